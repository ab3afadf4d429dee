/* SPDX-License-Identifier: BSD-3-Clause */
#include "test.h"

#include "shapes.h"

/* Every line of curvature of a torus is a circle. Where the triangles are as large as the spacing, a line that took its
 * own last chord for a neighbour would end at once; one that missed its own beginning would end as a spiral. */
AQR_TEST(lines_on_a_coarse_torus_are_closed_circles)
{
  for (size_t n = 20; n <= 32; n += 4)
  {
    shape m = shape_torus(n, (unsigned)n);
    aqr_input input = shape_input(&m);
    aqr_options o = aqr_default_options();
    aqr_remesher* r = NULL;
    o.density = AQR_DENSITY_POINTS;
    o.target_points = (int64_t)m.n_points / 2;
    CHECK(aqr_remesher_new(NULL, &r) == AQR_OK);
    CHECK(aqr_remesher_set_input(r, &input) == AQR_OK);
    CHECK(aqr_remesher_run(r, &o) == AQR_OK);
    const aqr_lines_view* l = aqr_remesher_lines(r);
    size_t open = 0;
    for (size_t i = 0; i < l->number_of_lines; i++)
      open += l->ends[2 * i] != AQR_END_LOOP;
    CHECK_BELOW((double)open, 0.4 * (double)l->number_of_lines);
    aqr_remesher_free(r);
    shape_free(&m);
  }
}

static vec3 place_on_spring(double u, double v)
{
  double a = 6 * shape_turn * u, t = shape_turn * v, pitch = 0.3 / shape_turn, n = sqrt(1 + pitch * pitch);
  vec3 out = v3(cos(a), sin(a), 0), up = v3(pitch * sin(a) / n, -pitch * cos(a) / n, 1 / n);
  vec3 p = v3(cos(a), sin(a), pitch * a);
  return v3_madd(v3_madd(p, 0.1 * cos(t), out), 0.1 * sin(t), up);
}

/* Rings around a wire come back a little beside their beginning. Where the spacing along the wire is wider than the
 * wire, no place on the ring lay far enough ahead for the head to steer to: it stopped, and lines along the wire passed
 * through the gaps of all rings. */
AQR_TEST(rings_around_a_thin_wire_stay_open)
{
  shape m = shape_grid(450, 16, false, true, 0.2, 1, place_on_spring);
  aqr_input input = shape_input(&m);
  aqr_options o = aqr_default_options();
  aqr_remesher* r = NULL;
  CHECK(aqr_remesher_new(NULL, &r) == AQR_OK);
  CHECK(aqr_remesher_set_input(r, &input) == AQR_OK);
  CHECK(aqr_remesher_run(r, &o) == AQR_OK);
  const aqr_lines_view* l = aqr_remesher_lines(r);
  size_t open = 0, rings = 0;
  for (size_t i = 0; i < l->number_of_lines; i++)
    if (l->type[i] == AQR_LINE_MAX)
    {
      rings++;
      open += l->ends[2 * i] != AQR_END_LOOP;
    }
  CHECK(rings > 50);
  CHECK_BELOW((double)open, 0.05 * (double)rings);
  aqr_remesher_free(r);
  shape_free(&m);
}

AQR_TEST_MAIN
