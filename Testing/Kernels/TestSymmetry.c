/* SPDX-License-Identifier: BSD-3-Clause */
/* Symmetric output about a plane: the same on both sides to the last digits, valid, and of the input's topology. */
#include "test.h"

#include "remesh.h"
#include "solids.h"
#include "threads.h"

/* The first of the mesh's points at p, which others may share; the number of points where none is there. */
static size_t point_at(const aqr_mesh* m, vec3 p, double near)
{
  size_t i = 0;
  while (i < m->number_of_points && !(v3_norm(v3_sub(v3_load(m->points + 3 * i), p)) < near))
    i++;
  return i;
}

static int64_t name_of(const aqr_mesh* m, size_t f, const int64_t* to)
{
  int64_t corner[256], *at = corner;
  for (int64_t k = m->offsets[f]; k < m->offsets[f + 1] && k < m->offsets[f] + 256; k++)
    *at++ = to[m->connectivity[k]];
  return survey_name(corner, (size_t)(at - corner));
}

/* Whether every point and every face has its mirror image in the mesh. */
static bool is_symmetric(const aqr_mesh* m, const aqr_options* o)
{
  size_t n = m->number_of_points, n_faces = m->number_of_faces;
  vec3 at = v3_load(o->symmetry_origin), up = v3_unit(v3_load(o->symmetry_normal));
  int64_t *self = malloc((n + 1) * sizeof *self), *image = malloc((n + 1) * sizeof *image);
  int64_t *names = malloc((n_faces + 1) * sizeof *names), *images = malloc((n_faces + 1) * sizeof *images);
  double reach = 0;
  bool good = true;
  for (size_t i = 0; i < n; i++)
    reach = fmax(reach, v3_norm(v3_sub(v3_load(m->points + 3 * i), at)));
  for (size_t i = 0; i < n && good; i++)
  {
    vec3 p = v3_load(m->points + 3 * i), q = v3_madd(p, -2 * v3_dot(v3_sub(p, at), up), up);
    self[i] = (int64_t)point_at(m, p, 1e-12 * reach);
    image[i] = (int64_t)point_at(m, q, 1e-12 * reach);
    good = image[i] < (int64_t)n;
  }
  for (size_t f = 0; f < n_faces && good; f++)
  {
    names[f] = name_of(m, f, self);
    images[f] = name_of(m, f, image);
  }
  if (good)
  {
    qsort(names, n_faces, sizeof *names, survey_by_index);
    qsort(images, n_faces, sizeof *images, survey_by_index);
    good = memcmp(names, images, n_faces * sizeof *names) == 0;
  }
  free(self);
  free(image);
  free(names);
  free(images);
  return good;
}

static void set_plane(aqr_options* o, vec3 at, vec3 up)
{
  o->symmetry = 1;
  v3_store(o->symmetry_origin, at);
  v3_store(o->symmetry_normal, up);
}

static void check_symmetry(const char* name, shape m, vec3 at, vec3 up, bool whole)
{
  for (int quads = 0; quads < 2; quads++)
  {
    aqr_options o = options_for_points(500);
    set_plane(&o, at, up);
    o.pure_quads = quads;
    survey before = survey_shape(&m);
    aqr_remesher* r = remesh(&m, &o);
    const aqr_mesh* out = aqr_remesher_mesh(r);
    survey after = survey_mesh(out);
    bool same = out && is_symmetric(out, &o);
    printf("%s: %s, %s, %zu points, Euler %ld (%ld), %zu loops (%zu), %zu asymmetric points\n", name,
      after.flaw ? after.flaw : "valid", same ? "symmetric" : "NOT SYMMETRIC", after.points, after.euler, before.euler,
      after.loops, before.loops, aqr_remesher_report(r)->asymmetric_points);
    CHECK(!after.flaw && same);
    CHECK(
      !whole || (after.euler == before.euler && after.loops == before.loops && after.components == before.components));
    CHECK(aqr_remesher_report(r)->target_missed || fabs((double)after.points / 500 - 1) < 0.05);
    CHECK(!quads || after.quads == after.faces);
    aqr_remesher_free(r);
  }
  shape_free(&m);
}

AQR_TEST(output_is_symmetric_to_the_last_digits_with_the_topology_of_the_input)
{
  const vec3 o = { 0, 0, 0 }, x = { 1, 0, 0 }, z = { 0, 0, -2 };
  check_symmetry("torus cut into two rings", shape_torus(12, 1), o, z, true);
  check_symmetry("torus cut into two arcs", shape_torus(12, 1), o, x, true);
  check_symmetry("torus by an oblique plane", shape_torus(12, 1), o, v3(0.6, 0.8, 0), true);
  check_symmetry("sphere by an oblique plane", shape_sphere(12, 2), o, v3(1, -2, 3), true);
  check_symmetry("cube", shape_cube(9, 0.1, 3), o, x, true);
  check_symmetry("cube by its diagonal, where creases are", shape_cube(10, 0.1, 3), o, v3(1, 1, 0), true);
  check_symmetry("can", shape_can(12, 4), o, v3(0, 1, 0), true);
  check_symmetry("pipe along its length", shape_cylinder(20, 5), o, x, true);
  check_symmetry("pipe across", shape_cylinder(20, 5), v3(0, 0, 0.5), v3(0, 0, 1), true);
  check_symmetry("sheet", shape_grid(30, 30, false, false, 0.3, 6, place_on_plane), v3(0.5, 0, 0), x, true);
  check_symmetry("saddle", shape_grid(30, 30, false, false, 0.3, 6, place_on_saddle), o, v3(0, 1, 0), true);
  check_symmetry("plate with two holes", shape_plate(2, 5, 6, 7), v3(12.5, 7.5, 2.5), x, true);
}

/* The point that the two sides had in common was not manifold. */
AQR_TEST(sides_that_touch_the_plane_in_one_point_stay_apart)
{
  const double points[] = { 0, 0, 0, 1, 0.5, 0, 1, -0.5, 0 };
  const int64_t triangle[] = { 0, 2, 1 };
  aqr_input input = { .number_of_points = 3, .points_d = points, .number_of_triangles = 1, .triangles = triangle };
  aqr_options o = aqr_default_options();
  aqr_remesher* r = NULL;
  o.symmetry = 1;
  CHECK(aqr_remesher_new(NULL, &r) == AQR_OK && aqr_remesher_set_input(r, &input) == AQR_OK);
  CHECK(aqr_remesher_run(r, &o) == AQR_OK);
  survey found = survey_mesh(aqr_remesher_mesh(r));
  printf("%s, %zu loops, Euler %ld\n", found.flaw ? found.flaw : "valid", found.loops, found.euler);
  CHECK(!found.flaw && found.loops == 2 && found.euler == 2);
  aqr_remesher_free(r);
}

/* An open half is closed by its image, and a plane off the middle makes of the surface what the positive side says. */
AQR_TEST(the_positive_side_decides_where_the_input_is_not_symmetric)
{
  const vec3 x = { 1, 0, 0 };
  check_symmetry("half a pipe made whole", shape_cylinder(20, 5), v3(0, 0, 0), v3(0, 0, 1), false);
  check_symmetry("torus off the middle", shape_torus(12, 1), v3(0.3, 0, 0), x, false);
  check_symmetry("a cap of a sphere", shape_sphere(12, 2), v3(0.8, 0, 0), x, false);
  check_symmetry("a plane through a hole of a plate", shape_plate(2, 5, 6, 7), v3(8, 8, 2), v3(0.3, 1, 0.1), false);
  shape m = shape_sphere(8, 3);
  aqr_options o = options_for_points(200);
  set_plane(&o, v3(5, 0, 0), x);
  aqr_input input = shape_input(&m);
  aqr_remesher* r = NULL;
  CHECK(aqr_remesher_new(NULL, &r) == AQR_OK && aqr_remesher_set_input(r, &input) == AQR_OK);
  CHECK(aqr_remesher_run(r, &o) == AQR_BAD_OPTION && strstr(aqr_remesher_message(r), "positive side"));
  set_plane(&o, v3(0, 0, 0), v3(0, 0, 0));
  CHECK(aqr_remesher_run(r, &o) == AQR_BAD_OPTION && strstr(aqr_remesher_message(r), "symmetry_normal"));
  o.symmetry = 0;
  CHECK(aqr_remesher_run(r, &o) == AQR_OK);
  uint64_t plain = hash_results(r);
  set_plane(&o, v3(0, 0, 0), x);
  CHECK(aqr_remesher_run(r, &o) == AQR_OK && hash_results(r) != plain);
  o.symmetry = 0;
  CHECK(aqr_remesher_run(r, &o) == AQR_OK && hash_results(r) == plain);
  aqr_remesher_free(r);
  shape_free(&m);
}

/* Squares of the normal overflowed or vanished; mirror images in a plane out of sight had no shape, or were infinite.
 */
AQR_TEST(planes_of_any_length_of_normal_serve_and_those_out_of_sight_are_refused)
{
  const vec3 normals[] = { { 3, -1, 2 }, { 0x3p900, -0x1p900, 0x2p900 }, { 0x3p-900, -0x1p-900, 0x2p-900 },
    { 0x3p-1074, -0x1p-1074, 0x2p-1074 } };
  const vec3 away[] = { { 1e7, 0, 0 }, { -1e7, 0, 0 }, { 0, 1e20, 0 }, { -1e300, 0, 0 }, { 0, 0, -1.7e308 } };
  shape m = shape_torus(6, 3);
  aqr_options o = options_for_points(200);
  set_plane(&o, v3(0.1, 0, 0), normals[0]);
  aqr_remesher* r = remesh(&m, &o);
  uint64_t once = hash_results(r);
  for (size_t i = 1; i < sizeof normals / sizeof *normals; i++)
  {
    set_plane(&o, v3(0.1, 0, 0), normals[i]);
    CHECK(aqr_remesher_run(r, &o) == AQR_OK && is_symmetric(aqr_remesher_mesh(r), &o));
    CHECK(once != 0 && hash_results(r) == once);
  }
  for (size_t i = 0; i < sizeof away / sizeof *away; i++)
  {
    set_plane(&o, away[i], v3(1, 0, 0));
    CHECK(aqr_remesher_run(r, &o) == AQR_BAD_OPTION && strstr(aqr_remesher_message(r), "diagonals"));
    CHECK(!aqr_remesher_mesh(r));
  }
  const double no_number[] = { NAN, INFINITY, -INFINITY };
  for (size_t i = 0; i < 18; i++)
  {
    set_plane(&o, v3(0.1, 0, 0), v3(1, 0, 0));
    *(i < 9 ? &o.symmetry_origin[i % 3] : &o.symmetry_normal[i % 3]) = no_number[i / 3 % 3];
    CHECK(aqr_remesher_run(r, &o) == AQR_BAD_OPTION && strstr(aqr_remesher_message(r), "finite"));
  }
  set_plane(&o, v3(-1e3, 0, 0), v3(1, 0, 0)); /* far, but in sight */
  CHECK(aqr_remesher_run(r, &o) == AQR_OK && !survey_mesh(aqr_remesher_mesh(r)).flaw);
  aqr_remesher_free(r);
  shape_free(&m);
}

AQR_TEST(points_without_a_mirror_image_are_counted)
{
  shape m = shape_grid(40, 16, true, true, 0, 1, place_on_torus);
  aqr_options o = options_for_points(300);
  set_plane(&o, v3(0, 0, 0), v3(0, 1, 0));
  aqr_remesher* r = remesh(&m, &o);
  CHECK(aqr_remesher_report(r)->asymmetric_points == 0);
  aqr_remesher_free(r);
  m.points[3 * 41] += 0.01;
  r = remesh(&m, &o);
  CHECK(aqr_remesher_report(r)->asymmetric_points == 2); /* it and its partner */
  o.tolerance *= 1.1;
  CHECK(aqr_remesher_run(r, &o) == AQR_OK && aqr_remesher_report(r)->asymmetric_points == 2); /* from the cache */
  aqr_remesher_free(r);
  shape_free(&m);
}

/* Planes at random through solids at random, also where little is left of them. */
AQR_TEST(no_plane_breaks_the_mesh)
{
  unsigned state = 5;
  for (unsigned i = 0; i < 120; i++)
  {
    shape m = i % 5 == 0   ? shape_torus(6, i)
              : i % 5 == 1 ? shape_cube(6, 0.2, i)
              : i % 5 == 2 ? shape_plate(1 + i % 3, 3, (int)i % 7, i)
              : i % 5 == 3 ? shape_grid(12, 12, false, false, 0.3, i, place_on_saddle)
                           : shape_can(7, i);
    double p[6];
    for (int k = 0; k < 6; k++)
      p[k] = 2 * shape_random(&state) - 1;
    aqr_options o = options_for_points(30 + (int64_t)(300 * shape_random(&state)));
    size_t inside = (size_t)(shape_random(&state) * (double)m.n_points);
    set_plane(&o, v3_load(m.points + 3 * inside), i % 3 ? v3_load(p) : v3(i % 2, 1 - i % 2, 0));
    o.pure_quads = i % 4 == 0;
    o.boundary_lines = i % 7 != 0;
    aqr_input input = shape_input(&m);
    aqr_remesher* r = NULL;
    CHECK(aqr_remesher_new(NULL, &r) == AQR_OK && aqr_remesher_set_input(r, &input) == AQR_OK);
    aqr_status status = aqr_remesher_run(r, &o);
    survey after = survey_mesh(aqr_remesher_mesh(r));
    bool empty = status == AQR_BAD_OPTION && strstr(aqr_remesher_message(r), "positive side");
    bool good = empty || (status == AQR_OK && !after.flaw && is_symmetric(aqr_remesher_mesh(r), &o));
    if (!good)
      printf("%u: %s, %s, %zu points\n", i, aqr_status_string(status), after.flaw ? after.flaw : "valid", after.points);
    CHECK(good);
    aqr_remesher_free(r);
    shape_free(&m);
  }
}

/* A mesh, and a triangle far from it that the diagonal goes by. */
static shape with_far_triangle(shape m)
{
  const double far[9] = { 6, 6, 6, 6.1, 6, 6, 6, 6.1, 6 };
  shape r = { .n_points = m.n_points + 3, .n_triangles = m.n_triangles + 1 };
  r.points = malloc(3 * r.n_points * sizeof *r.points);
  r.triangles = malloc(3 * r.n_triangles * sizeof *r.triangles);
  memcpy(r.points, m.points, 3 * m.n_points * sizeof *r.points);
  memcpy(r.points + 3 * m.n_points, far, sizeof far);
  memcpy(r.triangles, m.triangles, 3 * m.n_triangles * sizeof *r.triangles);
  for (size_t k = 0; k < 3; k++)
    r.triangles[3 * m.n_triangles + k] = (int64_t)(m.n_points + k);
  shape_free(&m);
  return r;
}

/* With so few points a half's border leaves the plane; a vertex left alone there once had a fan on either side, and the
 * two sides stayed open without a word. */
AQR_TEST(halves_with_almost_no_points_give_valid_meshes_and_say_what_they_lost)
{
  for (unsigned i = 0; i < 200; i++)
  {
    shape m = with_far_triangle(shape_sphere(3, i));
    aqr_options o = options_for_points(4);
    set_plane(&o, v3(0, 0, 0), v3(1, 0, 0));
    o.preserve_topology = i / 2 % 2;
    o.largest_spacing = 1;
    o.curvature_radius = 0;
    o.smoothing_iterations = 0;
    aqr_input input = shape_input(&m);
    aqr_remesher* r = NULL;
    CHECK(aqr_remesher_new(NULL, &r) == AQR_OK && aqr_remesher_set_input(r, &input) == AQR_OK);
    CHECK(aqr_remesher_run(r, &o) == AQR_OK);
    survey after = survey_mesh(aqr_remesher_mesh(r));
    bool kept = after.euler == 4 && after.loops == 2; /* a sphere and two triangles */
    if (after.flaw || !kept)
      printf("%u: %s, Euler number %ld\n", i, after.flaw ? after.flaw : "valid", after.euler);
    CHECK(!after.flaw);
    CHECK(kept || !o.preserve_topology || aqr_remesher_report(r)->topology_lost);
    aqr_remesher_free(r);
    shape_free(&m);
  }
}

AQR_TEST(a_run_reports_what_the_one_before_it_found)
{
  shape m = shape_can(14, 17);
  aqr_options o = options_for_points(400);
  set_plane(&o, v3(0, 0, 0.3), v3(0.1, 0.2, 1));
  aqr_remesher* r = remesh(&m, &o);
  CHECK(aqr_remesher_report(r)->feature_edges > 0 && aqr_remesher_report(r)->asymmetric_points > 0);
  o.symmetry = o.feature_lines = 0;
  CHECK(aqr_remesher_run(r, &o) == AQR_OK);
  CHECK(aqr_remesher_report(r)->feature_edges == 0 && aqr_remesher_report(r)->asymmetric_points == 0);
  aqr_remesher_free(r);
  shape_free(&m);
}

AQR_TEST(symmetric_output_is_the_same_on_any_number_of_threads)
{
  shape m = shape_can(14, 17);
  uint64_t once = 0;
  for (size_t i = 0; i < 3; i++)
  {
    size_t threads = (const size_t[]){ 1, 2, 8 }[i];
    aqr_hooks hooks = { .user = &threads, .parallel_for = on_threads };
    aqr_options o = options_for_points(400);
    set_plane(&o, v3(0, 0, 0), v3(1, 0.2, 0));
    aqr_remesher* r = remesh_with(&hooks, &m, &o);
    once = i ? once : hash_results(r);
    CHECK(once != 0 && hash_results(r) == once);
    aqr_remesher_free(r);
  }
  shape_free(&m);
}

AQR_TEST_MAIN
