/* SPDX-License-Identifier: BSD-3-Clause */
/* Three-vectors by value, for readable kernels. */
#ifndef AQR_VECTOR_H
#define AQR_VECTOR_H

#include <math.h>

typedef struct vec3
{
  double x, y, z;
} vec3;

/* As fmin and fmax, which are calls where NaN counts; here a NaN is taken only from the first. */
static inline double lesser(double a, double b)
{
  return b < a ? b : a;
}
static inline double greater(double a, double b)
{
  return b > a ? b : a;
}

static inline vec3 v3(double x, double y, double z)
{
  return (vec3){ x, y, z };
}
static inline vec3 v3_load(const double* p)
{
  return (vec3){ p[0], p[1], p[2] };
}
static inline vec3 v3_widen(const float* p)
{
  return v3((double)p[0], (double)p[1], (double)p[2]);
}
static inline void v3_narrow(float* p, vec3 a)
{
  p[0] = (float)a.x;
  p[1] = (float)a.y;
  p[2] = (float)a.z;
}
static inline void v3_store(double* p, vec3 a)
{
  p[0] = a.x;
  p[1] = a.y;
  p[2] = a.z;
}
static inline vec3 v3_add(vec3 a, vec3 b)
{
  return (vec3){ a.x + b.x, a.y + b.y, a.z + b.z };
}
static inline vec3 v3_sub(vec3 a, vec3 b)
{
  return (vec3){ a.x - b.x, a.y - b.y, a.z - b.z };
}
static inline vec3 v3_scale(vec3 a, double s)
{
  return (vec3){ s * a.x, s * a.y, s * a.z };
}
/* a + s b */
static inline vec3 v3_madd(vec3 a, double s, vec3 b)
{
  return (vec3){ a.x + s * b.x, a.y + s * b.y, a.z + s * b.z };
}
static inline double v3_dot(vec3 a, vec3 b)
{
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
static inline vec3 v3_cross(vec3 a, vec3 b)
{
  return (vec3){ a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x };
}
static inline double v3_norm2(vec3 a)
{
  return v3_dot(a, a);
}
static inline double v3_norm(vec3 a)
{
  return sqrt(v3_dot(a, a));
}
/* The unit vector along a; the zero vector where a has no direction. */
static inline vec3 v3_unit(vec3 a)
{
  double n = v3_norm(a);
  return n > 0 ? v3_scale(a, 1 / n) : (vec3){ 0, 0, 0 };
}
/* The unit vector along a, or `otherwise` where a has no direction or next to none. */
static inline vec3 v3_unit_or(vec3 a, vec3 otherwise)
{
  double n = v3_norm(a);
  return n > 1e-12 ? v3_scale(a, 1 / n) : otherwise;
}
/* The part of a orthogonal to the unit vector n. */
static inline vec3 v3_reject(vec3 a, vec3 n)
{
  return v3_madd(a, -v3_dot(a, n), n);
}

static inline double v3_segment_distance2(vec3 p, vec3 a, vec3 b)
{
  vec3 ab = v3_sub(b, a), ap = v3_sub(p, a);
  double n = v3_norm2(ab), t = n > 0 ? lesser(1, greater(0, v3_dot(ap, ab) / n)) : 0;
  return v3_norm2(v3_madd(ap, -t, ab));
}

static inline double radians(double degrees)
{
  return degrees * 0.017453292519943295;
}

#endif
