/* SPDX-License-Identifier: BSD-3-Clause */
/* Closest points on the working surface by walking over it, never through space to another sheet. */
#ifndef AQR_CLOSEST_H
#define AQR_CLOSEST_H

#include "polygon_mesh.h"
#include "surface.h"

typedef struct aqr_closest
{
  aqr_place place;
  vec3 position;
  double distance2;
} aqr_closest;

/* From face `start` to neighbouring faces as long as they are nearer to p, at most most_steps of them. Seams are
 * crossed on demand, borders never. *r is filled where it lies: copies of it cost as much as the look at a face. */
void aqr_closest_near(
  const aqr_surface* s, aqr_index start, vec3 p, unsigned most_steps, bool over_seams, aqr_closest* r);

/* Where p lies in face f, clamped to shares of at least `least`; the middle of a face without area. */
aqr_place aqr_place_in(const aqr_surface* s, aqr_index f, vec3 p, double least);

double aqr_triangle_distance2(vec3 a, vec3 b, vec3 c, vec3 p);

static inline vec3 aqr_place_position(const aqr_surface* s, const aqr_place* at)
{
  vec3 p = { 0, 0, 0 };
  for (unsigned i = 0; i < 3; i++)
    p = v3_madd(p, at->bary[i], aqr_point(s, s->corner[3 * at->face + i]));
  return p;
}

#endif
