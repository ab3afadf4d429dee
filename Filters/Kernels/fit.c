/* SPDX-License-Identifier: BSD-3-Clause */
#include "fit.h"

#include "chain_places.h"
#include "closest.h"
#include "fans.h"
#include "fit_system.h"

#include <string.h>

enum
{
  most_steps = 512, /* faces walked from a corner of a polygon to below a sample of it */
  rounds = 4,
  damp_rounds = 6
};

static const double hold_first = 0.5;    /* along the surface, where the error says little, in the first round */
static const double hold_tangent = 1e-3; /* and in the others */
static const double farthest_move = 0.5; /* of the shortest edge at a vertex, in one round */
static const double least_sine = 0.3;    /* of a corner's angle: a move does not make it smaller than that */
static const double open_height = 0.01;  /* of a corner that was straight, over the line between its neighbours */
static const double farthest_sample =
  0.5; /* of the longest side: what is farther away is another part of the surface */
static const double farthest_vertex =
  0.08; /* of the diagonal, from the surface: a handful of vertices would go farther to stand for a sphere */
static const double least_cosine = 0.3; /* between a polygon and the surface below it */

static void snap(void* data, size_t begin, size_t end)
{
  aqr_fitter* f = data;
  for (size_t v = begin; v < end; v++)
  {
    aqr_vertex* x = &f->m->vertices[v];
    bool placed = x->place.bary[0] + x->place.bary[1] + x->place.bary[2] > 0;
    if (x->kind != AQR_VERTEX_INTERIOR && placed)
      continue;
    aqr_closest near;
    aqr_closest_near(f->s, x->place.face, x->position, most_steps, true, &near);
    x->position = near.position;
    x->place = near.place;
  }
}

/* ---- triangles ---- */

static aqr_status allocate(aqr_context* c, aqr_fitter* f)
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
  f->triangles = AQR_NEW(c, aqr_fit_triangle, f->n_triangles);
  f->first_corner = AQR_NEW(c, size_t, n + 2);
  f->corners = AQR_NEW(c, aqr_index, 3 * f->n_triangles);
  f->links = AQR_NEW(c, aqr_fit_link, 3 * f->n_triangles + n);
  f->move = AQR_NEW(c, vec3, n);
  f->residual = AQR_NEW(c, vec3, n);
  f->direction = AQR_NEW(c, vec3, n);
  f->image = AQR_NEW(c, vec3, n);
  f->across = AQR_NEW(c, vec3, m->n_half_edges / 2);
  f->share = AQR_NEW(c, double, n);
  f->block = AQR_NEW(c, double, 6 * n);
  f->inverse = AQR_NEW(c, double, 6 * n);
  f->product = AQR_NEW(c, double, n);
  f->back = AQR_NEW0(c, uint8_t, n);
  f->folds = AQR_NEW(c, aqr_fit_flag, n);
  return f->triangles && f->first_corner && f->corners && f->links && f->move && f->residual && f->direction &&
             f->image && f->across && f->share && f->block && f->inverse && f->product && f->back && f->folds
           ? AQR_OK
           : AQR_OUT_OF_MEMORY;
}

static void release(aqr_context* c, aqr_fitter* f)
{
  size_t n = f->m->n_vertices;
  AQR_DROP(c, f->first, f->m->n_faces + 1);
  AQR_DROP(c, f->triangles, f->n_triangles);
  AQR_DROP(c, f->first_corner, n + 2);
  AQR_DROP(c, f->corners, 3 * f->n_triangles);
  AQR_DROP(c, f->links, 3 * f->n_triangles + n);
  AQR_DROP(c, f->move, n);
  AQR_DROP(c, f->residual, n);
  AQR_DROP(c, f->direction, n);
  AQR_DROP(c, f->image, n);
  AQR_DROP(c, f->across, f->m->n_half_edges / 2);
  AQR_DROP(c, f->share, n);
  AQR_DROP(c, f->block, 6 * n);
  AQR_DROP(c, f->inverse, 6 * n);
  AQR_DROP(c, f->product, n);
  AQR_DROP(c, f->back, n);
  AQR_DROP(c, f->folds, n);
}

/* Fans, as programs that read the mesh take it. */
static void triangulate(void* data, size_t begin, size_t end)
{
  aqr_fitter* f = data;
  aqr_polygon_mesh* m = f->m;
  for (size_t i = begin; i < end; i++)
  {
    aqr_fan_start(m, (aqr_index)i);
    aqr_index h = m->faces[i], a = aqr_pm_from(m, h);
    for (size_t t = f->first[i]; t < f->first[i + 1]; t++)
    {
      h = aqr_pm_next(m, h);
      aqr_fit_triangle* x = &f->triangles[t];
      x->v[0] = a;
      x->v[1] = aqr_pm_from(m, h);
      x->v[2] = aqr_pm_to(m, h);
    }
  }
}

static void list_corners(aqr_fitter* f)
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

/* ---- the error ---- */

static void start_samples(void* data, size_t begin, size_t end)
{
  aqr_fitter* f = data;
  for (size_t i = begin; i < end; i++)
    for (unsigned k = 0; k < AQR_FIT_SAMPLES; k++)
    {
      const double* w = aqr_fit_place[k];
      unsigned nearest = w[0] >= w[1] && w[0] >= w[2] ? 0 : w[1] >= w[2] ? 1 : 2;
      f->triangles[i].at[k].face = f->m->vertices[f->triangles[i].v[nearest]].place.face;
    }
}

/* Distance from samples of each triangle to the tangent planes of the surface below them. */
static void measure(void* data, size_t begin, size_t end)
{
  aqr_fitter* f = data;
  const aqr_surface* s = f->s;
  for (size_t i = begin; i < end; i++)
  {
    aqr_fit_triangle* t = &f->triangles[i];
    vec3 p[3];
    for (unsigned k = 0; k < 3; k++)
      p[k] = aqr_pm_point(f->m, t->v[k]);
    vec3 ab = v3_sub(p[1], p[0]), ac = v3_sub(p[2], p[0]), cross = v3_cross(ab, ac), normal = v3_unit(cross);
    double area = 0.5 * v3_norm(cross);
    t->area = (float)area;
    double reach =
      greater(greater(v3_norm2(ab), v3_norm2(ac)), v3_norm2(v3_sub(ab, ac))) * farthest_sample * farthest_sample;
    for (unsigned k = 0; k < AQR_FIT_SAMPLES; k++)
    {
      const double* w = aqr_fit_place[k];
      aqr_fit_sample* x = &t->at[k];
      vec3 q = v3_madd(v3_madd(v3_scale(p[0], w[0]), w[1], p[1]), w[2], p[2]);
      aqr_closest below;
      aqr_closest_near(s, x->face, q, most_steps, true, &below);
      vec3 n = v3_unit(aqr_face_cross(s, below.place.face));
      bool use = below.distance2 < reach && v3_dot(n, normal) > least_cosine;
      double a = use ? sqrt(area * aqr_fit_weight[k]) : 0;
      x->normal[0] = (float)(a * n.x);
      x->normal[1] = (float)(a * n.y);
      x->normal[2] = (float)(a * n.z);
      x->distance = use ? (float)(a * v3_dot(v3_sub(below.position, q), n)) : 0;
      x->face = below.place.face;
    }
  }
}

/* ---- moving ---- */

static void limit(void* data, size_t begin, size_t end)
{
  aqr_fitter* f = data;
  const aqr_polygon_mesh* m = f->m;
  for (size_t v = begin; v < end; v++)
  {
    double least = INFINITY, length = v3_norm(f->move[v]);
    aqr_index h = m->vertices[v].out;
    do
    {
      least = lesser(least, v3_norm2(v3_sub(aqr_pm_point(m, aqr_pm_to(m, h)), m->vertices[v].position)));
      h = aqr_pm_next_around(m, h);
    } while (h != m->vertices[v].out);
    double most = farthest_move * sqrt(least);
    if (!isfinite(length))
      f->move[v] = v3(0, 0, 0);
    else if (length > most)
      f->move[v] = v3_scale(f->move[v], most / length);
  }
}

static void apply(void* data, size_t begin, size_t end)
{
  aqr_fitter* f = data;
  for (size_t v = begin; v < end; v++)
  {
    aqr_vertex* x = &f->m->vertices[v];
    f->image[v] = x->position;
    x->position = v3_add(x->position, f->move[v]);
  }
}

/* The sine of the angle at p between its neighbours. */
static double sine(vec3 prev, vec3 p, vec3 next, vec3 normal)
{
  vec3 a = v3_sub(next, p), b = v3_sub(prev, p);
  double n = sqrt(v3_norm2(a) * v3_norm2(b));
  return n > 0 ? v3_dot(v3_cross(a, b), normal) / n : -1;
}

/* Whether the corner at the start of h has become too sharp, flat or turned over. */
static void look_for_fold(aqr_fitter* f, aqr_index h)
{
  const aqr_polygon_mesh* m = f->m;
  aqr_index at[3] = { aqr_pm_from(m, aqr_pm_prev(m, h)), aqr_pm_from(m, h), aqr_pm_to(m, h) };
  vec3 normal = m->vertices[at[1]].normal;
  double now = sine(aqr_pm_point(m, at[0]), aqr_pm_point(m, at[1]), aqr_pm_point(m, at[2]), normal);
  if (now > least_sine || !(now < sine(f->image[at[0]], f->image[at[1]], f->image[at[2]], normal)))
    return;
  for (unsigned i = 0; i < 3; i++)
    atomic_store_explicit(&f->folds[at[i]], 1, memory_order_relaxed);
}

static void find_folds(void* data, size_t begin, size_t end)
{
  aqr_fitter* f = data;
  for (aqr_index h = (aqr_index)begin; h < end; h++)
    if (aqr_pm_face(f->m, h) != AQR_NONE)
      look_for_fold(f, h);
}

/* ... of those that have a vertex held back: few. */
static void find_folds_again(void* data, size_t begin, size_t end)
{
  aqr_fitter* f = data;
  const aqr_polygon_mesh* m = f->m;
  for (size_t v = begin; v < end; v++)
  {
    if (!f->back[v])
      continue;
    aqr_index h = m->vertices[v].out;
    do
    {
      if (aqr_pm_face(m, h) != AQR_NONE)
      {
        look_for_fold(f, aqr_pm_prev(m, h));
        look_for_fold(f, h);
        look_for_fold(f, aqr_pm_next(m, h));
      }
      h = aqr_pm_next_around(m, h);
    } while (h != m->vertices[v].out);
  }
}

static void hold_back(void* data, size_t begin, size_t end)
{
  aqr_fitter* f = data;
  for (size_t v = begin; v < end; v++)
  {
    f->back[v] = atomic_load_explicit(&f->folds[v], memory_order_relaxed);
    if (!f->back[v])
      continue;
    atomic_store_explicit(&f->folds[v], 0, memory_order_relaxed);
    atomic_store_explicit(&f->folded, 1, memory_order_relaxed);
    f->move[v] = v3_scale(f->move[v], f->keep);
    f->m->vertices[v].position = v3_add(f->image[v], f->move[v]);
  }
}

/* Halves the moves around corners that fold, in the end to nothing. */
static aqr_status damp(aqr_context* c, aqr_fitter* f, double at)
{
  const aqr_polygon_mesh* m = f->m;
  aqr_status status = AQR_OK;
  for (size_t v = 0; v < m->n_vertices; v++)
    atomic_init(&f->folds[v], 0);
  for (unsigned round = 0; round < damp_rounds; round++)
  {
    f->keep = round + 1 < damp_rounds ? 0.5 : 0;
    atomic_init(&f->folded, 0);
    if (round == 0)
      AQR_TRY(aqr_parallel(c, m->n_half_edges, find_folds, f, at, at));
    else
      AQR_TRY(aqr_parallel(c, m->n_vertices, find_folds_again, f, at, at));
    AQR_TRY(aqr_parallel(c, m->n_vertices, hold_back, f, at, at));
    if (!atomic_load_explicit(&f->folded, memory_order_relaxed))
      break;
  }
done:
  return status;
}

/* Finds the place below a vertex that has moved along the surface. */
static void settle(void* data, size_t begin, size_t end)
{
  aqr_fitter* f = data;
  for (size_t v = begin; v < end; v++)
  {
    aqr_vertex* x = &f->m->vertices[v];
    if (x->kind != AQR_VERTEX_INTERIOR)
      continue;
    aqr_closest below;
    aqr_closest_near(f->s, x->place.face, x->position, most_steps, true, &below);
    x->place = below.place;
    if (below.distance2 > farthest_vertex * farthest_vertex)
      x->position =
        v3_madd(below.position, farthest_vertex / sqrt(below.distance2), v3_sub(x->position, below.position));
    vec3 n = v3(0, 0, 0);
    for (unsigned i = 0; i < 3 && f->normals; i++)
      n = v3_madd(n, x->place.bary[i], v3_load(f->normals + 3 * (size_t)f->s->corner[3 * x->place.face + i]));
    if (v3_norm2(n) > 0)
      x->normal = v3_unit(n);
  }
}

/* ---- straight corners ---- */

/* The smallest sine of the corners of triangles and quads that change where v moves to p. */
static double least_sine_around(const aqr_polygon_mesh* m, aqr_index v, vec3 p)
{
  double least = 1;
  aqr_index out = m->vertices[v].out;
  do
  {
    vec3 at[4] = { p };
    unsigned n = 1;
    aqr_index h = aqr_pm_next(m, out);
    for (; n < 4 && h != out; n++, h = aqr_pm_next(m, h))
      at[n] = aqr_pm_point(m, aqr_pm_from(m, h));
    if (h == out && aqr_pm_face(m, out) != AQR_NONE)
    {
      vec3 normal = v3_unit(v3_cross(v3_sub(at[2], at[0]), v3_sub(at[n - 1], at[1])));
      const unsigned corner[3] = { n - 1, 0, 1 };
      for (unsigned i = 0; i < 3; i++)
        least = lesser(least, sine(at[(corner[i] + n - 1) % n], at[corner[i]], at[(corner[i] + 1) % n], normal));
    }
    out = aqr_pm_next_around(m, out);
  } while (out != m->vertices[v].out);
  return least;
}

/* Takes the vertex where h starts, a straight or concave corner, out over the line between its neighbours, unless that
 * closes another corner as far. */
static void open_corner(aqr_polygon_mesh* m, aqr_index h)
{
  aqr_index v = aqr_pm_from(m, h);
  vec3 p = aqr_pm_point(m, v), from = aqr_pm_point(m, aqr_pm_from(m, aqr_pm_prev(m, h)));
  vec3 along = v3_sub(aqr_pm_point(m, aqr_pm_to(m, h)), from);
  vec3 out = v3_unit_or(v3_cross(along, m->vertices[v].normal), v3(0, 0, 0));
  vec3 moved = v3_madd(p, open_height * v3_norm(along) - v3_dot(v3_sub(p, from), out), out);
  if (least_sine_around(m, v, moved) > least_sine_around(m, v, p))
    m->vertices[v].position = moved;
}

/* Lines that meet three at a vertex leave one of its corners wide, and straight or concave where they meet in a T. The
 * error says nothing of it: what is moved is moved along the surface, and a few of a hundred vertices at most. */
static void open_corners(aqr_polygon_mesh* m)
{
  for (size_t f = 0; f < m->n_faces; f++)
  {
    aqr_index h[4] = { m->faces[f] };
    for (unsigned i = 1; i < 4; i++)
      h[i] = aqr_pm_next(m, h[i - 1]);
    if (h[3] == h[0] || aqr_pm_next(m, h[3]) != h[0])
      continue;
    vec3 p[4];
    for (unsigned i = 0; i < 4; i++)
      p[i] = aqr_pm_point(m, aqr_pm_from(m, h[i]));
    vec3 normal = v3_cross(v3_sub(p[2], p[0]), v3_sub(p[3], p[1]));
    for (unsigned i = 0; i < 4; i++)
    {
      vec3 cross = v3_cross(v3_sub(p[(i + 1) % 4], p[i]), v3_sub(p[(i + 3) % 4], p[i]));
      if (!(v3_dot(cross, normal) > 0) && m->vertices[aqr_pm_from(m, h[i])].kind == AQR_VERTEX_INTERIOR)
        open_corner(m, h[i]);
    }
  }
}

aqr_status aqr_fit(aqr_context* c, const aqr_surface* s, const double* normals, aqr_polygon_mesh* m)
{
  aqr_status status = AQR_OK;
  aqr_fitter f = { .s = s, .normals = normals, .m = m };
  size_t n = m->n_vertices;
  AQR_TRY(aqr_place_on_chains(c, s, m));
  AQR_TRY(aqr_parallel(c, n, snap, &f, 0, 0.1));
  AQR_TRY(allocate(c, &f));
  AQR_TRY(aqr_parallel(c, m->n_faces, triangulate, &f, 0.1, 0.1));
  AQR_TRY(aqr_parallel(c, f.n_triangles, start_samples, &f, 0.1, 0.1));
  AQR_TRY(aqr_fit_note_edges(c, &f, 0.1));
  for (unsigned round = 0; round < rounds; round++)
  {
    double from = 0.1 + 0.8 * round / rounds, to = 0.1 + 0.8 * (round + 1) / rounds;
    f.hold = round ? hold_tangent : hold_first;
    AQR_TRY(aqr_parallel(c, f.n_triangles, measure, &f, from, to));
    list_corners(&f);
    AQR_TRY(aqr_fit_solve(c, &f, to));
    AQR_TRY(aqr_parallel(c, n, limit, &f, to, to));
    AQR_TRY(aqr_parallel(c, n, apply, &f, to, to));
    AQR_TRY(damp(c, &f, to));
    AQR_TRY(aqr_parallel(c, m->n_faces, triangulate, &f, to, to));
  }
  open_corners(m);
  AQR_TRY(aqr_parallel(c, m->n_faces, triangulate, &f, 0.9, 0.9));
  AQR_TRY(aqr_parallel(c, n, settle, &f, 0.9, 1));
done:
  release(c, &f);
  return status;
}
