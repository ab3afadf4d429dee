/* SPDX-License-Identifier: BSD-3-Clause */
#include "test.h"

#include "cross_field.h"
#include "shapes.h"

static const double min_cosine = 0.866;
static const double degrees = 57.2957795130823209;

typedef struct model
{
  shape m;
  aqr_context c;
  aqr_surface s;
  aqr_tensors t;
  aqr_field f;
} model;

static model loaded(shape m)
{
  aqr_report report = { 0 };
  model e = { .m = m, .c = { .end = 1 } };
  aqr_input input = shape_input(&m);
  CHECK(aqr_surface_build(&e.c, &input, 1, &e.s, &report) == AQR_OK && e.s.n_points == m.n_points);
  return e;
}

static model with_tensors(shape m, double radius)
{
  model e = loaded(m);
  CHECK(aqr_curvature_tensors(&e.c, &e.s, radius, &e.t) == AQR_OK);
  return e;
}

static model with_field(shape m, double radius, int iterations)
{
  model e = with_tensors(m, radius);
  CHECK(aqr_direction_field(&e.c, &e.s, &e.t, iterations, min_cosine, &e.f) == AQR_OK);
  return e;
}

static void finish(model* e)
{
  aqr_field_free(&e->c, &e->s, &e->f);
  aqr_tensors_free(&e->c, &e->s, &e->t);
  aqr_surface_free(&e->c, &e->s);
  CHECK(e->c.bytes == 0);
  shape_free(&e->m);
}

/* Between lines, in degrees. */
static double off_line(vec3 a, vec3 b)
{
  return degrees * atan2(v3_norm(v3_cross(a, b)), fabs(v3_dot(a, b)));
}

/* Between crosses: modulo quarter turns. */
static double off_cross(vec3 a, vec3 b)
{
  double angle = off_line(a, b);
  return fmin(angle, 90 - angle);
}

static void check_frames(const model* e)
{
  size_t bad = 0;
  for (size_t v = 0; v < e->s.n_points; v++)
  {
    vec3 n = v3_load(e->f.normal + 3 * v), d = aqr_min_direction(&e->f, v), x = aqr_cross(&e->f, v);
    double worst =
      fabs(v3_norm(n) - 1) + fabs(v3_norm(d) - 1) + fabs(v3_norm(x) - 1) + fabs(v3_dot(n, d)) + fabs(v3_dot(n, x));
    float c = e->f.point_confidence[v];
    bad += !(worst < 1e-9 && c >= 0 && c <= 1 && e->f.k_min[v] <= e->f.k_max[v]);
  }
  for (size_t f = 0; f < e->s.n_faces; f++)
    bad += !(e->f.face_confidence[f] >= 0 && e->f.face_confidence[f] <= 1);
  CHECK(bad == 0);
}

AQR_TEST(smoothing_turns_directions_of_cylinder)
{
  const int iterations[] = { 0, 5, 100 };
  for (int i = 0; i < 3; i++)
  {
    model e = with_field(shape_cylinder(50, 1), 0.03, iterations[i]);
    double mean = 0, curvature = 0;
    for (size_t v = 0; v < e.s.n_points; v++)
    {
      mean += off_line(aqr_min_direction(&e.f, v), v3(0, 0, 1)) / (double)e.s.n_points;
      curvature += (double)e.f.k_max[v] / e.s.diagonal * 0.3 / (double)e.s.n_points;
    }
    CHECK_BELOW(mean, 1.0);
    CHECK_BELOW(fabs(curvature - 1), 0.05);
    check_frames(&e);
    finish(&e);
  }
}

AQR_TEST(smoothing_leaves_noise)
{
  double off[2];
  for (int i = 0; i < 2; i++)
  {
    shape m = shape_cylinder(50, 2);
    unsigned state = 3;
    for (size_t k = 0; k < 3 * m.n_points; k++)
      m.points[k] += 0.002 * (shape_random(&state) - 0.5);
    model e = with_field(m, 0.02, 10 * i);
    off[i] = 0;
    for (size_t v = 0; v < e.s.n_points; v++)
      off[i] += off_line(aqr_min_direction(&e.f, v), v3(0, 0, 1)) / (double)e.s.n_points;
    finish(&e);
  }
  printf("without smoothing: %g\n", off[0]);
  CHECK_BELOW(off[1], 0.5 * off[0]);
}

static vec3 place_on_sheet(double u, double v)
{
  return v3(u, v, 0);
}

static double mean_confidence(const model* e)
{
  double sum = 0;
  for (size_t f = 0; f < e->s.n_faces; f++)
    sum += (double)e->f.face_confidence[f];
  return sum / (double)e->s.n_faces;
}

AQR_TEST(confidence_cannot_tell_cylinder_from_noise)
{
  model cylinder = with_field(shape_cylinder(50, 4), 0.03, 0);
  CHECK_BELOW(1 - mean_confidence(&cylinder), 0.01);
  shape m = shape_grid(50, 50, false, false, 0.3, 5, place_on_sheet);
  unsigned state = 6;
  for (size_t v = 0; v < m.n_points; v++)
    m.points[3 * v + 2] = 1e-3 * shape_random(&state);
  model sheet = with_field(m, 0, 0);
  CHECK_BELOW(mean_confidence(&sheet), 0.7);
  finish(&cylinder);
  finish(&sheet);
}

/* One triangle whose tensors have their minimum directions at given degrees in its plane, and this
 * difference of curvatures. The normals lean a little, to where frames are chosen differently. */
static float triangle_confidence(const double angle[3], double difference)
{
  shape m = { 3, 1, malloc(9 * sizeof(double)), malloc(3 * sizeof(int64_t)) };
  vec3 n = v3(0.8, 0.6, 0), x = v3(0, 0, 1), y = v3_cross(n, x);
  for (size_t i = 0; i < 3; i++)
  {
    double turn = shape_turn * (double)i / 3;
    v3_store(m.points + 3 * i, v3_madd(v3_scale(x, cos(turn)), sin(turn), y));
    m.triangles[i] = (int64_t)i;
  }
  model e = with_tensors(m, 0);
  for (size_t i = 0; i < 3; i++)
  {
    double a = angle[i] / degrees;
    vec3 d = v3_madd(v3_scale(x, cos(a)), sin(a), y);
    const double t[6] = { d.x * d.x, d.y * d.y, d.z * d.z, d.x * d.y, d.x * d.z, d.y * d.z };
    for (size_t k = 0; k < 6; k++)
      e.t.t[6 * i + k] = (float)(difference * t[k]);
    v3_store(e.t.normal + 3 * i, v3_unit(v3(n.x + 0.01 * ((double)i - 1), n.y, 0)));
  }
  CHECK(aqr_direction_field(&e.c, &e.s, &e.t, 0, min_cosine, &e.f) == AQR_OK);
  float confidence = e.f.face_confidence[0];
  finish(&e);
  return confidence;
}

AQR_TEST(confidence_misses_an_angle)
{
  for (int i = 0; i < 3; i++)
  {
    double angle[3] = { 10, 10, 10 };
    CHECK_BELOW(fabs((double)triangle_confidence(angle, 3) - 1), 1e-3);
    angle[i] += 30;
    angle[(i + 1) % 3] -= 35;
    CHECK_BELOW(fabs((double)triangle_confidence(angle, 3) - cos(65 / degrees)), 0.01);
    angle[i] += 180;
    CHECK_BELOW(fabs((double)triangle_confidence(angle, 3) - cos(65 / degrees)), 0.01);
    CHECK(triangle_confidence(angle, 1e-10) == 0);
  }
}

AQR_TEST(flat_faces_are_trusted)
{
  model e = with_field(shape_grid(20, 20, false, false, 0.3, 7, place_on_sheet), 0.05, 5);
  for (size_t f = 0; f < e.s.n_faces; f++)
    if (e.f.face_confidence[f] != 0)
      CHECK(false);
  check_frames(&e);
  finish(&e);
}

AQR_TEST(cross_leaves_principal_directions)
{
  model e = with_field(shape_ellipsoid(40, 0.3, 8, v3(1, 0.6, 0.4)), 0.02, 5);
  double sum = 0, n = 0;
  for (size_t v = 0; v < e.s.n_points; v++)
  {
    double a = (double)e.f.k_min[v], b = (double)e.f.k_max[v];
    if (b - a < 0.3 * (fabs(a) + fabs(b)) || e.f.point_confidence[v] < 0.95F)
      continue;
    sum += off_line(aqr_cross(&e.f, v), aqr_min_direction(&e.f, v));
    n++;
  }
  CHECK(n > 0.3 * (double)e.s.n_points);
  CHECK_BELOW(sum / n, 0.5);
  check_frames(&e);
  finish(&e);
}

/* The share of neighbours whose crosses differ by more than 10 degrees. */
static double roughness(const model* e)
{
  double rough = 0;
  for (aqr_index h = 0; h < 3 * e->s.n_faces; h++)
  {
    size_t v = aqr_from(&e->s, h), w = aqr_to(&e->s, h);
    rough += off_cross(aqr_cross(&e->f, v), aqr_cross(&e->f, w)) > 10;
  }
  return rough / (3 * (double)e->s.n_faces);
}

AQR_TEST(cross_is_torn_where_nothing_is_known)
{
  model e = with_field(shape_ellipsoid(30, 0.3, 9, v3(1, 1, 1)), 0.02, 5);
  CHECK_BELOW(roughness(&e), 0.05);
  finish(&e);
}

AQR_TEST(cross_ignores_border_of_flat_sheet)
{
  model e = with_field(shape_grid(30, 30, false, false, 0.3, 10, place_on_sheet), 0.05, 5);
  double worst = 0;
  for (size_t v = 0; v < e.s.n_points; v++)
    worst = fmax(worst, off_cross(aqr_cross(&e.f, v), v3(1, 0, 0)));
  CHECK_BELOW(worst, 0.1);
  finish(&e);
}

static shape noisy_sheet(double noise)
{
  shape m = shape_grid(60, 60, false, false, 0.3, 10, place_on_sheet);
  unsigned state = 6;
  for (size_t v = 0; v < m.n_points; v++)
    m.points[3 * v + 2] = noise / 60 * (2 * shape_random(&state) - 1);
  return m;
}

AQR_TEST(noise_of_flat_sheet_turns_cross)
{
  for (int i = 0; i < 2; i++)
  {
    model e = with_field(noisy_sheet(i ? 0.3 : 0.1), 0.05, 5);
    double mean = 0;
    for (size_t v = 0; v < e.s.n_points; v++)
      mean += off_cross(aqr_cross(&e.f, v), v3(1, 0, 0)) / (double)e.s.n_points;
    CHECK_BELOW(mean, 5);
    finish(&e);
  }
}

static vec3 place_on_ring(double u, double v)
{
  return v3((1 + v) * cos(shape_turn * u), (1 + v) * sin(shape_turn * u), 0);
}

AQR_TEST(cross_does_not_turn_with_border)
{
  model e = with_field(shape_grid(100, 16, true, false, 0.3, 10, place_on_ring), 0.05, 5);
  double worst = 0;
  for (aqr_index v = 0; v < e.s.n_points; v++)
    worst = fmax(worst, off_cross(aqr_cross(&e.f, v), aqr_point(&e.s, v)));
  CHECK_BELOW(worst, 8);
  finish(&e);
}

AQR_TEST(ragged_border_turns_cross)
{
  shape m = shape_grid(40, 10, false, false, 0.3, 11, place_on_sheet);
  unsigned state = 12;
  for (size_t v = 0; v < m.n_points; v++)
    if (m.points[3 * v + 1] == 1)
      m.points[3 * v + 1] += 0.05 * shape_random(&state);
  model e = with_field(m, 0.03, 5);
  double worst = 0;
  for (size_t v = 0; v < e.s.n_points; v++)
    worst = fmax(worst, off_cross(aqr_cross(&e.f, v), v3(1, 0, 0)));
  CHECK_BELOW(worst, 15);
  finish(&e);
}

AQR_TEST(border_turns_trusted_directions)
{
  shape m = shape_cylinder(40, 11);
  for (size_t v = 0; v < m.n_points; v++) /* cut off obliquely */
    m.points[3 * v + 2] *= 1 + m.points[3 * v];
  model e = with_field(m, 0.03, 5);
  double worst = 0;
  for (size_t v = 0; v < e.s.n_points; v++)
    worst = fmax(worst, off_cross(aqr_cross(&e.f, v), aqr_min_direction(&e.f, v)));
  CHECK_BELOW(worst, 5);
  finish(&e);
}

/* Its crease and its other borders do not meet at right angles. */
static vec3 place_on_slanted_fold(double u, double v)
{
  return v3(u, v + 0.3 * u, fabs(u - 0.5));
}

AQR_TEST(cross_ignores_creases)
{
  model e = loaded(shape_grid(30, 30, false, false, 0, 13, place_on_slanted_fold));
  uint8_t* crease = calloc(3 * e.s.n_faces, 1);
  for (aqr_index h = 0; h < 3 * e.s.n_faces; h++)
  {
    aqr_index twin = aqr_any_twin(&e.s, h);
    crease[h] =
      twin != AQR_NONE && v3_dot(v3_unit(aqr_face_cross(&e.s, h / 3)), v3_unit(aqr_face_cross(&e.s, twin / 3))) < 0.9;
  }
  CHECK(aqr_surface_cut(&e.c, &e.s, crease) == AQR_OK);
  CHECK(aqr_curvature_tensors(&e.c, &e.s, 0.05, &e.t) == AQR_OK);
  CHECK(aqr_direction_field(&e.c, &e.s, &e.t, 5, min_cosine, &e.f) == AQR_OK);
  double worst = 0;
  size_t n = 0;
  for (aqr_index h = 0; h < 3 * e.s.n_faces; h++)
    if (aqr_is_seam(&e.s, h) && aqr_is_seam(&e.s, e.s.fan[aqr_to(&e.s, h)]))
    {
      worst = fmax(worst, off_cross(aqr_cross(&e.f, aqr_to(&e.s, h)), v3(0, 1, 0)));
      n++;
    }
  CHECK(n == 58);
  CHECK_BELOW(worst, 0.01);
  free(crease);
  finish(&e);
}

AQR_TEST(cross_depends_on_signs)
{
  model e = with_field(shape_ellipsoid(25, 0.3, 14, v3(1, 0.8, 0.7)), 0.02, 3);
  size_t n = e.s.n_points;
  float* before = malloc(3 * n * sizeof *before);
  memcpy(before, e.f.cross, 3 * n * sizeof *before);
  unsigned state = 15;
  for (size_t v = 0; v < n; v++)
    if (shape_random(&state) < 0.5)
      e.f.direction[v] = (aqr_rotor){ -e.f.direction[v].x, -e.f.direction[v].y };
  aqr_neighbours around;
  CHECK(aqr_neighbours_build(&e.c, &e.s, &around) == AQR_OK);
  CHECK(aqr_cross_field(&e.c, &e.s, &around, min_cosine, &e.f) == AQR_OK);
  double worst = 0;
  for (size_t v = 0; v < n; v++)
    worst = fmax(worst, off_cross(v3_widen(before + 3 * v), aqr_cross(&e.f, v)));
  CHECK_BELOW(worst, 1e-3);
  aqr_neighbours_free(&e.c, &around);
  free(before);
  finish(&e);
}

/* As threads might: in small pieces, the last first. */
static void backwards(void* user, size_t count, size_t grain, void (*body)(void*, size_t, size_t), void* data)
{
  size_t piece = grain / 3 + 1, pieces = (count + piece - 1) / piece;
  (*(int*)user)++;
  while (pieces--)
    body(data, pieces * piece, (pieces + 1) * piece < count ? (pieces + 1) * piece : count);
}

AQR_TEST(threads_change_field)
{
  int calls = 0;
  const vec3 axes = { 1, 1, 0.9 };
  model one = with_field(shape_ellipsoid(30, 0.3, 16, axes), 0.02, 5);
  model other = with_tensors(shape_ellipsoid(30, 0.3, 16, axes), 0.02);
  other.c.hooks.user = &calls;
  other.c.hooks.parallel_for = backwards;
  CHECK(aqr_direction_field(&other.c, &other.s, &other.t, 5, min_cosine, &other.f) == AQR_OK);
  CHECK(calls > 40);
  size_t n = one.s.n_points;
  CHECK(!memcmp(one.f.direction, other.f.direction, n * sizeof(aqr_rotor)));
  CHECK(!memcmp(one.f.cross, other.f.cross, 3 * n * sizeof(float)));
  CHECK(!memcmp(one.f.k_max, other.f.k_max, n * sizeof(float)));
  CHECK(!memcmp(one.f.point_confidence, other.f.point_confidence, n * sizeof(float)));
  finish(&one);
  finish(&other);
}

AQR_TEST(neighbours_are_missed_at_borders)
{
  model e = loaded(shape_grid(3, 2, false, false, 0, 17, place_on_sheet));
  aqr_neighbours around;
  CHECK(aqr_neighbours_build(&e.c, &e.s, &around) == AQR_OK);
  size_t edges = 0;
  for (aqr_index h = 0; h < 3 * e.s.n_faces; h++)
    edges += aqr_twin(&e.s, h) == AQR_NONE || h < aqr_twin(&e.s, h);
  CHECK(around.first[e.s.n_points] == 2 * edges);
  for (aqr_index h = 0; h < 3 * e.s.n_faces; h++)
    for (int way = 0; way < 2; way++)
    {
      aqr_index v = way ? aqr_to(&e.s, h) : aqr_from(&e.s, h), w = way ? aqr_from(&e.s, h) : aqr_to(&e.s, h), n = 0;
      for (aqr_index i = around.first[v]; i < around.first[v + 1]; i++)
        n += around.point[i] == w;
      CHECK(n == 1);
    }
  aqr_neighbours_free(&e.c, &around);
  finish(&e);
}

AQR_TEST(collapsed_faces_give_nan)
{
  for (int whole = 0; whole < 2; whole++)
  {
    model e = loaded(shape_torus(10, 18));
    for (aqr_index h = 0; h < 3 * e.s.n_faces; h++)
      if (whole || h % 7 == 0)
        v3_store(e.s.points + 3 * (size_t)aqr_to(&e.s, h), aqr_point(&e.s, aqr_from(&e.s, h)));
    for (size_t i = 0; whole && i < 3 * e.s.n_points; i++)
      e.s.points[i] = 0.25;
    CHECK(aqr_curvature_tensors(&e.c, &e.s, 0.1, &e.t) == AQR_OK);
    CHECK(aqr_direction_field(&e.c, &e.s, &e.t, 5, min_cosine, &e.f) == AQR_OK);
    check_frames(&e);
    for (aqr_index f = 0; f < e.s.n_faces; f++)
      if (v3_norm(aqr_face_cross(&e.s, f)) == 0 && e.f.face_confidence[f] != 0)
        CHECK(false);
    finish(&e);
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

AQR_TEST(stopping_leaks)
{
  model e = with_tensors(shape_torus(8, 19), 0.05);
  for (int cancelled = 0; cancelled < 2; cancelled++)
  {
    aqr_status status = AQR_OUT_OF_MEMORY;
    long granted = 0;
    for (; granted < 1000 && status != AQR_OK; granted++)
    {
      quota q = { cancelled ? 1000 : granted, cancelled ? granted : 1000 };
      aqr_context c = { .hooks = { .user = &q, .reallocate = grant, .progress = look }, .end = 1 };
      status = aqr_direction_field(&c, &e.s, &e.t, 3, min_cosine, &e.f);
      if (status == AQR_OK)
        aqr_field_free(&c, &e.s, &e.f);
      else
        CHECK(status == (cancelled ? AQR_CANCELLED : AQR_OUT_OF_MEMORY));
      CHECK(c.bytes == 0);
    }
    CHECK(granted > 10 && granted < 1000);
  }
  finish(&e);
}

AQR_TEST_MAIN
