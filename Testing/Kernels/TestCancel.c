/* SPDX-License-Identifier: BSD-3-Clause */
/* How often long loops ask whether to go on, counted, since clocks differ. */
#include "test.h"

#include "cells.h"
#include "coarsen.h"
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
  CHECK(a.times == 2 && steps > 1000 && steps < 1000000);
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
    CHECK(a.times >= n / 20000);
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

AQR_TEST(a_mesh_whose_compaction_is_cancelled_is_as_before)
{
  aqr_context plain = { 0 };
  aqr_polygon_mesh m = { 0 };
  CHECK(grid_of_quads(&plain, 300, 300, false, on_sheet, &m));
  disturb(&plain, &m, 1, 2000);
  CHECK(aqr_pm_is_consistent(&m));
  size_t n = m.n_half_edges, allowed = 0;
  long euler = aqr_pm_euler(&m);
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
  CHECK(allowed >= 5 && m.n_half_edges < n);
  aqr_polygon_mesh_free(&plain, &m);
}

AQR_TEST_MAIN
