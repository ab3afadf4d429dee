/* SPDX-License-Identifier: BSD-3-Clause */
#include "closest.h"

enum
{
  most_around = 256 /* faces looked at around a vertex */
};

/* 0 in triangles so small that products of their edges underflow. */
static double share(double part, double whole)
{
  return whole > 0 ? part / whole : 0;
}

/* The barycentric coordinates of the point of triangle abc closest to p, by the regions of its plane (Ericson,
 * Real-Time Collision Detection, 5.1.5). */
static inline vec3 shares_of_nearest(vec3 a, vec3 b, vec3 c, vec3 p)
{
  vec3 ab = v3_sub(b, a), ac = v3_sub(c, a), ap = v3_sub(p, a), bp = v3_sub(p, b), cp = v3_sub(p, c);
  double d1 = v3_dot(ab, ap), d2 = v3_dot(ac, ap), d3 = v3_dot(ab, bp), d4 = v3_dot(ac, bp);
  double d5 = v3_dot(ab, cp), d6 = v3_dot(ac, cp), v, w;
  double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
  if (va > 0 && vb > 0 && vc > 0) /* inside, as mostly */
  {
    double sum = va + vb + vc;
    v = share(vb, sum);
    w = share(vc, sum);
  }
  else if (d1 <= 0 && d2 <= 0)
    v = w = 0;
  else if (d3 >= 0 && d4 <= d3)
  {
    v = 1;
    w = 0;
  }
  else if (vc <= 0 && d1 >= 0 && d3 <= 0)
  {
    v = share(d1, d1 - d3);
    w = 0;
  }
  else if (d6 >= 0 && d5 <= d6)
  {
    v = 0;
    w = 1;
  }
  else if (vb <= 0 && d2 >= 0 && d6 <= 0)
  {
    v = 0;
    w = share(d2, d2 - d6);
  }
  else if (va <= 0 && d4 >= d3 && d5 >= d6)
  {
    w = share(d4 - d3, (d4 - d3) + (d5 - d6));
    v = 1 - w;
  }
  else
  {
    double sum = va + vb + vc;
    v = share(vb, sum);
    w = share(vc, sum);
  }
  double u = v == 0 ? 1 - w : w == 0 ? 1 - v : greater(0, 1 - v - w);
  return v3(v + w >= 1 ? 0 : u, v, w);
}

static inline vec3 combine(vec3 a, vec3 b, vec3 c, vec3 shares)
{
  return v3_madd(v3_madd(a, shares.y, v3_sub(b, a)), shares.z, v3_sub(c, a));
}

double aqr_triangle_distance2(vec3 a, vec3 b, vec3 c, vec3 p)
{
  return v3_norm2(v3_sub(p, combine(a, b, c, shares_of_nearest(a, b, c, p))));
}

/* Takes the point of a face closest to p where it is nearer than the best so far. */
static void keep_nearer(const aqr_surface* s, aqr_index f, vec3 p, aqr_closest* best)
{
  vec3 a = aqr_point(s, s->corner[3 * f]), b = aqr_point(s, s->corner[3 * f + 1]),
       c = aqr_point(s, s->corner[3 * f + 2]);
  vec3 shares = shares_of_nearest(a, b, c, p), nearest = combine(a, b, c, shares);
  double distance2 = v3_norm2(v3_sub(p, nearest));
  if (distance2 < best->distance2)
    *best = (aqr_closest){ { f, { shares.x, shares.y, shares.z } }, nearest, distance2 };
}

static aqr_index other_side(const aqr_surface* s, aqr_index h, bool over_seams)
{
  return over_seams ? aqr_any_twin(s, h) : aqr_twin(s, h);
}

/* The nearest of the faces around the start of h. */
static void around(const aqr_surface* s, aqr_index h, vec3 p, bool over_seams, aqr_closest* best)
{
  aqr_index k = other_side(s, aqr_prev(h), over_seams);
  for (unsigned i = 0; i < most_around && k != AQR_NONE && k != h; i++)
  {
    keep_nearer(s, aqr_face_of(k), p, best);
    k = other_side(s, aqr_prev(k), over_seams);
  }
  if (k == h)
    return;
  k = other_side(s, h, over_seams); /* met a border: the other way round */
  for (unsigned i = 0; i < most_around && k != AQR_NONE; i++)
  {
    k = aqr_next(k);
    keep_nearer(s, aqr_face_of(k), p, best);
    k = other_side(s, k, over_seams);
  }
}

void aqr_closest_near(
  const aqr_surface* s, aqr_index start, vec3 p, unsigned most_steps, bool over_seams, aqr_closest* r)
{
  *r = (aqr_closest){ { start, { 1, 0, 0 } }, aqr_point(s, s->corner[3 * start]), INFINITY };
  keep_nearer(s, start, p, r);
  for (unsigned step = 0; step < most_steps; step++)
  {
    aqr_index f = r->place.face;
    unsigned zeros = 0, corner = 0, opposite = 0;
    for (unsigned i = 0; i < 3; i++)
      if (r->place.bary[i] == 0)
      {
        zeros++;
        opposite = i;
      }
      else
        corner = i;
    if (zeros == 0)
      break;
    if (zeros == 1)
    {
      aqr_index t = other_side(s, 3 * f + (opposite + 1) % 3, over_seams);
      if (t != AQR_NONE)
        keep_nearer(s, aqr_face_of(t), p, r);
    }
    else
      around(s, 3 * f + corner, p, over_seams, r);
    if (r->place.face == f)
      break;
  }
}

aqr_place aqr_place_in(const aqr_surface* s, aqr_index f, vec3 p, double least)
{
  aqr_place at = { f, { 0, 0, 0 } };
  vec3 n = aqr_face_cross(s, f);
  double sum = 0;
  for (unsigned i = 0; i < 3; i++)
  {
    vec3 a = aqr_point(s, s->corner[3 * f + (i + 1) % 3]), b = aqr_point(s, s->corner[3 * f + (i + 2) % 3]);
    at.bary[i] = fmax(least * v3_norm2(n), v3_dot(n, v3_cross(v3_sub(a, p), v3_sub(b, p))));
    sum += at.bary[i];
  }
  for (unsigned i = 0; i < 3; i++)
    at.bary[i] = sum > 0 ? at.bary[i] / sum : 1.0 / 3;
  return at;
}
