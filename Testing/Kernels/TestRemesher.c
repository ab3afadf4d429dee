/* SPDX-License-Identifier: BSD-3-Clause */
#include "test.h"

#include "remesh.h"
#include "solids.h"
#include "threads.h"

/* ---- shapes ---- */

static void check_quads(const char* name, shape m, double least_quads, int64_t points)
{
  aqr_options o = options_for_points(points);
  survey s = check_remesh(name, &m, &o);
  CHECK_BELOW(1 - (double)s.quads / (double)(s.faces + 1), 1 - least_quads);
  CHECK(!s.areas_lost); /* two vertices of creases around one face were brought together */
  shape_free(&m);
}

/* Without curvature or with the same in all directions there is nothing to follow, and all the same quads must come. */
AQR_TEST(flat_and_round_surfaces_become_quads_not_nothing)
{
  check_quads("plane", shape_grid(40, 40, false, false, 0.3, 3, place_on_plane), 0.8, 400);
  check_quads("strip", shape_grid(100, 20, false, false, 0.3, 4, place_on_strip), 0.8, 400);
  check_quads("sphere", shape_sphere(24, 5), 0.6, 500);
  check_quads("cube", shape_cube(16, 0, 6), 0.8, 500);
}

AQR_TEST(solids_keep_their_handles_holes_and_borders)
{
  check_quads("double torus", shape_plate(2, 6, 12, 7), 0.6, 700);
  check_quads("three holes with edges", shape_plate(3, 4, 0, 8), 0.5, 700);
  check_quads("can", shape_can(16, 9), 0.6, 500);
  check_quads("pipe", shape_cylinder(36, 10), 0.7, 400);
  check_quads("ellipsoid", shape_ellipsoid(22, 0.3, 11, v3(1, 0.6, 0.4)), 0.6, 500);
  check_quads("saddle", shape_grid(40, 40, false, false, 0.3, 12, place_on_saddle), 0.7, 400);
  check_quads("torus", shape_torus(16, 13), 0.7, 500);
}

/* A strip with a half twist cannot be oriented: it is cut open somewhere, and what is left has a mesh. */
AQR_TEST(a_moebius_strip_is_cut_and_meshed)
{
  shape m = shape_moebius(80, 14, 14);
  aqr_options o = options_for_points(300);
  aqr_remesher* r = remesh(&m, &o);
  survey s = survey_mesh(aqr_remesher_mesh(r));
  printf("%s, Euler %ld, %zu loops, %zu edges cut\n", s.flaw ? s.flaw : "valid", s.euler, s.loops,
    aqr_remesher_report(r)->unorientable_edges);
  CHECK(!s.flaw && s.components == 1);
  CHECK(aqr_remesher_report(r)->unorientable_edges > 0);
  CHECK(s.euler == 1 && s.loops == 1);
  aqr_remesher_free(r);
  shape_free(&m);
}

/* Two spheres, one of them far too small for a line, and a free triangle. */
AQR_TEST(every_component_is_meshed_however_small)
{
  shape a = shape_sphere(14, 15), b = shape_sphere(3, 16), m = { 0 };
  m.points = malloc(3 * (a.n_points + b.n_points + 3) * sizeof *m.points);
  m.triangles = malloc(3 * (a.n_triangles + b.n_triangles + 1) * sizeof *m.triangles);
  const shape* part[2] = { &a, &b };
  for (int k = 0; k < 2; k++)
  {
    for (size_t i = 0; i < 3 * part[k]->n_triangles; i++)
      m.triangles[3 * m.n_triangles + i] = part[k]->triangles[i] + (int64_t)m.n_points;
    m.n_triangles += part[k]->n_triangles;
    for (size_t i = 0; i < part[k]->n_points; i++)
      v3_store(m.points + 3 * m.n_points++, v3_madd(v3(3 * k, 0, 0), k ? 1e-4 : 1, v3_load(part[k]->points + 3 * i)));
  }
  for (size_t i = 0; i < 3; i++)
  {
    m.triangles[3 * m.n_triangles + i] = (int64_t)m.n_points;
    v3_store(m.points + 3 * m.n_points++, v3(0, 2 + 0.1 * (double)i, i == 1 ? 0.1 : 0));
  }
  m.n_triangles++;
  aqr_options o = options_for_points(300);
  check_remesh("two spheres and a triangle", &m, &o);
  shape_free(&a);
  shape_free(&b);
  shape_free(&m);
}

/* ---- random inputs and parameters ---- */

static double between(unsigned* state, double low, double high)
{
  return low + (high - low) * shape_random(state);
}

static shape random_shape(unsigned* state, const char** name)
{
  unsigned seed = (unsigned)(1e6 * shape_random(state));
  size_t n = (size_t)between(state, 5, 15);
  double jitter = between(state, 0, 0.45);
  shape m;
  switch ((int)between(state, 0, 9))
  {
    case 0:
      *name = "sheet";
      return shape_grid(2 * n, n, false, false, jitter, seed, place_on_plane);
    case 1:
      *name = "torus";
      return shape_grid(3 * n, n, true, true, jitter, seed, place_on_torus);
    case 2:
      *name = "pipe";
      return shape_grid(n, 2 * n, true, false, jitter, seed, place_on_cylinder);
    case 3:
      *name = "catenoid";
      return shape_grid(2 * n, n, true, false, jitter, seed, place_on_catenoid);
    case 4:
      *name = "saddle";
      return shape_grid(n, n, false, false, jitter, seed, place_on_saddle);
    case 5:
      *name = "cube";
      return shape_cube(n, jitter, seed);
    case 6:
      *name = "can";
      return shape_can(n, seed);
    case 7:
      *name = "plate";
      return shape_plate(1 + seed % 3, 2 + n / 5, (int)between(state, 0, 8), seed);
    default:
      *name = "rough ellipsoid";
      m = shape_ellipsoid(n, jitter, seed, v3(1, between(state, 0.2, 1), between(state, 0.1, 1)));
      for (size_t i = 0; i < 3 * m.n_points; i++)
        m.points[i] += between(state, -0.2, 0.2) / (double)n * jitter;
      return m;
  }
}

static aqr_options random_options(unsigned* state)
{
  aqr_options o = options_for_points((int64_t)between(state, 20, 500));
  o.density = shape_random(state) < 0.5 ? AQR_DENSITY_POINTS : AQR_DENSITY_TOLERANCE;
  o.tolerance = pow(10, between(state, -4, -1));
  o.curvature_radius = between(state, 0, 0.1);
  o.smoothing_iterations = (int)between(state, 0, 20);
  o.confidence_angle = between(state, 0, 90);
  o.feature_lines = shape_random(state) < 0.7;
  o.feature_angle = between(state, 10, 100);
  o.boundary_lines = shape_random(state) < 0.5;
  o.anisotropy = between(state, 0, 1);
  o.adaptivity = between(state, 0, 1);
  o.pure_quads = shape_random(state) < 0.3;
  o.largest_spacing = pow(10, between(state, -1.5, 0));
  o.largest_valence = (int)between(state, 4, 12);
  o.convex_partition = shape_random(state) < 0.5;
  o.seed = (uint32_t)(1e6 * shape_random(state));
  return o;
}

/* A path along edges: from a random corner on over the triangles after it. */
static size_t random_path(unsigned* state, const shape* m, int64_t* pairs, size_t most)
{
  size_t n = 0, t = (size_t)between(state, 0, (double)m->n_triangles);
  for (; n < most && t < m->n_triangles; n++, t++)
  {
    size_t k = (size_t)between(state, 0, 3);
    pairs[2 * n] = m->triangles[3 * t + k];
    pairs[2 * n + 1] = m->triangles[3 * t + (k + 1) % 3];
  }
  return n;
}

/* The second shape beside the first. */
static shape both(shape a, shape b)
{
  a.points = realloc(a.points, 3 * (a.n_points + b.n_points) * sizeof *a.points);
  a.triangles = realloc(a.triangles, 3 * (a.n_triangles + b.n_triangles) * sizeof *a.triangles);
  for (size_t i = 0; i < b.n_points; i++)
    v3_store(a.points + 3 * (a.n_points + i), v3_add(v3_load(b.points + 3 * i), v3(20, 0, 0)));
  for (size_t i = 0; i < 3 * b.n_triangles; i++)
    a.triangles[3 * a.n_triangles + i] = b.triangles[i] + (int64_t)a.n_points;
  a.n_points += b.n_points;
  a.n_triangles += b.n_triangles;
  shape_free(&b);
  return a;
}

/* Surfaces number `first` and on: sheets, pipes, tori, solids with creases and handles, one component or two, every
 * option at random, some with locked edges. */
static void check_random(unsigned first, unsigned count)
{
  size_t met[3] = { 0, 0, 0 }, flat = 0;
  for (unsigned i = first; i < first + count; i++)
  {
    enum
    {
      most_locked = 30
    };
    unsigned state = 7919 * i + 1;
    const char* name;
    shape m = random_shape(&state, &name);
    if (shape_random(&state) < 0.15)
      m = both(m, random_shape(&state, &name));
    aqr_options o = random_options(&state);
    int64_t pairs[2 * most_locked];
    aqr_input input = shape_input(&m);
    input.locked = pairs;
    if (shape_random(&state) < 0.3)
      input.number_of_locked = random_path(&state, &m, pairs, most_locked);
    survey before = survey_shape(&m);
    aqr_remesher* r = NULL;
    aqr_status status = aqr_remesher_new(NULL, &r);
    if (status == AQR_OK)
      status = aqr_remesher_set_input(r, &input);
    if (status == AQR_OK)
      status = aqr_remesher_run(r, &o);
    survey after = survey_mesh(r ? aqr_remesher_mesh(r) : NULL);
    bool same = after.euler == before.euler && after.loops == before.loops && after.components == before.components;
    if (status != AQR_OK || after.flaw || !same)
      printf("seed %u: %s of %zu points and %zu locked edges: %s, %s, Euler %ld (%ld), %zu loops (%zu)\n", i, name,
        m.n_points, input.number_of_locked, aqr_status_string(status), after.flaw ? after.flaw : "valid", after.euler,
        before.euler, after.loops, before.loops);
    CHECK(status == AQR_OK && !after.flaw && same);
    CHECK(status != AQR_OK || aqr_remesher_report(r)->locked_missed == 0);
    CHECK(!o.pure_quads || after.quads == after.faces);
    flat += after.areas_lost > 0;
    met[0] += before.components > 1;
    met[1] += input.number_of_locked > 0;
    met[2] += before.euler < 2 * (long)before.components - (long)before.loops;
    aqr_remesher_free(r);
    shape_free(&m);
  }
  printf(
    "%u surfaces, %zu of several components, %zu with locked edges, %zu with handles; %zu have faces without area\n",
    count, met[0], met[1], met[2], flat);
  CHECK(flat <= count / 25); /* one in seven had: creases that ended inside a face were joined to themselves */
}

AQR_TEST(no_input_or_parameters_break_the_mesh_or_its_topology)
{
  check_random(0, 260);
}

AQR_TEST(no_other_input_or_parameters_break_the_mesh_or_its_topology)
{
  check_random(260, 260);
}

/* ---- the same bytes ---- */

AQR_TEST(any_number_of_threads_and_every_run_give_the_same_bytes)
{
  shape shapes[] = { shape_can(14, 17), shape_plate(2, 4, 8, 18), shape_torus(14, 19) };
  for (size_t k = 0; k < sizeof shapes / sizeof *shapes; k++)
  {
    aqr_options o = options_for_points(300);
    aqr_remesher* r = remesh(&shapes[k], &o);
    uint64_t once = hash_results(r);
    CHECK(once != 0);
    CHECK(aqr_remesher_run(r, &o) == AQR_OK && hash_results(r) == once);
    aqr_remesher_free(r);
    for (size_t i = 0; i < 5; i++)
    {
      size_t threads = (const size_t[]){ 1, 2, 3, 8, 16 }[i];
      aqr_hooks hooks = { .user = &threads, .parallel_for = on_threads };
      r = remesh_with(&hooks, &shapes[k], &o);
      CHECK(hash_results(r) == once);
      aqr_remesher_free(r);
    }
    shape_free(&shapes[k]);
  }
}

AQR_TEST_MAIN
