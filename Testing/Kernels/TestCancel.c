/* SPDX-License-Identifier: BSD-3-Clause */
/* How often long loops ask whether to go on, counted, since clocks differ. */
#include "test.h"

#include "cells.h"
#include "coarsen.h"
#include "feature_graph.h"
#include "model.h"
#include "sampler.h"
#include "sort.h"

typedef struct asked
{
  size_t times, allowed;
} asked;

static int ask(void* user, double fraction, const char* stage)
{
  asked* a = user;
  (void)fraction, (void)stage;
  return a->times++ < a->allowed;
}

static aqr_context context_of(asked* a)
{
  return (aqr_context){ .hooks = { .user = a, .progress = ask }, .end = 1 };
}

AQR_TEST(small_steps_ask_once_in_many)
{
  asked a = { 0, 1 };
  aqr_context c = context_of(&a);
  size_t steps = 0;
  while (aqr_worked(&c, 2))
    steps++;
  CHECK(a.times == 2 && steps > 1000 && steps < 10000000);
  a = (asked){ 0, 1000 };
  for (size_t i = 0; i < steps; i++)
    CHECK(aqr_worked(&c, 50));
  CHECK(a.times > 40 && a.times < 60);
}

typedef struct item
{
  unsigned key, place;
} item;

static int by_key_and_place(const void* x, const void* y)
{
  const item *a = x, *b = y;
  return a->key != b->key ? (a->key > b->key) - (a->key < b->key) : (a->place > b->place) - (a->place < b->place);
}

static item* items_of(size_t n)
{
  item* list = malloc(n * sizeof *list);
  unsigned state = 1;
  for (size_t i = 0; i < n; i++)
    list[i] = (item){ next_random(&state) % 50000, (unsigned)i };
  return list;
}

AQR_TEST(what_is_sorted_with_pauses_is_in_the_same_order)
{
  const size_t sizes[6] = { 0, 1, 1000, 32768, 32769, 300000 };
  for (unsigned k = 0; k < 6; k++)
  {
    size_t n = sizes[k];
    item *list = items_of(n + 1), *wanted = items_of(n + 1);
    asked a = { 0, SIZE_MAX };
    aqr_context c = context_of(&a);
    CHECK(aqr_sort(&c, list, n, sizeof *list, by_key_and_place) == AQR_OK && c.bytes == 0);
    qsort(wanted, n, sizeof *wanted, by_key_and_place);
    CHECK(memcmp(list, wanted, (n + 1) * sizeof *list) == 0);
    CHECK(a.times >= n / 40000);
    for (size_t allowed = 0; allowed < a.times; allowed = 2 * allowed + 1)
    {
      asked fewer = { 0, allowed };
      c = context_of(&fewer);
      CHECK(aqr_sort(&c, list, n, sizeof *list, by_key_and_place) == AQR_CANCELLED && c.bytes == 0);
      CHECK(fewer.times == allowed + 1);
    }
    free(list);
    free(wanted);
  }
}

/* Coarsens a sheet of n by n quads to as many points as it has, which leaves it as it is. */
static aqr_status coarsen_sheet(size_t n, asked* a)
{
  aqr_context plain = { 0 }, c = context_of(a);
  aqr_surface s = { 0 };
  aqr_polygon_mesh m = { 0 };
  CHECK(surface_of_grid(&plain, n, n, false, on_sheet, &s));
  aqr_index* faces = malloc(s.n_faces * sizeof *faces);
  double* normals = calloc(3 * s.n_points, sizeof *normals);
  for (aqr_index f = 0; f < s.n_faces; f++)
    faces[f] = f;
  aqr_field field = { .normal = normals };
  aqr_status status = aqr_coarsen_component(&c, &s, &field, faces, s.n_faces, s.n_points, &m);
  aqr_polygon_mesh_free(&c, &m);
  CHECK(c.bytes == 0);
  free(faces);
  free(normals);
  free_surface(&s);
  return status;
}

AQR_TEST(coarsening_asks_all_along)
{
  asked few = { 0, SIZE_MAX }, many = few;
  CHECK(coarsen_sheet(100, &few) == AQR_OK && coarsen_sheet(300, &many) == AQR_OK);
  printf("asked %zu and %zu times\n", few.times, many.times);
  CHECK(many.times > 4 * few.times);
  for (size_t allowed = 0; allowed < many.times; allowed = 2 * allowed + 1)
  {
    asked a = { 0, allowed };
    CHECK(coarsen_sheet(300, &a) == AQR_CANCELLED && a.times == allowed + 1);
  }
}

static vec3 place_on_band(double u, double v)
{
  double turn = 2 * acos(-1) * u;
  return v3(cos(turn), sin(turn), 1e-3 * v);
}

AQR_TEST(long_borders_are_linked_and_sampled_with_questions_in_between)
{
  const size_t n = 60000;
  model e = model_sizing(shape_grid(n, 1, true, false, 0, 1, place_on_band), 0.01, 1, NULL, 0.05);
  aqr_chains chains = { 0 };
  asked linked = { 0, SIZE_MAX }, sampled = { 0, SIZE_MAX };
  e.c.hooks = (aqr_hooks){ .user = &linked, .progress = ask };
  CHECK(aqr_chains_build(&e.c, &e.s, 45, &chains) == AQR_OK);
  CHECK(chains.n_chains == 2 && chains.chains[0].count == n);
  aqr_lines lines = { 0 };
  aqr_sampling_options options = { .tolerance = 1e-3, .boundary_lines = true };
  aqr_sampler m = { &e.c, &e.s, &e.f, &e.z, &options, &lines, .goal = INFINITY };
  CHECK(aqr_lines_init(&e.c, &e.s, &lines) == AQR_OK);
  e.c.hooks.user = &sampled;
  CHECK(aqr_sample_chain(&m, &chains, &chains.chains[0]) == AQR_OK);
  printf("asked %zu and %zu times\n", linked.times, sampled.times);
  CHECK(linked.times >= n / 10000 && sampled.times >= n / 20000);
  sampled = (asked){ 0, 0 };
  CHECK(aqr_sample_chain(&m, &chains, &chains.chains[1]) == AQR_CANCELLED && lines.n_lines == 1);
  aqr_lines_free(&e.c, &lines);
  AQR_DROP(&e.c, m.parents, m.parent_capacity);
  aqr_chains_free(&e.c, &chains);
  e.c.hooks = (aqr_hooks){ 0 };
  model_free(&e);
}

AQR_TEST(a_mesh_whose_compaction_is_cancelled_is_as_before)
{
  aqr_context plain = { 0 };
  aqr_polygon_mesh m = { 0 };
  CHECK(grid_of_quads(&plain, 300, 300, false, on_sheet, &m));
  disturb(&plain, &m, 1, 2000);
  CHECK(aqr_pm_is_consistent(&m));
  size_t n = m.n_half_edges, allowed = 0;
  long long euler = aqr_pm_euler(&m);
  for (;; allowed++)
  {
    asked a = { 0, allowed };
    aqr_context c = context_of(&a);
    aqr_status status = aqr_pm_compact(&c, &m);
    CHECK(status == (a.times > allowed ? AQR_CANCELLED : AQR_OK));
    CHECK(aqr_pm_is_consistent(&m) && aqr_pm_euler(&m) == euler);
    if (status == AQR_OK)
      break;
    CHECK(m.n_half_edges == n && c.bytes == 0);
  }
  CHECK(allowed >= 3 && m.n_half_edges < n);
  aqr_polygon_mesh_free(&plain, &m);
}

AQR_TEST_MAIN
