/* SPDX-License-Identifier: BSD-3-Clause */
#include "sizing.h"

#include <string.h>

enum
{
  blur_sweeps = 4,
  solve_steps = 60
};

static const double least_spacing = 1e-4; /* along a thread without area nothing else bounds the work */
static const double finest = 0.5;         /* of the input's local size: lines closer than this would sample its noise */
static const double densest = 0.25;  /* of it: not even the user's density or largest spacing brings lines nearer */
static const double strongest = 1e3; /* factor on the spacing that the user's density has, and one over the least */
static const double least_tolerance = 1e-9, most_tolerance = 0.25;
static const double sparse =
  0.6; /* over the points asked for: a larger tolerance is not taken before the largest spacing gives way */
static const double widest = 1.5; /* of the spacing that spreads the points asked for evenly: no largest spacing below
                                     is held to */
static const double flat_bend = 0.1; /* where points are asked for, flat places share them as if so little curved */

typedef struct job
{
  const aqr_surface* s;
  const aqr_field* field;
  const aqr_sizing_options* options;
  const float* from;
  double tolerance, mean;
  aqr_sizing* sizing;
} job;

static double spacing_of(double bend, double tolerance)
{
  double room = bend > 0 ? tolerance * (2 / bend - tolerance) : INFINITY;
  return room > 0 ? 2 * sqrt(room) : 2 * tolerance; /* a bump smaller than the tolerance: its half circle */
}

static void measure(void* data, size_t begin, size_t end)
{
  job* j = data;
  for (size_t v = begin; v < end; v++)
  {
    double c = v3_dot(v3_widen(j->field->cross + 3 * v), aqr_min_direction(j->field, v));
    double c2 = fmin(1, c * c), a = fmin(fabs((double)j->field->k_min[v]), j->options->largest_bend);
    double b = fmin(fabs((double)j->field->k_max[v]), j->options->largest_bend);
    j->sizing->bend[2 * v] = (float)(a * c2 + b * (1 - c2));
    j->sizing->bend[2 * v + 1] = (float)(a * (1 - c2) + b * c2);
  }
}

/* One sweep of averaging with the neighbours, branch by branch, so that spacing does not jump along
 * a line. */
static void blur(void* data, size_t begin, size_t end)
{
  job* j = data;
  const aqr_surface* s = j->s;
  for (size_t v = begin; v < end; v++)
  {
    vec3 d = v3_widen(j->field->cross + 3 * v);
    double sum[2] = { j->from[2 * v], j->from[2 * v + 1] };
    double n = 1;
    aqr_index h = s->fan[v], first = h;
    do
    {
      size_t w = aqr_to(s, h);
      double e = fabs(v3_dot(d, v3_widen(j->field->cross + 3 * w)));
      unsigned swap = e * e < 0.5;
      sum[0] += j->from[2 * w + swap];
      sum[1] += j->from[2 * w + !swap];
      n++;
      h = aqr_next_around(s, h);
    } while (h != AQR_NONE && h != first);
    j->sizing->bend[2 * v] = (float)(sum[0] / n);
    j->sizing->bend[2 * v + 1] = (float)(sum[1] / n);
  }
}

static double curvature_at(const aqr_sizing* z, size_t v)
{
  return fmax(flat_bend, sqrt((double)z->bend[2 * v] * (double)z->bend[2 * v + 1]));
}

static void make_squarer(void* data, size_t begin, size_t end)
{
  job* j = data;
  for (size_t i = 2 * begin; i < 2 * end; i++)
  {
    double larger = fmax((double)j->from[i], (double)j->from[i ^ 1]),
           ratio = larger > 0 ? (double)j->from[i] / larger : 1;
    j->sizing->bend[i] = (float)(larger * pow(ratio, j->options->anisotropy));
  }
}

/* Points per area go with the root of the product of the curvatures. */
static void make_more_even(void* data, size_t begin, size_t end)
{
  job* j = data;
  for (size_t v = begin; v < end; v++)
  {
    double factor = pow(j->mean / curvature_at(j->sizing, v), 1 - j->options->adaptivity);
    for (size_t i = 2 * v; i < 2 * v + 2; i++)
      j->sizing->bend[i] = (float)(factor * fmax(flat_bend, (double)j->sizing->bend[i]));
  }
}

static double total_area(const aqr_sizing* sizing)
{
  double area = 0;
  for (size_t v = 0; v < sizing->n_points; v++)
    area += (double)sizing->area[v];
  return area;
}

static double mean_curvature(const aqr_sizing* z)
{
  double sum = 0, area = total_area(z);
  for (size_t v = 0; v < z->n_points; v++)
    sum += (double)z->area[v] * curvature_at(z, v);
  return area > 0 ? sum / area : 1;
}

static void ask(void* data, size_t begin, size_t end)
{
  job* j = data;
  for (size_t v = begin; v < end; v++)
  {
    const aqr_origin o = aqr_origin_of(j->s, j->s->clean[v]);
    double d = 0;
    for (int i = 0; i < 3; i++)
      d += (double)o.weight[i] * j->options->density[o.point[i]];
    j->sizing->scale[v] = (float)fmin(strongest, fmax(1 / strongest, 1 / sqrt(d)));
  }
}

static double spacing_at(const aqr_sizing* z, size_t point, unsigned branch, double tolerance)
{
  double size = sqrt((double)z->area[point]);
  double bend = greater(z->least_bend, (double)z->bend[2 * point + branch]);
  double d = lesser(greater(finest * size, spacing_of(bend, tolerance)), z->largest * z->stretch);
  d = greater(densest * size, d * (z->scale ? (double)z->scale[point] * z->unit : 1));
  return greater(least_spacing, z->coarser * d);
}

static void space(void* data, size_t begin, size_t end)
{
  job* j = data;
  for (size_t v = begin; v < end; v++)
    for (unsigned i = 0; i < 2; i++)
      j->sizing->spacing[2 * v + i] = (float)spacing_at(j->sizing, v, i, j->tolerance);
}

static void add_up_area(void* data, size_t begin, size_t end)
{
  job* j = data;
  for (size_t v = begin; v < end; v++)
  {
    double area = 0;
    aqr_index h = j->s->fan[v], first = h;
    do
    {
      area += v3_norm(aqr_face_cross(j->s, aqr_face_of(h)));
      h = aqr_next_around(j->s, h);
    } while (h != AQR_NONE && h != first);
    j->sizing->area[v] = (float)(area / 6);
  }
}

static aqr_status fill(aqr_context* c, const aqr_surface* s, double tolerance, aqr_sizing* sizing)
{
  job j = { .s = s, .tolerance = tolerance, .sizing = sizing };
  return aqr_parallel(c, s->n_points, space, &j, 0, 0);
}

aqr_status aqr_sizing_set(aqr_context* c, const aqr_surface* s, double tolerance, aqr_sizing* sizing)
{
  sizing->least_bend = 0;
  sizing->stretch = sizing->unit = 1;
  return fill(c, s, tolerance, sizing);
}

size_t aqr_sizing_bounded(const aqr_sizing* sizing)
{
  size_t n = 0;
  for (size_t v = 0; v < sizing->n_points; v++)
    n += sizing->largest * sizing->largest < densest * densest * (double)sizing->area[v];
  return n;
}

double aqr_sizing_predict(const aqr_sizing* sizing, double tolerance)
{
  double points = 0;
  for (size_t v = 0; v < sizing->n_points; v++)
    points += (double)sizing->area[v] / (spacing_at(sizing, v, 0, tolerance) * spacing_at(sizing, v, 1, tolerance));
  return points;
}

/* The root of it: where a number of points is asked for, only what one place has against another counts. */
static double average_density(const aqr_sizing* sizing)
{
  double points = 0, area = sizing->scale ? total_area(sizing) : 0;
  for (size_t v = 0; sizing->scale && v < sizing->n_points; v++)
    points += (double)sizing->area[v] / ((double)sizing->scale[v] * (double)sizing->scale[v]);
  return area > 0 ? sqrt(points / area) : 1;
}

/* What the largest spacing is stretched by where points are few: as far as they do not suffice for it, and at least so
 * far that curved places may have more than their share of them. */
static double stretch_for(const aqr_sizing* sizing, double points)
{
  double short_of = aqr_sizing_predict(sizing, fmin(most_tolerance, sparse / points)) / points;
  double wide = widest * sqrt(total_area(sizing) / points) / (sizing->coarser * sizing->largest);
  return fmax(fmax(1, sqrt(short_of)), wide);
}

/* The prediction falls as the tolerance grows: halving on a logarithmic scale, sped up by how nearly it is in inverse
 * proportion. */
aqr_status aqr_sizing_solve(aqr_context* c, const aqr_surface* s, double points, aqr_sizing* sizing, double* tolerance)
{
  double low = log(least_tolerance), high = log(most_tolerance), guess = log(1e-4);
  sizing->least_bend = flat_bend;
  sizing->stretch = 1;
  sizing->unit = average_density(sizing);
  sizing->stretch = stretch_for(sizing, points);
  for (int i = 0; i < solve_steps && high - low > 1e-4; i++)
  {
    if (!aqr_step(c, 0))
      return AQR_CANCELLED;
    double off = log(aqr_sizing_predict(sizing, exp(guess)) / points);
    if (off > 0)
      low = guess;
    else
      high = guess;
    if (fabs(off) < 1e-4)
      break;
    guess += off;
    if (!(guess > low && guess < high))
      guess = (low + high) / 2;
  }
  *tolerance = exp(guess);
  return fill(c, s, *tolerance, sizing);
}

void aqr_sizing_at(const aqr_surface* s, const aqr_field* field, const aqr_sizing* sizing, aqr_index face, vec3 d,
  double* along, double* across)
{
  double a[2] = { 0, 0 };
  for (unsigned i = 0; i < 3; i++)
  {
    size_t v = s->corner[3 * face + i];
    double e = fabs(v3_dot(d, v3_widen(field->cross + 3 * v)));
    unsigned swap = e * e < 0.5;
    a[0] += (double)sizing->spacing[2 * v + swap];
    a[1] += (double)sizing->spacing[2 * v + !swap];
  }
  *along = a[0] / 3;
  *across = a[1] / 3;
}

double aqr_sizing_scale(const aqr_surface* s, const aqr_sizing* sizing, aqr_index face)
{
  double scale = 0;
  for (unsigned i = 0; sizing->scale && i < 3; i++)
    scale += (double)sizing->scale[s->corner[3 * face + i]] / 3;
  return sizing->scale ? scale : 1;
}

aqr_status aqr_sizing_build(
  aqr_context* c, const aqr_surface* s, const aqr_field* field, const aqr_sizing_options* options, aqr_sizing* sizing)
{
  memset(sizing, 0, sizeof *sizing);
  sizing->n_points = s->n_points;
  sizing->largest = options->largest_spacing;
  sizing->coarser = options->coarser;
  sizing->stretch = sizing->unit = 1;
  aqr_status status = AQR_OK;
  float* from = AQR_NEW(c, float, 2 * s->n_points);
  sizing->bend = AQR_NEW(c, float, 2 * s->n_points);
  sizing->spacing = AQR_NEW(c, float, 2 * s->n_points);
  sizing->area = AQR_NEW(c, float, s->n_points);
  AQR_REQUIRE(from && sizing->bend && sizing->spacing && sizing->area, AQR_OUT_OF_MEMORY);
  job j = { .s = s, .field = field, .options = options, .from = from, .sizing = sizing };
  if (options->density)
  {
    sizing->scale = AQR_NEW(c, float, s->n_points);
    AQR_REQUIRE(sizing->scale, AQR_OUT_OF_MEMORY);
    AQR_TRY(aqr_parallel(c, s->n_points, ask, &j, 0, 0));
  }
  AQR_TRY(aqr_parallel(c, s->n_points, add_up_area, &j, 0, 0.1));
  AQR_TRY(aqr_parallel(c, s->n_points, measure, &j, 0.1, 0.2));
  for (int i = 0; i < blur_sweeps; i++)
  {
    memcpy(from, sizing->bend, 2 * s->n_points * sizeof *from);
    AQR_TRY(aqr_parallel(c, s->n_points, blur, &j, 0.2, 1));
  }
  if (options->anisotropy < 1)
  {
    memcpy(from, sizing->bend, 2 * s->n_points * sizeof *from);
    AQR_TRY(aqr_parallel(c, s->n_points, make_squarer, &j, 1, 1));
  }
  if (options->adaptivity < 1)
  {
    j.mean = mean_curvature(sizing);
    AQR_TRY(aqr_parallel(c, s->n_points, make_more_even, &j, 1, 1));
  }
done:
  AQR_DROP(c, from, 2 * s->n_points);
  if (status != AQR_OK)
    aqr_sizing_free(c, sizing);
  return status;
}

void aqr_sizing_free(aqr_context* c, aqr_sizing* sizing)
{
  AQR_DROP(c, sizing->bend, 2 * sizing->n_points);
  AQR_DROP(c, sizing->spacing, 2 * sizing->n_points);
  AQR_DROP(c, sizing->area, sizing->n_points);
  AQR_DROP(c, sizing->scale, sizing->n_points);
  memset(sizing, 0, sizeof *sizing);
}
