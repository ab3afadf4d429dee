/* SPDX-License-Identifier: BSD-3-Clause */
/* Edges that the caller locks stay edges, on surfaces where nothing else would keep them. */
#include "test.h"

#include "remesh.h"
#include "solids.h"
#include "threads.h"

typedef struct locked_run
{
  aqr_remesher* r;
  aqr_status status;
} locked_run;

static locked_run run_locked(
  const shape* m, const int64_t* locked, size_t n, const aqr_options* o, const aqr_hooks* hooks)
{
  locked_run x = { NULL, AQR_OK };
  aqr_input input = shape_input(m);
  input.locked = locked;
  input.number_of_locked = n;
  x.status = aqr_remesher_new(hooks, &x.r);
  if (x.status == AQR_OK)
    x.status = aqr_remesher_set_input(x.r, &input);
  if (x.status == AQR_OK)
    x.status = aqr_remesher_run(x.r, o);
  return x;
}

/* Pairs of points one after the other. */
static size_t chain(const int64_t* path, size_t n, int64_t* pairs)
{
  for (size_t i = 0; i + 1 < n; i++)
  {
    pairs[2 * i] = path[i];
    pairs[2 * i + 1] = path[i + 1];
  }
  return n - 1;
}

enum
{
  rings = 80,
  sides = 32,
  longest = 4 * rings
};

/* A closed path over the torus of `rings` by `sides` quads that goes up and down `waves` times on its way. */
static size_t wavy_loop(int waves, int64_t* path)
{
  size_t n = 0;
  int j = 5;
  for (int i = 0; i <= rings; i++)
  {
    int to = 5 + (int)lround(4 * sin(shape_turn * waves * i / rings));
    path[n++] = i % rings * sides + j;
    for (; j != to && i < rings; n++)
    {
      j += to > j ? 1 : -1;
      path[n] = i % rings * sides + j;
    }
  }
  return n;
}

static double to_segment(vec3 p, vec3 a, vec3 b)
{
  vec3 e = v3_sub(b, a);
  double t = v3_norm2(e) > 0 ? fmin(1, fmax(0, v3_dot(v3_sub(p, a), e) / v3_norm2(e))) : 0;
  return v3_norm(v3_sub(p, v3_madd(a, t, e)));
}

/* The largest distance of points of the path from edges of the mesh, and of the mesh's points on features from the
 * path. */
static double path_from_edges(const shape* m, const int64_t* path, size_t n, const aqr_mesh* out)
{
  double worst = 0;
  for (size_t i = 0; i < n; i++)
  {
    vec3 p = v3_load(m->points + 3 * path[i]);
    double nearest = INFINITY;
    for (size_t f = 0; f < out->number_of_faces; f++)
      for (int64_t k = out->offsets[f]; k < out->offsets[f + 1]; k++)
      {
        int64_t a = out->connectivity[k];
        int64_t b = out->connectivity[k + 1 < out->offsets[f + 1] ? k + 1 : out->offsets[f]];
        if (out->point_kind[a] >= 2 && out->point_kind[b] >= 2)
          nearest = fmin(nearest, to_segment(p, v3_load(out->points + 3 * a), v3_load(out->points + 3 * b)));
      }
    worst = fmax(worst, nearest);
  }
  return worst;
}

static double features_from_path(const shape* m, const int64_t* path, size_t n, const aqr_mesh* out, size_t* count)
{
  double worst = 0;
  *count = 0;
  for (size_t v = 0; v < out->number_of_points; v++)
  {
    double nearest = INFINITY;
    if (out->point_kind[v] < 2)
      continue;
    for (size_t i = 0; i + 1 < n; i++)
      nearest = fmin(nearest, to_segment(v3_load(out->points + 3 * v), v3_load(m->points + 3 * path[i]),
                                v3_load(m->points + 3 * path[i + 1])));
    worst = fmax(worst, nearest);
    ++*count;
  }
  return worst;
}

AQR_TEST(a_locked_loop_on_a_smooth_torus_comes_out_as_a_chain_of_edges)
{
  shape m = shape_grid(rings, sides, true, true, 0.2, 1, place_on_torus);
  for (int waves = 0; waves < 4; waves += 3)
    for (int quads = 0; quads < 2; quads++)
    {
      int64_t path[longest] = { 0 }, pairs[2 * longest];
      size_t n = wavy_loop(waves, path), count;
      aqr_options o = options_for_points(700);
      o.feature_lines = quads; /* no crease here, but none may take the locked edges away */
      o.pure_quads = quads;
      locked_run x = run_locked(&m, pairs, chain(path, n, pairs), &o, NULL);
      CHECK(x.status == AQR_OK);
      const aqr_report* report = aqr_remesher_report(x.r);
      CHECK(report->locked_edges >= n - 1 && report->locked_missed == 0 && report->feature_edges == 0);
      survey s = survey_mesh(aqr_remesher_mesh(x.r));
      CHECK(!s.flaw && s.euler == 0 && s.components == 1);
      CHECK_BELOW(features_from_path(&m, path, n, aqr_remesher_mesh(x.r), &count), 1e-9);
      CHECK(count >= 8);
      /* chords of the loop, whose edges go to and fro by more than this, depart as those of a crease do */
      double diagonal = sqrt(2 * 2.8 * 2.8 + 0.8 * 0.8);
      CHECK_BELOW(path_from_edges(&m, path, n, aqr_remesher_mesh(x.r)), 5 * report->tolerance * diagonal);
      printf("%zu points, %zu of them on the loop of %zu edges\n", s.points, count, n - 1);
      aqr_remesher_free(x.r);
    }
  aqr_options o = options_for_points(700);
  aqr_remesher* r = remesh(&m, &o);
  for (size_t v = 0; v < aqr_remesher_mesh(r)->number_of_points; v++)
    CHECK(aqr_remesher_mesh(r)->point_kind[v] == 0);
  aqr_remesher_free(r);
  shape_free(&m);
}

/* Line cells that another filter made come with points of their own. */
AQR_TEST(locked_edges_are_told_by_the_places_of_their_points)
{
  shape m = shape_grid(rings, sides, true, true, 0.2, 1, place_on_torus);
  int64_t path[longest] = { 0 }, pairs[2 * longest], others[2 * longest];
  size_t n = wavy_loop(2, path), pairs_count = chain(path, n, pairs), n_points = m.n_points;
  aqr_options o = options_for_points(500);
  locked_run x = run_locked(&m, pairs, pairs_count, &o, NULL);
  m.points = realloc(m.points, 3 * (n_points + n + 1) * sizeof *m.points);
  for (size_t i = 0; i < n; i++)
  {
    memcpy(m.points + 3 * (n_points + i), m.points + 3 * path[i], 3 * sizeof *m.points);
    path[i] = (int64_t)(n_points + i);
  }
  m.n_points += n;
  locked_run y = run_locked(&m, others, chain(path, n, others), &o, NULL);
  CHECK(x.status == AQR_OK && y.status == AQR_OK);
  CHECK(aqr_remesher_report(y.r)->locked_edges >= pairs_count && aqr_remesher_report(y.r)->locked_missed == 0);
  CHECK(hash_results(x.r) != 0 && hash_results(x.r) == hash_results(y.r));
  aqr_remesher_free(x.r);
  aqr_remesher_free(y.r);
  shape_free(&m);
}

AQR_TEST(pairs_that_are_no_edge_are_counted_and_do_no_harm)
{
  shape m = shape_sphere(8, 3);
  size_t n_points = m.n_points;
  m.points = realloc(m.points, 3 * (n_points + 2) * sizeof *m.points);
  v3_store(m.points + 3 * n_points, v3(5, 5, 5)); /* on no triangle */
  v3_store(m.points + 3 * (n_points + 1), v3(NAN, 0, 0));
  m.n_points += 2;
  int64_t a = m.triangles[0], b = m.triangles[1], far = m.triangles[3 * (m.n_triangles / 2)];
  int64_t pairs[] = { a, b, b, a, a, a, a, far, a, (int64_t)n_points, (int64_t)n_points + 1, b };
  aqr_options o = options_for_points(200);
  locked_run x = run_locked(&m, pairs, 6, &o, NULL);
  CHECK(x.status == AQR_OK);
  CHECK(aqr_remesher_report(x.r)->locked_edges > 0 && aqr_remesher_report(x.r)->locked_missed == 4);
  survey s = survey_mesh(aqr_remesher_mesh(x.r));
  CHECK(!s.flaw && s.euler == 2);
  aqr_remesher_free(x.r);
  pairs[5] = (int64_t)m.n_points;
  x = run_locked(&m, pairs, 6, &o, NULL);
  CHECK(x.status == AQR_INDEX_OUT_OF_RANGE);
  aqr_remesher_free(x.r);
  pairs[5] = -1;
  x = run_locked(&m, pairs, 6, &o, NULL);
  CHECK(x.status == AQR_INDEX_OUT_OF_RANGE);
  aqr_remesher_free(x.r);
  shape_free(&m);
}

/* Long edges are halved before anything else: a locked one must be found in all its pieces. */
AQR_TEST(a_locked_edge_that_was_halved_is_locked_in_all_its_pieces)
{
  double points[] = { 0, 0, 0, 2, 0, 0, 2, 1, 0, 0, 1, 0 };
  int64_t triangles[] = { 0, 1, 2, 0, 2, 3 }, pairs[] = { 2, 0, 0, 1 };
  shape m = { 4, 2, points, triangles };
  aqr_options o = options_for_points(200);
  locked_run x = run_locked(&m, pairs, 2, &o, NULL);
  CHECK(x.status == AQR_OK && aqr_remesher_report(x.r)->locked_missed == 0);
  CHECK(aqr_remesher_report(x.r)->locked_edges > 64);
  const aqr_mesh* out = aqr_remesher_mesh(x.r);
  int64_t path[] = { 0, 2 };
  CHECK_BELOW(path_from_edges(&m, path, 2, out), 1e-12);
  size_t on = 0;
  for (size_t v = 0; v < out->number_of_points; v++)
    on += fabs(out->points[3 * v] - 2 * out->points[3 * v + 1]) < 1e-9;
  printf("%zu points, %zu on the diagonal\n", out->number_of_points, on);
  CHECK(on > 4 && !survey_mesh(out).flaw);
  /* no edge may cross the diagonal */
  for (size_t f = 0; f < out->number_of_faces; f++)
  {
    double least = 0, most = 0;
    for (int64_t k = out->offsets[f]; k < out->offsets[f + 1]; k++)
    {
      const double* p = out->points + 3 * out->connectivity[k];
      least = fmin(least, p[0] - 2 * p[1]);
      most = fmax(most, p[0] - 2 * p[1]);
    }
    CHECK(fmin(-least, most) < 1e-9);
  }
  aqr_remesher_free(x.r);
}

AQR_TEST(locked_edges_give_the_same_bytes_on_any_number_of_threads)
{
  shape m = shape_grid(rings, sides, true, true, 0.2, 1, place_on_torus);
  int64_t path[longest] = { 0 }, pairs[2 * longest];
  size_t n = wavy_loop(2, path), edges = chain(path, n, pairs);
  aqr_options o = options_for_points(500);
  uint64_t once = 0;
  for (size_t i = 0; i < 4; i++)
  {
    size_t threads = (const size_t[]){ 1, 2, 3, 8 }[i];
    aqr_hooks hooks = { .user = &threads, .parallel_for = on_threads };
    locked_run x = run_locked(&m, pairs, edges, &o, &hooks);
    CHECK(x.status == AQR_OK);
    once = i ? once : hash_results(x.r);
    CHECK(once != 0 && hash_results(x.r) == once);
    aqr_remesher_free(x.r);
  }
  shape_free(&m);
}

AQR_TEST_MAIN
