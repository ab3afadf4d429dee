/* SPDX-License-Identifier: BSD-3-Clause */
/* Work on surfaces with defects, against that on clean ones of the same size: counted, since clocks differ. */
#include "test.h"

#include "mutate.h"

typedef struct counter
{
  double elements, bytes;
} counter;

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

/* Elements of all loops that may be threaded, steps and queries of lines, and memory in units of an element's. 0 where
 * nothing came out. */
static double work_on(const aqr_input* input, const aqr_options* o)
{
  const double element_bytes = 64;
  counter n = { 0, 0 };
  aqr_hooks hooks = { &n, count_bytes, NULL, count_elements };
  aqr_remesher* r = NULL;
  aqr_status status = aqr_remesher_new(&hooks, &r);
  if (status == AQR_OK)
    status = aqr_remesher_set_input(r, input);
  if (status == AQR_OK)
    status = aqr_remesher_run(r, o);
  CHECK(status == AQR_OK || status == AQR_DEGENERATE_INPUT);
  double work = n.elements + n.bytes / element_bytes;
  if (status == AQR_OK)
    work += (double)aqr_remesher_report(r)->proximity_queries + (double)aqr_remesher_report(r)->line_samples;
  aqr_remesher_free(r);
  return status == AQR_OK ? work : 0;
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
                      : shape_grid(2 * n, 2 * n, false, false, 0.2, 1, place_on_saddle);
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
    shape m = mutate_base(k / 2);
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

AQR_TEST_MAIN
