/* SPDX-License-Identifier: BSD-3-Clause */
#include "joints.h"

#include "partition.h"
#include "regularize.h"

enum
{
  most_reach = 8
};

static const double vertex_price = 0.3; /* of a vertex added, against 1.1 for a pentagon too many */

/* A line that goes on from a corner of a face: the edges it crosses, seen from the side it comes from. */
typedef struct path
{
  aqr_index start; /* half-edge at the T-joint */
  aqr_index across[most_reach];
  unsigned n;
  double gain;
} path;

static aqr_index after(const aqr_polygon_mesh* m, aqr_index h, unsigned steps)
{
  while (steps--)
    h = aqr_pm_next(m, h);
  return h;
}

static bool has_size(const aqr_polygon_mesh* m, aqr_index h, unsigned n)
{
  for (unsigned i = 1; i < n; i++)
    if (after(m, h, i) == h)
      return false;
  return after(m, h, n) == h;
}

/* Collects corners from h on. */
static void add(const aqr_polygon_mesh* m, aqr_index h, unsigned count, aqr_polygon* g)
{
  for (unsigned i = 0; i < count; i++, h = aqr_pm_next(m, h))
    aqr_polygon_add(g, aqr_pm_from(m, h), &m->vertices[aqr_pm_from(m, h)]);
}

static double cost_of_face(const aqr_polygon_mesh* m, aqr_index h, unsigned n)
{
  aqr_polygon g = { .n = 0 };
  add(m, h, n, &g);
  return aqr_polygon_cost(&g);
}

/* Where the line that divides one side of a strip in a given ratio crosses the opposite side. */
static aqr_vertex crossing(const aqr_polygon_mesh* m, aqr_index h, double ratio)
{
  aqr_vertex r = aqr_middle(m, h);
  r.position =
    v3_madd(v3_scale(aqr_pm_point(m, aqr_pm_from(m, h)), 1 - ratio), ratio, aqr_pm_point(m, aqr_pm_to(m, h)));
  return r;
}

/* How the vertex where h starts divides the line from its predecessor to its successor, seen from the successor. */
static double ratio_at(const aqr_polygon_mesh* m, aqr_index h)
{
  vec3 p = aqr_pm_point(m, aqr_pm_from(m, h));
  double a = v3_norm(v3_sub(aqr_pm_point(m, aqr_pm_to(m, h)), p));
  double b = v3_norm(v3_sub(aqr_pm_point(m, aqr_pm_from(m, aqr_pm_prev(m, h))), p));
  return a + b > 0 ? fmax(0.2, fmin(0.8, a / (a + b))) : 0.5;
}

/* What a pentagon costs that is cut from the corner at h to a new vertex on the opposite side. */
static double cut_pentagon(const aqr_polygon_mesh* m, aqr_index h, const aqr_vertex* w)
{
  aqr_polygon a = { .n = 0 }, b = { .n = 0 };
  add(m, h, 3, &a);
  aqr_polygon_add(&a, AQR_NONE, w);
  aqr_polygon_add(&b, AQR_NONE, w);
  add(m, after(m, h, 3), 2, &b);
  add(m, h, 1, &b);
  return aqr_polygon_cost(&a) + aqr_polygon_cost(&b);
}

/* What a quad costs that is cut between two new vertices on its side h and on the opposite side. */
static double cut_quad(const aqr_polygon_mesh* m, aqr_index h, const aqr_vertex* v, const aqr_vertex* w)
{
  aqr_polygon a = { .n = 0 }, b = { .n = 0 };
  aqr_polygon_add(&a, AQR_NONE, v);
  add(m, after(m, h, 1), 2, &a);
  aqr_polygon_add(&a, AQR_NONE, w);
  aqr_polygon_add(&b, AQR_NONE, w);
  add(m, after(m, h, 3), 1, &b);
  add(m, h, 1, &b);
  aqr_polygon_add(&b, AQR_NONE, v);
  return aqr_polygon_cost(&a) + aqr_polygon_cost(&b);
}

/* What the line leaves behind in the face where it ends, beyond the side h: a triangle becomes a quad, a pentagon is
 * cut at its own T-joint. Infinite where the line cannot end there. */
static double end_in(const aqr_polygon_mesh* m, aqr_index h, const aqr_vertex* v)
{
  aqr_polygon a = { .n = 0 }, b = { .n = 0 };
  if (has_size(m, h, 3))
  {
    aqr_polygon_add(&a, AQR_NONE, v);
    add(m, after(m, h, 1), 3, &a);
    return aqr_polygon_cost(&a) - cost_of_face(m, h, 3);
  }
  if (!has_size(m, h, 5))
    return INFINITY;
  aqr_polygon_add(&a, AQR_NONE, v);
  add(m, after(m, h, 1), 3, &a);
  add(m, after(m, h, 3), 3, &b);
  aqr_polygon_add(&b, AQR_NONE, v);
  return aqr_polygon_cost(&a) + aqr_polygon_cost(&b) - cost_of_face(m, h, 5);
}

/* Follows the line from the corner at h through quads to where it may end. */
static path follow(const aqr_polygon_mesh* m, aqr_index h, unsigned reach)
{
  path best = { .start = h, .gain = 0 }, p = best;
  aqr_index visited[most_reach], o = after(m, h, 2);
  double ratio = ratio_at(m, h);
  aqr_vertex w = crossing(m, o, ratio);
  p.gain = cost_of_face(m, h, 5) - cut_pentagon(m, h, &w);
  while (p.n < reach && p.n < most_reach)
  {
    visited[p.n] = aqr_pm_face(m, o);
    p.across[p.n++] = o;
    p.gain -= vertex_price;
    aqr_index k = o ^ 1, face = aqr_pm_face(m, k);
    for (unsigned i = 0; i < p.n; i++)
      if (visited[i] == face)
        return best;
    double end = face == AQR_NONE ? 0 : end_in(m, k, &w);
    if (end < INFINITY)
    {
      p.gain -= end;
      return p.gain > 0 ? p : best;
    }
    if (!has_size(m, k, 4))
      break;
    aqr_vertex v = w;
    o = after(m, k, 2);
    w = crossing(m, o, ratio); /* sides of a strip run the same way when each is seen from before */
    p.gain += cost_of_face(m, k, 4) - cut_quad(m, k, &v, &w);
  }
  return best;
}

static aqr_status extend(aqr_context* c, aqr_polygon_mesh* m, const path* p)
{
  aqr_status status = AQR_OK;
  aqr_index h = p->start, inserted;
  double ratio = ratio_at(m, h);
  for (unsigned i = 0; i < p->n; i++)
  {
    aqr_index o = p->across[i];
    aqr_vertex w = crossing(m, o, ratio);
    AQR_TRY(aqr_pm_split_edge(c, m, o, &w, &inserted));
    AQR_TRY(aqr_pm_split_face(c, m, h, aqr_pm_next(m, o), AQR_LINE_MIN));
    h = o ^ 1;
  }
  if (aqr_pm_face(m, h) != AQR_NONE && has_size(m, h, 6))
    AQR_TRY(aqr_pm_split_face(c, m, h, after(m, h, 3), AQR_LINE_MIN));
done:
  return status;
}

/* The straightest corner of a pentagon. */
static aqr_index joint_of(const aqr_polygon_mesh* m, aqr_index h)
{
  aqr_polygon g = { .n = 0 };
  unsigned best = 0;
  add(m, h, 5, &g);
  for (unsigned i = 1; i < 5; i++)
    if (aqr_polygon_angle(&g, i) > aqr_polygon_angle(&g, best))
      best = i;
  return after(m, h, best);
}

aqr_status aqr_joints_extend(aqr_context* c, aqr_polygon_mesh* m, unsigned reach)
{
  aqr_status status = AQR_OK;
  size_t n = m->n_faces;
  for (aqr_index f = 0; f < n; f++)
  {
    if (f % 65536 == 0)
      AQR_REQUIRE(aqr_step(c, 0.5), AQR_CANCELLED);
    if (m->faces[f] == AQR_NONE || !has_size(m, m->faces[f], 5))
      continue;
    path p = follow(m, joint_of(m, m->faces[f]), reach);
    if (p.n == 0)
      continue;
    AQR_TRY(extend(c, m, &p));
  }
done:
  return status;
}
