/* SPDX-License-Identifier: BSD-3-Clause */
/* What each option and each status of aqr.h promises. */
#include "test.h"

#include "examine.h"
#include "pipeline.h"
#include "remesh.h"
#include "solids.h"

#include <float.h>

static size_t points_of(const aqr_remesher* r)
{
  return aqr_remesher_mesh(r) ? aqr_remesher_mesh(r)->number_of_points : 0;
}

static size_t lines_of_type(const aqr_remesher* r, uint8_t type)
{
  const aqr_lines_view* l = aqr_remesher_lines(r);
  size_t n = 0;
  for (size_t i = 0; l && i < l->number_of_lines; i++)
    n += l->type[i] == type;
  return n;
}

static aqr_status again(aqr_remesher* r, aqr_options o)
{
  return aqr_remesher_run(r, &o);
}

/* ---- density ---- */

AQR_TEST(the_number_of_points_falls_as_the_tolerance_grows)
{
  shape m = shape_torus(24, 1);
  aqr_options o = aqr_default_options();
  o.largest_spacing = 0.3;
  o.tolerance = 0.004;
  aqr_remesher* r = remesh(&m, &o);
  size_t coarse = points_of(r);
  o.tolerance = 0.001;
  CHECK(again(r, o) == AQR_OK);
  size_t fine = points_of(r);
  printf("tolerance 0.004: %zu points, 0.001: %zu\n", coarse, fine);
  CHECK(2 * fine > 5 * coarse && fine < 6 * coarse); /* one over the tolerance */
  CHECK(fabs(aqr_remesher_report(r)->tolerance - 0.001) < 1e-12);
  aqr_remesher_free(r);
  shape_free(&m);
}

/* A spacing that a coarse flat input cannot carry was left without a word. */
AQR_TEST(a_largest_spacing_that_is_not_met_is_reported)
{
  shape m = shape_grid(12, 12, false, false, 0, 1, place_on_cylinder);
  aqr_options o = aqr_default_options();
  o.curvature_radius = 0;
  aqr_remesher* r = remesh(&m, &o);
  CHECK(aqr_remesher_report(r)->bounded_points == 0);
  o.largest_spacing = 1e-4;
  CHECK(again(r, o) == AQR_OK);
  CHECK(aqr_remesher_report(r)->bounded_points == aqr_remesher_field(r)->number_of_points);
  o.density = AQR_DENSITY_POINTS;
  CHECK(again(r, o) == AQR_OK);
  CHECK(aqr_remesher_report(r)->bounded_points == 0);
  aqr_remesher_free(r);
  shape_free(&m);
}

AQR_TEST(targets_are_met_within_five_percent)
{
  shape shapes[] = { shape_torus(24, 2), shape_plate(2, 7, 12, 3), shape_ellipsoid(22, 0.3, 4, v3(1, 0.6, 0.4)) };
  for (int k = 0; k < 3; k++)
  {
    aqr_options o = options_for_points(400);
    aqr_remesher* r = remesh(&shapes[k], &o);
    const int64_t asked[] = { 400, 900 };
    for (int i = 0; i < 2; i++)
    {
      CHECK(again(r, options_for_points(asked[i])) == AQR_OK);
      CHECK_BELOW(fabs((double)points_of(r) / (double)asked[i] - 1), 0.05);
      CHECK(!aqr_remesher_report(r)->target_missed);
    }
    aqr_remesher_free(r);
    shape_free(&shapes[k]);
  }
}

/* Scales of 1, 2 and 4 differ in few bits, all of them high ones. */
AQR_TEST(a_changed_density_scale_is_taken_for_the_old_one)
{
  enum
  {
    n = 200,
    arrays = 2000
  };
  double scale[n];
  uint64_t seen[arrays];
  unsigned state = 4;
  for (size_t k = 0; k < arrays; k++)
  {
    for (size_t i = 0; i < n; i++)
      scale[i] = (const double[]){ 1, 2, 4 }[(size_t)(3 * shape_random(&state))];
    seen[k] = aqr_fingerprint(scale, n);
    for (size_t i = 0; i < k; i++)
      if (seen[i] == seen[k])
        CHECK(false);
  }
}

AQR_TEST(a_density_scale_of_four_brings_four_times_the_points)
{
  shape m = shape_torus(28, 5);
  double* scale = malloc(m.n_points * sizeof *scale);
  for (size_t i = 0; i < m.n_points; i++)
    scale[i] = m.points[3 * i] > 0 ? 4 : 1;
  aqr_options o = aqr_default_options();
  o.tolerance = 0.002;
  o.density_scale = scale;
  aqr_remesher* r = remesh(&m, &o);
  const aqr_mesh* mesh = aqr_remesher_mesh(r);
  double right = 0;
  for (size_t i = 0; i < mesh->number_of_points; i++)
    right += mesh->points[3 * i] > 0;
  /* every other line of the dense half must end where the other begins; if all went on it would be twice */
  CHECK_BELOW(fabs(log(right / ((double)mesh->number_of_points - right) / 4)), log(1.4));
  scale[7] = 0;
  CHECK(again(r, o) == AQR_BAD_OPTION);
  scale[7] = NAN;
  CHECK(again(r, o) == AQR_BAD_OPTION && strstr(aqr_remesher_message(r), "density_scale[7]"));
  aqr_remesher_free(r);
  free(scale);
  shape_free(&m);
}

AQR_TEST(no_two_lines_are_much_farther_apart_than_the_largest_spacing)
{
  shape m = shape_grid(40, 40, false, false, 0.2, 6, place_on_plane);
  aqr_options o = aqr_default_options();
  aqr_remesher* r = remesh(&m, &o);
  const double spacing[] = { 0.2, 0.1, 0.05 };
  for (int k = 0; k < 3; k++)
  {
    o.largest_spacing = spacing[k];
    CHECK(again(r, o) == AQR_OK);
    double cells = 1 / (sqrt(2) * spacing[k]); /* along a side of the unit square, whose diagonal is sqrt(2) */
    printf("largest spacing %g: %zu points\n", spacing[k], points_of(r));
    CHECK((double)points_of(r) > 0.7 * cells * cells && (double)points_of(r) < 1.8 * (cells + 1) * (cells + 1));
  }
  aqr_remesher_free(r);
  shape_free(&m);
}

static double aspect_of(const aqr_mesh* m, double* unevenness)
{
  double sum = 0, areas = 0, squares = 0;
  for (size_t f = 0; f < m->number_of_faces; f++)
  {
    const int64_t* at = m->connectivity + m->offsets[f];
    size_t n = (size_t)(m->offsets[f + 1] - m->offsets[f]);
    double shortest = INFINITY, longest = 0;
    vec3 cross = v3(0, 0, 0), o = v3_load(m->points + 3 * at[0]);
    for (size_t i = 0; i < n; i++)
    {
      vec3 a = v3_load(m->points + 3 * at[i]), b = v3_load(m->points + 3 * at[(i + 1) % n]);
      double length = v3_norm(v3_sub(b, a));
      shortest = fmin(shortest, length);
      longest = fmax(longest, length);
      cross = v3_add(cross, v3_cross(v3_sub(a, o), v3_sub(b, o)));
    }
    sum += longest / shortest;
    areas += v3_norm(cross);
    squares += v3_norm2(cross);
  }
  double count = (double)m->number_of_faces, mean = areas / count;
  *unevenness = sqrt(fmax(0, squares / count - mean * mean)) / mean;
  return sum / count;
}

/* On a slender spindle curvatures differ much, and most at its waist. */
AQR_TEST(anisotropy_zero_makes_squares_and_adaptivity_zero_equal_faces)
{
  shape m = shape_ellipsoid(24, 0.2, 3, v3(1, 0.25, 0.2));
  aqr_options o = options_for_points(1500);
  aqr_remesher* r = remesh(&m, &o);
  double full_spread, square_spread, even_spread;
  double full = aspect_of(aqr_remesher_mesh(r), &full_spread);
  o.adaptivity = 0;
  CHECK(again(r, o) == AQR_OK);
  double even = aspect_of(aqr_remesher_mesh(r), &even_spread);
  o.adaptivity = 1;
  o.anisotropy = 0;
  CHECK(again(r, o) == AQR_OK);
  double square = aspect_of(aqr_remesher_mesh(r), &square_spread);
  printf("aspect and spread of areas: full %.2f %.2f, even %.2f %.2f, square %.2f %.2f\n", full, full_spread, even,
    even_spread, square, square_spread);
  CHECK(square < 0.8 * full && even_spread < 0.7 * full_spread);
  aqr_remesher_free(r);
  shape_free(&m);
}

/* ---- pure quads ---- */

AQR_TEST(pure_quads_leave_no_other_face_on_any_kind_of_surface)
{
  shape shapes[] = { shape_sphere(4, 20), shape_cube(6, 0.2, 21), shape_torus(20, 22), shape_cylinder(6, 23) };
  for (int s = 0; s < 4; s++)
    for (int tolerance = 0; tolerance < 2; tolerance++)
    {
      aqr_options o = options_for_points(300);
      o.pure_quads = 1;
      o.largest_spacing = 0.3;
      o.density = tolerance ? AQR_DENSITY_TOLERANCE : AQR_DENSITY_POINTS;
      o.tolerance = 0.01;
      aqr_input input = shape_input(&shapes[s]);
      aqr_status status;
      const char* fault = examine(&input, &o, &status);
      CHECK(!fault && status == AQR_OK);
      aqr_remesher* r = remesh(&shapes[s], &o);
      const aqr_mesh* out = aqr_remesher_mesh(r);
      for (size_t f = 0; f < out->number_of_faces; f++)
        CHECK(out->offsets[f + 1] - out->offsets[f] == 4);
      if (!tolerance)
        CHECK(aqr_remesher_report(r)->target_missed || fabs((double)points_of(r) / 300 - 1) < 0.05);
      printf("shape %d: %zu points\n", s, points_of(r));
      aqr_remesher_free(r);
    }
  for (int s = 0; s < 4; s++)
    shape_free(&shapes[s]);
}

/* A ring with a square section of half the size of its hole. */
static vec3 place_on_square_ring(double u, double v)
{
  double side = 4 * v, t = side - floor(side), along[4][2] = { { 1 + t, 0 }, { 2, t }, { 2 - t, 1 }, { 1, 1 - t } };
  const double* at = along[(int)side % 4];
  return v3(at[0] * cos(shape_turn * u), at[0] * sin(shape_turn * u), at[1]);
}
/* New points of creases and borders belong on them, not on the chords between their neighbours. */
AQR_TEST(pure_quads_keep_rims_round)
{
  shape shapes[] = { shape_grid(64, 24, true, true, 0, 24, place_on_square_ring),
    shape_grid(64, 16, true, false, 0, 25, place_on_cylinder) };
  const double sagitta = 1 - cos(shape_turn / 128);
  for (int s = 0; s < 2; s++)
  {
    aqr_options o = options_for_points(120);
    o.pure_quads = 1;
    o.largest_spacing = 1;
    aqr_remesher* r = remesh(&shapes[s], &o);
    const aqr_mesh* out = aqr_remesher_mesh(r);
    size_t on_rims = 0;
    double farthest = 0;
    for (size_t i = 0; i < out->number_of_points; i++)
    {
      double radius = hypot(out->points[3 * i], out->points[3 * i + 1]);
      double rim = s == 1 ? 0.3 : radius < 1.5 ? 1 : 2;
      if (out->point_kind[i] == 0)
        continue;
      on_rims++;
      farthest = fmax(farthest, fabs(radius / rim - 1));
    }
    printf("%zu of %zu points on rims\n", on_rims, out->number_of_points);
    CHECK(on_rims > 15);
    CHECK_BELOW(farthest, 1.001 * sagitta);
    aqr_remesher_free(r);
    shape_free(&shapes[s]);
  }
}

/* ---- directions ---- */

AQR_TEST(radius_and_smoothing_calm_a_noisy_field)
{
  shape m = shape_torus(20, 7);
  unsigned state = 1;
  for (size_t i = 0; i < 3 * m.n_points; i++)
    m.points[i] += 0.02 * (shape_random(&state) - 0.5);
  aqr_options o = options_for_points(200);
  double mean[3], spread[3]; /* of the confidence; of the largest curvature, one over the tube's radius everywhere */
  o.curvature_radius = 0;
  o.smoothing_iterations = 0;
  aqr_remesher* r = remesh(&m, &o);
  for (int k = 0; k < 3; k++)
  {
    o.smoothing_iterations = k == 1 ? 20 : 0;
    o.curvature_radius = k == 2 ? 0.05 : 0;
    CHECK(again(r, o) == AQR_OK);
    const aqr_field_view* f = aqr_remesher_field(r);
    double sum = 0, squares = 0, n = (double)f->number_of_points;
    mean[k] = 0;
    for (size_t i = 0; i < f->number_of_triangles; i++)
      mean[k] += (double)f->triangle_confidence[i] / (double)f->number_of_triangles;
    for (size_t i = 0; i < f->number_of_points; i++)
    {
      sum += f->max_curvature[i];
      squares += f->max_curvature[i] * f->max_curvature[i];
    }
    spread[k] = sqrt(fmax(0, squares / n - sum / n * sum / n));
  }
  printf(
    "mean confidence %g, smoothed %g; spread of curvature %g, averaged %g\n", mean[0], mean[1], spread[0], spread[2]);
  CHECK(1 - mean[1] < 0.6 * (1 - mean[0]));
  CHECK(spread[2] < 0.8 * spread[0]);
  aqr_remesher_free(r);
  shape_free(&m);
}

static uint64_t hash_curvatures(const aqr_remesher* r)
{
  const aqr_field_view* f = aqr_remesher_field(r);
  return hash_bytes(0, f->max_curvature, f->number_of_points * sizeof *f->max_curvature);
}

/* A noisy tube so thin that few points lie close on it. */
static shape rough_wire(void)
{
  shape m = shape_cylinder(24, 5);
  unsigned state = 3;
  for (size_t i = 0; i < 3 * m.n_points; i++)
    m.points[i] *= (i % 3 == 2 ? 1 : 0.05) * (1 + 0.05 * (shape_random(&state) - 0.5));
  return m;
}

AQR_TEST(a_ball_wider_than_the_faces_does_not_hide_the_curvature_they_follow)
{
  shape m = rough_wire();
  const double area = shape_turn * 0.3 * 0.05; /* of a tube as long as the diagonal */
  aqr_options o = options_for_points(0);
  o.curvature_radius = 0.04;
  aqr_remesher* r = NULL;
  uint64_t seen[3], plain[3];
  for (int k = 0; k < 3; k++) /* spacings of 1/90, 1/180, 1/360 */
  {
    o.target_points = (int64_t)(area * 8100 * (1 << 2 * k));
    if (!r)
      r = remesh(&m, &o);
    CHECK(again(r, o) == AQR_OK);
    seen[k] = hash_curvatures(r);
  }
  aqr_options t = aqr_default_options(); /* a tolerance stands for points */
  for (int k = 0; k < 3; k++)
  {
    t.curvature_radius = 0.04;
    t.tolerance = 1.7 / (area * 8100 * (1 << 2 * k));
    CHECK(again(r, t) == AQR_OK && hash_curvatures(r) == seen[k]);
  }
  o.target_points = (int64_t)(area * 8100);
  for (int k = 0; k < 3; k++) /* the radii that these stand for */
  {
    o.curvature_radius = 0.04 / (1 << k);
    CHECK(again(r, o) == AQR_OK);
    plain[k] = hash_curvatures(r);
    CHECK(seen[k] == plain[k]);
  }
  CHECK(plain[0] != plain[1] && plain[1] != plain[2] && plain[0] != plain[2]);
  aqr_remesher_free(r);
  shape_free(&m);
}

AQR_TEST(the_confidence_angle_decides_which_directions_lead_lines)
{
  shape m = shape_sphere(16, 8);
  aqr_options o = options_for_points(300);
  aqr_remesher* r = remesh(&m, &o);
  uint64_t usual = hash_results(r);
  o.confidence_angle = 89;
  CHECK(again(r, o) == AQR_OK && hash_results(r) != usual);
  aqr_remesher_free(r);
  shape_free(&m);
}

/* ---- features and borders ---- */

AQR_TEST(edges_of_a_cube_are_lines_only_where_asked_for)
{
  shape m = shape_cube(12, 0, 9);
  aqr_options o = options_for_points(300);
  aqr_remesher* r = remesh(&m, &o);
  size_t corners = 0;
  for (size_t i = 0; i < points_of(r); i++)
    corners += aqr_remesher_mesh(r)->point_kind[i] == 3;
  CHECK(lines_of_type(r, AQR_LINE_FEATURE) == 12 && corners == 8);
  CHECK_BELOW(12 * 12 - 0.5, (double)aqr_remesher_report(r)->feature_edges);
  o.feature_angle = 100;
  CHECK(again(r, o) == AQR_OK && lines_of_type(r, AQR_LINE_FEATURE) == 0);
  o.feature_angle = 80;
  CHECK(again(r, o) == AQR_OK && lines_of_type(r, AQR_LINE_FEATURE) == 12);
  o.feature_lines = 0;
  CHECK(again(r, o) == AQR_OK && lines_of_type(r, AQR_LINE_FEATURE) == 0);
  aqr_remesher_free(r);
  shape_free(&m);
}

static vec3 place_on_wavy_sheet(double u, double v)
{
  return v3(u, v * (1 + 0.03 * sin(6 * shape_turn * u)), 0);
}
AQR_TEST(borders_are_followed_only_where_asked_for)
{
  shape m = shape_grid(80, 40, false, false, 0, 10, place_on_wavy_sheet);
  aqr_options o = aqr_default_options();
  o.largest_spacing = 0.3;
  size_t on_border[2];
  aqr_remesher* r = remesh(&m, &o);
  for (int k = 0; k < 2; k++)
  {
    o.boundary_lines = k;
    CHECK(again(r, o) == AQR_OK);
    on_border[k] = 0;
    for (size_t i = 0; i < points_of(r); i++)
      on_border[k] += aqr_remesher_mesh(r)->point_kind[i] != 0;
    CHECK(!survey_mesh(aqr_remesher_mesh(r)).flaw);
  }
  printf("points on the border: %zu followed, %zu not\n", on_border[1], on_border[0]);
  CHECK(on_border[0] < on_border[1]);
  CHECK(lines_of_type(r, AQR_LINE_BOUNDARY) > 0 && aqr_remesher_report(r)->boundary_loops == 1);
  aqr_remesher_free(r);
  shape_free(&m);
}

/* ---- faces ---- */

AQR_TEST(no_face_has_more_corners_than_the_largest_valence)
{
  shape m = shape_plate(2, 6, 6, 11);
  aqr_options o = options_for_points(400);
  aqr_remesher* r = remesh(&m, &o);
  int most[65] = { 0 };
  for (int valence = 4; valence <= 64; valence *= 2)
  {
    o.largest_valence = valence;
    CHECK(again(r, o) == AQR_OK);
    const aqr_mesh* mesh = aqr_remesher_mesh(r);
    for (size_t f = 0; f < mesh->number_of_faces; f++)
      most[valence] = (int)fmax(most[valence], (double)(mesh->offsets[f + 1] - mesh->offsets[f]));
    printf("largest valence %d: %zu faces of up to %d corners\n", valence, mesh->number_of_faces, most[valence]);
    CHECK(most[valence] <= valence);
  }
  CHECK(most[64] > 4); /* or there was nothing to split */
  aqr_remesher_free(r);
  shape_free(&m);
}

AQR_TEST(topology_is_kept_however_coarse_the_mesh)
{
  shape m = shape_plate(2, 4, 8, 12);
  aqr_options o = aqr_default_options();
  o.tolerance = 0.05;
  o.largest_spacing = 1;
  aqr_remesher* r = remesh(&m, &o);
  survey kept = survey_mesh(aqr_remesher_mesh(r));
  printf("%zu points, %zu cuts\n", points_of(r), aqr_remesher_report(r)->topology_cuts);
  CHECK(!kept.flaw && kept.euler == -2);
  CHECK(aqr_remesher_report(r)->topology_cuts > 0);
  o.preserve_topology = 0;
  CHECK(again(r, o) == AQR_OK);
  CHECK(!survey_mesh(aqr_remesher_mesh(r)).flaw && aqr_remesher_report(r)->topology_cuts == 0);
  aqr_remesher_free(r);
  shape_free(&m);
}

/* ---- caching ---- */

AQR_TEST(a_change_of_density_alone_reuses_the_field_and_gives_what_a_fresh_run_gives)
{
  shape m = shape_plate(1, 5, 8, 13);
  aqr_options a = options_for_points(300), b = aqr_default_options();
  aqr_remesher* r = remesh(&m, &a);
  size_t n = 0;
  for (size_t i = 0; i < 1 || i < n; i++)
    CHECK(!aqr_remesher_stages(r, &n)[i].reused);
  b.tolerance = 0.003;
  CHECK(again(r, b) == AQR_OK);
  const aqr_stage* stage = aqr_remesher_stages(r, &n);
  for (size_t i = 0; i < n; i++)
  {
    bool kept = !strcmp(stage[i].name, "curvature") || !strcmp(stage[i].name, "direction field") ||
                !strcmp(stage[i].name, "features");
    bool made = !strcmp(stage[i].name, "lines") || !strcmp(stage[i].name, "faces");
    CHECK(!kept || (stage[i].reused && stage[i].seconds <= 0));
    CHECK(!made || !stage[i].reused);
  }
  aqr_remesher* fresh = remesh(&m, &b);
  CHECK(hash_results(r) == hash_results(fresh) && hash_results(r) != 0);
  /* each option in turn: what is left of the run before must not show */
  for (int k = 0; k < 9; k++)
  {
    aqr_options o = b;
    o.curvature_radius = k == 0 ? 0.03 : o.curvature_radius;
    o.smoothing_iterations = k == 1 ? 9 : o.smoothing_iterations;
    o.feature_angle = k == 2 ? 20 : o.feature_angle;
    o.largest_spacing = k == 3 ? 0.2 : o.largest_spacing;
    o.confidence_angle = k == 4 ? 70 : o.confidence_angle;
    o.seed = k == 5 ? 3 : o.seed;
    o.largest_valence = k == 6 ? 4 : o.largest_valence;
    o.feature_lines = k == 7 ? 0 : o.feature_lines;
    aqr_remesher* other = remesh(&m, &o);
    CHECK(again(r, o) == AQR_OK && hash_results(r) == hash_results(other));
    aqr_remesher_free(other);
  }
  aqr_remesher_free(fresh);
  aqr_remesher_free(r);
  shape_free(&m);
}

AQR_TEST(a_density_that_asks_for_other_curvatures_gives_what_a_fresh_run_gives)
{
  shape m = rough_wire();
  aqr_options few = options_for_points(300), many = options_for_points(3000);
  few.curvature_radius = many.curvature_radius = 0.04;
  aqr_remesher *r = remesh(&m, &few), *fresh = remesh(&m, &many);
  const uint64_t revision = aqr_remesher_field(r)->revision;
  CHECK(again(r, many) == AQR_OK && aqr_remesher_field(r)->revision != revision);
  CHECK(hash_results(r) == hash_results(fresh));
  aqr_remesher_free(fresh);
  aqr_remesher_free(r);
  shape_free(&m);
}

AQR_TEST(a_field_computed_anew_has_another_revision_and_a_reused_one_keeps_it)
{
  shape m = shape_torus(24, 9);
  aqr_options o = aqr_default_options();
  aqr_remesher* r = remesh(&m, &o);
  uint64_t revision = aqr_remesher_field(r)->revision;
  o.tolerance *= 2;
  CHECK(again(r, o) == AQR_OK && aqr_remesher_field(r)->revision == revision);
  o.show_field = 0;
  CHECK(again(r, o) == AQR_OK);
  o.show_field = 1;
  CHECK(again(r, o) == AQR_OK && aqr_remesher_field(r)->revision == revision);
  o.smoothing_iterations++;
  CHECK(again(r, o) == AQR_OK && aqr_remesher_field(r)->revision != revision);
  revision = aqr_remesher_field(r)->revision;
  const aqr_input input = shape_input(&m);
  CHECK(aqr_remesher_set_input(r, &input) == AQR_OK && again(r, o) == AQR_OK);
  CHECK(aqr_remesher_field(r)->revision != revision);
  aqr_remesher_free(r);
  shape_free(&m);
}

static size_t bytes_at_end(const aqr_remesher* r)
{
  size_t n;
  const aqr_stage* stages = aqr_remesher_stages(r, &n);
  return stages[n - 1].end_bytes;
}

AQR_TEST(what_nobody_asks_to_be_shown_takes_no_memory)
{
  shape m = shape_torus(24, 9);
  aqr_options all = aqr_default_options(), none = all;
  none.show_field = none.show_lines = 0;
  aqr_remesher* r = remesh(&m, &all);
  uint64_t shown = hash_results(r);
  size_t points = points_of(r), bytes = bytes_at_end(r), view = aqr_remesher_field(r)->number_of_points;
  CHECK(again(r, none) == AQR_OK && points_of(r) == points);
  CHECK(!aqr_remesher_field(r) && !aqr_remesher_lines(r));
  CHECK(bytes - bytes_at_end(r) > 100 * view);
  CHECK(again(r, all) == AQR_OK && hash_results(r) == shown && bytes_at_end(r) == bytes);
  aqr_remesher_free(r);
  shape_free(&m);
}

/* ---- every status ---- */

static aqr_status status_of_input(const aqr_input* input)
{
  aqr_remesher* r = NULL;
  CHECK(aqr_remesher_new(NULL, &r) == AQR_OK);
  aqr_status status = aqr_remesher_set_input(r, input);
  aqr_options o = aqr_default_options();
  CHECK(status == AQR_OK || aqr_remesher_run(r, &o) == AQR_NO_INPUT);
  CHECK(status == AQR_OK || !aqr_remesher_mesh(r));
  CHECK(strlen(aqr_status_string(status)) > 5);
  aqr_remesher_free(r);
  return status;
}

AQR_TEST(every_unusable_input_has_its_status)
{
  double points[] = { 0, 0, 0, 1, 0, 0, 0, 1, 0 };
  int64_t triangle[] = { 0, 1, 2 };
  aqr_input input = { .number_of_points = 3, .points_d = points, .number_of_triangles = 1, .triangles = triangle };
  CHECK(status_of_input(&input) == AQR_OK);
  input.number_of_triangles = 0;
  CHECK(status_of_input(&input) == AQR_EMPTY_INPUT);
  input.number_of_triangles = 1;
  input.number_of_points = 0;
  CHECK(status_of_input(&input) == AQR_EMPTY_INPUT);
  input.number_of_points = 3;
  triangle[2] = 3;
  CHECK(status_of_input(&input) == AQR_INDEX_OUT_OF_RANGE);
  triangle[2] = -1;
  CHECK(status_of_input(&input) == AQR_INDEX_OUT_OF_RANGE);
  triangle[2] = 2;
  points[4] = NAN;
  CHECK(status_of_input(&input) == AQR_NON_FINITE_POINT);
  points[4] = INFINITY;
  CHECK(status_of_input(&input) == AQR_NON_FINITE_POINT);
  points[4] = points[7] = 0;
  CHECK(status_of_input(&input) == AQR_DEGENERATE_INPUT);
  points[7] = 1;
  CHECK(status_of_input(&input) == AQR_OK);
  /* nothing may be read before the sizes are known to be good */
  input.number_of_triangles = UINT32_MAX / 12 + 1;
  CHECK(status_of_input(&input) == AQR_TOO_LARGE);
  input.number_of_triangles = SIZE_MAX;
  CHECK(status_of_input(&input) == AQR_TOO_LARGE);
  input.number_of_triangles = 1;
  input.number_of_points = UINT32_MAX / 6 + 1;
  CHECK(status_of_input(&input) == AQR_TOO_LARGE);
}

AQR_TEST(every_status_has_a_sentence_of_its_own)
{
  for (int i = AQR_OK; i <= AQR_INTERNAL + 1; i++)
    for (int j = AQR_OK; j < i; j++)
      CHECK(strcmp(aqr_status_string((aqr_status)i), aqr_status_string((aqr_status)j)) != 0);
}

AQR_TEST(what_is_repaired_is_counted)
{
  shape m = shape_sphere(6, 4);
  size_t n = m.n_triangles;
  m.triangles = realloc(m.triangles, 3 * (n + 4) * sizeof *m.triangles);
  int64_t* more = m.triangles + 3 * n;
  for (int k = 0; k < 3; k++)
  {
    more[k] = m.triangles[k];               /* the first once more */
    more[3 + k] = m.triangles[5 - k];       /* the second turned over */
    more[6 + k] = m.triangles[6 + k / 2];   /* one point twice */
    more[9 + k] = m.triangles[(k + 1) % 3]; /* the first beginning elsewhere */
  }
  m.n_triangles += 4;
  aqr_options o = options_for_points(100);
  aqr_remesher* r = remesh(&m, &o);
  const aqr_report* report = aqr_remesher_report(r);
  CHECK(report->duplicate_triangles == 3 && report->degenerate_triangles == 1);
  CHECK(!survey_mesh(aqr_remesher_mesh(r)).flaw && survey_mesh(aqr_remesher_mesh(r)).euler == 2);
  aqr_remesher_free(r);
  shape_free(&m);
}

typedef struct owner
{
  int allocations, steps;
} owner;

static void* owned(void* user, void* old, size_t old_bytes, size_t bytes)
{
  owner* o = user;
  (void)old_bytes;
  o->allocations++;
  if (bytes)
    return realloc(old, bytes);
  free(old);
  return NULL;
}

static int stepped(void* user, double fraction, const char* stage)
{
  (void)fraction, (void)stage;
  ((owner*)user)->steps++;
  return 1;
}

/* Hooks are replaced between two runs: memory would be freed by an allocator that does not know it. */
AQR_TEST(memory_stays_with_the_allocator_it_came_from)
{
  shape m = shape_sphere(6, 4);
  aqr_input input = shape_input(&m);
  aqr_options o = options_for_points(100);
  for (int custom = 0; custom < 2; custom++)
  {
    owner first = { 0, 0 }, second = { 0, 0 };
    aqr_hooks hooks = { .user = &first, .reallocate = custom ? owned : NULL };
    aqr_remesher* r = NULL;
    CHECK(aqr_remesher_new(&hooks, &r) == AQR_OK);
    CHECK(aqr_remesher_set_input(r, &input) == AQR_OK && again(r, o) == AQR_OK);
    hooks = (aqr_hooks){ .user = &second, .reallocate = owned, .progress = stepped };
    aqr_remesher_set_hooks(r, &hooks);
    o.curvature_radius *= 2;
    CHECK(again(r, o) == AQR_OK);
    CHECK(second.allocations == 0);
    /* the user data goes with the allocator, where there is one */
    CHECK((custom ? first.steps : second.steps) > 0);
    aqr_remesher_set_hooks(r, NULL);
    o.curvature_radius /= 2;
    first.steps = second.steps = 0;
    CHECK(again(r, o) == AQR_OK && first.steps == 0 && second.steps == 0);
    aqr_remesher_free(r);
    CHECK(!custom || first.allocations > 0);
  }
  shape_free(&m);
}

AQR_TEST(every_option_out_of_range_is_named)
{
  shape m = shape_sphere(6, 14);
  aqr_options good = options_for_points(50);
  aqr_remesher* r = remesh(&m, &good);
  uint64_t before = hash_results(r);
  for (int k = 0; k < 28; k++)
  {
    aqr_options o = good;
    enum
    {
      n = 10
    };
    double low[n] = { 0, -1, -1, 0, 1e-5, -0.1, -0.1, NAN, NAN, NAN };
    double high[n] = { 0.2, 0.3, 91, 181, 1.1, 1.1, NAN, INFINITY, NAN, NAN };
    double* real[n] = { &o.tolerance, &o.curvature_radius, &o.confidence_angle, &o.feature_angle, &o.largest_spacing,
      &o.anisotropy, &o.adaptivity, &o.tolerance, &o.feature_angle, &o.curvature_radius };
    const char* names[n] = { "tolerance", "curvature_radius", "confidence_angle", "feature_angle", "largest_spacing",
      "anisotropy", "adaptivity", "tolerance", "feature_angle", "curvature_radius" };
    const char* name = names[k % n];
    if (k < 2 * n)
      *real[k % n] = k < n ? low[k] : high[k - n];
    else if (k < 22)
      o.target_points = k == 20 ? 3 : INT64_C(1) << 31, name = "target_points";
    else if (k < 24)
      o.smoothing_iterations = k == 22 ? -1 : 1001, name = "smoothing_iterations";
    else if (k < 26)
      o.largest_valence = k == 24 ? 3 : 65, name = "largest_valence";
    else if (k == 26)
      o.density = (aqr_density)2, name = "density";
    else
      o.cookie = 0, name = "cookie";
    CHECK(again(r, o) == AQR_BAD_OPTION);
    if (!strstr(aqr_remesher_message(r), name))
      printf("%d: \"%s\" does not name %s\n", k, aqr_remesher_message(r), name);
    CHECK(strstr(aqr_remesher_message(r), name));
    CHECK(!aqr_remesher_mesh(r) && !aqr_remesher_lines(r) && !aqr_remesher_field(r));
  }
  CHECK(again(r, good) == AQR_OK && hash_results(r) == before && !*aqr_remesher_message(r));
  aqr_remesher_free(r);
  shape_free(&m);
}

/* What is allowed must be met or missed, but never end in a broken mesh; all else is refused. */
AQR_TEST(no_value_of_any_option_is_without_a_defined_outcome)
{
  const double wild[] = { NAN, INFINITY, -INFINITY, -1, -0.0, 0, DBL_TRUE_MIN, 1e-6, 1e-4, 0.2, 1, 90, 180, 1e9,
    DBL_MAX };
  enum
  {
    n = 7
  };
  const double low[n] = { 1e-7, 0, 0, 1e-6, 1e-4, 0, 0 }, high[n] = { 0.1, 0.2, 90, 180, 1, 1, 1 };
  shape shapes[] = { shape_sphere(3, 16), shape_cylinder(4, 17) };
  for (int s = 0; s < 2; s++)
    for (size_t k = 0; k < n * sizeof wild / sizeof *wild; k++)
    {
      double x = wild[k / n];
      aqr_options o = options_for_points(30);
      if (k % n == 0 && x >= 1e-7 && x < 1e-3)
        continue;                                                          /* would only be slow */
      o.density = k % n == 4 ? AQR_DENSITY_POINTS : AQR_DENSITY_TOLERANCE; /* which bounds the finest spacing */
      o.tolerance = 0.02;
      o.largest_spacing = 0.3;
      double* value[] = { &o.tolerance, &o.curvature_radius, &o.confidence_angle, &o.feature_angle, &o.largest_spacing,
        &o.anisotropy, &o.adaptivity };
      *value[k % n] = x;
      aqr_input input = shape_input(&shapes[s]);
      aqr_status status;
      const char* fault = examine(&input, &o, &status);
      aqr_status wanted = x >= low[k % n] && x <= high[k % n] ? AQR_OK : AQR_BAD_OPTION;
      if (fault || status != wanted)
        printf("shape %d, option %zu, value %g: %s, %s\n", s, k % n, x, aqr_status_string(status), fault ? fault : "");
      CHECK(!fault && status == wanted);
    }
  shape_free(&shapes[0]);
  shape_free(&shapes[1]);
}

/* In units from the smallest to the largest: at the ends of the range nothing may vanish or overflow. */
AQR_TEST(the_finest_and_the_coarsest_tolerance_give_a_valid_mesh_in_any_unit)
{
  const double units[] = { 1e-30, 1e-12, 1, 1e12, 1e30 }, tolerances[] = { 0.1, 1e-3, 1e-7 };
  for (size_t u = 0; u < sizeof units / sizeof *units; u++)
  {
    shape m = shape_grid(24, 3, false, false, 0.2, 1, place_on_cylinder);
    for (size_t i = 0; i < 3 * m.n_points; i++)
      m.points[i] *= i % 3 == 2 ? 0.1 * units[u] : units[u];
    size_t fewer = 0;
    for (size_t k = 0; k < sizeof tolerances / sizeof *tolerances; k++)
    {
      aqr_options o = aqr_default_options();
      o.tolerance = tolerances[k];
      aqr_input input = shape_input(&m);
      aqr_status status;
      CHECK(!examine(&input, &o, &status) && status == AQR_OK);
      aqr_remesher* r = remesh(&m, &o);
      printf("%g at %g: %zu points\n", tolerances[k], units[u], points_of(r));
      CHECK(points_of(r) > fewer);
      fewer = points_of(r);
      aqr_remesher_free(r);
    }
    shape_free(&m);
  }
}

AQR_TEST(options_that_contradict_each_other_still_give_a_valid_mesh)
{
  shape shapes[] = { shape_cube(3, 0.2, 18), shape_cylinder(5, 19) };
  for (int s = 0; s < 2; s++)
    for (int k = 0; k < 9; k++)
    {
      aqr_options o = options_for_points(k == 0 ? 4 : k == 1 ? 3000 : 60);
      o.largest_spacing = k == 2 ? 1e-4 : k == 3 ? 1 : o.largest_spacing; /* far finer, far coarser than the target */
      o.curvature_radius = k == 4 ? 0.2 : o.curvature_radius;             /* larger than the spacing */
      o.smoothing_iterations = k == 4 ? 1000 : o.smoothing_iterations;
      o.confidence_angle = k == 5 ? 0 : k == 6 ? 90 : o.confidence_angle; /* nothing, everything is trusted */
      o.feature_angle = k == 5 ? 1e-6 : k == 6 ? 180 : o.feature_angle;   /* everything, nothing is a crease */
      o.largest_valence = k == 7 ? 4 : k == 8 ? 64 : o.largest_valence;
      o.convex_partition = k != 8;
      o.seed = k == 8 ? UINT32_MAX : 0;
      o.feature_lines = k == 7 ? -5 : 1; /* a truth value is what C takes for one */
      aqr_input input = shape_input(&shapes[s]);
      aqr_status status;
      const char* fault = examine(&input, &o, &status);
      if (fault || status != AQR_OK)
        printf("shape %d, case %d: %s, %s\n", s, k, aqr_status_string(status), fault ? fault : "");
      CHECK(!fault && status == AQR_OK);
    }
  for (int s = 0; s < 2; s++)
    shape_free(&shapes[s]);
}

/* ---- hooks ---- */

typedef struct watcher
{
  double last;
  int calls, allowed;
  bool fell;
} watcher;

static int watch(void* user, double fraction, const char* stage)
{
  watcher* w = user;
  w->fell |= fraction < w->last || fraction > 1 || !stage || !*stage;
  w->last = fraction;
  return w->calls++ < w->allowed;
}

AQR_TEST(a_target_that_cannot_be_met_is_said_to_be_missed)
{
  shape m = shape_sphere(5, 21);
  aqr_options o = options_for_points(2147483647);
  aqr_remesher* r = remesh(&m, &o);
  printf("%zu points\n", points_of(r));
  CHECK(aqr_remesher_report(r)->target_missed && !survey_mesh(aqr_remesher_mesh(r)).flaw);
  o.target_points = 4;
  CHECK(again(r, o) == AQR_OK);
  survey few = survey_mesh(aqr_remesher_mesh(r));
  printf("%zu points for a target of 4\n", few.points);
  CHECK(!few.flaw && few.euler == 2 && few.loops == 0);
  aqr_remesher_free(r);
  shape_free(&m);
}

/* ---- hooks ---- */

AQR_TEST(cancelling_anywhere_leaves_nothing_and_the_next_run_works)
{
  shape m = shape_plate(1, 4, 8, 15);
  aqr_options o = options_for_points(150);
  aqr_input input = shape_input(&m);
  aqr_remesher* r = remesh(&m, &o);
  uint64_t undisturbed = hash_results(r);
  aqr_remesher_free(r);
  for (int allowed = 0; allowed < 400; allowed = allowed * 3 / 2 + 1)
  {
    watcher w = { .allowed = allowed };
    aqr_hooks hooks = { .user = &w, .progress = watch };
    CHECK(aqr_remesher_new(&hooks, &r) == AQR_OK);
    aqr_status status = aqr_remesher_set_input(r, &input);
    w.last = 0;
    if (status == AQR_OK)
      status = aqr_remesher_run(r, &o);
    CHECK(status == (w.calls > allowed ? AQR_CANCELLED : AQR_OK) && !w.fell);
    CHECK(status == AQR_OK || !aqr_remesher_mesh(r));
    w = (watcher){ .allowed = 1 << 30 };
    CHECK(aqr_remesher_set_input(r, &input) == AQR_OK);
    w.last = 0;
    CHECK(again(r, o) == AQR_OK && hash_results(r) == undisturbed && !w.fell);
    CHECK_BELOW(fabs(w.last - 1), 1e-12);
    aqr_remesher_free(r);
  }
  shape_free(&m);
}

AQR_TEST_MAIN
