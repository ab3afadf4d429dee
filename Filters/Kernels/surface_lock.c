/* SPDX-License-Identifier: BSD-3-Clause */
/* Edges that the caller wants to keep, found on the cleaned surface by the input points at their ends. */
#include "surface.h"

#include <string.h>

/* Two input points, the smaller first. */
typedef struct pair
{
  aqr_index low, high;
} pair;

typedef struct pair_table
{
  pair* pairs; /* low AQR_NONE: free */
  uint8_t* found;
  size_t size;
} pair_table;

static pair ordered(aqr_index a, aqr_index b)
{
  return a < b ? (pair){ a, b } : (pair){ b, a };
}

/* Where the pair is, or would be. */
static size_t find(const pair_table* t, pair p)
{
  uint64_t x = ((uint64_t)p.low << 32 | p.high) * 0x9e3779b97f4a7c15u;
  size_t at = (size_t)(x ^ (x >> 29)) & (t->size - 1);
  while (t->pairs[at].low != AQR_NONE && (t->pairs[at].low != p.low || t->pairs[at].high != p.high))
    at = (at + 1) & (t->size - 1);
  return at;
}

/* Whether the pair could be an edge once equal points are joined. */
static bool joined(const aqr_input* in, const aqr_index* weld, size_t i, pair* p)
{
  aqr_index a = weld[in->locked[2 * i]], b = weld[in->locked[2 * i + 1]];
  *p = ordered(a, b);
  return a != b && p->high != AQR_NONE;
}

/* The input edge that the half-edge is a piece of: points added by halving it have origins at its two ends. */
static bool piece_of(const aqr_surface* s, aqr_index h, pair* p)
{
  const aqr_origin ends[2] = { aqr_origin_of(s, aqr_from(s, h)), aqr_origin_of(s, aqr_to(s, h)) };
  aqr_index seen[2] = { AQR_NONE, AQR_NONE };
  unsigned n = 0;
  for (unsigned k = 0; k < 6; k++)
  {
    const aqr_origin* o = &ends[k / 3];
    aqr_index v = o->point[k % 3];
    if (!(o->weight[k % 3] > 0) || (n > 0 && seen[0] == v) || (n > 1 && seen[1] == v))
      continue;
    if (n == 2)
      return false;
    seen[n++] = v;
  }
  if (n == 2)
    *p = ordered(seen[0], seen[1]);
  return n == 2;
}

aqr_status aqr_surface_lock(
  aqr_context* c, const aqr_input* input, const aqr_index* weld, aqr_surface* s, aqr_report* report)
{
  size_t n = input->number_of_locked;
  aqr_status status = AQR_OK;
  pair_table t = { .size = 16 };
  pair p;
  while (t.size < 2 * n)
    t.size *= 2;
  t.pairs = AQR_NEW(c, pair, t.size);
  t.found = AQR_NEW0(c, uint8_t, t.size);
  s->locked = AQR_NEW0(c, uint8_t, 3 * s->n_faces);
  AQR_REQUIRE(t.pairs && t.found && s->locked, AQR_OUT_OF_MEMORY);
  memset(t.pairs, 0xff, t.size * sizeof *t.pairs);
  for (size_t i = 0; i < n; i++)
    if (joined(input, weld, i, &p))
      t.pairs[find(&t, p)] = p;
  for (aqr_index h = 0; h < 3 * s->n_faces; h++)
  {
    if (h % (1 << 18) == 0)
      AQR_REQUIRE(aqr_step(c, 0.95), AQR_CANCELLED);
    if (!piece_of(s, h, &p))
      continue;
    size_t at = find(&t, p);
    if (t.pairs[at].low == AQR_NONE)
      continue;
    s->locked[h] = t.found[at] = 1;
    report->locked_edges += aqr_is_boundary(s, h) || h < s->twin[h];
  }
  for (size_t i = 0; i < n; i++)
    report->locked_missed += !joined(input, weld, i, &p) || !t.found[find(&t, p)];
done:
  AQR_DROP(c, t.pairs, t.size);
  AQR_DROP(c, t.found, t.size);
  return status;
}
