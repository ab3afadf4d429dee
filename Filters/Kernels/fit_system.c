/* SPDX-License-Identifier: BSD-3-Clause */
#include "fit_system.h"

#include <string.h>

enum
{
  solver_steps = 12
};

static const double least_residual = 1e-3; /* of the first, squared: the solver stops */
static const double hold_normal = 0.1;     /* of a vertex in its place, relative to its share of the error */
static const double hold_edge = 0.015;     /* against turning, relative to its ends' shares of the error */
static const double firmest = 10;          /* as often as that are the shortest edges held */

const double aqr_fit_place[AQR_FIT_SAMPLES][3] = { { 0.108103018168070, 0.445948490915965, 0.445948490915965 },
  { 0.445948490915965, 0.108103018168070, 0.445948490915965 },
  { 0.445948490915965, 0.445948490915965, 0.108103018168070 },
  { 0.816847572980459, 0.091576213509771, 0.091576213509771 },
  { 0.091576213509771, 0.816847572980459, 0.091576213509771 },
  { 0.091576213509771, 0.091576213509771, 0.816847572980459 } };
const double aqr_fit_weight[AQR_FIT_SAMPLES] = { 0.223381589678011, 0.223381589678011, 0.223381589678011,
  0.109951743655322, 0.109951743655322, 0.109951743655322 };

static vec3 times(const double* a, vec3 b)
{
  return v3(
    a[0] * b.x + a[3] * b.y + a[4] * b.z, a[3] * b.x + a[1] * b.y + a[5] * b.z, a[4] * b.x + a[5] * b.y + a[2] * b.z);
}

/* The inverse of a symmetric, positive definite matrix; false where it is not. */
static bool invert(const double* a, double* inverse)
{
  double xx = a[1] * a[2] - a[5] * a[5], xy = a[4] * a[5] - a[3] * a[2], xz = a[3] * a[5] - a[4] * a[1];
  double det = a[0] * xx + a[3] * xy + a[4] * xz;
  if (!(det > 0))
    return false;
  const double r[6] = { xx, a[0] * a[2] - a[4] * a[4], a[0] * a[1] - a[3] * a[3], xy, xz, a[3] * a[4] - a[0] * a[5] };
  for (unsigned i = 0; i < 6; i++)
    inverse[i] = r[i] / det;
  return true;
}

/* What holds a vertex in its place, times x. */
static vec3 held(const aqr_fitter* f, const aqr_vertex* v, double share, vec3 x)
{
  double along = v3_dot(x, v->normal);
  return v3_scale(v3_madd(v3_scale(x, f->hold), (hold_normal - f->hold) * along, v->normal), share);
}

static aqr_fit_link* links_of(const aqr_fitter* f, size_t v)
{
  return f->links + f->first_corner[v] + v;
}

/* Adds a block to that of a neighbour, which is new where no link leads to it yet. */
static void add_block(aqr_fit_link* links, size_t* n, aqr_index to, const float* block)
{
  size_t i = 0;
  while (i < *n && links[i].to != to)
    i++;
  if (i == *n)
    links[(*n)++] = (aqr_fit_link){ to, { 0 } };
  for (unsigned k = 0; k < 6; k++)
    links[i].block[k] += block[k];
}

/* What the distances say of each vertex: the right-hand side, its own block, and those of its neighbours. */
static void gather(void* data, size_t begin, size_t end)
{
  aqr_fitter* f = data;
  for (size_t v = begin; v < end; v++)
  {
    aqr_fit_link* links = links_of(f, v);
    double* a = f->block + 6 * v;
    vec3 right = v3(0, 0, 0);
    double area = 0;
    size_t n = 0;
    memset(a, 0, 6 * sizeof *a);
    for (size_t i = f->first_corner[v]; i < f->first_corner[v + 1]; i++)
    {
      const aqr_fit_triangle* t = &f->triangles[f->corners[i] / 3];
      unsigned k = f->corners[i] % 3, k1 = (k + 1) % 3, k2 = (k + 2) % 3;
      float own[6] = { 0 }, one[6] = { 0 }, two[6] = { 0 };
      for (unsigned j = 0; j < AQR_FIT_SAMPLES; j++)
      {
        const float* x = t->at[j].normal;
        const float product[6] = { x[0] * x[0], x[1] * x[1], x[2] * x[2], x[0] * x[1], x[0] * x[2], x[1] * x[2] };
        const float w = (float)aqr_fit_place[j][k], w1 = (float)aqr_fit_place[j][k1], w2 = (float)aqr_fit_place[j][k2];
        for (unsigned d = 0; d < 6; d++)
        {
          own[d] += w * w * product[d];
          one[d] += w * w1 * product[d];
          two[d] += w * w2 * product[d];
        }
        right =
          v3_madd(right, aqr_fit_place[j][k] * (double)t->at[j].distance, v3((double)x[0], (double)x[1], (double)x[2]));
      }
      for (unsigned d = 0; d < 6; d++)
        a[d] += (double)own[d];
      area += (double)t->area;
      add_block(links, &n, t->v[k1], one);
      add_block(links, &n, t->v[k2], two);
    }
    if (n <= f->first_corner[v + 1] - f->first_corner[v])
      links[n].to = AQR_NONE;
    f->share[v] = area / 6; /* the trace of its block, were all samples used */
    f->residual[v] = right;
  }
}

static void note_edges(void* data, size_t begin, size_t end)
{
  aqr_fitter* f = data;
  const aqr_polygon_mesh* m = f->m;
  for (size_t e = begin; e < end; e++)
  {
    aqr_index h = (aqr_index)(2 * e);
    const aqr_vertex *a = &m->vertices[aqr_pm_from(m, h)], *b = &m->vertices[aqr_pm_to(m, h)];
    vec3 across = v3_cross(v3_add(a->normal, b->normal), v3_sub(b->position, a->position));
    f->across[e] = v3_unit_or(across, v3(0, 0, 0));
  }
}

aqr_status aqr_fit_note_edges(aqr_context* c, aqr_fitter* f, double at)
{
  return aqr_parallel(c, f->m->n_half_edges / 2, note_edges, f, at, at);
}

/* Edges are held in the direction of their line: their ends may move along the surface together, as lines do that are
 * moved or spaced anew, but what one moves against the other across the edge is drawn back. Short edges are held more
 * firmly, as the same move turns them farther: by the root of how short they are for the area around them, halfway
 * between a hold on distances and one on angles. */
static void hold_edges(aqr_fitter* f, size_t v)
{
  const aqr_polygon_mesh* m = f->m;
  double* a = f->block + 6 * v;
  aqr_index out = m->vertices[v].out, h = out;
  do
  {
    aqr_index w = aqr_pm_to(m, h);
    vec3 n = f->across[h >> 1], edge = v3_sub(aqr_pm_point(m, w), aqr_pm_point(m, (aqr_index)v));
    double area = f->share[v] + f->share[w], length2 = v3_norm2(edge);
    double hold = hold_edge * area * (area < firmest * firmest * length2 ? sqrt(area / length2) : firmest);
    const double product[6] = { n.x * n.x, n.y * n.y, n.z * n.z, n.x * n.y, n.x * n.z, n.y * n.z };
    aqr_fit_link* to = links_of(f, v);
    while (to->to != w) /* every edge is one of triangles */
      to++;
    for (unsigned d = 0; d < 6; d++)
    {
      a[d] += hold * product[d];
      to->block[d] -= (float)(hold * product[d]);
    }
    f->residual[v] = v3_madd(f->residual[v], hold * v3_dot(edge, n), n);
    h = aqr_pm_next_around(m, h);
  } while (h != out);
}

/* Adds what holds edges and vertices, and sets the solver up. Fixed vertices have no equations. */
static void begin_rows(void* data, size_t begin, size_t end)
{
  aqr_fitter* f = data;
  for (size_t v = begin; v < end; v++)
  {
    const aqr_vertex* x = &f->m->vertices[v];
    double *a = f->block + 6 * v, *inverse = f->inverse + 6 * v, share = f->share[v];
    hold_edges(f, v);
    vec3 e[3] = { held(f, x, share, v3(1, 0, 0)), held(f, x, share, v3(0, 1, 0)), held(f, x, share, v3(0, 0, 1)) };
    const double hold[6] = { e[0].x, e[1].y, e[2].z, e[0].y, e[0].z, e[1].z };
    for (unsigned d = 0; d < 6; d++)
      a[d] += hold[d];
    if (x->kind != AQR_VERTEX_INTERIOR || !invert(a, inverse))
      memset(inverse, 0, 6 * sizeof *inverse);
    f->direction[v] = times(inverse, f->residual[v]);
    f->product[v] = v3_dot(f->residual[v], f->direction[v]);
    f->move[v] = v3(0, 0, 0);
  }
}

/* image = matrix * direction, and what their dot product is the sum of */
static void multiply(void* data, size_t begin, size_t end)
{
  aqr_fitter* f = data;
  for (size_t v = begin; v < end; v++)
  {
    if (!(f->inverse[6 * v] > 0))
    {
      f->image[v] = v3(0, 0, 0);
      f->product[v] = 0;
      continue;
    }
    vec3 sum = times(f->block + 6 * v, f->direction[v]);
    const aqr_fit_link *last = links_of(f, v + 1), *to = links_of(f, v);
    for (; to < last && to->to != AQR_NONE; to++)
    {
      double a[6];
      for (unsigned d = 0; d < 6; d++)
        a[d] = (double)to->block[d];
      sum = v3_add(sum, times(a, f->direction[to->to]));
    }
    f->image[v] = sum;
    f->product[v] = v3_dot(f->direction[v], sum);
  }
}

/* Goes along the direction; image = preconditioned residual. */
static void go_along(void* data, size_t begin, size_t end)
{
  aqr_fitter* f = data;
  for (size_t v = begin; v < end; v++)
  {
    f->move[v] = v3_madd(f->move[v], f->step, f->direction[v]);
    f->residual[v] = v3_madd(f->residual[v], -f->step, f->image[v]);
    f->image[v] = times(f->inverse + 6 * v, f->residual[v]);
    f->product[v] = v3_dot(f->residual[v], f->image[v]);
  }
}

static void turn(void* data, size_t begin, size_t end)
{
  aqr_fitter* f = data;
  for (size_t v = begin; v < end; v++)
    f->direction[v] = v3_madd(f->image[v], f->step, f->direction[v]);
}

/* In the order of the vertices, so that it does not depend on threads. */
static double sum_of_products(const aqr_fitter* f)
{
  double sum = 0;
  for (size_t v = 0; v < f->m->n_vertices; v++)
    sum += f->product[v];
  return sum;
}

/* Conjugate gradients with the blocks of single vertices as preconditioner. The matrix is nearly a mass matrix: few
 * steps are enough, and moves this near to the solution's are judged as well as its own. */
aqr_status aqr_fit_solve(aqr_context* c, aqr_fitter* f, double at)
{
  aqr_status status = AQR_OK;
  size_t n = f->m->n_vertices;
  AQR_TRY(aqr_parallel(c, n, gather, f, at, at));
  AQR_TRY(aqr_parallel(c, n, begin_rows, f, at, at));
  double rho = sum_of_products(f), first = rho;
  for (unsigned step = 0; step < solver_steps && rho > least_residual * first; step++)
  {
    AQR_TRY(aqr_parallel(c, n, multiply, f, at, at));
    double energy = sum_of_products(f);
    if (!(energy > 0))
      break;
    f->step = rho / energy;
    AQR_TRY(aqr_parallel(c, n, go_along, f, at, at));
    double next = sum_of_products(f);
    f->step = next / rho;
    AQR_TRY(aqr_parallel(c, n, turn, f, at, at));
    rho = next;
  }
done:
  return status;
}
