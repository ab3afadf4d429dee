/* SPDX-License-Identifier: BSD-3-Clause */
#include "peaks.h"

#include "tips.h"

enum
{
  most_faces = 4096, /* of the surface, looked at around a peak */
  enough_vertices = 12,
  polled_points = 65536
};

static const double most_angle = 4.71238898038469; /* around a peak */
static const double likely_cosine = 0.87;          /* of a face's normal to the peak's: of a cone of 270 degrees .75 */
static const double least_height = 0.3; /* of a peak over its face, in mean distances of the corners from the centre */
static const double within_reach = 0.5; /* in the same: a vertex as near is moved to the peak */

/* Vertices of the mesh by the surface's face they lie on, and a search over faces. */
typedef struct neighbourhood
{
  const aqr_surface* s;
  aqr_polygon_mesh* m;
  aqr_index* first; /* per face: a vertex, AQR_NONE without */
  aqr_index* next;  /* per vertex: another one on the same face */
  size_t n_first, n_next;
  uint32_t* seen; /* per face: the last search that came there */
  uint32_t search;
  aqr_index queue[most_faces];
  aqr_index found[enough_vertices];
  unsigned n_found;
} neighbourhood;

static bool is_peak(const aqr_surface* s, const double* normals, aqr_index v)
{
  aqr_index first = s->fan[v], h = first;
  vec3 p = aqr_point(s, v), n = v3_load(normals + 3 * (size_t)v), cross = aqr_face_cross(s, aqr_face_of(first));
  if (!(v3_dot(n, cross) < likely_cosine * v3_norm(cross)))
    return false;
  double angle = 0;
  do
  {
    vec3 a = v3_sub(aqr_point(s, aqr_to(s, h)), p), b = v3_sub(aqr_point(s, aqr_from(s, aqr_prev(h))), p);
    angle += atan2(v3_norm(v3_cross(a, b)), v3_dot(a, b));
    h = aqr_next_around(s, h);
  } while (h != AQR_NONE && h != first);
  return h == first && angle < most_angle;
}

static aqr_status list_vertices(aqr_context* c, neighbourhood* k)
{
  k->n_first = k->s->n_faces;
  k->n_next = k->m->n_vertices;
  k->first = AQR_NEW(c, aqr_index, k->n_first);
  k->next = AQR_NEW(c, aqr_index, k->n_next);
  k->seen = AQR_NEW0(c, uint32_t, k->n_first);
  if (!k->first || !k->next || !k->seen)
    return AQR_OUT_OF_MEMORY;
  for (size_t f = 0; f < k->n_first; f++)
    k->first[f] = AQR_NONE;
  for (aqr_index v = 0; v < k->n_next; v++)
  {
    const aqr_vertex* x = &k->m->vertices[v];
    if (x->out == AQR_NONE)
      continue;
    k->next[v] = k->first[x->place.face];
    k->first[x->place.face] = v;
  }
  return AQR_OK;
}

static void enter(neighbourhood* k, aqr_index f, size_t* tail)
{
  if (*tail == most_faces || k->seen[f] == k->search)
    return;
  k->seen[f] = k->search;
  k->queue[(*tail)++] = f;
}

/* Vertices on the faces nearest to a point, as the crow walks. */
static void find_vertices(neighbourhood* k, aqr_index peak)
{
  size_t head = 0, tail = 0;
  k->search++;
  k->n_found = 0;
  aqr_index first = k->s->fan[peak], h = first;
  do
  {
    enter(k, aqr_face_of(h), &tail);
    h = aqr_next_around(k->s, h);
  } while (h != AQR_NONE && h != first);
  while (head < tail && k->n_found < enough_vertices)
  {
    aqr_index f = k->queue[head++];
    for (aqr_index v = k->first[f]; v != AQR_NONE && k->n_found < enough_vertices; v = k->next[v])
      k->found[k->n_found++] = v;
    for (unsigned i = 0; i < 3; i++)
      if (aqr_twin(k->s, 3 * f + i) != AQR_NONE)
        enter(k, aqr_face_of(aqr_twin(k->s, 3 * f + i)), &tail);
  }
}

static aqr_index nearest_face(const neighbourhood* k, vec3 p, double* distance2)
{
  aqr_index best = AQR_NONE;
  *distance2 = INFINITY;
  for (unsigned i = 0; i < k->n_found; i++)
  {
    aqr_index out = k->m->vertices[k->found[i]].out, h = out;
    do
    {
      aqr_index f = aqr_pm_face(k->m, h);
      double d = f == AQR_NONE ? INFINITY : aqr_face_distance2(k->m, f, p);
      if (d < *distance2)
      {
        *distance2 = d;
        best = f;
      }
      h = aqr_pm_next_around(k->m, h);
    } while (h != out);
  }
  return best;
}

/* The free vertex of a face nearest to p; AQR_NONE where all are held by chains or corners. */
static aqr_index nearest_corner(const aqr_polygon_mesh* m, aqr_index f, vec3 p, double* distance)
{
  aqr_index h = m->faces[f], best = AQR_NONE;
  *distance = INFINITY;
  do
  {
    const aqr_vertex* v = &m->vertices[aqr_pm_from(m, h)];
    double d = v3_norm(v3_sub(v->position, p));
    if (v->kind == AQR_VERTEX_INTERIOR && d < *distance)
    {
      *distance = d;
      best = aqr_pm_from(m, h);
    }
    h = aqr_pm_next(m, h);
  } while (h != m->faces[f]);
  return best;
}

static aqr_status raise_peak(aqr_context* c, neighbourhood* k, const double* normals, aqr_index peak)
{
  aqr_polygon_mesh* m = k->m;
  const vec3 p = aqr_point(k->s, peak);
  double height2, size, distance;
  find_vertices(k, peak);
  aqr_index f = nearest_face(k, p, &height2);
  if (f == AQR_NONE || aqr_pm_face_size(m, f) < 3)
    return AQR_OK;
  double radius = aqr_face_radius(m, f, &size);
  if (!(sqrt(height2) > least_height * radius))
    return AQR_OK;
  aqr_vertex x = aqr_vertex_at(k->s, normals, peak, size);
  x.kind = AQR_VERTEX_CORNER;
  aqr_index near = nearest_corner(m, f, p, &distance);
  if (near == AQR_NONE || distance > within_reach * radius)
    return aqr_raise_face(c, m, f, &x);
  x.out = m->vertices[near].out;
  m->vertices[near] = x;
  return AQR_OK;
}

aqr_status aqr_peaks_raise(aqr_context* c, const aqr_surface* s, const double* normals, aqr_polygon_mesh* m)
{
  aqr_status status = AQR_OK;
  neighbourhood k = { .s = s, .m = m };
  for (aqr_index v = 0; v < s->n_points; v++)
  {
    if (v % polled_points == 0)
      AQR_REQUIRE(aqr_step(c, 0.9), AQR_CANCELLED);
    if (!is_peak(s, normals, v))
      continue;
    if (!k.first)
      AQR_TRY(list_vertices(c, &k));
    AQR_TRY(raise_peak(c, &k, normals, v));
  }
done:
  AQR_DROP(c, k.first, k.n_first);
  AQR_DROP(c, k.next, k.n_next);
  AQR_DROP(c, k.seen, k.n_first);
  return status;
}
