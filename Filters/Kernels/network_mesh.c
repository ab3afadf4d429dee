/* SPDX-License-Identifier: BSD-3-Clause */
/* Paper 5.1 and 5.2: from the network's loops to polygons. */
#include "closest.h"
#include "network.h"

#include <string.h>

static vec3 normal_at(const aqr_surface* s, const aqr_field* field, const aqr_place* at)
{
  vec3 n = { 0, 0, 0 };
  for (unsigned i = 0; i < 3; i++)
    n = v3_madd(n, at->bary[i], v3_load(field->normal + 3 * (size_t)s->corner[3 * at->face + i]));
  /* where the surface folds back on itself the sum may vanish */
  return v3_unit_or(n, v3_load(field->normal + 3 * (size_t)s->corner[3 * at->face]));
}

static double size_at(const aqr_surface* s, const aqr_sizing* sizing, aqr_index face)
{
  double size = 0;
  for (unsigned i = 0; i < 3; i++)
  {
    const float* d = sizing->spacing + 2 * (size_t)s->corner[3 * face + i];
    size += (double)(d[0] < d[1] ? d[0] : d[1]) / 3;
  }
  return size;
}

static aqr_vertex vertex_of_crossing(
  const aqr_surface* s, const aqr_field* field, const aqr_sizing* sizing, const aqr_lines* lines, const aqr_crossing* x)
{
  const aqr_sample *a = &lines->samples[x->chord[0]], *b = &lines->samples[x->chord[1]];
  vec3 d = v3_sub(a[1].p, a->p), e = v3_sub(b[1].p, b->p);
  vec3 u = v3_cross(e, v3_sub(a->p, b->p)), v = v3_cross(e, d);
  double n = v3_norm2(v), t = n > 0 ? fmin(1, fmax(0, -v3_dot(u, v) / n)) : 0.5;
  aqr_vertex r = { .position = v3_madd(a->p, t, d), .kind = AQR_VERTEX_INTERIOR, .out = AQR_NONE };
  r.place = aqr_place_in(s, a->face, r.position, 0);
  r.normal = normal_at(s, field, &r.place);
  r.size = size_at(s, sizing, a->face);
  return r;
}

static aqr_vertex vertex_of_stop(
  const aqr_surface* s, const aqr_field* field, const aqr_sizing* sizing, const aqr_lines* lines, const aqr_stop* x)
{
  aqr_vertex r = { .out = AQR_NONE };
  bool corner = x->chain == AQR_NONE;
  aqr_index h = corner ? s->fan[x->sample] : lines->samples[x->sample].edge;
  double t = corner ? 0 : x->t;
  r.position = aqr_edge_point(s, h, t);
  r.place.face = aqr_face_of(h);
  r.place.bary[h % 3] = 1 - t;
  r.place.bary[(h % 3 + 1) % 3] = t;
  r.normal = normal_at(s, field, &r.place);
  r.size = size_at(s, sizing, r.place.face);
  aqr_index other = aqr_any_twin(s, h);
  if (other != AQR_NONE && !corner)
  {
    aqr_place there = { aqr_face_of(other), { 0, 0, 0 } };
    there.bary[other % 3] = t;
    there.bary[(other % 3 + 1) % 3] = 1 - t;
    r.normal = v3_unit_or(v3_add(r.normal, normal_at(s, field, &there)), r.normal);
    r.size = fmin(r.size, size_at(s, sizing, there.face));
  }
  r.kind = corner                                            ? AQR_VERTEX_CORNER
           : lines->lines[x->chain].type == AQR_LINE_FEATURE ? AQR_VERTEX_FEATURE
                                                             : AQR_VERTEX_BOUNDARY;
  return r;
}

typedef struct vertices
{
  const aqr_surface* s;
  const aqr_field* field;
  const aqr_sizing* sizing;
  const aqr_lines* lines;
  const aqr_network* net;
  aqr_polygon_mesh* mesh;
  aqr_index* id; /* per node of the network: its vertex, or AQR_NONE */
} vertices;

static aqr_index count_vertices(vertices* v)
{
  const aqr_network* net = v->net;
  aqr_index n = 0;
  for (size_t i = 0; i < net->n_crossings + net->n_stops; i++)
    v->id[i] = i >= net->n_crossings || net->crossings[i].alive ? n++ : AQR_NONE;
  return n;
}

static void place_vertices(void* data, size_t begin, size_t end)
{
  vertices* v = data;
  size_t n_crossings = v->net->n_crossings;
  for (size_t i = begin; i < end; i++)
    if (v->id[i] != AQR_NONE)
      v->mesh->vertices[v->id[i]] =
        i < n_crossings ? vertex_of_crossing(v->s, v->field, v->sizing, v->lines, &v->net->crossings[i])
                        : vertex_of_stop(v->s, v->field, v->sizing, v->lines, &v->net->stops[i - n_crossings]);
}

aqr_status aqr_network_mesh(aqr_context* c, const aqr_surface* s, const aqr_field* field, const aqr_sizing* sizing,
  const aqr_lines* lines, const aqr_network* net, aqr_polygon_mesh* mesh)
{
  aqr_status status = AQR_OK;
  memset(mesh, 0, sizeof *mesh);
  size_t n_nodes = net->n_crossings + net->n_stops;
  aqr_index* id = AQR_NEW(c, aqr_index, n_nodes);
  AQR_REQUIRE(id, AQR_OUT_OF_MEMORY);
  AQR_REQUIRE(AQR_RESERVE(c, mesh->vertices, mesh->vertex_capacity, n_nodes) &&
                AQR_RESERVE(c, mesh->half_edges, mesh->half_edge_capacity, 2 * net->n_edges) &&
                AQR_RESERVE(c, mesh->edge_type, mesh->edge_capacity, net->n_edges) &&
                AQR_RESERVE(c, mesh->faces, mesh->face_capacity, net->n_loops),
    AQR_OUT_OF_MEMORY);
  vertices v = { s, field, sizing, lines, net, mesh, id };
  mesh->n_vertices = count_vertices(&v);
  AQR_TRY(aqr_parallel(c, n_nodes, place_vertices, &v, 1, 1));
  mesh->n_faces = net->n_loops;
  mesh->n_half_edges = 2 * net->n_edges;
  if (net->type) /* NULL where the network has no edge */
    memcpy(mesh->edge_type, net->type, net->n_edges);
  for (size_t h = 0; h < mesh->n_half_edges; h++)
  {
    aqr_half_edge* e = &mesh->half_edges[h];
    e->from = id[net->from[h]];
    e->next = net->next[h];
    e->face = net->loop[h];
    mesh->half_edges[e->next].prev = (aqr_index)h;
    if (e->face != AQR_NONE)
      mesh->faces[e->face] = (aqr_index)h;
    if (e->face == AQR_NONE || mesh->vertices[e->from].out == AQR_NONE)
      mesh->vertices[e->from].out = (aqr_index)h;
  }
done:
  AQR_DROP(c, id, n_nodes);
  return status;
}
