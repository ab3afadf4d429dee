/* SPDX-License-Identifier: BSD-3-Clause */
#include "test.h"

#include "cells.h"
#include "regularize.h"

/* Cell decompositions given by their rotation: from and next of every half-edge. */
typedef struct complex_case
{
  const char* name;
  size_t n_vertices, n_half_edges;
  aqr_index from[16], next[16];
  unsigned outer; /* bit h: half-edge h runs along a border */
  long euler;
} complex_case;

static const complex_case complexes[] = {
  { "sphere, one loop", 1, 2, { 0, 0 }, { 0, 1 }, 0, 2 },
  { "sphere, one edge", 2, 2, { 0, 1 }, { 1, 0 }, 0, 2 },
  { "sphere, three digons", 2, 6, { 0, 1, 0, 1, 0, 1 }, { 3, 4, 5, 0, 1, 2 }, 0, 2 },
  { "sphere, two triangles", 3, 6, { 0, 1, 1, 2, 2, 0 }, { 2, 5, 4, 1, 0, 3 }, 0, 2 },
  { "torus, one square", 1, 4, { 0, 0, 0, 0 }, { 2, 3, 1, 0 }, 0, 0 },
  { "genus two, one octagon", 1, 8, { 0, 0, 0, 0, 0, 0, 0, 0 }, { 2, 3, 1, 4, 6, 7, 5, 0 }, 0, -2 },
  { "disk, one loop", 1, 2, { 0, 0 }, { 0, 1 }, 2, 1 },
  { "annulus, one cut", 2, 6, { 0, 0, 1, 1, 0, 1 }, { 4, 1, 5, 3, 2, 0 }, 2 | 8, 0 },
};

static bool build(aqr_context* c, const complex_case* k, aqr_polygon_mesh* m)
{
  if (!AQR_RESERVE(c, m->vertices, m->vertex_capacity, k->n_vertices) ||
      !AQR_RESERVE(c, m->half_edges, m->half_edge_capacity, k->n_half_edges) ||
      !AQR_RESERVE(c, m->edge_type, m->edge_capacity, k->n_half_edges / 2) ||
      !AQR_RESERVE(c, m->faces, m->face_capacity, k->n_half_edges))
    return false;
  m->n_vertices = k->n_vertices;
  m->n_half_edges = k->n_half_edges;
  for (size_t v = 0; v < k->n_vertices; v++)
    m->vertices[v] = (aqr_vertex){ .position = v3((double)v, (double)(v * v), 0), .normal = v3(0, 0, 1), .size = 1 };
  for (aqr_index h = 0; h < k->n_half_edges; h++)
    m->half_edges[h] = (aqr_half_edge){ .next = k->next[h], .from = k->from[h], .face = AQR_NONE };
  for (aqr_index h = 0; h < k->n_half_edges; h++)
  {
    m->half_edges[k->next[h]].prev = h;
    m->vertices[k->from[h]].out = h;
    m->edge_type[h / 2] = k->outer >> (h & ~1u) & 3 ? AQR_LINE_BOUNDARY : AQR_LINE_MIN;
    if (k->outer >> h & 1 || m->half_edges[h].face != AQR_NONE)
      continue;
    m->faces[m->n_faces] = h;
    for (aqr_index i = h; m->half_edges[i].face == AQR_NONE; i = k->next[i])
      m->half_edges[i].face = (aqr_index)m->n_faces;
    m->n_faces++;
  }
  for (aqr_index h = 0; h < k->n_half_edges; h++)
    if (k->outer >> h & 1)
    {
      m->vertices[k->from[h]].out = h;
      m->vertices[k->from[h]].kind = AQR_VERTEX_BOUNDARY;
    }
  return true;
}

AQR_TEST(loops_and_digons_become_a_regular_mesh_of_the_same_topology)
{
  for (size_t i = 0; i < sizeof complexes / sizeof *complexes; i++)
    for (unsigned tidy = 0; tidy < 2; tidy++)
    {
      aqr_context c = { 0 };
      aqr_polygon_mesh m = { 0 };
      int before = aqr_failures;
      CHECK(build(&c, &complexes[i], &m));
      CHECK(aqr_pm_is_consistent(&m));
      CHECK(!aqr_pm_is_regular(&m));
      CHECK(aqr_pm_euler(&m) == complexes[i].euler);
      CHECK(!tidy || aqr_tidy(&c, &m) == AQR_OK);
      CHECK(aqr_regularize(&c, &m) == AQR_OK);
      CHECK(aqr_pm_compact(&c, &m) == AQR_OK);
      CHECK(aqr_pm_is_consistent(&m));
      CHECK(aqr_pm_is_regular(&m));
      CHECK(aqr_pm_euler(&m) == complexes[i].euler);
      if (aqr_failures > before)
        printf("in: %s\n", complexes[i].name);
      aqr_polygon_mesh_free(&c, &m);
      CHECK(c.bytes == 0);
    }
}

AQR_TEST(the_checker_notices_a_wrong_link)
{
  aqr_context c = { 0 };
  aqr_polygon_mesh m = { 0 };
  CHECK(torus_of_quads(&c, 6, 5, &m));
  CHECK(aqr_pm_is_consistent(&m) && aqr_pm_is_regular(&m) && aqr_pm_euler(&m) == 0);
  aqr_half_edge saved = m.half_edges[7];
  m.half_edges[7].next = saved.prev;
  CHECK(!aqr_pm_is_consistent(&m));
  m.half_edges[7] = saved;
  m.half_edges[7].face = saved.face ? 0 : 1;
  CHECK(!aqr_pm_is_consistent(&m));
  m.half_edges[7] = saved;
  m.half_edges[7].from = (saved.from + 1) % (aqr_index)m.n_vertices;
  CHECK(!aqr_pm_is_consistent(&m));
  m.half_edges[7] = saved;
  CHECK(aqr_pm_is_consistent(&m));
  aqr_polygon_mesh_free(&c, &m);
}

AQR_TEST(polygons_that_share_an_edge_three_times_are_refused)
{
  aqr_context c = { 0 };
  aqr_polygon_mesh m = { 0 };
  aqr_vertex v[5] = { 0 };
  const size_t offsets[] = { 0, 3, 6, 9 };
  const aqr_index fan[] = { 0, 1, 2, 1, 0, 3, 0, 1, 4 }, turned[] = { 0, 1, 2, 0, 1, 3, 0, 3, 4 };
  CHECK(aqr_pm_append(&c, &m, v, 5, offsets, 3, fan) == AQR_INTERNAL);
  CHECK(aqr_pm_append(&c, &m, v, 5, offsets, 3, turned) == AQR_INTERNAL);
  CHECK(m.n_vertices == 0 && m.n_half_edges == 0 && m.n_faces == 0);
  aqr_polygon_mesh_free(&c, &m);
  CHECK(c.bytes == 0);
}

AQR_TEST(euler_operators_in_any_order_keep_the_links_and_the_topology)
{
  for (unsigned seed = 1; seed <= 100; seed++)
  {
    aqr_context c = { 0 };
    aqr_polygon_mesh m = { 0 };
    bool open = seed % 2;
    CHECK(open ? sheet_of_quads(&c, 7, 6, &m) : torus_of_quads(&c, 7, 6, &m));
    disturb(&c, &m, seed, 150);
    CHECK(aqr_pm_is_consistent(&m));
    CHECK(aqr_pm_euler(&m) == (open ? 1 : 0));
    CHECK(aqr_pm_compact(&c, &m) == AQR_OK);
    CHECK(aqr_pm_is_consistent(&m));
    CHECK(aqr_pm_euler(&m) == (open ? 1 : 0));
    CHECK(aqr_regularize(&c, &m) == AQR_OK);
    CHECK(aqr_pm_is_consistent(&m) && aqr_pm_is_regular(&m));
    CHECK(aqr_pm_euler(&m) == (open ? 1 : 0));
    aqr_polygon_mesh_free(&c, &m);
    CHECK(c.bytes == 0);
  }
}

static aqr_index lesser_end(const aqr_polygon_mesh* m, aqr_index edge)
{
  aqr_index a = m->half_edges[2 * edge].from, b = m->half_edges[2 * edge + 1].from;
  return a < b ? a : b;
}

AQR_TEST(edges_and_faces_do_not_lie_far_from_their_vertices_in_memory)
{
  aqr_context c = { 0 };
  aqr_polygon_mesh m = { 0 };
  CHECK(torus_of_quads(&c, 7, 6, &m));
  disturb(&c, &m, 3, 150);
  CHECK(aqr_pm_compact(&c, &m) == AQR_OK);
  size_t edges_before = 0, faces_before = 0, seen = 0;
  for (aqr_index e = 1; e < m.n_half_edges / 2; e++)
    edges_before += lesser_end(&m, e) < lesser_end(&m, e - 1);
  for (aqr_index h = 0; h < m.n_half_edges; h++)
  {
    faces_before += m.half_edges[h].face > seen; /* first met in the order of half-edges */
    seen += m.half_edges[h].face == seen;
  }
  CHECK(edges_before == 0 && faces_before == 0 && seen == m.n_faces);
  aqr_polygon_mesh_free(&c, &m);
  CHECK(c.bytes == 0);
}

AQR_TEST(a_mesh_with_no_half_edges_left_takes_no_polygon)
{
  const size_t offsets[2] = { 0, 3 };
  const aqr_index corner[3] = { 0, 1, 2 };
  const aqr_vertex v[3] = { 0 };
  aqr_context c = { 0 };
  aqr_polygon_mesh m = { .n_half_edges = AQR_NONE - 3 };
  CHECK(aqr_pm_append(&c, &m, v, 3, offsets, 1, corner) == AQR_TOO_LARGE);
  CHECK(m.n_half_edges == AQR_NONE - 3 && c.bytes == 0);
}

AQR_TEST_MAIN
