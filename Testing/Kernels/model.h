/* SPDX-License-Identifier: BSD-3-Clause */
/* A shape and the stages built on it, for tests of single kernels. */
#ifndef AQR_TEST_MODEL_H
#define AQR_TEST_MODEL_H

#include "field.h"
#include "polygon_mesh.h"
#include "shapes.h"
#include "sizing.h"
#include "test.h"

typedef struct model
{
  shape m;
  aqr_context c;
  aqr_surface s;
  aqr_tensors t;
  aqr_field f;
  aqr_sizing z;
} model;

/* Takes the shape over. Lengths on the surface are those of the shape over `s.diagonal`. */
static inline model model_surface(shape m)
{
  aqr_report report = { 0 };
  model e = { .m = m, .c = { .end = 1 } };
  aqr_input input = shape_input(&m);
  CHECK(aqr_surface_build(&e.c, &input, 1, &e.s, &report) == AQR_OK);
  return e;
}

static inline model model_field(shape m, double radius, int iterations)
{
  model e = model_surface(m);
  CHECK(aqr_curvature_tensors(&e.c, &e.s, radius, &e.t) == AQR_OK);
  CHECK(aqr_direction_field(&e.c, &e.s, &e.t, iterations, 0.866, &e.f) == AQR_OK);
  return e;
}

static inline model model_sizing(shape m, double radius, int iterations, const double* density, double largest)
{
  model e = model_field(m, radius, iterations);
  const aqr_sizing_options sizing = { density, largest, 1000, 1, 1, 1 };
  CHECK(aqr_sizing_build(&e.c, &e.s, &e.f, &sizing, &e.z) == AQR_OK);
  return e;
}

static inline void model_free(model* e)
{
  if (e->z.bend)
    aqr_sizing_free(&e->c, &e->z);
  if (e->f.normal)
    aqr_field_free(&e->c, &e->s, &e->f);
  if (e->t.t)
    aqr_tensors_free(&e->c, &e->s, &e->t);
  aqr_surface_free(&e->c, &e->s);
  CHECK(e->c.bytes == 0);
  shape_free(&e->m);
}

/* Where the shape's coordinates p lie on the surface. */
static inline vec3 model_place(const model* e, vec3 p)
{
  return v3_scale(v3_sub(p, e->s.centre), 1 / e->s.diagonal);
}
static inline vec3 model_shape_point(const model* e, vec3 p)
{
  return v3_madd(e->s.centre, e->s.diagonal, p);
}

/* The surface's point nearest to p. */
static inline aqr_index model_point_near(const model* e, vec3 p)
{
  aqr_index best = 0;
  vec3 q = model_place(e, p);
  for (aqr_index v = 1; v < e->s.n_points; v++)
    if (v3_norm2(v3_sub(aqr_point(&e->s, v), q)) < v3_norm2(v3_sub(aqr_point(&e->s, best), q)))
      best = v;
  return best;
}

static inline aqr_place model_centre(aqr_index f)
{
  return (aqr_place){ f, { 1.0 / 3, 1.0 / 3, 1.0 / 3 } };
}

/* The face around p, of the shape's coordinates. */
static inline aqr_place model_place_at(const model* e, vec3 p)
{
  vec3 q = model_place(e, p);
  aqr_place best = model_centre(0);
  double least = -INFINITY;
  for (aqr_index f = 0; f < e->s.n_faces; f++)
  {
    vec3 n = aqr_face_cross(&e->s, f);
    double w[3], low = INFINITY;
    for (unsigned i = 0; i < 3; i++)
    {
      vec3 a = aqr_point(&e->s, e->s.corner[3 * f + (i + 1) % 3]);
      vec3 b = aqr_point(&e->s, e->s.corner[3 * f + (i + 2) % 3]);
      w[i] = v3_dot(n, v3_cross(v3_sub(a, q), v3_sub(b, q))) / v3_norm2(n);
      low = fmin(low, w[i]);
    }
    double away = fabs(v3_dot(v3_unit(n), v3_sub(q, aqr_point(&e->s, e->s.corner[3 * f]))));
    if (low - away > least)
    {
      least = low - away;
      best = (aqr_place){ f, { w[0], w[1], w[2] } };
    }
  }
  return best;
}

#endif
