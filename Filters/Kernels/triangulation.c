/* SPDX-License-Identifier: BSD-3-Clause */
#include "triangulation.h"

#include "vector.h"

#include <string.h>

enum
{
  poll_every = 1024,
  most_turns = 64 /* of diagonals per corner: rounding might let them turn for ever */
};

static const double straight = 1e-9; /* sine of the angle up to which three points lie on a line */

/* What an ear may be, from what it should be to what is taken where the outline crosses itself. */
enum strictness
{
  is_proper,  /* no corner lies in it or on its sides */
  is_flat,    /* it may have no area, and corners on its sides */
  is_shortest /* the one with the shortest diagonal */
};

typedef struct ring
{
  const aqr_outline* o;
  aqr_index *next, *prev;
  aqr_index* behind;   /* per corner: 3 t + i, side i of the triangle behind the side that begins here, or AQR_NONE */
  uint8_t* is_reflex;  /* convex corners stay convex, and no ear holds one without holding one that is not */
  aqr_index* cell;     /* n_cells + 1: corners of grid cell k are in_cell[cell[k]] ... */
  aqr_index* in_cell;  /* the corners that were reflex in the beginning */
  size_t side;         /* the grid has side * side cells */
  double low[2], size; /* of the grid */
} ring;

static double cross(const double* a, const double* b, const double* c)
{
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}
static double dot(const double* a, const double* b, const double* c)
{
  return (b[0] - a[0]) * (c[0] - a[0]) + (b[1] - a[1]) * (c[1] - a[1]);
}

/* 1 where c lies to the left of the line from a to b, -1 to its right, 0 on it. */
static int turn(const double* a, const double* b, const double* c)
{
  double z = cross(a, b, c);
  if (z * z <= straight * straight * dot(a, b, b) * dot(a, c, c))
    return 0;
  return z > 0 ? 1 : -1;
}

static const double* at_corner(const aqr_outline* o, aqr_index i)
{
  return o->xy + 2 * (size_t)i;
}

static bool is_convex(const ring* r, aqr_index i)
{
  return turn(at_corner(r->o, r->prev[i]), at_corner(r->o, i), at_corner(r->o, r->next[i])) > 0;
}

/* ---- the grid of reflex corners ---- */

static size_t slot(const ring* r, double x, unsigned axis)
{
  double k = (x - r->low[axis]) / r->size * (double)r->side;
  return k > 0 ? (size_t)lesser(k, (double)r->side - 1) : 0;
}

static size_t cell_of(const ring* r, aqr_index i)
{
  return slot(r, at_corner(r->o, i)[1], 1) * r->side + slot(r, at_corner(r->o, i)[0], 0);
}

static void fill_grid(ring* r)
{
  const aqr_outline* o = r->o;
  double high[2] = { o->xy[0], o->xy[1] };
  memcpy(r->low, o->xy, sizeof r->low);
  for (size_t k = 0; k < 2 * o->n; k++)
  {
    r->low[k % 2] = lesser(r->low[k % 2], o->xy[k]);
    high[k % 2] = greater(high[k % 2], o->xy[k]);
  }
  r->size = greater(high[0] - r->low[0], high[1] - r->low[1]);
  r->size = r->size > 0 ? r->size : 1;
  for (aqr_index i = 0; i < o->n; i++)
    if (r->is_reflex[i])
      r->cell[cell_of(r, i)]++;
  for (size_t k = 0; k < r->side * r->side; k++)
    r->cell[k + 1] += r->cell[k];
  for (aqr_index i = (aqr_index)o->n; i-- > 0;)
    if (r->is_reflex[i])
      r->in_cell[--r->cell[cell_of(r, i)]] = i;
}

/* ---- ears ---- */

/* Whether corner k lies in the ear, and is not one of its own. */
static bool lies_in(const ring* r, const aqr_index* ear, aqr_index k, int least)
{
  const aqr_outline* o = r->o;
  for (unsigned i = 0; i < 3; i++)
    if (o->name[ear[i]] == o->name[k] ||
        turn(at_corner(o, ear[i]), at_corner(o, ear[(i + 1) % 3]), at_corner(o, k)) < least)
      return false;
  return true;
}

static bool holds_corner(const ring* r, const aqr_index* ear, int least)
{
  size_t low[2], high[2];
  for (unsigned axis = 0; axis < 2; axis++)
  {
    double x[3];
    for (unsigned i = 0; i < 3; i++)
      x[i] = at_corner(r->o, ear[i])[axis];
    low[axis] = slot(r, lesser(x[0], lesser(x[1], x[2])), axis);
    high[axis] = slot(r, greater(x[0], greater(x[1], x[2])), axis);
  }
  for (size_t y = low[1]; y <= high[1]; y++)
    for (size_t k = r->cell[y * r->side + low[0]]; k < r->cell[y * r->side + high[0] + 1]; k++)
      if (r->is_reflex[r->in_cell[k]] && lies_in(r, ear, r->in_cell[k], least))
        return true;
  return false;
}

static bool is_ear(const ring* r, aqr_index i, enum strictness strictness)
{
  const aqr_outline* o = r->o;
  aqr_index ear[3] = { r->prev[i], i, r->next[i] };
  if (o->name[ear[0]] == o->name[ear[2]])
    return false;
  int t = turn(at_corner(o, ear[0]), at_corner(o, i), at_corner(o, ear[2]));
  return strictness == is_proper ? t > 0 && !holds_corner(r, ear, 0) : t >= 0 && !holds_corner(r, ear, 1);
}

/* The corner, of those left from `first` on, whose neighbours are nearest to each other; rather a convex one whose
 * neighbours have different names. */
static aqr_index shortest_ear(const ring* r, aqr_index first)
{
  const aqr_outline* o = r->o;
  aqr_index i = first, best = first;
  double least = INFINITY;
  bool is_better = false;
  do
  {
    const double *a = at_corner(o, r->prev[i]), *b = at_corner(o, r->next[i]);
    bool is_good = o->name[r->prev[i]] != o->name[r->next[i]] && turn(a, at_corner(o, i), b) > 0;
    double length2 = dot(a, b, b);
    if (is_good > is_better || (is_good == is_better && length2 < least))
    {
      best = i;
      least = length2;
      is_better = is_good;
    }
    i = r->next[i];
  } while (i != first);
  return best;
}

static void join(aqr_triangle* triangles, aqr_index t, unsigned side, aqr_index behind)
{
  triangles[t].beside[side] = behind == AQR_NONE ? AQR_NONE : behind / 3;
  if (behind != AQR_NONE)
    triangles[behind / 3].beside[behind % 3] = t;
}

static void cut_off(ring* r, aqr_index i, aqr_triangle* triangles, aqr_index t)
{
  aqr_index a = r->prev[i], b = r->next[i];
  triangles[t] = (aqr_triangle){ { a, i, b }, { AQR_NONE, AQR_NONE, AQR_NONE } };
  join(triangles, t, 0, r->behind[a]);
  join(triangles, t, 1, r->behind[i]);
  if (r->next[b] == a)
    join(triangles, t, 2, r->behind[b]);
  r->behind[a] = 3 * t + 2;
  r->next[a] = b;
  r->prev[b] = a;
  r->is_reflex[i] = 0;
  r->is_reflex[a] = !is_convex(r, a);
  r->is_reflex[b] = !is_convex(r, b);
}

static aqr_status cut_ears(aqr_context* c, ring* r, double at, aqr_triangle* triangles)
{
  size_t tried = 0, looks = 0, left = r->o->n;
  enum strictness strictness = is_proper;
  for (aqr_index i = 0, t = 0; left > 2;)
  {
    if (looks++ % poll_every == 0 && !aqr_step(c, at))
      return AQR_CANCELLED;
    if (strictness == is_shortest)
      i = shortest_ear(r, i);
    aqr_index next = r->next[i];
    if (strictness == is_shortest || is_ear(r, i, strictness))
    {
      cut_off(r, i, triangles, t++);
      next = r->next[next]; /* not all ears side by side, which makes fans */
      tried = 0;
      left--;
      strictness = is_proper;
    }
    else if (++tried > left)
    {
      tried = 0;
      strictness++;
    }
    i = next;
  }
  return AQR_OK;
}

/* ---- Delaunay ---- */

static unsigned side_to(const aqr_triangle* t, aqr_index beside)
{
  return t->beside[0] == beside ? 0 : t->beside[1] == beside ? 1 : 2;
}

/* Whether the circle through one triangle holds the far corner of the other, and their diagonal can be turned. */
static bool is_to_turn(const aqr_outline* o, const aqr_triangle* a, unsigned i, const aqr_triangle* b, unsigned j)
{
  const double *p = at_corner(o, a->corner[i]), *q = at_corner(o, a->corner[(i + 1) % 3]);
  const double *r = at_corner(o, a->corner[(i + 2) % 3]), *s = at_corner(o, b->corner[(j + 2) % 3]);
  double sine = cross(r, p, q) * dot(s, q, p) + dot(r, p, q) * cross(s, q, p); /* of the sum of the angles at r and s */
  double scale = dot(r, p, p) * dot(r, q, q) * dot(s, p, p) * dot(s, q, q);
  return sine < 0 && sine * sine > straight * straight * scale && turn(s, r, p) > 0 && turn(r, s, q) > 0 &&
         o->name[a->corner[(i + 2) % 3]] != o->name[b->corner[(j + 2) % 3]];
}

static void turn_diagonal(aqr_triangle* triangles, aqr_index a, unsigned i, aqr_index b, unsigned j)
{
  aqr_triangle *ta = &triangles[a], *tb = &triangles[b];
  aqr_index over_q = ta->beside[(i + 1) % 3], over_p = tb->beside[(j + 1) % 3];
  aqr_index r = ta->corner[(i + 2) % 3], s = tb->corner[(j + 2) % 3];
  /* a = (p, q, r) becomes (p, s, r), b = (q, p, s) becomes (q, r, s) */
  ta->corner[(i + 1) % 3] = s;
  ta->beside[i] = over_p;
  ta->beside[(i + 1) % 3] = b;
  tb->corner[(j + 1) % 3] = r;
  tb->beside[j] = over_q;
  tb->beside[(j + 1) % 3] = a;
  if (over_p != AQR_NONE)
    triangles[over_p].beside[side_to(&triangles[over_p], b)] = a;
  if (over_q != AQR_NONE)
    triangles[over_q].beside[side_to(&triangles[over_q], a)] = b;
}

static aqr_status turn_diagonals(aqr_context* c, const aqr_outline* o, double at, aqr_triangle* triangles)
{
  aqr_status status = AQR_OK;
  size_t n = o->n - 2, capacity = 0, height = 0, turns = 0;
  aqr_index* stack = NULL;
  AQR_REQUIRE(AQR_RESERVE(c, stack, capacity, n), AQR_OUT_OF_MEMORY);
  for (aqr_index t = 0; t < n; t++)
    stack[height++] = t;
  while (height)
  {
    aqr_index a = stack[--height];
    for (unsigned i = 0; i < 3; i++)
    {
      aqr_index b = triangles[a].beside[i];
      if (b == AQR_NONE)
        continue;
      unsigned j = side_to(&triangles[b], a);
      if (!is_to_turn(o, &triangles[a], i, &triangles[b], j))
        continue;
      if (turns++ % poll_every == 0)
        AQR_REQUIRE(aqr_step(c, at), AQR_CANCELLED);
      AQR_REQUIRE(turns < most_turns * o->n, AQR_OK);
      turn_diagonal(triangles, a, i, b, j);
      AQR_REQUIRE(AQR_RESERVE(c, stack, capacity, height + 2), AQR_OUT_OF_MEMORY);
      stack[height++] = b;
      stack[height++] = a;
      break;
    }
  }
done:
  AQR_DROP(c, stack, capacity);
  return status;
}

aqr_status aqr_triangulate(aqr_context* c, const aqr_outline* outline, double at, aqr_triangle* triangles)
{
  aqr_status status = AQR_OK;
  size_t n = outline->n, side = (size_t)sqrt((double)n) + 1;
  ring r = { .o = outline, .side = side };
  r.next = AQR_NEW(c, aqr_index, n);
  r.prev = AQR_NEW(c, aqr_index, n);
  r.behind = AQR_NEW(c, aqr_index, n);
  r.in_cell = AQR_NEW(c, aqr_index, n);
  r.is_reflex = AQR_NEW(c, uint8_t, n);
  r.cell = AQR_NEW0(c, aqr_index, side * side + 1);
  AQR_REQUIRE(r.next && r.prev && r.behind && r.in_cell && r.is_reflex && r.cell, AQR_OUT_OF_MEMORY);
  for (aqr_index i = 0; i < n; i++)
  {
    r.next[i] = i + 1 < n ? i + 1 : 0;
    r.prev[i] = i ? i - 1 : (aqr_index)n - 1;
    r.behind[i] = AQR_NONE;
  }
  for (aqr_index i = 0; i < n; i++)
    r.is_reflex[i] = !is_convex(&r, i);
  fill_grid(&r);
  AQR_TRY(cut_ears(c, &r, at, triangles));
  AQR_TRY(turn_diagonals(c, outline, at, triangles));
done:
  AQR_DROP(c, r.next, n);
  AQR_DROP(c, r.prev, n);
  AQR_DROP(c, r.behind, n);
  AQR_DROP(c, r.in_cell, n);
  AQR_DROP(c, r.is_reflex, n);
  AQR_DROP(c, r.cell, side * side + 1);
  return status;
}
