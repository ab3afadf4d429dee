/* SPDX-License-Identifier: BSD-3-Clause */
#include "regularize.h"

#include "marks.h"

#include <stdatomic.h>
#include <string.h>

enum
{
  tidy_passes = 32,
  calm = 1 << 15,     /* half-edges with nothing to tidy, before all threads look where there is something again */
  most_compared = 32, /* edges or corners compared with each other to see whether one is double */
  arc_candidates = 24 /* corners tried on either side when a face that meets itself is split */
};

static const double straight_cosine2 = 0.9999; /* squared: half a degree, as of edges of one straight crease */

aqr_vertex aqr_middle(const aqr_polygon_mesh* m, aqr_index h)
{
  const aqr_vertex *a = &m->vertices[aqr_pm_from(m, h)], *b = &m->vertices[aqr_pm_to(m, h)];
  aqr_vertex r = *a;
  r.position = v3_scale(v3_add(a->position, b->position), 0.5);
  r.normal = v3_unit_or(v3_add(a->normal, b->normal), a->normal);
  r.size = 0.5 * (a->size + b->size);
  r.out = AQR_NONE;
  r.kind = m->edge_type[h >> 1] == AQR_LINE_BOUNDARY  ? AQR_VERTEX_BOUNDARY
           : m->edge_type[h >> 1] == AQR_LINE_FEATURE ? AQR_VERTEX_FEATURE
                                                      : AQR_VERTEX_INTERIOR;
  if (r.kind != AQR_VERTEX_INTERIOR)
    r.place.bary[0] = r.place.bary[1] = r.place.bary[2] = 0; /* on the chain, but where is not known yet */
  return r;
}

/* ---- tidying ---- */

/* A vertex of valence two where the line does not turn by more than thirty degrees. */
static bool is_straight(const aqr_polygon_mesh* m, aqr_index v)
{
  aqr_index h = m->vertices[v].out, g = aqr_pm_next_around(m, h);
  vec3 a = v3_sub(aqr_pm_point(m, aqr_pm_to(m, h)), aqr_pm_point(m, v));
  vec3 b = v3_sub(aqr_pm_point(m, aqr_pm_to(m, g)), aqr_pm_point(m, v));
  return v3_dot(a, b) < -0.866 * v3_norm(a) * v3_norm(b);
}

static bool tidy_at(aqr_polygon_mesh* m, aqr_index h)
{
  aqr_index n = aqr_pm_next(m, h), f = aqr_pm_face(m, h), v = aqr_pm_from(m, h);
  if (f == AQR_NONE)
    return false;
  if (!aqr_pm_on_chain(m, h))
  {
    if (aqr_pm_prev(m, h) == (h ^ 1))
      return aqr_pm_remove_leaf(m, h);
    if (n == h || (aqr_pm_next(m, n) == h && n != (h ^ 1)))
      return aqr_pm_remove_edge(m, h);
  }
  return m->vertices[v].out == h && aqr_can_join(m, v) && is_straight(m, v) && aqr_pm_join_edges(m, v);
}

/* Whether there may be something to tidy at h. */
static bool is_untidy(const aqr_polygon_mesh* m, aqr_index h)
{
  aqr_index n = aqr_pm_next(m, h), v = aqr_pm_from(m, h);
  if (aqr_pm_face(m, h) == AQR_NONE)
    return false;
  if (!aqr_pm_on_chain(m, h) && (aqr_pm_prev(m, h) == (h ^ 1) || n == h || aqr_pm_next(m, n) == h))
    return true;
  return m->vertices[v].out == h && aqr_can_join(m, v) && is_straight(m, v);
}

typedef struct search
{
  const aqr_polygon_mesh* m;
  size_t from;
  _Atomic(aqr_index) found; /* the least half-edge from there on that may be untidy */
} search;

static void find_untidy(void* data, size_t begin, size_t end)
{
  search* k = data;
  aqr_index h = (aqr_index)(k->from + begin), last = (aqr_index)(k->from + end), found = k->found;
  while (h < last && h < found && !(aqr_pm_edge_lives(k->m, h) && is_untidy(k->m, h)))
    h++;
  while (h < last && h < found && !atomic_compare_exchange_weak(&k->found, &found, h))
    ;
}

/* From the next untidy half-edge, which all threads look for, to where none has been met for a while. */
static aqr_status tidy_stretch(aqr_context* c, aqr_polygon_mesh* m, aqr_index* h, bool* changed)
{
  search next = { m, *h, (aqr_index)m->n_half_edges };
  aqr_status status = aqr_parallel(c, m->n_half_edges - *h, find_untidy, &next, 0, 0);
  *h = next.found;
  for (unsigned tidy = 0; status == AQR_OK && tidy < calm && *h < m->n_half_edges; tidy++, ++*h)
    while (aqr_pm_edge_lives(m, *h) && tidy_at(m, *h)) /* each turn removes an edge */
    {
      *changed = true;
      tidy = 0;
    }
  return status;
}

aqr_status aqr_tidy(aqr_context* c, aqr_polygon_mesh* m)
{
  aqr_status status = AQR_OK;
  bool changed = true;
  for (unsigned pass = 0; pass < tidy_passes && changed; pass++)
  {
    changed = false;
    AQR_REQUIRE(aqr_step(c, 0), AQR_CANCELLED);
    for (aqr_index h = 0; h < m->n_half_edges;)
      AQR_TRY(tidy_stretch(c, m, &h, &changed));
  }
done:
  return status;
}

/* ---- making it regular ---- */

/* The middle of an edge, drawn towards the faces beside it: edges between the same two vertices part this way. */
static aqr_vertex aside(const aqr_polygon_mesh* m, aqr_index h)
{
  aqr_vertex r = aqr_middle(m, h);
  if (r.kind != AQR_VERTEX_INTERIOR)
    return r;
  vec3 sum = { 0, 0, 0 };
  for (unsigned side = 0; side < 2; side++)
  {
    aqr_index k = h ^ side;
    vec3 centre = { 0, 0, 0 };
    double n = 0;
    do
    {
      centre = v3_add(centre, aqr_pm_point(m, aqr_pm_from(m, k)));
      n += 1;
      k = aqr_pm_next(m, k);
    } while (k != (h ^ side));
    sum = v3_madd(sum, 1 / n, centre);
  }
  r.position = v3_madd(v3_scale(r.position, 0.5), 0.25, sum);
  return r;
}

static aqr_status split_aside(aqr_context* c, aqr_polygon_mesh* m, aqr_index h)
{
  aqr_vertex w = aside(m, h);
  aqr_index inserted;
  return aqr_pm_split_edge(c, m, h, &w, &inserted);
}

/* Whether a vertex has two edges to one with a higher number, or too many to compare them. Splitting the edges at one
 * vertex makes none parallel at another. */
static bool may_have_parallel_edges(const aqr_polygon_mesh* m, aqr_index u, const void* options)
{
  (void)options;
  aqr_index first = m->vertices[u].out, h = first;
  size_t n = 0;
  if (first == AQR_NONE)
    return false;
  do
  {
    for (aqr_index g = first; g != h; g = aqr_pm_next_around(m, g))
      if (aqr_pm_to(m, g) == aqr_pm_to(m, h) && aqr_pm_to(m, h) > u)
        return true;
    h = aqr_pm_next_around(m, h);
    n++;
  } while (h != first && n < most_compared);
  return h != first;
}

/* Loops become three edges; of two edges between the same vertices one is split, rather not one of a chain. Afterwards
 * the graph is simple: inserted vertices have two different neighbours and no parallel edges. */
static aqr_status split_parallel_edges(aqr_context* c, aqr_polygon_mesh* m)
{
  aqr_status status = AQR_OK;
  size_t n = m->n_vertices, n_edges = m->n_half_edges;
  aqr_index *seen = AQR_NEW(c, aqr_index, n), *by = AQR_NEW(c, aqr_index, n);
  aqr_marks parallel = { 0 };
  AQR_REQUIRE(seen && by, AQR_OUT_OF_MEMORY);
  for (aqr_index h = 0; h < n_edges; h += 2)
    if (aqr_pm_edge_lives(m, h) && aqr_pm_from(m, h) == aqr_pm_to(m, h))
    {
      AQR_TRY(split_aside(c, m, h));
      AQR_TRY(split_aside(c, m, h));
    }
  for (size_t v = 0; v < n; v++)
    by[v] = AQR_NONE;
  AQR_TRY(aqr_mark(c, m, n, may_have_parallel_edges, NULL, &parallel));
  for (aqr_index u = 0; u < n; u++)
  {
    if (!aqr_is_marked(&parallel, u))
      continue;
    aqr_index h = m->vertices[u].out;
    do
    {
      aqr_index v = aqr_pm_to(m, h);
      if (v > u && v < n)
      {
        if (by[v] == u)
        {
          bool other = aqr_pm_on_chain(m, h) && !aqr_pm_on_chain(m, seen[v]);
          aqr_index k = other ? seen[v] : h;
          if (other)
            seen[v] = h;
          AQR_TRY(split_aside(c, m, k)); /* keeps the half-edge at u */
        }
        else
        {
          by[v] = u;
          seen[v] = h;
        }
      }
      h = aqr_pm_next_around(m, h);
    } while (h != m->vertices[u].out);
  }
  /* A lone edge with one face around it. */
  for (aqr_index h = 0; h < m->n_half_edges; h += 2)
    if (aqr_pm_edge_lives(m, h) && aqr_pm_next(m, h) == (h ^ 1) && aqr_pm_prev(m, h) == (h ^ 1))
      AQR_TRY(split_aside(c, m, h));
done:
  aqr_marks_free(c, &parallel);
  AQR_DROP(c, seen, n);
  AQR_DROP(c, by, n);
  return status;
}

typedef struct walker
{
  aqr_index* corner; /* half-edges of the face at hand */
  size_t n, capacity;
  aqr_index* last; /* per vertex: last position in the face at hand, valid where `mark` says so */
  aqr_index* mark;
  size_t last_capacity, mark_capacity;
} walker;

static aqr_status collect(aqr_context* c, const aqr_polygon_mesh* m, aqr_index f, walker* w)
{
  w->n = 0;
  aqr_index h = m->faces[f];
  do
  {
    if (!AQR_RESERVE(c, w->corner, w->capacity, w->n + 1))
      return AQR_OUT_OF_MEMORY;
    w->corner[w->n++] = h;
    h = aqr_pm_next(m, h);
  } while (h != m->faces[f]);
  return AQR_OK;
}

/* Two corners of the face at the same vertex. `stamp` differs from call to call. */
static bool find_repeat(const aqr_polygon_mesh* m, walker* w, aqr_index stamp, size_t* i, size_t* j)
{
  for (size_t k = 0; k < w->n; k++)
  {
    aqr_index v = aqr_pm_from(m, w->corner[k]);
    if (w->mark[v] == stamp)
    {
      *i = w->last[v];
      *j = k;
      return true;
    }
    w->mark[v] = stamp;
    w->last[v] = (aqr_index)k;
  }
  return false;
}

/* Joins two corners of a face by an edge, with a vertex in its middle where there is such an edge already. */
static aqr_status connect(aqr_context* c, aqr_polygon_mesh* m, aqr_index h0, aqr_index h1)
{
  bool direct = aqr_pm_find(m, aqr_pm_from(m, h0), aqr_pm_from(m, h1)) == AQR_NONE;
  aqr_status status = aqr_pm_split_face(c, m, h0, h1, AQR_LINE_MIN);
  return status != AQR_OK || direct ? status : split_aside(c, m, aqr_pm_prev(m, h0));
}

/* Whether a connection from p to q goes through `middle`: along a crease that ends there it would leave no area. */
static bool goes_through(vec3 p, vec3 middle, vec3 q)
{
  vec3 a = v3_sub(p, middle), b = v3_sub(q, middle);
  double along = v3_dot(a, b);
  return along < 0 && along * along > straight_cosine2 * v3_norm2(a) * v3_norm2(b);
}

/* The shortest connection between the corners after i and before j and those after j and before i: corners *from
 * and *to. */
static bool choose_connection(const aqr_polygon_mesh* m, const walker* w, size_t i, size_t j, size_t* from, size_t* to)
{
  size_t inner = j - i - 1, outer = w->n - inner - 2;
  size_t step_in = inner / arc_candidates + 1, step_out = outer / arc_candidates + 1;
  const vec3 repeated = aqr_pm_point(m, aqr_pm_from(m, w->corner[i]));
  double best = INFINITY;
  bool found = false;
  for (unsigned whole = 0; whole < 2 && !found;
       whole++) /* all pairs only where the chosen ones are all of one vertex */
  {
    for (size_t a = 0; a < inner; a += whole ? 1 : step_in)
      for (size_t b = 0; b < outer; b += whole ? 1 : step_out)
      {
        size_t in = i + 1 + a, out = (j + 1 + b) % w->n;
        aqr_index u = aqr_pm_from(m, w->corner[in]), v = aqr_pm_from(m, w->corner[out]);
        double d = v3_norm2(v3_sub(aqr_pm_point(m, u), aqr_pm_point(m, v)));
        if (u == v)
          continue;
        if (aqr_pm_find(m, u, v) != AQR_NONE || goes_through(aqr_pm_point(m, u), repeated, aqr_pm_point(m, v)))
          d = 4 * d + 1;
        if (!found || d < best)
        {
          found = true;
          best = d;
          *from = in;
          *to = out;
        }
      }
  }
  return found;
}

/* What is left of the face at hand once its corners `from` and `to` are joined: those from the first to the second, and
 * the new edge back. Walking around the face once more for each of its repeats would take long where it is large. */
static aqr_status keep_rest(aqr_context* c, const aqr_polygon_mesh* m, walker* w, size_t from, size_t to)
{
  size_t wrapped = to < from ? to : 0;
  if (!AQR_RESERVE(c, w->corner, w->capacity, w->n + wrapped))
    return AQR_OUT_OF_MEMORY;
  memcpy(w->corner + w->n, w->corner, wrapped * sizeof *w->corner);
  w->n = (to < from ? w->n + to : to) - from;
  memmove(w->corner, w->corner + from, w->n * sizeof *w->corner);
  for (aqr_index h = aqr_pm_next(m, w->corner[w->n - 1]); h != w->corner[0]; h = aqr_pm_next(m, h))
  {
    if (!AQR_RESERVE(c, w->corner, w->capacity, w->n + 1))
      return AQR_OUT_OF_MEMORY;
    w->corner[w->n++] = h;
  }
  return AQR_OK;
}

/* Splitting one face leaves the corners of others as they are. */
static bool may_have_repeats(const aqr_polygon_mesh* m, aqr_index f, const void* options)
{
  (void)options;
  return m->faces[f] != AQR_NONE && aqr_pm_may_meet_itself(m, f, most_compared);
}

/* Each split lowers the sum over all faces of (corners - different vertices) by at least one, because the two corners
 * at one vertex come to lie in different faces and every other vertex gains at most a corner where it gains a face. In
 * a simple graph there is always a pair of different vertices to connect: else the face would be v w v w, which needs
 * two edges between v and w. */
static aqr_status part_repeats(aqr_context* c, aqr_polygon_mesh* m)
{
  aqr_status status = AQR_OK;
  walker w = { 0 };
  aqr_index stamp = 0;
  size_t known = 0;
  aqr_marks repeats = { 0 };
  AQR_TRY(aqr_mark(c, m, m->n_faces, may_have_repeats, NULL, &repeats));
  for (aqr_index f = 0; f < m->n_faces; f++)
  {
    if (m->faces[f] == AQR_NONE || !aqr_is_marked(&repeats, f))
      continue;
    AQR_TRY(collect(c, m, f, &w));
    for (;;)
    {
      if (stamp % 4096 == 0)
        AQR_REQUIRE(aqr_step(c, 0), AQR_CANCELLED);
      size_t i, j, from, to;
      AQR_REQUIRE(AQR_RESERVE(c, w.last, w.last_capacity, m->n_vertices) &&
                    AQR_RESERVE(c, w.mark, w.mark_capacity, m->n_vertices),
        AQR_OUT_OF_MEMORY);
      for (; known < m->n_vertices; known++)
        w.mark[known] = 0;
      if (!find_repeat(m, &w, ++stamp, &i, &j))
        break;
      AQR_REQUIRE(choose_connection(m, &w, i, j, &from, &to), AQR_INTERNAL);
      if ((to + w.n - from) % w.n < w.n / 2) /* the larger part stays at hand, and only the other gets a new number */
      {
        size_t swap = from;
        from = to;
        to = swap;
      }
      AQR_TRY(connect(c, m, w.corner[from], w.corner[to]));
      AQR_TRY(keep_rest(c, m, &w, from, to));
    }
  }
done:
  aqr_marks_free(c, &repeats);
  AQR_DROP(c, w.corner, w.capacity);
  AQR_DROP(c, w.last, w.last_capacity);
  AQR_DROP(c, w.mark, w.mark_capacity);
  return status;
}

static bool has_duplicate(const aqr_polygon_mesh* m, aqr_index f, const void* options)
{
  (void)options;
  return m->faces[f] != AQR_NONE && aqr_pm_duplicate(m, f) != AQR_NONE;
}

/* A vertex inside the first of two faces with the same vertices tells them apart, and no other face has it. */
static aqr_status part_duplicates(aqr_context* c, aqr_polygon_mesh* m)
{
  aqr_status status = AQR_OK;
  size_t n = m->n_faces;
  aqr_marks duplicates = { 0 };
  AQR_TRY(aqr_mark(c, m, n, has_duplicate, NULL, &duplicates));
  for (aqr_index f = 0; f < n; f++)
  {
    if (!aqr_is_marked(&duplicates, f) || !has_duplicate(m, f, NULL)) /* not where the other has been parted from it */
      continue;
    aqr_index h0 = m->faces[f], h1 = aqr_pm_next(m, h0), h2 = aqr_pm_next(m, h1), inserted;
    bool triangle = aqr_pm_next(m, h2) == h0;
    vec3 centre = { 0, 0, 0 };
    double size = 0;
    aqr_index k = h0;
    do
    {
      centre = v3_add(centre, aqr_pm_point(m, aqr_pm_from(m, k)));
      size += 1;
      k = aqr_pm_next(m, k);
    } while (k != h0);
    AQR_TRY(aqr_pm_split_face(c, m, h0, triangle ? h1 : h2, AQR_LINE_MIN));
    aqr_vertex w = aqr_middle(m, aqr_pm_prev(m, h0));
    w.position = v3_scale(centre, 1 / size);
    AQR_TRY(aqr_pm_split_edge(c, m, aqr_pm_prev(m, h0), &w, &inserted));
    if (triangle) /* the other face is now h1, h2 and back by way of the centre: join the centre to its third corner */
      AQR_TRY(aqr_pm_split_face(c, m, h2, aqr_pm_next(m, aqr_pm_next(m, h2)), AQR_LINE_MIN));
  }
done:
  aqr_marks_free(c, &duplicates);
  return status;
}

aqr_status aqr_regularize(aqr_context* c, aqr_polygon_mesh* m)
{
  aqr_status status = AQR_OK;
  AQR_TRY(split_parallel_edges(c, m));
  AQR_REQUIRE(aqr_step(c, 0), AQR_CANCELLED);
  AQR_TRY(part_repeats(c, m));
  AQR_REQUIRE(aqr_step(c, 0), AQR_CANCELLED);
  AQR_TRY(part_duplicates(c, m));
done:
  return status;
}

/* ---- operators that keep a mesh regular ---- */

bool aqr_can_merge(const aqr_polygon_mesh* m, aqr_index h)
{
  aqr_index f = aqr_pm_face(m, h), g = aqr_pm_face(m, h ^ 1);
  if (aqr_pm_on_chain(m, h) || f == AQR_NONE || g == AQR_NONE || f == g)
    return false;
  unsigned common = 0;
  for (aqr_index k = aqr_pm_next(m, h); k != h && common <= 2; k = aqr_pm_next(m, k))
    common += aqr_pm_face_has(m, g, aqr_pm_from(m, k));
  return common + aqr_pm_face_has(m, g, aqr_pm_from(m, h)) == 2;
}

bool aqr_can_join(const aqr_polygon_mesh* m, aqr_index v)
{
  aqr_index h = m->vertices[v].out, g = aqr_pm_next_around(m, h);
  if (m->vertices[v].kind != AQR_VERTEX_INTERIOR || g == h || aqr_pm_next_around(m, g) != h)
    return false;
  if (aqr_pm_on_chain(m, h) || aqr_pm_on_chain(m, g))
    return false;
  aqr_index a = aqr_pm_to(m, h), b = aqr_pm_to(m, g);
  if (a == b || a == v || b == v || aqr_pm_find(m, a, b) != AQR_NONE)
    return false;
  for (unsigned side = 0; side < 2; side++)
  {
    aqr_index k = side ? g : h;
    if (aqr_pm_face(m, k) == AQR_NONE || aqr_pm_next(m, aqr_pm_next(m, aqr_pm_next(m, k))) == k)
      return false;
  }
  return true;
}

/* The corner opposite to h where its face is a triangle; AQR_NONE otherwise. */
static aqr_index apex(const aqr_polygon_mesh* m, aqr_index h)
{
  aqr_index n = aqr_pm_next(m, h), p = aqr_pm_prev(m, h);
  return aqr_pm_face(m, h) != AQR_NONE && aqr_pm_next(m, n) == p ? aqr_pm_from(m, p) : AQR_NONE;
}

/* Whether the chains allow to bring the two ends of h together. */
static bool chains_allow(const aqr_polygon_mesh* m, aqr_index h)
{
  aqr_index u = aqr_pm_from(m, h), v = aqr_pm_to(m, h);
  uint8_t a = m->vertices[u].kind, b = m->vertices[v].kind;
  bool chain = aqr_pm_on_chain(m, h);
  bool border = aqr_pm_face(m, h) == AQR_NONE || aqr_pm_face(m, h ^ 1) == AQR_NONE;
  if (a == AQR_VERTEX_CORNER && b == AQR_VERTEX_CORNER)
    return false;
  if (a != AQR_VERTEX_INTERIOR && b != AQR_VERTEX_INTERIOR && !chain)
    return false;
  return border || !aqr_pm_on_border(m, u) || !aqr_pm_on_border(m, v);
}

/* A triangle beside a contracted edge becomes one edge: its apex must keep a fan, and its two edges may not both be of
 * chains. */
static bool triangle_may_go(const aqr_polygon_mesh* m, aqr_index h)
{
  aqr_index w = apex(m, h);
  if (w == AQR_NONE)
    return true;
  if (aqr_pm_on_chain(m, aqr_pm_next(m, h)) && aqr_pm_on_chain(m, aqr_pm_prev(m, h)))
    return false;
  return aqr_pm_valence(m, w) > (aqr_pm_on_border(m, w) ? 2 : 3);
}

/* Whether a triangle would be one in whose corner, inside a chain, two edges of chains meet: on a straight crease it
 * has no area. The edges lie between the vertices in turn, from the first to the second on. */
static bool is_flat(const aqr_polygon_mesh* m, const aqr_index* vertex, const bool* on_chain)
{
  for (unsigned i = 0; i < 3; i++)
  {
    uint8_t kind = m->vertices[vertex[i]].kind;
    if (on_chain[i] && on_chain[(i + 2) % 3] && (kind == AQR_VERTEX_FEATURE || kind == AQR_VERTEX_BOUNDARY))
      return true;
  }
  return false;
}

/* Whether contracting h leaves such a triangle of its face, or beyond the two edges of it that become one. `kept`: the
 * end of h that stays. */
static bool flattens(const aqr_polygon_mesh* m, aqr_index h, aqr_index kept)
{
  aqr_index n = aqr_pm_next(m, h), p = aqr_pm_prev(m, h), o = aqr_pm_next(m, n);
  if (aqr_pm_face(m, h) == AQR_NONE)
    return false;
  if (aqr_pm_next(m, o) == p) /* a quad */
  {
    const aqr_index vertex[3] = { kept, aqr_pm_from(m, o), aqr_pm_from(m, p) };
    const bool on_chain[3] = { aqr_pm_on_chain(m, n), aqr_pm_on_chain(m, o), aqr_pm_on_chain(m, p) };
    return is_flat(m, vertex, on_chain);
  }
  if (o != p || aqr_pm_on_chain(m, n) == aqr_pm_on_chain(m, p))
    return false;
  aqr_index k = (aqr_pm_on_chain(m, n) ? p : n) ^ 1; /* comes to lie on the chain */
  if (aqr_pm_face(m, k) == AQR_NONE || apex(m, k) == AQR_NONE)
    return false;
  aqr_index gone = aqr_pm_from(m, h) == kept ? aqr_pm_to(m, h) : aqr_pm_from(m, h);
  aqr_index vertex[3] = { aqr_pm_from(m, k), aqr_pm_to(m, k), apex(m, k) };
  for (unsigned i = 0; i < 3; i++)
    vertex[i] = vertex[i] == gone ? kept : vertex[i];
  const bool on_chain[3] = { true, aqr_pm_on_chain(m, aqr_pm_next(m, k)), aqr_pm_on_chain(m, aqr_pm_prev(m, k)) };
  return is_flat(m, vertex, on_chain);
}

bool aqr_can_contract(const aqr_polygon_mesh* m, aqr_index h)
{
  aqr_index t = h ^ 1, u = aqr_pm_from(m, h), v = aqr_pm_to(m, h), f = aqr_pm_face(m, h), g = aqr_pm_face(m, t);
  if (!chains_allow(m, h) || !triangle_may_go(m, h) || !triangle_may_go(m, t))
    return false;
  aqr_index kept = m->vertices[v].kind > m->vertices[u].kind ? v : u;
  if (flattens(m, h, kept) || flattens(m, t, kept))
    return false;
  aqr_index left = apex(m, h), right = apex(m, t);
  size_t valence = aqr_pm_valence(m, u) + aqr_pm_valence(m, v) - 2 - (left != AQR_NONE) - (right != AQR_NONE);
  bool border = aqr_pm_on_border(m, u) || aqr_pm_on_border(m, v);
  if (valence < (border ? 2 : 3))
    return false;
  aqr_index outer = f == AQR_NONE ? h : g == AQR_NONE ? t : AQR_NONE;
  if (outer != AQR_NONE && aqr_pm_next(m, aqr_pm_next(m, aqr_pm_next(m, outer))) == outer)
    return false;
  /* link condition: common neighbours are apexes only, common faces are those beside the edge only */
  for (aqr_index k = aqr_pm_next_around(m, h); k != h; k = aqr_pm_next_around(m, k))
  {
    aqr_index w = aqr_pm_to(m, k), face = aqr_pm_face(m, k);
    if (w != left && w != right && aqr_pm_find(m, w, v) != AQR_NONE)
      return false;
    if (face != AQR_NONE && face != f && face != g && aqr_pm_face_has(m, face, v))
      return false;
  }
  return true;
}

/* Merges the two edges of a digon at k into one; the one of a chain stays. */
static void close_digon(aqr_polygon_mesh* m, aqr_index k)
{
  aqr_index n = aqr_pm_next(m, k);
  if (aqr_pm_face(m, k) == AQR_NONE || aqr_pm_next(m, n) != k)
    return;
  if (aqr_pm_on_chain(m, k) || !aqr_pm_remove_edge(m, k))
    aqr_pm_remove_edge(m, n);
}

aqr_index aqr_contract(aqr_polygon_mesh* m, aqr_index h, const aqr_vertex* middle)
{
  if (m->vertices[aqr_pm_to(m, h)].kind > m->vertices[aqr_pm_from(m, h)].kind)
    h ^= 1;
  aqr_index u = aqr_pm_from(m, h), left = aqr_pm_next(m, h), right = aqr_pm_next(m, h ^ 1);
  bool free_ends = m->vertices[u].kind == AQR_VERTEX_INTERIOR;
  if (!aqr_pm_contract(m, h))
    return AQR_NONE;
  if (free_ends && middle)
  {
    aqr_vertex w = *middle;
    w.kind = AQR_VERTEX_INTERIOR;
    w.out = m->vertices[u].out;
    m->vertices[u] = w;
  }
  close_digon(m, left);
  close_digon(m, right);
  return u;
}
