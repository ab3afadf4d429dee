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

/* Moves the faces to the order given and numbers the points as the faces come to them. */
static aqr_status renumber(aqr_context* c, aqr_surface* s, const keyed* order)
{
  size_t n = s->n_faces, n_points = s->n_points;
  aqr_status status = AQR_OK;
  aqr_surface to = { 0 };
  aqr_index* id = AQR_NEW(c, aqr_index, n_points);
  AQR_REQUIRE(id && aqr_surface_reserve_faces(c, &to, n) && aqr_surface_reserve_points(c, &to, n_points) &&
                aqr_surface_reserve_origins(c, &to, n_points),
    AQR_OUT_OF_MEMORY);
  memset(id, 0xff, n_points * sizeof *id);
  for (size_t i = 0; i < n; i++)
  {
    if (i % 65536 == 0)
      AQR_REQUIRE(aqr_step(c, 0.35), AQR_CANCELLED);
    size_t f = order[i].face;
    to.source[i] = s->source[f];
    for (unsigned k = 0; k < 3; k++)
    {
      size_t v = s->corner[3 * f + k];
      if (id[v] == AQR_NONE)
      {
        id[v] = (aqr_index)to.n_points++;
        memcpy(to.points + 3 * (size_t)id[v], s->points + 3 * v, 3 * sizeof *s->points);
        to.origin[id[v]] = s->origin[v];
      }
      to.corner[3 * i + k] = id[v];
    }
  }
  to.n_faces = n;
  to.centre = s->centre;
  to.diagonal = s->diagonal;
  aqr_surface swap = *s;
  *s = to;
  to = swap;
done:
  aqr_surface_free(c, &to);
  AQR_DROP(c, id, n_points);
  return status;
}

aqr_status aqr_surface_arrange(aqr_context* c, aqr_surface* s)
{
  size_t n = s->n_faces;
  aqr_status status = AQR_OK;
  keyed *order = AQR_NEW(c, keyed, n), *spare = AQR_NEW(c, keyed, n);
  AQR_REQUIRE(order && spare, AQR_OUT_OF_MEMORY);
  for (size_t f = 0; f < n; f++)
    order[f] = (keyed){ aqr_morton(aqr_point(s, s->corner[3 * f])), (aqr_index)f };
  AQR_TRY(sort_by_key(c, order, spare, n));
  AQR_DROP(c, order, n);
  AQR_TRY(renumber(c, s, spare));
done:
  AQR_DROP(c, order, n);
  AQR_DROP(c, spare, n);
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
    key[i] = s->origin[i].weight[0] < 1 ? (aqr_index)n_input_points : s->origin[i].point[0];
  aqr_status status = rank_by(c, key, s->n_clean, n_input_points + 1, rank);
  AQR_DROP(c, key, s->n_clean);
  return status;
}
