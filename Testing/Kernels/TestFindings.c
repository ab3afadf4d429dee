/* SPDX-License-Identifier: BSD-3-Clause */
/* What fuzzing found, each named after what went wrong. */
#include "test.h"

#include "examine.h"
#include "shapes.h"

static const char* fault_of(const aqr_input* input, const aqr_options* o)
{
  aqr_status status;
  const char* fault = examine(input, o, &status);
  if (fault)
    printf("%s\n", fault);
  return fault;
}

/* The counts of the repair were lost in all attempts but the first. */
AQR_TEST(the_report_of_a_run_that_meets_a_target_is_whole)
{
  shape m = shape_cylinder(10, 1);
  aqr_input input = shape_input(&m);
  aqr_options o = aqr_default_options();
  o.density = AQR_DENSITY_POINTS;
  o.target_points = 20;
  CHECK(!fault_of(&input, &o));
  shape_free(&m);
}

/* Three faces at an edge were cut apart, and the two that met elsewhere too kept a boundary of two edges there. */
AQR_TEST(a_fin_inside_a_sheet_leaves_no_slit)
{
  const double points[] = { 0, 0, 0, 1, 0, 0, 0, 1, 0, -1, 0, 0, 0, -1, 0, 1, 1, 0, 0.5, 0.5, 1, 1, -1, 0, -1, -1, 0,
    -1, 1, 0 };
  const int64_t triangles[] = { 0, 1, 2, 1, 5, 2, 0, 2, 3, 0, 3, 4, 0, 4, 1, 4, 7, 1, 3, 8, 4, 2, 9, 3, 1, 2, 6, 0, 1,
    6 };
  aqr_input input = { .number_of_points = 10, .points_d = points, .number_of_triangles = 9, .triangles = triangles };
  aqr_options o = aqr_default_options();
  o.tolerance = 0.01;
  CHECK(!fault_of(&input, &o));
  input.number_of_triangles = 10;
  CHECK(!fault_of(&input, &o));
}

/* Normals on both sides of a fold cancelled out, and the point between had none. */
AQR_TEST(points_on_a_fold_have_a_normal)
{
  const double points[] = { 0, 0, 0, 1, 0, 0, 0.5, 1, 0, 0.5, 1, 0.0000001, 0.2, 1, 0, 0.8, 1, -0.0000001 };
  const int64_t triangles[] = { 0, 1, 2, 1, 0, 3, 0, 2, 4, 1, 5, 2 };
  aqr_input input = { .number_of_points = 6, .points_d = points, .number_of_triangles = 4, .triangles = triangles };
  for (int features = 0; features < 2; features++)
  {
    aqr_options o = aqr_default_options();
    o.feature_lines = features;
    o.tolerance = 0.01;
    CHECK(!fault_of(&input, &o));
  }
}

/* Around a tube far thinner than the spacing, a line wound until memory ran out. */
AQR_TEST(lines_do_not_wind_around_threads)
{
  enum
  {
    around = 3,
    along = 40
  };
  const double thin[] = { 1e-4, 1e-8, 1e-12, 1e-20 };
  for (size_t k = 0; k < sizeof thin / sizeof *thin; k++)
  {
    shape m = shape_grid(around, along, true, false, 0, 1, place_on_cylinder);
    for (size_t i = 0; i < m.n_points; i++)
    {
      m.points[3 * i] *= thin[k];
      m.points[3 * i + 1] *= thin[k];
    }
    /* a sheet beside it, so that the thread is not all there is */
    const double far[9] = { 0.5, 0, 0, 0.5, 0, 1, 1, 0.5, 0.5 };
    m.points = realloc(m.points, (3 * m.n_points + 9) * sizeof *m.points);
    m.triangles = realloc(m.triangles, (3 * m.n_triangles + 3) * sizeof *m.triangles);
    memcpy(m.points + 3 * m.n_points, far, sizeof far);
    for (int i = 0; i < 3; i++)
      m.triangles[3 * m.n_triangles + (size_t)i] = (int64_t)m.n_points + i;
    m.n_points += 3;
    m.n_triangles++;
    aqr_input input = shape_input(&m);
    aqr_options o = aqr_default_options();
    o.tolerance = 0.01;
    CHECK(!fault_of(&input, &o));
    shape_free(&m);
  }
}

/* Beside coordinates of 1e30 all others coincide next to exactly, and products of edges underflow. */
AQR_TEST(a_component_too_small_for_its_products_stays_finite)
{
  shape m = shape_grid(4, 4, false, false, 0.3, 1, place_on_cylinder);
  for (size_t i = 0; i < 3 * m.n_points; i++)
    m.points[i] *= 1e-170;
  m.points = realloc(m.points, (3 * m.n_points + 9) * sizeof *m.points);
  m.triangles = realloc(m.triangles, (3 * m.n_triangles + 3) * sizeof *m.triangles);
  const double far[9] = { 0, 0, 0, 1, 0, 0, 0, 1, 0 };
  memcpy(m.points + 3 * m.n_points, far, sizeof far);
  for (int i = 0; i < 3; i++)
    m.triangles[3 * m.n_triangles + (size_t)i] = (int64_t)m.n_points + i;
  m.n_points += 3;
  m.n_triangles++;
  aqr_input input = shape_input(&m);
  aqr_options o = aqr_default_options();
  o.tolerance = 0.01;
  CHECK(!fault_of(&input, &o));
  shape_free(&m);
}

/* Lines that end at one place of a crease stood along it in another order than around the face they came over: their
 * edges left their crossing in the wrong order, and three regions became one face. */
AQR_TEST(lines_that_end_at_one_place_of_a_crease_keep_their_order)
{
  const double points[] = { 0, 0, 0, 1, 0, 0, 0, 1, 0, 0.46, 0, 0, 0.6, 0, 0, 3, 0, 0, 4, 0, 0, 3, 0.4, 0 };
  const int64_t triangles[] = { 4, 1, 2, 0, 1, 3, 1, 4, 3, 0, 1, 2, 5, 6, 7 };
  aqr_input input = { .number_of_points = 8, .points_d = points, .number_of_triangles = 5, .triangles = triangles };
  aqr_options o = aqr_default_options();
  CHECK(!fault_of(&input, &o));
}

/* A component without lines was decimated as the smallest of its spacings asked for: one sharp bend or a user's
 * density at one point, and it kept all of its faces. */
AQR_TEST(one_point_does_not_speak_for_a_component_without_lines)
{
  size_t points[2];
  for (int dense = 0; dense < 2; dense++)
  {
    shape m = shape_ellipsoid(16, 0.1, 1, v3(0.05, 0.05, 0.05));
    const double far[9] = { 3, 0, 0, 3, 1, 0, 3, 0, 1 };
    m.points = realloc(m.points, (3 * m.n_points + 9) * sizeof *m.points);
    m.triangles = realloc(m.triangles, (3 * m.n_triangles + 3) * sizeof *m.triangles);
    memcpy(m.points + 3 * m.n_points, far, sizeof far);
    for (size_t k = 0; k < 3; k++)
      m.triangles[3 * m.n_triangles + k] = (int64_t)(m.n_points + k);
    m.n_points += 3;
    m.n_triangles++;
    aqr_input input = shape_input(&m);
    aqr_options o = aqr_default_options();
    o.tolerance = 0.1;
    o.feature_lines = 0;
    o.largest_spacing = 1;
    double* scale = malloc(m.n_points * sizeof *scale);
    for (size_t i = 0; i < m.n_points; i++)
      scale[i] = dense && i == 700 ? 1e6 : 1;
    o.density_scale = scale;
    CHECK(!fault_of(&input, &o));
    aqr_remesher* r = NULL;
    CHECK(aqr_remesher_new(NULL, &r) == AQR_OK && aqr_remesher_set_input(r, &input) == AQR_OK);
    CHECK(aqr_remesher_run(r, &o) == AQR_OK);
    points[dense] = aqr_remesher_mesh(r)->number_of_points;
    printf("%zu points of %zu\n", points[dense], m.n_points);
    CHECK(aqr_remesher_report(r)->coarsened_components > 0);
    aqr_remesher_free(r);
    free(scale);
    shape_free(&m);
  }
  CHECK(points[1] < 2 * points[0]);
}

/* Round after round the fit took a vertex of six farther off, as hardly any of its samples had the surface below them.
 */
AQR_TEST(no_vertex_of_a_handful_is_fitted_far_off)
{
  shape m = shape_ellipsoid(4, 0, 0, v3(1, 0.6, 0.4));
  aqr_input input = shape_input(&m);
  aqr_options o = aqr_default_options();
  o.tolerance = 0.1;
  o.largest_spacing = 1;
  o.curvature_radius = 0;
  o.smoothing_iterations = 0;
  o.feature_lines = 0;
  o.convex_partition = 0;
  CHECK(!fault_of(&input, &o));
  shape_free(&m);
}

/* Seeds meant for places along a needle all stood in its middle: the line there was found again and again, and points
 * came by the thousand. */
AQR_TEST(places_along_a_needle_are_all_its_middle)
{
  enum
  {
    sides = 64
  };
  double points[3 * (2 * sides + 2)] = { 0 };
  int64_t triangles[3 * 4 * sides];
  for (int64_t i = 0; i < sides; i++)
  {
    const double a = shape_turn * (double)i / sides;
    int64_t next = (i + 1) % sides;
    for (int64_t end = 0; end < 2; end++)
      v3_store(points + 3 * (sides * end + i), v3(cos(a), sin(a), 1000.0 * (double)end));
    const int64_t t[12] = { i, next, sides + i, next, sides + next, sides + i, next, i, 2 * sides, sides + i,
      sides + next, 2 * sides + 1 };
    memcpy(triangles + 12 * i, t, sizeof t);
  }
  points[3 * (2 * sides + 1) + 2] = 1000;
  aqr_input input = {
    .number_of_points = 2 * sides + 2, .points_d = points, .number_of_triangles = 4 * sides, .triangles = triangles
  };
  aqr_options o = aqr_default_options();
  aqr_remesher* r = NULL;
  CHECK(!fault_of(&input, &o));
  CHECK(aqr_remesher_new(NULL, &r) == AQR_OK && aqr_remesher_set_input(r, &input) == AQR_OK);
  CHECK(aqr_remesher_run(r, &o) == AQR_OK);
  CHECK_BELOW((double)aqr_remesher_mesh(r)->number_of_points, 300);
  aqr_remesher_free(r);
}

/* Lines around tetrahedra far smaller than the spacing made three points of each and two thirds of its surface. */
AQR_TEST(lines_are_drawn_around_specks)
{
  enum
  {
    specks = 200
  };
  static double points[12 * specks];
  static int64_t triangles[12 * specks];
  const int64_t faces[12] = { 0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2 };
  unsigned state = 1;
  for (size_t i = 0; i < specks; i++)
  {
    double* p = points + 12 * i;
    for (size_t k = 0; k < 12; k++)
      p[k] = 50 * shape_random(&state);
    for (size_t k = 3; k < 12; k++)
      p[k] = p[k % 3] + (k % 4 == 3 ? 0.5 : 0);
    for (size_t k = 0; k < 12; k++)
      triangles[12 * i + k] = (int64_t)(4 * i) + faces[k];
  }
  aqr_input input = {
    .number_of_points = 4 * specks, .points_d = points, .number_of_triangles = 4 * specks, .triangles = triangles
  };
  aqr_options o = aqr_default_options();
  aqr_remesher* r = NULL;
  CHECK(!fault_of(&input, &o));
  CHECK(aqr_remesher_new(NULL, &r) == AQR_OK && aqr_remesher_set_input(r, &input) == AQR_OK);
  CHECK(aqr_remesher_run(r, &o) == AQR_OK);
  CHECK(aqr_remesher_mesh(r)->number_of_points == 4 * specks);
  CHECK(aqr_remesher_mesh(r)->number_of_faces == 4 * specks);
  aqr_remesher_free(r);
}

AQR_TEST_MAIN
