/* SPDX-License-Identifier: BSD-3-Clause */
#include "examine.h"

#include "judge.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct purse
{
  size_t held;
  int backwards;
} purse;

static const size_t most_bytes = (size_t)1 << 30;

static void* count_bytes(void* user, void* old, size_t old_bytes, size_t bytes)
{
  purse* p = user;
  if (bytes > most_bytes || p->held - old_bytes > most_bytes - bytes)
    return NULL;
  void* grown = NULL;
  if (bytes)
    grown = realloc(old, bytes);
  else
    free(old);
  if (grown || !bytes)
    p->held = p->held - old_bytes + bytes;
  return grown;
}

/* Small ranges, the last one first in one of the two runs. */
static void in_ranges(void* user, size_t count, size_t grain, void (*body)(void*, size_t, size_t), void* data)
{
  const purse* p = user;
  size_t width = grain < 64 ? grain : 64, n = (count + width - 1) / width;
  for (size_t i = 0; i < n; i++)
  {
    size_t begin = (p->backwards ? n - 1 - i : i) * width;
    body(data, begin, begin + width < count ? begin + width : count);
  }
}

static uint64_t hash_bytes(uint64_t h, const void* data, size_t n)
{
  const unsigned char* bytes = data;
  for (size_t i = 0; i < n; i++)
    h = (h ^ bytes[i]) * 0x100000001b3u;
  return h;
}

static uint64_t hash_results(const aqr_remesher* r)
{
  const aqr_mesh* m = aqr_remesher_mesh(r);
  const aqr_lines_view* l = aqr_remesher_lines(r);
  const aqr_field_view* f = aqr_remesher_field(r);
  uint64_t h = 0xcbf29ce484222325u;
  h = hash_bytes(h, m->points, 3 * m->number_of_points * sizeof(double));
  h = hash_bytes(h, m->normals, 3 * m->number_of_points * sizeof(double));
  h = hash_bytes(h, m->offsets, (m->number_of_faces + 1) * sizeof(int64_t));
  h = hash_bytes(h, m->connectivity, m->number_of_corners * sizeof(int64_t));
  h = hash_bytes(h, l->points, 3 * l->number_of_points * sizeof(double));
  h = hash_bytes(h, l->type, l->number_of_lines);
  h = hash_bytes(h, f->min_direction, 3 * f->number_of_points * sizeof(double));
  return hash_bytes(h, f->triangles, 3 * f->number_of_triangles * sizeof(aqr_index));
}

/* Points stray from the surface by about the height of the arc above an edge. */
static const double stray = 0.1;

static const char* check_box(const aqr_mesh* m, const aqr_field_view* f)
{
  double low[3] = { INFINITY, INFINITY, INFINITY }, high[3] = { -INFINITY, -INFINITY, -INFINITY }, margin = 0;
  for (size_t i = 0; i < 3 * f->number_of_points; i++)
  {
    low[i % 3] = fmin(low[i % 3], f->points[i]);
    high[i % 3] = fmax(high[i % 3], f->points[i]);
  }
  for (int k = 0; k < 3; k++)
    margin = hypot(margin, high[k] - low[k]);
  margin *= stray;
  for (size_t i = 0; i < 3 * m->number_of_points; i++)
    if (!(m->points[i] >= low[i % 3] - margin && m->points[i] <= high[i % 3] + margin))
      return "a point lies outside the bounding box";
  return NULL;
}

static int unit(const double* v)
{
  return fabs(v[0] * v[0] + v[1] * v[1] + v[2] * v[2] - 1) < 1e-6;
}

static const char* check_attributes(const aqr_mesh* m, const aqr_input* input)
{
  for (size_t i = 0; i < m->number_of_points; i++)
  {
    const aqr_origin* o = &m->origins[i];
    float sum = 0;
    for (int k = 0; k < 3; k++)
    {
      if (o->point[k] >= input->number_of_points || !(o->weight[k] >= 0))
        return "an origin is no point of the input";
      sum += o->weight[k];
    }
    if (!(fabsf(sum - 1) < 1e-4F))
      return "weights of an origin do not add up to one";
    if (!unit(m->normals + 3 * i))
      return "a normal is not of unit length";
  }
  for (size_t i = 0; i < m->number_of_faces; i++)
    if (m->face_source[i] >= input->number_of_triangles)
      return "a face has no source";
  return NULL;
}

static const char* check_field(const aqr_field_view* f)
{
  for (size_t i = 0; i < f->number_of_points; i++)
  {
    if (!unit(f->normals + 3 * i) || !unit(f->min_direction + 3 * i) || !unit(f->max_direction + 3 * i))
      return "a direction is not of unit length";
    if (!(f->min_curvature[i] <= f->max_curvature[i]))
      return "curvatures are not in order";
  }
  return NULL;
}

static verdict judge_surface(const aqr_field_view* f)
{
  size_t n = f->number_of_triangles;
  int64_t* offsets = malloc((n + 1) * sizeof *offsets);
  int64_t* corners = malloc(3 * n * sizeof *corners);
  verdict v = { "the judge has no memory", 0, 0, 0 };
  if (offsets && corners)
  {
    for (size_t i = 0; i <= n; i++)
      offsets[i] = (int64_t)(3 * i);
    for (size_t i = 0; i < 3 * n; i++)
      corners[i] = f->triangles[i];
    v = judge_mesh(f->number_of_points, f->points, n, offsets, corners);
  }
  free(offsets);
  free(corners);
  return v;
}

const char* examine_results(const aqr_mesh* m, const aqr_field_view* f, const aqr_report* report,
  const aqr_input* input, const aqr_options* options)
{
  verdict surface = judge_surface(f);
  verdict mesh = judge_mesh(m->number_of_points, m->points, m->number_of_faces, m->offsets, m->connectivity);
  const char* fault = mesh.fault ? mesh.fault : surface.fault;
  if (!fault && options->preserve_topology)
    fault = judge_pair(&surface, &mesh);
  if (!fault && surface.boundary_loops != report->boundary_loops)
    fault = "the report's boundary loops are not those of the surface";
  if (!fault && surface.components != report->components)
    fault = "the report's components are not those of the surface";
  if (!fault)
    fault = check_attributes(m, input);
  if (!fault)
    fault = check_field(f);
  if (!fault)
    fault = check_box(m, f);
  if (fault)
    fprintf(stderr,
      "surface: %zu points, Euler %ld, %zu loops, %zu components; mesh: %zu points, %ld, %zu, %zu; "
      "report: %zu loops, %zu components; %s\n",
      f->number_of_points, surface.euler, surface.boundary_loops, surface.components, m->number_of_points, mesh.euler,
      mesh.boundary_loops, mesh.components, report->boundary_loops, report->components,
      surface.fault ? "the surface is at fault" : fault);
  return fault;
}

static const char* check_results(const aqr_remesher* r, const aqr_input* input, const aqr_options* o)
{
  const aqr_mesh* m = aqr_remesher_mesh(r);
  const aqr_field_view* f = aqr_remesher_field(r);
  if (!m || !f || !aqr_remesher_lines(r))
    return "no result after success";
  return examine_results(m, f, aqr_remesher_report(r), input, o);
}

static const char* run_once(
  const aqr_input* input, const aqr_options* options, int backwards, aqr_status* status, uint64_t* hash)
{
  purse p = { 0, backwards };
  aqr_hooks hooks = { &p, count_bytes, NULL, in_ranges };
  aqr_remesher* r = NULL;
  const char* fault = NULL;
  *hash = 0;
  *status = aqr_remesher_new(&hooks, &r);
  if (*status == AQR_OK)
    *status = aqr_remesher_set_input(r, input);
  if (*status == AQR_OK)
    *status = aqr_remesher_run(r, options);
  if (*status == AQR_INTERNAL)
    fault = "an invariant of the library did not hold";
  else if (*status == AQR_OK)
  {
    fault = check_results(r, input, options);
    if (!fault)
      *hash = hash_results(r);
  }
  else if (r && (aqr_remesher_mesh(r) || aqr_remesher_field(r) || aqr_remesher_lines(r)))
    fault = "a result after a failure";
  aqr_remesher_free(r);
  return fault || !p.held ? fault : "memory was left behind";
}

const char* examine(const aqr_input* input, const aqr_options* options, aqr_status* status)
{
  uint64_t hash[2];
  aqr_status again;
  const char* fault = run_once(input, options, 0, status, &hash[0]);
  if (!fault)
    fault = run_once(input, options, 1, &again, &hash[1]);
  if (!fault && (again != *status || hash[0] != hash[1]))
    fault = "two runs differ";
  return fault;
}
