/* SPDX-License-Identifier: BSD-3-Clause */
#include "partition.h"

#include <string.h>

#define PI 3.14159265358979323846

static const double straight = PI * 19 / 18; /* a T-joint on a curved line bends by a few degrees */
static const double corner_price = 1.1; /* of every corner beyond the fourth, and of the missing one of a triangle */
static const double angle_price = 0.9;  /* of a corner that is off by a right angle */
static const double concave_price = 5;

double aqr_corner_angle(vec3 prev, vec3 p, vec3 next, vec3 normal)
{
  vec3 in = v3_sub(p, prev), out = v3_sub(next, p);
  return PI - atan2(v3_dot(normal, v3_cross(in, out)), v3_dot(v3_reject(in, normal), v3_reject(out, normal)));
}

void aqr_polygon_add(aqr_polygon* g, aqr_index index, const aqr_vertex* v)
{
  unsigned i = g->n++;
  g->p[i] = v->position;
  g->normal[i] = v->normal;
  g->sharp[i] = v->kind >= AQR_VERTEX_FEATURE;
  g->vertex[i] = index;
  vec3 area = i > 1 ? v3_cross(v3_sub(g->p[i - 1], g->p[0]), v3_sub(g->p[i], g->p[0])) : v3(0, 0, 0);
  g->area = i > 1 ? v3_add(g->area, area) : area;
}

/* The angle of corner b between corners a and c. */
static double angle_at(const aqr_polygon* g, unsigned a, unsigned b, unsigned c)
{
  vec3 normal = g->sharp[b] ? v3_unit_or(g->area, g->normal[b]) : g->normal[b];
  return aqr_corner_angle(g->p[a], g->p[b], g->p[c], normal);
}

double aqr_polygon_angle(const aqr_polygon* g, unsigned i)
{
  return angle_at(g, i ? i - 1 : g->n - 1, i, i + 1 < g->n ? i + 1 : 0);
}

/* Cost of n corner angles: the four smallest are meant to be right, the others straight. */
static double angles_cost(double* angle, unsigned n)
{
  double cost = n == 3 ? corner_price : corner_price * (n - 4.0);
  for (unsigned i = 0; i < n; i++)
    if (angle[i] > straight)
      cost += concave_price + 3 * (angle[i] / PI - 1);
  for (unsigned i = 0; i < n && i < 4; i++) /* selects the smallest four in order */
    for (unsigned j = i + 1; j < n; j++)
      if (angle[j] < angle[i])
      {
        double swap = angle[i];
        angle[i] = angle[j];
        angle[j] = swap;
      }
  for (unsigned i = 0; i < n; i++)
  {
    double off = (angle[i] - (i < 4 ? PI / 2 : PI)) / (PI / 2);
    cost += angle_price * off * off;
  }
  return cost;
}

static double cost_of(const aqr_polygon* g, const unsigned char* corner, unsigned n)
{
  double angle[AQR_POLYGON_CORNERS];
  for (unsigned i = 0; i < n; i++)
  {
    unsigned a = corner[i ? i - 1 : n - 1], b = corner[i], c = corner[i + 1 < n ? i + 1 : 0];
    angle[i] = angle_at(g, a, b, c);
  }
  return angles_cost(angle, n);
}

double aqr_polygon_cost(const aqr_polygon* g)
{
  unsigned char corner[AQR_POLYGON_CORNERS];
  for (unsigned i = 0; i < g->n; i++)
    corner[i] = (unsigned char)i;
  return cost_of(g, corner, g->n);
}

bool aqr_polygon_is_concave(const aqr_polygon* g)
{
  for (unsigned i = 0; i < g->n; i++)
    if (aqr_polygon_angle(g, i) > straight)
      return true;
  return false;
}

/* Costs of the parts on one side of a chord, by dynamic programming: of all polygons that lie beside the chord i - j
 * inside corners i .. j, the one that with the parts behind its own sides is cheapest. */
typedef struct table
{
  const aqr_polygon* g;
  bool open[AQR_POLYGON_CORNERS][AQR_POLYGON_CORNERS]; /* the chord may be drawn, or is a side */
  double cost[AQR_POLYGON_CORNERS][AQR_POLYGON_CORNERS];
  unsigned char n[AQR_POLYGON_CORNERS][AQR_POLYGON_CORNERS];
  unsigned char part[AQR_POLYGON_CORNERS][AQR_POLYGON_CORNERS][5];
} table;

static void try_part(table* t, const unsigned char* corner, unsigned n)
{
  unsigned i = corner[0], j = corner[n - 1];
  double behind = 0;
  for (unsigned k = 0; k + 1 < n; k++)
  {
    if (!t->open[corner[k]][corner[k + 1]])
      return;
    behind += t->cost[corner[k]][corner[k + 1]];
  }
  if (!(behind < t->cost[i][j]))
    return;
  double cost = behind + cost_of(t->g, corner, n);
  if (cost < t->cost[i][j])
  {
    t->cost[i][j] = cost;
    t->n[i][j] = (unsigned char)n;
    memcpy(t->part[i][j], corner, n);
  }
}

static void fill(table* t, unsigned i, unsigned j, unsigned largest)
{
  unsigned char k[5] = { (unsigned char)i };
  for (unsigned a = i + 1; a < j; a++)
  {
    k[1] = (unsigned char)a;
    k[2] = (unsigned char)j;
    try_part(t, k, 3);
    for (unsigned b = a + 1; b < j && largest > 3; b++)
    {
      k[2] = (unsigned char)b;
      k[3] = (unsigned char)j;
      try_part(t, k, 4);
      for (unsigned d = b + 1; d < j && largest > 4; d++)
      {
        k[3] = (unsigned char)d;
        k[4] = (unsigned char)j;
        try_part(t, k, 5);
      }
    }
  }
}

static void emit(const table* t, unsigned i, unsigned j, aqr_partition* r)
{
  for (unsigned k = 0; k + 1 < t->n[i][j]; k++)
  {
    unsigned a = t->part[i][j][k], b = t->part[i][j][k + 1];
    if (b == a + 1)
      continue;
    r->from[r->n] = (unsigned char)a;
    r->to[r->n++] = (unsigned char)b;
    emit(t, a, b, r);
  }
}

aqr_partition aqr_best_partition(const aqr_polygon_mesh* m, const aqr_polygon* g, unsigned largest, aqr_index ignore)
{
  table t;
  aqr_partition r = { .cost = INFINITY };
  unsigned n = g->n;
  if (n < 3)
    return r;
  t.g = g;
  for (unsigned i = 0; i < n; i++)
    for (unsigned j = i + 1; j < n; j++)
    {
      bool side = j == i + 1 || (i == 0 && j == n - 1);
      aqr_index h = side ? AQR_NONE : aqr_pm_find(m, g->vertex[i], g->vertex[j]);
      t.open[i][j] = side || h == AQR_NONE || (ignore != AQR_NONE && h >> 1 == ignore >> 1);
      t.cost[i][j] = j == i + 1 ? 0 : INFINITY;
    }
  for (unsigned length = 2; length < n; length++)
    for (unsigned i = 0; i + length < n; i++)
      if (t.open[i][i + length])
        fill(&t, i, i + length, largest);
  r.cost = t.cost[0][n - 1];
  if (r.cost < INFINITY)
    emit(&t, 0, n - 1, &r);
  return r;
}
