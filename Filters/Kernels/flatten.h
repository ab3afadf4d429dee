/* SPDX-License-Identifier: BSD-3-Clause */
/* Directions at a face's corners as complex numbers in the plane of the face (paper 2). */
#ifndef AQR_FLATTEN_H
#define AQR_FLATTEN_H

#include "vector.h"

#include <stdbool.h>
#include <stdint.h>

typedef struct aqr_complex
{
  double x, y;
} aqr_complex;

static inline aqr_complex cx(double x, double y)
{
  return (aqr_complex){ x, y };
}
static inline aqr_complex cx_mul(aqr_complex a, aqr_complex b)
{
  return cx(a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x);
}
static inline aqr_complex cx_unit(aqr_complex a)
{
  double n = sqrt(a.x * a.x + a.y * a.y);
  return n > 0 ? cx(a.x / n, a.y / n) : cx(1, 0);
}

/* For arrays of many: unit, or zero where nothing is known. */
typedef struct aqr_rotor
{
  float x, y;
} aqr_rotor;

static inline aqr_rotor cx_narrow(aqr_complex a)
{
  return (aqr_rotor){ (float)a.x, (float)a.y };
}
static inline aqr_complex cx_wide(aqr_rotor a)
{
  return cx((double)a.x, (double)a.y);
}

/* For the arrays that lines read most: a unit number to 2e-5, in units of 1/32767. */
typedef struct aqr_short_rotor
{
  int16_t x, y;
} aqr_short_rotor;

static inline aqr_short_rotor cx_shorten(aqr_complex unit)
{
  return (aqr_short_rotor){ (int16_t)lrint(INT16_MAX * unit.x), (int16_t)lrint(INT16_MAX * unit.y) };
}

static inline bool aqr_agree(aqr_short_rotor a, aqr_short_rotor b)
{
  return (int32_t)a.x * b.x + (int32_t)a.y * b.y > 0;
}

static inline aqr_complex cx_fourth(aqr_complex a)
{
  aqr_complex b = cx_mul(a, a);
  return cx_mul(b, b);
}

/* The one nearest to 1 of a unit number's fourth roots, by halving its angle twice. */
static inline aqr_complex cx_fourth_root(aqr_complex u)
{
  for (int i = 0; i < 2; i++)
  {
    double x = greater(0, (1 + u.x) / 2), y = greater(0, (1 - u.x) / 2);
    u = cx(sqrt(x), copysign(sqrt(y), u.y));
  }
  return u;
}

/* A triangle laid into the plane: corner 0 at the origin, half-edge 0 along +x. */
static inline void aqr_lay_flat(vec3 a, vec3 b, vec3 c, aqr_complex q[3])
{
  vec3 ab = v3_sub(b, a), ac = v3_sub(c, a);
  double base = v3_norm(ab), one_over = base > 0 ? 1 / base : 0;
  q[0] = cx(0, 0);
  q[1] = cx(base, 0);
  q[2] = cx(v3_dot(ab, ac) * one_over, v3_norm(v3_cross(ab, ac)) * one_over);
}

/* A tangent direction at a corner with normal n as a unit complex number in a plane where the edges
 * leaving the corner lie along to_next and to_prev: measured from the edge nearer to the tangent
 * plane. */
static inline aqr_complex aqr_flatten(
  vec3 n, vec3 direction, vec3 next, vec3 prev, aqr_complex to_next, aqr_complex to_prev)
{
  double a = v3_dot(next, n), b = v3_dot(prev, n);
  bool use_next = a * a * v3_norm2(prev) <= b * b * v3_norm2(next);
  vec3 p = v3_reject(use_next ? next : prev, n);
  aqr_complex xi = cx(v3_dot(p, direction), v3_dot(n, v3_cross(p, direction)));
  return cx_unit(cx_mul(use_next ? to_next : to_prev, xi));
}

#endif
