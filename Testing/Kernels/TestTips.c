/* SPDX-License-Identifier: BSD-3-Clause */
#include "test.h"

#include "cells.h"
#include "model.h"
#include "remesh.h"
#include "solids.h"
#include "tips.h"

static const double horn_height = 0.8;

/* A horn on every face of a cube. */
static vec3 sphere_to_horns(vec3 p)
{
  double c = fmax(fabs(p.x), fmax(fabs(p.y), fabs(p.z))) / v3_norm(p);
  return v3_scale(v3_unit(p), 1 + horn_height * exp((c - 1) / 0.004));
}

/* How far the mesh and the surface reach out along +-x, +-y and +-z: the least of the six ratios. */
static double least_reach(const shape* m, const aqr_mesh* mesh)
{
  double least = INFINITY;
  for (int i = 0; i < 6; i++)
  {
    double reach[2] = { 0, 0 }, sign = i % 2 ? -1 : 1;
    for (size_t v = 0; v < m->n_points; v++)
      reach[0] = fmax(reach[0], sign * m->points[3 * v + (size_t)i / 2]);
    for (size_t v = 0; v < mesh->number_of_points; v++)
      reach[1] = fmax(reach[1], sign * mesh->points[3 * v + (size_t)i / 2]);
    least = fmin(least, reach[1] / reach[0]);
  }
  return least;
}

/* With so few points no ring of lines goes around a horn near its end, and the lines that lead over it cross none. */
AQR_TEST(horns_are_not_cut_off)
{
  shape m = shape_sphere(100, 3);
  shape_map(&m, sphere_to_horns);
  for (int64_t points = 200; points <= 1600; points *= 2)
  {
    aqr_options o = options_for_points(points);
    aqr_remesher* r = remesh(&m, &o);
    survey after = survey_mesh(r ? aqr_remesher_mesh(r) : NULL);
    CHECK(!after.flaw && after.euler == 2);
    if (!after.flaw)
      CHECK_BELOW(0.9, least_reach(&m, aqr_remesher_mesh(r)));
    aqr_remesher_free(r);
  }
  shape_free(&m);
}

static double hill; /* its height */
static vec3 place_with_hill(double u, double v)
{
  return v3(u, v, hill * exp(-((u - 0.5) * (u - 0.5) + (v - 0.5) * (v - 0.5)) / 0.002));
}

/* Three by three quads over a sheet with a hill in its middle, and a bay: all points with x and y below `reach`,
 * around it the corners of one quad. The number of vertices that raising adds. */
static size_t count_raised(double height, size_t quad, double reach)
{
  hill = height;
  model e = model_surface(shape_grid(60, 60, false, false, 0, 1, place_with_hill));
  CHECK(aqr_curvature_tensors(&e.c, &e.s, 0.01, &e.t) == AQR_OK);
  aqr_polygon_mesh m = { 0 };
  CHECK(sheet_of_quads(&e.c, 3, 3, &m));
  for (size_t v = 0; v < m.n_vertices; v++)
    m.vertices[v].position = model_place(&e, m.vertices[v].position);
  aqr_index* points = malloc(e.s.n_points * sizeof *points);
  aqr_bay bays[2] = { { 0, 0 }, { 0, 4 } };
  for (aqr_index v = 0; v < e.s.n_points; v++)
  {
    vec3 p = model_shape_point(&e, aqr_point(&e.s, v));
    if (p.x < reach && p.y < reach)
      points[bays[1].points++] = v;
  }
  aqr_index border[4], h = m.faces[quad];
  for (unsigned i = 0; i < 4; i++, h = aqr_pm_next(&m, h))
    border[i] = aqr_pm_from(&m, h);
  const aqr_tips tips = {
    .s = &e.s, .normals = e.t.normal, .bays = bays, .n_bays = 1, .points = points, .border = border
  };
  const size_t before = m.n_vertices;
  CHECK(aqr_tips_raise(&e.c, &tips, &m) == AQR_OK);
  CHECK(aqr_pm_is_consistent(&m) && aqr_pm_is_regular(&m));
  CHECK(aqr_pm_euler(&m) == 1);
  const size_t raised = m.n_vertices - before;
  for (size_t v = before; v < m.n_vertices; v++)
    CHECK(aqr_pm_valence(&m, (aqr_index)v) >= 3);
  aqr_polygon_mesh_free(&e.c, &m);
  free(points);
  model_free(&e);
  return raised;
}

AQR_TEST(low_hills_get_no_vertex)
{
  CHECK(count_raised(0, 4, 1) == 0);
  CHECK(count_raised(0.1, 4, 1) == 0);
}

AQR_TEST(a_high_hill_gets_a_vertex_at_its_top)
{
  for (double height = 0.25; height < 0.6; height += 0.05)
    CHECK(count_raised(height, 4, 0.65) == 1);
}

/* The bay reaches over the quad that is next to it, or a vertex would be put there. */
AQR_TEST(a_bay_that_another_face_stands_for_is_left_alone)
{
  CHECK(count_raised(0, 0, 0.65) == 0);
}

/* It lies on the next quad: the face with the most corners around the bay would reach over to it. */
AQR_TEST(a_face_is_raised_to_the_tip_on_another)
{
  CHECK(count_raised(0.18, 4, 0.65) == 1);
  CHECK(count_raised(0.18, 0, 0.65) == 0);
}

/* Rings around a cone end where they are as small as their spacing: the cone was cut off there, by up to a tenth of its
 * height. */
AQR_TEST(the_point_of_a_cone_is_cut_off)
{
  enum
  {
    sides = 512
  };
  static double points[3 * (sides + 2)];
  static int64_t triangles[6 * sides];
  for (int64_t i = 0; i < sides; i++)
  {
    double a = shape_turn * (double)i / sides;
    const int64_t next = (i + 1) % sides, t[6] = { sides, i, next, sides + 1, next, i };
    memcpy(triangles + 6 * i, t, sizeof t);
    v3_store(points + 3 * i, v3(cos(a), sin(a), 0));
  }
  points[3 * sides + 2] = 3;
  aqr_input input = {
    .number_of_points = sides + 2, .points_d = points, .number_of_triangles = 2 * sides, .triangles = triangles
  };
  aqr_options o = aqr_default_options();
  o.density = AQR_DENSITY_POINTS;
  for (int64_t asked = 200; asked < 1000; asked += 100)
  {
    o.target_points = asked;
    aqr_remesher* r = NULL;
    CHECK(aqr_remesher_new(NULL, &r) == AQR_OK && aqr_remesher_set_input(r, &input) == AQR_OK);
    CHECK(aqr_remesher_run(r, &o) == AQR_OK);
    const aqr_mesh* m = aqr_remesher_mesh(r);
    double highest = 0;
    for (size_t v = 0; v < m->number_of_points; v++)
      highest = fmax(highest, m->points[3 * v + 2]);
    CHECK_BELOW(3 - highest, 0.03);
    aqr_remesher_free(r);
  }
}

AQR_TEST_MAIN
