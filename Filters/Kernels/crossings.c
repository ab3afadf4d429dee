/* SPDX-License-Identifier: BSD-3-Clause */
/* Paper 5: intersections per face. */
#include "crossings.h"

#include <string.h>

enum
{
  faces_at_once = 1 << 17, /* looked through by all threads before their crossings are added */
  pairs_held = 31
};

/* What the pairs of a face's chords do, in the order they are looked at, two bits for each. */
typedef enum pair_state
{
  apart,
  crosses_left,  /* the second runs from the right of the first to its left */
  crosses_right, /* the other way */
  not_looked_at  /* nor are the pairs after it: there are more than are held */
} pair_state;

typedef struct finder
{
  aqr_context* c;
  const aqr_surface* s;
  const aqr_lines* l;
  aqr_network* net;
  aqr_crossing_order* order;
  aqr_index first_face; /* of those looked at now */
  uint64_t* pairs;      /* of each of them */
} finder;

/* The first in the list of face f from i on that is not on a chain; or AQR_NONE. */
static aqr_index chord_from(const aqr_lines* l, aqr_index i, aqr_index f)
{
  while (i != AQR_NONE && l->lines[l->samples[i].line].is_chain)
    i = aqr_next_chord(l, i, f);
  return i;
}

static aqr_index next_chord(const aqr_lines* l, aqr_index i, aqr_index f)
{
  return chord_from(l, aqr_next_chord(l, i, f), f);
}

static pair_state look_at(const finder* b, aqr_index f, aqr_index i, aqr_index j)
{
  const aqr_sample *p = &b->l->samples[i], *q = &b->l->samples[j];
  int turn = aqr_chords_cross(b->s, f, p, p + 1, q, q + 1);
  return turn == 0 ? apart : turn > 0 ? crosses_left : crosses_right;
}

static uint64_t pairs_of(const finder* b, aqr_index f)
{
  const aqr_lines* l = b->l;
  uint64_t pairs = 0;
  unsigned n = 0;
  for (aqr_index i = chord_from(l, l->head[f], f); i != AQR_NONE; i = next_chord(l, i, f))
    for (aqr_index j = next_chord(l, i, f); j != AQR_NONE; j = next_chord(l, j, f), n++)
    {
      if (n == pairs_held)
        return pairs | (uint64_t)not_looked_at << (2 * n);
      pairs |= (uint64_t)look_at(b, f, i, j) << (2 * n);
    }
  return pairs;
}

static void look_at_faces(void* data, size_t begin, size_t end)
{
  finder* b = data;
  for (size_t i = begin; i < end; i++)
    b->pairs[i] = pairs_of(b, b->first_face + (aqr_index)i);
}

/* Adds the crossings of a face to the network's. */
static aqr_status add_crossings(finder* b, aqr_index f, uint64_t pairs)
{
  const aqr_lines* l = b->l;
  aqr_network* net = b->net;
  for (aqr_index i = chord_from(l, l->head[f], f); i != AQR_NONE && pairs; i = next_chord(l, i, f))
    for (aqr_index j = next_chord(l, i, f); j != AQR_NONE && pairs; j = next_chord(l, j, f))
    {
      pair_state state = (pair_state)(pairs & 3);
      if (state == not_looked_at)
        state = look_at(b, f, i, j);
      else
        pairs >>= 2;
      if (state == apart)
        continue;
      if (!AQR_RESERVE(b->c, net->crossings, net->crossing_capacity, net->n_crossings + 1))
        return AQR_OUT_OF_MEMORY;
      net->crossings[net->n_crossings++] = (aqr_crossing){ { i, j }, { l->samples[i].line, l->samples[j].line },
        { AQR_NONE, AQR_NONE }, { AQR_NONE, AQR_NONE }, (int8_t)(state == crosses_left ? 1 : -1), true };
    }
  return AQR_OK;
}

/* All threads look at the faces, one adds what they found in the order of the faces. */
static aqr_status find(finder* b)
{
  aqr_status status = AQR_OK;
  size_t n_faces = b->s->n_faces;
  b->pairs = AQR_NEW(b->c, uint64_t, faces_at_once);
  AQR_REQUIRE(b->pairs, AQR_OUT_OF_MEMORY);
  for (size_t first = 0; first < n_faces; first += faces_at_once)
  {
    size_t n = n_faces - first < faces_at_once ? n_faces - first : faces_at_once;
    double from = 0.2 * (double)first / (double)n_faces, to = 0.2 * (double)(first + n) / (double)n_faces;
    b->first_face = (aqr_index)first;
    AQR_TRY(aqr_parallel(b->c, n, look_at_faces, b, from, to));
    for (size_t i = 0; i < n; i++)
      if (b->pairs[i])
        AQR_TRY(add_crossings(b, b->first_face + (aqr_index)i, b->pairs[i]));
  }
  AQR_REQUIRE(b->net->n_crossings < AQR_NONE / 8, AQR_TOO_LARGE);
done:
  AQR_DROP(b->c, b->pairs, faces_at_once);
  return status;
}

static aqr_status list_by_chord(finder* b)
{
  const aqr_network* net = b->net;
  aqr_crossing_order* o = b->order;
  size_t n = b->l->n_samples;
  o->n_samples = n;
  o->n_on = 2 * net->n_crossings;
  o->first = AQR_NEW0(b->c, aqr_index, n + 2);
  o->on = AQR_NEW(b->c, aqr_index, o->n_on);
  if (!o->first || !o->on)
    return AQR_OUT_OF_MEMORY;
  for (size_t i = 0; i < net->n_crossings; i++)
    for (unsigned k = 0; k < 2; k++)
      o->first[net->crossings[i].chord[k] + 2]++;
  for (size_t i = 0; i < n; i++)
    o->first[i + 2] += o->first[i + 1];
  for (size_t i = 0; i < net->n_crossings; i++)
    for (unsigned k = 0; k < 2; k++)
      o->on[o->first[net->crossings[i].chord[k] + 1]++] = (aqr_index)i;
  return AQR_OK;
}

/* Whether x's other chord runs from the right of `chord` to its left (1) or from its left (-1). */
static int turn_on(const aqr_crossing* x, aqr_index chord)
{
  return aqr_side_of(x, chord) == 0 ? x->turn : -x->turn;
}

/* Twice as many places as are told apart along an edge where three chords nearly meet. Large enough for the order of
 * crossings to be the true one wherever it can be seen, small enough for 64 bits. */
#define AQR_PLACES ((int64_t)1 << 15)
#define AQR_HALF_WORD ((int64_t)1 << 31)

/* A chord's end in barycentric coordinates of its face, times AQR_PLACES; or how these change as it moves along the
 * face's border. Never at a corner, so that ends on two sides differ. */
static void end_at(const finder* b, aqr_index f, const aqr_sample* a, bool moving, int64_t w[3])
{
  aqr_index h = aqr_sample_half_edge(b->s, a, f), k = h % 3;
  int64_t t = 2 * (int64_t)(a->t * (double)(AQR_PLACES >> 1)) + 1;
  if (t >= AQR_PLACES)
    t = AQR_PLACES - 1;
  if (h != a->edge)
    t = AQR_PLACES - t;
  w[k] = moving ? -1 : AQR_PLACES - t;
  w[(k + 1) % 3] = moving ? 1 : t;
  w[(k + 2) % 3] = 0;
}

static void cross(const int64_t a[3], const int64_t b[3], int64_t c[3])
{
  for (unsigned i = 0; i < 3; i++)
    c[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

/* The sign of the determinant of three lines, exact: their numbers are below 2^30, those of the product of two below
 * 2^61, which is taken in two halves. */
static int determinant(int64_t line[3][3])
{
  int64_t m[3], high = 0, low = 0;
  cross(line[1], line[2], m);
  for (unsigned i = 0; i < 3; i++)
  {
    high += line[0][i] * (m[i] / AQR_HALF_WORD);
    low += line[0][i] * (m[i] % AQR_HALF_WORD);
  }
  high += low / AQR_HALF_WORD;
  low %= AQR_HALF_WORD;
  return high ? (high > 0 ? 1 : -1) : (low > 0) - (low < 0);
}

/* Orientation of three chords of face f that cross each other pairwise: the sign of the determinant of their lines.
 *
 * The orders of crossings that follow along the chords must be those of some straight lines, or the loops around these
 * crossings would close no disks. So the sign is exact, and where the three lines meet in one point each end counts as
 * moved a little along the border, ends farther along infinitely more than those before them: that keeps the order of
 * ends along the border, which decides who crosses whom, also where chords coincide. The sign is then that of the first
 * derivative that does not vanish. */
static int triple(const finder* b, aqr_index f, aqr_index a, aqr_index p, aqr_index q)
{
  const aqr_sample* m = b->l->samples;
  const aqr_sample* end[6] = { &m[a], &m[a + 1], &m[p], &m[p + 1], &m[q], &m[q + 1] };
  unsigned rank[6] = { 0 }; /* 0: the farthest along the border */
  for (unsigned moved = 0; moved < 64; moved++)
  {
    int64_t line[3][3], w[2][3];
    for (unsigned i = 0; moved == 1 && i < 6; i++)
      for (unsigned j = 0; j < 6; j++)
        rank[i] += aqr_border_before(b->s, f, end[i], end[j]);
    for (unsigned i = 0; i < 3; i++)
    {
      for (unsigned k = 0; k < 2; k++)
        end_at(b, f, end[2 * i + k], moved >> rank[2 * i + k] & 1, w[k]);
      cross(w[0], w[1], line[i]);
    }
    int sign = determinant(line);
    if (sign)
      return sign;
  }
  return 1; /* not reached: no chord begins and ends on one edge */
}

/* Whether crossing x comes before crossing y along chord a. */
static bool comes_before(const finder* b, aqr_index a, aqr_index x, aqr_index y)
{
  const aqr_crossing *cx = &b->net->crossings[x], *cy = &b->net->crossings[y];
  aqr_index p = cx->chord[!aqr_side_of(cx, a)], q = cy->chord[!aqr_side_of(cy, a)], f = b->l->samples[a].face;
  const aqr_sample* m = b->l->samples;
  if (aqr_chords_cross(b->s, f, &m[p], &m[p + 1], &m[q], &m[q + 1]))
    return triple(b, f, a, p, q) * turn_on(cx, a) * turn_on(cy, a) > 0;
  /* p and q do not cross, so q lies whole on one side of p: on that of a's start or on that of its end */
  bool wraps = aqr_border_before(b->s, f, &m[p + 1], &m[p]);
  const aqr_sample *low = wraps ? &m[p + 1] : &m[p], *high = wraps ? &m[p] : &m[p + 1];
  bool start = aqr_border_before(b->s, f, low, &m[a]) && aqr_border_before(b->s, f, &m[a], high);
  bool other = aqr_border_before(b->s, f, low, &m[q]) && aqr_border_before(b->s, f, &m[q], high);
  return start != other;
}

static void order_along_chords(void* data, size_t begin, size_t end)
{
  const finder* b = data;
  const aqr_crossing_order* o = b->order;
  for (size_t a = begin; a < end; a++)
    for (size_t i = o->first[a]; i < o->first[a + 1]; i++)
    {
      /* halving finds the place: what compares costs far more than what moves */
      aqr_index x = o->on[i];
      size_t low = o->first[a], high = i;
      while (low < high)
      {
        size_t middle = (low + high) / 2;
        if (comes_before(b, (aqr_index)a, x, o->on[middle]))
          high = middle;
        else
          low = middle + 1;
      }
      memmove(o->on + low + 1, o->on + low, (i - low) * sizeof x);
      o->on[low] = x;
    }
}

aqr_status aqr_crossings_find(
  aqr_context* c, const aqr_surface* s, const aqr_lines* lines, aqr_network* net, aqr_crossing_order* order)
{
  finder b = { .c = c, .s = s, .l = lines, .net = net, .order = order };
  aqr_status status = AQR_OK;
  AQR_TRY(find(&b));
  AQR_TRY(list_by_chord(&b));
  AQR_TRY(aqr_parallel(c, lines->n_samples, order_along_chords, &b, 0.2, 0.3));
done:
  return status;
}

void aqr_crossing_order_free(aqr_context* c, aqr_crossing_order* order)
{
  AQR_DROP(c, order->first, order->n_samples + 2);
  AQR_DROP(c, order->on, order->n_on);
}
