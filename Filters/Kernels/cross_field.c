/* SPDX-License-Identifier: BSD-3-Clause */
/* A smooth field of crosses: anchored to principal directions where they are trusted and to creases
 * and borders, diffused over the rest. A point's cross is the fourth power z of a unit complex
 * number in the frame (min direction, normal x min direction), so that quarter turns are all one:
 * z = 1 is the principal cross. */
#include "cross_field.h"
#include "flatten.h"

#include <string.h>

enum
{
  sweeps = 12,
  border_reach = 4, /* edges to either side that a border's tangent is taken from */
  steps_between_polls = 4096
};

static const double firm = 0.8;        /* anchors of this weight do not move */
static const double own_start = 0.1;   /* anchors of this weight start from their own direction */
static const double pull = 4;          /* of a full anchor, against the mean of the neighbours */
static const double half_strength = 2; /* curvature difference, the scaled surface's diagonal being 1 */
static const double full_anisotropy = 0.5;
static const double border_weight = 0.4;
static const double seam_agreement = 0.866; /* of two edges up to 15 degrees apart: cos(4 * 15 / 2) */

typedef struct job
{
  const aqr_surface* s;
  const aqr_neighbours* around;
  aqr_field* field;
  double min_cosine;
  aqr_index* previous; /* per point: the point before it along its border or seam, or AQR_NONE */
  aqr_rotor* anchor;   /* per point: weight times direction */
  aqr_rotor* z[2];     /* per point; 0 where not yet known */
  aqr_index* slot;     /* per point: where it is in `active`, or AQR_NONE */
  aqr_index* active;   /* points that are not firmly anchored, ascending */
  size_t n_active;
  aqr_index* first; /* n_active + 1: where each one's begin in `turn` */
  aqr_rotor* turn;  /* brings a neighbour's z into the point's frame */
  aqr_index* queue;
  const aqr_rotor* from;
  aqr_rotor* to;
} job;

static aqr_complex cx_add(aqr_complex a, aqr_complex b)
{
  return cx(a.x + b.x, a.y + b.y);
}
static double size(aqr_complex a)
{
  return sqrt(a.x * a.x + a.y * a.y);
}

/* The principal directions of a point. */
static aqr_frame principal_frame(const aqr_field* field, size_t v)
{
  vec3 m = aqr_min_direction(field, v);
  return (aqr_frame){ m, v3_cross(v3_load(field->normal + 3 * v), m) };
}

/* The fourth power of d's direction; 0 where d has none in the frame. */
static aqr_complex in_frame(aqr_frame at, vec3 d)
{
  double x = v3_dot(d, at.x), y = v3_dot(d, at.y), r2 = x * x + y * y;
  if (!(r2 > 0))
    return cx(0, 0);
  aqr_complex square = cx((x * x - y * y) / r2, 2 * x * y / r2);
  return cx_mul(square, square);
}

/* How far the principal cross is to be believed: coherent around the point, distinct in the ratio of
 * the curvatures, and not just the noise of a flat place, or of a sphere. */
static double trust(const job* j, size_t v)
{
  const aqr_field* f = j->field;
  double a = (double)f->k_min[v], b = (double)f->k_max[v], strength = b - a, all = fabs(a) + fabs(b);
  if (!(strength > 0 && j->min_cosine < 1))
    return 0;
  double ratio = fmin(strength / all / full_anisotropy, 1);
  double coherent = fmax(0, ((double)f->point_confidence[v] - j->min_cosine) / (1 - j->min_cosine));
  coherent = 1 - (1 - coherent) * (1 - coherent);
  double noise = (double)f->noise[v], sure = strength < 2 * noise ? fmax(0, strength / noise - 1) : 1;
  return coherent * sure * ratio * ratio * (3 - 2 * ratio) * strength / (strength + half_strength);
}

/* The edge of border or seam that leaves v, as seen in the frame of `at`. */
static aqr_complex border_edge(const job* j, aqr_index v, aqr_index at)
{
  const aqr_surface* s = j->s;
  return in_frame(principal_frame(j->field, at), v3_sub(aqr_point(s, aqr_to(s, j->s->fan[v])), aqr_point(s, v)));
}

static bool leaves_seam(const job* j, aqr_index v)
{
  return v != AQR_NONE && aqr_is_seam(j->s, j->s->fan[v]);
}

/* Creases hold the cross firmly, but not at their bends. */
static aqr_complex seam_anchor(const job* j, aqr_index v)
{
  aqr_complex mean = cx_add(border_edge(j, v, v), border_edge(j, j->previous[v], v));
  return size(mean) >= 2 * seam_agreement ? cx_unit(mean) : cx(0, 0);
}

/* The tangent of a boundary, the weaker the less clear it is: either the chords over several edges
 * to both sides agree, as on scanned borders that are ragged, or the edges themselves do, as around
 * right-angled corners. Ends where the boundary becomes a seam. */
static aqr_complex boundary_anchor(const job* j, aqr_index v)
{
  const aqr_surface* s = j->s;
  aqr_index ahead = v, behind = v;
  aqr_complex edges = cx(0, 0);
  double n = 0;
  for (int i = 0; i < border_reach; i++)
  {
    const aqr_index from[2] = { ahead, j->previous[behind] };
    for (int k = 0; k < 2; k++)
      if (aqr_is_boundary(s, s->fan[from[k]]))
      {
        edges = cx_add(edges, border_edge(j, from[k], v));
        n++;
        if (k == 0)
          ahead = aqr_to(s, s->fan[ahead]);
        else
          behind = j->previous[behind];
      }
  }
  if (n > 0)
    edges = cx(edges.x / n, edges.y / n);
  vec3 p = aqr_point(s, v);
  aqr_frame own = principal_frame(j->field, v);
  aqr_complex chords =
    cx_add(in_frame(own, v3_sub(aqr_point(s, ahead), p)), in_frame(own, v3_sub(p, aqr_point(s, behind))));
  chords = cx(chords.x / 2, chords.y / 2);
  aqr_complex best = size(edges) > size(chords) ? edges : chords;
  double w = border_weight * size(best);
  return cx(w * best.x, w * best.y);
}

static void anchors(void* data, size_t begin, size_t end)
{
  const job* j = data;
  for (size_t v = begin; v < end; v++)
  {
    double w = trust(j, v);
    aqr_complex a = cx(w, 0);
    if (j->previous[v] != AQR_NONE)
    {
      if (leaves_seam(j, (aqr_index)v) || leaves_seam(j, j->previous[v]))
      {
        aqr_complex b = seam_anchor(j, (aqr_index)v);
        if (size(b) > 0)
          a = b;
      }
      else
      {
        aqr_complex b = boundary_anchor(j, (aqr_index)v);
        a = cx_add(a, cx((1 - w) * (1 - w) * b.x, (1 - w) * (1 - w) * b.y));
      }
    }
    j->anchor[v] = cx_narrow(a);
    double r = size(a);
    j->z[0][v] = r >= own_start ? cx_narrow(cx(a.x / r, a.y / r)) : (aqr_rotor){ 0, 0 };
    j->slot[v] = r < firm ? 0 : AQR_NONE;
  }
}

/* Parallel transport of w's frame to v's, over the rotation that takes one normal to the other. */
static void turns(void* data, size_t begin, size_t end)
{
  const job* j = data;
  const aqr_field* f = j->field;
  for (size_t a = begin; a < end; a++)
  {
    size_t v = j->active[a];
    vec3 n = v3_load(f->normal + 3 * v);
    aqr_frame own = principal_frame(f, v);
    const aqr_index* point = j->around->point + j->around->first[v];
    for (aqr_index i = j->first[a]; i < j->first[a + 1]; i++)
    {
      size_t w = point[i - j->first[a]];
      vec3 m = v3_load(f->normal + 3 * w), d = aqr_min_direction(f, w);
      double both = 1 + v3_dot(n, m);
      if (both > 0)
        d = v3_madd(d, -v3_dot(d, n) / both, v3_add(n, m));
      j->turn[i] = cx_narrow(in_frame(own, d));
    }
  }
}

static aqr_complex mean_around(const job* j, const aqr_rotor* z, size_t a)
{
  const aqr_index* point = j->around->point + j->around->first[j->active[a]];
  float x = 0, y = 0;
  for (aqr_index i = j->first[a]; i < j->first[a + 1]; i++)
  {
    aqr_rotor t = j->turn[i], b = z[point[i - j->first[a]]];
    x += t.x * b.x - t.y * b.y;
    y += t.x * b.y + t.y * b.x;
  }
  double n = (double)(j->first[a + 1] - j->first[a]);
  return n > 0 ? cx((double)x / n, (double)y / n) : cx(0, 0);
}

static void sweep(void* data, size_t begin, size_t end)
{
  const job* j = data;
  for (size_t a = begin; a < end; a++)
  {
    size_t v = j->active[a];
    aqr_complex sum = mean_around(j, j->from, a), own = cx_wide(j->anchor[v]);
    sum = cx_add(sum, cx(pull * own.x, pull * own.y));
    j->to[v] = size(sum) > 0 ? cx_narrow(cx_unit(sum)) : j->from[v];
  }
}

static void store(void* data, size_t begin, size_t end)
{
  const job* j = data;
  for (size_t v = begin; v < end; v++)
  {
    aqr_frame own = principal_frame(j->field, v);
    aqr_complex turn = cx_fourth_root(cx_unit(cx_wide(j->from[v])));
    v3_narrow(j->field->cross + 3 * v, v3_madd(v3_scale(own.x, turn.x), turn.y, own.y));
  }
}

/* The crosses as lines are to see them: flattened once, not along every line. */
static void flatten(void* data, size_t begin, size_t end)
{
  const job* j = data;
  const aqr_surface* s = j->s;
  for (size_t f = begin; f < end; f++)
  {
    vec3 p[3];
    aqr_complex q[3];
    for (unsigned i = 0; i < 3; i++)
      p[i] = aqr_point(s, s->corner[3 * f + i]);
    aqr_lay_flat(p[0], p[1], p[2], q);
    for (unsigned i = 0; i < 3; i++)
    {
      unsigned k = (i + 1) % 3, h = (i + 2) % 3;
      size_t v = s->corner[3 * f + i];
      aqr_complex d = aqr_flatten(v3_load(j->field->normal + 3 * v), aqr_cross(j->field, v), v3_sub(p[k], p[i]),
        v3_sub(p[h], p[i]), cx(q[k].x - q[i].x, q[k].y - q[i].y), cx(q[h].x - q[i].x, q[h].y - q[i].y));
      j->field->flat[3 * f + i] = cx_shorten(cx_fourth(d));
    }
  }
}

/* Gives points without a direction one, ring by ring from those that have one: each ring only from
 * what was known before it, so that the order within does not matter. Components without any anchor
 * start from the frame of one of their points. */
static aqr_status propagate(aqr_context* c, job* j)
{
  aqr_rotor* z = j->z[0];
  size_t n = j->s->n_points, begin = 0, end = 0, seed = 0, poll = 0;
  for (size_t v = 0; v < n; v++)
    if (z[v].x != 0 || z[v].y != 0)
      j->queue[end++] = (aqr_index)v;
  while (end < n || begin < end)
  {
    if (begin == end)
    {
      while (z[seed].x != 0 || z[seed].y != 0)
        seed++;
      z[seed] = (aqr_rotor){ 1, 0 };
      j->queue[end++] = (aqr_index)seed;
    }
    size_t next = end;
    for (size_t i = begin; i < end; i++)
    {
      if (++poll % steps_between_polls == 0 && !aqr_step(c, 0))
        return AQR_CANCELLED;
      aqr_index v = j->queue[i];
      for (aqr_index k = j->around->first[v]; k < j->around->first[v + 1]; k++)
      {
        aqr_index w = j->around->point[k];
        if (z[w].x != 0 || z[w].y != 0 || j->to[w].x != 0)
          continue;
        j->to[w].x = 1; /* queued */
        j->queue[next++] = w;
      }
    }
    for (size_t i = end; i < next; i++)
    {
      aqr_complex mean = mean_around(j, z, j->slot[j->queue[i]]);
      j->to[j->queue[i]] = size(mean) > 0 ? cx_narrow(cx_unit(mean)) : (aqr_rotor){ 1, 0 };
    }
    for (size_t i = end; i < next; i++)
      z[j->queue[i]] = j->to[j->queue[i]];
    begin = end;
    end = next;
  }
  return AQR_OK;
}

/* Borders and seams go counter-clockwise around the surface: each point on one has one edge ahead
 * and one behind. */
static void link_borders(job* j)
{
  const aqr_surface* s = j->s;
  memset(j->previous, 0xff, s->n_points * sizeof *j->previous);
  for (aqr_index v = 0; v < s->n_points; v++)
    if (s->fan[v] != AQR_NONE && aqr_twin(s, s->fan[v]) == AQR_NONE)
      j->previous[aqr_to(s, s->fan[v])] = v;
}

static aqr_status list_active(aqr_context* c, job* j)
{
  size_t n = j->s->n_points;
  for (aqr_index v = 0; v < n; v++)
    if (j->slot[v] != AQR_NONE)
      j->slot[v] = (aqr_index)j->n_active++;
  j->active = AQR_NEW(c, aqr_index, j->n_active);
  j->first = AQR_NEW(c, aqr_index, j->n_active + 1);
  if (!j->active || !j->first)
    return AQR_OUT_OF_MEMORY;
  j->first[0] = 0;
  for (aqr_index v = 0; v < n; v++)
    if (j->slot[v] != AQR_NONE)
    {
      aqr_index a = j->slot[v];
      j->active[a] = v;
      j->first[a + 1] = j->first[a] + j->around->first[v + 1] - j->around->first[v];
    }
  j->turn = AQR_NEW(c, aqr_rotor, j->first[j->n_active]);
  return j->turn ? AQR_OK : AQR_OUT_OF_MEMORY;
}

static bool allocate(aqr_context* c, job* j)
{
  size_t n = j->s->n_points;
  j->previous = AQR_NEW(c, aqr_index, n);
  j->anchor = AQR_NEW(c, aqr_rotor, n);
  j->z[0] = AQR_NEW(c, aqr_rotor, n);
  j->z[1] = AQR_NEW0(c, aqr_rotor, n);
  j->slot = AQR_NEW(c, aqr_index, n);
  j->queue = AQR_NEW(c, aqr_index, n);
  return j->previous && j->anchor && j->z[0] && j->z[1] && j->slot && j->queue;
}

static void release(aqr_context* c, job* j)
{
  size_t n = j->s->n_points;
  if (j->turn)
    AQR_DROP(c, j->turn, j->first[j->n_active]);
  AQR_DROP(c, j->first, j->n_active + 1);
  AQR_DROP(c, j->active, j->n_active);
  AQR_DROP(c, j->previous, n);
  AQR_DROP(c, j->anchor, n);
  AQR_DROP(c, j->z[0], n);
  AQR_DROP(c, j->z[1], n);
  AQR_DROP(c, j->slot, n);
  AQR_DROP(c, j->queue, n);
}

aqr_status aqr_cross_field(
  aqr_context* c, const aqr_surface* s, const aqr_neighbours* around, double min_cosine, aqr_field* field)
{
  aqr_status status = AQR_OK;
  job j = { .s = s, .around = around, .field = field, .min_cosine = min_cosine };
  AQR_REQUIRE(allocate(c, &j), AQR_OUT_OF_MEMORY);
  link_borders(&j);
  AQR_TRY(aqr_parallel(c, s->n_points, anchors, &j, 0.6, 0.65));
  AQR_TRY(list_active(c, &j));
  AQR_TRY(aqr_parallel(c, j.n_active, turns, &j, 0.65, 0.7));
  j.to = j.z[1];
  AQR_TRY(propagate(c, &j));
  memcpy(j.z[1], j.z[0], s->n_points * sizeof *j.z[0]);
  for (int i = 0; i < sweeps; i++)
  {
    j.from = j.z[i % 2];
    j.to = j.z[1 - i % 2];
    AQR_TRY(aqr_parallel(c, j.n_active, sweep, &j, 0.7 + 0.25 * i / sweeps, 0.7 + 0.25 * (i + 1) / sweeps));
  }
  j.from = j.z[sweeps % 2];
  AQR_TRY(aqr_parallel(c, s->n_points, store, &j, 0.95, 0.97));
  AQR_TRY(aqr_parallel(c, s->n_faces, flatten, &j, 0.97, 1));
done:
  release(c, &j);
  return status;
}
