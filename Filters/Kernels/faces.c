/* SPDX-License-Identifier: BSD-3-Clause */
#include "faces.h"

#include "joints.h"
#include "large_faces.h"
#include "marks.h"
#include "partition.h"
#include "peaks.h"
#include "regularize.h"
#include "thin_triangles.h"

enum
{
  rounds = 4
};

static const double near_intersection = 0.2; /* of the local spacing: such vertices are merged (paper 5) */
static const double one_place = 1e-3;        /* of the local spacing: vertices no farther apart are at one place */
static const double tip_cosine = 0.7071;     /* of the angle between two edges that lead to a tip and back */
static const double weld_reach = 0.75;       /* of the local spacing: T-joints as near may become one crossing */
static const double least_gain = 0.05;       /* an operation is worth its while */
static const double merge_allowance = 0.3;   /* what merging near intersections may cost in shape */

/* The corners of f, with vertex `gone` taking the place of `kept` at `middle`; false where there are too many. */
static bool gather(
  const aqr_polygon_mesh* m, aqr_index f, aqr_index gone, aqr_index kept, const aqr_vertex* middle, aqr_polygon* g)
{
  g->n = 0;
  aqr_index h = m->faces[f];
  do
  {
    aqr_index v = aqr_pm_from(m, h);
    bool moved = middle && (v == gone || v == kept);
    const aqr_vertex* w = moved ? middle : &m->vertices[v];
    v = moved ? kept : v;
    if (g->n == 0 || g->vertex[g->n - 1] != v)
    {
      if (g->n == AQR_POLYGON_CORNERS)
        return false;
      aqr_polygon_add(g, v, w);
    }
    h = aqr_pm_next(m, h);
  } while (h != m->faces[f]);
  if (g->n > 1 && g->vertex[g->n - 1] == g->vertex[0])
    g->n--;
  return true;
}

static double face_cost(
  const aqr_polygon_mesh* m, aqr_index f, aqr_index gone, aqr_index kept, const aqr_vertex* middle)
{
  aqr_polygon g;
  if (!gather(m, f, gone, kept, middle, &g))
    return 1.1 * (double)aqr_pm_face_size(m, f);
  return g.n < 3 ? 0 : aqr_polygon_cost(&g);
}

/* Contraction between such faces, lines that go on, and redrawing never make anything else of a quad. */
static bool is_odd(const aqr_polygon_mesh* m, aqr_index f, const void* options)
{
  (void)options;
  return m->faces[f] != AQR_NONE && !aqr_pm_is_quad(m, f);
}

/* Whether both faces beside h have other than four corners. */
static bool between_odd_faces(const aqr_polygon_mesh* m, const aqr_marks* odd, aqr_index h)
{
  aqr_index f = aqr_pm_face(m, h), g = aqr_pm_face(m, h ^ 1);
  return f != AQR_NONE && g != AQR_NONE && aqr_is_marked(odd, f) && aqr_is_marked(odd, g) && !aqr_pm_is_quad(m, f) &&
         !aqr_pm_is_quad(m, g);
}

/* ---- contraction ---- */

/* What contracting h saves in the cost of the faces around its ends. */
static double contraction_gain(const aqr_polygon_mesh* m, aqr_index h, const aqr_vertex* middle)
{
  aqr_index u = aqr_pm_from(m, h), v = aqr_pm_to(m, h), f = aqr_pm_face(m, h), g = aqr_pm_face(m, h ^ 1);
  double gain = 0;
  for (unsigned side = 0; side < 2; side++)
  {
    aqr_index start = h ^ side, k = start;
    do
    {
      aqr_index face = aqr_pm_face(m, k);
      if (face != AQR_NONE && (side == 0 || (face != f && face != g)))
        gain += face_cost(m, face, AQR_NONE, AQR_NONE, NULL) - face_cost(m, face, v, u, middle);
      k = aqr_pm_next_around(m, k);
    } while (k != start);
  }
  return gain;
}

/* Where the ends of h meet when it is contracted. */
static aqr_vertex meeting(const aqr_polygon_mesh* m, aqr_index h)
{
  const aqr_vertex *a = &m->vertices[aqr_pm_from(m, h)], *b = &m->vertices[aqr_pm_to(m, h)];
  if (a->kind == AQR_VERTEX_INTERIOR && b->kind == AQR_VERTEX_INTERIOR)
    return aqr_middle(m, h);
  return b->kind > a->kind ? *b : *a;
}

static double edge_length(const aqr_polygon_mesh* m, aqr_index h)
{
  return v3_norm(v3_sub(aqr_pm_point(m, aqr_pm_from(m, h)), aqr_pm_point(m, aqr_pm_to(m, h))));
}

static double local_size(const aqr_polygon_mesh* m, aqr_index h)
{
  return fmin(m->vertices[aqr_pm_from(m, h)].size, m->vertices[aqr_pm_to(m, h)].size);
}

/* Whether the chain through the edge of h runs straight on, up to twenty degrees, at the end that is given up. */
static bool keeps_chain(const aqr_polygon_mesh* m, aqr_index h)
{
  if (!aqr_pm_on_chain(m, h))
    return true;
  aqr_index t = m->vertices[aqr_pm_to(m, h)].kind > m->vertices[aqr_pm_from(m, h)].kind ? h : h ^ 1;
  vec3 v = aqr_pm_point(m, aqr_pm_from(m, t)), a = v3_sub(v, aqr_pm_point(m, aqr_pm_to(m, t)));
  for (aqr_index k = aqr_pm_next_around(m, t); k != t; k = aqr_pm_next_around(m, k))
  {
    vec3 b = v3_sub(aqr_pm_point(m, aqr_pm_to(m, k)), v);
    if (aqr_pm_on_chain(m, k) && !(v3_dot(a, b) > 0.94 * v3_norm(a) * v3_norm(b)))
      return false;
  }
  return true;
}

static bool contract_if(aqr_polygon_mesh* m, aqr_index h, double least)
{
  if (!aqr_can_contract(m, h))
    return false;
  aqr_vertex middle = meeting(m, h);
  if (edge_length(m, h) <= one_place * local_size(m, h))
    return aqr_contract(m, h, &middle) != AQR_NONE;
  if (!keeps_chain(m, h))
    return false;
  return contraction_gain(m, h, &middle) >= least && aqr_contract(m, h, &middle) != AQR_NONE;
}

/* Three lines that nearly meet in one point make a tiny triangle: its vertices become one (paper 5). */
static bool merge_nearer(aqr_context* c, aqr_polygon_mesh* m, double reach, double at)
{
  for (aqr_index h = 0; h < m->n_half_edges; h += 2)
  {
    if (h % 65536 == 0 && !aqr_step(c, at))
      return false;
    if (aqr_pm_edge_lives(m, h) && edge_length(m, h) <= reach * local_size(m, h))
      contract_if(m, h, -merge_allowance);
  }
  return true;
}

/* Lines that end from both sides on nearby places of a third make two pentagons; where they meet there is a crossing
 * and all faces are quads. Short sides of triangles go likewise. */
static bool weld_joints(aqr_context* c, aqr_polygon_mesh* m, const aqr_marks* odd)
{
  for (aqr_index h = 0; h < m->n_half_edges; h += 2)
  {
    if (h % 65536 == 0 && !aqr_step(c, 0.4))
      return false;
    if (aqr_pm_edge_lives(m, h) && between_odd_faces(m, odd, h) && edge_length(m, h) < weld_reach * local_size(m, h))
      contract_if(m, h, least_gain);
  }
  return true;
}

/* ---- merging and splitting ---- */

/* Draws the diagonals of a partition in a face whose corners are half-edges `corner`. They come outermost first, so
 * that the half-edge after corner `from` and the one before corner `to` still lie in the face at hand. */
static aqr_status draw(aqr_context* c, aqr_polygon_mesh* m, const aqr_index* corner, const aqr_partition* p)
{
  aqr_status status = AQR_OK;
  for (unsigned i = 0; i < p->n; i++)
    AQR_TRY(aqr_pm_split_face(c, m, corner[p->from[i]], aqr_pm_next(m, corner[p->to[i] - 1]), AQR_LINE_MIN));
done:
  return status;
}

static void add_corner(const aqr_polygon_mesh* m, aqr_index h, aqr_polygon* g, aqr_index* corner)
{
  corner[g->n] = h;
  aqr_polygon_add(g, aqr_pm_from(m, h), &m->vertices[aqr_pm_from(m, h)]);
}

/* Whether a vertex at a corner of the polygon keeps at least three edges (two on borders) when an edge at it goes and
 * the diagonals of the partition come. */
static bool keeps_fan(const aqr_polygon_mesh* m, const aqr_polygon* g, unsigned corner, const aqr_partition* p)
{
  size_t valence = aqr_pm_valence(m, g->vertex[corner]) - 1;
  for (unsigned i = 0; i < p->n; i++)
    valence += p->from[i] == corner || p->to[i] == corner;
  return valence >= (aqr_pm_on_border(m, g->vertex[corner]) ? 2 : 3);
}

/* The corners of a face, or more than `most` where there are: large faces are not walked around from each of their
 * edges. */
static size_t corners_up_to(const aqr_polygon_mesh* m, aqr_index f, size_t most)
{
  size_t n = 0;
  aqr_index h = m->faces[f];
  do
  {
    n++;
    h = aqr_pm_next(m, h);
  } while (h != m->faces[f] && n <= most);
  return n;
}

/* Cuts the union of the two faces beside h anew where that is better. */
static aqr_status redraw(aqr_context* c, aqr_polygon_mesh* m, aqr_index h, unsigned largest)
{
  aqr_index f = aqr_pm_face(m, h), other = aqr_pm_face(m, h ^ 1), corner[AQR_POLYGON_CORNERS];
  aqr_polygon g = { .n = 0 };
  size_t n_f = corners_up_to(m, f, AQR_POLYGON_CORNERS), n_other = corners_up_to(m, other, AQR_POLYGON_CORNERS);
  if (n_f + n_other - 2 > AQR_POLYGON_CORNERS || !aqr_can_merge(m, h))
    return AQR_OK;
  double before = face_cost(m, f, AQR_NONE, AQR_NONE, NULL) + face_cost(m, other, AQR_NONE, AQR_NONE, NULL);
  for (aqr_index k = aqr_pm_next(m, h); k != h; k = aqr_pm_next(m, k))
    add_corner(m, k, &g, corner);
  for (aqr_index k = aqr_pm_next(m, h ^ 1); k != (h ^ 1); k = aqr_pm_next(m, k))
    add_corner(m, k, &g, corner);
  aqr_partition p = aqr_best_partition(m, &g, largest, h);
  if (!(p.cost < before - least_gain) || !keeps_fan(m, &g, 0, &p) || !keeps_fan(m, &g, (unsigned)n_f - 1, &p))
    return AQR_OK;
  return aqr_pm_remove_edge(m, h) ? draw(c, m, corner, &p) : AQR_INTERNAL;
}

static aqr_status redraw_all(aqr_context* c, aqr_polygon_mesh* m, const aqr_marks* odd, unsigned largest)
{
  aqr_status status = AQR_OK;
  size_t n = m->n_half_edges;
  for (aqr_index h = 0; h < n; h += 2)
  {
    if (h % 65536 == 0)
      AQR_REQUIRE(aqr_step(c, 0.6), AQR_CANCELLED);
    if (aqr_pm_edge_lives(m, h) && !aqr_pm_on_chain(m, h) && between_odd_faces(m, odd, h))
      AQR_TRY(redraw(c, m, h, largest));
  }
done:
  return status;
}

/* Adds the corners of a face; false where it has more than there is room for. */
static bool add_corners(const aqr_polygon_mesh* m, aqr_index f, aqr_polygon* g, aqr_index* corner)
{
  aqr_index h = m->faces[f];
  do
  {
    if (g->n == AQR_POLYGON_CORNERS)
      return false;
    add_corner(m, h, g, corner);
    h = aqr_pm_next(m, h);
  } while (h != m->faces[f]);
  return true;
}

/* Whether a face has too many corners or a concave one. Splitting it leaves those of all other faces as they are. */
static bool is_to_part(const aqr_polygon_mesh* m, aqr_index f, const void* options)
{
  const aqr_faces_options* o = options;
  aqr_index corner[AQR_POLYGON_CORNERS];
  aqr_polygon g; /* filled as far as there are corners: most faces need nothing more */
  g.n = 0;
  return m->faces[f] != AQR_NONE && (!add_corners(m, f, &g, corner) || (int)g.n > o->largest_valence ||
                                      (o->convex_partition && aqr_polygon_is_concave(&g)));
}

/* The best partition of a face that has too many corners or a concave one (paper 5.2). */
static aqr_status partition_face(aqr_context* c, aqr_polygon_mesh* m, aqr_index f, const aqr_faces_options* o)
{
  aqr_polygon g = { .n = 0 };
  aqr_index corner[AQR_POLYGON_CORNERS];
  if (!is_to_part(m, f, o) || !add_corners(m, f, &g, corner))
    return AQR_OK;
  aqr_partition p = aqr_best_partition(m, &g, o->largest_valence > 5 ? 5 : (unsigned)o->largest_valence, AQR_NONE);
  return p.cost < INFINITY ? draw(c, m, corner, &p) : AQR_OK;
}

/* Faces that a split adds come at the end of the list and are looked at in turn. */
static aqr_status partition_all(aqr_context* c, aqr_polygon_mesh* m, const aqr_faces_options* o, aqr_marks* marks)
{
  aqr_status status = AQR_OK;
  AQR_TRY(aqr_cut_large_faces(c, m, o->largest_valence, 0.7));
  AQR_TRY(aqr_mark(c, m, m->n_faces, is_to_part, o, marks));
  for (aqr_index f = 0; f < m->n_faces; f++)
  {
    if (f % 65536 == 0)
      AQR_REQUIRE(aqr_step(c, 0.8), AQR_CANCELLED);
    if (aqr_is_marked(marks, f))
      AQR_TRY(partition_face(c, m, f, o));
  }
done:
  return status;
}

/* Whether the two edges of a vertex go back nearly the same way: around the tip of a limb, which they stand for. */
static bool is_tip(const aqr_polygon_mesh* m, aqr_index v)
{
  aqr_index h = m->vertices[v].out;
  vec3 a = v3_sub(aqr_pm_point(m, aqr_pm_to(m, h)), aqr_pm_point(m, v));
  vec3 b = v3_sub(aqr_pm_point(m, aqr_pm_to(m, aqr_pm_next_around(m, h))), aqr_pm_point(m, v));
  return v3_dot(a, b) > tip_cosine * v3_norm(a) * v3_norm(b);
}

/* A vertex between two lines that ended there, which no cut has come to, joins their edges. */
static bool join_loose(aqr_context* c, aqr_polygon_mesh* m)
{
  for (aqr_index v = 0; v < m->n_vertices; v++)
  {
    if (v % 65536 == 0 && !aqr_step(c, 0.85))
      return false;
    if (m->vertices[v].out != AQR_NONE && aqr_can_join(m, v) && !is_tip(m, v))
      aqr_pm_join_edges(m, v);
  }
  return true;
}

aqr_status aqr_faces_finish(aqr_context* c, aqr_polygon_mesh* m, const aqr_faces_options* options)
{
  aqr_status status = AQR_OK;
  unsigned largest = options->largest_valence > 5 ? 5 : (unsigned)options->largest_valence;
  aqr_marks marks = { 0 };
  AQR_TRY(aqr_pm_verify(c, m, false));
  AQR_TRY(aqr_tidy(c, m));
  if (options->surface)
    AQR_TRY(aqr_peaks_raise(c, options->surface, options->normals, m));
  AQR_TRY(aqr_cut_large_faces(c, m, options->largest_valence, 0));
  AQR_TRY(aqr_regularize(c, m));
  AQR_REQUIRE(merge_nearer(c, m, near_intersection, 0.2), AQR_CANCELLED);
  for (unsigned round = 1; round <= rounds; round++) /* near partners first, then farther ones */
  {
    AQR_TRY(aqr_mark(c, m, m->n_faces, is_odd, NULL, &marks));
    AQR_REQUIRE(weld_joints(c, m, &marks), AQR_CANCELLED);
    AQR_TRY(aqr_joints_extend(c, m, round));
    AQR_TRY(redraw_all(c, m, &marks, largest));
    AQR_TRY(partition_all(c, m, options, &marks));
  }
  AQR_REQUIRE(join_loose(c, m), AQR_CANCELLED);
  AQR_REQUIRE(aqr_step(c, 0.9), AQR_CANCELLED);
  AQR_TRY(aqr_regularize(c, m));
  if (options->tips)
    AQR_TRY(aqr_tips_raise(c, options->tips, m));
  AQR_REQUIRE(merge_nearer(c, m, one_place, 0.9), AQR_CANCELLED);
  AQR_TRY(aqr_open_thin_triangles(c, m, options->largest_valence));
  AQR_TRY(aqr_regularize(c, m));
  AQR_REQUIRE(aqr_step(c, 0.95), AQR_CANCELLED);
  AQR_TRY(aqr_pm_verify(c, m, true));
  AQR_REQUIRE(aqr_step(c, 0.98), AQR_CANCELLED);
  AQR_TRY(aqr_pm_compact(c, m));
done:
  aqr_marks_free(c, &marks);
  return status;
}
