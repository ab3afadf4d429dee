/* SPDX-License-Identifier: BSD-3-Clause */
#include "test.h"

#include "remesh.h"
#include "solids.h"

typedef struct census
{
  size_t type[4], end[8], lines;
} census;

static census count_lines(const aqr_remesher* r)
{
  census k = { .lines = 0 };
  const aqr_lines_view* l = aqr_remesher_lines(r);
  for (size_t i = 0; l && i < l->number_of_lines; i++, k.lines++)
  {
    k.type[l->type[i]]++;
    k.end[l->ends[2 * i]]++;
    k.end[l->ends[2 * i + 1]]++;
  }
  printf("min %zu max %zu boundary %zu feature %zu; ends: loop %zu boundary %zu feature %zu proximity %zu self %zu "
         "length %zu corner %zu cut %zu\n",
    k.type[0], k.type[1], k.type[2], k.type[3], k.end[0], k.end[1], k.end[2], k.end[3], k.end[4], k.end[5], k.end[6],
    k.end[7]);
  return k;
}

static census lines_on(shape m, aqr_options o)
{
  aqr_remesher* r = remesh(&m, &o);
  census k = count_lines(r);
  const aqr_lines_view* l = aqr_remesher_lines(r);
  for (size_t i = 0; i < l->number_of_lines; i++)
  {
    size_t a = (size_t)l->offsets[i], b = (size_t)l->offsets[i + 1] - 1;
    vec3 gap = v3_sub(v3_load(l->points + 3 * a), v3_load(l->points + 3 * b));
    CHECK(b > a && (l->ends[2 * i] == AQR_END_LOOP) == (l->ends[2 * i + 1] == AQR_END_LOOP));
    CHECK(l->ends[2 * i] != AQR_END_LOOP || v3_norm(gap) <= 0); /* a loop is closed as one polyline */
    for (size_t j = a; j < b; j++)
      CHECK(l->arc_length[j + 1] >= l->arc_length[j]);
  }
  aqr_remesher_free(r);
  shape_free(&m);
  return k;
}

static vec3 cube_to_bar(vec3 p)
{
  return v3(4 * p.x, 0.06 * p.y, 0.05 * p.z);
}

/* The closest two points of a result. */
static double least_distance(const aqr_mesh* m)
{
  double least = INFINITY;
  for (size_t i = 0; i < m->number_of_points; i++)
    for (size_t j = 0; j < i; j++)
      least = fmin(least, v3_norm(v3_sub(v3_load(m->points + 3 * i), v3_load(m->points + 3 * j))));
  return least;
}

AQR_TEST(lines_around_a_bar_do_not_end_in_two_vertices_at_one_place)
{
  for (int64_t points = 60; points <= 160; points += 20)
  {
    shape m = shape_cube(16, 0, 1);
    aqr_options o = options_for_points(points);
    shape_map(&m, cube_to_bar);
    aqr_remesher* r = remesh(&m, &o);
    double least = least_distance(aqr_remesher_mesh(r));
    printf("%d points asked: the closest two are %g apart\n", (int)points, least);
    CHECK(least > 1e-3);
    aqr_remesher_free(r);
    shape_free(&m);
  }
}

AQR_TEST(every_type_of_line_and_end_is_found_where_it_belongs)
{
  aqr_options smooth = options_for_points(300); /* where the shape has no creases but those of its triangles */
  smooth.feature_lines = 0;
  census k = lines_on(shape_torus(20, 1), smooth);
  CHECK(
    k.type[AQR_LINE_MIN] > 3 && k.type[AQR_LINE_MAX] > 3 && !k.type[AQR_LINE_BOUNDARY] && !k.type[AQR_LINE_FEATURE]);
  CHECK(k.end[AQR_END_LOOP] > 10 && !k.end[AQR_END_BOUNDARY] && !k.end[AQR_END_FEATURE] && !k.end[AQR_END_CORNER]);
  k = lines_on(shape_cylinder(30, 2), smooth);
  CHECK(k.type[AQR_LINE_BOUNDARY] == 2 && !k.type[AQR_LINE_FEATURE]);
  CHECK(k.end[AQR_END_BOUNDARY] > 10 && k.end[AQR_END_LOOP] > 10 && !k.end[AQR_END_FEATURE]);
  k = lines_on(shape_cube(12, 0, 3), options_for_points(300));
  CHECK(k.type[AQR_LINE_FEATURE] == 12 && k.end[AQR_END_CORNER] == 24);
  CHECK(k.end[AQR_END_FEATURE] > 10 && !k.end[AQR_END_BOUNDARY]);
  k = lines_on(shape_sphere(20, 4), options_for_points(400));
  CHECK(k.end[AQR_END_PROXIMITY] + k.end[AQR_END_SELF] > 0);
  CHECK(k.end[AQR_END_LENGTH] == 0);
  aqr_options coarse = aqr_default_options();
  coarse.tolerance = 0.05;
  coarse.largest_spacing = 1;
  size_t cuts = 0;
  for (unsigned seed = 10; seed < 16; seed++)
    cuts += lines_on(shape_plate(2, 4, 8, seed), coarse).end[AQR_END_CUT];
  CHECK(cuts > 0);
}

/* Along a line through a plane the lines that cross it come at the largest spacing. */
AQR_TEST(neighbouring_lines_on_a_plane_keep_their_spacing)
{
  shape m = shape_grid(40, 40, false, false, 0.2, 6, place_on_plane);
  aqr_options o = aqr_default_options();
  o.largest_spacing = 0.07;
  aqr_remesher* r = remesh(&m, &o);
  const aqr_lines_view* l = aqr_remesher_lines(r);
  double spacing = 0.07 * sqrt(2);
  size_t near = 0, far = 0, asked = 0;
  for (size_t i = 0; i < l->number_of_lines; i++)
    for (size_t a = (size_t)l->offsets[i]; a + 1 < (size_t)l->offsets[i + 1]; a++)
    {
      vec3 p = v3_load(l->points + 3 * a), d = v3_unit(v3_sub(v3_load(l->points + 3 * (a + 1)), p));
      double nearest = INFINITY;
      for (size_t j = 0; j < l->number_of_lines; j++)
        for (size_t b = (size_t)l->offsets[j]; j != i && b + 1 < (size_t)l->offsets[j + 1]; b++)
        {
          vec3 q = v3_load(l->points + 3 * b), e = v3_unit(v3_sub(v3_load(l->points + 3 * (b + 1)), q));
          if (fabs(v3_dot(d, e)) > 0.8)
            nearest = fmin(nearest,
              v3_norm(v3_reject(v3_sub(q, p), d)) + 1e3 * fmax(0, fabs(v3_dot(v3_sub(q, p), d)) - spacing / 2));
        }
      asked++;
      near += nearest < 0.35 * spacing;
      far += nearest > 1.8 * spacing;
    }
  CHECK(asked > 500);
  CHECK_BELOW((double)near, 0.05 * (double)asked);
  CHECK_BELOW((double)far, 0.05 * (double)asked);
  aqr_remesher_free(r);
  shape_free(&m);
}

/* A ball with a spike of a ten-thousandth of its size: lines that wind about it would be longer than all others. */
static vec3 spiked(vec3 p)
{
  double r = hypot(p.x, p.y);
  return p.z > 0 && r < 0.12 ? v3(1e-3 * p.x, 1e-3 * p.y, p.z + (0.12 - r) * 10) : p;
}
AQR_TEST(lines_do_not_wind_about_a_microscopic_tube)
{
  shape m = shape_sphere(40, 7);
  shape_map(&m, spiked);
  aqr_options o = options_for_points(500);
  aqr_remesher* r = remesh(&m, &o);
  const aqr_lines_view* l = aqr_remesher_lines(r);
  size_t samples = l->number_of_points;
  printf("%zu points in %zu lines\n", samples, l->number_of_lines);
  CHECK_BELOW((double)samples, 150.0 * (double)l->number_of_lines);
  CHECK(!survey_mesh(aqr_remesher_mesh(r)).flaw && survey_mesh(aqr_remesher_mesh(r)).euler == 2);
  aqr_remesher_free(r);
  shape_free(&m);
}

AQR_TEST_MAIN
