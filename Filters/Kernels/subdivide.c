/* SPDX-License-Identifier: BSD-3-Clause */
#include "subdivide.h"

#include "aqr.h"
#include "closest.h"
#include "regularize.h"

enum
{
  most_steps = 512 /* faces walked from a corner to below a new vertex */
};

typedef struct job
{
  const aqr_surface* s;
  const aqr_polygon_mesh* m;
  aqr_polygon_mesh* fine;
} job;

/* Half-edges of the new mesh: an old one is cut in two, those of its twin run the other way; across[h] leads from the
 * middle of h to the centre of its face. */
static aqr_index first_half(aqr_index h)
{
  return 4 * (h >> 1) + (h & 1 ? 3 : 0);
}

static aqr_index second_half(aqr_index h)
{
  return 4 * (h >> 1) + (h & 1 ? 1 : 2);
}

static void link(aqr_polygon_mesh* m, aqr_index h, aqr_index next, aqr_index from, aqr_index face)
{
  m->half_edges[h].next = next;
  m->half_edges[next].prev = h;
  m->half_edges[h].from = from;
  m->half_edges[h].face = face;
}

/* From vertex `from` of the old mesh to the place nearest to a new one, kept if it is nearer than what was found. */
static void look(const job* j, aqr_index from, vec3 p, aqr_closest* best)
{
  const aqr_place* at = &j->m->vertices[from].place;
  aqr_closest near;
  aqr_closest_near(j->s, at->face, p, most_steps, true, &near);
  if (near.distance2 < best->distance2)
    *best = near;
}

static void settle(aqr_vertex* v, const aqr_closest* at)
{
  v->place = at->place;
  v->position = at->position;
}

static void add_middles(void* data, size_t begin, size_t end)
{
  const job* j = data;
  for (size_t e = begin; e < end; e++)
  {
    const aqr_index h = (aqr_index)(2 * e), outer = aqr_pm_face(j->m, h) == AQR_NONE ? h : h ^ 1;
    aqr_vertex* v = &j->fine->vertices[j->m->n_vertices + e];
    *v = aqr_middle(j->m, h);
    v->size /= 2;
    v->out = second_half(outer);
    if (v->kind != AQR_VERTEX_INTERIOR)
      continue; /* the fit puts it on its chain */
    aqr_closest best = { .distance2 = INFINITY };
    look(j, aqr_pm_from(j->m, h), v->position, &best);
    look(j, aqr_pm_to(j->m, h), v->position, &best);
    settle(v, &best);
  }
}

static void add_centres(void* data, size_t begin, size_t end)
{
  const job* j = data;
  const aqr_polygon_mesh* m = j->m;
  for (size_t f = begin; f < end; f++)
  {
    aqr_vertex* v = &j->fine->vertices[m->n_vertices + m->n_half_edges / 2 + f];
    vec3 position = { 0, 0, 0 }, normal = { 0, 0, 0 };
    double n = 0, size = 0;
    aqr_index h = m->faces[f];
    do
    {
      const aqr_vertex* w = &m->vertices[aqr_pm_from(m, h)];
      position = v3_add(position, w->position);
      normal = v3_add(normal, w->normal);
      size += w->size;
      n += 1;
      h = aqr_pm_next(m, h);
    } while (h != m->faces[f]);
    *v = m->vertices[aqr_pm_from(m, h)];
    v->normal = v3_unit_or(normal, v->normal);
    v->size = size / n / 2;
    v->kind = AQR_VERTEX_INTERIOR;
    aqr_closest best = { .distance2 = INFINITY };
    do
    {
      look(j, aqr_pm_from(m, h), v3_scale(position, 1 / n), &best);
      h = aqr_pm_next(m, h);
    } while (h != m->faces[f]);
    settle(v, &best);
  }
}

/* Connects the quad at the start of h, or the two halves of h on the border. */
static void add_corner(job* j, const aqr_index* across, aqr_index h)
{
  const aqr_polygon_mesh* m = j->m;
  aqr_polygon_mesh* fine = j->fine;
  aqr_index middle = (aqr_index)(m->n_vertices + (h >> 1)), face = aqr_pm_face(m, h), prev = aqr_pm_prev(m, h);
  if (face == AQR_NONE)
  {
    link(fine, first_half(h), second_half(h), aqr_pm_from(m, h), AQR_NONE);
    link(fine, second_half(h), first_half(aqr_pm_next(m, h)), middle, AQR_NONE);
    return;
  }
  aqr_index centre = (aqr_index)(m->n_vertices + m->n_half_edges / 2) + face, quad = (aqr_index)fine->n_faces++;
  link(fine, first_half(h), across[h], aqr_pm_from(m, h), quad);
  link(fine, across[h], across[prev] ^ 1, middle, quad);
  link(fine, across[prev] ^ 1, second_half(prev), centre, quad);
  link(fine, second_half(prev), first_half(h), (aqr_index)(m->n_vertices + (prev >> 1)), quad);
  fine->edge_type[across[h] >> 1] = m->edge_type[h >> 1] == AQR_LINE_MIN ? AQR_LINE_MAX : AQR_LINE_MIN;
  fine->faces[quad] = first_half(h);
  fine->vertices[centre].out = across[h] ^ 1;
}

aqr_status aqr_subdivide(aqr_context* c, const aqr_surface* s, aqr_polygon_mesh* m)
{
  aqr_status status = AQR_OK;
  aqr_polygon_mesh fine = { 0 };
  job j = { s, m, &fine };
  const size_t n_edges = m->n_half_edges / 2;
  size_t corners = 0;
  aqr_index* across = AQR_NEW(c, aqr_index, m->n_half_edges);
  AQR_REQUIRE(across, AQR_OUT_OF_MEMORY);
  for (aqr_index h = 0; h < m->n_half_edges; h++)
    across[h] = aqr_pm_face(m, h) == AQR_NONE ? AQR_NONE : 2 * (aqr_index)(2 * n_edges + corners++);
  fine.n_vertices = m->n_vertices + n_edges + m->n_faces;
  fine.n_half_edges = 2 * (2 * n_edges + corners);
  AQR_REQUIRE(fine.n_half_edges < AQR_SEAM, AQR_TOO_LARGE);
  AQR_REQUIRE(AQR_RESERVE(c, fine.vertices, fine.vertex_capacity, fine.n_vertices) &&
                AQR_RESERVE(c, fine.half_edges, fine.half_edge_capacity, fine.n_half_edges) &&
                AQR_RESERVE(c, fine.edge_type, fine.edge_capacity, fine.n_half_edges / 2) &&
                AQR_RESERVE(c, fine.faces, fine.face_capacity, corners),
    AQR_OUT_OF_MEMORY);
  for (size_t v = 0; v < m->n_vertices; v++)
  {
    fine.vertices[v] = m->vertices[v];
    fine.vertices[v].size /= 2;
    fine.vertices[v].out = first_half(m->vertices[v].out);
  }
  AQR_TRY(aqr_parallel(c, n_edges, add_middles, &j, 0, 0));
  AQR_TRY(aqr_parallel(c, m->n_faces, add_centres, &j, 0, 0));
  for (size_t e = 0; e < n_edges; e++)
    fine.edge_type[2 * e] = fine.edge_type[2 * e + 1] = m->edge_type[e];
  for (aqr_index h = 0; h < m->n_half_edges; h++)
    add_corner(&j, across, h);
  aqr_polygon_mesh_free(c, m);
  *m = fine;
  fine = (aqr_polygon_mesh){ 0 };
done:
  AQR_DROP(c, across, 2 * n_edges);
  aqr_polygon_mesh_free(c, &fine);
  return status;
}
