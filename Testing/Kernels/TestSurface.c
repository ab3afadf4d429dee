/* SPDX-License-Identifier: BSD-3-Clause */
#include "test.h"

#include "model.h"
#include "threads.h"

#include <string.h>

/* Every triangle of a torus with points of its own, which come in the opposite order. */
static shape torn_torus(size_t* n_whole)
{
  shape m = shape_torus(120, 60);
  size_t n = 3 * m.n_triangles;
  double* points = malloc(3 * n * sizeof *points);
  for (size_t i = 0; i < n; i++)
  {
    memcpy(points + 3 * (n - 1 - i), m.points + 3 * m.triangles[i], 3 * sizeof *points);
    m.triangles[i] = (int64_t)(n - 1 - i);
  }
  *n_whole = m.n_points;
  free(m.points);
  m.points = points;
  m.n_points = n;
  return m;
}

/* Attributes are taken from the point that stays. */
AQR_TEST(of_equal_points_the_first_that_a_triangle_uses_stays_on_any_number_of_threads)
{
  for (size_t threads = 1; threads <= 4; threads++)
  {
    size_t whole;
    shape m = torn_torus(&whole);
    aqr_input input = shape_input(&m);
    aqr_hooks hooks = { .user = &threads, .parallel_for = on_threads };
    aqr_context c = { .hooks = hooks, .end = 1 };
    aqr_report report = { 0 };
    aqr_surface s;
    CHECK(aqr_surface_build(&c, &input, 1, &s, &report) == AQR_OK);
    CHECK(s.n_points == whole && report.merged_points == m.n_points - whole && report.unused_points == 0);
    for (size_t i = 0; i < s.n_points; i += 101)
    {
      const double* p = m.points + 3 * s.origin[i];
      for (size_t k = s.origin[i] + 1; k < m.n_points; k++)
        CHECK(memcmp(p, m.points + 3 * k, 3 * sizeof *p) != 0); /* none used before it */
    }
    aqr_surface_free(&c, &s);
    CHECK(c.bytes == 0);
    shape_free(&m);
  }
}

/* Triangles that repeat are seen where their half-edges meet: also among others at an edge, and none that only touch.
 */
AQR_TEST(fins_that_repeat_are_dropped_and_others_kept)
{
  shape m = shape_torus(40, 20);
  size_t n = m.n_triangles;
  m.triangles = realloc(m.triangles, 3 * (n + 4) * sizeof *m.triangles);
  int64_t *fin = m.triangles + 3 * n, far = m.triangles[3 * (n / 2)];
  for (int k = 0; k < 3; k++)
  {
    fin[k] = k < 2 ? m.triangles[k] : far;
    fin[3 + (k + 1) % 3] = fin[k];
    fin[6 + 2 - k] = fin[k];
    fin[9 + k] = k < 2 ? m.triangles[k] : m.triangles[3 * (n / 3)];
  }
  for (size_t threads = 1; threads <= 2; threads++)
    for (m.n_triangles = n; m.n_triangles <= n + 4; m.n_triangles++)
    {
      aqr_input input = shape_input(&m);
      aqr_hooks hooks = { .user = &threads, .parallel_for = on_threads };
      aqr_context c = { .hooks = hooks, .end = 1 };
      aqr_report report = { 0 };
      aqr_surface s;
      size_t fins = m.n_triangles - n, kept = fins == 0 ? 0 : fins < 4 ? 1 : 2;
      CHECK(aqr_surface_build(&c, &input, 1, &s, &report) == AQR_OK);
      CHECK(report.duplicate_triangles == fins - kept && report.degenerate_triangles == 0);
      CHECK(report.split_edges == (kept > 0) && s.n_faces == n + kept);
      aqr_surface_free(&c, &s);
      CHECK(c.bytes == 0);
    }
  shape_free(&m);
}

/* Two fans around the points 0 and 1 over one rim. Where all that meets at a point is compared with all else there,
 * this takes longer than a test may. */
static shape spindle(size_t n, size_t fins)
{
  shape m = { .n_points = 2 + n, .n_triangles = 2 * n + fins };
  m.points = calloc(3 * m.n_points, sizeof *m.points);
  m.triangles = malloc(3 * m.n_triangles * sizeof *m.triangles);
  m.points[2] = 1;
  m.points[5] = -1;
  for (size_t i = 0; i < n; i++)
  {
    double turn = 2 * acos(-1) * (double)i / (double)n;
    int64_t a = (int64_t)(2 + i), b = (int64_t)(2 + (i + 1) % n);
    m.points[3 * a] = cos(turn);
    m.points[3 * a + 1] = sin(turn);
    memcpy(m.triangles + 6 * i, (int64_t[6]){ 0, a, b, 1, b, a }, 6 * sizeof a);
  }
  for (size_t i = 0; i < fins; i++) /* from one spoke to the opposite one */
    memcpy(m.triangles + 6 * n + 3 * i, (int64_t[3]){ 0, (int64_t)(2 + i), (int64_t)(2 + n / 2 + i) },
      3 * sizeof *m.triangles);
  return m;
}

AQR_TEST(a_million_triangles_around_a_point_meet_as_those_around_any_other)
{
  for (size_t fins = 0; fins <= 3; fins += 3)
  {
    shape m = spindle(fins ? 1000 : 1000000, fins);
    aqr_input input = shape_input(&m);
    aqr_context c = { .end = 1 };
    aqr_report report = { 0 };
    aqr_surface s;
    CHECK(aqr_surface_build(&c, &input, 4, &s, &report) == AQR_OK);
    CHECK(s.n_faces == m.n_triangles && report.split_edges == 2 * fins && report.unorientable_edges == 0);
    CHECK(fins || (report.components == 1 && report.boundary_loops == 0 && s.n_points == m.n_points));
    aqr_surface_free(&c, &s);
    CHECK(c.bytes == 0);
    shape_free(&m);
  }
}

AQR_TEST_MAIN
