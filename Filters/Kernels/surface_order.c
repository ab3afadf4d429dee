/* SPDX-License-Identifier: BSD-3-Clause */
/* Numbers faces and points along a space-filling curve: what lies together on the surface lies together in memory,
 * whatever order the input came in. */
#include "morton.h"
#include "surface.h"

#include <string.h>

enum
{
  digit_bits = 11,
  digits = 1 << digit_bits,
  passes = 3
};

typedef struct keyed
{
  uint32_t key;
  aqr_index face;
} keyed;

/* Stable radix sort; the passes go to and fro between the two arrays and end in `b`. */
static aqr_status sort_by_key(aqr_context* c, keyed* a, keyed* b, size_t n)
{
  for (unsigned pass = 0; pass < passes; pass++)
  {
    size_t start[digits + 1] = { 0 };
    unsigned shift = pass * digit_bits;
    if (!aqr_step(c, 0.3))
      return AQR_CANCELLED;
    for (size_t i = 0; i < n; i++)
      start[(a[i].key >> shift & (digits - 1)) + 1]++;
    for (unsigned d = 0; d < digits; d++)
      start[d + 1] += start[d];
    for (size_t i = 0; i < n; i++)
      b[start[a[i].key >> shift & (digits - 1)]++] = a[i];
    keyed* swap = a;
    a = b;
    b = swap;
  }
  return AQR_OK;
}

/* From the faces as they come, whose corners are input points, to those in order. */
typedef struct arrangement
{
  const aqr_input* in;
  const aqr_surface* from;
  aqr_surface to;
  keyed *order, *spare;
  aqr_index* input_point; /* of each point in order */
  aqr_index* first;       /* of its half-edges */
} arrangement;

static vec3 place(const arrangement* a, size_t input_point)
{
  vec3 d = v3_sub(aqr_input_point(a->in, input_point), a->from->centre);
  double diagonal = a->from->diagonal;
  return v3(d.x / diagonal, d.y / diagonal, d.z / diagonal);
}

static void find_keys(void* data, size_t begin, size_t end)
{
  arrangement* a = data;
  for (size_t f = begin; f < end; f++)
    a->order[f] = (keyed){ aqr_morton(place(a, a->from->corner[3 * f])), (aqr_index)f };
}

static void move_faces(void* data, size_t begin, size_t end)
{
  arrangement* a = data;
  for (size_t i = begin; i < end; i++)
  {
    size_t f = a->order[i].face;
    a->to.source[i] = a->from->source[f];
    memcpy(a->to.corner + 3 * i, a->from->corner + 3 * f, 3 * sizeof *a->to.corner);
  }
}

/* Numbers the points as the faces come to them. */
static aqr_status number_points(aqr_context* c, arrangement* a)
{
  size_t n_in = a->in->number_of_points, n = 0;
  aqr_status status = AQR_OK;
  aqr_index* id = AQR_NEW(c, aqr_index, n_in);
  AQR_REQUIRE(id, AQR_OUT_OF_MEMORY);
  memset(id, 0xff, n_in * sizeof *id);
  for (size_t i = 0; i < 3 * a->to.n_faces; i++)
  {
    if (i % (1 << 18) == 0)
      AQR_REQUIRE(aqr_step(c, 0.35), AQR_CANCELLED);
    aqr_index v = a->to.corner[i];
    if (id[v] == AQR_NONE)
    {
      id[v] = (aqr_index)n;
      a->input_point[n] = v;
      a->first[n++] = (aqr_index)i;
    }
    a->to.corner[i] = id[v];
  }
  a->to.n_points = n;
done:
  AQR_DROP(c, id, n_in);
  return status;
}

static void place_points(void* data, size_t begin, size_t end)
{
  arrangement* a = data;
  for (size_t i = begin; i < end; i++)
  {
    aqr_index p = a->input_point[i];
    v3_store(a->to.points + 3 * i, place(a, p));
    a->to.fan[i] = a->first[i];
    a->to.origin[i] = p;
  }
}

aqr_status aqr_surface_arrange(aqr_context* c, const aqr_input* input, aqr_surface* s)
{
  size_t n = s->n_faces, n_in = input->number_of_points;
  aqr_status status = AQR_OK;
  arrangement a = { .in = input, .from = s, .order = AQR_NEW(c, keyed, n), .spare = AQR_NEW(c, keyed, n) };
  AQR_REQUIRE(a.order && a.spare && aqr_surface_reserve_faces(c, &a.to, n), AQR_OUT_OF_MEMORY);
  a.to.n_faces = n;
  a.to.centre = s->centre;
  a.to.diagonal = s->diagonal;
  AQR_TRY(aqr_parallel(c, n, find_keys, &a, 0.28, 0.3));
  AQR_TRY(sort_by_key(c, a.order, a.spare, n));
  keyed* sorted = a.spare;
  a.spare = a.order;
  a.order = sorted;
  AQR_DROP(c, a.spare, n);
  AQR_TRY(aqr_parallel(c, n, move_faces, &a, 0.33, 0.35));
  AQR_DROP(c, a.order, n);
  a.input_point = AQR_NEW(c, aqr_index, n_in);
  a.first = AQR_NEW(c, aqr_index, n_in);
  AQR_REQUIRE(a.input_point && a.first, AQR_OUT_OF_MEMORY);
  AQR_TRY(number_points(c, &a));
  AQR_REQUIRE(
    aqr_surface_reserve_points(c, &a.to, a.to.n_points) && aqr_surface_reserve_origins(c, &a.to, a.to.n_points),
    AQR_OUT_OF_MEMORY);
  AQR_TRY(aqr_parallel(c, a.to.n_points, place_points, &a, 0.35, 0.36));
  aqr_surface swap = *s;
  *s = a.to;
  a.to = swap;
done:
  AQR_DROP(c, a.order, n);
  AQR_DROP(c, a.spare, n);
  AQR_DROP(c, a.input_point, n_in);
  AQR_DROP(c, a.first, n_in);
  aqr_surface_free(c, &a.to);
  return status;
}

/* Ranks of n items by key, those of one key as they come. */
static aqr_status rank_by(aqr_context* c, const aqr_index* key, size_t n, size_t n_keys, aqr_index* rank)
{
  aqr_index* start = AQR_NEW0(c, aqr_index, n_keys + 1);
  if (!start)
    return AQR_OUT_OF_MEMORY;
  for (size_t i = 0; i < n; i++)
    start[key[i] + 1]++;
  for (size_t k = 0; k < n_keys; k++)
    start[k + 1] += start[k];
  for (size_t i = 0; i < n; i++)
    rank[i] = start[key[i]]++;
  AQR_DROP(c, start, n_keys + 1);
  return AQR_OK;
}

aqr_status aqr_surface_rank_faces(aqr_context* c, const aqr_surface* s, aqr_index* rank)
{
  aqr_index last = 0;
  for (size_t f = 0; f < s->n_faces; f++)
    last = s->source[f] > last ? s->source[f] : last;
  return rank_by(c, s->source, s->n_faces, (size_t)last + 1, rank);
}

aqr_status aqr_surface_rank_points(aqr_context* c, const aqr_surface* s, size_t n_input_points, aqr_index* rank)
{
  aqr_index* key = AQR_NEW(c, aqr_index, s->n_clean);
  if (!key)
    return AQR_OUT_OF_MEMORY;
  for (size_t i = 0; i < s->n_clean; i++)
    key[i] = aqr_is_input_point(s, i) ? s->origin[i] : (aqr_index)n_input_points;
  aqr_status status = rank_by(c, key, s->n_clean, n_input_points + 1, rank);
  AQR_DROP(c, key, s->n_clean);
  return status;
}
