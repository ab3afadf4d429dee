/* SPDX-License-Identifier: BSD-3-Clause */
/* One run of the whole library, and what a polygon mesh must satisfy. */
#ifndef AQR_TEST_REMESH_H
#define AQR_TEST_REMESH_H

#include "shapes.h"
#include "test.h"

#include <math.h>

/* What is known of a polygon mesh once it was looked through. */
typedef struct survey
{
  const char* flaw; /* NULL: manifold, oriented, nothing degenerate, duplicated or unused */
  long euler;
  size_t loops, components, quads, faces, points;
  size_t areas_lost; /* faces whose corners lie on one line */
} survey;

typedef struct survey_edge
{
  int64_t low, high;
  size_t corner;
  bool up;
} survey_edge;

static inline int survey_order(const void* a, const void* b)
{
  const survey_edge *x = a, *y = b;
  return x->low != y->low ? (x->low > y->low) - (x->low < y->low) : (x->high > y->high) - (x->high < y->high);
}

static inline int survey_by_index(const void* a, const void* b)
{
  int64_t x = *(const int64_t*)a, y = *(const int64_t*)b;
  return (x > y) - (x < y);
}

static inline size_t survey_root(size_t* up, size_t i)
{
  while (up[i] != i)
    i = up[i] = up[up[i]];
  return i;
}

static inline const char* survey_face(const int64_t* corner, size_t n, size_t n_points)
{
  if (n < 3)
    return "a face of two corners";
  for (size_t i = 0; i < n; i++)
  {
    if (corner[i] < 0 || corner[i] >= (int64_t)n_points)
      return "a corner out of range";
    for (size_t j = 0; j < i; j++)
      if (corner[i] == corner[j])
        return "a face that meets itself";
  }
  return NULL;
}

static inline bool survey_has_area(const double* p, const int64_t* corner, size_t n)
{
  vec3 o = v3_load(p + 3 * corner[0]), area = { 0, 0, 0 };
  double reach2 = 0;
  for (size_t i = 1; i < n; i++)
  {
    vec3 a = v3_sub(v3_load(p + 3 * corner[i]), o), b = v3_sub(v3_load(p + 3 * corner[(i + 1) % n]), o);
    area = v3_add(area, v3_cross(a, b));
    reach2 = fmax(reach2, v3_norm2(a));
  }
  return v3_norm(area) > 1e-9 * reach2;
}

/* A number that tells faces with other corners apart, whichever corner comes first. */
static inline int64_t survey_name(const int64_t* corner, size_t n)
{
  uint64_t name = 0;
  for (size_t i = 0; i < n; i++)
  {
    uint64_t x = (uint64_t)corner[i] + 0x9e3779b97f4a7c15u;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    name += x ^ (x >> 31);
  }
  return (int64_t)(name >> 1);
}

static inline survey survey_polygons(
  const double* points, size_t n_points, const int64_t* offsets, size_t n_faces, const int64_t* corner)
{
  survey r = { .faces = n_faces, .points = n_points };
  size_t n = (size_t)offsets[n_faces], n_edges = 0;
  survey_edge* e = malloc((n + 1) * sizeof *e);
  size_t *twin = malloc((n + 1) * sizeof *twin), *next = malloc((n + 1) * sizeof *next);
  size_t *prev = malloc((n + 1) * sizeof *prev), *fan = malloc((n + 1) * sizeof *fan);
  size_t *up = malloc((n_points + 1) * sizeof *up), *out = calloc(n_points + 1, sizeof *out);
  size_t* at = malloc((n_points + 1) * sizeof *at);
  int64_t* names = malloc((n_faces + 1) * sizeof *names);
  for (size_t i = 0; i < n_points; i++)
    up[i] = i;
  for (size_t f = 0; f < n_faces && !r.flaw; f++)
  {
    size_t a = (size_t)offsets[f], b = (size_t)offsets[f + 1];
    r.flaw = survey_face(corner + a, b - a, n_points);
    r.areas_lost += !r.flaw && !survey_has_area(points, corner + a, b - a);
    r.quads += b - a == 4;
    names[f] = survey_name(corner + a, b - a);
    for (size_t i = a; i < b && !r.flaw; i++)
    {
      next[i] = i + 1 < b ? i + 1 : a;
      prev[next[i]] = i;
      int64_t x = corner[i], y = corner[next[i]];
      e[i] = (survey_edge){ x < y ? x : y, x < y ? y : x, i, x < y };
      up[survey_root(up, (size_t)x)] = survey_root(up, (size_t)y);
      out[x]++;
      at[x] = i;
      twin[i] = n;
    }
  }
  if (!r.flaw)
  {
    qsort(e, n, sizeof *e, survey_order);
    qsort(names, n_faces, sizeof *names, survey_by_index);
  }
  for (size_t f = 1; f < n_faces && !r.flaw; f++)
    if (names[f] == names[f - 1])
      r.flaw = "two faces over the same points";
  for (size_t i = 0, j; i < n && !r.flaw; i = j, n_edges++)
  {
    for (j = i + 1; j < n && survey_order(&e[i], &e[j]) == 0; j++)
      ;
    if (j - i > 2)
      r.flaw = "an edge of three faces";
    else if (j - i == 2 && e[i].up == e[i + 1].up)
      r.flaw = "two faces that turn against each other";
    else if (j - i == 2)
    {
      twin[e[i].corner] = e[i + 1].corner;
      twin[e[i + 1].corner] = e[i].corner;
    }
  }
  for (size_t v = 0; v < n_points && !r.flaw; v++)
  {
    if (!out[v])
    {
      r.flaw = "a point without a face";
      break;
    }
    r.components += survey_root(up, v) == v;
    size_t h = at[v], seen = 0;
    while (twin[h] != n && next[twin[h]] != at[v]) /* clockwise to the border, if there is one */
      h = next[twin[h]];
    size_t first = h;
    do
    {
      seen++;
      h = twin[prev[h]];
    } while (h != n && h != first);
    if (seen != out[v])
      r.flaw = "a point with two fans";
    fan[v] = first;
  }
  for (size_t i = 0; i < n && !r.flaw; i++)
  {
    if (twin[i] != n)
      continue;
    r.loops++;
    for (size_t h = i; twin[h] == n; h = fan[corner[next[h]]])
      twin[h] = n + 1; /* seen */
  }
  r.euler = (long)n_points - (long)n_edges + (long)n_faces;
  free(e);
  free(twin);
  free(next);
  free(prev);
  free(fan);
  free(up);
  free(out);
  free(at);
  free(names);
  return r;
}

static inline survey survey_mesh(const aqr_mesh* m)
{
  return m ? survey_polygons(m->points, m->number_of_points, m->offsets, m->number_of_faces, m->connectivity)
           : (survey){ .flaw = "no mesh" };
}

static inline survey survey_shape(const shape* m)
{
  int64_t* offsets = malloc((m->n_triangles + 1) * sizeof *offsets);
  for (size_t f = 0; f <= m->n_triangles; f++)
    offsets[f] = 3 * (int64_t)f;
  survey r = survey_polygons(m->points, m->n_points, offsets, m->n_triangles, m->triangles);
  free(offsets);
  return r;
}

/* A remesher that has run; NULL after a failure, which is counted. */
static inline aqr_remesher* remesh_with(const aqr_hooks* hooks, const shape* m, const aqr_options* o)
{
  aqr_input input = shape_input(m);
  aqr_remesher* r = NULL;
  aqr_status status = aqr_remesher_new(hooks, &r);
  if (status == AQR_OK)
    status = aqr_remesher_set_input(r, &input);
  if (status == AQR_OK)
    status = aqr_remesher_run(r, o);
  if (status != AQR_OK)
    printf("%s: %s\n", aqr_status_string(status), r ? aqr_remesher_message(r) : "");
  CHECK(status == AQR_OK);
  return r;
}
static inline aqr_remesher* remesh(const shape* m, const aqr_options* o)
{
  return remesh_with(NULL, m, o);
}

static inline aqr_options options_for_points(int64_t points)
{
  aqr_options o = aqr_default_options();
  o.density = AQR_DENSITY_POINTS;
  o.target_points = points;
  return o;
}

/* Fails the test where the mesh has a flaw or another topology than the input; prints what it is. */
static inline survey check_remesh(const char* name, const shape* m, const aqr_options* o)
{
  survey before = survey_shape(m);
  aqr_remesher* r = remesh(m, o);
  survey after = survey_mesh(r ? aqr_remesher_mesh(r) : NULL);
  printf("%s: %s, %zu points, %zu faces, %.2f quads, Euler %ld (%ld), %zu loops (%zu), %zu without area\n", name,
    after.flaw ? after.flaw : "valid", after.points, after.faces, (double)after.quads / (double)(after.faces + 1),
    after.euler, before.euler, after.loops, before.loops, after.areas_lost);
  CHECK(!after.flaw);
  CHECK(after.areas_lost <= after.faces / 100); /* corners of a face along one straight crease: few at most */
  CHECK(after.euler == before.euler && after.loops == before.loops && after.components == before.components);
  aqr_remesher_free(r);
  return after;
}

static inline uint64_t hash_bytes(uint64_t h, const void* p, size_t bytes)
{
  const unsigned char* b = p;
  for (size_t i = 0; i < bytes; i++)
    h = (h ^ b[i]) * 0x100000001b3u;
  return h;
}

/* Of everything on the four ports. */
static inline uint64_t hash_results(const aqr_remesher* r)
{
  const aqr_mesh* m = r ? aqr_remesher_mesh(r) : NULL;
  const aqr_lines_view* l = r ? aqr_remesher_lines(r) : NULL;
  const aqr_field_view* f = r ? aqr_remesher_field(r) : NULL;
  uint64_t h = 0xcbf29ce484222325u;
  if (!m || !l || !f)
    return 0;
  h = hash_bytes(h, m->points, 3 * m->number_of_points * sizeof *m->points);
  h = hash_bytes(h, m->normals, 3 * m->number_of_points * sizeof *m->normals);
  h = hash_bytes(h, m->point_kind, m->number_of_points);
  h = hash_bytes(h, m->offsets, (m->number_of_faces + 1) * sizeof *m->offsets);
  h = hash_bytes(h, m->connectivity, m->number_of_corners * sizeof *m->connectivity);
  h = hash_bytes(h, m->face_source, m->number_of_faces * sizeof *m->face_source);
  for (size_t i = 0; i < m->number_of_points; i++)
  {
    h = hash_bytes(h, m->origins[i].point, sizeof m->origins[i].point);
    h = hash_bytes(h, m->origins[i].weight, sizeof m->origins[i].weight);
  }
  h = hash_bytes(h, l->offsets, (l->number_of_lines + 1) * sizeof *l->offsets);
  h = hash_bytes(h, l->type, l->number_of_lines);
  h = hash_bytes(h, l->ends, 2 * l->number_of_lines);
  h = hash_bytes(h, l->points, 3 * l->number_of_points * sizeof *l->points);
  h = hash_bytes(h, l->isotropic, l->number_of_points);
  h = hash_bytes(h, f->min_direction, 3 * f->number_of_points * sizeof *f->min_direction);
  h = hash_bytes(h, f->max_curvature, f->number_of_points * sizeof *f->max_curvature);
  return hash_bytes(h, f->triangle_confidence, f->number_of_triangles * sizeof *f->triangle_confidence);
}

#endif
