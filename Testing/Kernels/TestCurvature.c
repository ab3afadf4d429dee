/* SPDX-License-Identifier: BSD-3-Clause */
#include "test.h"

#include "field.h"
#include "shapes.h"

typedef struct estimate
{
  aqr_context c;
  aqr_surface s;
  aqr_tensors t;
  aqr_status status;
} estimate;

static void load(estimate* e, const shape* m)
{
  aqr_report report = { 0 };
  aqr_input input = shape_input(m);
  *e = (estimate){ .c = { .end = 1 } };
  e->status = aqr_surface_build(&e->c, &input, 1, &e->s, &report);
  CHECK(e->status == AQR_OK && e->s.n_points == m->n_points);
}

static estimate estimate_of(const shape* m, double radius)
{
  estimate e;
  load(&e, m);
  if (e.status == AQR_OK)
    e.status = aqr_curvature_tensors(&e.c, &e.s, radius, &e.t);
  CHECK(e.status == AQR_OK);
  return e;
}

static void finish(estimate* e, shape* m)
{
  aqr_tensors_free(&e->c, &e->s, &e->t);
  aqr_surface_free(&e->c, &e->s);
  CHECK(e->c.bytes == 0);
  shape_free(m);
}

static double apply(const float* f, vec3 a, vec3 b)
{
  double t[6];
  for (int i = 0; i < 6; i++)
    t[i] = (double)f[i];
  return t[0] * a.x * b.x + t[1] * a.y * b.y + t[2] * a.z * b.z + t[3] * (a.x * b.y + a.y * b.x) +
         t[4] * (a.x * b.z + a.z * b.x) + t[5] * (a.y * b.z + a.z * b.y);
}

/* Of the tensor in the plane of its normal, where the eigenvectors are swapped: the direction of the
 * larger eigenvalue is that of minimum curvature. */
static shape_curvature estimated(const estimate* e, aqr_index v)
{
  const float* t = e->t.t + 6 * (size_t)v;
  vec3 n = v3_load(e->t.normal + 3 * (size_t)v), a, b;
  shape_tangents(n, &a, &b);
  shape_curvature k = shape_principal(n, a, b, apply(t, a, a), apply(t, a, b), apply(t, b, b));
  k.min_direction = v3_cross(n, k.min_direction);
  return k;
}

typedef struct errors
{
  double angle;     /* degrees, mean over what is not umbilic */
  double curvature; /* of the larger of the two, mean */
  double normal;    /* degrees, largest */
} errors;

static errors errors_of(const estimate* e, vec3 (*gradient)(vec3))
{
  const double degrees = 360 / shape_turn;
  errors r = { 0 };
  size_t n = 0;
  for (aqr_index v = 0; v < e->s.n_points; v++)
  {
    shape_curvature k = estimated(e, v);
    shape_curvature x = shape_exact(gradient, v3_madd(e->s.centre, e->s.diagonal, aqr_point(&e->s, v)));
    double larger = fmax(fabs(x.k_min), fabs(x.k_max));
    r.normal = fmax(r.normal, degrees * acos(fmin(v3_dot(k.normal, x.normal), 1)));
    r.curvature += fmax(fabs(k.k_min / e->s.diagonal - x.k_min), fabs(k.k_max / e->s.diagonal - x.k_max)) / larger;
    if (x.k_max - x.k_min < 0.1 * larger)
      continue;
    r.angle += degrees * acos(fmin(fabs(v3_dot(k.min_direction, x.min_direction)), 1));
    n++;
  }
  r.curvature /= (double)e->s.n_points;
  r.angle /= n ? (double)n : 1;
  return r;
}

static void check_shape(shape m, double radius, vec3 (*gradient)(vec3))
{
  estimate e = estimate_of(&m, radius);
  errors r = errors_of(&e, gradient);
  CHECK_BELOW(r.angle, 3);
  CHECK_BELOW(r.curvature, 0.05);
  CHECK_BELOW(r.normal, 12);
  finish(&e, &m);
}

AQR_TEST(directions_swapped_on_cylinder)
{
  check_shape(shape_cylinder(70, 1), 0.02, cylinder_gradient);
}

AQR_TEST(curvature_of_torus_off)
{
  check_shape(shape_torus(32, 2), 0.02, torus_gradient);
}

AQR_TEST(curvature_of_ellipsoid_off)
{
  check_shape(shape_ellipsoid(41, 0.3, 3, v3(1, 0.6, 0.4)), 0.02, ellipsoid_gradient);
}

AQR_TEST(negative_curvature_of_catenoid_off)
{
  check_shape(shape_catenoid(32, 4), 0.02, catenoid_gradient);
}

AQR_TEST(balls_starve_without_radius)
{
  check_shape(shape_torus(32, 5), 0, torus_gradient);
  check_shape(shape_cylinder(70, 5), 0, cylinder_gradient);
}

AQR_TEST(blending_shared_balls_turns_directions)
{
  check_shape(shape_torus(60, 6), 0.03, torus_gradient);
  check_shape(shape_cylinder(100, 6), 0.05, cylinder_gradient);
}

AQR_TEST(sign_turned)
{
  shape m = shape_ellipsoid(20, 0.3, 7, v3(1, 1, 1));
  estimate e = estimate_of(&m, 0.02);
  CHECK_BELOW(errors_of(&e, sphere_gradient).curvature, 0.1);
  for (aqr_index v = 0; v < e.s.n_points; v++)
    if (!(estimated(&e, v).k_min > 0))
      CHECK(false);
  finish(&e, &m);
}

/* The share of points whose two curvatures differ by no more than noise explains. */
static double noise_share(shape m, double radius)
{
  estimate e = estimate_of(&m, radius);
  double share = 0;
  for (aqr_index v = 0; v < e.s.n_points; v++)
  {
    shape_curvature k = estimated(&e, v);
    share += k.k_max - k.k_min < 2 * (double)e.t.noise[v];
  }
  share /= (double)e.s.n_points;
  finish(&e, &m);
  return share;
}

static vec3 place_on_sheet(double u, double v)
{
  return v3(u, v, 0);
}

static shape with_noise(shape m, double noise)
{
  unsigned state = 6;
  for (size_t i = 0; i < 3 * m.n_points; i++)
    m.points[i] += noise * (2 * shape_random(&state) - 1);
  return m;
}

AQR_TEST(noise_is_taken_for_curvature)
{
  const double radius[] = { 0, 0.03, 0.08 };
  for (int i = 0; i < 3; i++)
  {
    CHECK_BELOW(
      0.95, noise_share(with_noise(shape_grid(60, 60, false, false, 0.3, 5, place_on_sheet), 1e-3), radius[i]));
    CHECK_BELOW(
      0.95, noise_share(with_noise(shape_grid(60, 60, false, false, 0.3, 5, place_on_sheet), 3e-3), radius[i]));
  }
}

AQR_TEST(curvature_is_taken_for_noise)
{
  const double radius[] = { 0, 0.03, 0.08 };
  for (int i = 0; i < 3; i++)
  {
    CHECK_BELOW(noise_share(shape_cylinder(50, 6), radius[i]), 0.01);
    CHECK_BELOW(noise_share(shape_torus(32, 6), radius[i]), 0.01);
    CHECK_BELOW(noise_share(shape_catenoid(32, 6), radius[i]), 0.01);
  }
  CHECK_BELOW(noise_share(with_noise(shape_cylinder(50, 6), 2e-4), 0.05), 0.01);
}

static vec3 place_on_inner_cylinder(double u, double v)
{
  return v3(0.29 * cos(shape_turn * u), -0.29 * sin(shape_turn * u), v);
}

/* One shape behind the other. */
static shape together_with(const shape* one, const shape* other)
{
  shape both = { one->n_points + other->n_points, one->n_triangles + other->n_triangles, NULL, NULL };
  both.points = malloc(3 * both.n_points * sizeof(double));
  both.triangles = malloc(3 * both.n_triangles * sizeof(int64_t));
  memcpy(both.points, one->points, 3 * one->n_points * sizeof(double));
  memcpy(both.points + 3 * one->n_points, other->points, 3 * other->n_points * sizeof(double));
  memcpy(both.triangles, one->triangles, 3 * one->n_triangles * sizeof(int64_t));
  for (size_t i = 0; i < 3 * other->n_triangles; i++)
    both.triangles[3 * one->n_triangles + i] = other->triangles[i] + (int64_t)one->n_points;
  return both;
}

AQR_TEST(ball_jumps_to_the_next_sheet)
{
  shape one = shape_cylinder(40, 8), other = shape_grid(80, 40, true, false, 0.3, 9, place_on_inner_cylinder);
  shape both = together_with(&one, &other);
  estimate alone = estimate_of(&one, 0.04), together = estimate_of(&both, 0.04);
  size_t* at = malloc(one.n_points * sizeof *at); /* of the points of `one` among those of both */
  for (size_t i = 0; i < together.s.n_points; i++)
    if (together.s.origin[i] < one.n_points)
      at[together.s.origin[i]] = i;
  bool same_points = true, same_tensors = true;
  for (size_t i = 0; i < one.n_points; i++)
  {
    size_t j = at[alone.s.origin[i]];
    same_points &= !memcmp(alone.s.points + 3 * i, together.s.points + 3 * j, 3 * sizeof(double));
    same_tensors &= !memcmp(alone.t.t + 6 * i, together.t.t + 6 * j, 6 * sizeof(float));
  }
  CHECK(same_points);
  CHECK(same_tensors);
  free(at);
  finish(&alone, &one);
  finish(&together, &both);
  shape_free(&other);
}

AQR_TEST(normals_of_tiny_components_point_anywhere)
{
  const vec3 at = { 1.5, 0.3, 0.2 };
  const double size = 1e-8;
  shape one = shape_ellipsoid(16, 0.2, 5, v3(1, 1, 1)), speck = shape_ellipsoid(8, 0, 6, v3(1, 1, 1));
  for (size_t i = 0; i < speck.n_points; i++)
    v3_store(speck.points + 3 * i, v3_madd(at, size, v3_load(speck.points + 3 * i)));
  shape both = together_with(&one, &speck);
  estimate e = estimate_of(&both, 0.04);
  double least = 1;
  for (size_t i = 0; i < e.s.n_points; i++)
  {
    vec3 out = v3_sub(v3_load(both.points + 3 * (size_t)e.s.origin[i]), at);
    if (v3_norm(out) < 2 * size)
      least = fmin(least, v3_dot(v3_unit(out), v3_load(e.t.normal + 3 * i)));
  }
  CHECK(least < 1); /* some were looked at */
  CHECK_BELOW(1 - least, 0.1);
  finish(&e, &both);
  shape_free(&one);
  shape_free(&speck);
}

static vec3 place_on_folded_sheet(double u, double v)
{
  return v3(u, v, fabs(u - 0.5));
}

AQR_TEST(curvature_leaks_through_seam)
{
  shape m = shape_grid(20, 20, false, false, 0, 10, place_on_folded_sheet);
  estimate e = estimate_of(&m, 0.1);
  double largest = 0;
  for (size_t i = 0; i < 6 * e.s.n_points; i++)
    largest = fmax(largest, fabs((double)e.t.t[i]));
  CHECK(largest > 1);
  aqr_tensors_free(&e.c, &e.s, &e.t);
  uint8_t* crease = calloc(3 * e.s.n_faces, 1);
  for (aqr_index h = 0; h < 3 * e.s.n_faces; h++)
  {
    vec3 n = v3_unit(aqr_face_cross(&e.s, aqr_face_of(h)));
    crease[h] =
      !aqr_is_boundary(&e.s, h) && v3_dot(n, v3_unit(aqr_face_cross(&e.s, aqr_face_of(aqr_any_twin(&e.s, h))))) < 0.9;
  }
  CHECK(aqr_surface_cut(&e.c, &e.s, crease) == AQR_OK);
  CHECK(e.s.n_points == m.n_points + 21);
  CHECK(aqr_curvature_tensors(&e.c, &e.s, 0.1, &e.t) == AQR_OK);
  for (size_t i = 0; i < 6 * e.s.n_points; i++)
    if (!(fabs((double)e.t.t[i]) < 1e-9))
      CHECK(false);
  free(crease);
  finish(&e, &m);
}

AQR_TEST(collapsed_faces_give_nan)
{
  for (int whole = 0; whole < 2; whole++)
  {
    shape m = shape_torus(10, 11);
    estimate e;
    load(&e, &m);
    for (aqr_index h = 0; h < 3 * e.s.n_faces; h++)
      if (whole || h % 7 == 0)
        v3_store(e.s.points + 3 * (size_t)aqr_to(&e.s, h), aqr_point(&e.s, aqr_from(&e.s, h)));
    for (size_t i = 0; whole && i < 3 * e.s.n_points; i++)
      e.s.points[i] = 0.25;
    for (int r = 0; r < 3; r++)
    {
      CHECK(aqr_curvature_tensors(&e.c, &e.s, 0.1 * r, &e.t) == AQR_OK);
      for (size_t i = 0; i < 6 * e.s.n_points; i++)
        if (!isfinite(e.t.t[i]) || !isfinite(e.t.normal[i / 2]) || (whole && e.t.t[i] != 0))
          CHECK(false);
      aqr_tensors_free(&e.c, &e.s, &e.t);
    }
    finish(&e, &m);
  }
}

/* As threads might: in small pieces, the last first. */
static void backwards(void* user, size_t count, size_t grain, void (*body)(void*, size_t, size_t), void* data)
{
  size_t piece = grain / 3 + 1, pieces = (count + piece - 1) / piece;
  (*(int*)user)++;
  while (pieces--)
    body(data, pieces * piece, (pieces + 1) * piece < count ? (pieces + 1) * piece : count);
}

AQR_TEST(threads_change_tensors)
{
  const double radius[] = { 0, 0.05, 0.2 };
  for (int r = 0; r < 3; r++)
  {
    int calls = 0;
    shape m = shape_torus(30, 12), same = shape_torus(30, 12);
    estimate one = estimate_of(&m, radius[r]), other;
    load(&other, &same);
    other.c.hooks.user = &calls;
    other.c.hooks.parallel_for = backwards;
    CHECK(aqr_curvature_tensors(&other.c, &other.s, radius[r], &other.t) == AQR_OK);
    CHECK(calls > 2);
    CHECK(!memcmp(one.t.t, other.t.t, 6 * one.s.n_points * sizeof(float)));
    CHECK(!memcmp(one.t.normal, other.t.normal, 3 * one.s.n_points * sizeof(double)));
    finish(&one, &m);
    finish(&other, &same);
  }
}

typedef struct quota
{
  long allocations, looks; /* that are still granted */
} quota;

static void* grant(void* user, void* old, size_t old_bytes, size_t bytes)
{
  (void)old_bytes;
  if (bytes == 0)
  {
    free(old);
    return NULL;
  }
  return ((quota*)user)->allocations-- > 0 ? realloc(old, bytes) : NULL;
}

static int look(void* user, double fraction, const char* stage)
{
  (void)fraction;
  (void)stage;
  return ((quota*)user)->looks-- > 0;
}

/* Stops at the first, second, ... allocation or look at the progress hook, until none is left. */
static void stop_at_every(bool allocation, aqr_status expected)
{
  shape m = shape_torus(30, 13);
  estimate e;
  load(&e, &m);
  size_t held = e.c.bytes;
  long stops = 0;
  for (bool stopped = true; stopped; stops += stopped)
  {
    quota q = { allocation ? stops : 1000000, allocation ? 1000000 : stops };
    e.c.hooks = (aqr_hooks){ .user = &q, .reallocate = grant, .progress = look };
    aqr_status status = aqr_curvature_tensors(&e.c, &e.s, 0.2, &e.t);
    stopped = status != AQR_OK;
    CHECK(status == AQR_OK || status == expected);
    CHECK(!stopped || (e.c.bytes == held && !e.t.t && !e.t.normal));
    if (stops > 1000)
      break;
  }
  CHECK(stops > 4);
  e.c.hooks = (aqr_hooks){ 0 };
  finish(&e, &m);
}

AQR_TEST(failed_allocation_leaks)
{
  stop_at_every(true, AQR_OUT_OF_MEMORY);
}

AQR_TEST(cancelling_is_not_heard)
{
  stop_at_every(false, AQR_CANCELLED);
}

/* The hook is asked after so many visits to points, so how often it was asked tells the work. */
AQR_TEST(needles_make_work_quadratic)
{
  shape m = shape_grid(2000, 10, true, false, 0, 14, place_on_cylinder);
  estimate e;
  load(&e, &m);
  quota q = { .looks = 1000000 };
  e.c.hooks = (aqr_hooks){ .user = &q, .progress = look };
  CHECK(aqr_curvature_tensors(&e.c, &e.s, 0.01, &e.t) == AQR_OK);
  CHECK_BELOW(1e6 - (double)q.looks, 50);
  CHECK_BELOW(errors_of(&e, cylinder_gradient).angle, 3);
  e.c.hooks = (aqr_hooks){ 0 };
  finish(&e, &m);
}

AQR_TEST_MAIN
