/* SPDX-License-Identifier: BSD-3-Clause */
#include "test.h"

#include "creases.h"
#include "feature_graph.h"

#include <stdlib.h>

static const double tau = 6.28318530717958648;

/* ---- shapes ---- */

typedef struct shape
{
  double points[3 * 40000];
  int64_t triangles[3 * 80000];
  size_t n_points, n_triangles;
} shape;

static int64_t point(shape* a, double x, double y, double z)
{
  double* p = a->points + 3 * a->n_points;
  p[0] = x;
  p[1] = y;
  p[2] = z;
  return (int64_t)a->n_points++;
}

static void triangle(shape* a, int64_t i, int64_t j, int64_t k)
{
  int64_t* t = a->triangles + 3 * a->n_triangles++;
  t[0] = i;
  t[1] = j;
  t[2] = k;
}

static void quad(shape* a, int64_t i, int64_t j, int64_t k, int64_t l)
{
  triangle(a, i, j, k);
  triangle(a, i, k, l);
}

/* The six sides of a cube but for the last `open` ones. */
static shape* cube(unsigned open)
{
  static const int64_t side[6][4] = { { 0, 2, 3, 1 }, { 0, 1, 5, 4 }, { 1, 3, 7, 5 }, { 3, 2, 6, 7 }, { 2, 0, 4, 6 },
    { 4, 5, 7, 6 } };
  shape* a = calloc(1, sizeof *a);
  for (unsigned i = 0; i < 8; i++)
    point(a, i & 1, (i >> 1) & 1, i >> 2);
  for (unsigned i = 0; i < 6 - open; i++)
    quad(a, side[i][0], side[i][1], side[i][2], side[i][3]);
  return a;
}

static shape* cylinder(unsigned n)
{
  shape* a = calloc(1, sizeof *a);
  int64_t low = point(a, 0, 0, 0), high = point(a, 0, 0, 1);
  for (unsigned i = 0; i < n; i++)
    for (unsigned k = 0; k < 2; k++)
      point(a, cos(tau * i / n), sin(tau * i / n), k);
  for (unsigned i = 0; i < n; i++)
  {
    int64_t p = 2 + 2 * i, q = 2 + 2 * ((i + 1) % n);
    quad(a, p, q, q + 1, p + 1);
    triangle(a, low, q, p);
    triangle(a, high, p + 1, q + 1);
  }
  return a;
}

/* nu by nv quads over the unit square times (width, 1), lifted by `height`. */
static shape* sheet(unsigned nu, unsigned nv, double width, double (*height)(double, double))
{
  shape* a = calloc(1, sizeof *a);
  for (unsigned i = 0; i <= nu; i++)
    for (unsigned j = 0; j <= nv; j++)
      point(a, width * i / nu, (double)j / nv, height((double)i / nu, (double)j / nv));
  for (unsigned i = 0; i < nu; i++)
    for (unsigned j = 0; j < nv; j++)
    {
      int64_t p = i * (nv + 1) + j, q = p + nv + 1;
      quad(a, p, q, q + 1, p + 1);
    }
  return a;
}

static double flat(double x, double y)
{
  return 0 * x * y;
}
/* A roof with a right angle at x = 0 that fades smoothly to a plain in the middle. */
static double dart(double x, double y)
{
  double fade = fmax(0, 0.5 - x);
  return -4 * fabs(y - 0.5) * fade * fade;
}

static shape* noisy_sphere(unsigned n, double noise)
{
  shape* a = calloc(1, sizeof *a);
  unsigned state = 7;
  for (unsigned i = 0; i <= n; i++)
    for (unsigned j = 0; j < 2 * n; j++)
    {
      double u = tau / 2 * i / n, v = tau / 2 * j / n;
      state = state * 1664525u + 1013904223u;
      double r = 1 + (i % n ? noise / n * ((state >> 8) / 8388608.0 - 1) : 0);
      point(a, r * sin(u) * cos(v), r * sin(u) * sin(v), i == n ? -1 : i == 0 ? 1 : r * cos(u));
      if (i % n == 0) /* all copies of a pole in one place */
        a->points[3 * a->n_points - 3] = a->points[3 * a->n_points - 2] = 0;
    }
  for (unsigned i = 0; i < n; i++)
    for (unsigned j = 0; j < 2 * n; j++)
    {
      int64_t p = 2 * n * i + j, q = 2 * n * i + (j + 1) % (2 * n);
      quad(a, p, p + 2 * n, q + 2 * n, q);
    }
  return a;
}

/* ---- what is found on them ---- */

typedef struct found
{
  aqr_context c;
  aqr_surface s;
  aqr_chains chains;
  aqr_report report;
  aqr_status status;
  uint8_t* crease;
  size_t features, borders, closed, corners;
} found;

static aqr_status run(found* f, const shape* a, double longest_edge)
{
  aqr_input in = { .number_of_points = a->n_points,
    .points_d = a->points,
    .number_of_triangles = a->n_triangles,
    .triangles = a->triangles };
  aqr_status status = aqr_surface_build(&f->c, &in, longest_edge, &f->s, &f->report);
  if (status != AQR_OK)
    return status;
  f->crease = calloc(3 * f->s.n_faces, 1);
  status = aqr_features_detect(&f->c, &f->s, 40, 0.02, f->crease, &f->report);
  if (status == AQR_OK)
    status = aqr_surface_cut(&f->c, &f->s, f->crease);
  if (status == AQR_OK)
    status = aqr_chains_build(&f->c, &f->s, 45, &f->chains);
  return status;
}

static aqr_index clean_from(const found* f, aqr_index h)
{
  return f->s.clean[aqr_from(&f->s, h)];
}
static aqr_index clean_to(const found* f, aqr_index h)
{
  return f->s.clean[aqr_to(&f->s, h)];
}

/* Every seam once, by one of its sides, and every boundary half-edge, each chain head to tail between nodes. */
static void check_chains(const found* f)
{
  const aqr_surface* s = &f->s;
  const aqr_chains* k = &f->chains;
  size_t total = 0, listed = 0;
  uint8_t* seen = calloc(3 * s->n_faces, 1);
  for (size_t i = 0; i < k->n_chains; i++)
  {
    const aqr_chain* a = &k->chains[i];
    CHECK(a->count > 0 && a->first == total);
    total += a->count;
    for (size_t j = 0; j < a->count; j++)
    {
      aqr_index h = k->half_edges[a->first + j];
      CHECK(a->is_feature ? aqr_is_seam(s, h) : aqr_is_boundary(s, h));
      CHECK(!seen[h] && (!a->is_feature || !seen[aqr_any_twin(s, h)]));
      seen[h] = 1;
      if (j > 0)
        CHECK(clean_to(f, k->half_edges[a->first + j - 1]) == clean_from(f, h));
      CHECK(k->is_node[clean_from(f, h)] == (j > 0 || a->closed ? 2 : 1));
    }
    aqr_index first = k->half_edges[a->first], last = k->half_edges[a->first + a->count - 1];
    if (a->closed)
      CHECK(clean_to(f, last) == clean_from(f, first));
    else
      CHECK(k->is_node[clean_to(f, last)] == 1);
  }
  for (aqr_index h = 0; h < 3 * s->n_faces; h++)
    listed += aqr_is_boundary(s, h) || (aqr_is_seam(s, h) && h < aqr_any_twin(s, h));
  CHECK(total == k->n_half_edges && total == listed);
  free(seen);
}

static found find(shape* a, double longest_edge)
{
  found f = { 0 };
  f.status = run(&f, a, longest_edge);
  CHECK(f.status == AQR_OK);
  check_chains(&f);
  for (size_t i = 0; i < f.chains.n_chains; i++)
  {
    f.features += f.chains.chains[i].is_feature;
    f.borders += !f.chains.chains[i].is_feature;
    f.closed += f.chains.chains[i].closed;
  }
  for (size_t v = 0; v < f.chains.n_clean; v++)
    f.corners += f.chains.is_node[v] == 1;
  free(a);
  return f;
}

static void drop(found* f)
{
  aqr_chains_free(&f->c, &f->chains);
  aqr_surface_free(&f->c, &f->s);
  free(f->crease);
  CHECK(f->c.bytes == 0);
}

/* ---- creases ---- */

AQR_TEST(a_cube_keeps_its_twelve_edges_and_eight_corners_coarse_or_fine)
{
  for (unsigned fine = 0; fine < 2; fine++)
  {
    found f = find(cube(0), fine ? 0.05 : 10);
    CHECK(f.features == 12 && f.borders == 0 && f.closed == 0 && f.corners == 8);
    CHECK(fine ? f.report.feature_edges > 12 : f.report.feature_edges == 12);
    drop(&f);
  }
}

AQR_TEST(rims_of_a_cylinder_become_two_closed_loops)
{
  found f = find(cylinder(24), 0.1);
  CHECK(f.features == 2 && f.closed == 2 && f.corners == 0);
  drop(&f);
}

AQR_TEST(a_face_without_area_does_not_interrupt_the_crease_it_lies_on)
{
  shape* a = cube(0);
  /* splits the edge from 0 to 1 on one side only; a triangle of three collinear points fills the slit */
  int64_t m = point(a, 0.3, 0, 0);
  for (size_t i = 0; i < a->n_triangles; i++)
  {
    int64_t* t = a->triangles + 3 * i;
    for (unsigned k = 0; k < 3; k++)
      if (t[k] == 0 && t[(k + 1) % 3] == 1)
      {
        int64_t other = t[(k + 2) % 3];
        t[(k + 1) % 3] = m;
        triangle(a, m, 1, other);
        triangle(a, 0, 1, m);
        i = a->n_triangles;
        break;
      }
  }
  CHECK(a->n_triangles == 14);
  found f = find(a, 10);
  CHECK(f.features == 12 && f.corners == 8 && f.report.feature_edges == 13);
  drop(&f);
}

AQR_TEST(noise_of_a_scan_is_no_feature_however_steep)
{
  found f = find(noisy_sphere(40, 1.5), 10);
  size_t steep = 0;
  for (aqr_index h = 0; h < 3 * f.s.n_faces; h++)
  {
    aqr_index t = aqr_any_twin(&f.s, h);
    CHECK(t != AQR_NONE);
    if (t != AQR_NONE)
      steep += v3_dot(v3_unit(aqr_face_cross(&f.s, h / 3)), v3_unit(aqr_face_cross(&f.s, t / 3))) < 0.766;
  }
  CHECK(steep > 1000);
  CHECK(f.features == 0 && f.report.feature_edges == 0);
  drop(&f);
}

AQR_TEST(a_crease_that_ends_inside_a_face_ends_in_a_node)
{
  found f = find(sheet(40, 40, 1, dart), 10);
  CHECK(f.features == 1 && f.closed == 0);
  const aqr_chain* a = f.chains.chains;
  CHECK(a->is_feature && a->count > 5 && a->count < 20);
  aqr_index first = f.chains.half_edges[a->first], last = f.chains.half_edges[a->first + a->count - 1];
  CHECK(f.chains.is_node[clean_from(&f, first)] == 1 && f.chains.is_node[clean_to(&f, last)] == 1);
  /* one point more for each but the one the crease ends at */
  CHECK(f.s.n_points == f.s.n_clean + a->count);
  drop(&f);
}

AQR_TEST(a_smooth_surface_far_from_flat_has_no_feature)
{
  found f = find(noisy_sphere(12, 0), 10);
  CHECK(f.features == 0);
  drop(&f);
}

/* ---- borders ---- */

AQR_TEST(the_border_of_an_open_strip_has_four_corners_even_one_edge_apart)
{
  for (unsigned n = 1; n <= 16; n *= 4)
  {
    found f = find(sheet(20, n, n == 1 ? 20 : 2, flat), 10);
    CHECK(f.features == 0 && f.borders == 4 && f.closed == 0 && f.corners == 4);
    CHECK(f.report.boundary_loops == 1);
    drop(&f);
  }
}

AQR_TEST(an_open_box_has_nodes_where_creases_reach_its_border)
{
  found f = find(cube(1), 0.05);
  CHECK(f.features == 8 && f.borders == 4 && f.corners == 8);
  drop(&f);
}

AQR_TEST(the_border_of_a_tube_is_two_smooth_loops)
{
  shape* a = cylinder(24);
  size_t kept = 0;
  for (size_t i = 0; i < a->n_triangles; i++)
    if (a->triangles[3 * i] > 1)
      memmove(a->triangles + 3 * kept++, a->triangles + 3 * i, 3 * sizeof *a->triangles);
  a->n_triangles = kept;
  found f = find(a, 10);
  CHECK(f.features == 0 && f.borders == 2 && f.closed == 2 && f.corners == 0);
  drop(&f);
}

AQR_TEST(a_ragged_border_has_corners_where_it_turns_not_at_every_tooth)
{
  /* a sheet of right triangles whose border is stepped: every other quad of the first column cut away */
  shape* a = sheet(30, 30, 1, flat);
  size_t kept = 0;
  for (size_t i = 0; i < a->n_triangles; i++)
  {
    size_t q = i / 2, u = q / 30, v = q % 30;
    bool tooth = u == 0 && v % 2 == 1;
    if (!tooth)
      memmove(a->triangles + 3 * kept++, a->triangles + 3 * i, 3 * sizeof *a->triangles);
  }
  a->n_triangles = kept;
  found f = find(a, 10);
  CHECK(f.features == 0 && f.corners >= 4 && f.corners <= 6);
  drop(&f);
}

/* ---- hooks ---- */

static void* fail_in_time(void* user, void* old, size_t old_bytes, size_t bytes)
{
  int* left = user;
  (void)old_bytes;
  if (bytes == 0)
  {
    free(old);
    return NULL;
  }
  return (*left)-- > 0 ? realloc(old, bytes) : NULL;
}

AQR_TEST(running_out_of_memory_anywhere_is_told_and_leaks_nothing)
{
  shape* a = cube(1);
  bool through = false;
  for (int allowed = 0; allowed < 200 && !through; allowed++)
  {
    int left = allowed;
    found f = { .c.hooks = { .user = &left, .reallocate = fail_in_time } };
    f.status = run(&f, a, 0.1);
    CHECK(f.status == AQR_OK || f.status == AQR_OUT_OF_MEMORY);
    through = f.status == AQR_OK;
    drop(&f);
  }
  CHECK(through);
  free(a);
}

static void backwards(
  void* user, size_t count, size_t grain, void (*body)(void* data, size_t begin, size_t end), void* data)
{
  (void)user;
  (void)grain;
  for (size_t end = count; end > 0; end -= end < 97 ? end : 97)
    body(data, end < 97 ? 0 : end - 97, end);
}

AQR_TEST(creases_do_not_depend_on_who_does_the_work)
{
  shape* a = sheet(60, 60, 1, dart);
  found f[2] = { { .report = { 0 } }, { .c.hooks = { .parallel_for = backwards } } };
  for (unsigned i = 0; i < 2; i++)
    CHECK(run(&f[i], a, 10) == AQR_OK);
  CHECK(f[0].report.feature_edges > 0);
  CHECK(memcmp(f[0].crease, f[1].crease, 3 * f[0].s.n_faces) == 0);
  CHECK(f[0].chains.n_half_edges == f[1].chains.n_half_edges);
  CHECK(memcmp(f[0].chains.half_edges, f[1].chains.half_edges, f[0].chains.n_half_edges * sizeof(aqr_index)) == 0);
  drop(&f[0]);
  drop(&f[1]);
  free(a);
}

AQR_TEST_MAIN
