/* SPDX-License-Identifier: BSD-3-Clause */
#include "test.h"

#include "cells.h"
#include "coarsen.h"

/* Coarsens a whole grid to about `points` vertices behind what m holds. */
static aqr_status coarsen_grid(aqr_context* c, size_t nu, size_t nv, bool closed, aqr_vertex (*place)(double, double),
  size_t points, aqr_polygon_mesh* m)
{
  aqr_context plain = { 0 };
  aqr_surface s;
  if (!surface_of_grid(&plain, nu, nv, closed, place, &s))
    return AQR_INTERNAL;
  aqr_index* faces = malloc(s.n_faces * sizeof *faces);
  double* normals = malloc(3 * s.n_points * sizeof *normals);
  aqr_field field = { .normal = normals };
  for (aqr_index f = 0; f < s.n_faces; f++)
    faces[f] = f;
  for (size_t f = 0; f < s.n_faces; f++)
    for (unsigned i = 0; i < 3; i++)
      v3_store(normals + 3 * (size_t)s.corner[3 * f + i], v3_unit(aqr_face_cross(&s, (aqr_index)f)));
  aqr_status status = aqr_coarsen_component(c, &s, &field, faces, s.n_faces, points, m);
  free(faces);
  free(normals);
  free_surface(&s);
  return status;
}

/* Of the middles of edges from the torus. */
static double farthest_from_torus(const aqr_polygon_mesh* m, vec3 centre, double size)
{
  double farthest = 0;
  for (aqr_index h = 0; h < m->n_half_edges; h += 2)
  {
    vec3 q = v3_scale(v3_add(aqr_pm_point(m, aqr_pm_from(m, h)), aqr_pm_point(m, aqr_pm_to(m, h))), 0.5);
    q = v3_scale(v3_sub(q, centre), 1 / size);
    farthest = fmax(farthest, fabs(hypot(hypot(q.x, q.y) - 1, q.z) - 0.4));
  }
  return farthest;
}

AQR_TEST(a_coarsened_torus_keeps_its_handle_and_its_shape)
{
  aqr_context c = { 0 };
  aqr_polygon_mesh m = { 0 };
  CHECK(coarsen_grid(&c, 40, 20, true, on_torus, 80, &m) == AQR_OK);
  CHECK(aqr_pm_is_consistent(&m) && aqr_pm_is_regular(&m) && aqr_pm_euler(&m) == 0);
  CHECK(m.n_vertices == 80 && m.n_faces == 160);
  CHECK_BELOW(farthest_from_torus(&m, v3(0, 0, 0), 1), 0.2);
  for (size_t f = 0; f < m.n_faces; f++)
  {
    aqr_index h = m.faces[f];
    vec3 a = aqr_pm_point(&m, aqr_pm_from(&m, h)), b = aqr_pm_point(&m, aqr_pm_to(&m, h));
    vec3 d = aqr_pm_point(&m, aqr_pm_from(&m, aqr_pm_prev(&m, h)));
    vec3 q = v3_scale(v3_add(a, v3_add(b, d)), 1.0 / 3);
    double r = hypot(q.x, q.y);
    CHECK(v3_dot(v3_cross(v3_sub(b, a), v3_sub(d, a)), v3(q.x * (1 - 1 / r), q.y * (1 - 1 / r), q.z)) > 0);
  }
  aqr_polygon_mesh_free(&c, &m);
  CHECK(c.bytes == 0);
}

static const vec3 speck_centre = { 0.4, 0.2, -0.3 };
static const double speck_size = 1e-8;

static aqr_vertex on_speck(double s, double t)
{
  aqr_vertex v = on_torus(s, t);
  v.position = v3_madd(speck_centre, speck_size, v.position);
  return v;
}

AQR_TEST(a_coarsened_speck_far_from_the_middle_keeps_its_shape)
{
  aqr_context c = { 0 };
  aqr_polygon_mesh m = { 0 };
  CHECK(coarsen_grid(&c, 40, 20, true, on_speck, 80, &m) == AQR_OK);
  CHECK(aqr_pm_is_regular(&m) && aqr_pm_euler(&m) == 0 && m.n_vertices == 80);
  CHECK_BELOW(farthest_from_torus(&m, speck_centre, speck_size), 0.2);
  aqr_polygon_mesh_free(&c, &m);
}

AQR_TEST(coarsening_a_sheet_turns_no_triangle)
{
  aqr_context c = { 0 };
  aqr_polygon_mesh m = { 0 };
  CHECK(coarsen_grid(&c, 24, 24, false, on_sheet, 60, &m) == AQR_OK);
  for (size_t f = 0; f < m.n_faces; f++)
  {
    aqr_index h = m.faces[f];
    vec3 a = aqr_pm_point(&m, aqr_pm_from(&m, h)), b = aqr_pm_point(&m, aqr_pm_to(&m, h));
    vec3 d = aqr_pm_point(&m, aqr_pm_from(&m, aqr_pm_prev(&m, h)));
    CHECK(v3_cross(v3_sub(b, a), v3_sub(d, a)).z > 0);
  }
  aqr_polygon_mesh_free(&c, &m);
}

AQR_TEST(coarsening_to_almost_nothing_stops_at_a_valid_mesh)
{
  aqr_context c = { 0 };
  aqr_polygon_mesh m = { 0 };
  CHECK(coarsen_grid(&c, 20, 10, true, on_torus, 1, &m) == AQR_OK);
  CHECK(aqr_pm_is_consistent(&m) && aqr_pm_is_regular(&m) && aqr_pm_euler(&m) == 0);
  CHECK(m.n_vertices < 100);
  aqr_polygon_mesh_free(&c, &m);
}

AQR_TEST(a_coarsened_sheet_keeps_its_four_corners)
{
  aqr_context c = { 0 };
  aqr_polygon_mesh m = { 0 };
  CHECK(coarsen_grid(&c, 20, 20, false, on_sheet, 4, &m) == AQR_OK);
  CHECK(aqr_pm_is_consistent(&m) && aqr_pm_is_regular(&m) && aqr_pm_euler(&m) == 1);
  CHECK(m.n_vertices == 4 && m.n_faces == 2);
  for (size_t v = 0; v < m.n_vertices; v++)
  {
    vec3 p = m.vertices[v].position;
    CHECK((p.x == 0 || p.x == 1) && (p.y == 0 || p.y == 1));
  }
  aqr_polygon_mesh_free(&c, &m);
}

AQR_TEST(a_small_component_passes_as_it_is_and_leaves_the_mesh_before_it_alone)
{
  aqr_context c = { 0 };
  aqr_polygon_mesh m = { 0 };
  CHECK(torus_of_quads(&c, 9, 6, &m));
  CHECK(coarsen_grid(&c, 3, 2, false, on_sheet, 100, &m) == AQR_OK);
  CHECK(m.n_vertices == 54 + 12 && m.n_faces == 54 + 12);
  CHECK(aqr_pm_is_consistent(&m) && aqr_pm_is_regular(&m) && aqr_pm_euler(&m) == 1);
  CHECK(aqr_pm_face_size(&m, 53) == 4 && aqr_pm_face_size(&m, 54) == 3);
  aqr_polygon_mesh_free(&c, &m);
  CHECK(c.bytes == 0);
}

AQR_TEST(coarsening_that_runs_out_of_memory_leaves_nothing_behind)
{
  unsigned failed = 0;
  for (size_t allowed = 0; allowed < 60; allowed++)
  {
    ration r = { allowed };
    aqr_context c = { .hooks = { .user = &r, .reallocate = rationed } };
    aqr_polygon_mesh m = { 0 };
    aqr_status status = coarsen_grid(&c, 9, 6, true, on_torus, 20, &m);
    failed += status != AQR_OK;
    CHECK(status != AQR_OK || aqr_pm_is_regular(&m));
    aqr_polygon_mesh_free(&c, &m);
    CHECK(c.bytes == 0);
  }
  CHECK(failed > 5 && failed < 60);
}

AQR_TEST_MAIN
