/* SPDX-License-Identifier: BSD-3-Clause */
/* Memory that runs out at any allocation, and a cancel at any step of progress. */
#include "test.h"

#include "judge.h"
#include "remesh.h"

typedef struct trial
{
  size_t held, allocations, fail_at; /* fail_at 0: never */
  size_t steps, cancel_at;
  double last;
} trial;

static void* ration_bytes(void* user, void* old, size_t old_bytes, size_t bytes)
{
  trial* t = user;
  if (bytes == 0)
  {
    free(old);
    t->held -= old_bytes;
    return NULL;
  }
  if (++t->allocations == t->fail_at)
    return NULL;
  void* p = realloc(old, bytes);
  t->held = t->held - old_bytes + bytes;
  return p;
}

static int count_steps(void* user, double fraction, const char* stage)
{
  trial* t = user;
  CHECK(fraction >= t->last && fraction <= 1 && stage);
  t->last = fraction;
  return ++t->steps != t->cancel_at;
}

static const aqr_hooks* hooks_of(trial* t)
{
  static aqr_hooks hooks;
  hooks = (aqr_hooks){ t, ration_bytes, count_steps, NULL };
  return &hooks;
}

/* A box without a lid beside a strip too small for lines: creases, borders, corners, and a component that is decimated.
 */
static shape small_scene(void)
{
  shape m = shape_ellipsoid(2, 0, 1, v3(1, 0.1, 0.07));
  m.points = realloc(m.points, (3 * m.n_points + 9) * sizeof *m.points);
  const double far[9] = { 1.1, 0, 0, 1.11, 0, 0, 1.1, 0.01, 0 };
  memcpy(m.points + 3 * m.n_points, far, sizeof far);
  for (int i = 0; i < 3; i++)
    m.triangles[i] = (int64_t)m.n_points + i;
  m.n_points += 3;
  return m;
}

enum
{
  unaffordable = 20, /* points for the creases of the scene: some are given up */
  third_time = 60    /* points that are met at the third attempt: enough to see the others dropped */
};

static aqr_options small_options(int64_t points, int symmetry)
{
  aqr_options o = aqr_default_options();
  if (points)
  {
    o.density = AQR_DENSITY_POINTS;
    o.target_points = points;
  }
  o.tolerance = 0.02;
  o.largest_spacing = 0.3;
  o.smoothing_iterations = 1;
  o.feature_angle = 25;
  o.symmetry = symmetry;
  return o;
}

static bool has_result(const aqr_remesher* r)
{
  return aqr_remesher_mesh(r) || aqr_remesher_field(r) || aqr_remesher_lines(r);
}

static bool is_valid(const aqr_remesher* r)
{
  const aqr_mesh* m = aqr_remesher_mesh(r);
  return m && !judge_mesh(m->number_of_points, m->points, m->number_of_faces, m->offsets, m->connectivity).fault;
}

static aqr_status input_and_run(aqr_remesher* r, const aqr_input* input, const aqr_options* o)
{
  aqr_status status = aqr_remesher_set_input(r, input);
  return status == AQR_OK ? aqr_remesher_run(r, o) : status;
}

/* What was cached before a fault serves; without an input one must be set again. */
static void check_next_run(aqr_remesher* r, trial* t, const aqr_input* input, const aqr_options* o)
{
  t->last = 0;
  aqr_status status = aqr_remesher_run(r, o);
  t->last = 0;
  if (status == AQR_NO_INPUT)
    status = input_and_run(r, input, o);
  CHECK(status == AQR_OK && is_valid(r));
}

/* Steps of n that visit the first 400 one by one and some two thousand in all. */
static size_t after(size_t n)
{
  return n < 400 ? n + 1 : n + 1 + (n - 400) / 1000 + n % 5;
}

static void fail_everywhere(const aqr_options* o)
{
  shape m = small_scene();
  aqr_input input = shape_input(&m);
  size_t visited = 0;
  for (size_t n = 1;; n = after(n))
  {
    trial t = { .fail_at = n };
    aqr_remesher* r = NULL;
    aqr_status status = aqr_remesher_new(hooks_of(&t), &r);
    if (status == AQR_OK)
      status = input_and_run(r, &input, o);
    bool failed = t.allocations >= n;
    CHECK(status == (failed ? AQR_OUT_OF_MEMORY : AQR_OK));
    CHECK(!r || !failed || !has_result(r));
    if (r && failed)
    {
      check_next_run(r, &t, &input, o);
    }
    aqr_remesher_free(r);
    CHECK(t.held == 0);
    ++visited;
    if (!failed || aqr_failures)
    {
      printf("%zu allocations, %zu of them failed in turn\n", t.allocations, visited - 1);
      break;
    }
  }
  shape_free(&m);
}

AQR_TEST(memory_that_runs_out_is_an_error_and_the_next_run_works)
{
  aqr_options o = small_options(0, 0);
  fail_everywhere(&o);
}

AQR_TEST(memory_that_runs_out_while_a_target_is_met_is_an_error)
{
  aqr_options o = small_options(third_time, 0);
  fail_everywhere(&o);
}

AQR_TEST(memory_that_runs_out_while_creases_are_given_up_is_an_error)
{
  aqr_options o = small_options(unaffordable, 0);
  shape m = small_scene();
  aqr_remesher* r = remesh(&m, &o);
  CHECK(aqr_remesher_report(r)->given_up_edges > 0);
  aqr_remesher_free(r);
  shape_free(&m);
  fail_everywhere(&o);
}

AQR_TEST(memory_that_runs_out_while_a_half_is_mirrored_is_an_error)
{
  aqr_options o = small_options(third_time, 1);
  fail_everywhere(&o);
}

AQR_TEST(a_cancel_at_any_step_stops_and_the_next_run_works)
{
  shape m = small_scene();
  aqr_input input = shape_input(&m);
  for (int i = 0; i < 2; i++)
  {
    aqr_options o = small_options(i ? third_time : 0, 0);
    for (size_t n = 1;; n++)
    {
      trial t = { .cancel_at = n };
      aqr_remesher* r = NULL;
      CHECK(aqr_remesher_new(hooks_of(&t), &r) == AQR_OK);
      aqr_status status = input_and_run(r, &input, &o);
      size_t steps = t.steps;
      bool last = status == AQR_OK && steps == n; /* the step that says that all is done asks no more */
      CHECK(steps <= n && (steps == n ? status == AQR_CANCELLED || last : status == AQR_OK));
      CHECK(status == AQR_OK || !has_result(r));
      if (status == AQR_CANCELLED)
      {
        check_next_run(r, &t, &input, &o);
      }
      aqr_remesher_free(r);
      CHECK(t.held == 0);
      if (steps < n || aqr_failures)
      {
        printf("%zu steps, cancelled at each\n", steps);
        break;
      }
    }
  }
  shape_free(&m);
}

AQR_TEST_MAIN
