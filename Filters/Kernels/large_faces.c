/* SPDX-License-Identifier: BSD-3-Clause */
#include "large_faces.h"

#include "marks.h"
#include "partition.h"
#include "triangulation.h"

#include <stdlib.h>

static const double straight_cosine = 0.94; /* a chain that turns by less than twenty degrees goes straight on */
static const double length_price = 8; /* of a diagonal as long as the face's perimeter, against angles in radians */

enum
{
  most_compared = 32 /* corners compared with each other to see whether two are of one vertex */
};

/* Between corners from < to of the face, and between two triangles. */
typedef struct diagonal
{
  aqr_index from, to, triangle[2];
  double cost;
} diagonal;

/* Triangles that stay together. */
typedef struct part
{
  aqr_index up; /* a triangle that stands for it, at last for itself */
  unsigned n;
  aqr_index name[AQR_POLYGON_CORNERS];
} part;

typedef struct large_face
{
  aqr_polygon_mesh* m;
  size_t n, n_diagonals;
  aqr_index *corner, *name; /* half-edges at the corners, and their vertices */
  double* xy;               /* the corners in the face's plane */
  aqr_triangle* triangles;
  diagonal* diagonals;
  part* parts; /* per triangle */
  vec3 normal;
  double perimeter;
} large_face;

/* ---- bridges ---- */

/* Whether the loop of h has four corners or more. */
static bool has_four_corners(const aqr_polygon_mesh* m, aqr_index h)
{
  aqr_index third = aqr_pm_next(m, aqr_pm_next(m, h));
  return third != h && aqr_pm_next(m, h) != h && aqr_pm_next(m, third) != h;
}

static bool is_straight_chain(const aqr_polygon_mesh* m, aqr_index a, aqr_index b)
{
  vec3 p = aqr_pm_point(m, aqr_pm_from(m, a));
  vec3 to = v3_sub(aqr_pm_point(m, aqr_pm_to(m, a)), p), fro = v3_sub(aqr_pm_point(m, aqr_pm_to(m, b)), p);
  return aqr_pm_on_chain(m, a) && aqr_pm_on_chain(m, b) &&
         v3_dot(to, fro) < -straight_cosine * v3_norm(to) * v3_norm(fro);
}

/* Arcs end in the middle of some edge of the input where a chain may turn away: a straight edge from there to the other
 * end can cross the chain. Where the start of h lies on a straight chain that only h leaves, it moves to the chain's
 * next vertex on either side if that is nearer to the end of h. */
static void slide_start(aqr_polygon_mesh* m, aqr_index h)
{
  aqr_index s = aqr_pm_from(m, h), end = aqr_pm_to(m, h);
  aqr_index side[2] = { aqr_pm_next_around(m, h), aqr_pm_next_around(m, aqr_pm_next_around(m, h)) }, best = AQR_NONE;
  if ((m->vertices[s].kind != AQR_VERTEX_FEATURE && m->vertices[s].kind != AQR_VERTEX_BOUNDARY))
    return;
  if (aqr_pm_next_around(m, side[1]) != h || side[1] == h || !is_straight_chain(m, side[0], side[1]))
    return;
  double least = v3_norm2(v3_sub(aqr_pm_point(m, s), aqr_pm_point(m, end)));
  for (unsigned i = 0; i < 2; i++)
  {
    aqr_index w = aqr_pm_to(m, side[i]);
    double d = v3_norm2(v3_sub(aqr_pm_point(m, w), aqr_pm_point(m, end)));
    if (d < least && w != end && w != s && has_four_corners(m, side[i]) && has_four_corners(m, side[i] ^ 1) &&
        aqr_pm_find(m, w, end) == AQR_NONE)
    {
      least = d;
      best = side[i];
    }
  }
  if (best != AQR_NONE)
    aqr_pm_contract(m, best ^ 1);
}

/* Of the lines around face f; they stay, edges of the chains they end on go. */
static void slide_ends(large_face* l, aqr_index f)
{
  aqr_polygon_mesh* m = l->m;
  aqr_index h = m->faces[f];
  size_t n = 0;
  do
  {
    if (!aqr_pm_on_chain(m, h))
      l->corner[n++] = h;
    h = aqr_pm_next(m, h);
  } while (h != m->faces[f]);
  for (size_t i = 0; i < n; i++)
  {
    slide_start(m, l->corner[i]);
    slide_start(m, l->corner[i] ^ 1);
  }
  l->n = aqr_pm_face_size(m, f);
}

/* ---- the parts ---- */

static void collect_corners(large_face* l, aqr_index f)
{
  const aqr_polygon_mesh* m = l->m;
  aqr_index h = m->faces[f];
  vec3 normal = v3_unit_or(aqr_pm_area(m, f), m->vertices[aqr_pm_from(m, h)].normal);
  vec3 first = aqr_pm_point(m, aqr_pm_from(m, h));
  vec3 axis = fabs(normal.x) < 0.7 ? v3(1, 0, 0) : v3(0, 1, 0);
  vec3 u = v3_unit(v3_reject(axis, normal)), v = v3_cross(normal, u);
  l->normal = normal;
  for (size_t i = 0; i < l->n; i++, h = aqr_pm_next(m, h))
  {
    l->corner[i] = h;
    l->name[i] = aqr_pm_from(m, h);
    vec3 p = v3_sub(aqr_pm_point(m, l->name[i]), first);
    l->xy[2 * i] = v3_dot(p, u);
    l->xy[2 * i + 1] = v3_dot(p, v);
    l->perimeter += v3_norm(v3_sub(aqr_pm_point(m, aqr_pm_to(m, h)), aqr_pm_point(m, l->name[i])));
  }
}

/* How far the two angles that a diagonal to `to` makes at a corner are from right angles; infinite outside the face,
 * whose normal is the one at vertices of creases. */
static double diagonal_angles(const aqr_polygon_mesh* m, aqr_index h, aqr_index to, vec3 normal)
{
  const aqr_vertex* v = &m->vertices[aqr_pm_from(m, h)];
  normal = v->kind >= AQR_VERTEX_FEATURE ? normal : v->normal;
  vec3 prev = aqr_pm_point(m, aqr_pm_from(m, aqr_pm_prev(m, h))), next = aqr_pm_point(m, aqr_pm_to(m, h));
  vec3 end = aqr_pm_point(m, to);
  double whole = aqr_corner_angle(prev, v->position, next, normal);
  double part = aqr_corner_angle(end, v->position, next, normal);
  const double right = 1.57079632679489662;
  return part < whole ? fmin(right, fabs(part - right)) + fmin(right, fabs(whole - part - right)) : INFINITY;
}

/* Infinite where it cannot be drawn. */
static double cost_of(const large_face* l, aqr_index from, aqr_index to)
{
  const aqr_polygon_mesh* m = l->m;
  aqr_index u = l->name[from], v = l->name[to];
  if (u == v || aqr_pm_find(m, u, v) != AQR_NONE)
    return INFINITY;
  double angles = diagonal_angles(m, l->corner[from], v, l->normal) + diagonal_angles(m, l->corner[to], u, l->normal);
  double length = v3_norm(v3_sub(aqr_pm_point(m, u), aqr_pm_point(m, v)));
  return (angles < INFINITY ? angles : 100) + (l->perimeter > 0 ? length_price * length / l->perimeter : 0);
}

static void collect_diagonals(large_face* l)
{
  for (aqr_index t = 0; t + 2 < l->n; t++)
    for (unsigned i = 0; i < 3; i++)
    {
      const aqr_triangle* a = &l->triangles[t];
      if (a->beside[i] == AQR_NONE || a->beside[i] < t)
        continue;
      aqr_index x = a->corner[i], y = a->corner[(i + 1) % 3];
      diagonal d = { x < y ? x : y, x < y ? y : x, { t, a->beside[i] }, 0 };
      d.cost = cost_of(l, d.from, d.to);
      l->diagonals[l->n_diagonals++] = d;
    }
}

static int dearest_first(const void* a, const void* b)
{
  const diagonal *x = a, *y = b;
  if (x->cost != y->cost)
    return x->cost > y->cost ? -1 : 1;
  return x->from != y->from ? (x->from > y->from) - (x->from < y->from) : (x->to > y->to) - (x->to < y->to);
}

static int innermost_first(const void* a, const void* b)
{
  const diagonal *x = a, *y = b;
  aqr_index across = x->to - x->from, along = y->to - y->from;
  return across != along ? (across > along) - (across < along) : (x->from > y->from) - (x->from < y->from);
}

static part* part_of(large_face* l, aqr_index t)
{
  for (; l->parts[t].up != t; t = l->parts[t].up)
    l->parts[t].up = l->parts[l->parts[t].up].up;
  return &l->parts[t];
}

/* Whether two parts have more corners than there is room for, or a vertex in common beside those of the diagonal. */
static bool stay_apart(const part* a, const part* b, aqr_index u, aqr_index v)
{
  if (a->n + b->n - 2 > AQR_POLYGON_CORNERS)
    return true;
  for (unsigned i = 0; i < a->n; i++)
    for (unsigned j = 0; j < b->n; j++)
      if (a->name[i] == b->name[j] && a->name[i] != u && a->name[i] != v)
        return true;
  return false;
}

static void grow_together(part* a, part* b, aqr_index u, aqr_index v)
{
  for (unsigned j = 0; j < b->n; j++)
    if (b->name[j] != u && b->name[j] != v)
      a->name[a->n++] = b->name[j];
  b->up = a->up;
}

/* Triangles grow together over the diagonals that cost most; the diagonals left are between parts. */
static void leave_best(large_face* l)
{
  size_t left = 0;
  for (aqr_index t = 0; t + 2 < l->n; t++)
  {
    part* p = &l->parts[t];
    p->up = t;
    p->n = 3;
    for (unsigned i = 0; i < 3; i++)
      p->name[i] = l->name[l->triangles[t].corner[i]];
  }
  qsort(l->diagonals, l->n_diagonals, sizeof *l->diagonals, dearest_first);
  for (size_t i = 0; i < l->n_diagonals; i++)
  {
    const diagonal d = l->diagonals[i];
    part *a = part_of(l, d.triangle[0]), *b = part_of(l, d.triangle[1]);
    aqr_index u = l->name[d.from], v = l->name[d.to];
    if (stay_apart(a, b, u, v))
      l->diagonals[left++] = d;
    else
      grow_together(a, b, u, v);
  }
  l->n_diagonals = left;
}

/* From the innermost outwards the part cut off is always small. What goes out from a corner changes where a diagonal
 * begins there, with the smaller number: the corners beyond it lie outside the part. */
static aqr_status draw_diagonals(aqr_context* c, large_face* l)
{
  aqr_polygon_mesh* m = l->m;
  qsort(l->diagonals, l->n_diagonals, sizeof *l->diagonals, innermost_first);
  for (size_t i = 0; i < l->n_diagonals; i++)
  {
    aqr_index from = l->diagonals[i].from, to = l->diagonals[i].to, u = l->name[from], v = l->name[to];
    if (u == v || aqr_pm_find(m, u, v) != AQR_NONE)
      continue; /* maybe drawn between others of its vertices' corners */
    aqr_status status = aqr_pm_split_face(c, m, l->corner[to], l->corner[from], AQR_LINE_MIN);
    if (status != AQR_OK)
      return status;
    l->corner[from] = aqr_pm_prev(m, l->corner[to]);
  }
  return AQR_OK;
}

static aqr_status cut(aqr_context* c, aqr_polygon_mesh* m, aqr_index f, double at)
{
  aqr_status status = AQR_OK;
  size_t n = aqr_pm_face_size(m, f);
  large_face l = { .m = m, .n = n };
  l.corner = AQR_NEW(c, aqr_index, n);
  l.name = AQR_NEW(c, aqr_index, n);
  l.xy = AQR_NEW(c, double, 2 * n);
  l.triangles = AQR_NEW(c, aqr_triangle, n);
  l.diagonals = AQR_NEW(c, diagonal, n);
  l.parts = AQR_NEW(c, part, n);
  AQR_REQUIRE(l.corner && l.name && l.xy && l.triangles && l.diagonals && l.parts, AQR_OUT_OF_MEMORY);
  slide_ends(&l, f);
  AQR_REQUIRE(l.n > 3, AQR_OK);
  collect_corners(&l, f);
  const aqr_outline outline = { l.n, l.xy, l.name };
  AQR_TRY(aqr_triangulate(c, &outline, at, l.triangles));
  collect_diagonals(&l);
  leave_best(&l);
  AQR_TRY(draw_diagonals(c, &l));
done:
  AQR_DROP(c, l.corner, n);
  AQR_DROP(c, l.name, n);
  AQR_DROP(c, l.xy, 2 * n);
  AQR_DROP(c, l.triangles, n);
  AQR_DROP(c, l.diagonals, n);
  AQR_DROP(c, l.parts, n);
  return status;
}

static bool is_to_cut(const aqr_polygon_mesh* m, aqr_index f, const void* options)
{
  const size_t* most = options;
  return m->faces[f] != AQR_NONE && aqr_pm_may_meet_itself(m, f, *most);
}

aqr_status aqr_cut_large_faces(aqr_context* c, aqr_polygon_mesh* m, int largest_valence, double at)
{
  aqr_status status = AQR_OK;
  const size_t n = m->n_faces;
  const size_t largest = largest_valence < AQR_POLYGON_CORNERS ? AQR_POLYGON_CORNERS : (size_t)largest_valence;
  const size_t most = largest < most_compared ? largest : most_compared;
  aqr_marks marks = { 0 };
  AQR_TRY(aqr_mark(c, m, n, is_to_cut, &most, &marks));
  for (aqr_index f = 0; f < n; f++)
    if (aqr_is_marked(&marks, f))
      AQR_TRY(cut(c, m, f, at));
done:
  aqr_marks_free(c, &marks);
  return status;
}
