/* SPDX-License-Identifier: BSD-3-Clause */
/* Small surfaces, and what scanners and careless exports do to them, driven by a fuzzer's bytes. */
#ifndef AQR_TEST_MUTATE_H
#define AQR_TEST_MUTATE_H

#include "bytes.h"

#include "../Kernels/shapes.h"

static inline vec3 mutate_on_square(double u, double v)
{
  return v3(u, v, 0);
}
static inline vec3 mutate_on_saddle(double u, double v)
{
  double x = 2 * u - 1, y = 2 * v - 1;
  return v3(x, y, x * x * x - 3 * x * y * y);
}

static inline shape mutate_surface(unsigned which, unsigned seed)
{
  switch (which)
  {
    case 0:
      return shape_ellipsoid(2 + seed % 4, 0.2, seed, v3(1, 1, 1));
    case 1:
      return shape_ellipsoid(4, 0, seed, v3(1, 0.6, 0.4));
    case 2:
      return shape_torus(2 + seed % 3, seed);
    case 3:
      return shape_cylinder(3 + seed % 5, seed);
    case 4:
      return shape_catenoid(2, seed);
    case 5:
      return shape_grid(2 + seed % 8, 6, false, false, 0, seed, mutate_on_square);
    case 6:
      return shape_grid(8, 8, false, false, 0, seed, mutate_on_saddle);
    default:
      return shape_grid(3, 1 + seed % 3, true, false, 0, seed, place_on_cylinder);
  }
}

/* A triangle far off: edges longer than a share of the diagonal are halved, so that the surface keeps its few triangles
 * and a run costs a twentieth. Every eighth surface has none. */
static inline shape mutate_base(unsigned which)
{
  shape m = mutate_surface(which % 8, which / 8 % 4);
  double far[] = { 6, 3, 10, 2, 4, 1.5, 5 };
  if (which / 32 == 7 || m.n_points == 0)
    return m;
  double* points = realloc(m.points, 3 * (m.n_points + 3) * sizeof *points);
  if (points)
    m.points = points;
  int64_t* triangles = realloc(m.triangles, 3 * (m.n_triangles + 1) * sizeof *triangles);
  if (triangles)
    m.triangles = triangles;
  for (size_t k = 0; points && triangles && k < 3; k++)
  {
    double d = far[which / 32];
    v3_store(m.points + 3 * m.n_points, v3(d + 0.1 * (k == 1), d + 0.1 * (k == 2), d));
    m.triangles[3 * m.n_triangles + k] = (int64_t)m.n_points++;
  }
  m.n_triangles += points && triangles;
  return m;
}

/* One change to the mesh; room for one more point and three more triangles must be there. */
static inline void mutate_once(shape* m, bytes* b)
{
  uint8_t kind = take_8(b) % 14;
  size_t p = take_16(b) % m->n_points, q = take_16(b) % m->n_points, t = take_16(b) % m->n_triangles;
  double* x = m->points + 3 * p;
  int64_t* corner = m->triangles + 3 * t;
  switch (kind)
  {
    case 0: /* a point lies on another */
      memcpy(x, m->points + 3 * q, 3 * sizeof *x);
      break;
    case 1: /* a triangle uses another point */
      corner[p % 3] = (int64_t)q;
      break;
    case 2: /* turned round */
    {
      int64_t swap = corner[0];
      corner[0] = corner[1];
      corner[1] = swap;
      break;
    }
    case 3: /* twice */
      memcpy(m->triangles + 3 * m->n_triangles++, corner, 3 * sizeof *corner);
      break;
    case 4: /* lost */
      memcpy(corner, m->triangles + 3 * --m->n_triangles, 3 * sizeof *corner);
      m->n_triangles += m->n_triangles == 0;
      break;
    case 5: /* any triangle */
      m->triangles[3 * m->n_triangles] = (int64_t)p;
      m->triangles[3 * m->n_triangles + 1] = (int64_t)q;
      m->triangles[3 * m->n_triangles++ + 2] = (int64_t)(take_16(b) % m->n_points);
      break;
    case 6: /* a point flies off */
      for (int k = 0; k < 3; k++)
        x[k] += (take_8(b) - 127.5) / 64;
      break;
    case 7: /* nearly on another */
      for (int k = 0; k < 3; k++)
        x[k] = m->points[3 * q + (size_t)k] + 1e-9 * take_8(b);
      break;
    case 8: /* collapsed to an edge */
      corner[0] = corner[1];
      break;
    case 9: /* a fin: a third face at an edge, with a point of its own */
      for (int k = 0; k < 3; k++)
        m->points[3 * m->n_points + (size_t)k] = x[k] + (take_8(b) - 127.5) / 128;
      m->triangles[3 * m->n_triangles] = corner[0];
      m->triangles[3 * m->n_triangles + 1] = corner[1];
      m->triangles[3 * m->n_triangles++ + 2] = (int64_t)m->n_points++;
      break;
    case 10: /* squeezed flat or stretched */
      for (size_t i = 0; i < m->n_points; i++)
        m->points[3 * i + p % 3] *= q % 2 ? 1e-4 : 30;
      break;
    case 11: /* far from the origin */
      for (size_t i = 0; i < m->n_points; i++)
        m->points[3 * i + p % 3] += 1e5;
      break;
    case 12: /* scaled */
      for (size_t i = 0; i < 3 * m->n_points; i++)
        m->points[i] *= q % 2 ? 1e-12 : 1e12;
      break;
    default: /* split at a point of its own */
      for (int k = 0; k < 3; k++)
        m->points[3 * m->n_points + (size_t)k] =
          0.999 * m->points[3 * corner[0] + k] + 0.0005 * (m->points[3 * corner[1] + k] + m->points[3 * corner[2] + k]);
      m->triangles[3 * m->n_triangles] = corner[0];
      m->triangles[3 * m->n_triangles + 1] = corner[1];
      m->triangles[3 * m->n_triangles++ + 2] = (int64_t)m->n_points;
      m->triangles[3 * m->n_triangles] = corner[1];
      m->triangles[3 * m->n_triangles + 1] = corner[2];
      m->triangles[3 * m->n_triangles++ + 2] = (int64_t)m->n_points;
      corner[1] = (int64_t)m->n_points++;
  }
}

static inline bool mutate(shape* m, bytes* b)
{
  size_t most = b->left < 400 ? b->left / 4 + 1 : 100;
  double* points = realloc(m->points, 3 * (m->n_points + most) * sizeof *points);
  if (points)
    m->points = points;
  int64_t* triangles = realloc(m->triangles, 3 * (m->n_triangles + 3 * most) * sizeof *triangles);
  if (triangles)
    m->triangles = triangles;
  if (!points || !triangles)
    return false;
  for (size_t i = 0; i < most && b->left; i++)
    mutate_once(m, b);
  return true;
}

#endif
