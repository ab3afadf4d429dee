/* SPDX-License-Identifier: BSD-3-Clause */
#include "chain_places.h"

#include "closest.h"

enum
{
  most_starts = 64 /* ways along chains from a corner: on either side of every seam, one way each. More are left out */
};

static const double first_reach = 4; /* times the distance between the ends of a run: how far the other is looked for */
static const double next_reach = 16; /* times the one before */
static const double last_reach = 64; /* diagonals: from there on without an end */

/* A place on a border or seam: fraction t of one of its half-edges. */
typedef struct spot
{
  aqr_index h;
  double t;
} spot;

/* The same place seen from every half-edge along which a chain may be followed from it. */
typedef struct spots
{
  unsigned n;
  spot at[most_starts];
  aqr_index corner; /* the cleaned point, AQR_NONE inside an edge */
} spots;

static bool has_place(const aqr_vertex* v)
{
  return v->place.bary[0] + v->place.bary[1] + v->place.bary[2] > 0;
}

static bool is_open(const aqr_surface* s, aqr_index h)
{
  return aqr_twin(s, h) == AQR_NONE;
}

static void add(const aqr_surface* s, spots* r, aqr_index h)
{
  if (is_open(s, h) && r->n < most_starts)
    r->at[r->n++] = (spot){ h, 0 };
}

static spots spots_of(const aqr_surface* s, const aqr_place* at)
{
  spots r = { .corner = AQR_NONE };
  unsigned largest = 0;
  for (unsigned i = 0; i < 3; i++)
  {
    aqr_index h = 3 * at->face + i, other = aqr_any_twin(s, h);
    double t = at->bary[(i + 1) % 3];
    if (at->bary[(i + 2) % 3] == 0 && at->bary[i] > 0 && t > 0 && is_open(s, h))
    {
      r.at[r.n++] = (spot){ h, t };
      if (other != AQR_NONE)
        r.at[r.n++] = (spot){ other, 1 - t };
      return r;
    }
    if (at->bary[i] > at->bary[largest])
      largest = i;
  }
  const aqr_index first = 3 * at->face + largest;
  aqr_index h = first;
  r.corner = s->clean[aqr_from(s, first)];
  do
  {
    add(s, &r, h);
    h = aqr_any_twin(s, aqr_prev(h));
  } while (h != AQR_NONE && h != first);
  if (h == first) /* all the way around */
    return r;
  for (h = first; !aqr_is_boundary(s, h);)
  {
    h = aqr_next(aqr_any_twin(s, h));
    add(s, &r, h);
  }
  return r;
}

static double length_of(const aqr_surface* s, aqr_index h)
{
  return v3_norm(aqr_edge_vector(s, h));
}

/* The half-edge of the same side of the same border or seam behind h. */
static aqr_index next_open(const aqr_surface* s, aqr_index h)
{
  h = aqr_next(h);
  while (!is_open(s, h))
    h = aqr_next(aqr_twin(s, h));
  return h;
}

/* Whether b lies on h behind fraction t, or in front of it as well where `anywhere`; then its fraction of h. */
static bool lies_on(const aqr_surface* s, const spots* b, aqr_index h, double t, bool anywhere, double* end)
{
  *end = 1;
  if (b->corner != AQR_NONE)
    return s->clean[aqr_to(s, h)] == b->corner;
  for (unsigned i = 0; i < b->n; i++)
    if (b->at[i].h == h && (anywhere || b->at[i].t > t))
    {
      *end = b->at[i].t;
      return true;
    }
  return false;
}

/* The way along the chain from a to b, all the way around where they are the same; infinite where it is longer than
 * `most` or does not get there. */
static double way_to(const aqr_surface* s, spot a, const spots* b, double most)
{
  double gone = 0;
  aqr_index first = a.h;
  for (bool begins = true; gone <= most; begins = false)
  {
    double end;
    if (lies_on(s, b, a.h, a.t, !begins, &end))
      return gone + (end - a.t) * length_of(s, a.h);
    if (!begins && a.h == first)
      break;
    gone += (1 - a.t) * length_of(s, a.h);
    a = (spot){ next_open(s, a.h), 0 };
  }
  return INFINITY;
}

/* The spot at a distance along the chain that does not exceed the way to its end. */
static spot go(const aqr_surface* s, spot a, double distance)
{
  for (;;)
  {
    double length = length_of(s, a.h), rest = (1 - a.t) * length;
    if (distance <= rest)
      return (spot){ a.h, length > 0 ? fmin(1, a.t + distance / length) : a.t };
    distance -= rest;
    a = (spot){ next_open(s, a.h), 0 };
  }
}

/* The shortest way from a to b: where it starts and how long it is. Looked for nearby first, as chains can be as long
 * as the surface. */
static double shortest_way(const aqr_surface* s, const spots* a, const spots* b, double reach, spot* start)
{
  double best = INFINITY;
  for (;; reach = reach * next_reach < last_reach ? reach * next_reach : INFINITY)
  {
    for (unsigned i = 0; i < a->n; i++)
    {
      double way = way_to(s, a->at[i], b, fmin(best, reach));
      if (way < best)
      {
        best = way;
        *start = a->at[i];
      }
    }
    if (isfinite(best) || isinf(reach))
      return best;
  }
}

static void put(const aqr_surface* s, spot at, aqr_vertex* v)
{
  v->place = (aqr_place){ aqr_face_of(at.h), { 0, 0, 0 } };
  v->place.bary[at.h % 3] = 1 - at.t;
  v->place.bary[(at.h % 3 + 1) % 3] = at.t;
  v->position = aqr_place_position(s, &v->place);
}

static bool on_curve(const aqr_polygon_mesh* m, aqr_index h)
{
  return aqr_pm_on_chain(m, h) || aqr_pm_face(m, h) == AQR_NONE || aqr_pm_face(m, h ^ 1) == AQR_NONE;
}

/* The edge of the same chain behind h, at whose end only two of its edges meet. */
static aqr_index follow(const aqr_polygon_mesh* m, aqr_index h)
{
  aqr_index k = aqr_pm_next_around(m, h ^ 1);
  while (k != (h ^ 1) && !on_curve(m, k))
    k = aqr_pm_next_around(m, k);
  return k;
}

/* The run of vertices without a place behind half-edge h, which starts at a placed one; on borders it runs as the
 * surface's own do. */
static void place_run(const aqr_surface* s, aqr_polygon_mesh* m, aqr_index h)
{
  const aqr_vertex* from = &m->vertices[aqr_pm_from(m, h)];
  double n = 1, i = 1;
  aqr_index last = h;
  for (; !has_place(&m->vertices[aqr_pm_to(m, last)]); n += 1)
  {
    aqr_index next = follow(m, last);
    if (next == (last ^ 1) || next == h)
      return;
    last = next;
  }
  const aqr_vertex* to = &m->vertices[aqr_pm_to(m, last)];
  spots a = spots_of(s, &from->place), b = spots_of(s, &to->place);
  spot start = { AQR_NONE, 0 };
  double distance = v3_norm(v3_sub(to->position, from->position));
  double length = shortest_way(s, &a, &b, distance > 0 ? first_reach * distance : INFINITY, &start);
  if (!(length > 0) || isinf(length))
    return;
  for (; h != last; h = follow(m, h), i += 1)
    put(s, go(s, start, length * i / n), &m->vertices[aqr_pm_to(m, h)]);
}

aqr_status aqr_place_on_chains(aqr_context* c, const aqr_surface* s, aqr_polygon_mesh* m)
{
  for (aqr_index h = 0; h < m->n_half_edges; h++)
  {
    if (h % 65536 == 0 && !aqr_step(c, 0))
      return AQR_CANCELLED;
    if (aqr_pm_edge_lives(m, h) && on_curve(m, h) && aqr_pm_face(m, h) != AQR_NONE &&
        has_place(&m->vertices[aqr_pm_from(m, h)]) && !has_place(&m->vertices[aqr_pm_to(m, h)]))
      place_run(s, m, h);
  }
  return AQR_OK;
}
