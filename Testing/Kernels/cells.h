/* SPDX-License-Identifier: BSD-3-Clause */
/* Polygon meshes to try operators on: grids, and grids disturbed by random Euler operators. */
#ifndef AQR_TEST_CELLS_H
#define AQR_TEST_CELLS_H

#include "polygon_mesh.h"
#include "surface.h"

#include <stdlib.h>

/* An allocator that fails after some number of calls. */
typedef struct ration
{
  size_t left;
} ration;

static inline void* rationed(void* user, void* old, size_t old_bytes, size_t bytes)
{
  ration* r = user;
  (void)old_bytes;
  if (bytes == 0)
  {
    free(old);
    return NULL;
  }
  return r->left && r->left-- ? realloc(old, bytes) : NULL;
}

static inline unsigned next_random(unsigned* state)
{
  *state = *state * 1664525u + 1013904223u;
  return *state >> 8;
}

/* nu by nv quads whose vertices are at place(i, j); closed in both directions or in none. */
static inline bool grid_of_quads(
  aqr_context* c, size_t nu, size_t nv, bool closed, aqr_vertex (*place)(double, double), aqr_polygon_mesh* m)
{
  size_t wu = closed ? nu : nu + 1, wv = closed ? nv : nv + 1;
  aqr_vertex* v = malloc(wu * wv * sizeof *v);
  size_t* offsets = malloc((nu * nv + 1) * sizeof *offsets);
  aqr_index* corner = malloc(4 * nu * nv * sizeof *corner);
  bool ok = v && offsets && corner;
  for (size_t i = 0; ok && i < wu; i++)
    for (size_t j = 0; j < wv; j++)
      v[i * wv + j] = place((double)i / (double)nu, (double)j / (double)nv);
  for (size_t f = 0; ok && f <= nu * nv; f++)
    offsets[f] = 4 * f;
  for (size_t i = 0; ok && i < nu; i++)
    for (size_t j = 0; j < nv; j++)
    {
      size_t a = i, b = (i + 1) % wu, p = j, q = (j + 1) % wv;
      aqr_index* k = corner + 4 * (i * nv + j);
      k[0] = (aqr_index)(a * wv + p);
      k[1] = (aqr_index)(b * wv + p);
      k[2] = (aqr_index)(b * wv + q);
      k[3] = (aqr_index)(a * wv + q);
    }
  ok = ok && aqr_pm_append(c, m, v, wu * wv, offsets, nu * nv, corner) == AQR_OK;
  for (size_t i = 0; ok && !closed && i < m->n_vertices; i++)
    if (aqr_pm_on_border(m, (aqr_index)i))
      m->vertices[i].kind = aqr_pm_valence(m, (aqr_index)i) == 2 ? AQR_VERTEX_CORNER : AQR_VERTEX_BOUNDARY;
  free(v);
  free(offsets);
  free(corner);
  return ok;
}

static inline aqr_vertex on_torus(double s, double t)
{
  double u = 6.28318530717958648 * s, w = 6.28318530717958648 * t;
  vec3 n = v3(cos(w) * cos(u), cos(w) * sin(u), sin(w));
  return (aqr_vertex){ .position = v3_madd(v3(cos(u), sin(u), 0), 0.4, n), .normal = n, .size = 0.3 };
}
static inline aqr_vertex on_sheet(double s, double t)
{
  return (aqr_vertex){ .position = v3(s, t, 0), .normal = v3(0, 0, 1), .size = 0.15 };
}
static inline bool torus_of_quads(aqr_context* c, size_t nu, size_t nv, aqr_polygon_mesh* m)
{
  return grid_of_quads(c, nu, nv, true, on_torus, m);
}
static inline bool sheet_of_quads(aqr_context* c, size_t nu, size_t nv, aqr_polygon_mesh* m)
{
  return grid_of_quads(c, nu, nv, false, on_sheet, m);
}

/* A working surface whose triangles halve the quads of a grid. */
static inline bool surface_of_grid(
  aqr_context* c, size_t nu, size_t nv, bool closed, aqr_vertex (*place)(double, double), aqr_surface* s)
{
  aqr_polygon_mesh m = { 0 };
  if (!grid_of_quads(c, nu, nv, closed, place, &m))
    return false;
  size_t quads = m.n_faces;
  for (aqr_index f = 0; f < quads; f++)
    if (aqr_pm_split_face(c, &m, m.faces[f], aqr_pm_next(&m, aqr_pm_next(&m, m.faces[f])), AQR_LINE_MIN) != AQR_OK)
      return false;
  *s = (aqr_surface){ .n_points = m.n_vertices, .n_faces = m.n_faces };
  s->points = malloc(3 * s->n_points * sizeof(double));
  s->corner = malloc(3 * s->n_faces * sizeof(aqr_index));
  s->twin = malloc(3 * s->n_faces * sizeof(aqr_index));
  s->clean = malloc(s->n_points * sizeof(aqr_index));
  s->n_clean = s->n_points;
  aqr_index* at = malloc(m.n_half_edges * sizeof(aqr_index));
  for (size_t v = 0; v < s->n_points; v++)
  {
    v3_store(s->points + 3 * v, m.vertices[v].position);
    s->clean[v] = (aqr_index)v;
  }
  for (aqr_index f = 0; f < s->n_faces; f++)
  {
    aqr_index h = m.faces[f];
    for (unsigned i = 0; i < 3; i++, h = aqr_pm_next(&m, h))
      at[h] = 3 * f + i;
  }
  for (aqr_index h = 0; h < m.n_half_edges; h++)
    if (aqr_pm_face(&m, h) != AQR_NONE)
    {
      s->corner[at[h]] = aqr_pm_from(&m, h);
      s->twin[at[h]] = aqr_pm_face(&m, h ^ 1) == AQR_NONE ? AQR_NONE : at[h ^ 1];
    }
  free(at);
  aqr_polygon_mesh_free(c, &m);
  return true;
}

static inline void free_surface(aqr_surface* s)
{
  free(s->points);
  free(s->corner);
  free(s->twin);
  free(s->clean);
}

/* Random Euler operators without any regard for what makes a good mesh. */
static inline void disturb(aqr_context* c, aqr_polygon_mesh* m, unsigned seed, unsigned times)
{
  unsigned state = seed;
  for (unsigned k = 0; k < times; k++)
  {
    aqr_index h = next_random(&state) % (aqr_index)m->n_half_edges, g = h, w;
    unsigned what = next_random(&state) % 10, steps = next_random(&state) % 5;
    if (!aqr_pm_edge_lives(m, h))
      continue;
    bool chain = aqr_pm_on_chain(m, h);
    while (steps--)
      g = aqr_pm_next(m, g);
    if (what < 4 && !chain)
      aqr_pm_remove_edge(m, h);
    else if (what < 6)
      aqr_pm_contract(m, h);
    else if (what < 8)
      aqr_pm_split_face(c, m, h, g, AQR_LINE_MAX);
    else if (what == 8)
    {
      aqr_vertex middle = m->vertices[aqr_pm_from(m, h)];
      middle.position = v3_scale(v3_add(middle.position, aqr_pm_point(m, aqr_pm_to(m, h))), 0.5);
      middle.kind = chain ? AQR_VERTEX_BOUNDARY : AQR_VERTEX_INTERIOR;
      aqr_pm_split_edge(c, m, h, &middle, &w);
    }
    else
    {
      aqr_pm_remove_leaf(m, h);
      if (aqr_pm_edge_lives(m, h) && m->vertices[aqr_pm_from(m, h)].kind == AQR_VERTEX_INTERIOR)
        aqr_pm_join_edges(m, aqr_pm_from(m, h));
    }
  }
}

#endif
