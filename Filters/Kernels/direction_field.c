/* SPDX-License-Identifier: BSD-3-Clause */
/* Principal frames, their confidence and confidence-weighted smoothing (paper 4.1). The confidence
 * that weights an iteration is that of the field it smooths, as the paper prints it, so directions
 * spread further into isotropic regions with every iteration. */
#include "cross_field.h"
#include "flatten.h"

#include <string.h>

/* Curvature differences below this are rounding, no direction: the scaled surface would turn by less
 * than this many radians from end to end. */
static const double least_difference = 1e-7;

typedef struct job
{
  const aqr_surface* s;
  const aqr_neighbours* around;
  const double* t;
  double* smoothed;
  aqr_field* field;
} job;

static vec3 any_tangent(vec3 n)
{
  return v3_unit(v3_cross(n, fabs(n.x) < 0.8 ? v3(1, 0, 0) : v3(0, 1, 0)));
}

static double apply(const double* t, vec3 a, vec3 b)
{
  return t[0] * a.x * b.x + t[1] * a.y * b.y + t[2] * a.z * b.z + t[3] * (a.x * b.y + a.y * b.x) +
         t[4] * (a.x * b.z + a.z * b.x) + t[5] * (a.y * b.z + a.z * b.y);
}

/* Principal curvatures and directions from the tensor in the plane of the averaged normal. Its
 * eigenvectors are swapped (DESIGN: normal cycles): the larger curvature comes along the minimum
 * direction. The direction is zero where there is none. */
static void principal(void* data, size_t begin, size_t end)
{
  const job* j = data;
  for (size_t v = begin; v < end; v++)
  {
    vec3 n = v3_load(j->field->normal + 3 * v), e1 = any_tangent(n), e2 = v3_cross(n, e1);
    const double* t = j->t + 6 * v;
    double a = apply(t, e1, e1), b = apply(t, e2, e2), off = apply(t, e1, e2);
    double mean = (a + b) / 2, d = (a - b) / 2, half = sqrt(d * d + off * off);
    double x = d >= 0 ? half + d : fabs(off), y = d >= 0 ? off : copysign(half - d, off);
    double r = sqrt(x * x + y * y);
    j->field->k_min[v] = mean - half;
    j->field->k_max[v] = mean + half;
    bool directed = 2 * half > least_difference * (1 + fabs(mean));
    v3_store(j->field->min_direction + 3 * v, directed ? v3_madd(v3_scale(e1, x / r), y / r, e2) : v3(0, 0, 0));
  }
}

/* Equation 1. Nothing is known of faces with a corner without direction, or without a plane. */
static double face_confidence(const aqr_surface* s, const aqr_field* field, size_t f)
{
  vec3 p[3], e[3];
  for (unsigned i = 0; i < 3; i++)
    p[i] = aqr_point(s, s->corner[3 * f + i]);
  for (unsigned i = 0; i < 3; i++)
    e[i] = v3_sub(p[(i + 1) % 3], p[i]);
  double base = v3_norm(e[0]), cross = v3_norm(v3_cross(e[0], e[1])), along = v3_dot(e[1], e[0]);
  if (!(base > 0 && cross > 0))
    return 0;
  aqr_complex q[3] = { cx(base, 0), cx(along / base, cross / base), cx(-base - along / base, -cross / base) };
  aqr_complex d[3];
  for (unsigned i = 0; i < 3; i++)
  {
    size_t v = s->corner[3 * f + i];
    unsigned k = (i + 2) % 3;
    vec3 direction = v3_load(field->min_direction + 3 * v);
    if (v3_norm2(direction) < 0.5)
      return 0;
    d[i] = aqr_flatten(v3_load(field->normal + 3 * v), direction, e[i], v3_scale(e[k], -1), q[i], cx(-q[k].x, -q[k].y));
  }
  double least = 1;
  for (unsigned i = 0; i < 3; i++)
    least = fmin(least, fabs(d[i].x * d[(i + 1) % 3].x + d[i].y * d[(i + 1) % 3].y));
  return least;
}

static void faces_confidence(void* data, size_t begin, size_t end)
{
  const job* j = data;
  for (size_t f = begin; f < end; f++)
    j->field->face_confidence[f] = (float)face_confidence(j->s, j->field, f);
}

static void points_confidence(void* data, size_t begin, size_t end)
{
  const job* j = data;
  const aqr_surface* s = j->s;
  for (size_t v = begin; v < end; v++)
  {
    double sum = 0, n = 0;
    aqr_index start = s->fan[v], h = start;
    while (h != AQR_NONE)
    {
      sum += (double)j->field->face_confidence[aqr_face_of(h)];
      n++;
      h = aqr_next_around(s, h);
      if (h == start)
        break;
    }
    j->field->point_confidence[v] = n > 0 ? (float)(sum / n) : 0;
  }
}

/* One printed iteration. Where no neighbour is trusted at all the tensor stays. */
static void smooth(void* data, size_t begin, size_t end)
{
  const job* j = data;
  const float* confidence = j->field->point_confidence;
  for (size_t v = begin; v < end; v++)
  {
    double sum[6] = { 0 }, weight = 0;
    for (aqr_index i = j->around->first[v]; i < j->around->first[v + 1]; i++)
    {
      aqr_index w = j->around->point[i];
      double c = (double)confidence[w];
      weight += c;
      for (int k = 0; k < 6; k++)
        sum[k] += c * j->t[6 * (size_t)w + (size_t)k];
    }
    double keep = weight > 0 ? (double)confidence[v] / 2 : 1, take = weight > 0 ? (1 - keep) / weight : 0;
    for (size_t k = 0; k < 6; k++)
      j->smoothed[6 * v + k] = keep * j->t[6 * v + k] + take * sum[k];
  }
}

/* Any unit tangent where there is no principal direction, along an edge where possible: what is
 * built on the field needs a frame everywhere. */
static void complete(void* data, size_t begin, size_t end)
{
  const job* j = data;
  for (size_t v = begin; v < end; v++)
  {
    double* direction = j->field->min_direction + 3 * v;
    if (v3_norm2(v3_load(direction)) > 0.5)
      continue;
    vec3 n = v3_load(j->field->normal + 3 * v), d = v3(0, 0, 0);
    if (j->s->fan[v] != AQR_NONE)
      d = v3_unit(
        v3_reject(v3_unit(v3_sub(aqr_point(j->s, aqr_to(j->s, j->s->fan[v])), aqr_point(j->s, (aqr_index)v))), n));
    d = v3_unit(v3_reject(d, n));
    v3_store(direction, v3_norm2(d) > 0.5 ? d : any_tangent(n));
  }
}

static void copy_normals(void* data, size_t begin, size_t end)
{
  const job* j = data;
  for (size_t v = begin; v < end; v++)
  {
    vec3 n = v3_unit(v3_load(j->t + 3 * v));
    v3_store(j->field->normal + 3 * v, v3_norm2(n) > 0.5 ? n : v3(0, 0, 1));
  }
}

static bool allocate(aqr_context* c, const aqr_surface* s, aqr_field* field)
{
  size_t n = s->n_points;
  *field = (aqr_field){ 0 };
  field->normal = AQR_NEW(c, double, 3 * n);
  field->min_direction = AQR_NEW(c, double, 3 * n);
  field->k_min = AQR_NEW(c, double, n);
  field->k_max = AQR_NEW(c, double, n);
  field->cross = AQR_NEW(c, double, 3 * n);
  field->point_confidence = AQR_NEW(c, float, n);
  field->face_confidence = AQR_NEW(c, float, s->n_faces);
  return field->normal && field->min_direction && field->k_min && field->k_max && field->cross &&
         field->point_confidence && field->face_confidence;
}

static aqr_status smooth_tensors(aqr_context* c, job* j, const aqr_tensors* tensors, int iterations)
{
  aqr_status status = AQR_OK;
  size_t n = j->s->n_points;
  double* buffer[2] = { NULL, NULL };
  for (int i = 0; i < 2 && i < iterations; i++)
  {
    buffer[i] = AQR_NEW(c, double, 6 * n);
    AQR_REQUIRE(buffer[i], AQR_OUT_OF_MEMORY);
  }
  j->t = tensors->t;
  for (int i = 0; i <= iterations; i++)
  {
    double from = 0.6 * i / (iterations + 1), width = 0.2 / (iterations + 1);
    AQR_TRY(aqr_parallel(c, n, principal, j, from, from + width));
    AQR_TRY(aqr_parallel(c, j->s->n_faces, faces_confidence, j, from + width, from + 2 * width));
    AQR_TRY(aqr_parallel(c, n, points_confidence, j, from + 2 * width, from + 2 * width));
    if (i == iterations)
      break;
    j->smoothed = buffer[i % 2];
    AQR_TRY(aqr_parallel(c, n, smooth, j, from + 2 * width, from + 3 * width));
    j->t = j->smoothed;
  }
done:
  AQR_DROP(c, buffer[0], 6 * n);
  AQR_DROP(c, buffer[1], 6 * n);
  return status;
}

void aqr_field_free(aqr_context* c, const aqr_surface* s, aqr_field* field)
{
  size_t n = s->n_points;
  AQR_DROP(c, field->normal, 3 * n);
  AQR_DROP(c, field->min_direction, 3 * n);
  AQR_DROP(c, field->k_min, n);
  AQR_DROP(c, field->k_max, n);
  AQR_DROP(c, field->cross, 3 * n);
  AQR_DROP(c, field->point_confidence, n);
  AQR_DROP(c, field->face_confidence, s->n_faces);
}

aqr_status aqr_direction_field(
  aqr_context* c, const aqr_surface* s, const aqr_tensors* tensors, int iterations, double min_cosine, aqr_field* field)
{
  aqr_status status = AQR_OK;
  aqr_neighbours around = { 0 };
  job j = { .s = s, .around = &around, .field = field, .t = tensors->normal };
  AQR_REQUIRE(allocate(c, s, field), AQR_OUT_OF_MEMORY);
  AQR_TRY(aqr_parallel(c, s->n_points, copy_normals, &j, 0, 0));
  AQR_TRY(aqr_neighbours_build(c, s, &around));
  AQR_TRY(smooth_tensors(c, &j, tensors, iterations));
  AQR_TRY(aqr_parallel(c, s->n_points, complete, &j, 0.6, 0.6));
  AQR_TRY(aqr_cross_field(c, s, &around, min_cosine, field));
done:
  aqr_neighbours_free(c, &around);
  if (status != AQR_OK)
    aqr_field_free(c, s, field);
  return status;
}
