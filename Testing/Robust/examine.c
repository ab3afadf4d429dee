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

/* A box, and a margin as a share of its diagonal. */
typedef struct box
{
  double low[3], high[3], diagonal;
} box;

static box no_box(void)
{
  return (box){ { INFINITY, INFINITY, INFINITY }, { -INFINITY, -INFINITY, -INFINITY }, 0 };
}

static void widen(box* b, const double* p)
{
  b->diagonal = 0;
  for (int k = 0; k < 3; k++)
  {
    b->low[k] = fmin(b->low[k], p[k]);
    b->high[k] = fmax(b->high[k], p[k]);
    b->diagonal = hypot(b->diagonal, b->high[k] - b->low[k]);
  }
}

static int holds(const box* b, const double* points, size_t n_points, double share)
{
  for (size_t i = 0; i < 3 * n_points; i++)
    if (!(points[i] >= b->low[i % 3] - share * b->diagonal && points[i] <= b->high[i % 3] + share * b->diagonal))
      return 0;
  return 1;
}

static judge_plane plane_of(const aqr_options* o)
{
  judge_plane p;
  const double* n = o->symmetry_normal;
  double most = fmax(fmax(fabs(n[0]), fabs(n[1])), fabs(n[2]));
  double length = hypot(hypot(n[0] / most, n[1] / most), n[2] / most);
  for (int k = 0; k < 3; k++)
  {
    p.origin[k] = o->symmetry_origin[k];
    p.normal[k] = n[k] / most / length;
  }
  return p;
}

static void mirror_point(const judge_plane* plane, const double* p, double* q)
{
  double d = judge_height(plane, p);
  for (int k = 0; k < 3; k++)
    q[k] = p[k] - 2 * d * plane->normal[k];
}

static const char* check_box(const aqr_mesh* m, const aqr_field_view* f, const aqr_options* o)
{
  box b = no_box();
  const judge_plane plane = plane_of(o);
  for (size_t i = 0; i < f->number_of_points; i++)
  {
    double image[3];
    widen(&b, f->points + 3 * i);
    mirror_point(&plane, f->points + 3 * i, image);
    if (o->symmetry)
      widen(&b, image);
  }
  return holds(&b, m->points, m->number_of_points, stray) ? NULL : "a point lies outside the bounding box";
}

static const char* check_cleaned_box(const aqr_field_view* f, const aqr_input* input, const aqr_options* o)
{
  /* a corner near a plane of symmetry is moved onto it: by a hundredth of an edge at most, which is no longer than a
   * fortieth of the diagonal */
  const double margin = o->symmetry ? 3e-4 : 1e-5;
  box b = no_box();
  for (size_t i = 0; i < 3 * input->number_of_triangles; i++)
  {
    size_t v = 3 * (size_t)input->triangles[i];
    double p[3];
    for (size_t k = 0; k < 3; k++)
      p[k] = input->points_f ? (double)input->points_f[v + k] : input->points_d[v + k];
    widen(&b, p);
  }
  return holds(&b, f->points, f->number_of_points, margin) ? NULL : "the surface leaves the bounding box of the input";
}

enum
{
  most_compared = 1500 /* points, each with all */
};

static const char* check_symmetry(const aqr_mesh* m, const aqr_options* o)
{
  const judge_plane plane = plane_of(o);
  size_t n = m->number_of_points;
  box b = no_box();
  double reach = 0;
  for (size_t i = 0; i < n; i++)
  {
    widen(&b, m->points + 3 * i);
    for (int k = 0; k < 3; k++)
      reach = fmax(reach, fmax(fabs(m->points[3 * i + (size_t)k]), fabs(o->symmetry_origin[k])));
  }
  double near = fmax(1e-9 * b.diagonal, 1e-14 * reach);
  for (size_t i = 0; i < n && n <= most_compared; i++)
  {
    double q[3];
    mirror_point(&plane, m->points + 3 * i, q);
    size_t j = 0;
    while (j < n && !(fabs(m->points[3 * j] - q[0]) <= near && fabs(m->points[3 * j + 1] - q[1]) <= near &&
                      fabs(m->points[3 * j + 2] - q[2]) <= near))
      j++;
    if (j == n)
      return "a point has no mirror image";
  }
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

/* With symmetry the field is that of a half, and the surface that half and its image. */
static verdict judge_surface(const aqr_field_view* f, const aqr_options* o)
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
    const judge_plane plane = plane_of(o);
    v = o->symmetry ? judge_mirrored(f->number_of_points, f->points, n, offsets, corners, &plane)
                    : judge_mesh(f->number_of_points, f->points, n, offsets, corners);
  }
  free(offsets);
  free(corners);
  return v;
}

const char* examine_results(const aqr_mesh* m, const aqr_field_view* f, const aqr_report* report,
  const aqr_input* input, const aqr_options* options)
{
  verdict surface = judge_surface(f, options);
  verdict mesh = judge_mesh(m->number_of_points, m->points, m->number_of_faces, m->offsets, m->connectivity);
  const char* fault = mesh.fault ? mesh.fault : surface.fault;
  if (!fault && options->preserve_topology && !(options->symmetry && report->topology_lost))
    fault = judge_pair(&surface, &mesh);
  if (!fault && !options->symmetry && surface.boundary_loops != report->boundary_loops)
    fault = "the report's boundary loops are not those of the surface";
  if (!fault && !options->symmetry && surface.components != report->components)
    fault = "the report's components are not those of the surface";
  if (!fault)
    fault = check_attributes(m, input);
  if (!fault)
    fault = check_field(f);
  if (!fault)
    fault = check_box(m, f, options);
  if (!fault)
    fault = check_cleaned_box(f, input, options);
  if (!fault && options->symmetry)
    fault = check_symmetry(m, options);
  if (fault)
    fprintf(stderr,
      "surface: %zu points, Euler %ld, %zu loops, %zu components; mesh: %zu points, %ld, %zu, %zu; "
      "report: %zu loops, %zu components; %s\n",
      f->number_of_points, surface.euler, surface.boundary_loops, surface.components, m->number_of_points, mesh.euler,
      mesh.boundary_loops, mesh.components, report->boundary_loops, report->components,
      surface.fault ? "the surface is at fault" : fault);
  return fault;
}

/* `cleaned`: what set_input reported of the whole input. */
static const char* check_results(
  const aqr_remesher* r, const aqr_input* input, const aqr_options* o, const aqr_report* cleaned)
{
  const aqr_report* report = aqr_remesher_report(r);
  const aqr_mesh* m = aqr_remesher_mesh(r);
  const aqr_field_view* f = aqr_remesher_field(r);
  if (!m || !f || !aqr_remesher_lines(r))
    return "no result after success";
  if (report->boundary_loops != cleaned->boundary_loops || report->components != cleaned->components)
    return "the run changed the report on the input";
  return examine_results(m, f, report, input, o);
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
  aqr_report cleaned = { 0 };
  if (*status == AQR_OK)
  {
    cleaned = *aqr_remesher_report(r);
    *status = aqr_remesher_run(r, options);
  }
  if (*status == AQR_INTERNAL)
    fault = "an invariant of the library did not hold";
  else if (*status == AQR_OK)
  {
    fault = check_results(r, input, options, &cleaned);
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
