/* SPDX-License-Identifier: BSD-3-Clause */
/* The surface of the benchmarks: curvature varies along and across it. */
#ifndef AQR_BUMPY_TORUS_H
#define AQR_BUMPY_TORUS_H

#include "aqr.h"

#include <math.h>
#include <stdlib.h>

typedef struct bumpy_torus
{
  size_t n_points, n_faces;
  double* points;
  int64_t* triangles;
} bumpy_torus;

/* About `faces` of them; the arrays are NULL where memory ran out. */
static inline bumpy_torus bumpy_torus_make(double faces)
{
  const double full_turn = 6.283185307179586;
  const size_t across = (size_t)fmax(8, sqrt(faces / 6)), around = 3 * across;
  bumpy_torus m = { .n_points = around * across, .n_faces = 2 * around * across };
  m.points = malloc(3 * m.n_points * sizeof *m.points);
  m.triangles = malloc(3 * m.n_faces * sizeof *m.triangles);
  for (size_t i = 0; m.points && m.triangles && i < around; i++)
    for (size_t j = 0; j < across; j++)
    {
      const double u = full_turn * (double)i / (double)around, v = full_turn * (double)j / (double)across;
      const double tube = 1 + 0.2 * cos(5 * u) + 0.1 * sin(4 * v);
      double* p = m.points + 3 * (i * across + j);
      p[0] = (3 + tube * cos(v)) * cos(u);
      p[1] = (3 + tube * cos(v)) * sin(u);
      p[2] = tube * sin(v);

      const size_t next_i = (i + 1) % around, next_j = (j + 1) % across;
      const int64_t a = (int64_t)(i * across + j), b = (int64_t)(next_i * across + j);
      const int64_t c = (int64_t)(next_i * across + next_j), d = (int64_t)(i * across + next_j);
      int64_t* t = m.triangles + 6 * (i * across + j);
      t[0] = a, t[1] = b, t[2] = c;
      t[3] = a, t[4] = c, t[5] = d;
    }
  return m;
}

static inline aqr_input bumpy_torus_input(const bumpy_torus* m)
{
  return (aqr_input){
    .number_of_points = m->n_points, .points_d = m->points, .number_of_triangles = m->n_faces, .triangles = m->triangles
  };
}

static inline void bumpy_torus_free(bumpy_torus* m)
{
  free(m->points);
  free(m->triangles);
}

#endif
