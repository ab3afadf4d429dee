/* SPDX-License-Identifier: BSD-3-Clause */
#include "judge.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* A side of a face: its ends in increasing order, the way the face walks it, and its corners. */
typedef struct side
{
  int64_t low, high;
  size_t corner, next; /* into the connectivity: where the side begins and where the face goes on */
  bool forward;
} side;

static int compare_sides(const void* x, const void* y)
{
  const side *a = x, *b = y;
  if (a->low != b->low)
    return a->low < b->low ? -1 : 1;
  if (a->high != b->high)
    return a->high < b->high ? -1 : 1;
  return (a->corner > b->corner) - (a->corner < b->corner);
}

static int compare_ids(const void* x, const void* y)
{
  const int64_t *a = x, *b = y;
  return (*a > *b) - (*a < *b);
}

static int compare_hashes(const void* x, const void* y)
{
  const uint64_t *a = x, *b = y;
  return (*a > *b) - (*a < *b);
}

static size_t root(size_t* parent, size_t i)
{
  while (parent[i] != i)
    i = parent[i] = parent[parent[i]];
  return i;
}

static void join(size_t* parent, size_t a, size_t b)
{
  parent[root(parent, a)] = root(parent, b);
}

static size_t count_roots(const size_t* parent, size_t n)
{
  size_t count = 0;
  for (size_t i = 0; i < n; i++)
    count += parent[i] == i;
  return count;
}

static void separate(size_t* parent, size_t n)
{
  for (size_t i = 0; i < n; i++)
    parent[i] = i;
}

typedef struct bench
{
  side* sides;       /* per corner */
  uint64_t* hash;    /* per face: of its set of points */
  int64_t* sorted;   /* per corner */
  size_t* parent;    /* per corner */
  int64_t* outgoing; /* per point: where its boundary goes on, -1 when it has none */
} bench;

static const char* check_faces(
  size_t n_points, const double* points, size_t n_faces, const int64_t* offsets, const int64_t* connectivity, bench* b)
{
  for (size_t i = 0; i < 3 * n_points; i++)
    if (!isfinite(points[i]))
      return "a point is not finite";
  for (size_t f = 0; f < n_faces; f++)
  {
    if (offsets[f + 1] < offsets[f] + 3)
      return "a face has fewer than three corners";
    size_t begin = (size_t)offsets[f], n = (size_t)offsets[f + 1] - begin;
    for (size_t k = 0; k < n; k++)
    {
      int64_t from = connectivity[begin + k], to = connectivity[begin + (k + 1) % n];
      if (from < 0 || (size_t)from >= n_points)
        return "a corner is no point";
      b->sides[begin + k] =
        (side){ from < to ? from : to, from < to ? to : from, begin + k, begin + (k + 1) % n, from < to };
    }
    int64_t* ids = b->sorted + begin;
    memcpy(ids, connectivity + begin, n * sizeof *ids);
    qsort(ids, n, sizeof *ids, compare_ids);
    b->hash[f] = 0x9e3779b97f4a7c15u;
    for (size_t k = 0; k < n; k++)
    {
      if (k && ids[k] == ids[k - 1])
        return "a face meets a point twice";
      b->hash[f] = (b->hash[f] ^ (uint64_t)ids[k]) * 0xff51afd7ed558ccdu;
      b->hash[f] ^= b->hash[f] >> 29;
    }
  }
  qsort(b->hash, n_faces, sizeof *b->hash, compare_hashes);
  for (size_t f = 1; f < n_faces; f++)
    if (b->hash[f] == b->hash[f - 1])
      return "two faces have the same points";
  return NULL;
}

/* Corners of a point that are joined over sides must be one fan. */
static const char* check_fans(
  size_t n_points, const int64_t* connectivity, size_t n_corners, bench* b, size_t* n_edges, size_t* n_boundary)
{
  qsort(b->sides, n_corners, sizeof *b->sides, compare_sides);
  separate(b->parent, n_corners);
  for (size_t i = 0; i < n_points; i++)
    b->outgoing[i] = -1;
  for (size_t i = 0, n; i < n_corners; i += n)
  {
    const side* s = b->sides + i;
    for (n = 1; i + n < n_corners && s[n].low == s->low && s[n].high == s->high; n++)
      ;
    if (n > 2)
      return "an edge has more than two faces";
    ++*n_edges;
    if (n == 2 && s[0].forward == s[1].forward)
      return "two faces disagree about their side";
    if (n == 2)
    {
      join(b->parent, s[0].corner, s[1].next);
      join(b->parent, s[0].next, s[1].corner);
    }
    else
    {
      ++*n_boundary;
      b->outgoing[connectivity[s->corner]] = connectivity[s->next];
    }
  }
  int64_t* fans = b->sorted;
  memset(fans, 0, n_points * sizeof *fans);
  for (size_t i = 0; i < n_corners; i++)
    if (root(b->parent, i) == i)
      fans[connectivity[i]]++;
  for (size_t i = 0; i < n_points; i++)
    if (fans[i] != 1)
      return fans[i] ? "a point has two fans" : "a point has no face";
  return NULL;
}

static size_t count_loops(size_t n_points, bench* b)
{
  size_t loops = 0;
  for (size_t i = 0; i < n_points; i++)
  {
    loops += b->outgoing[i] >= 0;
    for (int64_t p = (int64_t)i; b->outgoing[p] >= 0;)
    {
      int64_t next = b->outgoing[p];
      b->outgoing[p] = -1;
      p = next;
    }
  }
  return loops;
}

static bool new_bench(bench* b, size_t n_points, size_t n_faces, size_t n_corners)
{
  size_t most = n_corners > n_points ? n_corners : n_points;
  *b = (bench){ malloc(n_corners * sizeof(side)), malloc(n_faces * sizeof(uint64_t)), malloc(most * sizeof(int64_t)),
    malloc(most * sizeof(size_t)), malloc(n_points * sizeof(int64_t)) };
  return b->sides && b->hash && b->sorted && b->parent && b->outgoing;
}

static void free_bench(bench* b)
{
  free(b->sides);
  free(b->hash);
  free(b->sorted);
  free(b->parent);
  free(b->outgoing);
}

verdict judge_mesh(
  size_t n_points, const double* points, size_t n_faces, const int64_t* offsets, const int64_t* connectivity)
{
  verdict v = { "it is empty", 0, 0, 0 };
  if (!n_points || !n_faces || offsets[n_faces] < 0)
    return v;
  size_t n_corners = (size_t)offsets[n_faces], n_edges = 0, n_boundary = 0;
  bench b;
  v.fault = new_bench(&b, n_points, n_faces, n_corners)
              ? check_faces(n_points, points, n_faces, offsets, connectivity, &b)
              : "the judge has no memory";
  if (!v.fault)
    v.fault = check_fans(n_points, connectivity, n_corners, &b, &n_edges, &n_boundary);
  if (!v.fault)
  {
    v.euler = (long)n_points - (long)n_edges + (long)n_faces;
    v.boundary_loops = count_loops(n_points, &b);
    separate(b.parent, n_points);
    for (size_t i = 0; i < n_corners; i++)
      join(b.parent, (size_t)b.sides[i].low, (size_t)b.sides[i].high);
    v.components = count_roots(b.parent, n_points);
  }
  free_bench(&b);
  return v;
}

double judge_height(const judge_plane* plane, const double* point)
{
  double d = 0;
  for (int k = 0; k < 3; k++)
    d += (point[k] - plane->origin[k]) * plane->normal[k];
  return d;
}

/* As far from the plane counts as on it: far below a millionth of the size, within which points are moved there. */
static double rounding_of(size_t n_points, const double* points, const judge_plane* plane)
{
  double reach = 0, size = 0;
  for (size_t i = 0; i < 3 * n_points; i++)
  {
    reach = fmax(reach, fmax(fabs(points[i]), fabs(plane->origin[i % 3])));
    size = fmax(size, fabs(points[i] - points[i % 3]));
  }
  return fmax(1e-7 * size, 1e-14 * reach);
}

/* The sides are sorted. A border's sides on the plane are joined to their images there, the others go round twice:
 * along the mesh, and the other way along its image, whose points come behind the mesh's. */
static void join_images(size_t n, size_t n_corners, const int64_t* connectivity, const bool* on, verdict* v, bench* b)
{
  int64_t* image = b->sorted;
  for (size_t i = 0; i < n; i++)
    image[i] = (int64_t)(n + i);
  v->euler *= 2;
  for (int pass = 0; pass < 2; pass++)
    for (size_t i = 0, same; i < n_corners; i += same)
    {
      const side* s = b->sides + i;
      for (same = 1; i + same < n_corners && s[same].low == s->low && s[same].high == s->high; same++)
        ;
      int64_t from = connectivity[s->corner], to = connectivity[s->next];
      if (same == 2)
        continue;
      if (!on[from] || !on[to])
      {
        if (pass == 0)
          continue;
        b->outgoing[from] = to;
        b->outgoing[image[to]] = image[from];
      }
      else if (pass == 0)
      {
        v->euler += 1 - (image[from] != from) - (image[to] != to);
        image[from] = from;
        image[to] = to;
      }
    }
  for (size_t i = 0; i < n_corners; i++)
  {
    join(b->parent, (size_t)b->sides[i].low, (size_t)b->sides[i].high);
    join(b->parent, (size_t)image[b->sides[i].low], (size_t)image[b->sides[i].high]);
  }
  v->boundary_loops = count_loops(2 * n, b);
  v->components = 0;
  for (size_t i = 0; i < n; i++)
    v->components += (size_t)(b->parent[i] == i) + (image[i] != (int64_t)i && b->parent[n + i] == n + i);
}

verdict judge_mirrored(size_t n_points, const double* points, size_t n_faces, const int64_t* offsets,
  const int64_t* connectivity, const judge_plane* plane)
{
  verdict v = judge_mesh(n_points, points, n_faces, offsets, connectivity);
  if (v.fault)
    return v;
  size_t n_corners = (size_t)offsets[n_faces], n_edges = 0, n_boundary = 0;
  double near = rounding_of(n_points, points, plane);
  bool* on = malloc(n_points * sizeof *on);
  bench b;
  if (new_bench(&b, 2 * n_points, n_faces, n_corners) && on)
  {
    for (size_t i = 0; i < n_points; i++)
    {
      double d = judge_height(plane, points + 3 * i);
      on[i] = fabs(d) <= near;
      if (d < -near)
        v.fault = "a point of the half lies on the wrong side of the plane";
    }
    check_faces(n_points, points, n_faces, offsets, connectivity, &b);
    check_fans(n_points, connectivity, n_corners, &b, &n_edges, &n_boundary);
    for (size_t i = 0; i < 2 * n_points; i++)
      b.outgoing[i] = -1;
    separate(b.parent, 2 * n_points);
    join_images(n_points, n_corners, connectivity, on, &v, &b);
  }
  else
    v.fault = "the judge has no memory";
  free(on);
  free_bench(&b);
  return v;
}

const char* judge_pair(const verdict* surface, const verdict* mesh)
{
  if (surface->fault)
    return surface->fault;
  if (mesh->fault)
    return mesh->fault;
  if (mesh->components != surface->components)
    return "the number of components changed";
  if (mesh->boundary_loops != surface->boundary_loops)
    return "the number of boundary loops changed";
  if (mesh->euler != surface->euler)
    return "the Euler number changed";
  return NULL;
}
