/* SPDX-License-Identifier: BSD-3-Clause */
#include "test.h"

#include "model.h"
#include "solids.h"

/* Of a chord that departs by e from a circle of curvature k (Alliez et al. 2003). */
static double chord(double k, double e)
{
  return 2 * sqrt(e * (2 / k - e));
}

static double relative(double a, double b)
{
  return fabs(a / b - 1);
}

/* The whole field of a sphere of radius R has one curvature, and so one spacing. */
AQR_TEST(spacing_is_the_chord_that_departs_by_the_tolerance)
{
  model e = model_sizing(shape_sphere(24, 1), 0.05, 5, NULL, 1);
  const double tolerance[] = { 0.002, 0.006, 0.02 };
  for (int i = 0; i < 3; i++)
  {
    double mean = 0, expected = chord(e.s.diagonal, tolerance[i]);
    CHECK(aqr_sizing_set(&e.c, &e.s, tolerance[i], &e.z) == AQR_OK);
    for (size_t k = 0; k < 2 * e.s.n_points; k++)
      mean += (double)e.z.spacing[k] / (double)(2 * e.s.n_points);
    CHECK_BELOW(relative(mean, expected), 0.05);
  }
  model_free(&e);
}

AQR_TEST(no_spacing_is_above_the_largest_or_below_what_the_input_can_carry)
{
  model e = model_sizing(shape_grid(30, 30, false, false, 0.3, 2, place_on_plane), 0.05, 0, NULL, 0.07);
  CHECK(aqr_sizing_set(&e.c, &e.s, 0.001, &e.z) == AQR_OK);
  for (size_t k = 0; k < 2 * e.s.n_points; k++)
    CHECK(fabs((double)e.z.spacing[k] - 0.07) < 1e-6);
  model_free(&e);
  e = model_sizing(shape_sphere(10, 2), 0.05, 0, NULL, 0.5);
  CHECK(aqr_sizing_set(&e.c, &e.s, 1e-7, &e.z) == AQR_OK);
  for (size_t k = 0; k < 2 * e.s.n_points; k++)
    CHECK((double)e.z.spacing[k] > 0.3 * sqrt((double)e.z.area[k / 2]));
  model_free(&e);
}

/* The branches must not be swapped: around the tube lines are near together, along it far apart. */
AQR_TEST(lines_are_dense_across_the_stronger_curvature)
{
  model e = model_sizing(shape_cylinder(40, 3), 0.05, 5, NULL, 0.4);
  double tolerance = 0.004, r = 0.3 / e.s.diagonal, worst = 0;
  CHECK(aqr_sizing_set(&e.c, &e.s, tolerance, &e.z) == AQR_OK);
  for (aqr_index f = 0; f < e.s.n_faces; f++)
  {
    vec3 p = model_shape_point(&e, aqr_point(&e.s, e.s.corner[3 * f]));
    double along, across;
    if (p.z < 0.2 || p.z > 0.8)
      continue;
    aqr_sizing_at(&e.s, &e.f, &e.z, f, v3_unit(v3(-p.y, p.x, 0)), &along, &across);
    worst = fmax(worst, relative(along, chord(1 / r, tolerance)));
    CHECK(across > 0.35);
    aqr_sizing_at(&e.s, &e.f, &e.z, f, v3(0, 0, 1), &along, &across);
    CHECK(along > 0.35);
  }
  CHECK_BELOW(worst, 0.1);
  model_free(&e);
}

/* The integral over the torus of 1 / (d(k1) d(k2)), the curvatures being 1 / r and cos t / (1 + r cos t). */
AQR_TEST(points_are_predicted_as_the_integral_over_a_torus)
{
  model e = model_sizing(shape_torus(40, 4), 0.03, 5, NULL, 0.1);
  const double tolerance[] = { 0.0005, 0.001, 0.003 };
  for (int k = 0; k < 3; k++)
  {
    double exact = 0, scale = e.s.diagonal;
    CHECK(aqr_sizing_set(&e.c, &e.s, tolerance[k], &e.z) == AQR_OK);
    for (int i = 0; i < 2000; i++)
    {
      double c = cos(shape_turn * (i + 0.5) / 2000), q = 1 + 0.4 * c;
      double area = shape_turn * shape_turn * 0.4 * q / 2000 / (scale * scale);
      double a = fmin(0.1, chord(scale / 0.4, tolerance[k]));
      double b = fmin(0.1, chord(fmax(1e-9, scale * fabs(c) / q), tolerance[k]));
      exact += area / (a * b);
    }
    CHECK_BELOW(relative(aqr_sizing_predict(&e.z, tolerance[k]), exact), 0.06);
  }
  model_free(&e);
}

AQR_TEST(points_are_predicted_as_the_integral_over_an_ellipsoid)
{
  model e = model_sizing(shape_ellipsoid(36, 0.3, 5, v3(1, 0.6, 0.4)), 0.03, 5, NULL, 0.3);
  double exact = 0, scale = e.s.diagonal, tolerance = 0.001;
  CHECK(aqr_sizing_set(&e.c, &e.s, tolerance, &e.z) == AQR_OK);
  for (size_t v = 0; v < e.s.n_points; v++)
  {
    shape_curvature k = shape_exact(ellipsoid_gradient, model_shape_point(&e, aqr_point(&e.s, (aqr_index)v)));
    double a = fmin(0.3, chord(scale * fabs(k.k_min), tolerance)),
           b = fmin(0.3, chord(scale * fabs(k.k_max), tolerance));
    exact += (double)e.z.area[v] / (a * b);
  }
  CHECK_BELOW(relative(aqr_sizing_predict(&e.z, tolerance), exact), 0.1);
  model_free(&e);
}

AQR_TEST(a_smaller_tolerance_never_predicts_fewer_points)
{
  model e = model_sizing(shape_torus(16, 6), 0.03, 5, NULL, 0.2);
  CHECK(aqr_sizing_set(&e.c, &e.s, 0.001, &e.z) == AQR_OK);
  double last = INFINITY;
  for (double t = 1e-7; t < 0.1; t *= 1.3)
  {
    double now = aqr_sizing_predict(&e.z, t);
    CHECK(now <= last * (1 + 1e-9) && now > 0);
    last = now;
  }
  model_free(&e);
}

AQR_TEST(the_tolerance_solved_for_predicts_the_points_asked_for)
{
  model e = model_sizing(shape_torus(40, 7), 0.03, 5, NULL, 0.1);
  const double points[] = { 30, 300, 3000 };
  double last = INFINITY;
  for (int i = 0; i < 3; i++)
  {
    double tolerance = 0;
    CHECK(aqr_sizing_solve(&e.c, &e.s, points[i], &e.z, &tolerance) == AQR_OK);
    CHECK_BELOW(relative(aqr_sizing_predict(&e.z, tolerance), points[i]), 0.01);
    CHECK(tolerance < last);
    last = tolerance;
  }
  model_free(&e);
}

AQR_TEST(a_density_scale_of_four_halves_the_spacings)
{
  shape m = shape_torus(20, 8);
  double* density = malloc(m.n_points * sizeof *density);
  for (size_t i = 0; i < m.n_points; i++)
    density[i] = m.points[3 * i] > 0 ? 4 : 1;
  model plain = model_sizing(shape_torus(20, 8), 0.03, 5, NULL, 0.1);
  model scaled = model_sizing(m, 0.03, 5, density, 0.1);
  CHECK(aqr_sizing_set(&plain.c, &plain.s, 0.001, &plain.z) == AQR_OK);
  CHECK(aqr_sizing_set(&scaled.c, &scaled.s, 0.001, &scaled.z) == AQR_OK);
  for (size_t i = 0; i < 2 * plain.s.n_points; i++)
  {
    double x = model_shape_point(&plain, aqr_point(&plain.s, (aqr_index)(i / 2))).x;
    CHECK(fabs((double)scaled.z.spacing[i] / (double)plain.z.spacing[i] - (x > 0 ? 0.5 : 1)) < 1e-5);
  }
  free(density);
  model_free(&plain);
  model_free(&scaled);
}

/* A sheet with a narrow ridge across it. */
static vec3 place_on_ridge(double u, double v)
{
  return v3(u, v, 0.05 * exp(-(u - 0.5) * (u - 0.5) / 0.002));
}

/* A largest spacing that few points do not suffice for left next to none for the ridge. */
AQR_TEST(curved_places_have_more_than_their_share_of_few_points)
{
  model narrow = model_sizing(shape_grid(90, 90, false, false, 0.2, 5, place_on_ridge), 0.02, 5, NULL, 0.02);
  model wide = model_sizing(shape_grid(90, 90, false, false, 0.2, 5, place_on_ridge), 0.02, 5, NULL, 1);
  double tolerance[2];
  CHECK(aqr_sizing_solve(&narrow.c, &narrow.s, 100, &narrow.z, &tolerance[0]) == AQR_OK);
  CHECK(aqr_sizing_solve(&wide.c, &wide.s, 100, &wide.z, &tolerance[1]) == AQR_OK);
  CHECK_BELOW(tolerance[0] / tolerance[1], 3);
  model_free(&narrow);
  model_free(&wide);
}

AQR_TEST_MAIN
