/* SPDX-License-Identifier: BSD-3-Clause */
#include "test.h"

#include "solids.h"

static double points_over_asked(const shape* m, int64_t asked)
{
  aqr_input input = shape_input(m);
  aqr_options o = aqr_default_options();
  aqr_remesher* r = NULL;
  double ratio = 0;
  o.density = AQR_DENSITY_POINTS;
  o.target_points = asked;
  CHECK(aqr_remesher_new(NULL, &r) == AQR_OK);
  CHECK(aqr_remesher_set_input(r, &input) == AQR_OK);
  CHECK(aqr_remesher_run(r, &o) == AQR_OK);
  if (aqr_remesher_mesh(r))
    ratio = (double)aqr_remesher_mesh(r)->number_of_points / (double)asked;
  aqr_remesher_free(r);
  return ratio;
}

/* Without curvature no tolerance, however small, brings lines nearer together. */
AQR_TEST(a_flat_sheet_gets_the_points_asked_for)
{
  shape m = shape_grid(60, 60, false, false, 0.2, 1, place_on_plane);
  const int64_t asked[] = { 150, 500, 1800 };
  for (int i = 0; i < 3; i++)
    CHECK_BELOW(fabs(points_over_asked(&m, asked[i]) - 1), 0.03);
  shape_free(&m);
}

/* The largest spacing alone would give several hundred. A loop more or less is some eight points. */
AQR_TEST(few_points_are_met_beyond_the_largest_spacing)
{
  shape m = shape_torus(30, 2);
  const int64_t asked[] = { 100, 200, 300 };
  for (int i = 0; i < 3; i++)
    CHECK_BELOW(fabs(points_over_asked(&m, asked[i]) - 1), 0.04);
  shape_free(&m);
}

/* The spacing first taken is too wide by a factor that depends on the shape and on the target: it has to shrink until
 * the lines are enough, and no further. */
AQR_TEST(shrinking_stops_at_the_points_asked_for)
{
  shape m = shape_torus(60, 2);
  for (int64_t asked = 250; asked < 3000; asked = asked * 3 / 2)
    CHECK_BELOW(fabs(points_over_asked(&m, asked) - 1), 0.03);
  shape_free(&m);
}

/* A thin tube along a trefoil: a line that winds around it comes back after hundreds of crossings, where rings have
 * eight or so. */
static vec3 place_on_knot(double u, double v)
{
  double s = shape_turn * u, t = shape_turn * v, q = 2 + cos(3 * s);
  vec3 p = v3(q * cos(2 * s), q * sin(2 * s), sin(3 * s)),
       out = v3(cos(3 * s) * cos(2 * s), cos(3 * s) * sin(2 * s), sin(3 * s));
  vec3 along =
    v3_unit(v3(-2 * p.y - 3 * sin(3 * s) * cos(2 * s), 2 * p.x - 3 * sin(3 * s) * sin(2 * s), 3 * cos(3 * s)));
  out = v3_unit(v3_madd(out, -v3_dot(out, along), along));
  return v3_madd(v3_madd(p, 0.3 * cos(t), out), 0.3 * sin(t), v3_cross(along, out));
}

AQR_TEST(one_long_line_does_not_go_beyond_the_points_asked_for)
{
  shape m = shape_grid(300, 16, true, true, 0.3, 1, place_on_knot);
  for (int64_t asked = 300; asked < 2400; asked = asked * 6 / 5)
    CHECK_BELOW(fabs(points_over_asked(&m, asked) - 1), 0.03);
  shape_free(&m);
}

AQR_TEST_MAIN
