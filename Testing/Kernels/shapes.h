/* SPDX-License-Identifier: BSD-3-Clause */
/* Triangle meshes of surfaces whose curvature is known exactly. Points lie on the surface, moved
 * along it by up to `jitter` spacings, and diagonals are random, so that no edges follow a curvature
 * line. */
#ifndef AQR_TEST_SHAPES_H
#define AQR_TEST_SHAPES_H

#include "aqr.h"
#include "vector.h"

#include <stdbool.h>
#include <stdlib.h>

typedef struct shape
{
  size_t n_points, n_triangles;
  double* points;
  int64_t* triangles;
} shape;

static inline void shape_free(shape* m)
{
  free(m->points);
  free(m->triangles);
  *m = (shape){ 0 };
}

static inline aqr_input shape_input(const shape* m)
{
  return (aqr_input){ .number_of_points = m->n_points,
    .points_d = m->points,
    .number_of_triangles = m->n_triangles,
    .triangles = m->triangles };
}

/* Uniform in [0, 1). */
static inline double shape_random(unsigned* state)
{
  *state = *state * 1664525u + 1013904223u;
  return (double)(*state >> 8) / 16777216.0;
}

static inline void shape_quad(shape* m, const size_t quad[4], unsigned* state)
{
  size_t k = shape_random(state) < 0.5;
  int64_t* t = m->triangles + 3 * m->n_triangles;
  for (size_t i = 0; i < 3; i++)
  {
    t[i] = (int64_t)quad[(k + i) % 4];
    t[3 + i] = (int64_t)quad[(k + (i ? i + 1 : 0)) % 4];
  }
  m->n_triangles += 2;
}

/* nu by nv quads, halved, with the points at place(u, v), where u and v in [0, 1] wrap or end. */
static inline shape shape_grid(
  size_t nu, size_t nv, bool wrap_u, bool wrap_v, double jitter, unsigned seed, vec3 (*place)(double, double))
{
  size_t wu = wrap_u ? nu : nu + 1, wv = wrap_v ? nv : nv + 1;
  shape m = { 0 };
  m.points = malloc(3 * wu * wv * sizeof *m.points);
  m.triangles = malloc(6 * nu * nv * sizeof *m.triangles);
  unsigned state = seed;
  for (size_t i = 0; i < wu; i++)
    for (size_t j = 0; j < wv; j++, m.n_points++)
    {
      double du = jitter * (2 * shape_random(&state) - 1), dv = jitter * (2 * shape_random(&state) - 1);
      if (!wrap_u && (i == 0 || i == nu))
        du = 0;
      if (!wrap_v && (j == 0 || j == nv))
        dv = 0;
      v3_store(m.points + 3 * m.n_points, place(((double)i + du) / (double)nu, ((double)j + dv) / (double)nv));
    }
  for (size_t i = 0; i < nu; i++)
    for (size_t j = 0; j < nv; j++)
    {
      size_t a = i * wv, b = (i + 1) % wu * wv, next = (j + 1) % wv;
      shape_quad(&m, (size_t[4]){ a + j, b + j, b + next, a + next }, &state);
    }
  return m;
}

/* An ellipsoid around 0 from the surface of a lattice cube of n cells a side: 6 n^2 + 2 points. */
static inline shape shape_ellipsoid(size_t n, double jitter, unsigned seed, vec3 axes)
{
  size_t w = n + 1;
  shape m = { 0 };
  m.points = malloc(3 * (6 * n * n + 2) * sizeof *m.points);
  m.triangles = malloc(36 * n * n * sizeof *m.triangles);
  size_t* at = malloc(w * w * w * sizeof *at);
  unsigned state = seed;
  for (size_t k = 0; k < w * w * w; k++)
  {
    size_t x[3] = { k / (w * w), k / w % w, k % w };
    if (x[0] % n && x[1] % n && x[2] % n)
      continue;
    double p[3];
    for (int i = 0; i < 3; i++)
    {
      double moved = x[i] % n ? (double)x[i] + jitter * (2 * shape_random(&state) - 1) : (double)x[i];
      p[i] = tan((moved / (double)n - 0.5) * 1.57079632679489662);
    }
    vec3 q = v3_unit(v3_load(p));
    at[k] = m.n_points;
    v3_store(m.points + 3 * m.n_points++, v3(q.x * axes.x, q.y * axes.y, q.z * axes.z));
  }
  for (int axis = 0; axis < 3; axis++)
    for (size_t i = 0; i < n; i++)
      for (size_t j = 0; j < n; j++)
      {
        const size_t step[3] = { w * w, w, 1 };
        size_t u = step[(axis + 1) % 3], v = step[(axis + 2) % 3], low = i * u + j * v, high = low + n * step[axis];
        shape_quad(&m, (size_t[4]){ at[high], at[high + u], at[high + u + v], at[high + v] }, &state);
        shape_quad(&m, (size_t[4]){ at[low], at[low + v], at[low + u + v], at[low + u] }, &state);
      }
  free(at);
  return m;
}

static const double shape_turn = 6.28318530717958648;

static inline vec3 place_on_torus(double u, double v)
{
  double s = shape_turn * u, t = shape_turn * v, q = 1 + 0.4 * cos(t);
  return v3(q * cos(s), q * sin(s), 0.4 * sin(t));
}
static inline vec3 place_on_cylinder(double u, double v)
{
  return v3(0.3 * cos(shape_turn * u), 0.3 * sin(shape_turn * u), v);
}
static inline vec3 place_on_catenoid(double u, double v)
{
  double z = 2 * v - 1;
  return v3(cosh(z) * cos(shape_turn * u), cosh(z) * sin(shape_turn * u), z);
}

static inline shape shape_torus(size_t n, unsigned seed)
{
  return shape_grid(5 * n, 2 * n, true, true, 0.3, seed, place_on_torus);
}
static inline shape shape_cylinder(size_t n, unsigned seed)
{
  return shape_grid(2 * n, n, true, false, 0.3, seed, place_on_cylinder);
}
static inline shape shape_catenoid(size_t n, unsigned seed)
{
  return shape_grid(5 * n, 2 * n, true, false, 0.3, seed, place_on_catenoid);
}

/* The outward gradient of an implicit function of each surface. */
static inline vec3 torus_gradient(vec3 p)
{
  double q = hypot(p.x, p.y), a = 1 - 1 / q;
  return v3(a * p.x, a * p.y, p.z);
}
static inline vec3 cylinder_gradient(vec3 p)
{
  return v3(p.x, p.y, 0);
}
static inline vec3 catenoid_gradient(vec3 p)
{
  return v3(p.x, p.y, -0.5 * sinh(2 * p.z));
}
static inline vec3 sphere_gradient(vec3 p)
{
  return p;
}
static inline vec3 ellipsoid_gradient(vec3 p) /* of axes 1, 0.6, 0.4 */
{
  return v3(p.x, p.y / 0.36, p.z / 0.16);
}

typedef struct shape_curvature
{
  vec3 normal, min_direction;
  double k_min, k_max; /* positive on a sphere */
} shape_curvature;

/* The symmetric 2x2 matrix a b; b d over a tangent basis u, v: its eigenvalues and the direction of
 * the smaller. */
static inline shape_curvature shape_principal(vec3 normal, vec3 u, vec3 v, double a, double b, double d)
{
  double mean = (a + d) / 2, half = hypot((a - d) / 2, b), turn = 0.5 * atan2(-b, (d - a) / 2);
  return (shape_curvature){ normal, v3_madd(v3_scale(u, cos(turn)), sin(turn), v), mean - half, mean + half };
}

static inline void shape_tangents(vec3 normal, vec3* u, vec3* v)
{
  *u = v3_unit(v3_cross(normal, fabs(normal.x) < 0.8 ? v3(1, 0, 0) : v3(0, 1, 0)));
  *v = v3_cross(normal, *u);
}

/* From how the normal turns around p, a point on the surface. */
static inline shape_curvature shape_exact(vec3 (*gradient)(vec3), vec3 p)
{
  const double h = 1e-5;
  vec3 n = v3_unit(gradient(p)), t[2], dn[2];
  shape_tangents(n, &t[0], &t[1]);
  for (int i = 0; i < 2; i++)
    dn[i] =
      v3_scale(v3_sub(v3_unit(gradient(v3_madd(p, h, t[i]))), v3_unit(gradient(v3_madd(p, -h, t[i])))), 1 / (2 * h));
  return shape_principal(n, t[0], t[1], v3_dot(dn[0], t[0]), v3_dot(dn[0], t[1]), v3_dot(dn[1], t[1]));
}

#endif
