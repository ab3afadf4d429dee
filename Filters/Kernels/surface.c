/* SPDX-License-Identifier: BSD-3-Clause */
/* The working surface: any triangles in, oriented manifold triangles out. Paper 3.2 for the halving of long edges. */
#include "surface.h"

#include "shared.h"
#include "surface_input.h"

#include <string.h>

typedef struct builder
{
  aqr_context* c;
  const aqr_input* in;
  aqr_surface* s;
  aqr_report* report;
  aqr_index* weld;        /* per input point: the input point it was joined to */
  aqr_shared_double area; /* of the largest parallelogram that two sides of a triangle span */
  size_t* first;          /* per point: where its bucket begins */
  aqr_index* in_bucket;   /* half-edges by their smaller point */
  aqr_shared_size split_edges;
  atomic_bool may_repeat;   /* a triangle may have the points of another */
  atomic_bool disagree;     /* some neighbours */
  aqr_shared_index* parent; /* sets of faces: components */
  aqr_shared_size components;
  aqr_shared_size in_fans; /* half-edges */
} builder;

static void measure_areas(void* data, size_t begin, size_t end)
{
  builder* b = data;
  double area = 0;
  for (aqr_index f = (aqr_index)begin; f < end; f++)
    area = greater(area, v3_norm(aqr_face_cross(b->s, f)));
  aqr_shared_raise(&b->area, area);
}

/* At least one triangle must have an area: more, in a unit box, than rounding makes of a straight line. */
static aqr_status check_areas(builder* b)
{
  aqr_status status = AQR_OK;
  atomic_init(&b->area, 0);
  AQR_TRY(aqr_parallel(b->c, b->s->n_faces, measure_areas, b, 0.36, 0.37));
  AQR_REQUIRE(b->area > 1e-14, AQR_DEGENERATE_INPUT);
done:
  return status;
}

/* ---- adjacency ---- */

static bool runs_against(const aqr_surface* s, aqr_index h, aqr_index t)
{
  return aqr_from(s, h) == aqr_to(s, t);
}

static aqr_index opposite(const aqr_surface* s, aqr_index h)
{
  return aqr_from(s, aqr_prev(h));
}

static aqr_index larger_end(const aqr_surface* s, aqr_index h)
{
  aqr_index p = aqr_from(s, h), q = aqr_to(s, h);
  return p > q ? p : q;
}

/* Shell's way: most buckets hold three half-edges, that of a fan's centre can hold as many as there are faces. */
static void sort_bucket(const aqr_surface* s, aqr_index* bucket, size_t n)
{
  size_t gap = 1;
  while (gap < n / 9)
    gap = 3 * gap + 1;
  for (; gap > 0; gap /= 3)
    for (size_t i = gap; i < n; i++)
    {
      aqr_index h = bucket[i], end = larger_end(s, h);
      size_t j = i;
      for (; j >= gap && larger_end(s, bucket[j - gap]) > end; j -= gap)
        bucket[j] = bucket[j - gap];
      bucket[j] = h;
    }
}

/* The n half-edges of one undirected edge. Two make neighbours, whatever their direction; more are a non-manifold edge,
 * at which all faces are cut apart. */
static void pair_up(builder* b, const aqr_index* edge, size_t n)
{
  aqr_surface* s = b->s;
  for (size_t i = 0; i < n; i++)
    s->twin[edge[i]] = n == 2 ? edge[1 - i] : AQR_NONE;
  if (n == 2 && !runs_against(s, edge[0], edge[1]))
    atomic_store_explicit(&b->disagree, true, memory_order_relaxed);
  if (n > 2)
    atomic_fetch_add_explicit(&b->split_edges, 1, memory_order_relaxed);
  if (n > 2 || (n == 2 && opposite(s, edge[0]) == opposite(s, edge[1])))
    atomic_store_explicit(&b->may_repeat, true, memory_order_relaxed);
}

/* Half-edges of one undirected edge meet in the bucket of its smaller point. */
static void pair_in_bucket(builder* b, aqr_index v)
{
  aqr_index* bucket = b->in_bucket + b->first[v];
  size_t n = b->first[v + 1] - b->first[v];
  sort_bucket(b->s, bucket, n);
  for (size_t i = 0, next; i < n; i = next)
  {
    aqr_index end = larger_end(b->s, bucket[i]);
    for (next = i + 1; next < n && larger_end(b->s, bucket[next]) == end; next++)
      ;
    pair_up(b, bucket + i, next - i);
  }
}

static void pair_in_buckets(void* data, size_t begin, size_t end)
{
  for (size_t v = begin; v < end; v++)
    pair_in_bucket(data, (aqr_index)v);
}

static aqr_index smaller_end(const aqr_index* corner, unsigned k)
{
  aqr_index p = corner[k], q = corner[k == 2 ? 0 : k + 1];
  return p < q ? p : q;
}

static aqr_status pair_half_edges(builder* b)
{
  aqr_surface* s = b->s;
  size_t n = 3 * s->n_faces, n_first = s->n_points + 2;
  aqr_status status = AQR_OK;
  b->first = AQR_NEW0(b->c, size_t, n_first);
  b->in_bucket = AQR_NEW(b->c, aqr_index, n);
  AQR_REQUIRE(b->first && b->in_bucket, AQR_OUT_OF_MEMORY);
  atomic_init(&b->split_edges, 0);
  atomic_init(&b->disagree, false);
  AQR_REQUIRE(aqr_step(b->c, 0.38), AQR_CANCELLED);
  for (size_t i = 0; i < n; i += 3)
    for (unsigned k = 0; k < 3; k++)
      b->first[smaller_end(s->corner + i, k) + 2]++;
  for (size_t i = 1; i <= s->n_points; i++)
    b->first[i + 1] += b->first[i];
  AQR_REQUIRE(aqr_step(b->c, 0.39), AQR_CANCELLED);
  for (size_t i = 0; i < n; i += 3)
    for (unsigned k = 0; k < 3; k++)
      b->in_bucket[b->first[smaller_end(s->corner + i, k) + 1]++] = (aqr_index)(i + k);
  AQR_TRY(aqr_parallel(b->c, s->n_points, pair_in_buckets, b, 0.4, 0.45));
  b->report->split_edges = b->split_edges;
done:
  AQR_DROP(b->c, b->first, n_first);
  AQR_DROP(b->c, b->in_bucket, n);
  return status;
}

/* Half-edge h after its face was turned over. */
static aqr_index turned(aqr_index h, const uint8_t* turn)
{
  static const aqr_index to[3] = { 2, 1, 0 };
  return turn[h / 3] ? 3 * (h / 3) + to[h % 3] : h;
}

static void begin_components(void* data, size_t begin, size_t end)
{
  builder* b = data;
  for (size_t f = begin; f < end; f++)
    atomic_init(&b->parent[f], (aqr_index)f);
}

static void unite_neighbours(void* data, size_t begin, size_t end)
{
  builder* b = data;
  for (aqr_index h = (aqr_index)begin; h < end; h++)
    if (b->s->twin[h] < h)
      aqr_unite(b->parent, h / 3, b->s->twin[h] / 3);
}

static void count_roots(void* data, size_t begin, size_t end)
{
  builder* b = data;
  size_t n = 0;
  for (aqr_index f = (aqr_index)begin; f < end; f++)
    n += aqr_above(b->parent, f) == f;
  b->components += n;
}

static aqr_status count_components(builder* b)
{
  size_t n = b->s->n_faces;
  aqr_status status = AQR_OK;
  b->parent = AQR_NEW(b->c, aqr_shared_index, n);
  AQR_REQUIRE(b->parent, AQR_OUT_OF_MEMORY);
  AQR_TRY(aqr_parallel(b->c, n, begin_components, b, 0.45, 0.46));
  AQR_TRY(aqr_parallel(b->c, 3 * n, unite_neighbours, b, 0.46, 0.54));
  AQR_TRY(aqr_parallel(b->c, n, count_roots, b, 0.54, 0.55));
  b->report->components = b->components;
done:
  AQR_DROP(b->c, b->parent, n);
  return status;
}

typedef struct orientation
{
  uint8_t *turn, *seen; /* per face */
  aqr_index* queue;     /* the component's faces */
  size_t n;
  bool any; /* is turned */
} orientation;

/* Gathers the component of a face, each face turned to agree with the one it is reached from. Edges over which no
 * choice agrees (Moebius) are cut. */
static aqr_status gather_component(builder* b, orientation* o, aqr_index start, size_t* n_turned)
{
  aqr_surface* s = b->s;
  o->n = *n_turned = 0;
  o->seen[start] = 1;
  o->queue[o->n++] = start;
  for (size_t i = 0; i < o->n; i++)
  {
    aqr_index f = o->queue[i];
    if (!aqr_worked(b->c, 8))
      return AQR_CANCELLED;
    *n_turned += o->turn[f];
    for (unsigned k = 0; k < 3; k++)
    {
      aqr_index h = 3 * f + k, t = s->twin[h];
      if (t == AQR_NONE)
        continue;
      uint8_t wanted = o->turn[f] ^ (uint8_t)!runs_against(s, h, t);
      if (!o->seen[t / 3])
      {
        o->seen[t / 3] = 1;
        o->turn[t / 3] = wanted;
        o->queue[o->n++] = t / 3;
      }
      else if (o->turn[t / 3] != wanted)
      {
        s->twin[h] = s->twin[t] = AQR_NONE;
        b->report->unorientable_edges++;
      }
    }
  }
  return AQR_OK;
}

/* The side that most faces of a component had wins. */
static void choose_side(builder* b, orientation* o, size_t n_turned)
{
  bool other = 2 * n_turned > o->n;
  for (size_t i = 0; i < o->n; i++)
  {
    aqr_index f = o->queue[i];
    o->turn[f] ^= other;
    b->report->flipped_triangles += o->turn[f];
    o->any |= o->turn[f];
  }
}

static aqr_status turn_faces(builder* b, const uint8_t* turn)
{
  aqr_surface* s = b->s;
  size_t n = s->n_faces;
  aqr_status status = AQR_OK;
  aqr_index* twin = AQR_NEW(b->c, aqr_index, 3 * n);
  AQR_REQUIRE(twin, AQR_OUT_OF_MEMORY);
  for (aqr_index h = 0; h < 3 * n; h++)
  {
    AQR_REQUIRE(aqr_worked(b->c, 1), AQR_CANCELLED);
    twin[turned(h, turn)] = s->twin[h] == AQR_NONE ? AQR_NONE : turned(s->twin[h], turn);
  }
  for (aqr_index f = 0; f < n; f++)
    if (turn[f])
    {
      aqr_index swap = s->corner[3 * f + 1];
      s->corner[3 * f + 1] = s->corner[3 * f + 2];
      s->corner[3 * f + 2] = swap;
    }
  memcpy(s->twin, twin, 3 * n * sizeof *twin);
done:
  AQR_DROP(b->c, twin, 3 * n);
  return status;
}

/* Turns faces so that neighbours agree. */
static aqr_status orient(builder* b)
{
  size_t n = b->s->n_faces, n_turned;
  aqr_status status = AQR_OK;
  orientation o = {
    .turn = AQR_NEW0(b->c, uint8_t, n), .seen = AQR_NEW0(b->c, uint8_t, n), .queue = AQR_NEW(b->c, aqr_index, n)
  };
  AQR_REQUIRE(o.turn && o.seen && o.queue, AQR_OUT_OF_MEMORY);
  for (aqr_index start = 0; start < n; start++)
  {
    if (o.seen[start])
      continue;
    AQR_TRY(gather_component(b, &o, start, &n_turned));
    choose_side(b, &o, n_turned);
    b->report->components++;
  }
  if (o.any)
    AQR_TRY(turn_faces(b, o.turn));
done:
  AQR_DROP(b->c, o.turn, n);
  AQR_DROP(b->c, o.seen, n);
  AQR_DROP(b->c, o.queue, n);
  return status;
}

/* ---- fans ---- */

/* The points that split_fans added: copies of old points, in order. */
typedef struct copies
{
  aqr_index* of;
  size_t n, capacity;
} copies;

/* The clockwise-most half-edge of the fan that h is in; h where the fan closes. */
static aqr_index fan_start(const aqr_surface* s, aqr_index h)
{
  aqr_index start = h;
  for (aqr_index t = aqr_twin(s, start); t != AQR_NONE; t = aqr_twin(s, start))
  {
    start = aqr_next(t);
    if (start == h)
      break;
  }
  return start;
}

/* Gives every fan of faces around a point a point of its own (the first keeps it), and every point its clockwise-most
 * outgoing half-edge. Coordinates are copied, what else belongs to a point is the caller's. */
static aqr_status split_fans(aqr_context* c, aqr_surface* s, copies* added)
{
  size_t n = 3 * s->n_faces, old = s->n_points;
  aqr_status status = AQR_OK;
  uint8_t *seen = AQR_NEW0(c, uint8_t, n), *claimed = AQR_NEW0(c, uint8_t, old);
  aqr_index* start_of = NULL; /* of the copies */
  size_t start_capacity = 0;
  AQR_REQUIRE(seen && claimed, AQR_OUT_OF_MEMORY);
  for (aqr_index h = 0; h < n; h++)
  {
    if (h % 65536 == 0)
      AQR_REQUIRE(aqr_step(c, 0.7), AQR_CANCELLED);
    if (seen[h])
      continue;
    aqr_index v = s->corner[h], start = fan_start(s, h), id = v;
    if (claimed[v])
    {
      AQR_REQUIRE(AQR_RESERVE(c, added->of, added->capacity, added->n + 1) &&
                    AQR_RESERVE(c, start_of, start_capacity, added->n + 1),
        AQR_OUT_OF_MEMORY);
      start_of[added->n] = start;
      id = (aqr_index)(old + added->n);
      added->of[added->n++] = v;
    }
    else
    {
      claimed[v] = 1;
      s->fan[v] = start;
    }
    aqr_index k = start;
    do
    {
      seen[k] = 1;
      s->corner[k] = id;
      k = aqr_next_around(s, k);
    } while (k != AQR_NONE && k != start);
  }
  if (added->n)
  {
    AQR_REQUIRE(old + added->n < AQR_SEAM, AQR_TOO_LARGE);
    AQR_REQUIRE(aqr_surface_reserve_points(c, s, old + added->n), AQR_OUT_OF_MEMORY);
    for (size_t i = 0; i < added->n; i++)
    {
      memcpy(s->points + 3 * (old + i), s->points + 3 * (size_t)added->of[i], 3 * sizeof *s->points);
      s->fan[old + i] = start_of[i];
    }
    s->n_points = old + added->n;
  }
done:
  AQR_DROP(c, seen, n);
  AQR_DROP(c, claimed, old);
  AQR_DROP(c, start_of, start_capacity);
  return status;
}

static void begin_fans(void* data, size_t begin, size_t end)
{
  builder* b = data;
  aqr_surface* s = b->s;
  size_t n = 0;
  for (size_t v = begin; v < end; v++)
  {
    aqr_index h = s->fan[v] = fan_start(s, s->fan[v]);
    do
    {
      n++;
      h = aqr_next_around(s, h);
    } while (h != AQR_NONE && h != s->fan[v]);
  }
  b->in_fans += n;
}

static aqr_status split_points(builder* b)
{
  aqr_surface* s = b->s;
  copies added = { 0 };
  aqr_status status = AQR_OK;
  size_t old = s->n_points;
  if (!b->disagree) /* no face has been turned: the first half-edges of points are still so */
  {
    AQR_TRY(aqr_parallel(b->c, s->n_points, begin_fans, b, 0.6, 0.7));
    if (b->in_fans == 3 * s->n_faces) /* every point has one fan */
      return AQR_OK;
  }
  AQR_TRY(split_fans(b->c, s, &added));
  b->report->split_points = added.n;
  AQR_REQUIRE(aqr_surface_reserve_origins(b->c, s, s->n_points), AQR_OUT_OF_MEMORY);
  for (size_t i = 0; i < added.n; i++)
    s->origin[old + i] = s->origin[added.of[i]];
done:
  AQR_DROP(b->c, added.of, added.capacity);
  return status;
}

/* Counts the boundary's loops. One of two edges is where a non-manifold edge was cut although the other faces there
 * left: both of its edges join the same two points, so they are one edge again. */
static aqr_status close_loops(builder* b)
{
  const aqr_surface* s = b->s;
  size_t n = 3 * s->n_faces;
  aqr_status status = AQR_OK;
  uint8_t* seen = AQR_NEW0(b->c, uint8_t, n);
  AQR_REQUIRE(seen, AQR_OUT_OF_MEMORY);
  for (aqr_index h = 0; h < n; h++)
  {
    AQR_REQUIRE(aqr_worked(b->c, 1), AQR_CANCELLED);
    if (seen[h] || !aqr_is_boundary(s, h))
      continue;
    /* every point has one fan: the border goes on along the clockwise-most half-edge of the next point */
    aqr_index next = s->fan[aqr_to(s, h)];
    if (aqr_to(s, next) == aqr_from(s, h))
    {
      s->twin[h] = next;
      s->twin[next] = h;
      continue;
    }
    b->report->boundary_loops++;
    for (aqr_index k = h; !seen[k]; k = s->fan[aqr_to(s, k)])
      seen[k] = 1;
  }
done:
  AQR_DROP(b->c, seen, n);
  return status;
}

aqr_status aqr_surface_split_fans(aqr_context* c, aqr_surface* s)
{
  copies added = { 0 };
  aqr_status status = AQR_OK;
  size_t old = s->n_points;
  AQR_TRY(split_fans(c, s, &added));
  AQR_REQUIRE(aqr_surface_reserve_origins(c, s, s->n_points), AQR_OUT_OF_MEMORY);
  for (size_t i = 0; i < added.n; i++)
    s->origin[old + i] = s->origin[added.of[i]];
  for (size_t i = 0; i < s->n_points; i++)
    s->clean[i] = (aqr_index)i;
  s->n_clean = s->n_points;
done:
  AQR_DROP(c, added.of, added.capacity);
  return status;
}

aqr_status aqr_surface_cut(aqr_context* c, aqr_surface* s, const uint8_t* is_crease)
{
  copies added = { 0 };
  aqr_status status = AQR_OK;
  size_t old = s->n_points;
  for (aqr_index h = 0; h < 3 * s->n_faces; h++)
    if (is_crease[h] && s->twin[h] != AQR_NONE)
      s->twin[h] |= AQR_SEAM;
  AQR_TRY(split_fans(c, s, &added));
  for (size_t i = 0; i < added.n; i++)
    s->clean[old + i] = s->clean[added.of[i]];
done:
  AQR_DROP(c, added.of, added.capacity);
  return status;
}

double aqr_surface_area(const aqr_surface* s)
{
  double area = 0;
  for (aqr_index f = 0; f < s->n_faces; f++)
    area += v3_norm(aqr_face_cross(s, f)) / 2;
  return area;
}

/* Triangles in order, and which meet. */
static aqr_status arrange(builder* b, bool unique)
{
  aqr_status status = AQR_OK;
  AQR_TRY(aqr_input_take(b->c, b->in, b->weld, unique, b->s, b->report));
  AQR_TRY(aqr_surface_arrange(b->c, b->in, b->s));
  AQR_TRY(check_areas(b));
  AQR_TRY(pair_half_edges(b));
done:
  return status;
}

aqr_status aqr_surface_build(
  aqr_context* c, const aqr_input* input, double longest_edge, aqr_surface* s, aqr_report* report)
{
  memset(s, 0, sizeof *s);
  builder b = { .c = c, .in = input, .s = s, .report = report };
  aqr_status status = AQR_OK;
  AQR_TRY(aqr_input_weld(c, input, report, &b.weld));
  AQR_TRY(arrange(&b, false));
  if (b.may_repeat) /* seldom: looking for it beforehand would cost a tenth of all */
    AQR_TRY(arrange(&b, true));
  AQR_TRY(b.disagree ? orient(&b) : count_components(&b));
  AQR_TRY(split_points(&b));
  AQR_TRY(close_loops(&b));
  AQR_TRY(aqr_surface_refine(c, s, longest_edge, &report->refined_points));
  for (size_t i = 0; i < s->n_points; i++)
    s->clean[i] = (aqr_index)i;
  s->n_clean = s->n_points;
  if (input->number_of_locked)
    AQR_TRY(aqr_surface_lock(c, input, b.weld, s, report));
done:
  AQR_DROP(c, b.weld, input->number_of_points);
  if (status != AQR_OK)
    aqr_surface_free(c, s);
  return status;
}
