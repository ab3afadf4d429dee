/* SPDX-License-Identifier: BSD-3-Clause */
#include "fit.h"

#include "borders.h"
#include "closest.h"

enum
{
  most_steps = 512, /* faces walked from a corner of a polygon to below a sample of it */
  solver_steps = 24,
  damp_rounds = 6,
  samples = 6
};

static const double regularization = 1e-3; /* relative to the diagonal */
static const double farthest_move = 0.3;   /* of the shortest edge at a vertex */
static const double farthest_sample =
  0.5;                                  /* of the longest side: what is farther away is another part of the surface */
static const double least_cosine = 0.3; /* between a polygon and the surface below it */

/* Quadrature of degree four over a triangle (Dunavant 1985): squared distances from a quadratic surface are exact. */
static const double barycentric[samples][3] = { { 0.108103018168070, 0.445948490915965, 0.445948490915965 },
  { 0.445948490915965, 0.108103018168070, 0.445948490915965 },
  { 0.445948490915965, 0.445948490915965, 0.108103018168070 },
  { 0.816847572980459, 0.091576213509771, 0.091576213509771 },
  { 0.091576213509771, 0.816847572980459, 0.091576213509771 },
  { 0.091576213509771, 0.091576213509771, 0.816847572980459 } };
static const double weight[samples] = { 0.223381589678011, 0.223381589678011, 0.223381589678011, 0.109951743655322,
  0.109951743655322, 0.109951743655322 };

/* A triangle of a polygon and its part of the normal equations. */
typedef struct triangle
{
  aqr_index v[3];
  double matrix[6]; /* 00 11 22 01 02 12 */
  double right[3];
} triangle;

typedef struct fit
{
  const aqr_surface* s;
  aqr_polygon_mesh* m;
  size_t n_triangles;
  size_t* first; /* per face: its first triangle; n_faces + 1 */
  triangle* triangles;
  size_t* first_corner; /* per vertex, into `corners`; n_vertices + 2 */
  aqr_index* corners;   /* 3 * triangle + corner */
  double *move, *residual, *direction, *image, *diagonal;
} fit;

static void snap(void* data, size_t begin, size_t end)
{
  fit* f = data;
  for (size_t v = begin; v < end; v++)
  {
    aqr_vertex* x = &f->m->vertices[v];
    bool placed = x->place.bary[0] + x->place.bary[1] + x->place.bary[2] > 0;
    if (x->kind != AQR_VERTEX_INTERIOR && placed)
      continue;
    aqr_closest near = aqr_closest_near(f->s, x->place.face, x->position, most_steps, true);
    x->position = near.position;
    x->place = near.place;
  }
}

/* ---- triangles ---- */

static aqr_status allocate(aqr_context* c, fit* f)
{
  const aqr_polygon_mesh* m = f->m;
  f->first = AQR_NEW(c, size_t, m->n_faces + 1);
  if (!f->first)
    return AQR_OUT_OF_MEMORY;
  for (aqr_index i = 0; i < m->n_faces; i++)
  {
    f->first[i] = f->n_triangles;
    f->n_triangles += aqr_pm_face_size(m, i) - 2;
  }
  f->first[m->n_faces] = f->n_triangles;
  if (f->n_triangles > AQR_NONE / 3)
    return AQR_TOO_LARGE;
  size_t n = m->n_vertices;
  f->triangles = AQR_NEW(c, triangle, f->n_triangles);
  f->first_corner = AQR_NEW(c, size_t, n + 2);
  f->corners = AQR_NEW(c, aqr_index, 3 * f->n_triangles);
  f->move = AQR_NEW(c, double, n);
  f->residual = AQR_NEW(c, double, n);
  f->direction = AQR_NEW(c, double, n);
  f->image = AQR_NEW(c, double, n);
  f->diagonal = AQR_NEW(c, double, n);
  return f->triangles && f->first_corner && f->corners && f->move && f->residual && f->direction && f->image &&
             f->diagonal
           ? AQR_OK
           : AQR_OUT_OF_MEMORY;
}

static void release(aqr_context* c, fit* f)
{
  size_t n = f->m->n_vertices;
  AQR_DROP(c, f->first, f->m->n_faces + 1);
  AQR_DROP(c, f->triangles, f->n_triangles);
  AQR_DROP(c, f->first_corner, n + 2);
  AQR_DROP(c, f->corners, 3 * f->n_triangles);
  AQR_DROP(c, f->move, n);
  AQR_DROP(c, f->residual, n);
  AQR_DROP(c, f->direction, n);
  AQR_DROP(c, f->image, n);
  AQR_DROP(c, f->diagonal, n);
}

/* Fans from the first corner; quads are cut at the shorter diagonal, as renderers that care do. */
static void triangulate(void* data, size_t begin, size_t end)
{
  fit* f = data;
  const aqr_polygon_mesh* m = f->m;
  for (size_t i = begin; i < end; i++)
  {
    aqr_index h = m->faces[i];
    if (f->first[i + 1] - f->first[i] == 2)
    {
      aqr_index k = aqr_pm_next(m, h);
      vec3 a = aqr_pm_point(m, aqr_pm_from(m, h)), b = aqr_pm_point(m, aqr_pm_from(m, k));
      vec3 c = aqr_pm_point(m, aqr_pm_to(m, k)), d = aqr_pm_point(m, aqr_pm_from(m, aqr_pm_prev(m, h)));
      if (v3_norm2(v3_sub(a, c)) > v3_norm2(v3_sub(b, d)))
        h = k;
    }
    aqr_index a = aqr_pm_from(m, h);
    for (size_t t = f->first[i]; t < f->first[i + 1]; t++)
    {
      h = aqr_pm_next(m, h);
      f->triangles[t] = (triangle){ .v = { a, aqr_pm_from(m, h), aqr_pm_to(m, h) } };
    }
  }
}

static void list_corners(fit* f)
{
  size_t n = f->m->n_vertices;
  for (size_t v = 0; v < n + 2; v++)
    f->first_corner[v] = 0;
  for (size_t t = 0; t < f->n_triangles; t++)
    for (unsigned k = 0; k < 3; k++)
      f->first_corner[f->triangles[t].v[k] + 2]++;
  for (size_t v = 0; v < n; v++)
    f->first_corner[v + 2] += f->first_corner[v + 1];
  for (size_t t = 0; t < f->n_triangles; t++)
    for (unsigned k = 0; k < 3; k++)
      f->corners[f->first_corner[f->triangles[t].v[k] + 1]++] = (aqr_index)(3 * t + k);
}

/* ---- the normal equations ---- */

/* Distance from samples of each triangle to the tangent planes of the surface below them, linear in the moves of its
 * corners along their normals. */
static void measure(void* data, size_t begin, size_t end)
{
  fit* f = data;
  const aqr_surface* s = f->s;
  for (size_t i = begin; i < end; i++)
  {
    triangle* t = &f->triangles[i];
    const aqr_vertex* v[3];
    for (unsigned k = 0; k < 3; k++)
      v[k] = &f->m->vertices[t->v[k]];
    vec3 ab = v3_sub(v[1]->position, v[0]->position), ac = v3_sub(v[2]->position, v[0]->position);
    vec3 cross = v3_cross(ab, ac), normal = v3_unit(cross);
    double area = 0.5 * v3_norm(cross);
    double reach = fmax(fmax(v3_norm2(ab), v3_norm2(ac)), v3_norm2(v3_sub(ab, ac))) * farthest_sample * farthest_sample;
    for (unsigned k = 0; k < samples; k++)
    {
      const double* w = barycentric[k];
      vec3 q = v3_madd(v3_madd(v3_scale(v[0]->position, w[0]), w[1], v[1]->position), w[2], v[2]->position);
      unsigned nearest = w[0] >= w[1] && w[0] >= w[2] ? 0 : w[1] >= w[2] ? 1 : 2;
      aqr_closest below = aqr_closest_near(s, v[nearest]->place.face, q, most_steps, true);
      vec3 n = v3_unit(aqr_face_cross(s, below.place.face));
      if (!(below.distance2 < reach) || !(v3_dot(n, normal) > least_cosine))
        continue;
      double a = area * weight[k], d = v3_dot(v3_sub(below.position, q), n), g[3];
      for (unsigned j = 0; j < 3; j++)
      {
        g[j] = w[j] * v3_dot(v[j]->normal, n);
        t->right[j] += a * d * g[j];
        t->matrix[j] += a * g[j] * g[j];
      }
      t->matrix[3] += a * g[0] * g[1];
      t->matrix[4] += a * g[0] * g[2];
      t->matrix[5] += a * g[1] * g[2];
    }
  }
}

/* Sets up the diagonal and the right-hand side, and the first step of the solver. Fixed vertices have a zero row. */
static void begin_rows(void* data, size_t begin, size_t end)
{
  fit* f = data;
  for (size_t v = begin; v < end; v++)
  {
    double diagonal = 0, right = 0;
    for (size_t i = f->first_corner[v]; i < f->first_corner[v + 1]; i++)
    {
      const triangle* t = &f->triangles[f->corners[i] / 3];
      diagonal += t->matrix[f->corners[i] % 3];
      right += t->right[f->corners[i] % 3];
    }
    bool free_row = f->m->vertices[v].kind == AQR_VERTEX_INTERIOR && diagonal > 0;
    f->diagonal[v] = free_row ? (1 + regularization) * diagonal : 0;
    f->residual[v] = free_row ? right : 0;
    f->direction[v] = free_row ? right / f->diagonal[v] : 0;
    f->move[v] = 0;
  }
}

/* image = matrix * direction */
static void multiply(void* data, size_t begin, size_t end)
{
  static const unsigned char at[3][3] = { { 0, 3, 4 }, { 3, 1, 5 }, { 4, 5, 2 } };
  fit* f = data;
  for (size_t v = begin; v < end; v++)
  {
    double sum = 0;
    for (size_t i = f->first_corner[v]; f->diagonal[v] > 0 && i < f->first_corner[v + 1]; i++)
    {
      const triangle* t = &f->triangles[f->corners[i] / 3];
      unsigned k = f->corners[i] % 3;
      for (unsigned j = 0; j < 3; j++)
        sum += t->matrix[at[k][j]] * f->direction[t->v[j]];
    }
    f->image[v] = sum + regularization / (1 + regularization) * f->diagonal[v] * f->direction[v];
  }
}

/* Conjugate gradients with the diagonal as preconditioner. Sums run in the order of the vertices, so that they do not
 * depend on threads. The matrix is a mass matrix: a fixed number of steps is enough. */
static aqr_status solve(aqr_context* c, fit* f, double from, double to)
{
  aqr_status status = AQR_OK;
  size_t n = f->m->n_vertices;
  double rho = 0, first;
  AQR_TRY(aqr_parallel(c, n, begin_rows, f, from, from));
  for (size_t v = 0; v < n; v++)
    rho += f->residual[v] * f->direction[v];
  first = rho;
  for (unsigned step = 0; step < solver_steps && rho > 1e-12 * first; step++)
  {
    double fraction = from + (to - from) * step / solver_steps, energy = 0, next = 0;
    AQR_TRY(aqr_parallel(c, n, multiply, f, fraction, fraction));
    for (size_t v = 0; v < n; v++)
      energy += f->direction[v] * f->image[v];
    if (!(energy > 0))
      break;
    for (size_t v = 0; v < n; v++)
    {
      if (!(f->diagonal[v] > 0))
        continue;
      f->move[v] += rho / energy * f->direction[v];
      f->residual[v] -= rho / energy * f->image[v];
      next += f->residual[v] * f->residual[v] / f->diagonal[v];
    }
    for (size_t v = 0; v < n; v++)
      if (f->diagonal[v] > 0)
        f->direction[v] = f->residual[v] / f->diagonal[v] + next / rho * f->direction[v];
    rho = next;
  }
done:
  return status;
}

/* ---- moving ---- */

static void limit(void* data, size_t begin, size_t end)
{
  fit* f = data;
  const aqr_polygon_mesh* m = f->m;
  for (size_t v = begin; v < end; v++)
  {
    double least = INFINITY;
    aqr_index h = m->vertices[v].out;
    do
    {
      least = fmin(least, v3_norm2(v3_sub(aqr_pm_point(m, aqr_pm_to(m, h)), m->vertices[v].position)));
      h = aqr_pm_next_around(m, h);
    } while (h != m->vertices[v].out);
    double most = farthest_move * sqrt(least);
    f->move[v] = isfinite(f->move[v]) ? fmax(-most, fmin(most, f->move[v])) : 0;
  }
}

/* Halves the moves of corners whose triangle would turn against the surface, in the end to nothing. */
static void damp(fit* f)
{
  for (unsigned round = 0; round < damp_rounds; round++)
  {
    bool folded = false;
    for (size_t i = 0; i < f->n_triangles; i++)
    {
      const triangle* t = &f->triangles[i];
      vec3 p[3], q[3], normal = { 0, 0, 0 };
      for (unsigned k = 0; k < 3; k++)
      {
        const aqr_vertex* v = &f->m->vertices[t->v[k]];
        normal = v3_add(normal, v->normal);
        p[k] = v->position;
        q[k] = v3_madd(v->position, f->move[t->v[k]], v->normal);
      }
      if (v3_dot(normal, v3_cross(v3_sub(q[1], q[0]), v3_sub(q[2], q[0]))) > 0 ||
          !(v3_dot(normal, v3_cross(v3_sub(p[1], p[0]), v3_sub(p[2], p[0]))) > 0))
        continue;
      folded = true;
      for (unsigned k = 0; k < 3; k++)
        f->move[t->v[k]] *= round + 1 < damp_rounds ? 0.5 : 0;
    }
    if (!folded)
      break;
  }
}

static void apply(void* data, size_t begin, size_t end)
{
  fit* f = data;
  for (size_t v = begin; v < end; v++)
  {
    aqr_vertex* x = &f->m->vertices[v];
    x->position = v3_madd(x->position, f->move[v], x->normal);
  }
}

aqr_status aqr_fit(aqr_context* c, const aqr_surface* s, aqr_polygon_mesh* m)
{
  aqr_status status = AQR_OK;
  fit f = { .s = s, .m = m };
  size_t n = m->n_vertices;
  AQR_TRY(aqr_place_on_borders(c, s, m));
  AQR_TRY(aqr_parallel(c, n, snap, &f, 0, 0.1));
  AQR_TRY(allocate(c, &f));
  AQR_TRY(aqr_parallel(c, m->n_faces, triangulate, &f, 0.1, 0.15));
  list_corners(&f);
  AQR_TRY(aqr_parallel(c, f.n_triangles, measure, &f, 0.15, 0.8));
  AQR_TRY(solve(c, &f, 0.8, 0.95));
  AQR_TRY(aqr_parallel(c, n, limit, &f, 0.95, 1));
  damp(&f);
  AQR_TRY(aqr_parallel(c, n, apply, &f, 1, 1));
done:
  release(c, &f);
  return status;
}
