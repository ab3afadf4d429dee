/* SPDX-License-Identifier: BSD-3-Clause */
#include "tips.h"

#include "closest.h"

enum
{
  most_triangles = 64, /* out of one face */
  enough_points = 2048,
  steps_between_polls = 4096
};

static const double farthest_face =
  1.5; /* times as far from a tip as the nearest face around its bay: it is another's */
static const double least_height = 0.7; /* of a tip over its face, in mean distances of the corners from the centre */

/* ---- bays ---- */

typedef struct search
{
  aqr_context* c;
  const aqr_surface* s;
  const aqr_lines* l;
  const aqr_network* net;
  const aqr_polygon_mesh* m;
  aqr_tips* tips;
  uint8_t* seen;       /* per face of the surface */
  aqr_index* bay_seen; /* per vertex of the mesh: one more than the bay it was last met around */
  aqr_index* stack;
  size_t stack_capacity, depth, steps;
} search;

static aqr_status enter(search* b, aqr_index f)
{
  if (b->seen[f])
    return AQR_OK;
  b->seen[f] = 1;
  if (!AQR_RESERVE(b->c, b->stack, b->stack_capacity, b->depth + 1))
    return AQR_OUT_OF_MEMORY;
  b->stack[b->depth++] = f;
  return AQR_OK;
}

static aqr_status add_border(search* b, aqr_index edge)
{
  aqr_tips* t = b->tips;
  for (unsigned i = 0; i < 2; i++)
  {
    aqr_index v = aqr_pm_from(b->m, 2 * edge + i);
    if (b->bay_seen[v] == t->n_bays)
      continue;
    b->bay_seen[v] = (aqr_index)t->n_bays;
    if (!AQR_RESERVE(b->c, t->border, t->border_capacity, t->n_border + 1))
      return AQR_OUT_OF_MEMORY;
    t->border[t->n_border++] = v;
  }
  return AQR_OK;
}

/* Adds the edges that pass a face to the border; whether curvature lines are among them, which end the bay. */
static aqr_status look_at_chords(search* b, aqr_index f, bool* ends)
{
  *ends = false;
  for (aqr_index k = b->l->head[f]; k != AQR_NONE; k = aqr_next_chord(b->l, k, f))
  {
    bool is_chain = b->l->lines[b->l->samples[k].line].is_chain;
    for (aqr_index i = 0; i < (is_chain ? 1 : 2); i++)
    {
      aqr_index edge = b->net->edge_at[k + i];
      if (edge == AQR_NONE)
        continue;
      *ends |= !is_chain;
      aqr_status status = add_border(b, edge);
      if (status != AQR_OK)
        return status;
    }
  }
  return AQR_OK;
}

static aqr_status add_points(search* b, aqr_index f)
{
  aqr_tips* t = b->tips;
  for (aqr_index h = 3 * f; h < 3 * f + 3; h++)
  {
    aqr_index v = aqr_from(b->s, h);
    if (b->s->fan[v] != h || aqr_twin(b->s, h) == AQR_NONE)
      continue;
    if (!AQR_RESERVE(b->c, t->points, t->point_capacity, t->n_points + 1))
      return AQR_OUT_OF_MEMORY;
    t->points[t->n_points++] = v;
  }
  return AQR_OK;
}

static aqr_status explore(search* b, aqr_index start)
{
  aqr_tips* t = b->tips;
  aqr_status status = AQR_OK;
  AQR_REQUIRE(AQR_RESERVE(b->c, t->bays, t->bay_capacity, t->n_bays + 2), AQR_OUT_OF_MEMORY);
  t->bays[t->n_bays++] = (aqr_bay){ t->n_points, t->n_border };
  AQR_TRY(enter(b, start));
  while (b->depth)
  {
    aqr_index f = b->stack[--b->depth];
    bool ends;
    if (++b->steps % steps_between_polls == 0)
      AQR_REQUIRE(aqr_step(b->c, 1), AQR_CANCELLED);
    AQR_TRY(look_at_chords(b, f, &ends));
    if (ends)
    {
      b->seen[f] = 0; /* other bays may end there as well */
      continue;
    }
    AQR_TRY(add_points(b, f));
    for (aqr_index h = 3 * f; h < 3 * f + 3; h++)
      if (aqr_twin(b->s, h) != AQR_NONE)
        AQR_TRY(enter(b, aqr_face_of(aqr_twin(b->s, h))));
  }
  t->bays[t->n_bays] = (aqr_bay){ t->n_points, t->n_border };
done:
  return status;
}

aqr_status aqr_tips_find(aqr_context* c, const aqr_surface* s, const double* normals, const aqr_lines* l,
  const aqr_network* net, const aqr_polygon_mesh* m, aqr_tips* tips)
{
  aqr_status status = AQR_OK;
  search b = { .c = c, .s = s, .l = l, .net = net, .m = m, .tips = tips };
  *tips = (aqr_tips){ .s = s, .normals = normals };
  b.seen = AQR_NEW0(c, uint8_t, s->n_faces);
  b.bay_seen = AQR_NEW0(c, aqr_index, m->n_vertices);
  AQR_REQUIRE(b.seen && b.bay_seen, AQR_OUT_OF_MEMORY);
  for (aqr_index i = 0; i < l->n_lines; i++)
  {
    const aqr_line* line = &l->lines[i];
    for (size_t k = line->first; !line->is_chain && k + 1 < line->first + line->count; k++)
    {
      bool ends = net->edge_at[k] != AQR_NONE || net->edge_at[k + 1] != AQR_NONE;
      aqr_index f = l->samples[k].face;
      if (!ends && !b.seen[f])
        AQR_TRY(explore(&b, f));
    }
  }
done:
  AQR_DROP(c, b.seen, s->n_faces);
  AQR_DROP(c, b.bay_seen, m->n_vertices);
  AQR_DROP(c, b.stack, b.stack_capacity);
  return status;
}

void aqr_tips_free(aqr_context* c, aqr_tips* t)
{
  AQR_DROP(c, t->bays, t->bay_capacity);
  AQR_DROP(c, t->points, t->point_capacity);
  AQR_DROP(c, t->border, t->border_capacity);
  *t = (aqr_tips){ 0 };
}

/* ---- tips ---- */

typedef struct votes
{
  size_t n;         /* faces of the mesh before any was raised; those that have come since are not voted for */
  aqr_index* count; /* per face, zero between bays */
  uint8_t* raised;
  aqr_index* faces; /* those with votes */
  size_t n_faces, capacity;
} votes;

/* The face with the most corners among the vertices around a bay; AQR_NONE where none of these is left. */
static aqr_status elect(
  aqr_context* c, const aqr_tips* t, size_t bay, const aqr_polygon_mesh* m, votes* v, aqr_index* elected)
{
  *elected = AQR_NONE;
  v->n_faces = 0;
  for (size_t i = t->bays[bay].border; i < t->bays[bay + 1].border; i++)
  {
    aqr_index out = m->vertices[t->border[i]].out, h = out;
    while (h != AQR_NONE)
    {
      aqr_index f = aqr_pm_face(m, h);
      if (f < v->n && v->count[f]++ == 0)
      {
        if (!AQR_RESERVE(c, v->faces, v->capacity, v->n_faces + 1))
          return AQR_OUT_OF_MEMORY;
        v->faces[v->n_faces++] = f;
      }
      h = aqr_pm_next_around(m, h);
      if (h == out)
        break;
    }
  }
  for (size_t i = 0; i < v->n_faces; i++)
    if (*elected == AQR_NONE || v->count[v->faces[i]] > v->count[*elected])
      *elected = v->faces[i];
  for (size_t i = 0; i < v->n_faces; i++)
    v->count[v->faces[i]] = 0;
  return AQR_OK;
}

static vec3 centre_of(const aqr_polygon_mesh* m, aqr_index f)
{
  vec3 sum = v3(0, 0, 0);
  double n = 0;
  aqr_index h = m->faces[f];
  do
  {
    sum = v3_add(sum, aqr_pm_point(m, aqr_pm_from(m, h)));
    n++;
    h = aqr_pm_next(m, h);
  } while (h != m->faces[f]);
  return v3_scale(sum, 1 / n);
}

double aqr_face_radius(const aqr_polygon_mesh* m, aqr_index f, double* size)
{
  const vec3 centre = centre_of(m, f);
  double sum = 0, n = 0;
  aqr_index h = m->faces[f];
  *size = 0;
  do
  {
    const aqr_vertex* v = &m->vertices[aqr_pm_from(m, h)];
    sum += v3_norm(v3_sub(v->position, centre));
    *size += v->size;
    n++;
    h = aqr_pm_next(m, h);
  } while (h != m->faces[f]);
  *size /= n;
  return sum / n;
}

double aqr_face_distance2(const aqr_polygon_mesh* m, aqr_index f, vec3 p)
{
  double least = INFINITY;
  const vec3 centre = centre_of(m, f);
  aqr_index h = m->faces[f];
  do
  {
    least = lesser(
      least, aqr_triangle_distance2(centre, aqr_pm_point(m, aqr_pm_from(m, h)), aqr_pm_point(m, aqr_pm_to(m, h)), p));
    h = aqr_pm_next(m, h);
  } while (h != m->faces[f]);
  return least;
}

/* One diagonal, the vertex into it, then the other spokes. */
aqr_status aqr_raise_face(aqr_context* c, aqr_polygon_mesh* m, aqr_index f, const aqr_vertex* tip)
{
  aqr_status status = AQR_OK;
  aqr_index h = m->faces[f], k = aqr_pm_next(m, aqr_pm_next(m, h)), spoke;
  AQR_TRY(aqr_pm_split_face(c, m, h, k, AQR_LINE_MIN));
  spoke = aqr_pm_prev(m, h);
  aqr_index inserted;
  AQR_TRY(aqr_pm_split_edge(c, m, spoke, tip, &inserted));
  AQR_TRY(aqr_pm_split_face(c, m, aqr_pm_next(m, spoke), aqr_pm_next(m, h), AQR_LINE_MIN));
  spoke = aqr_pm_prev(m, k);
  while (aqr_pm_next(m, aqr_pm_next(m, spoke)) != aqr_pm_prev(m, spoke))
  {
    k = aqr_pm_next(m, aqr_pm_next(m, spoke));
    AQR_TRY(aqr_pm_split_face(c, m, spoke, k, AQR_LINE_MIN));
    spoke = aqr_pm_prev(m, k);
  }
done:
  return status;
}

typedef struct outlier
{
  aqr_index point, face; /* the nearest of what has come of the face elected */
  double distance2;      /* from all faces around the bay */
  double own2;           /* from `face` */
} outlier;

static void look_at_face(const aqr_polygon_mesh* m, aqr_index f, vec3 p, outlier* x)
{
  double d = aqr_face_distance2(m, f, p);
  if (d < x->distance2)
  {
    x->distance2 = x->own2 = d;
    x->face = f;
  }
}

/* The point of a bay farthest from the faces around it; of the one elected comes all from face `first` on. Of very many
 * points some are looked at: a tip is as large as its face. */
static outlier farthest_point(
  const aqr_tips* t, size_t bay, const aqr_polygon_mesh* m, const votes* v, aqr_index elected, size_t first)
{
  outlier best = { AQR_NONE, elected, 0, 0 };
  const size_t begin = t->bays[bay].points, end = t->bays[bay + 1].points, step = (end - begin) / enough_points + 1;
  for (size_t i = begin; i < end; i += step)
  {
    const vec3 p = aqr_point(t->s, t->points[i]);
    outlier x = { t->points[i], elected, INFINITY, INFINITY };
    look_at_face(m, elected, p, &x);
    for (aqr_index f = (aqr_index)first; f < m->n_faces && x.distance2 > best.distance2; f++)
      look_at_face(m, f, p, &x);
    for (size_t k = 0; k < v->n_faces && x.distance2 > best.distance2; k++)
      if (v->faces[k] != elected)
        x.distance2 = lesser(x.distance2, aqr_face_distance2(m, v->faces[k], p));
    if (x.distance2 > best.distance2)
      best = x;
  }
  return best;
}

aqr_vertex aqr_vertex_at(const aqr_surface* s, const double* normals, aqr_index point, double size)
{
  aqr_index h = s->fan[point];
  aqr_vertex r = { .position = aqr_point(s, point), .size = size, .kind = AQR_VERTEX_INTERIOR, .out = AQR_NONE };
  r.normal = v3_load(normals + 3 * (size_t)point);
  r.place.face = aqr_face_of(h);
  r.place.bary[h % 3] = 1;
  return r;
}

/* Raises the face that stands for a bay, and then of what has come of it the nearest to what is still far out. */
static aqr_status raise_over(aqr_context* c, const aqr_tips* t, size_t bay, aqr_polygon_mesh* m, votes* v)
{
  aqr_index f;
  const size_t first = m->n_faces;
  aqr_status status = elect(c, t, bay, m, v, &f);
  if (status != AQR_OK || f == AQR_NONE || v->raised[f])
    return status;
  while (m->n_faces - first < most_triangles)
  {
    const outlier x = farthest_point(t, bay, m, v, f, first);
    double size, radius = aqr_face_radius(m, x.face, &size);
    if (!(sqrt(x.distance2) > least_height * radius) || x.own2 > farthest_face * farthest_face * x.distance2)
      break;
    const aqr_vertex tip = aqr_vertex_at(t->s, t->normals, x.point, size);
    v->raised[f] = 1;
    AQR_TRY(aqr_raise_face(c, m, x.face, &tip));
  }
done:
  return status;
}

aqr_status aqr_tips_raise(aqr_context* c, const aqr_tips* t, aqr_polygon_mesh* m)
{
  aqr_status status = AQR_OK;
  votes v = { .n = m->n_faces };
  v.count = AQR_NEW0(c, aqr_index, v.n);
  v.raised = AQR_NEW0(c, uint8_t, v.n);
  AQR_REQUIRE(v.count && v.raised, AQR_OUT_OF_MEMORY);
  for (size_t i = 0; i < t->n_bays; i++)
  {
    if (i % 1024 == 0)
      AQR_REQUIRE(aqr_step(c, 0.95), AQR_CANCELLED);
    AQR_TRY(raise_over(c, t, i, m, &v));
  }
done:
  AQR_DROP(c, v.count, v.n);
  AQR_DROP(c, v.raised, v.n);
  AQR_DROP(c, v.faces, v.capacity);
  return status;
}
