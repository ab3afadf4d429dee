/* SPDX-License-Identifier: BSD-3-Clause */
#include "borders.h"

#include "closest.h"

enum
{
  most_around = 4096 /* faces turned over around a vertex */
};

/* A place on the border: fraction t of a boundary half-edge. */
typedef struct spot
{
  aqr_index h;
  double t;
} spot;

static bool has_place(const aqr_vertex* v)
{
  return v->place.bary[0] + v->place.bary[1] + v->place.bary[2] > 0;
}

/* The boundary half-edge that starts where h starts or, turning clockwise over seams, would. */
static aqr_index border_from(const aqr_surface* s, aqr_index h)
{
  for (unsigned i = 0; i < most_around && !aqr_is_boundary(s, h); i++)
    h = aqr_next(aqr_any_twin(s, h));
  return aqr_is_boundary(s, h) ? h : AQR_NONE;
}

static spot spot_of(const aqr_surface* s, const aqr_place* at)
{
  unsigned largest = 0;
  for (unsigned i = 0; i < 3; i++)
  {
    aqr_index h = 3 * at->face + i;
    if (at->bary[(i + 2) % 3] == 0 && at->bary[i] > 0 && at->bary[(i + 1) % 3] > 0 && aqr_is_boundary(s, h))
      return (spot){ h, at->bary[(i + 1) % 3] };
    if (at->bary[i] > at->bary[largest])
      largest = i;
  }
  return (spot){ border_from(s, 3 * at->face + largest), 0 };
}

static double length_of(const aqr_surface* s, aqr_index h)
{
  return v3_norm(v3_sub(aqr_point(s, aqr_to(s, h)), aqr_point(s, aqr_from(s, h))));
}

/* Goes along the border from a to b, all the way around where they are the same. With `distance` below the way's length
 * stops there. Returns the length gone, negative where b was not met. */
static double walk(const aqr_surface* s, spot a, spot b, double distance, spot* end)
{
  double gone = 0;
  for (size_t steps = 0; steps <= 3 * s->n_faces; steps++)
  {
    double length = length_of(s, a.h);
    bool last = a.h == b.h && (steps > 0 || b.t > a.t);
    double piece = ((last ? b.t : 1) - a.t) * length;
    if (gone + piece >= distance && piece > 0)
    {
      *end = (spot){ a.h, a.t + (distance - gone) / length };
      return distance;
    }
    gone += piece;
    if (last)
    {
      *end = b;
      return gone;
    }
    a = (spot){ border_from(s, aqr_next(a.h)), 0 };
    if (a.h == AQR_NONE)
      break;
  }
  return -1;
}

static void put(const aqr_surface* s, spot at, aqr_vertex* v)
{
  v->place = (aqr_place){ aqr_face_of(at.h), { 0, 0, 0 } };
  v->place.bary[at.h % 3] = 1 - at.t;
  v->place.bary[(at.h % 3 + 1) % 3] = at.t;
  v->position = aqr_place_position(s, &v->place);
}

/* The run of unplaced vertices behind outer half-edge o, which starts at a placed one. Outer half-edges run against the
 * surface's own. */
static void place_run(const aqr_surface* s, aqr_polygon_mesh* m, aqr_index o)
{
  aqr_index k = aqr_pm_next(m, o);
  double n = 1, i = 1;
  while (!has_place(&m->vertices[aqr_pm_from(m, k)]))
  {
    n += 1;
    k = aqr_pm_next(m, k);
  }
  spot b = spot_of(s, &m->vertices[aqr_pm_from(m, o)].place), a = spot_of(s, &m->vertices[aqr_pm_from(m, k)].place),
       end = { AQR_NONE, 0 };
  double length = a.h == AQR_NONE || b.h == AQR_NONE ? -1 : walk(s, a, b, INFINITY, &end);
  if (!(length > 0))
    return;
  for (k = aqr_pm_prev(m, k); k != o; k = aqr_pm_prev(m, k), i += 1)
    if (walk(s, a, b, length * i / n, &end) >= 0)
      put(s, end, &m->vertices[aqr_pm_from(m, k)]);
}

aqr_status aqr_place_on_borders(aqr_context* c, const aqr_surface* s, aqr_polygon_mesh* m)
{
  for (aqr_index o = 0; o < m->n_half_edges; o++)
  {
    if (o % 65536 == 0 && !aqr_step(c, 0))
      return AQR_CANCELLED;
    if (aqr_pm_edge_lives(m, o) && aqr_pm_face(m, o) == AQR_NONE && has_place(&m->vertices[aqr_pm_from(m, o)]) &&
        !has_place(&m->vertices[aqr_pm_to(m, o)]))
      place_run(s, m, o);
  }
  return AQR_OK;
}
