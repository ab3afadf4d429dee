/* SPDX-License-Identifier: BSD-3-Clause */
/* From the scaled working surface back to the caller's coordinates and indices. */
#include "pipeline.h"

#include <string.h>

/* The views are read-only for callers; here their arrays are filled and released. */
#define WRITABLE(type, p) ((type*)(uintptr_t)(p))
#define DROP_VIEW(c, type, p, count) (aqr_release(c, WRITABLE(type, p), count, sizeof(type)), (p) = NULL)

static void unscale(const aqr_surface* s, vec3 p, double* out)
{
  v3_store(out, v3_madd(s->centre, s->diagonal, p));
}

/* Weights over input points of a place on the working surface: all its corners lie on one input triangle, so that three
 * points suffice. */
static aqr_origin origin_of(const aqr_surface* s, const aqr_place* at)
{
  aqr_index point[9] = { 0 };
  double weight[9], sum = 0;
  unsigned n = 0;
  for (unsigned k = 0; k < 3; k++)
  {
    const aqr_origin o = aqr_origin_of(s, s->clean[s->corner[3 * at->face + k]]);
    for (unsigned i = 0; i < 3; i++)
    {
      double w = at->bary[k] * (double)o.weight[i];
      unsigned j = 0;
      while (j < n && point[j] != o.point[i])
        j++;
      if (j == n)
      {
        point[n] = o.point[i];
        weight[n++] = 0;
      }
      weight[j] += w;
    }
  }
  aqr_origin r = { { point[0], point[0], point[0] }, { 0, 0, 0 }, s->source[at->face] };
  for (unsigned i = 0; i < 3 && n; i++)
  {
    unsigned best = 0;
    for (unsigned j = 1; j < n; j++)
      if (weight[j] > weight[best])
        best = j;
    r.point[i] = point[best];
    r.weight[i] = (float)weight[best];
    sum += weight[best];
    n--;
    point[best] = point[n];
    weight[best] = weight[n];
  }
  for (unsigned i = 0; i < 3; i++)
    r.weight[i] = sum > 0 ? (float)((double)r.weight[i] / sum) : (i == 0);
  return r;
}

static vec3 mirror(const aqr_plane* plane, vec3 p)
{
  return v3_madd(p, -2 * aqr_plane_height(plane, p), plane->normal);
}

/* A vertex of the half's border becomes one inside the whole: exactly on the plane, and of the kind that the creases
 * and borders that meet it there and their mirror images make it. */
static void put_on_plane(
  const aqr_remesher* r, const aqr_plane* plane, aqr_index v, double* point, double* normal, uint8_t* kind)
{
  const aqr_polygon_mesh* m = &r->polygons;
  aqr_index h = m->vertices[v].out;
  unsigned features = 0;
  bool border = false;
  vec3 p = v3_load(point), n = v3_load(normal);
  do
  {
    if (aqr_pm_face(m, h) == AQR_NONE || aqr_pm_face(m, h ^ 1) == AQR_NONE)
      border |= !aqr_symmetry_on_plane(r->surface, m, aqr_pm_to(m, h));
    else
      features += m->edge_type[h >> 1] == AQR_LINE_FEATURE;
    h = aqr_pm_next_around(m, h);
  } while (h != m->vertices[v].out);
  bool ridge = r->done.feature_lines && aqr_plane_creases(plane, n);
  v3_store(point, v3_madd(p, -aqr_plane_height(plane, p), plane->normal));
  v3_store(normal, aqr_plane_normal(plane, n));
  if (border)
    *kind = features ? AQR_VERTEX_CORNER : AQR_VERTEX_BOUNDARY;
  else if (ridge || features)
    *kind = features > (ridge ? 0 : 1) ? AQR_VERTEX_CORNER : AQR_VERTEX_FEATURE;
  else
    *kind = AQR_VERTEX_INTERIOR;
}

/* The mesh of the half becomes the first part of the whole; without symmetry it is all. */
typedef struct mesh_job
{
  const aqr_remesher* r;
  bool mirrored;
  aqr_plane plane;
  aqr_index *id, *image; /* per vertex: its point, and the point at its mirror image */
  size_t n_points, n_faces, n_corners, half_faces, half_corners;
  double *points, *normals;
  aqr_origin* origins;
  uint8_t* kind;
  int64_t *offsets, *connectivity;
  aqr_index* source;
} mesh_job;

static void number_points(mesh_job* j)
{
  const aqr_polygon_mesh* m = &j->r->polygons;
  for (size_t v = 0; v < m->n_vertices; v++)
    j->id[v] = m->vertices[v].out == AQR_NONE ? AQR_NONE : (aqr_index)j->n_points++;
  for (aqr_index v = 0; j->mirrored && v < m->n_vertices; v++)
    j->image[v] =
      j->id[v] == AQR_NONE || aqr_symmetry_on_plane(j->r->surface, m, v) ? j->id[v] : (aqr_index)j->n_points++;
}

static void count_faces(mesh_job* j)
{
  const aqr_polygon_mesh* m = &j->r->polygons;
  for (size_t h = 0; h < m->n_half_edges; h++)
    j->half_corners += m->half_edges[h].from != AQR_NONE && m->half_edges[h].face != AQR_NONE;
  for (size_t f = 0; f < m->n_faces; f++)
    j->half_faces += m->faces[f] != AQR_NONE;
  j->n_faces = (j->mirrored ? 2 : 1) * j->half_faces;
  j->n_corners = (j->mirrored ? 2 : 1) * j->half_corners;
}

/* The arrays, which the mesh owns at once. */
static bool make_arrays(aqr_context* c, mesh_job* j, aqr_mesh* out)
{
  j->points = AQR_NEW(c, double, 3 * j->n_points);
  j->normals = AQR_NEW(c, double, 3 * j->n_points);
  j->origins = AQR_NEW(c, aqr_origin, j->n_points);
  j->kind = AQR_NEW(c, uint8_t, j->n_points);
  j->offsets = AQR_NEW(c, int64_t, j->n_faces + 1);
  j->connectivity = AQR_NEW(c, int64_t, j->n_corners);
  j->source = AQR_NEW(c, aqr_index, j->n_faces);
  *out = (aqr_mesh){ j->n_points, j->points, j->normals, j->origins, j->kind, j->n_faces, j->offsets, j->connectivity,
    j->source, j->n_corners };
  return j->points && j->normals && j->origins && j->kind && j->offsets && j->connectivity && j->source;
}

/* The mirror image of point i of the half. */
static void put_image(const mesh_job* j, size_t i, vec3 normal, size_t image)
{
  const aqr_plane turn = { { 0, 0, 0 }, j->plane.normal };
  v3_store(j->points + 3 * image, mirror(&j->plane, v3_load(j->points + 3 * i)));
  v3_store(j->normals + 3 * image, mirror(&turn, normal));
  j->origins[image] = j->origins[i];
  j->kind[image] = j->kind[i];
}

static void fill_points(const mesh_job* j)
{
  const aqr_surface* s = j->r->surface;
  const aqr_polygon_mesh* m = &j->r->polygons;
  for (aqr_index v = 0; v < m->n_vertices; v++)
  {
    if (j->id[v] == AQR_NONE)
      continue;
    const aqr_vertex* at = &m->vertices[v];
    size_t i = j->id[v];
    unscale(s, at->position, j->points + 3 * i);
    v3_store(j->normals + 3 * i, at->normal);
    j->origins[i] = origin_of(s, &at->place);
    j->kind[i] = at->kind;
    if (j->mirrored && j->image[v] == i)
      put_on_plane(j->r, &j->plane, v, j->points + 3 * i, j->normals + 3 * i, &j->kind[i]);
    else if (j->mirrored)
      put_image(j, i, at->normal, j->image[v]);
  }
}

/* Face i of the mesh, as face f of the half with corners from *k on, which then is behind them. */
static aqr_status fill_face(const mesh_job* j, aqr_index i, size_t f, size_t* k)
{
  const aqr_polygon_mesh* m = &j->r->polygons;
  const size_t first = *k, size = aqr_pm_face_size(m, i);
  if (size > j->half_corners - first)
    return AQR_INTERNAL;
  aqr_index h = m->faces[i];
  j->offsets[f] = (int64_t)first;
  j->source[f] = j->r->surface->source[m->vertices[aqr_pm_from(m, h)].place.face];
  for (; *k < first + size; h = aqr_pm_next(m, h), ++*k)
  {
    j->connectivity[*k] = j->id[aqr_pm_from(m, h)];
    if (j->mirrored) /* the other way round, behind all of the half */
      j->connectivity[j->half_corners + 2 * first + size - 1 - *k] = j->image[aqr_pm_from(m, h)];
  }
  return AQR_OK;
}

static aqr_status fill_faces(const mesh_job* j)
{
  const aqr_polygon_mesh* m = &j->r->polygons;
  aqr_status status = AQR_OK;
  size_t k = 0, f = 0;
  for (aqr_index i = 0; i < m->n_faces; i++)
    if (m->faces[i] != AQR_NONE)
      AQR_TRY(fill_face(j, i, f++, &k));
  for (size_t i = 0; j->mirrored && i < j->half_faces; i++)
  {
    j->offsets[j->half_faces + i] = (int64_t)j->half_corners + j->offsets[i];
    j->source[j->half_faces + i] = j->source[i];
  }
  j->offsets[j->n_faces] = (int64_t)j->n_corners;
done:
  return status;
}

aqr_status aqr_results_mesh(aqr_remesher* r)
{
  aqr_context* c = &r->context;
  const size_t n = r->polygons.n_vertices, n_images = r->surface->mirrored ? n : 0;
  aqr_status status = AQR_OK;
  aqr_results_free_mesh(r);
  mesh_job j = { .r = r, .mirrored = r->surface->mirrored, .plane = aqr_symmetry_plane(&r->done) };
  j.id = AQR_NEW(c, aqr_index, n);
  j.image = AQR_NEW(c, aqr_index, n_images);
  AQR_REQUIRE(j.id && j.image, AQR_OUT_OF_MEMORY);
  number_points(&j);
  count_faces(&j);
  AQR_REQUIRE(make_arrays(c, &j, &r->mesh), AQR_OUT_OF_MEMORY);
  fill_points(&j);
  AQR_TRY(fill_faces(&j));
done:
  AQR_DROP(c, j.id, n);
  AQR_DROP(c, j.image, n_images);
  if (status != AQR_OK)
    aqr_results_free_mesh(r);
  return status;
}

void aqr_results_free_mesh(aqr_remesher* r)
{
  aqr_context* c = &r->context;
  aqr_mesh* m = &r->mesh;
  DROP_VIEW(c, double, m->points, 3 * m->number_of_points);
  DROP_VIEW(c, double, m->normals, 3 * m->number_of_points);
  DROP_VIEW(c, aqr_origin, m->origins, m->number_of_points);
  DROP_VIEW(c, uint8_t, m->point_kind, m->number_of_points);
  DROP_VIEW(c, int64_t, m->offsets, m->number_of_faces + 1);
  DROP_VIEW(c, int64_t, m->connectivity, m->number_of_corners);
  DROP_VIEW(c, aqr_index, m->face_source, m->number_of_faces);
  memset(m, 0, sizeof *m);
}

typedef struct field_job
{
  const aqr_surface* s;
  const aqr_field* field;
  const aqr_index *point_rank, *face_rank;
  double *points, *normals, *min_direction, *max_direction, *min_curvature, *max_curvature;
  float *point_confidence, *confidence;
  aqr_origin* origins;
  aqr_index *triangles, *source;
} field_job;

/* The first sector of a point speaks for it: sectors split off come behind all cleaned points. */
static void show_points(void* data, size_t begin, size_t end)
{
  const field_job* j = data;
  const aqr_surface* s = j->s;
  for (size_t v = begin; v < end; v++)
  {
    size_t i = j->point_rank[v];
    vec3 normal = v3_load(j->field->normal + 3 * v), d = aqr_min_direction(j->field, v);
    unscale(s, aqr_point(s, (aqr_index)v), j->points + 3 * i);
    v3_store(j->normals + 3 * i, normal);
    v3_store(j->min_direction + 3 * i, d);
    v3_store(j->max_direction + 3 * i, v3_cross(normal, d));
    j->min_curvature[i] = (double)j->field->k_min[v] / s->diagonal;
    j->max_curvature[i] = (double)j->field->k_max[v] / s->diagonal;
    j->point_confidence[i] = j->field->point_confidence[v];
    j->origins[i] = aqr_origin_of(s, v);
  }
}

static void show_triangles(void* data, size_t begin, size_t end)
{
  const field_job* j = data;
  const aqr_surface* s = j->s;
  for (size_t f = begin; f < end; f++)
  {
    size_t i = j->face_rank[f];
    j->source[i] = s->source[f];
    j->confidence[i] = j->field->face_confidence[f];
    for (unsigned k = 0; k < 3; k++)
      j->triangles[3 * i + k] = j->point_rank[s->clean[s->corner[3 * f + k]]];
  }
}

aqr_status aqr_results_field(aqr_remesher* r)
{
  aqr_context* c = &r->context;
  const aqr_surface* s = r->surface;
  aqr_status status = AQR_OK;
  field_job job;
  aqr_index *point_rank = NULL, *face_rank = NULL;
  aqr_results_free_field(r);
  size_t n = s->n_clean, nf = s->n_faces;
  double *points = AQR_NEW(c, double, 3 * n), *normals = AQR_NEW(c, double, 3 * n);
  double *min_direction = AQR_NEW(c, double, 3 * n), *max_direction = AQR_NEW(c, double, 3 * n);
  double *min_curvature = AQR_NEW(c, double, n), *max_curvature = AQR_NEW(c, double, n);
  aqr_origin* origins = AQR_NEW(c, aqr_origin, n);
  float *point_confidence = AQR_NEW(c, float, n), *confidence = AQR_NEW(c, float, nf);
  aqr_index *triangles = AQR_NEW(c, aqr_index, 3 * nf), *source = AQR_NEW(c, aqr_index, nf);
  r->field_view = (aqr_field_view){ n, points, origins, normals, min_direction, max_direction, min_curvature,
    max_curvature, point_confidence, nf, triangles, source, confidence, r->field_revision };
  AQR_REQUIRE(points && normals && min_direction && max_direction && min_curvature && max_curvature && origins &&
                point_confidence && confidence && triangles && source,
    AQR_OUT_OF_MEMORY);
  point_rank = AQR_NEW(c, aqr_index, n);
  face_rank = AQR_NEW(c, aqr_index, nf);
  AQR_REQUIRE(point_rank && face_rank, AQR_OUT_OF_MEMORY);
  AQR_REQUIRE(aqr_step(c, 0.1), AQR_CANCELLED);
  AQR_TRY(aqr_surface_rank_points(c, s, r->n_input_points, point_rank));
  AQR_REQUIRE(aqr_step(c, 0.2), AQR_CANCELLED);
  AQR_TRY(aqr_surface_rank_faces(c, s, face_rank));
  job = (field_job){ s, &r->field, point_rank, face_rank, points, normals, min_direction, max_direction, min_curvature,
    max_curvature, point_confidence, confidence, origins, triangles, source };
  AQR_TRY(aqr_parallel(c, n, show_points, &job, 0.3, 0.6));
  AQR_TRY(aqr_parallel(c, nf, show_triangles, &job, 0.6, 1));
done:
  AQR_DROP(c, point_rank, n);
  AQR_DROP(c, face_rank, nf);
  if (status != AQR_OK)
    aqr_results_free_field(r);
  return status;
}

void aqr_results_free_field(aqr_remesher* r)
{
  aqr_context* c = &r->context;
  aqr_field_view* v = &r->field_view;
  size_t n = v->number_of_points, nf = v->number_of_triangles;
  DROP_VIEW(c, double, v->points, 3 * n);
  DROP_VIEW(c, aqr_origin, v->origins, n);
  DROP_VIEW(c, double, v->normals, 3 * n);
  DROP_VIEW(c, double, v->min_direction, 3 * n);
  DROP_VIEW(c, double, v->max_direction, 3 * n);
  DROP_VIEW(c, double, v->min_curvature, n);
  DROP_VIEW(c, double, v->max_curvature, n);
  DROP_VIEW(c, float, v->point_confidence, n);
  DROP_VIEW(c, aqr_index, v->triangles, 3 * nf);
  DROP_VIEW(c, aqr_index, v->triangle_source, nf);
  DROP_VIEW(c, float, v->triangle_confidence, nf);
  memset(v, 0, sizeof *v);
}

/* Normal curvature of the surface across direction d at the corner of face f nearest to p. */
static double curvature_across(const aqr_remesher* r, aqr_index f, vec3 p, vec3 d)
{
  const aqr_surface* s = r->surface;
  size_t v = s->corner[3 * f];
  for (unsigned i = 1; i < 3; i++)
    if (v3_norm2(v3_sub(aqr_point(s, s->corner[3 * f + i]), p)) < v3_norm2(v3_sub(aqr_point(s, (aqr_index)v), p)))
      v = s->corner[3 * f + i];
  double e = v3_dot(v3_unit(d), aqr_min_direction(&r->field, v)), along = fmin(1, e * e);
  return ((double)r->field.k_max[v] * along + (double)r->field.k_min[v] * (1 - along)) / s->diagonal;
}

typedef struct lines_job
{
  const aqr_remesher* r;
  const aqr_index* face_rank;
  uint8_t *type, *ends, *isotropic;
  double *points, *curvature, *arc;
  aqr_index* triangle;
} lines_job;

static void show_some_lines(void* data, size_t begin, size_t end)
{
  const lines_job* x = data;
  const aqr_surface* s = x->r->surface;
  const aqr_lines* l = &x->r->lines;
  for (size_t i = begin; i < end; i++)
  {
    const aqr_line* line = &l->lines[i];
    x->type[i] = line->type;
    x->ends[2 * i] = line->ends[0];
    x->ends[2 * i + 1] = line->ends[1];
    for (size_t k = 0; k < line->count; k++)
    {
      size_t j = line->first + k, to = k + 1 < line->count ? j : j - 1;
      const aqr_sample* a = &l->samples[j];
      vec3 d = v3_sub(l->samples[to + 1].p, l->samples[to].p);
      unscale(s, a->p, x->points + 3 * j);
      x->curvature[j] = curvature_across(x->r, a->face, a->p, d);
      x->arc[j] = (double)a->arc * s->diagonal;
      x->triangle[j] = x->face_rank[a->face];
      x->isotropic[j] = a->isotropic;
    }
  }
}

aqr_status aqr_results_lines(aqr_remesher* r)
{
  aqr_context* c = &r->context;
  const aqr_lines* l = &r->lines;
  aqr_status status = AQR_OK;
  lines_job job;
  aqr_results_free_lines(r);
  size_t n = l->n_lines, m = l->n_samples;
  int64_t* offsets = AQR_NEW(c, int64_t, n + 1);
  uint8_t *type = AQR_NEW(c, uint8_t, n), *ends = AQR_NEW(c, uint8_t, 2 * n), *isotropic = AQR_NEW(c, uint8_t, m);
  double *points = AQR_NEW(c, double, 3 * m), *curvature = AQR_NEW(c, double, m), *arc = AQR_NEW(c, double, m);
  aqr_index* triangle = AQR_NEW(c, aqr_index, m);
  aqr_index* face_rank = AQR_NEW(c, aqr_index, r->surface->n_faces);
  r->lines_view = (aqr_lines_view){ n, offsets, type, ends, m, points, curvature, arc, triangle, isotropic };
  AQR_REQUIRE(
    offsets && type && ends && isotropic && points && curvature && arc && triangle && face_rank, AQR_OUT_OF_MEMORY);
  AQR_REQUIRE(aqr_step(c, 1), AQR_CANCELLED);
  AQR_TRY(aqr_surface_rank_faces(c, r->surface, face_rank));
  offsets[0] = 0;
  for (size_t i = 0; i < n; i++)
    offsets[i + 1] = offsets[i] + (int64_t)l->lines[i].count;
  job = (lines_job){ r, face_rank, type, ends, isotropic, points, curvature, arc, triangle };
  AQR_TRY(aqr_parallel(c, n, show_some_lines, &job, 1, 1));
done:
  AQR_DROP(c, face_rank, r->surface->n_faces);
  if (status != AQR_OK)
    aqr_results_free_lines(r);
  return status;
}

void aqr_results_free_lines(aqr_remesher* r)
{
  aqr_context* c = &r->context;
  aqr_lines_view* v = &r->lines_view;
  size_t n = v->number_of_lines, m = v->number_of_points;
  DROP_VIEW(c, int64_t, v->offsets, n + 1);
  DROP_VIEW(c, uint8_t, v->type, n);
  DROP_VIEW(c, uint8_t, v->ends, 2 * n);
  DROP_VIEW(c, double, v->points, 3 * m);
  DROP_VIEW(c, double, v->curvature, m);
  DROP_VIEW(c, double, v->arc_length, m);
  DROP_VIEW(c, aqr_index, v->triangle, m);
  DROP_VIEW(c, uint8_t, v->isotropic, m);
  memset(v, 0, sizeof *v);
}
