/* SPDX-License-Identifier: BSD-3-Clause */
#include "feature_error.h"

#include "morton.h"

#include <stdlib.h>

enum
{
  leaf = 4,            /* edges at the bottom of the tree */
  deepest = 64,        /* levels: halves of 2^32 edges */
  samples_per_edge = 2 /* its start and its middle */
};

typedef struct box
{
  float low[3], high[3]; /* outwards rounded */
} box;

typedef struct segment
{
  uint32_t key; /* along a space-filling curve */
  aqr_index h;
} segment;

typedef struct measuring
{
  const aqr_surface* s;
  const aqr_chains* chains;
  const aqr_polygon_mesh* m;
  segment* segments;
  size_t n;
  box* boxes; /* of node i of an implicit binary tree: children 2 i + 1 and 2 i + 2 halve its range of segments */
  size_t n_boxes;
  double* distance; /* samples_per_edge per half-edge of the chains */
} measuring;

static int by_key(const void* a, const void* b)
{
  const segment *x = a, *y = b;
  return x->key != y->key ? (x->key > y->key) - (x->key < y->key) : (x->h > y->h) - (x->h < y->h);
}

static vec3 start_of(const aqr_polygon_mesh* m, aqr_index h)
{
  return aqr_pm_point(m, aqr_pm_from(m, h));
}

static void list_segments(measuring* w)
{
  const aqr_polygon_mesh* m = w->m;
  for (aqr_index h = 0; h < m->n_half_edges; h += 2)
  {
    if (!aqr_pm_edge_lives(m, h))
      continue;
    vec3 p = v3_scale(v3_add(start_of(m, h), start_of(m, h ^ 1)), 0.5);
    w->segments[w->n++] = (segment){ aqr_morton(p), h };
  }
  qsort(w->segments, w->n, sizeof *w->segments, by_key);
}

static box around(const measuring* w, size_t begin, size_t end)
{
  box b = { { INFINITY, INFINITY, INFINITY }, { -INFINITY, -INFINITY, -INFINITY } };
  for (size_t i = 2 * begin; i < 2 * end; i++)
  {
    double p[3];
    v3_store(p, start_of(w->m, w->segments[i / 2].h ^ (i & 1)));
    for (unsigned k = 0; k < 3; k++)
    {
      float x = (float)p[k];
      b.low[k] = fminf(b.low[k], nextafterf(x, -INFINITY));
      b.high[k] = fmaxf(b.high[k], nextafterf(x, INFINITY));
    }
  }
  return b;
}

static bool is_leaf(size_t node, size_t begin, size_t end, size_t n_boxes)
{
  return end - begin <= leaf || 2 * node + 2 >= n_boxes;
}

/* The boxes of a node and of all below it. */
static void fill(measuring* w, size_t node, size_t begin, size_t end)
{
  if (is_leaf(node, begin, end, w->n_boxes))
  {
    w->boxes[node] = around(w, begin, end);
    return;
  }
  size_t middle = begin + (end - begin) / 2;
  fill(w, 2 * node + 1, begin, middle);
  fill(w, 2 * node + 2, middle, end);
  const box *a = &w->boxes[2 * node + 1], *b = &w->boxes[2 * node + 2];
  for (unsigned k = 0; k < 3; k++)
  {
    w->boxes[node].low[k] = fminf(a->low[k], b->low[k]);
    w->boxes[node].high[k] = fmaxf(a->high[k], b->high[k]);
  }
}

static double to_box2(const box* b, const double* p)
{
  double sum = 0;
  for (unsigned k = 0; k < 3; k++)
  {
    double out = fmax(0, fmax((double)b->low[k] - p[k], p[k] - (double)b->high[k]));
    sum += out * out;
  }
  return sum;
}

static double to_segment2(const measuring* w, aqr_index h, vec3 p)
{
  return v3_segment_distance2(p, start_of(w->m, h), start_of(w->m, h ^ 1));
}

typedef struct pending
{
  size_t node, begin, end;
} pending;

/* The squared distance of p from the nearest segment. */
static double nearest2(const measuring* w, vec3 p)
{
  double at[3], best = INFINITY;
  v3_store(at, p);
  pending stack[deepest + 1];
  unsigned n = 0;
  stack[n++] = (pending){ 0, 0, w->n };
  while (n)
  {
    pending x = stack[--n];
    if (!(to_box2(&w->boxes[x.node], at) < best))
      continue;
    if (is_leaf(x.node, x.begin, x.end, w->n_boxes))
    {
      for (size_t i = x.begin; i < x.end; i++)
        best = fmin(best, to_segment2(w, w->segments[i].h, p));
      continue;
    }
    size_t middle = x.begin + (x.end - x.begin) / 2;
    pending child[2] = { { 2 * x.node + 1, x.begin, middle }, { 2 * x.node + 2, middle, x.end } };
    bool second = to_box2(&w->boxes[child[1].node], at) < to_box2(&w->boxes[child[0].node], at);
    stack[n++] = child[!second]; /* the nearer comes first */
    stack[n++] = child[second];
  }
  return best;
}

static void find_distances(void* data, size_t begin, size_t end)
{
  measuring* w = data;
  for (size_t i = begin; i < end; i++)
  {
    aqr_index h = w->chains->half_edges[i];
    vec3 p = aqr_point(w->s, aqr_from(w->s, h)), q = aqr_point(w->s, aqr_to(w->s, h));
    w->distance[samples_per_edge * i] = nearest2(w, p);
    w->distance[samples_per_edge * i + 1] = nearest2(w, v3_scale(v3_add(p, q), 0.5));
  }
}

static aqr_distance summary(const measuring* w, bool features)
{
  const aqr_chains* chains = w->chains;
  double sum = 0, length = 0, largest = 0;
  for (size_t i = 0; i < chains->n_chains; i++)
  {
    const aqr_chain* a = &chains->chains[i];
    bool counts = a->is_feature == features && !aqr_on_plane(w->s, chains->half_edges[a->first]);
    for (size_t k = a->first; counts && k < a->first + a->count; k++)
    {
      aqr_index h = chains->half_edges[k];
      double l = v3_norm(aqr_edge_vector(w->s, h));
      const double* d = w->distance + samples_per_edge * k;
      sum += l * (d[0] + d[1]) / samples_per_edge;
      length += l;
      largest = fmax(largest, fmax(d[0], d[1]));
    }
  }
  return (aqr_distance){ length > 0 ? sqrt(sum / length) : 0, sqrt(largest) };
}

aqr_status aqr_feature_error(aqr_context* c, const aqr_surface* s, const aqr_chains* chains, const aqr_polygon_mesh* m,
  aqr_distance* features, aqr_distance* boundary)
{
  aqr_status status = AQR_OK;
  measuring w = { .s = s, .chains = chains, .m = m };
  size_t n_samples = samples_per_edge * chains->n_half_edges, room = m->n_half_edges / 2;
  *features = *boundary = (aqr_distance){ 0, 0 };
  if (!n_samples || !room)
    return AQR_OK;
  for (w.n_boxes = 1; w.n_boxes * leaf < 2 * room;)
    w.n_boxes = 2 * w.n_boxes + 1;
  w.segments = AQR_NEW(c, segment, room);
  w.boxes = AQR_NEW(c, box, w.n_boxes);
  w.distance = AQR_NEW(c, double, n_samples);
  AQR_REQUIRE(w.segments && w.boxes && w.distance, AQR_OUT_OF_MEMORY);
  list_segments(&w);
  AQR_REQUIRE(w.n > 0, AQR_INTERNAL);
  AQR_REQUIRE(aqr_step(c, 0), AQR_CANCELLED);
  fill(&w, 0, 0, w.n);
  AQR_TRY(aqr_parallel(c, chains->n_half_edges, find_distances, &w, 0, 0.1));
  *features = summary(&w, true);
  *boundary = summary(&w, false);
done:
  AQR_DROP(c, w.segments, room);
  AQR_DROP(c, w.boxes, w.n_boxes);
  AQR_DROP(c, w.distance, n_samples);
  return status;
}
