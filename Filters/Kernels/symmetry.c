/* SPDX-License-Identifier: BSD-3-Clause */
#include "symmetry.h"

#include "regularize.h"

#include <string.h>

static const double rounding = 1e-6;       /* of the diagonal: as near counts as on the plane */
static const double near_corner = 0.01;    /* of an edge: a corner as near to where the plane cuts it is moved there */
static const double match_distance = 1e-5; /* of the diagonal: as near to a mirror image is at it */

typedef struct cutter
{
  aqr_context* c;
  const aqr_surface* s;
  aqr_surface* half;
  const aqr_plane* plane;
  const uint8_t* is_crease;
  double* height;    /* per point of s */
  int* side;         /* per point of s */
  aqr_index* id;     /* per point of s: point of the half */
  aqr_index* cut;    /* per half-edge of s, the smaller of two: the point where the plane cuts it */
  aqr_index* piece;  /* per half-edge of s: its piece in the half */
  uint8_t* at_plane; /* per half-edge of the half: begins on the plane */
  uint8_t* crease;   /* per half-edge of the half */
} cutter;

static void find_sides(cutter* w)
{
  const aqr_surface* s = w->s;
  for (aqr_index v = 0; v < s->n_points; v++)
  {
    double d = w->height[v] = aqr_plane_height(w->plane, aqr_point(s, v));
    w->side[v] = d > rounding ? 1 : d < -rounding ? -1 : 0;
  }
  for (aqr_index h = 0; h < 3 * s->n_faces; h++)
  {
    double d = w->height[aqr_from(s, h)], e = w->height[aqr_to(s, h)];
    if (d * e < 0 && fabs(d) < near_corner * fabs(d - e))
      w->side[aqr_from(s, h)] = 0;
    if (d * e < 0 && fabs(e) < near_corner * fabs(d - e))
      w->side[aqr_to(s, h)] = 0;
  }
}

/* A point at p that is input point `input`, or lies at `between` where that is not NULL. */
static bool add_point(cutter* w, vec3 p, aqr_index input, const aqr_origin* between)
{
  aqr_surface* t = w->half;
  if (!aqr_surface_reserve_points(w->c, t, t->n_points + 1) || !aqr_surface_reserve_origins(w->c, t, t->n_points + 1))
    return false;
  if (between && !aqr_surface_put_between(w->c, t, t->n_points, between))
    return false;
  if (!between)
    t->origin[t->n_points] = input;
  v3_store(t->points + 3 * t->n_points++, p);
  return true;
}

static vec3 onto_plane(const aqr_plane* plane, vec3 p)
{
  return v3_madd(p, -aqr_plane_height(plane, p), plane->normal);
}

/* The point of the half that is point v of the surface; AQR_NONE when out of memory. */
static aqr_index kept(cutter* w, aqr_index v)
{
  if (w->id[v] != AQR_NONE)
    return w->id[v];
  vec3 p = aqr_point(w->s, v);
  const aqr_origin origin = aqr_origin_of(w->s, v);
  if (!add_point(
        w, w->side[v] ? p : onto_plane(w->plane, p), w->s->origin[v], aqr_is_input_point(w->s, v) ? NULL : &origin))
    return AQR_NONE;
  return w->id[v] = (aqr_index)(w->half->n_points - 1);
}

/* The point where the plane cuts an edge. */
static aqr_index cut_at(cutter* w, aqr_index h)
{
  const aqr_surface* s = w->s;
  aqr_index t = s->twin[h], low = t != AQR_NONE && t < h ? t : h;
  if (w->cut[low] != AQR_NONE)
    return w->cut[low];
  aqr_index a = aqr_from(s, low), b = aqr_to(s, low);
  double at = w->height[a] / (w->height[a] - w->height[b]);
  vec3 p = v3_madd(v3_scale(aqr_point(s, a), 1 - at), at, aqr_point(s, b));
  const aqr_origin origin = aqr_origin_between(s, a, b, at, s->source[low / 3]);
  if (!add_point(w, onto_plane(w->plane, p), AQR_NONE, &origin))
    return AQR_NONE;
  return w->cut[low] = (aqr_index)(w->half->n_points - 1);
}

typedef struct corner
{
  aqr_index v, edge; /* the old half-edge that goes on from it; AQR_NONE along the plane */
  bool at_plane;
} corner;

static bool add_face(cutter* w, const corner p[3], aqr_index source)
{
  aqr_surface* t = w->half;
  if (!aqr_surface_reserve_faces(w->c, t, t->n_faces + 1))
    return false;
  for (unsigned k = 0; k < 3; k++)
  {
    size_t h = 3 * t->n_faces + k;
    t->corner[h] = p[k].v;
    t->twin[h] = AQR_NONE;
    w->at_plane[h] = p[k].at_plane;
    if (p[k].edge == AQR_NONE)
      continue;
    w->piece[p[k].edge] = (aqr_index)h;
    w->crease[h] = w->is_crease[p[k].edge];
  }
  t->source[t->n_faces++] = source;
  return true;
}

/* What of face f lies above the plane: nothing, a triangle or a quad, which is halved by its shorter diagonal. */
static bool cut_face(cutter* w, aqr_index f)
{
  const aqr_surface* s = w->s;
  corner p[4] = { { 0 } };
  unsigned n = 0;
  bool above = false;
  for (unsigned k = 0; k < 3; k++)
    above |= w->side[s->corner[3 * f + k]] > 0;
  for (unsigned k = 0; above && k < 3; k++)
  {
    aqr_index h = 3 * f + k, v = aqr_from(s, h);
    int a = w->side[v], b = w->side[aqr_to(s, h)];
    if (a >= 0)
      p[n++] = (corner){ kept(w, v), a == 0 && b < 0 ? AQR_NONE : h, a == 0 };
    if (a * b < 0)
      p[n++] = (corner){ cut_at(w, h), a < 0 ? h : AQR_NONE, true };
  }
  for (unsigned k = 0; k < n; k++)
    if (p[k].v == AQR_NONE)
      return false;
  if (n == 3)
    return add_face(w, p, s->source[f]);
  if (n < 4)
    return true;
  const aqr_surface* t = w->half;
  double even = v3_norm2(v3_sub(aqr_point(t, p[2].v), aqr_point(t, p[0].v)));
  double odd = v3_norm2(v3_sub(aqr_point(t, p[3].v), aqr_point(t, p[1].v)));
  unsigned i = odd < even ? 1 : 0;
  /* the corner before the diagonal goes along it */
  corner first = p[(i + 2) % 4], second = p[i];
  corner one[3] = { p[i], p[(i + 1) % 4], first }, two[3] = { second, p[(i + 2) % 4], p[(i + 3) % 4] };
  one[2].edge = two[0].edge = AQR_NONE;
  if (!add_face(w, one, s->source[f]) || !add_face(w, two, s->source[f]))
    return false;
  aqr_index last = (aqr_index)(3 * (t->n_faces - 2));
  w->half->twin[last + 2] = last + 3;
  w->half->twin[last + 3] = last + 2;
  return true;
}

static void pair_pieces(cutter* w)
{
  const aqr_surface* s = w->s;
  for (aqr_index h = 0; h < 3 * s->n_faces; h++)
    if (w->piece[h] != AQR_NONE && s->twin[h] != AQR_NONE)
      w->half->twin[w->piece[h]] = w->piece[s->twin[h]];
}

/* Borders that lie wholly on the plane. Forgets what is at the plane on the way. */
static size_t count_loops(cutter* w)
{
  const aqr_surface* t = w->half;
  size_t loops = 0;
  for (aqr_index first = 0; first < 3 * t->n_faces; first++)
  {
    aqr_index h = first;
    while (w->at_plane[h] && aqr_on_plane(t, h))
    {
      w->at_plane[h] = 0;
      h = aqr_next(h);
      while (t->twin[h] != AQR_NONE)
        h = aqr_next(t->twin[h]);
      loops += h == first;
    }
  }
  return loops;
}

aqr_status aqr_symmetry_cut(aqr_context* c, const aqr_surface* s, const aqr_plane* plane, const uint8_t* is_crease,
  aqr_surface* half, uint8_t** crease)
{
  cutter w = { .c = c, .s = s, .half = half, .plane = plane, .is_crease = is_crease };
  aqr_status status = AQR_OK;
  size_t n = 3 * s->n_faces, n_points = s->n_points, held = 2 * n, kept_edges = 0;
  memset(half, 0, sizeof *half);
  half->centre = s->centre;
  half->diagonal = s->diagonal;
  *crease = NULL;
  w.height = AQR_NEW(c, double, n_points);
  w.side = AQR_NEW(c, int, n_points);
  w.id = AQR_NEW(c, aqr_index, n_points);
  w.cut = AQR_NEW(c, aqr_index, n);
  w.piece = AQR_NEW(c, aqr_index, n);
  w.at_plane = AQR_NEW(c, uint8_t, held);
  w.crease = AQR_NEW0(c, uint8_t, held);
  AQR_REQUIRE(w.height && w.side && w.id && w.cut && w.piece && w.at_plane && w.crease, AQR_OUT_OF_MEMORY);
  memset(w.id, 0xff, n_points * sizeof *w.id);
  memset(w.cut, 0xff, n * sizeof *w.cut);
  memset(w.piece, 0xff, n * sizeof *w.piece);
  find_sides(&w);
  for (aqr_index f = 0; f < s->n_faces; f++)
  {
    if (f % 65536 == 0)
      AQR_REQUIRE(aqr_step(c, 0.95), AQR_CANCELLED);
    AQR_REQUIRE(cut_face(&w, f), AQR_OUT_OF_MEMORY);
  }
  AQR_REQUIRE(half->n_faces > 0, AQR_BAD_OPTION);
  pair_pieces(&w);
  AQR_TRY(aqr_surface_split_fans(c, half));
  half->mirrored = AQR_NEW0(c, uint8_t, half->n_clean);
  kept_edges = 3 * half->n_faces;
  *crease = AQR_NEW(c, uint8_t, kept_edges);
  AQR_REQUIRE(half->mirrored && *crease, AQR_OUT_OF_MEMORY);
  /* where the surface touches the plane in one point, without an edge along it, the two sides stay apart */
  for (aqr_index h = 0; h < kept_edges; h++)
    if (half->twin[h] == AQR_NONE && w.at_plane[h] && w.at_plane[aqr_next(h)])
      half->mirrored[half->corner[h]] = half->mirrored[half->corner[aqr_next(h)]] = 1;
  half->mirrored_loops = count_loops(&w);
  for (size_t h = 0; h < kept_edges; h++)
    (*crease)[h] = half->twin[h] != AQR_NONE ? w.crease[h] : 0;
done:
  AQR_DROP(c, w.height, n_points);
  AQR_DROP(c, w.side, n_points);
  AQR_DROP(c, w.id, n_points);
  AQR_DROP(c, w.cut, n);
  AQR_DROP(c, w.piece, n);
  AQR_DROP(c, w.at_plane, held);
  AQR_DROP(c, w.crease, held);
  if (status != AQR_OK)
  {
    AQR_DROP(c, *crease, kept_edges);
    aqr_surface_free(c, half);
  }
  return status;
}

/* ---- is the input symmetric ---- */

typedef struct grid
{
  aqr_index* first; /* per bucket */
  aqr_index* next;  /* per point */
  size_t size;
} grid;

static void cell_of(vec3 p, int64_t* cell)
{
  cell[0] = (int64_t)floor(p.x / (2 * match_distance));
  cell[1] = (int64_t)floor(p.y / (2 * match_distance));
  cell[2] = (int64_t)floor(p.z / (2 * match_distance));
}

static size_t bucket_of(const grid* g, const int64_t* cell)
{
  uint64_t x = (uint64_t)cell[0] * 0x9e3779b97f4a7c15u ^ (uint64_t)cell[1] * 0xc2b2ae3d27d4eb4fu ^
               (uint64_t)cell[2] * 0x165667b19e3779f9u;
  return (size_t)(x ^ (x >> 29)) & (g->size - 1);
}

static bool has_point_near(const aqr_surface* s, const grid* g, vec3 p)
{
  int64_t low[3];
  cell_of(v3_sub(p, v3(match_distance, match_distance, match_distance)), low);
  for (unsigned i = 0; i < 8; i++)
  {
    const int64_t cell[3] = { low[0] + (i & 1), low[1] + (i >> 1 & 1), low[2] + (i >> 2) };
    for (aqr_index v = g->first[bucket_of(g, cell)]; v != AQR_NONE; v = g->next[v])
      if (v3_norm2(v3_sub(aqr_point(s, v), p)) < match_distance * match_distance)
        return true;
  }
  return false;
}

aqr_status aqr_symmetry_unmatched(aqr_context* c, const aqr_surface* s, const aqr_plane* plane, size_t* count)
{
  aqr_status status = AQR_OK;
  grid g = { .size = 16 };
  while (g.size < 2 * s->n_points)
    g.size *= 2;
  g.first = AQR_NEW(c, aqr_index, g.size);
  g.next = AQR_NEW(c, aqr_index, s->n_points);
  AQR_REQUIRE(g.first && g.next, AQR_OUT_OF_MEMORY);
  memset(g.first, 0xff, g.size * sizeof *g.first);
  *count = 0;
  for (aqr_index v = 0; v < s->n_points; v++)
  {
    int64_t cell[3];
    cell_of(aqr_point(s, v), cell);
    size_t at = bucket_of(&g, cell);
    g.next[v] = g.first[at];
    g.first[at] = v;
  }
  for (aqr_index v = 0; v < s->n_points; v++)
  {
    if (v % 65536 == 0)
      AQR_REQUIRE(aqr_step(c, 0.95), AQR_CANCELLED);
    if (!aqr_is_input_point(s, v)) /* in the middle of a long edge: as symmetric as its ends, but for diagonals */
      continue;
    vec3 p = aqr_point(s, v);
    *count += !has_point_near(s, &g, v3_madd(p, -2 * aqr_plane_height(plane, p), plane->normal));
  }
done:
  AQR_DROP(c, g.first, g.size);
  AQR_DROP(c, g.next, s->n_points);
  return status;
}

/* ---- the field of the half ---- */

void aqr_symmetry_complete(const aqr_surface* half, const aqr_plane* plane, float* tensors, double* normals)
{
  vec3 n = plane->normal;
  for (size_t v = 0; v < half->n_points; v++)
  {
    vec3 normal = v3_load(normals + 3 * v);
    if (!half->mirrored[half->clean[v]] || aqr_plane_creases(plane, normal))
      continue;
    double t[6];
    for (size_t a = 0; a < 6; a++)
      t[a] = (double)tensors[6 * v + a];
    /* what couples the plane's normal with directions along the plane changes its sign in the mirror */
    vec3 across = v3(
      t[0] * n.x + t[3] * n.y + t[4] * n.z, t[3] * n.x + t[1] * n.y + t[5] * n.z, t[4] * n.x + t[5] * n.y + t[2] * n.z);
    vec3 a = v3_madd(across, -v3_dot(across, n), n);
    t[0] -= 2 * a.x * n.x;
    t[1] -= 2 * a.y * n.y;
    t[2] -= 2 * a.z * n.z;
    t[3] -= a.x * n.y + a.y * n.x;
    t[4] -= a.x * n.z + a.z * n.x;
    t[5] -= a.y * n.z + a.z * n.y;
    for (size_t a = 0; a < 6; a++)
      tensors[6 * v + a] = (float)t[a];
    v3_store(normals + 3 * v, aqr_plane_normal(plane, normal));
  }
}

/* ---- the mesh of the half ---- */

static bool is_at_plane(const aqr_surface* half, const aqr_polygon_mesh* m, aqr_index v)
{
  const aqr_place* at = &m->vertices[v].place;
  if (!half->mirrored || !aqr_pm_on_border(m, v))
    return false;
  for (unsigned k = 0; k < 3; k++)
    if (at->bary[k] > 0 && !half->mirrored[half->clean[half->corner[3 * at->face + k]]])
      return false;
  return true;
}

static bool is_border(const aqr_polygon_mesh* m, aqr_index h)
{
  return aqr_pm_face(m, h) == AQR_NONE || aqr_pm_face(m, h ^ 1) == AQR_NONE;
}

/* A vertex none of whose edges run along the plane would have a fan of faces on either side. */
bool aqr_symmetry_on_plane(const aqr_surface* half, const aqr_polygon_mesh* m, aqr_index v)
{
  if (!is_at_plane(half, m, v))
    return false;
  aqr_index h = m->vertices[v].out;
  do
  {
    if (is_border(m, h) && is_at_plane(half, m, aqr_pm_to(m, h)))
      return true;
    h = aqr_pm_next_around(m, h);
  } while (h != m->vertices[v].out);
  return false;
}

static bool is_joint(const aqr_surface* half, const aqr_polygon_mesh* m, aqr_index h)
{
  return aqr_pm_edge_lives(m, h) && aqr_pm_face(m, h) == AQR_NONE && is_at_plane(half, m, aqr_pm_from(m, h)) &&
         is_at_plane(half, m, aqr_pm_to(m, h));
}

long long aqr_symmetry_joint(const aqr_surface* half, const aqr_polygon_mesh* m)
{
  long long chi = 0;
  for (aqr_index v = 0; v < m->n_vertices; v++)
    chi += m->vertices[v].out != AQR_NONE && aqr_symmetry_on_plane(half, m, v);
  for (aqr_index h = 0; h < m->n_half_edges; h++)
    chi -= is_joint(half, m, h);
  return chi;
}

size_t aqr_symmetry_loops(const aqr_surface* half, const aqr_polygon_mesh* m)
{
  size_t loops = 0;
  for (aqr_index first = 0; first < m->n_half_edges; first++)
  {
    if (!is_joint(half, m, first))
      continue;
    /* counted at its smallest half-edge */
    aqr_index h = aqr_pm_next(m, first);
    while (h > first && is_joint(half, m, h))
      h = aqr_pm_next(m, h);
    loops += h == first;
  }
  return loops;
}

long long aqr_symmetry_joint_of_surface(const aqr_surface* half)
{
  long long chi = 0;
  for (size_t v = 0; v < half->n_clean; v++)
    chi += half->mirrored[v];
  for (aqr_index h = 0; h < 3 * half->n_faces; h++)
    chi -= aqr_on_plane(half, h);
  return chi;
}

static bool all_on_plane(const aqr_surface* half, const aqr_polygon_mesh* m, aqr_index f)
{
  aqr_index h = m->faces[f];
  do
  {
    if (!aqr_symmetry_on_plane(half, m, aqr_pm_from(m, h)))
      return false;
    h = aqr_pm_next(m, h);
  } while (h != m->faces[f]);
  return true;
}

static aqr_status split_at_middle(aqr_context* c, aqr_polygon_mesh* m, aqr_index h)
{
  aqr_vertex middle = aqr_middle(m, h);
  aqr_index inserted;
  return aqr_pm_split_edge(c, m, h, &middle, &inserted);
}

aqr_status aqr_symmetry_open(aqr_context* c, const aqr_surface* half, aqr_polygon_mesh* m)
{
  aqr_status status = AQR_OK;
  size_t n_faces = m->n_faces;
  for (aqr_index f = 0; f < n_faces; f++)
  {
    if (m->faces[f] == AQR_NONE || !all_on_plane(half, m, f))
      continue;
    if (aqr_pm_face_size(m, f) < 4)
      AQR_TRY(split_at_middle(c, m, m->faces[f]));
    aqr_index h = m->faces[f], k = h;
    for (size_t i = aqr_pm_face_size(m, f) / 2; i > 0; i--)
      k = aqr_pm_next(m, k);
    AQR_TRY(aqr_pm_split_face(c, m, h, k, AQR_LINE_MIN));
  }
  for (aqr_index h = 0, n = (aqr_index)m->n_half_edges; h < n; h += 2)
    if (aqr_pm_edge_lives(m, h) && !is_border(m, h) && aqr_symmetry_on_plane(half, m, aqr_pm_from(m, h)) &&
        aqr_symmetry_on_plane(half, m, aqr_pm_to(m, h)))
      AQR_TRY(split_at_middle(c, m, h));
done:
  return status;
}
