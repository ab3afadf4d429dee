/* SPDX-License-Identifier: BSD-3-Clause */
#include "crease_budget.h"

#include <stdlib.h>

static const double of_loop = 4;   /* points: with fewer it is none */
static const double at_once = 0.5; /* of the excess: creases that run on then share fewer ends */

typedef struct priced
{
  double take;  /* points */
  double worth; /* bend per point; infinite where it is locked */
  size_t chain;
} priced;

static aqr_index end_of(const aqr_surface* s, const aqr_chains* k, const aqr_chain* a, unsigned end)
{
  return end ? s->clean[aqr_to(s, k->half_edges[a->first + a->count - 1])]
             : s->clean[aqr_from(s, k->half_edges[a->first])];
}

/* How many chains end at each cleaned point. */
static void count_ends(const aqr_surface* s, const aqr_chains* k, unsigned* ends)
{
  for (size_t i = 0; i < k->n_chains; i++)
    for (unsigned end = 0; end < 2 && !k->chains[i].closed; end++)
      ends[end_of(s, k, &k->chains[i], end)]++;
}

/* Of the points where a chain ends, which others share, its part. */
static double points_of(const aqr_surface* s, const aqr_chains* k, const aqr_chain* a, const unsigned* ends)
{
  if (a->closed)
    return of_loop;
  return 1.0 / ends[end_of(s, k, a, 0)] + 1.0 / ends[end_of(s, k, a, 1)];
}

/* The dihedral angle of an edge, integrated along it. */
static double bend_at(const aqr_surface* s, aqr_index h)
{
  double length = v3_norm(aqr_edge_vector(s, h));
  vec3 n = aqr_face_cross(s, aqr_face_of(h)), m = aqr_face_cross(s, aqr_face_of(aqr_any_twin(s, h)));
  return length * atan2(v3_norm(v3_cross(n, m)), v3_dot(n, m));
}

static double bend_along(const aqr_surface* s, const aqr_chains* k, const aqr_chain* a)
{
  double bend = 0;
  for (size_t i = 0; i < a->count; i++)
    bend += bend_at(s, k->half_edges[a->first + i]);
  return bend;
}

double aqr_crease_bend(const aqr_surface* s, const aqr_chains* chains)
{
  double along = 0, elsewhere = 0;
  for (size_t i = 0; i < chains->n_chains; i++)
    along += chains->chains[i].is_feature ? bend_along(s, chains, &chains->chains[i]) : 0;
  for (aqr_index h = 0; h < 3 * s->n_faces; h++)
    if (aqr_twin(s, h) != AQR_NONE && s->twin[h] > h)
      elsewhere += bend_at(s, h);
  return along > 0 ? along / (along + elsewhere) : 0;
}

aqr_status aqr_chains_measure(aqr_context* c, const aqr_surface* s, const aqr_chains* chains, aqr_chain_cost* cost)
{
  *cost = (aqr_chain_cost){ 0 };
  unsigned* ends = AQR_NEW0(c, unsigned, s->n_clean);
  if (!ends)
    return AQR_OUT_OF_MEMORY;
  count_ends(s, chains, ends);
  for (size_t i = 0; i < chains->n_chains; i++)
  {
    const aqr_chain* a = &chains->chains[i];
    *(a->is_feature ? &cost->creases : &cost->boundary) += points_of(s, chains, a, ends);
  }
  AQR_DROP(c, ends, s->n_clean);
  return AQR_OK;
}

static bool is_locked(const aqr_chains* k, const aqr_chain* a, const uint8_t* is_crease)
{
  for (size_t i = 0; i < a->count; i++)
    if (is_crease[k->half_edges[a->first + i]] == AQR_CREASE_LOCKED)
      return true;
  return false;
}

static int by_worth(const void* a, const void* b)
{
  const priced *x = a, *y = b;
  if (x->worth < y->worth || x->worth > y->worth)
    return x->worth < y->worth ? -1 : 1;
  return x->chain < y->chain ? -1 : x->chain > y->chain;
}

static size_t clear(aqr_surface* s, const aqr_chains* k, size_t chain, uint8_t* is_crease)
{
  const aqr_chain* a = &k->chains[chain];
  for (size_t i = 0; i < a->count; i++)
  {
    aqr_index h = k->half_edges[a->first + i], t = aqr_any_twin(s, h);
    is_crease[h] = is_crease[t] = 0;
    s->twin[h] = t;
    s->twin[t] = h;
  }
  return a->count;
}

aqr_status aqr_creases_give_up(
  aqr_context* c, aqr_surface* s, const aqr_chains* chains, double budget, uint8_t* is_crease, size_t* given_up)
{
  aqr_status status = AQR_OK;
  unsigned* ends = AQR_NEW0(c, unsigned, s->n_clean);
  priced* list = AQR_NEW(c, priced, chains->n_chains);
  size_t n = 0;
  AQR_REQUIRE(ends && list, AQR_OUT_OF_MEMORY);
  count_ends(s, chains, ends);
  double left = 0;
  for (size_t i = 0; i < chains->n_chains; i++)
    if (chains->chains[i].is_feature)
    {
      const aqr_chain* a = &chains->chains[i];
      double take = points_of(s, chains, a, ends);
      left += take;
      list[n++] = (priced){ take, is_locked(chains, a, is_crease) ? INFINITY : bend_along(s, chains, a) / take, i };
    }
  qsort(list, n, sizeof *list, by_worth);
  const double enough = budget + (left - budget) * at_once;
  *given_up = 0;
  for (size_t i = 0; i < n && left > enough && list[i].worth < INFINITY; i++)
  {
    *given_up += clear(s, chains, list[i].chain, is_crease);
    left -= list[i].take;
  }
done:
  AQR_DROP(c, ends, s->n_clean);
  AQR_DROP(c, list, chains->n_chains);
  return status;
}
