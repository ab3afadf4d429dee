/* SPDX-License-Identifier: BSD-3-Clause */
/* Triangle meshes whose topology is known: sheets, solids, handles, a strip with a half twist. */
#ifndef AQR_TEST_SOLIDS_H
#define AQR_TEST_SOLIDS_H

#include "shapes.h"

#include <string.h>

static inline vec3 place_on_plane(double u, double v)
{
  return v3(u, v, 0);
}
static inline vec3 place_on_strip(double u, double v)
{
  return v3(u, 0.2 * v, 0);
}
static inline vec3 place_on_saddle(double u, double v)
{
  double x = 2 * u - 1, y = 2 * v - 1;
  return v3(x, y, 0.5 * (x * x - y * y));
}

/* Changes every point. */
static inline void shape_map(shape* m, vec3 (*to)(vec3))
{
  for (size_t i = 0; i < m->n_points; i++)
    v3_store(m->points + 3 * i, to(v3_load(m->points + 3 * i)));
}

static inline shape shape_sphere(size_t n, unsigned seed)
{
  return shape_ellipsoid(n, 0.3, seed, v3(1, 1, 1));
}

/* From the sphere of the lattice cube back to the cube: regular on each side. */
static inline vec3 sphere_to_cube(vec3 p)
{
  const double scale = 1.27323954473516268, most = fmax(fabs(p.x), fmax(fabs(p.y), fabs(p.z)));
  return v3(scale * atan(p.x / most), scale * atan(p.y / most), scale * atan(p.z / most));
}
static inline vec3 cube_to_can(vec3 p)
{
  double r = hypot(p.x, p.y), m = fmax(fabs(p.x), fabs(p.y)), k = r > 0 ? m / r : 0;
  return v3(0.5 * k * p.x, 0.5 * k * p.y, p.z);
}
static inline shape shape_cube(size_t n, double jitter, unsigned seed)
{
  shape m = shape_ellipsoid(n, jitter, seed, v3(1, 1, 1));
  shape_map(&m, sphere_to_cube);
  return m;
}
/* A cylinder with two flat caps and sharp rims. */
static inline shape shape_can(size_t n, unsigned seed)
{
  shape m = shape_cube(n, 0.2, seed);
  shape_map(&m, cube_to_can);
  return m;
}

/* A strip whose end is joined to its beginning upside down. */
static inline shape shape_moebius(size_t nu, size_t nv, unsigned seed)
{
  shape m = { 0 };
  size_t w = nv + 1;
  unsigned state = seed;
  m.points = malloc(3 * nu * w * sizeof *m.points);
  m.triangles = malloc(6 * nu * nv * sizeof *m.triangles);
  for (size_t i = 0; i < nu; i++)
    for (size_t j = 0; j < w; j++, m.n_points++)
    {
      double a = shape_turn * (double)i / (double)nu, b = 0.6 * ((double)j / (double)nv - 0.5);
      double q = 1 + b * cos(a / 2);
      v3_store(m.points + 3 * m.n_points, v3(q * cos(a), q * sin(a), b * sin(a / 2)));
    }
  for (size_t i = 0; i < nu; i++)
    for (size_t j = 0; j < nv; j++)
    {
      bool last = i + 1 == nu;
      size_t c = last ? nv - j - 1 : (i + 1) * w + j + 1, d = last ? nv - j : (i + 1) * w + j;
      shape_quad(&m, (size_t[4]){ i * w + j, d, c, i * w + j + 1 }, &state);
    }
  return m;
}

/* A plate of cells a side `n` lattice steps long with a row of square holes through it, rounded by averaging: a closed
 * surface with as many handles as holes. */
static inline shape shape_plate(size_t holes, size_t n, int rounding, unsigned seed)
{
  const size_t size[3] = { (2 * holes + 1) * n, 3 * n, n };
  const size_t w[3] = { size[0] + 1, size[1] + 1, size[2] + 1 }, lattice = w[0] * w[1] * w[2];
  shape m = { 0 };
  unsigned state = seed;
  size_t* at = malloc(lattice * sizeof *at);
  m.points = malloc(3 * lattice * sizeof *m.points);
  m.triangles = malloc(36 * size[0] * size[1] * size[2] * sizeof *m.triangles);
  memset(at, 0xff, lattice * sizeof *at);
  for (size_t k = 0; k < size[0] * size[1] * size[2] * 6; k++)
  {
    size_t side = k % 6, cell = k / 6, axis = side / 2;
    size_t x[3] = { cell % size[0], cell / size[0] % size[1], cell / size[0] / size[1] };
    size_t y[3] = { x[0], x[1], x[2] };
    y[axis] += side % 2 ? 1 : (size_t)-1;
    const size_t* z[2] = { x, y };
    bool solid[2];
    for (int i = 0; i < 2; i++)
      solid[i] =
        z[i][0] < size[0] && z[i][1] < size[1] && z[i][2] < size[2] && !(z[i][1] / n == 1 && z[i][0] / n % 2 == 1);
    if (!solid[0] || solid[1])
      continue;
    size_t quad[4];
    for (size_t i = 0; i < 4; i++)
    {
      size_t p[3] = { x[0], x[1], x[2] }, turn = side % 2 ? i : 3 - i;
      p[axis] += side % 2;
      p[(axis + 1) % 3] += turn == 1 || turn == 2;
      p[(axis + 2) % 3] += turn >= 2;
      size_t corner = p[0] + w[0] * (p[1] + w[1] * p[2]);
      if (at[corner] == (size_t)-1)
      {
        at[corner] = m.n_points;
        v3_store(m.points + 3 * m.n_points++, v3((double)p[0], (double)p[1], (double)p[2]));
      }
      quad[i] = at[corner];
    }
    shape_quad(&m, quad, &state);
  }
  double* sum = malloc(4 * m.n_points * sizeof *sum);
  for (int r = 0; r < rounding; r++)
  {
    memset(sum, 0, 4 * m.n_points * sizeof *sum);
    for (size_t i = 0; i < 3 * m.n_triangles; i++)
    {
      size_t a = (size_t)m.triangles[i], b = (size_t)m.triangles[i % 3 == 2 ? i - 2 : i + 1];
      for (size_t j = 0; j < 3; j++)
        sum[4 * a + j] += m.points[3 * b + j];
      sum[4 * a + 3]++;
    }
    for (size_t v = 0; v < m.n_points; v++)
      for (size_t j = 0; j < 3; j++)
        m.points[3 * v + j] = (m.points[3 * v + j] + sum[4 * v + j] / sum[4 * v + 3]) / 2;
  }
  free(sum);
  free(at);
  return m;
}

#endif
