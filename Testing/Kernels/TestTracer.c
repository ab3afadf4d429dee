/* SPDX-License-Identifier: BSD-3-Clause */
#include "test.h"

#include "model.h"
#include "solids.h"
#include "tracer.h"

static double cx_apart(aqr_complex a, aqr_complex b)
{
  return hypot(a.x - b.x, a.y - b.y);
}

/* ---- unfolding ---- */

AQR_TEST(a_face_unfolded_over_any_edge_keeps_its_lengths_and_place)
{
  model e = model_surface(shape_sphere(4, 1));
  aqr_tracer t;
  aqr_tracer_init(&t, &e.s, NULL);
  double worst = 0;
  for (aqr_index f = 0; f < e.s.n_faces; f++)
  {
    aqr_chart a, b;
    aqr_chart_lay(&t, f, &a);
    for (unsigned k = 0; k < 3; k++)
    {
      aqr_chart_unfold(&t, &a, k, &b);
      aqr_index twin = aqr_twin(&e.s, 3 * f + k);
      CHECK(b.face == aqr_face_of(twin));
      worst = fmax(worst, cx_apart(b.q[twin % 3], a.q[(k + 1) % 3]));
      worst = fmax(worst, cx_apart(b.q[(twin % 3 + 1) % 3], a.q[k]));
      for (unsigned i = 0; i < 3; i++)
      {
        vec3 p = aqr_point(&e.s, aqr_from(&e.s, 3 * b.face + i)), q = aqr_point(&e.s, aqr_to(&e.s, 3 * b.face + i));
        worst = fmax(worst, fabs(v3_norm(v3_sub(q, p)) - cx_apart(b.q[i], b.q[(i + 1) % 3])));
      }
      aqr_complex u = b.q[0], v = b.q[1], w = b.q[2];
      CHECK((v.x - u.x) * (w.y - u.y) - (v.y - u.y) * (w.x - u.x) > 0); /* not folded over onto the first face */
    }
  }
  CHECK_BELOW(worst, 1e-14);
  model_free(&e);
}

/* ---- the polar map ---- */

/* A vertex at `height` above (or, for every other neighbour, below) a ring of n points. */
static shape fan_of(size_t n, double height, double wave)
{
  shape m = { .n_points = n + 1, .n_triangles = n };
  m.points = malloc(3 * (n + 1) * sizeof *m.points);
  m.triangles = malloc(3 * n * sizeof *m.triangles);
  v3_store(m.points, v3(0, 0, height));
  for (size_t i = 0; i < n; i++)
  {
    double a = shape_turn * (double)i / (double)n;
    v3_store(m.points + 3 * (i + 1), v3(cos(a), sin(a), i % 2 ? wave : -wave));
    m.triangles[3 * i] = 0;
    m.triangles[3 * i + 1] = (int64_t)i + 1;
    m.triangles[3 * i + 2] = (int64_t)((i + 1) % n) + 1;
  }
  return m;
}

/* Every corner has the angle `corner`; from `angle` after an edge the way out lies n / 2 corners farther. */
static void check_exits(shape m, size_t n)
{
  model e = model_surface(m);
  aqr_index centre = model_point_near(&e, v3_load(m.points)), h = e.s.fan[centre];
  vec3 o = aqr_point(&e.s, centre);
  vec3 a = v3_unit(v3_sub(aqr_point(&e.s, aqr_to(&e.s, h)), o));
  vec3 b = v3_unit(v3_sub(aqr_point(&e.s, aqr_from(&e.s, aqr_prev(h))), o));
  double corner = acos(v3_dot(a, b)), worst = 0;
  for (size_t i = 0; i < n; i++, h = aqr_next_around(&e.s, h))
    for (int k = 1; k < 10; k++)
    {
      double angle = corner * k / 10, way = angle + corner * (double)n / 2, left;
      aqr_index exit, expected = h;
      CHECK(aqr_polar_exit(&e.s, h, angle, &exit, &left));
      for (way = fmod(way, corner * (double)n); way > corner; way -= corner)
        expected = aqr_next_around(&e.s, expected);
      if (fabs(way - corner) < 1e-9 || way < 1e-9) /* along an edge: a matter of rounding which face it is in */
        continue;
      CHECK(exit == expected);
      worst = fmax(worst, fabs(left - way));
    }
  CHECK_BELOW(worst, 1e-9);
  model_free(&e);
}

AQR_TEST(the_way_through_a_vertex_halves_its_angle_whatever_that_sums_to)
{
  check_exits(fan_of(6, 0, 0), 6);   /* flat */
  check_exits(fan_of(7, 0, 0), 7);   /* flat, opposite to an edge lies a face */
  check_exits(fan_of(5, 1, 0), 5);   /* a cone: less than a full turn */
  check_exits(fan_of(8, 0, 0.7), 8); /* a saddle: more */
}

AQR_TEST(there_is_no_way_through_a_border_vertex)
{
  model e = model_surface(fan_of(6, 0, 0));
  aqr_index rim = model_point_near(&e, v3(1, 0, 0)), exit;
  double angle;
  CHECK(!aqr_polar_exit(&e.s, e.s.fan[rim], 0.3, &exit, &angle));
  model_free(&e);
}

/* ---- straight lines ---- */

/* Every sample lies on its edge, inside it, and the chord after it inside the face it names. */
static void check_samples(const aqr_surface* s, const aqr_tracer* t)
{
  size_t off = 0, strayed = 0, at_ends = 0;
  for (size_t i = 0; i < t->n_samples; i++)
  {
    const aqr_sample* a = &t->samples[i];
    off += v3_norm(v3_sub(a->p, aqr_edge_point(s, a->edge, a->t))) > 1e-12;
    at_ends += !(a->t > 0 && a->t < 1);
    CHECK(aqr_edge_of(s, a->edge) == a->edge);
    if (i + 1 == t->n_samples)
      continue;
    aqr_index f = a->face, here = aqr_sample_half_edge(s, a, f), there = aqr_sample_half_edge(s, a + 1, f);
    strayed += here == AQR_NONE || there == AQR_NONE || aqr_face_of(here) != f || aqr_face_of(there) != f;
    CHECK(a->edge != a[1].edge);
  }
  CHECK(off == 0 && strayed == 0 && at_ends == 0);
}

static double off_straight(const model* e, const aqr_tracer* t, vec3 from, vec3 d)
{
  double worst = 0;
  for (size_t i = 0; i < t->n_samples; i++)
    worst = fmax(worst, v3_norm(v3_reject(v3_sub(model_shape_point(e, t->samples[i].p), from), d)));
  return worst;
}

AQR_TEST(geodesics_are_straight_on_a_plane_and_end_at_its_border)
{
  model e = model_surface(shape_grid(20, 20, false, false, 0.2, 2, place_on_plane));
  for (int k = 0; k < 24; k++)
  {
    double a = shape_turn * (k + 0.3) / 24;
    vec3 from = v3(0.43, 0.51, 0), d = v3(cos(a), sin(a), 0);
    aqr_tracer t;
    aqr_advance result;
    aqr_place at = model_place_at(&e, from);
    aqr_tracer_init(&t, &e.s, NULL);
    aqr_tracer_start(&t, &at, d);
    CHECK(aqr_tracer_straight(&e.c, &t, 0.1, &result) == AQR_OK && result == AQR_INSIDE);
    vec3 end = v3_madd(from, 0.1 * e.s.diagonal, d);
    CHECK(v3_norm(v3_sub(model_shape_point(&e, aqr_tracer_position(&t)), end)) < 1e-12);
    CHECK(aqr_tracer_straight(&e.c, &t, 5, &result) == AQR_OK && result == AQR_AT_BORDER);
    vec3 p = model_shape_point(&e, aqr_tracer_position(&t));
    CHECK(fmin(fmin(p.x, 1 - p.x), fmin(p.y, 1 - p.y)) < 1e-12);
    CHECK_BELOW(off_straight(&e, &t, from, d), 1e-6);
    check_samples(&e.s, &t);
    aqr_tracer_free(&e.c, &t);
  }
  model_free(&e);
}

/* Along rows, columns and diagonals of an even grid a line meets nothing but vertices. */
AQR_TEST(a_line_through_the_vertices_of_a_grid_goes_straight_on)
{
  model e = model_surface(shape_grid(16, 16, false, false, 0, 3, place_on_plane));
  const vec3 d[4] = { v3(1, 0, 0), v3(0, 1, 0), v3(1, 1, 0), v3(1, -1, 0) };
  for (int k = 0; k < 8; k++)
  {
    vec3 way = v3_scale(d[k % 4], k < 4 ? 1 : -1), from = v3_madd(v3(0.5, 0.5, 0), 0.2 / 16, way);
    aqr_tracer t;
    aqr_advance result;
    aqr_place at = model_place_at(&e, from);
    aqr_tracer_init(&t, &e.s, NULL);
    aqr_tracer_start(&t, &at, way);
    CHECK(aqr_tracer_straight(&e.c, &t, 5, &result) == AQR_OK && result == AQR_AT_BORDER);
    vec3 p = model_shape_point(&e, aqr_tracer_position(&t));
    CHECK(v3_norm(v3_reject(v3_sub(p, from), v3_unit(way))) < 1e-6);
    CHECK(fmin(fmin(p.x, 1 - p.x), fmin(p.y, 1 - p.y)) < 1e-6);
    CHECK(off_straight(&e, &t, from, v3_unit(way)) < 1e-5);
    check_samples(&e.s, &t);
    aqr_tracer_free(&e.c, &t);
  }
  model_free(&e);
}

/* On a prism, which unrolls into a plane, the height of a geodesic is its length times the sine of its slope. */
AQR_TEST(geodesics_are_helices_on_a_cylinder)
{
  shape m = shape_grid(60, 60, true, false, 0, 4, place_on_cylinder);
  model e = model_surface(m);
  for (int k = 0; k < 6; k++)
  {
    double slope = 0.05 + 0.1 * k, z = 0.1033;
    vec3 from = v3_scale(v3_add(place_on_cylinder(0, z), place_on_cylinder(1.0 / 60, z)), 0.5);
    vec3 around = v3_unit(v3_sub(place_on_cylinder(1.0 / 60, z), place_on_cylinder(0, z)));
    aqr_tracer t;
    aqr_advance result;
    aqr_place at = model_place_at(&e, from);
    aqr_tracer_init(&t, &e.s, NULL);
    aqr_tracer_start(&t, &at, v3_madd(v3_scale(around, cos(slope)), sin(slope), v3(0, 0, 1)));
    double length = 0.5 / sin(slope) * 0.9;
    CHECK(aqr_tracer_straight(&e.c, &t, length / e.s.diagonal, &result) == AQR_OK && result == AQR_INSIDE);
    vec3 p = model_shape_point(&e, aqr_tracer_position(&t));
    CHECK(fabs(p.z - z - length * sin(slope)) < 1e-9);
    /* the winding number times the girth is the length times the cosine */
    double girth = 60 * 2 * 0.3 * sin(shape_turn / 120), turns = length * cos(slope) / girth;
    double angle = shape_turn * (turns + 0.5 / 60), reached = atan2(p.y, p.x);
    CHECK(fabs(remainder(angle - reached, shape_turn)) < 0.003);
    CHECK(fabs(t.travelled * e.s.diagonal - length) < 1e-9);
    check_samples(&e.s, &t);
    aqr_tracer_free(&e.c, &t);
  }
  model_free(&e);
}

/* A line winds around a tube of a thousandth of its way; a length through space would lose most of that. */
static vec3 place_on_hair(double u, double v)
{
  return v3(1e-3 * cos(shape_turn * u), 1e-3 * sin(shape_turn * u), v);
}
AQR_TEST(length_travelled_around_a_thin_tube_is_the_paths)
{
  model e = model_surface(shape_grid(5, 400, true, false, 0, 5, place_on_hair));
  aqr_tracer t;
  aqr_advance result;
  aqr_place at = model_centre(aqr_face_of(e.s.fan[model_point_near(&e, v3(0, 0, 0.5))]));
  aqr_tracer_init(&t, &e.s, NULL);
  aqr_tracer_start(&t, &at, v3_cross(v3(0, 0, 1), aqr_face_cross(&e.s, at.face)));
  vec3 from = aqr_tracer_position(&t);
  for (int i = 0; i < 50; i++)
    CHECK(aqr_tracer_straight(&e.c, &t, 0.01, &result) == AQR_OK && result == AQR_INSIDE);
  CHECK(fabs(t.travelled - 0.5) < 1e-9);
  CHECK_BELOW(v3_norm(v3_sub(aqr_tracer_position(&t), from)), 0.003);
  check_samples(&e.s, &t);
  aqr_tracer_free(&e.c, &t);
  model_free(&e);
}

/* ---- borders and seams ---- */

AQR_TEST(a_seam_ends_a_line_as_a_border_does)
{
  model e = model_surface(shape_grid(10, 10, false, false, 0, 6, place_on_plane));
  uint8_t* crease = calloc(3 * e.s.n_faces, 1);
  for (aqr_index h = 0; h < 3 * e.s.n_faces; h++)
  {
    vec3 p = model_shape_point(&e, aqr_point(&e.s, aqr_from(&e.s, h)));
    vec3 q = model_shape_point(&e, aqr_point(&e.s, aqr_to(&e.s, h)));
    crease[h] = fabs(p.x - 0.7) < 1e-9 && fabs(q.x - 0.7) < 1e-9;
  }
  CHECK(aqr_surface_cut(&e.c, &e.s, crease) == AQR_OK);
  aqr_tracer t;
  aqr_advance result;
  aqr_place at = model_place_at(&e, v3(0.31, 0.33, 0));
  aqr_tracer_init(&t, &e.s, NULL);
  aqr_tracer_start(&t, &at, v3(1, 0.05, 0));
  CHECK(aqr_tracer_straight(&e.c, &t, 2, &result) == AQR_OK && result == AQR_AT_BORDER);
  CHECK(fabs(model_shape_point(&e, aqr_tracer_position(&t)).x - 0.7) < 1e-9);
  CHECK(t.n_samples && aqr_is_seam(&e.s, t.samples[t.n_samples - 1].edge));
  aqr_tracer_free(&e.c, &t);
  free(crease);
  model_free(&e);
}

/* Needles a millionth as wide as they are long lie across the way. */
static vec3 place_on_needles(double u, double v)
{
  double w = u < 0.5 ? u : u < 0.55 ? 0.5 + 1e-7 * (u - 0.5) : u - 0.05;
  return v3(w, v, 0);
}
AQR_TEST(needles_neither_stop_nor_turn_a_line)
{
  model e = model_surface(shape_grid(20, 20, false, false, 0, 7, place_on_needles));
  for (int k = 0; k < 10; k++)
  {
    vec3 from = v3(0.26, 0.31 + 0.01 * k, 0), d = v3_unit(v3(1, 0.3 - 0.05 * k, 0));
    aqr_tracer t;
    aqr_advance result;
    aqr_place at = model_place_at(&e, from);
    aqr_tracer_init(&t, &e.s, NULL);
    aqr_tracer_start(&t, &at, d);
    CHECK(aqr_tracer_straight(&e.c, &t, 2, &result) == AQR_OK && result == AQR_AT_BORDER);
    vec3 p = model_shape_point(&e, aqr_tracer_position(&t));
    CHECK(p.x > 0.949 && v3_norm(v3_reject(v3_sub(p, from), d)) < 1e-5);
    aqr_tracer_free(&e.c, &t);
  }
  model_free(&e);
}

/* ---- field lines ---- */

/* Follows the field from p for `length`; the largest value that `off` takes on the way. */
static double follow(model* e, vec3 p, vec3 d, double length, double (*off)(vec3), vec3* end)
{
  aqr_tracer t;
  aqr_advance result = AQR_INSIDE;
  aqr_place at = model_place_at(e, p);
  double worst = 0, step = 0.01;
  aqr_tracer_init(&t, &e->s, &e->f);
  aqr_tracer_start(&t, &at, d);
  while (t.travelled * e->s.diagonal < length && result == AQR_INSIDE)
  {
    /* the last step ends where it should */
    double left = length / e->s.diagonal - t.travelled;
    CHECK(aqr_tracer_step(&e->c, &t, &step, fmin(left, 0.002), fmin(left, 0.01), &result) == AQR_OK);
    worst = fmax(worst, off(model_shape_point(e, aqr_tracer_position(&t))));
    if (left < 1e-9)
      break;
  }
  check_samples(&e->s, &t);
  *end = model_shape_point(e, aqr_tracer_position(&t));
  aqr_tracer_free(&e->c, &t);
  return worst;
}

static double off_height(vec3 p)
{
  return fabs(p.z - 0.5);
}
AQR_TEST(a_line_of_curvature_around_a_cylinder_comes_back_to_its_start)
{
  model e = model_field(shape_cylinder(50, 8), 0.05, 5);
  vec3 end, from = place_on_cylinder(0.1, 0.5);
  double off =
    follow(&e, from, v3(-sin(0.1 * shape_turn), cos(0.1 * shape_turn), 0), shape_turn * 0.3, off_height, &end);
  CHECK_BELOW(off, 0.012);
  CHECK_BELOW(v3_norm(v3_sub(end, from)), 0.015);
  model_free(&e);
}

static double off_parallel(vec3 p)
{
  return fabs(atan2(p.z, hypot(p.x, p.y) - 1) - 1.5) * 0.4;
}
static double off_meridian(vec3 p)
{
  return fabs(atan2(p.y, p.x) - 0.2 * shape_turn) * hypot(p.x, p.y);
}
AQR_TEST(lines_of_curvature_stay_on_a_torus_parallel_and_meridian)
{
  model e = model_field(shape_torus(32, 9), 0.03, 5);
  double t = 1.5 / shape_turn, q = 1 + 0.4 * cos(1.5);
  vec3 end, from = place_on_torus(0.2, t), around = v3(-sin(0.2 * shape_turn), cos(0.2 * shape_turn), 0);
  CHECK_BELOW(follow(&e, from, around, shape_turn * q, off_parallel, &end), 0.05);
  CHECK_BELOW(v3_norm(v3_sub(end, from)), 0.08);
  vec3 up = v3_sub(place_on_torus(0.2, t + 0.01), from);
  CHECK_BELOW(follow(&e, from, up, shape_turn * 0.4, off_meridian, &end), 0.03);
  CHECK_BELOW(v3_norm(v3_sub(end, from)), 0.03);
  model_free(&e);
}

AQR_TEST_MAIN
