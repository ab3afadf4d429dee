/* SPDX-License-Identifier: BSD-3-Clause */
#include "test.h"

#include "cells.h"
#include "faces.h"
#include "partition.h"
#include "regularize.h"
#include "shapes.h"

static const aqr_faces_options usual = { .convex_partition = true, .largest_valence = 5 };

static size_t count_quads(const aqr_polygon_mesh* m)
{
  size_t n = 0;
  for (aqr_index f = 0; f < m->n_faces; f++)
    n += m->faces[f] != AQR_NONE && aqr_pm_face_size(m, f) == 4;
  return n;
}

AQR_TEST(any_cell_decomposition_ends_as_a_valid_mesh_of_the_same_topology)
{
  for (unsigned seed = 1; seed <= 300; seed++)
  {
    aqr_context c = { 0 };
    aqr_polygon_mesh m = { 0 };
    bool open = seed % 2;
    CHECK(open ? sheet_of_quads(&c, 9, 8, &m) : torus_of_quads(&c, 12, 8, &m));
    disturb(&c, &m, seed, 20 + seed);
    CHECK(aqr_faces_finish(&c, &m, &usual) == AQR_OK);
    CHECK(aqr_pm_is_consistent(&m) && aqr_pm_is_regular(&m));
    CHECK(aqr_pm_euler(&m) == (open ? 1 : 0));
    aqr_polygon_mesh_free(&c, &m);
    CHECK(c.bytes == 0);
  }
}

/* One polygon of n corners around a circle, with a wall behind each side. */
AQR_TEST(a_polygon_of_some_number_of_corners_is_left_whole)
{
  for (size_t n = 3; n <= 70; n++)
  {
    aqr_context c = { 0 };
    aqr_polygon_mesh m = { 0 };
    aqr_vertex* v = malloc(2 * n * sizeof *v);
    size_t* offsets = malloc((n + 2) * sizeof *offsets);
    aqr_index* corner = malloc(5 * n * sizeof *corner);
    for (size_t i = 0; i < 2 * n; i++)
    {
      double a = shape_turn * (double)(i % n) / (double)n, r = i < n ? 1 : 1.1;
      v[i] = (aqr_vertex){ .position = v3(r * cos(a), r * sin(a), 0), .normal = v3(0, 0, 1), .size = 0.01 };
      v[i].out = AQR_NONE;
    }
    offsets[0] = 0;
    offsets[1] = n;
    for (size_t i = 0; i < n; i++)
    {
      const size_t next = (i + 1) % n, wall[4] = { i, n + i, n + next, next };
      corner[i] = (aqr_index)i;
      offsets[i + 2] = offsets[i + 1] + 4;
      for (size_t k = 0; k < 4; k++)
        corner[n + 4 * i + k] = (aqr_index)wall[k];
    }
    CHECK(aqr_pm_append(&c, &m, v, 2 * n, offsets, n + 1, corner) == AQR_OK);
    CHECK(aqr_faces_finish(&c, &m, &usual) == AQR_OK);
    for (aqr_index f = 0; f < m.n_faces; f++)
      CHECK(m.faces[f] == AQR_NONE || aqr_pm_face_size(&m, f) <= 5);
    aqr_polygon_mesh_free(&c, &m);
    free(v);
    free(offsets);
    free(corner);
  }
}

AQR_TEST(a_perfect_lattice_is_left_alone)
{
  aqr_context c = { 0 };
  aqr_polygon_mesh m = { 0 };
  CHECK(torus_of_quads(&c, 16, 10, &m));
  CHECK(aqr_faces_finish(&c, &m, &usual) == AQR_OK);
  CHECK(m.n_vertices == 160 && m.n_faces == 160 && count_quads(&m) == 160);
  aqr_polygon_mesh_free(&c, &m);
}

AQR_TEST(corners_of_the_boundary_stay_where_they_are)
{
  for (unsigned seed = 1; seed <= 50; seed++)
  {
    aqr_context c = { 0 };
    aqr_polygon_mesh m = { 0 };
    CHECK(sheet_of_quads(&c, 9, 8, &m));
    for (size_t v = 0; v < m.n_vertices; v++)
      m.vertices[v].size = 10; /* everything is near to everything */
    CHECK(aqr_faces_finish(&c, &m, &usual) == AQR_OK);
    unsigned corners = 0;
    for (size_t v = 0; v < m.n_vertices; v++)
    {
      vec3 p = m.vertices[v].position;
      bool border = p.x == 0 || p.x == 1 || p.y == 0 || p.y == 1;
      CHECK(border == aqr_pm_on_border(&m, (aqr_index)v));
      corners += (p.x == 0 || p.x == 1) && (p.y == 0 || p.y == 1);
    }
    CHECK(corners == 4);
    aqr_polygon_mesh_free(&c, &m);
  }
}

/* A crease around the torus, drawn along one ring of its grid. */
AQR_TEST(a_crease_stays_closed_and_on_its_curve)
{
  for (unsigned seed = 1; seed <= 100; seed++)
  {
    aqr_context c = { 0 };
    aqr_polygon_mesh m = { 0 };
    unsigned edges = 0, on_crease = 0, placed = 0;
    CHECK(torus_of_quads(&c, 24, 8, &m));
    for (size_t v = 0; v < m.n_vertices; v += 8)
    {
      m.vertices[v].kind = AQR_VERTEX_FEATURE;
      m.vertices[v].place.bary[0] = 1;
      aqr_index h = aqr_pm_find(&m, (aqr_index)v, (aqr_index)((v + 8) % m.n_vertices));
      m.edge_type[h >> 1] = AQR_LINE_FEATURE;
    }
    unsigned state = seed;
    for (unsigned k = 0; k < 150; k++)
    {
      aqr_index h = next_random(&state) % (aqr_index)m.n_half_edges;
      if (aqr_pm_edge_lives(&m, h) && !aqr_pm_on_chain(&m, h))
        aqr_pm_remove_edge(&m, h);
    }
    CHECK(aqr_faces_finish(&c, &m, &usual) == AQR_OK);
    for (aqr_index h = 0; h < m.n_half_edges; h += 2)
      if (m.edge_type[h >> 1] == AQR_LINE_FEATURE)
      {
        const aqr_vertex* v = &m.vertices[aqr_pm_from(&m, h)];
        double r = hypot(v->position.x, v->position.y);
        /* a line that goes on across it leaves a vertex on its chord, which comes to the curve with its place */
        bool has_place = v->place.bary[0] > 0;
        edges++;
        placed += has_place;
        CHECK(v->kind == AQR_VERTEX_FEATURE && fabs(v->position.z) < 1e-9);
        CHECK(has_place ? fabs(r - 1.4) < 1e-9 : r < 1.4);
      }
    for (size_t v = 0; v < m.n_vertices; v++)
      on_crease += m.vertices[v].kind == AQR_VERTEX_FEATURE;
    CHECK(placed >= 3 && 2 * placed >= edges && on_crease == edges);
    aqr_polygon_mesh_free(&c, &m);
  }
}

/* Removes the grid lines' edges between two points of the unit sheet with n cells a side. */
static void erase(aqr_polygon_mesh* m, vec3 from, vec3 to)
{
  for (aqr_index h = 0; h < m->n_half_edges; h += 2)
  {
    if (!aqr_pm_edge_lives(m, h))
      continue;
    vec3 p = v3_scale(v3_add(aqr_pm_point(m, aqr_pm_from(m, h)), aqr_pm_point(m, aqr_pm_to(m, h))), 0.5);
    vec3 d = v3_sub(to, from), e = v3_sub(p, from);
    double t = v3_dot(d, e) / v3_norm2(d);
    if (t > 0 && t < 1 && v3_norm(v3_madd(e, -t, d)) < 1e-6)
      aqr_pm_remove_edge(m, h);
  }
}

/* Lines with gaps everywhere, as sampling leaves them. */
AQR_TEST(lines_with_gaps_give_more_quads_than_they_left_and_no_loose_vertex)
{
  for (unsigned seed = 1; seed <= 10; seed++)
  {
    aqr_context c = { 0 };
    aqr_polygon_mesh m = { 0 };
    unsigned state = seed;
    size_t before, faces = 0;
    CHECK(sheet_of_quads(&c, 24, 24, &m));
    for (unsigned k = 0; k < 60; k++)
    {
      double a = (next_random(&state) % 20) / 24.0, b = a + (1 + next_random(&state) % 6) / 24.0;
      double at = (1 + 2 * (next_random(&state) % 12)) / 24.0;
      erase(&m, k % 2 ? v3(a, at, 0) : v3(at, a, 0), k % 2 ? v3(b, at, 0) : v3(at, b, 0));
    }
    CHECK(aqr_tidy(&c, &m) == AQR_OK);
    before = count_quads(&m);
    for (size_t f = 0; f < m.n_faces; f++)
      faces += m.faces[f] != AQR_NONE;
    CHECK(aqr_faces_finish(&c, &m, &usual) == AQR_OK);
    CHECK((double)count_quads(&m) / (double)m.n_faces > (double)before / (double)faces + 0.03);
    for (size_t v = 0; v < m.n_vertices; v++)
      CHECK(aqr_pm_on_border(&m, (aqr_index)v) || aqr_pm_valence(&m, (aqr_index)v) > 2);
    aqr_polygon_mesh_free(&c, &m);
  }
}

AQR_TEST(concave_faces_are_split)
{
  aqr_context c = { 0 };
  aqr_polygon_mesh m = { 0 };
  CHECK(sheet_of_quads(&c, 8, 8, &m));
  /* an L of three cells with sides of four, two and two */
  erase(&m, v3(0.25, 0.375, 0), v3(0.75, 0.375, 0));
  erase(&m, v3(0.25, 0.5, 0), v3(0.5, 0.5, 0));
  erase(&m, v3(0.25, 0.625, 0), v3(0.5, 0.625, 0));
  erase(&m, v3(0.375, 0.25, 0), v3(0.375, 0.75, 0));
  erase(&m, v3(0.5, 0.25, 0), v3(0.5, 0.5, 0));
  erase(&m, v3(0.625, 0.25, 0), v3(0.625, 0.5, 0));
  CHECK(aqr_faces_finish(&c, &m, &usual) == AQR_OK);
  for (aqr_index h = 0; h < m.n_half_edges; h++)
  {
    vec3 a = aqr_pm_point(&m, aqr_pm_from(&m, aqr_pm_prev(&m, h))), b = aqr_pm_point(&m, aqr_pm_from(&m, h));
    vec3 n = v3_cross(v3_sub(b, a), v3_sub(aqr_pm_point(&m, aqr_pm_to(&m, h)), b));
    CHECK(aqr_pm_face(&m, h) == AQR_NONE || n.z > -1e-12);
  }
  aqr_polygon_mesh_free(&c, &m);
}

/* The normal kept for a vertex of a crease may be that of the other side. */
AQR_TEST(a_concave_corner_on_a_crease_is_seen_from_its_face)
{
  const vec3 corner[6] = { { 0, 0, 0 }, { 2, 0, 0 }, { 2, 1, 0 }, { 1, 1, 0 }, { 1, 2, 0 }, { 0, 2, 0 } };
  aqr_polygon g = { .n = 0 };
  for (unsigned i = 0; i < 6; i++)
  {
    aqr_vertex v = { .position = corner[i], .normal = { 0, 0, 1 }, .kind = AQR_VERTEX_INTERIOR };
    if (i == 3)
    {
      v.normal = v3(1, 0, 0);
      v.kind = AQR_VERTEX_FEATURE;
    }
    aqr_polygon_add(&g, i, &v);
  }
  CHECK_BELOW(fabs(aqr_polygon_angle(&g, 3) - 1.5 * 3.14159265358979), 1e-9);
  CHECK(aqr_polygon_is_concave(&g));
}

static aqr_vertex on_comb(double s, double t)
{
  aqr_vertex v = on_sheet(s, t);
  v.position.y += fmod(floor(s * 12 + 0.5), 2) * 0.03;
  v.size = 10;
  return v;
}

AQR_TEST(bends_of_a_boundary_are_kept)
{
  aqr_context c = { 0 };
  aqr_polygon_mesh m = { 0 };
  unsigned teeth = 0;
  CHECK(grid_of_quads(&c, 12, 12, false, on_comb, &m));
  CHECK(aqr_faces_finish(&c, &m, &usual) == AQR_OK);
  for (size_t v = 0; v < m.n_vertices; v++)
    teeth += aqr_pm_on_border(&m, (aqr_index)v) && m.vertices[v].position.y < 0.04;
  CHECK(teeth == 13);
  aqr_polygon_mesh_free(&c, &m);
}

/* A line with a gap of two cells: between its two ends it goes on. */
AQR_TEST(lines_that_end_towards_each_other_are_joined)
{
  aqr_context c = { 0 };
  aqr_polygon_mesh m = { 0 };
  CHECK(sheet_of_quads(&c, 10, 10, &m));
  erase(&m, v3(0.4, 0.5, 0), v3(0.7, 0.5, 0));
  CHECK(count_quads(&m) == 94);
  CHECK(aqr_tidy(&c, &m) == AQR_OK);
  CHECK(count_quads(&m) == 95);
  CHECK(aqr_faces_finish(&c, &m, &usual) == AQR_OK);
  CHECK(count_quads(&m) == 100 && m.n_faces == 100 && m.n_vertices == 121);
  aqr_polygon_mesh_free(&c, &m);
}

/* The same with a crease across the gap, where neither line has a vertex. */
/* Makes a crease of the edges of a sheet along y. */
static void draw_crease(aqr_polygon_mesh* m, double y)
{
  for (aqr_index h = 0; h < m->n_half_edges; h += 2)
  {
    if (!aqr_pm_edge_lives(m, h))
      continue;
    aqr_vertex* end[2] = { &m->vertices[aqr_pm_from(m, h)], &m->vertices[aqr_pm_to(m, h)] };
    if (fabs(end[0]->position.y - y) > 1e-9 || fabs(end[1]->position.y - y) > 1e-9)
      continue;
    m->edge_type[h >> 1] = AQR_LINE_FEATURE;
    for (unsigned i = 0; i < 2; i++)
      end[i]->kind = end[i]->kind == AQR_VERTEX_BOUNDARY ? AQR_VERTEX_CORNER : AQR_VERTEX_FEATURE;
  }
}

AQR_TEST(lines_that_end_towards_each_other_are_joined_across_a_crease)
{
  aqr_context c = { 0 };
  aqr_polygon_mesh m = { 0 };
  unsigned on_crease = 0;
  CHECK(sheet_of_quads(&c, 10, 10, &m));
  erase(&m, v3(0.5, 0.4, 0), v3(0.5, 0.7, 0));
  for (aqr_index v = 0; v < m.n_vertices; v++)
  {
    vec3 p = m.vertices[v].position;
    if (fabs(p.y - 0.5) < 1e-9 && fabs(p.x - 0.5) < 1e-9)
      CHECK(aqr_pm_join_edges(&m, v));
  }
  draw_crease(&m, 0.5);
  CHECK(aqr_faces_finish(&c, &m, &usual) == AQR_OK);
  CHECK(count_quads(&m) == 100 && m.n_faces == 100 && m.n_vertices == 121);
  for (aqr_index h = 0; h < m.n_half_edges; h += 2)
    on_crease += m.edge_type[h >> 1] == AQR_LINE_FEATURE;
  CHECK(on_crease == 10);
  aqr_polygon_mesh_free(&c, &m);
}

/* A line that ends one cell before the border goes on to it. */
AQR_TEST(a_line_that_ends_short_of_the_border_reaches_it)
{
  aqr_context c = { 0 };
  aqr_polygon_mesh m = { 0 };
  CHECK(sheet_of_quads(&c, 10, 10, &m));
  erase(&m, v3(0.9, 0.5, 0), v3(1, 0.5, 0));
  CHECK(aqr_faces_finish(&c, &m, &usual) == AQR_OK);
  CHECK(count_quads(&m) == 100 && m.n_faces == 100 && m.n_vertices == 121);
  aqr_polygon_mesh_free(&c, &m);
}

/* On a sheet of 7 by 7 quads a line from either side ends on a third, `apart` from each other. */
static void face_t_joints(aqr_context* c, aqr_polygon_mesh* m, double apart)
{
  aqr_index v = AQR_NONE, a, h;
  for (aqr_index i = 0; i < m->n_vertices; i++)
    if (fabs(m->vertices[i].position.x - 3.0 / 7) < 1e-9 && fabs(m->vertices[i].position.y - 3.0 / 7) < 1e-9)
      v = i;
  h = m->vertices[v].out;
  for (unsigned k = 0; k < 4 && aqr_pm_point(m, aqr_pm_to(m, h)).x < 3.0 / 7 + 0.1; k++)
    h = aqr_pm_next_around(m, h);
  aqr_vertex beside = m->vertices[v];
  beside.position.x += apart;
  CHECK(aqr_pm_split_edge(c, m, h, &beside, &a) == AQR_OK);
  /* the line that came from below at v now ends at a */
  aqr_index up = aqr_pm_prev(m, h) ^ 1, top = aqr_pm_next(m, up);
  aqr_index onto = aqr_pm_next(m, h);
  CHECK(aqr_pm_remove_edge(m, up));
  CHECK(aqr_pm_split_face(c, m, onto, top, AQR_LINE_MIN) == AQR_OK);
  CHECK(count_quads(m) == 47);
}

AQR_TEST(t_joints_that_face_each_other_become_one_crossing)
{
  aqr_context c = { 0 };
  aqr_polygon_mesh m = { 0 };
  CHECK(sheet_of_quads(&c, 7, 7, &m));
  face_t_joints(&c, &m, 0.05);
  CHECK(aqr_faces_finish(&c, &m, &usual) == AQR_OK);
  CHECK(count_quads(&m) == 49 && m.n_faces == 49);
  aqr_polygon_mesh_free(&c, &m);
}

AQR_TEST(lines_that_end_at_one_place_of_a_crease_leave_an_edge_without_length)
{
  aqr_context c = { 0 };
  aqr_polygon_mesh m = { 0 };
  CHECK(sheet_of_quads(&c, 7, 7, &m));
  draw_crease(&m, 3.0 / 7);
  face_t_joints(&c, &m, 0);
  CHECK(aqr_faces_finish(&c, &m, &usual) == AQR_OK);
  CHECK(count_quads(&m) == 49 && m.n_faces == 49 && m.n_vertices == 64);
  aqr_polygon_mesh_free(&c, &m);
}

AQR_TEST(no_face_has_more_corners_than_asked_for)
{
  for (int largest = 4; largest <= 6; largest++)
  {
    aqr_context c = { 0 };
    aqr_polygon_mesh m = { 0 };
    aqr_faces_options o = { .convex_partition = true, .largest_valence = largest };
    CHECK(sheet_of_quads(&c, 12, 12, &m));
    for (aqr_index h = 0; h < m.n_half_edges; h += 2)
    {
      vec3 p = aqr_pm_point(&m, aqr_pm_from(&m, h)), q = aqr_pm_point(&m, aqr_pm_to(&m, h));
      vec3 mid = v3_scale(v3_add(p, q), 0.5);
      if (mid.x > 0.3 && mid.x < 0.7 && mid.y > 0.3 && mid.y < 0.7)
        aqr_pm_remove_edge(&m, h);
    }
    CHECK(aqr_faces_finish(&c, &m, &o) == AQR_OK);
    for (aqr_index f = 0; f < m.n_faces; f++)
      CHECK((int)aqr_pm_face_size(&m, f) <= largest);
    aqr_polygon_mesh_free(&c, &m);
  }
}

AQR_TEST(running_out_of_memory_leaves_nothing_behind)
{
  unsigned failed = 0;
  for (size_t allowed = 0; allowed < 60; allowed++)
  {
    ration r = { SIZE_MAX };
    aqr_context c = { .hooks = { .user = &r, .reallocate = rationed } };
    aqr_polygon_mesh m = { 0 };
    CHECK(torus_of_quads(&c, 12, 8, &m));
    disturb(&c, &m, 5, 200);
    r.left = allowed;
    aqr_status status = aqr_faces_finish(&c, &m, &usual);
    CHECK(status == AQR_OK || status == AQR_OUT_OF_MEMORY);
    failed += status != AQR_OK;
    CHECK(status != AQR_OK || aqr_pm_is_regular(&m));
    aqr_polygon_mesh_free(&c, &m);
    CHECK(c.bytes == 0);
  }
  CHECK(failed > 5 && failed < 60);
}

/* A limb with a ring of four around it and a line that leads over its tip, where nothing else goes: the vertex there
 * has that line's edges only. Over a flat end it is not worth keeping. */
AQR_TEST(the_tip_of_a_limb_is_not_cut_off)
{
  const size_t offsets[8] = { 0, 4, 8, 12, 16, 20, 24, 28 };
  const aqr_index corner[28] = { 7, 6, 5, 4, 0, 1, 2, 8, 2, 3, 0, 8, 0, 4, 5, 1, 1, 5, 6, 2, 2, 6, 7, 3, 3, 7, 4, 0 };
  for (int flat = 0; flat < 2; flat++)
  {
    aqr_context c = { 0 };
    aqr_polygon_mesh m = { 0 };
    aqr_vertex v[9];
    for (unsigned i = 0; i < 9; i++)
    {
      double a = i * 1.57079632679489662;
      vec3 p = i < 8 ? v3(cos(a), sin(a), i < 4 ? 0 : -1) : v3(0, 0, flat ? 0 : 4);
      v[i] = (aqr_vertex){ .position = p, .normal = i < 8 && !flat ? v3(cos(a), sin(a), 0) : v3(0, 0, 1), .size = 1 };
    }
    CHECK(aqr_pm_append(&c, &m, v, 9, offsets, 7, corner) == AQR_OK);
    CHECK(aqr_faces_finish(&c, &m, &usual) == AQR_OK);
    CHECK(aqr_pm_is_regular(&m));
    CHECK(m.n_vertices == (flat ? 8 : 9));
    aqr_polygon_mesh_free(&c, &m);
    CHECK(c.bytes == 0);
  }
}

AQR_TEST_MAIN
