/* SPDX-License-Identifier: BSD-3-Clause */
#include "coarsen.h"

#include "regularize.h"
#include "sort.h"

#include <stdlib.h>

enum
{
  most_passes = 200
};

static const double least_cosine = 0.2; /* between a triangle before and after */
static const double length_price =
  1e-4;                                 /* of a squared length, against a squared distance: decides where all is flat */
static const double border_weight = 10; /* of the planes that hold a border in place */
static const double corner_cosine = 0.7; /* borders that turn more have a corner there */

/* Squared distance from planes: symmetric 4x4. */
typedef struct quadric
{
  double a[10];
} quadric;

typedef struct candidate
{
  double cost;
  aqr_index h; /* contracted into its start */
} candidate;

typedef struct coarsener
{
  aqr_context* c;
  aqr_polygon_mesh mesh;
  quadric* quadrics; /* about the centre: far from it the terms of a small component's would cancel */
  size_t n_quadrics;
  vec3 centre;
  candidate* candidates;
  size_t n_candidates, candidate_capacity;
  aqr_index* touched; /* per vertex: last pass that changed a face at it */
} coarsener;

/* ---- the component as a polygon mesh ---- */

static int by_index(const void* a, const void* b)
{
  aqr_index x = *(const aqr_index*)a, y = *(const aqr_index*)b;
  return (x > y) - (x < y);
}

/* Triangles over cleaned points, so that seams are closed; over sectors where that would pinch. */
static aqr_status build(
  coarsener* k, const aqr_surface* s, const aqr_field* field, const aqr_index* faces, size_t n, bool sectors)
{
  aqr_context* c = k->c;
  aqr_status status = AQR_OK;
  size_t n_ids = 0;
  aqr_index* ids = AQR_NEW(c, aqr_index, 3 * n);
  aqr_index* corner = AQR_NEW(c, aqr_index, 3 * n);
  size_t* offsets = AQR_NEW(c, size_t, n + 1);
  aqr_vertex* vertices = NULL;
  AQR_REQUIRE(ids && corner && offsets, AQR_OUT_OF_MEMORY);
  for (size_t i = 0; i < 3 * n; i++)
  {
    aqr_index p = s->corner[3 * (size_t)faces[i / 3] + i % 3];
    ids[i] = corner[i] = sectors ? p : s->clean[p];
  }
  AQR_TRY(aqr_sort(c, ids, 3 * n, sizeof *ids, by_index));
  for (size_t i = 0; i < 3 * n; i++)
    if (i == 0 || ids[i] != ids[n_ids - 1])
      ids[n_ids++] = ids[i];
  vertices = AQR_NEW0(c, aqr_vertex, n_ids);
  AQR_REQUIRE(vertices, AQR_OUT_OF_MEMORY);
  for (size_t i = 0; i <= n; i++)
    offsets[i] = 3 * i;
  for (size_t i = 0; i < 3 * n; i++)
  {
    AQR_REQUIRE(aqr_worked(c, 8), AQR_CANCELLED);
    const aqr_index* at = bsearch(&corner[i], ids, n_ids, sizeof *ids, by_index);
    corner[i] = (aqr_index)(at - ids);
    aqr_vertex* v = &vertices[corner[i]];
    aqr_index p = s->corner[3 * (size_t)faces[i / 3] + i % 3];
    v->position = aqr_point(s, p);
    v->normal = v3_add(v->normal, v3_load(field->normal + 3 * (size_t)p));
    v->place = (aqr_place){ faces[i / 3], { 0, 0, 0 } };
    v->place.bary[i % 3] = 1;
  }
  for (size_t i = 0; i < n_ids; i++)
  {
    AQR_REQUIRE(aqr_worked(c, 8), AQR_CANCELLED);
    const aqr_place* at = &vertices[i].place;
    aqr_index p = s->corner[3 * at->face + (at->bary[0] > 0 ? 0 : at->bary[1] > 0 ? 1 : 2)];
    vertices[i].normal = v3_unit_or(vertices[i].normal, v3_load(field->normal + 3 * (size_t)p));
  }
  AQR_TRY(aqr_pm_append(c, &k->mesh, vertices, n_ids, offsets, n, corner));
  for (size_t i = 0; i < n; i++)
  {
    aqr_index h = k->mesh.faces[i];
    AQR_REQUIRE(aqr_worked(c, 8), AQR_CANCELLED);
    for (unsigned j = 0; j < 3; j++, h = aqr_pm_next(&k->mesh, h))
      if (aqr_pm_face(&k->mesh, h ^ 1) != AQR_NONE && aqr_is_seam(s, 3 * faces[i] + j))
        k->mesh.edge_type[h >> 1] = AQR_LINE_FEATURE;
  }
done:
  AQR_DROP(c, ids, 3 * n);
  AQR_DROP(c, corner, 3 * n);
  AQR_DROP(c, offsets, n + 1);
  AQR_DROP(c, vertices, n_ids);
  return status;
}

/* Vertices inside a chain, and those where chains end, meet or turn. */
static aqr_status set_kinds(aqr_context* c, aqr_polygon_mesh* m)
{
  for (aqr_index v = 0; v < m->n_vertices; v++)
  {
    if (!aqr_worked(c, 8))
      return AQR_CANCELLED;
    vec3 along[2] = { { 0, 0, 0 }, { 0, 0, 0 } };
    unsigned n = 0;
    uint8_t kind = AQR_VERTEX_FEATURE;
    aqr_index h = m->vertices[v].out;
    do
    {
      if (aqr_pm_on_chain(m, h))
      {
        along[n % 2] = v3_unit(v3_sub(aqr_pm_point(m, aqr_pm_to(m, h)), aqr_pm_point(m, v)));
        n++;
        if (m->edge_type[h >> 1] == AQR_LINE_BOUNDARY)
          kind = AQR_VERTEX_BOUNDARY;
      }
      h = aqr_pm_next_around(m, h);
    } while (h != m->vertices[v].out);
    bool smooth = n == 2 && v3_dot(along[0], along[1]) < -corner_cosine;
    m->vertices[v].kind = n == 0 ? AQR_VERTEX_INTERIOR : smooth ? kind : AQR_VERTEX_CORNER;
  }
  return AQR_OK;
}

/* ---- quadrics ---- */

static void add_plane(quadric* q, vec3 n, vec3 p, double w)
{
  double x[4] = { n.x, n.y, n.z, -v3_dot(n, p) };
  for (unsigned i = 0, k = 0; i < 4; i++)
    for (unsigned j = i; j < 4; j++)
      q->a[k++] += w * x[i] * x[j];
}

static double error_at(const quadric* q, vec3 p)
{
  double x[4] = { p.x, p.y, p.z, 1 }, sum = 0;
  for (unsigned i = 0, k = 0; i < 4; i++)
    for (unsigned j = i; j < 4; j++)
      sum += (i == j ? 1 : 2) * q->a[k++] * x[i] * x[j];
  return sum;
}

static vec3 face_cross(const aqr_polygon_mesh* m, aqr_index h)
{
  vec3 a = aqr_pm_point(m, aqr_pm_from(m, h));
  return v3_cross(
    v3_sub(aqr_pm_point(m, aqr_pm_to(m, h)), a), v3_sub(aqr_pm_point(m, aqr_pm_from(m, aqr_pm_prev(m, h))), a));
}

static aqr_status set_quadrics(coarsener* k)
{
  const aqr_polygon_mesh* m = &k->mesh;
  for (aqr_index h = 0; h < m->n_half_edges; h++)
  {
    if (!aqr_worked(k->c, 8))
      return AQR_CANCELLED;
    if (aqr_pm_face(m, h) == AQR_NONE)
      continue;
    vec3 cross = face_cross(m, h), p = v3_sub(aqr_pm_point(m, aqr_pm_from(m, h)), k->centre);
    add_plane(&k->quadrics[aqr_pm_from(m, h)], v3_unit(cross), p, v3_norm(cross));
    if (aqr_pm_on_chain(m, h))
    {
      vec3 e = v3_sub(aqr_pm_point(m, aqr_pm_to(m, h)), aqr_pm_point(m, aqr_pm_from(m, h)));
      vec3 n = v3_unit(v3_cross(e, cross));
      add_plane(&k->quadrics[aqr_pm_from(m, h)], n, p, border_weight * v3_norm2(e));
      add_plane(&k->quadrics[aqr_pm_to(m, h)], n, p, border_weight * v3_norm2(e));
    }
  }
  return AQR_OK;
}

/* ---- contraction ---- */

/* Whether triangles around the end of h keep their side when it moves to the start. */
static bool keeps_normals(const aqr_polygon_mesh* m, aqr_index h)
{
  aqr_index u = aqr_pm_from(m, h), v = aqr_pm_to(m, h);
  vec3 p = aqr_pm_point(m, u);
  for (aqr_index k = aqr_pm_next_around(m, h ^ 1); k != (h ^ 1); k = aqr_pm_next_around(m, k))
  {
    aqr_index a = aqr_pm_to(m, k), b = aqr_pm_from(m, aqr_pm_prev(m, k));
    if (aqr_pm_face(m, k) == AQR_NONE || a == u || b == u)
      continue;
    vec3 q = aqr_pm_point(m, a), r = aqr_pm_point(m, b), old = aqr_pm_point(m, v);
    vec3 before = v3_cross(v3_sub(q, old), v3_sub(r, old)), after = v3_cross(v3_sub(q, p), v3_sub(r, p));
    if (!(v3_dot(before, after) > least_cosine * v3_norm(before) * v3_norm(after)))
      return false;
  }
  return true;
}

static int by_cost(const void* a, const void* b)
{
  const candidate *x = a, *y = b;
  return x->cost != y->cost ? (x->cost < y->cost ? -1 : 1) : (x->h > y->h) - (x->h < y->h);
}

static aqr_status list_candidates(coarsener* k)
{
  const aqr_polygon_mesh* m = &k->mesh;
  k->n_candidates = 0;
  for (aqr_index h = 0; h < m->n_half_edges; h++)
  {
    if (!aqr_worked(k->c, 4))
      return AQR_CANCELLED;
    if (!aqr_pm_edge_lives(m, h))
      continue;
    aqr_index u = aqr_pm_from(m, h), v = aqr_pm_to(m, h);
    if (m->vertices[v].kind > m->vertices[u].kind)
      continue;
    if (!AQR_RESERVE(k->c, k->candidates, k->candidate_capacity, k->n_candidates + 1))
      return AQR_OUT_OF_MEMORY;
    vec3 p = aqr_pm_point(m, u);
    quadric q = k->quadrics[u];
    double length2 = v3_norm2(v3_sub(aqr_pm_point(m, v), p));
    for (unsigned i = 0; i < 10; i++)
      q.a[i] += k->quadrics[v].a[i];
    k->candidates[k->n_candidates++] =
      (candidate){ error_at(&q, v3_sub(p, k->centre)) + length_price * length2 * length2, h };
  }
  return aqr_sort(k->c, k->candidates, k->n_candidates, sizeof *k->candidates, by_cost);
}

static void touch_around(coarsener* k, aqr_index v, aqr_index pass)
{
  aqr_index h = k->mesh.vertices[v].out;
  k->touched[v] = pass;
  do
  {
    k->touched[aqr_pm_to(&k->mesh, h)] = pass;
    h = aqr_pm_next_around(&k->mesh, h);
  } while (h != k->mesh.vertices[v].out);
}

/* One pass over the cheaper half of the edges, none beside another. */
static aqr_status contract_pass(coarsener* k, aqr_index pass, size_t points, size_t* left, bool* any)
{
  *any = false;
  for (size_t i = 0; i < k->n_candidates && (i < k->n_candidates / 2 || !*any); i++)
  {
    if (*left <= points)
      break;
    if (!aqr_worked(k->c, 32))
      return AQR_CANCELLED;
    aqr_index h = k->candidates[i].h;
    if (!aqr_pm_edge_lives(&k->mesh, h))
      continue;
    aqr_index u = aqr_pm_from(&k->mesh, h), v = aqr_pm_to(&k->mesh, h);
    if (k->touched[u] == pass || k->touched[v] == pass || !aqr_can_contract(&k->mesh, h) || !keeps_normals(&k->mesh, h))
      continue;
    aqr_vertex stays = k->mesh.vertices[u];
    if (aqr_contract(&k->mesh, h, &stays) == AQR_NONE)
      continue;
    for (unsigned j = 0; j < 10; j++)
      k->quadrics[u].a[j] += k->quadrics[v].a[j];
    touch_around(k, u, pass);
    *any = true;
    --*left;
  }
  return AQR_OK;
}

static aqr_status contract(coarsener* k, size_t points)
{
  aqr_status status = AQR_OK;
  size_t left = k->mesh.n_vertices;
  bool any = true;
  for (aqr_index pass = 1; any && pass <= most_passes && left > points; pass++)
  {
    AQR_REQUIRE(aqr_step(k->c, 0), AQR_CANCELLED);
    AQR_TRY(list_candidates(k));
    AQR_TRY(contract_pass(k, pass, points, &left, &any));
  }
done:
  return status;
}

static void set_sizes(aqr_polygon_mesh* m)
{
  for (aqr_index v = 0; v < m->n_vertices; v++)
  {
    double sum = 0, n = 0;
    aqr_index h = m->vertices[v].out;
    do
    {
      sum += v3_norm(v3_sub(aqr_pm_point(m, aqr_pm_to(m, h)), aqr_pm_point(m, v)));
      n += 1;
      h = aqr_pm_next_around(m, h);
    } while (h != m->vertices[v].out);
    m->vertices[v].size = sum / n;
  }
}

aqr_status aqr_coarsen_component(aqr_context* c, const aqr_surface* s, const aqr_field* field, const aqr_index* faces,
  size_t n_faces, size_t points, aqr_polygon_mesh* m)
{
  aqr_status status = AQR_OK;
  coarsener k = { .c = c };
  status = build(&k, s, field, faces, n_faces, false);
  if (status == AQR_OK)
    status = aqr_pm_verify(c, &k.mesh, false);
  if (status == AQR_INTERNAL)
  {
    aqr_polygon_mesh_free(c, &k.mesh);
    status = build(&k, s, field, faces, n_faces, true);
  }
  AQR_TRY(status);
  k.centre = aqr_pm_point(&k.mesh, 0);
  k.n_quadrics = k.mesh.n_vertices;
  k.quadrics = AQR_NEW0(c, quadric, k.n_quadrics);
  k.touched = AQR_NEW0(c, aqr_index, k.n_quadrics);
  AQR_REQUIRE(k.quadrics && k.touched, AQR_OUT_OF_MEMORY);
  AQR_TRY(set_kinds(c, &k.mesh));
  AQR_TRY(set_quadrics(&k));
  AQR_TRY(contract(&k, points));
  AQR_TRY(aqr_pm_compact(c, &k.mesh));
  set_sizes(&k.mesh);
  AQR_TRY(aqr_pm_append_mesh(c, m, &k.mesh));
done:
  AQR_DROP(c, k.quadrics, k.n_quadrics);
  AQR_DROP(c, k.touched, k.n_quadrics);
  AQR_DROP(c, k.candidates, k.candidate_capacity);
  aqr_polygon_mesh_free(c, &k.mesh);
  return status;
}
