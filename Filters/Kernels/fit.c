/* SPDX-License-Identifier: BSD-3-Clause */
#include "fit.h"

#include "chain_places.h"
#include "closest.h"
#include "fans.h"

#include <stdatomic.h>
#include <string.h>

enum
{
  most_steps = 512, /* faces walked from a corner of a polygon to below a sample of it */
  rounds = 4,
  solver_steps = 12,
  damp_rounds = 6,
  samples = 6
};

static const double least_residual = 1e-3; /* of the first, squared: the solver stops */
static const double hold_normal = 1e-3;    /* of a vertex in its place, relative to its part of the error */
static const double hold_first = 5;        /* along the surface, where the error says little, in the first round */
static const double hold_tangent = 0.02;   /* and in the others */
static const double hold_edge = 0.12;      /* against turning, relative to its ends' parts of the error */
static const double farthest_move = 0.3;   /* of the shortest edge at a vertex, in one round */
static const double least_sine = 0.3;      /* of a corner's angle: a move does not make it smaller than that */
static const double open_height = 0.01;    /* of a corner that was straight, over the line between its neighbours */
static const double farthest_sample =
  0.5;                                  /* of the longest side: what is farther away is another part of the surface */
static const double least_cosine = 0.3; /* between a polygon and the surface below it */

/* Quadrature of degree four over a triangle (Dunavant 1985): squared distances from a quadratic surface are exact. */
static const double barycentric[samples][3] = { { 0.108103018168070, 0.445948490915965, 0.445948490915965 },
  { 0.445948490915965, 0.108103018168070, 0.445948490915965 },
  { 0.445948490915965, 0.445948490915965, 0.108103018168070 },
  { 0.816847572980459, 0.091576213509771, 0.091576213509771 },
  { 0.091576213509771, 0.816847572980459, 0.091576213509771 },
  { 0.091576213509771, 0.091576213509771, 0.816847572980459 } };
static const double weight[samples] = { 0.223381589678011, 0.223381589678011, 0.223381589678011, 0.109951743655322,
  0.109951743655322, 0.109951743655322 };

/* A place in a triangle and the tangent plane of the surface below it, both scaled by the root of the area it stands
 * for. */
typedef struct sample
{
  float normal[3], distance;
  aqr_index face; /* where the next round looks first */
} sample;

/* A triangle of a polygon. */
typedef struct triangle
{
  aqr_index v[3];
  sample at[samples];
  float error; /* squared distance, over the area */
} triangle;

/* What a vertex has to do with a neighbour: a block of the matrix, xx yy zz xy xz yz. */
typedef struct link
{
  aqr_index to; /* AQR_NONE: no further neighbours */
  float block[6];
} link;

/* What threads write to without waiting for each other. */
typedef _Atomic(uint8_t) shared_flag;

typedef struct fit
{
  const aqr_surface* s;
  const double* normals; /* of the surface, 3 per point, or NULL */
  aqr_polygon_mesh* m;
  size_t n_triangles;
  size_t* first; /* per face: its first triangle; n_faces + 1 */
  triangle* triangles;
  size_t* first_corner; /* per vertex, into `corners`; n_vertices + 2 */
  aqr_index* corners;   /* 3 * triangle + corner */
  link* links;          /* per vertex: one more than its corners, as a fan has at most so many neighbours */
  vec3 *move, *residual, *direction, *image, *before;
  vec3* across;       /* per edge: along the surface and across the edge, scaled by the root of what holds it */
  double* trace;      /* per vertex: of its part of the error */
  double* block;      /* per vertex: its own block of the matrix, as in link */
  double* inverse;    /* of it; 0 where the vertex stays */
  double* product;    /* per vertex: its term of the sum that the solver takes next */
  double* error;      /* per vertex: of its triangles, before the last move */
  uint8_t* back;      /* per vertex: the last move was damped or taken back */
  shared_flag* folds; /* per vertex: at a corner that folds */
  shared_flag folded; /* any does */
  double hold;        /* along the surface */
  double step;        /* of the solver along the direction, or how much of the last direction the next one keeps */
  double keep;        /* of moves that fold */
} fit;

static void snap(void* data, size_t begin, size_t end)
{
  fit* f = data;
  for (size_t v = begin; v < end; v++)
  {
    aqr_vertex* x = &f->m->vertices[v];
    bool placed = x->place.bary[0] + x->place.bary[1] + x->place.bary[2] > 0;
    if (x->kind != AQR_VERTEX_INTERIOR && placed)
      continue;
    aqr_closest near;
    aqr_closest_near(f->s, x->place.face, x->position, most_steps, true, &near);
    x->position = near.position;
    x->place = near.place;
  }
}

/* ---- triangles ---- */

static aqr_status allocate(aqr_context* c, fit* f)
{
  const aqr_polygon_mesh* m = f->m;
  f->first = AQR_NEW(c, size_t, m->n_faces + 1);
  if (!f->first)
    return AQR_OUT_OF_MEMORY;
  for (aqr_index i = 0; i < m->n_faces; i++)
  {
    f->first[i] = f->n_triangles;
    f->n_triangles += aqr_pm_face_size(m, i) - 2;
  }
  f->first[m->n_faces] = f->n_triangles;
  if (f->n_triangles > AQR_NONE / 3)
    return AQR_TOO_LARGE;
  size_t n = m->n_vertices;
  f->triangles = AQR_NEW(c, triangle, f->n_triangles);
  f->first_corner = AQR_NEW(c, size_t, n + 2);
  f->corners = AQR_NEW(c, aqr_index, 3 * f->n_triangles);
  f->links = AQR_NEW(c, link, 3 * f->n_triangles + n);
  f->move = AQR_NEW(c, vec3, n);
  f->residual = AQR_NEW(c, vec3, n);
  f->direction = AQR_NEW(c, vec3, n);
  f->image = AQR_NEW(c, vec3, n);
  f->before = AQR_NEW(c, vec3, n);
  f->across = AQR_NEW(c, vec3, m->n_half_edges / 2);
  f->trace = AQR_NEW(c, double, n);
  f->block = AQR_NEW(c, double, 6 * n);
  f->inverse = AQR_NEW(c, double, 6 * n);
  f->product = AQR_NEW(c, double, n);
  f->error = AQR_NEW(c, double, n);
  f->back = AQR_NEW0(c, uint8_t, n);
  f->folds = AQR_NEW(c, shared_flag, n);
  return f->triangles && f->first_corner && f->corners && f->links && f->move && f->residual && f->direction &&
             f->image && f->before && f->across && f->trace && f->block && f->inverse && f->product && f->error &&
             f->back && f->folds
           ? AQR_OK
           : AQR_OUT_OF_MEMORY;
}

static void release(aqr_context* c, fit* f)
{
  size_t n = f->m->n_vertices;
  AQR_DROP(c, f->first, f->m->n_faces + 1);
  AQR_DROP(c, f->triangles, f->n_triangles);
  AQR_DROP(c, f->first_corner, n + 2);
  AQR_DROP(c, f->corners, 3 * f->n_triangles);
  AQR_DROP(c, f->links, 3 * f->n_triangles + n);
  AQR_DROP(c, f->move, n);
  AQR_DROP(c, f->residual, n);
  AQR_DROP(c, f->direction, n);
  AQR_DROP(c, f->image, n);
  AQR_DROP(c, f->before, n);
  AQR_DROP(c, f->across, f->m->n_half_edges / 2);
  AQR_DROP(c, f->trace, n);
  AQR_DROP(c, f->block, 6 * n);
  AQR_DROP(c, f->inverse, 6 * n);
  AQR_DROP(c, f->product, n);
  AQR_DROP(c, f->error, n);
  AQR_DROP(c, f->back, n);
  AQR_DROP(c, f->folds, n);
}

/* Fans, as programs that read the mesh take it. */
static void triangulate(void* data, size_t begin, size_t end)
{
  fit* f = data;
  aqr_polygon_mesh* m = f->m;
  for (size_t i = begin; i < end; i++)
  {
    aqr_fan_start(m, (aqr_index)i);
    aqr_index h = m->faces[i], a = aqr_pm_from(m, h);
    for (size_t t = f->first[i]; t < f->first[i + 1]; t++)
    {
      h = aqr_pm_next(m, h);
      triangle* x = &f->triangles[t];
      x->v[0] = a;
      x->v[1] = aqr_pm_from(m, h);
      x->v[2] = aqr_pm_to(m, h);
    }
  }
}

static void list_corners(fit* f)
{
  size_t n = f->m->n_vertices;
  for (size_t v = 0; v < n + 2; v++)
    f->first_corner[v] = 0;
  for (size_t t = 0; t < f->n_triangles; t++)
    for (unsigned k = 0; k < 3; k++)
      f->first_corner[f->triangles[t].v[k] + 2]++;
  for (size_t v = 0; v < n; v++)
    f->first_corner[v + 2] += f->first_corner[v + 1];
  for (size_t t = 0; t < f->n_triangles; t++)
    for (unsigned k = 0; k < 3; k++)
      f->corners[f->first_corner[f->triangles[t].v[k] + 1]++] = (aqr_index)(3 * t + k);
}

/* ---- the normal equations ---- */

static void start_samples(void* data, size_t begin, size_t end)
{
  fit* f = data;
  for (size_t i = begin; i < end; i++)
    for (unsigned k = 0; k < samples; k++)
    {
      const double* w = barycentric[k];
      unsigned nearest = w[0] >= w[1] && w[0] >= w[2] ? 0 : w[1] >= w[2] ? 1 : 2;
      f->triangles[i].at[k].face = f->m->vertices[f->triangles[i].v[nearest]].place.face;
    }
}

/* Distance from samples of each triangle to the tangent planes of the surface below them. */
static void measure(void* data, size_t begin, size_t end)
{
  fit* f = data;
  const aqr_surface* s = f->s;
  for (size_t i = begin; i < end; i++)
  {
    triangle* t = &f->triangles[i];
    vec3 p[3];
    for (unsigned k = 0; k < 3; k++)
      p[k] = aqr_pm_point(f->m, t->v[k]);
    vec3 ab = v3_sub(p[1], p[0]), ac = v3_sub(p[2], p[0]), cross = v3_cross(ab, ac), normal = v3_unit(cross);
    double area = 0.5 * v3_norm(cross), error = 0;
    double reach =
      greater(greater(v3_norm2(ab), v3_norm2(ac)), v3_norm2(v3_sub(ab, ac))) * farthest_sample * farthest_sample;
    for (unsigned k = 0; k < samples; k++)
    {
      const double* w = barycentric[k];
      sample* x = &t->at[k];
      vec3 q = v3_madd(v3_madd(v3_scale(p[0], w[0]), w[1], p[1]), w[2], p[2]);
      aqr_closest below;
      aqr_closest_near(s, x->face, q, most_steps, true, &below);
      vec3 n = v3_unit(aqr_face_cross(s, below.place.face));
      error += area * weight[k] * lesser(reach, below.distance2);
      bool use = below.distance2 < reach && v3_dot(n, normal) > least_cosine;
      double a = use ? sqrt(area * weight[k]) : 0;
      x->normal[0] = (float)(a * n.x);
      x->normal[1] = (float)(a * n.y);
      x->normal[2] = (float)(a * n.z);
      x->distance = use ? (float)(a * v3_dot(v3_sub(below.position, q), n)) : 0;
      x->face = below.place.face;
    }
    t->error = (float)error;
  }
}

/* Samples of vertices taken back get their distance from the plane that was found below them. */
static void shift(void* data, size_t begin, size_t end)
{
  fit* f = data;
  for (size_t i = begin; i < end; i++)
  {
    triangle* t = &f->triangles[i];
    if (!f->back[t->v[0]] && !f->back[t->v[1]] && !f->back[t->v[2]])
      continue;
    double error = 0;
    for (unsigned k = 0; k < samples; k++)
    {
      sample* x = &t->at[k];
      vec3 d = v3(0, 0, 0);
      for (unsigned j = 0; j < 3; j++)
        if (f->back[t->v[j]])
          d = v3_madd(d, barycentric[k][j], f->move[t->v[j]]);
      x->distance += (float)v3_dot(d, v3((double)x->normal[0], (double)x->normal[1], (double)x->normal[2]));
      error += (double)(x->distance * x->distance);
    }
    t->error = (float)error;
  }
}

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

/* What holds a vertex in its place, times x: a share of its part of the error. */
static vec3 held(const fit* f, const aqr_vertex* v, double trace, vec3 x)
{
  double along = v3_dot(x, v->normal);
  return v3_scale(v3_madd(v3_scale(x, f->hold), (hold_normal - f->hold) * along, v->normal), trace);
}

static link* links_of(const fit* f, size_t v)
{
  return f->links + f->first_corner[v] + v;
}

/* Adds a block to that of a neighbour, which is new where no link leads to it yet. */
static void add_block(link* links, size_t* n, aqr_index to, const float* block)
{
  size_t i = 0;
  while (i < *n && links[i].to != to)
    i++;
  if (i == *n)
    links[(*n)++] = (link){ to, { 0 } };
  for (unsigned k = 0; k < 6; k++)
    links[i].block[k] += block[k];
}

/* What the distances say of each vertex: the right-hand side, its own block, and those of its neighbours. */
static void gather(void* data, size_t begin, size_t end)
{
  fit* f = data;
  for (size_t v = begin; v < end; v++)
  {
    link* links = links_of(f, v);
    double* a = f->block + 6 * v;
    vec3 right = v3(0, 0, 0);
    size_t n = 0;
    memset(a, 0, 6 * sizeof *a);
    for (size_t i = f->first_corner[v]; i < f->first_corner[v + 1]; i++)
    {
      const triangle* t = &f->triangles[f->corners[i] / 3];
      unsigned k = f->corners[i] % 3, k1 = (k + 1) % 3, k2 = (k + 2) % 3;
      float own[6] = { 0 }, one[6] = { 0 }, two[6] = { 0 };
      for (unsigned j = 0; j < samples; j++)
      {
        const float* x = t->at[j].normal;
        const float product[6] = { x[0] * x[0], x[1] * x[1], x[2] * x[2], x[0] * x[1], x[0] * x[2], x[1] * x[2] };
        const float w = (float)barycentric[j][k], w1 = (float)barycentric[j][k1], w2 = (float)barycentric[j][k2];
        for (unsigned d = 0; d < 6; d++)
        {
          own[d] += w * w * product[d];
          one[d] += w * w1 * product[d];
          two[d] += w * w2 * product[d];
        }
        right =
          v3_madd(right, barycentric[j][k] * (double)t->at[j].distance, v3((double)x[0], (double)x[1], (double)x[2]));
      }
      for (unsigned d = 0; d < 6; d++)
        a[d] += (double)own[d];
      add_block(links, &n, t->v[k1], one);
      add_block(links, &n, t->v[k2], two);
    }
    if (n <= f->first_corner[v + 1] - f->first_corner[v])
      links[n].to = AQR_NONE;
    f->trace[v] = a[0] + a[1] + a[2]; /* the part of the error that it stands for */
    f->residual[v] = right;
  }
}

/* Edges are held against turning: their ends may move along the surface together, as lines do that are moved or spaced
 * anew, but not one against the other across the edge. */
static void hold_edges(void* data, size_t begin, size_t end)
{
  fit* f = data;
  const aqr_polygon_mesh* m = f->m;
  for (size_t e = begin; e < end; e++)
  {
    aqr_index u = aqr_pm_from(m, (aqr_index)(2 * e)), v = aqr_pm_to(m, (aqr_index)(2 * e));
    const aqr_vertex *a = &m->vertices[u], *b = &m->vertices[v];
    vec3 across = v3_cross(v3_add(a->normal, b->normal), v3_sub(b->position, a->position));
    f->across[e] = v3_scale(v3_unit_or(across, v3(0, 0, 0)), sqrt(hold_edge * (f->trace[u] + f->trace[v])));
  }
}

/* Adds what holds the vertices, and sets the solver up. Fixed vertices have no equations. */
static void begin_rows(void* data, size_t begin, size_t end)
{
  fit* f = data;
  for (size_t v = begin; v < end; v++)
  {
    const aqr_vertex* x = &f->m->vertices[v];
    double *a = f->block + 6 * v, *inverse = f->inverse + 6 * v, trace = f->trace[v];
    aqr_index h = x->out;
    do
    {
      vec3 n = f->across[h >> 1];
      const double product[6] = { n.x * n.x, n.y * n.y, n.z * n.z, n.x * n.y, n.x * n.z, n.y * n.z };
      link* to = links_of(f, v);
      while (to->to != aqr_pm_to(f->m, h)) /* every edge is one of triangles */
        to++;
      for (unsigned d = 0; d < 6; d++)
      {
        a[d] += product[d];
        to->block[d] -= (float)product[d];
      }
      h = aqr_pm_next_around(f->m, h);
    } while (h != x->out);
    vec3 e[3] = { held(f, x, trace, v3(1, 0, 0)), held(f, x, trace, v3(0, 1, 0)), held(f, x, trace, v3(0, 0, 1)) };
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
  fit* f = data;
  for (size_t v = begin; v < end; v++)
  {
    if (!(f->inverse[6 * v] > 0))
    {
      f->image[v] = v3(0, 0, 0);
      f->product[v] = 0;
      continue;
    }
    vec3 sum = times(f->block + 6 * v, f->direction[v]);
    const link *last = links_of(f, v + 1), *to = links_of(f, v);
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
  fit* f = data;
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
  fit* f = data;
  for (size_t v = begin; v < end; v++)
    f->direction[v] = v3_madd(f->image[v], f->step, f->direction[v]);
}

/* In the order of the vertices, so that it does not depend on threads. */
static double sum_of_products(const fit* f)
{
  double sum = 0;
  for (size_t v = 0; v < f->m->n_vertices; v++)
    sum += f->product[v];
  return sum;
}

/* Conjugate gradients with the blocks of single vertices as preconditioner. The matrix is nearly a mass matrix: few
 * steps are enough, and moves this near to the solution's are judged as well as its own. */
static aqr_status solve(aqr_context* c, fit* f, double at)
{
  aqr_status status = AQR_OK;
  size_t n = f->m->n_vertices;
  AQR_TRY(aqr_parallel(c, n, gather, f, at, at));
  AQR_TRY(aqr_parallel(c, f->m->n_half_edges / 2, hold_edges, f, at, at));
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

/* ---- moving ---- */

static void limit(void* data, size_t begin, size_t end)
{
  fit* f = data;
  const aqr_polygon_mesh* m = f->m;
  for (size_t v = begin; v < end; v++)
  {
    double least = INFINITY, length = v3_norm(f->move[v]);
    aqr_index h = m->vertices[v].out;
    do
    {
      least = lesser(least, v3_norm2(v3_sub(aqr_pm_point(m, aqr_pm_to(m, h)), m->vertices[v].position)));
      h = aqr_pm_next_around(m, h);
    } while (h != m->vertices[v].out);
    double most = farthest_move * sqrt(least);
    if (!isfinite(length))
      f->move[v] = v3(0, 0, 0);
    else if (length > most)
      f->move[v] = v3_scale(f->move[v], most / length);
  }
}

static void apply(void* data, size_t begin, size_t end)
{
  fit* f = data;
  for (size_t v = begin; v < end; v++)
  {
    aqr_vertex* x = &f->m->vertices[v];
    f->before[v] = x->position;
    x->position = v3_add(x->position, f->move[v]);
  }
}

/* The sine of the angle at p between its neighbours. */
static double sine(vec3 prev, vec3 p, vec3 next, vec3 normal)
{
  vec3 a = v3_sub(next, p), b = v3_sub(prev, p);
  double n = sqrt(v3_norm2(a) * v3_norm2(b));
  return n > 0 ? v3_dot(v3_cross(a, b), normal) / n : -1;
}

/* Finds the corners of vertices in question that have become too sharp, flat or turned over. */
static void find_folds(void* data, size_t begin, size_t end)
{
  fit* f = data;
  const aqr_polygon_mesh* m = f->m;
  for (aqr_index h = (aqr_index)begin; h < end; h++)
  {
    if (aqr_pm_face(m, h) == AQR_NONE)
      continue;
    aqr_index u = aqr_pm_from(m, aqr_pm_prev(m, h)), v = aqr_pm_from(m, h), w = aqr_pm_to(m, h);
    if (!f->back[u] && !f->back[v] && !f->back[w])
      continue;
    vec3 normal = m->vertices[v].normal;
    double now = sine(aqr_pm_point(m, u), aqr_pm_point(m, v), aqr_pm_point(m, w), normal);
    if (now > least_sine || !(now < sine(f->before[u], f->before[v], f->before[w], normal)))
      continue;
    const aqr_index at[3] = { u, v, w };
    for (unsigned i = 0; i < 3; i++)
      atomic_store_explicit(&f->folds[at[i]], 1, memory_order_relaxed);
  }
}

static void hold_back(void* data, size_t begin, size_t end)
{
  fit* f = data;
  for (size_t v = begin; v < end; v++)
  {
    f->back[v] = atomic_load_explicit(&f->folds[v], memory_order_relaxed);
    if (!f->back[v])
      continue;
    atomic_store_explicit(&f->folds[v], 0, memory_order_relaxed);
    atomic_store_explicit(&f->folded, 1, memory_order_relaxed);
    f->move[v] = v3_scale(f->move[v], f->keep);
    f->m->vertices[v].position = v3_add(f->before[v], f->move[v]);
  }
}

/* Halves the moves around corners that fold, in the end to nothing. */
static aqr_status damp(aqr_context* c, fit* f, double at)
{
  const aqr_polygon_mesh* m = f->m;
  aqr_status status = AQR_OK;
  memset(f->back, 1, m->n_vertices);
  for (size_t v = 0; v < m->n_vertices; v++)
    atomic_init(&f->folds[v], 0);
  for (unsigned round = 0; round < damp_rounds; round++)
  {
    f->keep = round + 1 < damp_rounds ? 0.5 : 0;
    atomic_init(&f->folded, 0);
    AQR_TRY(aqr_parallel(c, m->n_half_edges, find_folds, f, at, at));
    AQR_TRY(aqr_parallel(c, m->n_vertices, hold_back, f, at, at));
    if (!atomic_load_explicit(&f->folded, memory_order_relaxed))
      break;
  }
done:
  return status;
}

/* Finds the place below a vertex that has moved along the surface. */
static void settle(void* data, size_t begin, size_t end)
{
  fit* f = data;
  for (size_t v = begin; v < end; v++)
  {
    aqr_vertex* x = &f->m->vertices[v];
    if (x->kind != AQR_VERTEX_INTERIOR)
      continue;
    aqr_closest below;
    aqr_closest_near(f->s, x->place.face, x->position, most_steps, true, &below);
    x->place = below.place;
    vec3 n = v3(0, 0, 0);
    for (unsigned i = 0; i < 3 && f->normals; i++)
      n = v3_madd(n, x->place.bary[i], v3_load(f->normals + 3 * (size_t)f->s->corner[3 * x->place.face + i]));
    if (v3_norm2(n) > 0)
      x->normal = v3_unit(n);
  }
}

static double error_around(const fit* f, size_t v)
{
  double sum = 0;
  for (size_t i = f->first_corner[v]; i < f->first_corner[v + 1]; i++)
    sum += (double)f->triangles[f->corners[i] / 3].error;
  return sum;
}

/* Takes the last move back where the error grew. */
static void take_back(void* data, size_t begin, size_t end)
{
  fit* f = data;
  for (size_t v = begin; v < end; v++)
  {
    f->back[v] = error_around(f, v) > f->error[v];
    if (f->back[v])
      f->m->vertices[v].position = f->before[v];
  }
}

static void note_error(void* data, size_t begin, size_t end)
{
  fit* f = data;
  for (size_t v = begin; v < end; v++)
    f->error[v] = error_around(f, v);
}

/* Measures the error after a move, and takes back what made it larger. */
static aqr_status judge(aqr_context* c, fit* f, bool last, double from, double to)
{
  aqr_status status = AQR_OK;
  AQR_TRY(aqr_parallel(c, f->m->n_faces, triangulate, f, from, from));
  AQR_TRY(aqr_parallel(c, f->n_triangles, measure, f, from, to));
  list_corners(f);
  AQR_TRY(aqr_parallel(c, f->m->n_vertices, take_back, f, to, to));
  if (!last)
    AQR_TRY(aqr_parallel(c, f->n_triangles, shift, f, to, to));
done:
  return status;
}

/* ---- straight corners ---- */

/* The smallest sine of the corners of triangles and quads that change where v moves to p. */
static double least_sine_around(const aqr_polygon_mesh* m, aqr_index v, vec3 p)
{
  double least = 1;
  aqr_index out = m->vertices[v].out;
  do
  {
    vec3 at[4] = { p };
    unsigned n = 1;
    aqr_index h = aqr_pm_next(m, out);
    for (; n < 4 && h != out; n++, h = aqr_pm_next(m, h))
      at[n] = aqr_pm_point(m, aqr_pm_from(m, h));
    if (h == out && aqr_pm_face(m, out) != AQR_NONE)
    {
      vec3 normal = v3_unit(v3_cross(v3_sub(at[2], at[0]), v3_sub(at[n - 1], at[1])));
      const unsigned corner[3] = { n - 1, 0, 1 };
      for (unsigned i = 0; i < 3; i++)
        least = lesser(least, sine(at[(corner[i] + n - 1) % n], at[corner[i]], at[(corner[i] + 1) % n], normal));
    }
    out = aqr_pm_next_around(m, out);
  } while (out != m->vertices[v].out);
  return least;
}

/* Takes the vertex where h starts, a straight or concave corner, out over the line between its neighbours, unless that
 * closes another corner as far. */
static void open_corner(aqr_polygon_mesh* m, aqr_index h)
{
  aqr_index v = aqr_pm_from(m, h);
  vec3 p = aqr_pm_point(m, v), from = aqr_pm_point(m, aqr_pm_from(m, aqr_pm_prev(m, h)));
  vec3 along = v3_sub(aqr_pm_point(m, aqr_pm_to(m, h)), from);
  vec3 out = v3_unit_or(v3_cross(along, m->vertices[v].normal), v3(0, 0, 0));
  vec3 moved = v3_madd(p, open_height * v3_norm(along) - v3_dot(v3_sub(p, from), out), out);
  if (least_sine_around(m, v, moved) > least_sine_around(m, v, p))
    m->vertices[v].position = moved;
}

/* Lines that meet three at a vertex leave one of its corners wide, and straight or concave where they meet in a T. The
 * error says nothing of it: what is moved is moved along the surface, and a few of a hundred vertices at most. */
static void open_corners(aqr_polygon_mesh* m)
{
  for (size_t f = 0; f < m->n_faces; f++)
  {
    aqr_index h[4] = { m->faces[f] };
    for (unsigned i = 1; i < 4; i++)
      h[i] = aqr_pm_next(m, h[i - 1]);
    if (h[3] == h[0] || aqr_pm_next(m, h[3]) != h[0])
      continue;
    vec3 p[4];
    for (unsigned i = 0; i < 4; i++)
      p[i] = aqr_pm_point(m, aqr_pm_from(m, h[i]));
    vec3 normal = v3_cross(v3_sub(p[2], p[0]), v3_sub(p[3], p[1]));
    for (unsigned i = 0; i < 4; i++)
    {
      vec3 cross = v3_cross(v3_sub(p[(i + 1) % 4], p[i]), v3_sub(p[(i + 3) % 4], p[i]));
      if (!(v3_dot(cross, normal) > 0) && m->vertices[aqr_pm_from(m, h[i])].kind == AQR_VERTEX_INTERIOR)
        open_corner(m, h[i]);
    }
  }
}

aqr_status aqr_fit(aqr_context* c, const aqr_surface* s, const double* normals, aqr_polygon_mesh* m)
{
  aqr_status status = AQR_OK;
  fit f = { .s = s, .normals = normals, .m = m };
  size_t n = m->n_vertices;
  AQR_TRY(aqr_place_on_chains(c, s, m));
  AQR_TRY(aqr_parallel(c, n, snap, &f, 0, 0.1));
  AQR_TRY(allocate(c, &f));
  AQR_TRY(aqr_parallel(c, m->n_faces, triangulate, &f, 0.1, 0.1));
  AQR_TRY(aqr_parallel(c, f.n_triangles, start_samples, &f, 0.1, 0.1));
  AQR_TRY(aqr_parallel(c, f.n_triangles, measure, &f, 0.1, 0.25));
  list_corners(&f);
  for (unsigned round = 0; round < rounds; round++)
  {
    double at = 0.25 + 0.65 * round / rounds, next = 0.25 + 0.65 * (round + 1) / rounds;
    f.hold = round ? hold_tangent : hold_first;
    AQR_TRY(aqr_parallel(c, n, note_error, &f, at, at));
    AQR_TRY(solve(c, &f, at));
    AQR_TRY(aqr_parallel(c, n, limit, &f, at, at));
    AQR_TRY(aqr_parallel(c, n, apply, &f, at, at));
    AQR_TRY(damp(c, &f, at));
    AQR_TRY(judge(c, &f, round + 1 == rounds, at, next));
  }
  open_corners(m);
  AQR_TRY(aqr_parallel(c, m->n_faces, triangulate, &f, 0.9, 0.9));
  AQR_TRY(aqr_parallel(c, n, settle, &f, 0.9, 1));
done:
  release(c, &f);
  return status;
}
