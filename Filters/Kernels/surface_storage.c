/* SPDX-License-Identifier: BSD-3-Clause */
/* The arrays of the working surface, and what goes into them. */
#include "surface.h"

#include <string.h>

/* One array to be moved to a larger place. */
typedef struct move
{
  void** array;
  size_t size; /* bytes per element of the group (face, point) */
} move;

/* Moves all arrays of a group, or none. Arrays that do not exist yet are made. */
static bool grow(aqr_context* c, const move* m, unsigned n, size_t* held, size_t need)
{
  if (need <= *held)
    return true;
  void* fresh[3] = { NULL, NULL, NULL };
  size_t wanted = *held ? *held + *held / 2 : 0;
  if (wanted < need)
    wanted = need;
  bool all = true;
  for (unsigned i = 0; i < n; i++)
  {
    fresh[i] = aqr_alloc(c, wanted, m[i].size);
    all = all && fresh[i];
  }
  for (unsigned i = 0; i < n; i++)
  {
    if (all)
    {
      if (*m[i].array)
        memcpy(fresh[i], *m[i].array, *held * m[i].size);
      aqr_release(c, *m[i].array, *held, m[i].size);
      *m[i].array = fresh[i];
    }
    else
      aqr_release(c, fresh[i], wanted, m[i].size);
  }
  if (all)
    *held = wanted;
  return all;
}

bool aqr_surface_reserve_faces(aqr_context* c, aqr_surface* s, size_t need)
{
  move m[3] = { { (void**)&s->corner, 3 * sizeof *s->corner }, { (void**)&s->twin, 3 * sizeof *s->twin },
    { (void**)&s->source, sizeof *s->source } };
  return grow(c, m, 3, &s->faces_held, need);
}

bool aqr_surface_reserve_points(aqr_context* c, aqr_surface* s, size_t need)
{
  move m[3] = { { (void**)&s->points, 3 * sizeof *s->points }, { (void**)&s->fan, sizeof *s->fan },
    { (void**)&s->clean, sizeof *s->clean } };
  return grow(c, m, 3, &s->points_held, need);
}

bool aqr_surface_reserve_origins(aqr_context* c, aqr_surface* s, size_t need)
{
  move m[1] = { { (void**)&s->origin, sizeof *s->origin } };
  return grow(c, m, 1, &s->origins_held, need);
}

aqr_origin aqr_origin_of(const aqr_surface* s, size_t v)
{
  aqr_index p = s->origin[v];
  if (p & AQR_BETWEEN)
    return s->between[p & ~AQR_BETWEEN];
  return (aqr_origin){ { p, p, p }, { 1, 0, 0 }, s->source[aqr_face_of(s->fan[v])] };
}

bool aqr_surface_put_between(aqr_context* c, aqr_surface* s, size_t v, const aqr_origin* origin)
{
  if (!AQR_RESERVE(c, s->between, s->between_capacity, s->n_between + 1))
    return false;
  s->origin[v] = AQR_BETWEEN | (aqr_index)s->n_between;
  s->between[s->n_between++] = *origin;
  return true;
}

aqr_origin aqr_origin_between(const aqr_surface* s, aqr_index a, aqr_index b, double t, aqr_index triangle)
{
  const aqr_origin ends[2] = { aqr_origin_of(s, a), aqr_origin_of(s, b) };
  aqr_index first = ends[0].point[0];
  aqr_origin r = { { first, first, first }, { 0, 0, 0 }, triangle };
  unsigned n = 0;
  for (unsigned k = 0; k < 6; k++)
  {
    const aqr_origin* o = &ends[k / 3];
    double share = (k < 3 ? 1 - t : t) * (double)o->weight[k % 3];
    unsigned j = 0;
    while (j < n && r.point[j] != o->point[k % 3])
      j++;
    if (!(share > 0) || j == 3)
      continue;
    if (j == n)
      r.point[n++] = o->point[k % 3];
    r.weight[j] += (float)share;
  }
  return r;
}

void aqr_surface_free(aqr_context* c, aqr_surface* s)
{
  AQR_DROP(c, s->corner, 3 * s->faces_held);
  AQR_DROP(c, s->twin, 3 * s->faces_held);
  AQR_DROP(c, s->source, s->faces_held);
  AQR_DROP(c, s->locked, 3 * s->n_faces);
  AQR_DROP(c, s->mirrored, s->n_clean);
  AQR_DROP(c, s->points, 3 * s->points_held);
  AQR_DROP(c, s->fan, s->points_held);
  AQR_DROP(c, s->clean, s->points_held);
  AQR_DROP(c, s->origin, s->origins_held);
  AQR_DROP(c, s->between, s->between_capacity);
  memset(s, 0, sizeof *s);
}

aqr_status aqr_surface_copy(aqr_context* c, const aqr_surface* from, aqr_surface* to)
{
  memset(to, 0, sizeof *to);
  if (!aqr_surface_reserve_faces(c, to, from->n_faces) || !aqr_surface_reserve_points(c, to, from->n_points) ||
      !aqr_surface_reserve_origins(c, to, from->n_clean) ||
      !AQR_RESERVE(c, to->between, to->between_capacity, from->n_between) ||
      (from->mirrored && !(to->mirrored = AQR_NEW(c, uint8_t, from->n_clean))))
  {
    to->n_clean = from->n_clean;
    aqr_surface_free(c, to);
    return AQR_OUT_OF_MEMORY;
  }
  memcpy(to->corner, from->corner, 3 * from->n_faces * sizeof *to->corner);
  memcpy(to->twin, from->twin, 3 * from->n_faces * sizeof *to->twin);
  memcpy(to->source, from->source, from->n_faces * sizeof *to->source);
  memcpy(to->points, from->points, 3 * from->n_points * sizeof *to->points);
  memcpy(to->fan, from->fan, from->n_points * sizeof *to->fan);
  memcpy(to->clean, from->clean, from->n_points * sizeof *to->clean);
  memcpy(to->origin, from->origin, from->n_clean * sizeof *to->origin);
  if (from->n_between)
    memcpy(to->between, from->between, from->n_between * sizeof *to->between);
  if (from->mirrored)
    memcpy(to->mirrored, from->mirrored, from->n_clean);
  to->n_faces = from->n_faces;
  to->n_points = from->n_points;
  to->n_clean = from->n_clean;
  to->n_between = from->n_between;
  to->centre = from->centre;
  to->diagonal = from->diagonal;
  return AQR_OK;
}
