/* SPDX-License-Identifier: BSD-3-Clause */
/* Work on surfaces with defects, against that on clean ones of the same size: counted, since clocks differ. */
#include "test.h"

#include "mutate.h"

static const double element_bytes = 64, most_work = 5e7;

typedef struct counter
{
  double elements, bytes;
} counter;

typedef struct cost
{
  double work;                /* 0 where nothing came out */
  double points, mesh_points; /* of the cleaned surface, of the result */
} cost;

static void* count_bytes(void* user, void* old, size_t old_bytes, size_t bytes)
{
  (void)old_bytes;
  ((counter*)user)->bytes += (double)bytes;
  if (bytes)
    return realloc(old, bytes);
  free(old);
  return NULL;
}

static void count_elements(
  void* user, size_t count, size_t grain, void (*body)(void* data, size_t begin, size_t end), void* data)
{
  (void)grain;
  ((counter*)user)->elements += (double)count;
  body(data, 0, count);
}

/* Ends what would not end by itself. */
static int allow(void* user, double fraction, const char* stage)
{
  (void)fraction, (void)stage;
  const counter* n = user;
  return n->elements + n->bytes / element_bytes < most_work;
}

/* Elements of all loops that may be threaded, faces crossed by lines and their queries, and memory in units of an
 * element's. */
static cost cost_of(const aqr_input* input, const aqr_options* o)
{
  counter n = { 0, 0 };
  aqr_hooks hooks = { &n, count_bytes, allow, count_elements };
  aqr_remesher* r = NULL;
  aqr_status status = aqr_remesher_new(&hooks, &r);
  if (status == AQR_OK)
    status = aqr_remesher_set_input(r, input);
  if (status == AQR_OK)
    status = aqr_remesher_run(r, o);
  CHECK(status == AQR_OK || status == AQR_DEGENERATE_INPUT);
  cost spent = { 0, 0, 0 };
  if (status == AQR_OK)
  {
    const aqr_report* report = aqr_remesher_report(r);
    spent.work =
      n.elements + n.bytes / element_bytes + (double)report->proximity_queries + (double)report->faces_crossed;
    spent.points = (double)aqr_remesher_field(r)->number_of_points;
    spent.mesh_points = (double)aqr_remesher_mesh(r)->number_of_points;
  }
  aqr_remesher_free(r);
  return spent;
}

static double work_on(const aqr_input* input, const aqr_options* o)
{
  return cost_of(input, o).work;
}

/* On the most costly of clean surfaces with at least as many triangles, and at least a few hundred. */
static double clean_work(size_t triangles, const aqr_options* o)
{
  double most = 0;
  for (int kind = 0; kind < 4; kind++)
  {
    shape m = { 0 };
    for (size_t n = 4; m.n_triangles < triangles; n++)
    {
      shape_free(&m);
      m = kind == 0   ? shape_torus(n, 1)
          : kind == 1 ? shape_ellipsoid(n, 0.2, 1, v3(1, 0.6, 0.4))
          : kind == 2 ? shape_cylinder(n, 1)
                      : shape_grid(2 * n, 2 * n, false, false, 0.2, 1, mutate_on_saddle);
    }
    aqr_input input = shape_input(&m);
    most = fmax(most, work_on(&input, o));
    shape_free(&m);
  }
  return most;
}

static uint8_t next_byte(unsigned* state)
{
  return (uint8_t)(256 * shape_random(state));
}

AQR_TEST(defects_never_cost_ten_times_the_work_on_a_clean_surface)
{
  enum
  {
    trials = 96,
    class_width = 256 /* triangles: clean surfaces of as many serve all that have fewer */
  };
  double clean[2][16] = { { 0 } }, worst = 0;
  for (unsigned k = 0; k < trials; k++)
  {
    aqr_options o = aqr_default_options();
    o.density = k % 2 ? AQR_DENSITY_POINTS : AQR_DENSITY_TOLERANCE;
    o.target_points = 200;
    o.tolerance = 0.003;
    uint8_t data[64];
    unsigned state = k + 1;
    size_t size = 8 + k % 8 * 8;
    for (size_t i = 0; i < size; i++)
      data[i] = next_byte(&state);
    bytes b = { data, size };
    shape m = mutate_surface(k / 2 % 8, k / 16);
    CHECK(mutate(&m, &b));
    size_t class = m.n_triangles / class_width;
    CHECK(class < 16);
    if (class < 16 && clean[k % 2][class] <= 0)
      clean[k % 2][class] = clean_work((class + 1) * class_width, &o);
    aqr_input input = shape_input(&m);
    double ratio = work_on(&input, &o) / clean[k % 2][class < 16 ? class : 0];
    if (ratio > worst)
      printf("%u: %zu triangles, %g of the work on a clean surface\n", k, m.n_triangles, ratio);
    worst = fmax(worst, ratio);
    shape_free(&m);
  }
  CHECK_BELOW(worst, 10);
}

/* One factor everywhere, the highest at one point among the lowest, or anything. */
static void fill_factors(double* factor, size_t n, int kind)
{
  unsigned state = 1;
  for (size_t i = 0; i < n; i++)
    factor[i] = kind == 0   ? 1e-300
                : kind == 1 ? 1e300
                : kind == 2 ? (i ? 1e-300 : 1e300)
                : kind == 3 ? (i ? 1e300 : 1e-300)
                            : pow(10, 600 * (shape_random(&state) - 0.5));
}

/* The spacing went down to a ten-thousandth of the diagonal: a hundred million points from a small surface. */
AQR_TEST(no_density_asks_for_more_than_the_input_can_carry)
{
  shape m = shape_grid(24, 3, false, false, 0.2, 1, mutate_on_saddle);
  for (size_t i = 0; i < m.n_points; i++)
    m.points[3 * i + 1] *= 0.1;
  aqr_input input = shape_input(&m);
  double* factor = malloc(m.n_points * sizeof *factor);
  for (int k = 0; k < 8; k++)
  {
    aqr_options o = aqr_default_options();
    o.tolerance = k == 5 ? 1e-7 : 0.005;
    o.largest_spacing = k == 6 ? 1e-4 : o.largest_spacing;
    o.target_points = INT32_MAX;
    o.density = k == 7 ? AQR_DENSITY_POINTS : AQR_DENSITY_TOLERANCE;
    o.density_scale = k < 5 ? factor : NULL;
    fill_factors(factor, m.n_points, k);
    cost c = cost_of(&input, &o);
    CHECK(c.work > 0);
    CHECK_BELOW(c.mesh_points / c.points, 80);
    CHECK_BELOW(c.work / c.points, 12000);
  }
  free(factor);
  shape_free(&m);
}

/* Where a number of points is asked for, factors that are all small or all large had it missed, after all attempts. */
AQR_TEST(a_number_of_points_costs_no_more_under_any_density)
{
  for (unsigned base = 2; base < 8; base += 4)
  {
    shape m = mutate_surface(base, 0);
    aqr_input input = shape_input(&m);
    double* factor = malloc(m.n_points * sizeof *factor);
    aqr_options o = aqr_default_options();
    o.density = AQR_DENSITY_POINTS;
    o.target_points = 100;
    double plain = work_on(&input, &o);
    o.density_scale = factor;
    for (int k = 0; k < 5; k++)
    {
      fill_factors(factor, m.n_points, k);
      cost c = cost_of(&input, &o);
      CHECK_BELOW(c.work / plain, 10);
      if (k < 2)
        CHECK_BELOW(fabs(c.mesh_points / 100 - 1), 0.051);
    }
    free(factor);
    shape_free(&m);
  }
}

/* No area foretells the points on the two borders of a ribbon: attempts at a target set tens of thousands of them. */
AQR_TEST(ribbons_without_area_cost_no_more_than_wide_ones)
{
  aqr_options o = aqr_default_options();
  o.density = AQR_DENSITY_POINTS;
  o.target_points = 100;
  double wide = 0;
  for (double width = 1; width > 1e-10; width *= 1e-3)
  {
    shape m = shape_grid(19, 10, true, false, 0, 1, place_on_cylinder);
    for (size_t i = 0; i < m.n_points; i++)
      m.points[3 * i + 2] *= width;
    aqr_input input = shape_input(&m);
    double work = work_on(&input, &o);
    wide = wide > 0 ? wide : work;
    CHECK_BELOW(work / wide, 5);
    shape_free(&m);
  }
}

/* Lines crossed thousands of faces of needles without getting anywhere, from each of thousands of seeds. */
AQR_TEST(a_point_far_away_costs_no_more_than_a_clean_strip)
{
  aqr_options o = aqr_default_options();
  o.density = AQR_DENSITY_POINTS;
  o.target_points = 100;
  o.feature_lines = 0;
  for (size_t n = 4; n <= 36; n *= 3)
  {
    double clean = 0;
    for (int far = 0; far < 3; far++)
    {
      shape m = shape_grid(29, n / 2, true, false, 0, 1, place_on_cylinder);
      for (int k = 0; k < 3 && far; k++)
        m.points[3 * (m.n_points / 2) + (size_t)k] += far == 1 ? 1e6 : 1e9;
      aqr_input input = shape_input(&m);
      double work = work_on(&input, &o);
      clean = far ? clean : work;
      CHECK_BELOW(work / clean, 10);
      shape_free(&m);
    }
  }
}

/* Where few points were expected there came a thousand times as many, in an attempt that nothing ended. */
AQR_TEST(a_target_on_squeezed_surfaces_costs_no_more_than_on_a_clean_one)
{
  aqr_options o = aqr_default_options();
  o.density = AQR_DENSITY_POINTS;
  o.target_points = 100;
  o.feature_lines = 0;
  double worst = 0;
  for (unsigned seed = 1; seed <= 8; seed++)
    for (int axis = 0; axis < 2; axis++)
    {
      shape m = shape_torus(8, seed);
      double clean = clean_work(m.n_triangles, &o);
      for (size_t i = 0; i < 3 * m.n_points; i++) /* facets, and steps between them */
        m.points[i] = round(10 * m.points[i]) / 10 * ((int)(i % 3) == axis ? 1e3 : 1);
      aqr_input input = shape_input(&m);
      worst = fmax(worst, work_on(&input, &o) / clean);
      shape_free(&m);
    }
  CHECK_BELOW(worst, 10);
}

/* Attempt followed attempt at a target that the locked edges alone exceed many times over. */
AQR_TEST(a_target_below_what_chains_give_is_soon_given_up)
{
  shape m = shape_grid(40, 40, true, false, 0, 1, place_on_cylinder);
  int64_t* locked = malloc(2 * m.n_triangles * sizeof *locked);
  size_t n = 0;
  for (size_t f = 0; f < m.n_triangles; f += 7)
    for (size_t i = 0; i < 2; i++)
      locked[n++] = m.triangles[3 * f + i];
  aqr_input input = shape_input(&m);
  input.number_of_locked = n / 2;
  input.locked = locked;
  aqr_options o = aqr_default_options();
  double once = work_on(&input, &o);
  o.density = AQR_DENSITY_POINTS;
  o.target_points = 4;
  CHECK_BELOW(work_on(&input, &o) / once, 3);
  free(locked);
  shape_free(&m);
}

/* Each triangle across the whole box was halved as if it were all of the surface. */
AQR_TEST(a_soup_of_large_triangles_costs_no_more_than_a_clean_surface)
{
  aqr_options o = aqr_default_options();
  o.density = AQR_DENSITY_POINTS;
  o.target_points = 100;
  o.feature_lines = 0;
  shape m = shape_torus(10, 1);
  double clean = clean_work(m.n_triangles, &o);
  unsigned state = 1;
  for (size_t i = 0; i < 3 * m.n_points; i++)
    m.points[i] = shape_random(&state);
  aqr_input input = shape_input(&m);
  CHECK_BELOW(work_on(&input, &o) / clean, 10);
  shape_free(&m);
}

AQR_TEST_MAIN
