/* SPDX-License-Identifier: BSD-3-Clause */
/* Principal frames, their confidence and confidence-weighted smoothing (paper 4.1). The confidence
 * that weights an iteration is that of the field it smooths, as the paper prints it, so directions
 * spread further into isotropic regions with every iteration. */
#include "cross_field.h"
#include "flatten.h"

/* Curvature differences below this are rounding of the tensors, no direction: the scaled surface would turn by less
 * than this many radians from end to end. */
static const double least_difference = 1e-6;

typedef struct job
{
  const aqr_surface* s;
  const aqr_neighbours* around;
  const float* t;
  float* smoothed;
  aqr_rotor* direction; /* per point: the minimum direction in the point's frame; 0 where there is none */
  aqr_rotor* corner;    /* per half-edge: turns the frame at its start into its face's plane; 0 without a plane */
  aqr_field* field;
} job;

/* The same in every iteration, as the normals are. */
static aqr_frame frame_at(const aqr_field* field, size_t v)
{
  return aqr_frame_on(v3_load(field->normal + 3 * v));
}

typedef struct principal
{
  double k_min, k_max;
  aqr_complex min_direction; /* in the frame; 0 where there is none */
} principal;

static double apply(const float* f, vec3 a, vec3 b)
{
  double t[6];
  for (int i = 0; i < 6; i++)
    t[i] = (double)f[i];
  return t[0] * a.x * b.x + t[1] * a.y * b.y + t[2] * a.z * b.z + t[3] * (a.x * b.y + a.y * b.x) +
         t[4] * (a.x * b.z + a.z * b.x) + t[5] * (a.y * b.z + a.z * b.y);
}

/* Of the tensor in the plane of the averaged normal. Its eigenvectors are swapped, as normal cycles
 * have them: the larger curvature comes along the minimum direction. */
static principal principal_of(const float* t, aqr_frame at)
{
  double a = apply(t, at.x, at.x), b = apply(t, at.y, at.y), off = apply(t, at.x, at.y);
  double mean = (a + b) / 2, d = (a - b) / 2, half = sqrt(d * d + off * off);
  principal p = { mean - half, mean + half, cx(0, 0) };
  if (2 * half > least_difference * (1 + fabs(mean)))
    p.min_direction = cx_unit(d >= 0 ? cx(half + d, off) : cx(fabs(off), copysign(half - d, off)));
  return p;
}

static void find_directions(void* data, size_t begin, size_t end)
{
  const job* j = data;
  for (size_t v = begin; v < end; v++)
    j->direction[v] = cx_narrow(principal_of(j->t + 6 * v, frame_at(j->field, v)).min_direction);
}

static void turn_corners(void* data, size_t begin, size_t end)
{
  const job* j = data;
  for (size_t f = begin; f < end; f++)
  {
    vec3 p[3], e[3];
    for (unsigned i = 0; i < 3; i++)
      p[i] = aqr_point(j->s, j->s->corner[3 * f + i]);
    for (unsigned i = 0; i < 3; i++)
      e[i] = v3_sub(p[(i + 1) % 3], p[i]);
    double base = v3_norm(e[0]), cross = v3_norm(v3_cross(e[0], e[1])), along = v3_dot(e[1], e[0]);
    bool flat = base > 0 && cross > 0;
    double x = flat ? along / base : 0, y = flat ? cross / base : 0;
    aqr_complex q[3] = { cx(base, 0), cx(x, y), cx(-base - x, -y) };
    for (unsigned i = 0; i < 3; i++)
    {
      size_t v = j->s->corner[3 * f + i];
      unsigned k = (i + 2) % 3;
      aqr_complex turn = aqr_flatten(v3_load(j->field->normal + 3 * v), frame_at(j->field, v).x, e[i],
        v3_scale(e[k], -1), q[i], cx(-q[k].x, -q[k].y));
      j->corner[3 * f + i] = flat ? cx_narrow(turn) : (aqr_rotor){ 0, 0 };
    }
  }
}

/* Equation 1; 0 where a corner has no direction. */
static void faces_confidence(void* data, size_t begin, size_t end)
{
  const job* j = data;
  for (size_t f = begin; f < end; f++)
  {
    aqr_complex d[3];
    for (unsigned i = 0; i < 3; i++)
      d[i] = cx_mul(cx_wide(j->corner[3 * f + i]), cx_wide(j->direction[j->s->corner[3 * f + i]]));
    double a = fabs(d[0].x * d[1].x + d[0].y * d[1].y), b = fabs(d[1].x * d[2].x + d[1].y * d[2].y),
           c = fabs(d[2].x * d[0].x + d[2].y * d[0].y), least = a < b ? a : b;
    least = least < c ? least : c;
    j->field->face_confidence[f] = least < 1 ? (float)least : 1;
  }
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
        sum[k] += c * (double)j->t[6 * (size_t)w + (size_t)k];
    }
    double keep = weight > 0 ? (double)confidence[v] / 2 : 1, take = weight > 0 ? (1 - keep) / weight : 0;
    for (size_t k = 0; k < 6; k++)
      j->smoothed[6 * v + k] = (float)(keep * (double)j->t[6 * v + k] + take * sum[k]);
  }
}

/* The final frames. Where there is no principal direction an edge takes its place: what is built on
 * the field needs a frame everywhere. */
static void store(void* data, size_t begin, size_t end)
{
  const job* j = data;
  for (size_t v = begin; v < end; v++)
  {
    aqr_frame at = frame_at(j->field, v);
    principal p = principal_of(j->t + 6 * v, at);
    aqr_complex d = p.min_direction;
    if (d.x == 0 && d.y == 0)
    {
      vec3 edge = v3(0, 0, 0);
      if (j->s->fan[v] != AQR_NONE)
        edge = v3_sub(aqr_point(j->s, aqr_to(j->s, j->s->fan[v])), aqr_point(j->s, (aqr_index)v));
      d = cx_unit(cx(v3_dot(edge, at.x), v3_dot(edge, at.y)));
    }
    j->field->k_min[v] = (float)p.k_min;
    j->field->k_max[v] = (float)p.k_max;
    j->field->direction[v] = cx_narrow(d);
  }
}

static bool allocate(aqr_context* c, const aqr_surface* s, aqr_field* field)
{
  size_t n = s->n_points;
  *field = (aqr_field){ 0 };
  field->direction = AQR_NEW(c, aqr_rotor, n);
  field->k_min = AQR_NEW(c, float, n);
  field->k_max = AQR_NEW(c, float, n);
  field->cross = AQR_NEW(c, float, 3 * n);
  field->flat = AQR_NEW(c, aqr_short_rotor, 3 * s->n_faces);
  field->point_confidence = AQR_NEW(c, float, n);
  field->face_confidence = AQR_NEW(c, float, s->n_faces);
  return field->direction && field->k_min && field->k_max && field->cross && field->flat && field->point_confidence &&
         field->face_confidence;
}

static aqr_status smooth_tensors(aqr_context* c, job* j, const aqr_tensors* tensors, int iterations)
{
  aqr_status status = AQR_OK;
  size_t n = j->s->n_points, n_faces = j->s->n_faces;
  float* buffer[2] = { NULL, NULL };
  j->direction = AQR_NEW(c, aqr_rotor, n);
  j->corner = AQR_NEW(c, aqr_rotor, 3 * n_faces);
  AQR_REQUIRE(j->direction && j->corner, AQR_OUT_OF_MEMORY);
  for (int i = 0; i < 2 && i < iterations; i++)
  {
    buffer[i] = AQR_NEW(c, float, 6 * n);
    AQR_REQUIRE(buffer[i], AQR_OUT_OF_MEMORY);
  }
  AQR_TRY(aqr_parallel(c, n_faces, turn_corners, j, 0, 0.1));
  j->t = tensors->t;
  for (int i = 0; i <= iterations; i++)
  {
    double from = 0.1 + 0.5 * i / (iterations + 1), middle = from + 0.25 / (iterations + 1);
    AQR_TRY(aqr_parallel(c, n, find_directions, j, from, middle));
    AQR_TRY(aqr_parallel(c, n_faces, faces_confidence, j, middle, middle));
    AQR_TRY(aqr_parallel(c, n, points_confidence, j, middle, middle));
    if (i == iterations)
      break;
    j->smoothed = buffer[i % 2];
    AQR_TRY(aqr_parallel(c, n, smooth, j, middle, from + 0.5 / (iterations + 1)));
    j->t = j->smoothed;
  }
  AQR_TRY(aqr_parallel(c, n, store, j, 0.6, 0.6));
done:
  AQR_DROP(c, buffer[0], 6 * n);
  AQR_DROP(c, buffer[1], 6 * n);
  AQR_DROP(c, j->direction, n);
  AQR_DROP(c, j->corner, 3 * n_faces);
  return status;
}

void aqr_field_free(aqr_context* c, const aqr_surface* s, aqr_field* field)
{
  size_t n = s->n_points;
  field->normal = NULL;
  field->noise = NULL;
  AQR_DROP(c, field->direction, n);
  AQR_DROP(c, field->k_min, n);
  AQR_DROP(c, field->k_max, n);
  AQR_DROP(c, field->cross, 3 * n);
  AQR_DROP(c, field->flat, 3 * s->n_faces);
  AQR_DROP(c, field->point_confidence, n);
  AQR_DROP(c, field->face_confidence, s->n_faces);
}

aqr_status aqr_direction_field(
  aqr_context* c, const aqr_surface* s, const aqr_tensors* tensors, int iterations, double min_cosine, aqr_field* field)
{
  aqr_status status = AQR_OK;
  aqr_neighbours around = { 0 };
  job j = { .s = s, .around = &around, .field = field };
  AQR_REQUIRE(allocate(c, s, field), AQR_OUT_OF_MEMORY);
  field->normal = tensors->normal;
  field->noise = tensors->noise;
  AQR_TRY(aqr_neighbours_build(c, s, &around));
  AQR_TRY(smooth_tensors(c, &j, tensors, iterations));
  AQR_TRY(aqr_cross_field(c, s, &around, min_cosine, field));
done:
  aqr_neighbours_free(c, &around);
  if (status != AQR_OK)
    aqr_field_free(c, s, field);
  return status;
}
