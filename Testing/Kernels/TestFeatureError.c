/* SPDX-License-Identifier: BSD-3-Clause */
/* The distance of creases and borders from the output's edges, where it is known. */
#include "feature_error.h"
#include "model.h"
#include "remesh.h"
#include "solids.h"

/* A sheet of n by n quads in the unit square and, on top of it, one quad whose corners were moved outwards. */
static void measure_moved_quad(double moved, aqr_distance* features, aqr_distance* boundary)
{
  model e = model_surface(shape_grid(7, 7, false, false, 0.3, 1, place_on_plane));
  aqr_chains chains = { 0 };
  aqr_polygon_mesh m = { 0 };
  CHECK(aqr_chains_build(&e.c, &e.s, 45, &chains) == AQR_OK);
  const double corner[4][2] = { { 0, 0 }, { 1, 0 }, { 1, 1 }, { 0, 1 } };
  aqr_vertex vertices[4];
  for (int i = 0; i < 4; i++)
  {
    double x = corner[i][0], y = corner[i][1];
    vertices[i] = (aqr_vertex){ .position = model_place(&e, v3(x + moved * (2 * x - 1), y + moved * (2 * y - 1), 0)),
      .normal = v3(0, 0, 1),
      .kind = AQR_VERTEX_CORNER };
  }
  const size_t offsets[2] = { 0, 4 };
  const aqr_index corners[4] = { 0, 1, 2, 3 };
  CHECK(aqr_pm_append(&e.c, &m, vertices, 4, offsets, 1, corners) == AQR_OK);
  CHECK(aqr_feature_error(&e.c, &e.s, &chains, &m, features, boundary) == AQR_OK);
  aqr_polygon_mesh_free(&e.c, &m);
  aqr_chains_free(&e.c, &chains);
  model_free(&e);
}

AQR_TEST(a_border_that_was_moved_away_is_as_far_as_it_was_moved)
{
  aqr_distance features, boundary;
  const double diagonal = sqrt(2);
  for (double moved = 0; moved < 0.3; moved += 0.1)
  {
    measure_moved_quad(moved, &features, &boundary);
    CHECK_BELOW(fabs(boundary.rms - moved / diagonal), 1e-12);
    CHECK_BELOW(fabs(boundary.largest - moved / diagonal), 1e-12);
    CHECK(!(features.rms > 0) && !(features.largest > 0));
  }
}

/* Of the rims of a can the chords depart, of its smooth side nothing counts; a cube's edges are straight. */
AQR_TEST(rims_depart_by_their_chords_and_straight_edges_not_at_all)
{
  shape can = shape_can(24, 1), cube = shape_cube(12, 0.2, 2), sheet = shape_cylinder(30, 3);
  aqr_options o = options_for_points(400);
  aqr_remesher* r = remesh(&can, &o);
  const aqr_mesh* m = aqr_remesher_mesh(r);
  const aqr_report* report = aqr_remesher_report(r);
  double chords = 0, diagonal = sqrt(1 + 1 + 4); /* radius 0.5, from -1 to 1 */
  for (size_t f = 0; f < m->number_of_faces; f++)
    for (int64_t k = m->offsets[f]; k < m->offsets[f + 1]; k++)
    {
      vec3 a = v3_load(m->points + 3 * m->connectivity[k]);
      vec3 b = v3_load(m->points + 3 * m->connectivity[k + 1 < m->offsets[f + 1] ? k + 1 : m->offsets[f]]);
      double z = fabs(a.z + b.z) / 2;
      bool on_rim = z > 0.999 && fabs(a.z - b.z) < 1e-3 && hypot(a.x, a.y) > 0.49 && hypot(b.x, b.y) > 0.49;
      if (on_rim)
        chords = fmax(chords, 0.5 - hypot(a.x + b.x, a.y + b.y) / 2);
    }
  printf("can: deepest chord %g\n", chords / diagonal);
  CHECK_BELOW(fabs(report->feature_max - chords / diagonal), 0.3 * chords / diagonal);
  CHECK_BELOW(report->feature_rms, report->feature_max);
  CHECK(report->feature_rms > 0.3 * report->feature_max && !(report->boundary_max > 0));
  aqr_remesher_free(r);
  r = remesh(&cube, &o);
  CHECK_BELOW(aqr_remesher_report(r)->feature_max, 1e-9);
  aqr_remesher_free(r);
  r = remesh(&sheet, &o);
  report = aqr_remesher_report(r);
  CHECK(!(report->feature_max > 0));
  CHECK_BELOW(report->boundary_max, 3 * report->tolerance);
  double kept = report->boundary_rms;
  o.boundary_lines = 0;
  CHECK(aqr_remesher_run(r, &o) == AQR_OK);
  printf("border cut coarsely: %g, as a line: %g\n", report->boundary_rms, kept);
  CHECK(report->boundary_rms > 1.5 * kept);
  aqr_remesher_free(r);
  shape_free(&can);
  shape_free(&cube);
  shape_free(&sheet);
}

AQR_TEST_MAIN
