/* SPDX-License-Identifier: BSD-3-Clause */
#include "polygon_mesh.h"

#include "shared.h"

#include <stdlib.h>
#include <string.h>

enum
{
  small_fan = 4 /* edges at a vertex: looking for a vertex with fewer costs more than it saves */
};

size_t aqr_pm_valence(const aqr_polygon_mesh* m, aqr_index v)
{
  size_t n = 0;
  aqr_index h = m->vertices[v].out;
  do
  {
    n++;
    h = aqr_pm_next_around(m, h);
  } while (h != m->vertices[v].out);
  return n;
}

size_t aqr_pm_face_size(const aqr_polygon_mesh* m, aqr_index f)
{
  size_t n = 0;
  aqr_index h = m->faces[f];
  do
  {
    n++;
    h = aqr_pm_next(m, h);
  } while (h != m->faces[f]);
  return n;
}

aqr_index aqr_pm_find(const aqr_polygon_mesh* m, aqr_index u, aqr_index v)
{
  /* Both orbits are walked in step, so that the cost is that of the smaller one. */
  aqr_index h = m->vertices[u].out, g = m->vertices[v].out;
  do
  {
    if (aqr_pm_to(m, h) == v)
      return h;
    if (aqr_pm_to(m, g) == u)
      return g ^ 1;
    h = aqr_pm_next_around(m, h);
    g = aqr_pm_next_around(m, g);
  } while (h != m->vertices[u].out && g != m->vertices[v].out);
  return AQR_NONE;
}

static bool face_has(const aqr_polygon_mesh* m, aqr_index f, aqr_index v)
{
  aqr_index h = m->faces[f];
  do
  {
    if (aqr_pm_from(m, h) == v)
      return true;
    h = aqr_pm_next(m, h);
  } while (h != m->faces[f]);
  return false;
}

bool aqr_pm_same_vertices(const aqr_polygon_mesh* m, aqr_index f, aqr_index g)
{
  aqr_index h = m->faces[f], k = m->faces[g];
  do /* the same number of corners */
  {
    h = aqr_pm_next(m, h);
    k = aqr_pm_next(m, k);
  } while (h != m->faces[f] && k != m->faces[g]);
  if (h != m->faces[f] || k != m->faces[g])
    return false;
  do
  {
    if (!face_has(m, g, aqr_pm_from(m, h)))
      return false;
    h = aqr_pm_next(m, h);
  } while (h != m->faces[f]);
  return true;
}

aqr_index aqr_pm_duplicate(const aqr_polygon_mesh* m, aqr_index f)
{
  /* A face with the same vertices is around each of them: look around one with a small fan. */
  aqr_index h = m->faces[f], best = h;
  size_t least = SIZE_MAX;
  do
  {
    size_t n = aqr_pm_valence(m, aqr_pm_from(m, h));
    if (n < least)
    {
      least = n;
      best = h;
    }
    h = aqr_pm_next(m, h);
  } while (h != m->faces[f] && least > small_fan);
  h = best;
  do
  {
    aqr_index g = aqr_pm_face(m, h);
    if (g != AQR_NONE && g != f && aqr_pm_same_vertices(m, f, g))
      return g;
    h = aqr_pm_next_around(m, h);
  } while (h != best);
  return AQR_NONE;
}

/* ---- Euler operators ---- */

static void link_half_edges(aqr_polygon_mesh* m, aqr_index a, aqr_index b)
{
  m->half_edges[a].next = b;
  m->half_edges[b].prev = a;
}

static void delete_edge(aqr_polygon_mesh* m, aqr_index h)
{
  m->half_edges[h].from = AQR_NONE;
  m->half_edges[h ^ 1].from = AQR_NONE;
}

/* Makes the outgoing half-edge of h's start the outer one where there is one. */
static void set_out(aqr_polygon_mesh* m, aqr_index h)
{
  aqr_index v = aqr_pm_from(m, h), k = h;
  m->vertices[v].out = h;
  do
  {
    if (aqr_pm_face(m, k) == AQR_NONE)
      m->vertices[v].out = k;
    k = aqr_pm_next_around(m, k);
  } while (k != h);
}

static aqr_status add_edge(aqr_context* c, aqr_polygon_mesh* m, uint8_t type, aqr_index* h)
{
  if (m->n_half_edges >= AQR_NONE - 2)
    return AQR_TOO_LARGE;
  if (!AQR_RESERVE(c, m->half_edges, m->half_edge_capacity, m->n_half_edges + 2) ||
      !AQR_RESERVE(c, m->edge_type, m->edge_capacity, m->n_half_edges / 2 + 1))
    return AQR_OUT_OF_MEMORY;
  *h = (aqr_index)m->n_half_edges;
  m->edge_type[*h >> 1] = type;
  m->n_half_edges += 2;
  return AQR_OK;
}

aqr_status aqr_pm_split_edge(
  aqr_context* c, aqr_polygon_mesh* m, aqr_index h, const aqr_vertex* vertex, aqr_index* inserted)
{
  aqr_vertex copy = *vertex; /* it may be one of the vertices that the reserve below moves */
  aqr_index g;
  if (!AQR_RESERVE(c, m->vertices, m->vertex_capacity, m->n_vertices + 1))
    return AQR_OUT_OF_MEMORY;
  aqr_status status = add_edge(c, m, m->edge_type[h >> 1], &g);
  if (status != AQR_OK)
    return status;
  aqr_half_edge* e = m->half_edges;
  aqr_index t = h ^ 1, w = (aqr_index)m->n_vertices++, v = e[t].from, next = e[h].next, prev = e[t].prev;
  e[g] = (aqr_half_edge){ .from = w, .face = e[h].face };
  e[g ^ 1] = (aqr_half_edge){ .from = v, .face = e[t].face };
  if (next == t)
    link_half_edges(m, g, g ^ 1);
  else
  {
    link_half_edges(m, g, next);
    link_half_edges(m, prev, g ^ 1);
  }
  link_half_edges(m, h, g);
  link_half_edges(m, g ^ 1, t);
  e[t].from = w;
  if (m->vertices[v].out == t)
    m->vertices[v].out = g ^ 1;
  copy.out = e[t].face == AQR_NONE ? t : g;
  m->vertices[w] = copy;
  *inserted = w;
  return AQR_OK;
}

aqr_status aqr_pm_split_face(aqr_context* c, aqr_polygon_mesh* m, aqr_index h0, aqr_index h1, uint8_t type)
{
  aqr_index g;
  if (h0 == h1 || aqr_pm_face(m, h0) == AQR_NONE || aqr_pm_face(m, h0) != aqr_pm_face(m, h1))
    return AQR_INTERNAL;
  if (!AQR_RESERVE(c, m->faces, m->face_capacity, m->n_faces + 1))
    return AQR_OUT_OF_MEMORY;
  aqr_status status = add_edge(c, m, type, &g);
  if (status != AQR_OK)
    return status;
  aqr_half_edge* e = m->half_edges;
  aqr_index f = e[h0].face, added = (aqr_index)m->n_faces++, p0 = e[h0].prev, p1 = e[h1].prev;
  e[g] = (aqr_half_edge){ .from = e[h1].from, .face = f };
  e[g ^ 1] = (aqr_half_edge){ .from = e[h0].from, .face = added };
  link_half_edges(m, p1, g);
  link_half_edges(m, g, h0);
  link_half_edges(m, p0, g ^ 1);
  link_half_edges(m, g ^ 1, h1);
  m->faces[f] = h0;
  m->faces[added] = h1;
  for (aqr_index k = h1; k != (g ^ 1); k = e[k].next)
    e[k].face = added;
  return AQR_OK;
}

/* Cuts h out of its loop. */
static void unlink_half_edge(aqr_polygon_mesh* m, aqr_index h)
{
  link_half_edges(m, aqr_pm_prev(m, h), aqr_pm_next(m, h));
}

/* An outgoing half-edge beside h and its twin of the start of h; AQR_NONE where there is none. */
static aqr_index other_out(const aqr_polygon_mesh* m, aqr_index h)
{
  for (aqr_index k = aqr_pm_next_around(m, h); k != h; k = aqr_pm_next_around(m, k))
    if (k != (h ^ 1))
      return k;
  return AQR_NONE;
}

bool aqr_pm_remove_edge(aqr_polygon_mesh* m, aqr_index h)
{
  aqr_half_edge* e = m->half_edges;
  aqr_index t = h ^ 1, f = e[h].face, g = e[t].face;
  if (f == AQR_NONE || g == AQR_NONE || f == g)
    return false;
  aqr_index out_u = other_out(m, h), out_v = other_out(m, t);
  if (out_u == AQR_NONE || out_v == AQR_NONE)
    return false; /* a vertex would be left alone */
  aqr_index u = e[h].from, v = e[t].from;
  for (aqr_index k = e[t].next; k != t; k = e[k].next)
    e[k].face = f;
  m->faces[f] = e[h].next != h ? e[h].next : e[t].next;
  aqr_index h_prev = e[h].prev, h_next = e[h].next, t_prev = e[t].prev, t_next = e[t].next;
  if (h_next == h)
    unlink_half_edge(m, t);
  else if (t_next == t)
    unlink_half_edge(m, h);
  else
  {
    link_half_edges(m, h_prev, t_next);
    link_half_edges(m, t_prev, h_next);
  }
  m->faces[g] = AQR_NONE;
  if (m->vertices[u].out == h || m->vertices[u].out == t)
    m->vertices[u].out = out_u;
  if (m->vertices[v].out == h || m->vertices[v].out == t)
    m->vertices[v].out = out_v;
  delete_edge(m, h);
  return true;
}

bool aqr_pm_remove_leaf(aqr_polygon_mesh* m, aqr_index h)
{
  aqr_half_edge* e = m->half_edges;
  aqr_index t = h ^ 1, leaf = e[h].from, v = e[t].from;
  if (e[h].prev != t || e[h].next == t)
    return false;
  aqr_index out = e[h].next;
  link_half_edges(m, e[t].prev, out);
  if (m->vertices[v].out == t)
    m->vertices[v].out = out;
  if (e[h].face != AQR_NONE)
    m->faces[e[h].face] = out;
  m->vertices[leaf].out = AQR_NONE;
  delete_edge(m, h);
  return true;
}

bool aqr_pm_join_edges(aqr_polygon_mesh* m, aqr_index v)
{
  aqr_half_edge* e = m->half_edges;
  aqr_index h = m->vertices[v].out, g = aqr_pm_next_around(m, h), t = h ^ 1, p = g ^ 1;
  if (g == h || g == t || aqr_pm_next_around(m, g) != h)
    return false;
  /* p: a -> v and h: v -> b become p: a -> b; t: b -> v and g: v -> a become g: b -> a */
  aqr_index b = e[t].from;
  if (e[h].next == t)
    link_half_edges(m, p, g);
  else
  {
    link_half_edges(m, p, e[h].next);
    link_half_edges(m, e[t].prev, g);
  }
  e[g].from = b;
  if (m->vertices[b].out == t)
    m->vertices[b].out = g;
  if (e[p].face != AQR_NONE)
    m->faces[e[p].face] = p;
  if (e[g].face != AQR_NONE)
    m->faces[e[g].face] = g;
  if (aqr_pm_on_chain(m, h))
    m->edge_type[p >> 1] = m->edge_type[h >> 1];
  m->vertices[v].out = AQR_NONE;
  delete_edge(m, h);
  return true;
}

bool aqr_pm_contract(aqr_polygon_mesh* m, aqr_index h)
{
  aqr_half_edge* e = m->half_edges;
  aqr_index t = h ^ 1, u = e[h].from, v = e[t].from;
  if (u == v)
    return false;
  if (e[h].next == t)
    return aqr_pm_remove_leaf(m, t);
  if (e[h].prev == t) /* the start is a leaf: its edge shrinks from the other side */
  {
    aqr_index keep = e[h].next;
    aqr_vertex start = m->vertices[u];
    if (!aqr_pm_remove_leaf(m, h))
      return false;
    start.out = AQR_NONE;
    m->vertices[u] = start;
    aqr_index k = keep;
    do
    {
      e[k].from = u;
      k = aqr_pm_next_around(m, k);
    } while (k != keep);
    m->vertices[v].out = AQR_NONE;
    set_out(m, keep);
    return true;
  }
  if (aqr_pm_on_border(m, u) && aqr_pm_on_border(m, v) && e[h].face != AQR_NONE && e[t].face != AQR_NONE)
    return false;
  for (aqr_index k = aqr_pm_next_around(m, t); k != t; k = aqr_pm_next_around(m, k))
    e[k].from = u;
  if (e[h].face != AQR_NONE)
    m->faces[e[h].face] = e[h].next;
  if (e[t].face != AQR_NONE)
    m->faces[e[t].face] = e[t].next;
  aqr_index out = e[h].next; /* starts at v, which is u now */
  unlink_half_edge(m, h);
  unlink_half_edge(m, t);
  m->vertices[v].out = AQR_NONE;
  delete_edge(m, h);
  set_out(m, out);
  return true;
}

/* ---- whole meshes ---- */

typedef struct side
{
  uint64_t key; /* the edge's two vertices, smaller first */
  aqr_index at; /* position in the connectivity */
} side;

static int by_key(const void* a, const void* b)
{
  const side *x = a, *y = b;
  return x->key != y->key ? (x->key < y->key ? -1 : 1) : (x->at > y->at) - (x->at < y->at);
}

/* Pairs the sides of polygons that share an edge: half-edge of every side. The first of a pair is even. False where
 * three sides meet or two run the same way. */
static bool pair_sides(
  const side* sides, size_t n, const aqr_index* from, aqr_index base, aqr_index* half_edge, size_t* edges)
{
  *edges = 0;
  for (size_t i = 0; i < n;)
  {
    size_t j = i + 1;
    while (j < n && sides[j].key == sides[i].key)
      j++;
    if (j - i > 2 || sides[i].key >> 32 == (sides[i].key & UINT32_MAX) ||
        (j - i == 2 && from[sides[i].at] == from[sides[i + 1].at]))
      return false;
    for (size_t k = i; k < j; k++)
      half_edge[sides[k].at] = base + (aqr_index)(2 * *edges + (k - i));
    ++*edges;
    i = j;
  }
  return true;
}

/* Closes the outer half-edges to border loops by turning around their ends. */
static void link_borders(aqr_polygon_mesh* m, size_t first)
{
  aqr_half_edge* e = m->half_edges;
  for (aqr_index o = (aqr_index)first; o < m->n_half_edges; o++)
  {
    if (e[o].face != AQR_NONE)
      continue;
    aqr_index x = e[o ^ 1].prev ^ 1;
    while (e[x].face != AQR_NONE)
      x = e[x].prev ^ 1;
    link_half_edges(m, o, x);
  }
}

aqr_status aqr_pm_append(aqr_context* c, aqr_polygon_mesh* m, const aqr_vertex* vertices, size_t n_vertices,
  const size_t* offsets, size_t n_faces, const aqr_index* connectivity)
{
  aqr_status status = AQR_OK;
  size_t n = offsets[n_faces] - offsets[0], edges = 0;
  const aqr_index* from = connectivity + offsets[0];
  aqr_index base = (aqr_index)m->n_half_edges, first_vertex = (aqr_index)m->n_vertices;
  size_t first_face = m->n_faces;
  side* sides = AQR_NEW(c, side, n);
  aqr_index* half_edge = AQR_NEW(c, aqr_index, n);
  AQR_REQUIRE(sides && half_edge, AQR_OUT_OF_MEMORY);
  AQR_REQUIRE(n < AQR_NONE / 2 - base, AQR_TOO_LARGE);
  for (size_t f = 0; f < n_faces; f++)
    for (size_t i = offsets[f]; i < offsets[f + 1]; i++)
    {
      aqr_index a = connectivity[i], b = connectivity[i + 1 < offsets[f + 1] ? i + 1 : offsets[f]];
      sides[i - offsets[0]] =
        (side){ a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a, (aqr_index)(i - offsets[0]) };
    }
  qsort(sides, n, sizeof *sides, by_key);
  AQR_REQUIRE(pair_sides(sides, n, from, base, half_edge, &edges), AQR_INTERNAL);
  AQR_REQUIRE(AQR_RESERVE(c, m->vertices, m->vertex_capacity, m->n_vertices + n_vertices) &&
                AQR_RESERVE(c, m->half_edges, m->half_edge_capacity, base + 2 * edges) &&
                AQR_RESERVE(c, m->edge_type, m->edge_capacity, base / 2 + edges) &&
                AQR_RESERVE(c, m->faces, m->face_capacity, m->n_faces + n_faces),
    AQR_OUT_OF_MEMORY);
  for (size_t e = 0; e < edges; e++)
    m->half_edges[base + 2 * e + 1] = (aqr_half_edge){ AQR_NONE, AQR_NONE, AQR_NONE, AQR_NONE };
  for (size_t f = 0; f < n_faces; f++)
  {
    for (size_t i = offsets[f]; i < offsets[f + 1]; i++)
    {
      aqr_index h = half_edge[i - offsets[0]];
      m->half_edges[h].from = first_vertex + connectivity[i];
      m->half_edges[h].face = (aqr_index)(first_face + f);
    }
    m->faces[first_face + f] = half_edge[offsets[f] - offsets[0]];
  }
  for (size_t f = 0; f < n_faces; f++)
    for (size_t i = offsets[f]; i < offsets[f + 1]; i++)
    {
      aqr_index h = half_edge[i - offsets[0]],
                k = half_edge[(i + 1 < offsets[f + 1] ? i + 1 : offsets[f]) - offsets[0]];
      link_half_edges(m, h, k);
      if (m->half_edges[h ^ 1].face == AQR_NONE)
        m->half_edges[h ^ 1].from = m->half_edges[k].from;
    }
  memcpy(m->vertices + first_vertex, vertices, n_vertices * sizeof *vertices);
  m->n_vertices += n_vertices;
  m->n_faces += n_faces;
  m->n_half_edges += 2 * edges;
  for (size_t v = first_vertex; v < m->n_vertices; v++)
    m->vertices[v].out = AQR_NONE;
  link_borders(m, base);
  for (aqr_index h = base; h < m->n_half_edges; h++)
  {
    bool outer = m->half_edges[h].face == AQR_NONE;
    if (outer || h % 2 == 0)
      m->edge_type[h >> 1] = outer ? AQR_LINE_BOUNDARY : AQR_LINE_MIN;
    if (outer || m->vertices[m->half_edges[h].from].out == AQR_NONE)
      m->vertices[m->half_edges[h].from].out = h;
  }
done:
  AQR_DROP(c, sides, n);
  AQR_DROP(c, half_edge, n);
  return status;
}

static aqr_index shifted(aqr_index i, size_t by)
{
  return i == AQR_NONE ? AQR_NONE : i + (aqr_index)by;
}

aqr_status aqr_pm_append_mesh(aqr_context* c, aqr_polygon_mesh* m, const aqr_polygon_mesh* added)
{
  size_t nv = m->n_vertices, nh = m->n_half_edges, nf = m->n_faces;
  if (added->n_half_edges >= AQR_NONE - nh)
    return AQR_TOO_LARGE;
  if (!AQR_RESERVE(c, m->vertices, m->vertex_capacity, nv + added->n_vertices) ||
      !AQR_RESERVE(c, m->half_edges, m->half_edge_capacity, nh + added->n_half_edges) ||
      !AQR_RESERVE(c, m->edge_type, m->edge_capacity, (nh + added->n_half_edges) / 2) ||
      !AQR_RESERVE(c, m->faces, m->face_capacity, nf + added->n_faces))
    return AQR_OUT_OF_MEMORY;
  for (size_t v = 0; v < added->n_vertices; v++)
  {
    m->vertices[nv + v] = added->vertices[v];
    m->vertices[nv + v].out = shifted(added->vertices[v].out, nh);
  }
  for (size_t h = 0; h < added->n_half_edges; h++)
  {
    aqr_half_edge e = added->half_edges[h];
    m->half_edges[nh + h] =
      (aqr_half_edge){ shifted(e.next, nh), shifted(e.prev, nh), shifted(e.from, nv), shifted(e.face, nf) };
    m->edge_type[(nh + h) / 2] = added->edge_type[h / 2];
  }
  for (size_t f = 0; f < added->n_faces; f++)
    m->faces[nf + f] = shifted(added->faces[f], nh);
  m->n_vertices += added->n_vertices;
  m->n_half_edges += added->n_half_edges;
  m->n_faces += added->n_faces;
  return AQR_OK;
}

static aqr_index lesser_end(const aqr_polygon_mesh* m, const aqr_index* vertex, size_t edge)
{
  aqr_index a = vertex[m->half_edges[2 * edge].from], b = vertex[m->half_edges[2 * edge + 1].from];
  return a < b ? a : b;
}

static aqr_index renumbered(const aqr_index* rank, aqr_index h)
{
  return 2 * rank[h >> 1] + (h & 1);
}

/* Where each living edge goes: edges come in the order of their lesser ends. first: as many zeros as there are vertices
 * and one more; it holds where the edges of each end. */
static void rank_edges(const aqr_polygon_mesh* m, const aqr_index* vertex, aqr_index* first, aqr_index* rank)
{
  for (size_t e = 0; 2 * e < m->n_half_edges; e++)
    if (aqr_pm_edge_lives(m, (aqr_index)(2 * e)))
      first[lesser_end(m, vertex, e) + 1]++;
  for (size_t v = 0; v < m->n_vertices; v++)
    first[v + 1] += first[v];
  for (size_t e = 0; 2 * e < m->n_half_edges; e++)
    if (aqr_pm_edge_lives(m, (aqr_index)(2 * e)))
      rank[e] = first[lesser_end(m, vertex, e)]++;
}

aqr_status aqr_pm_compact(aqr_context* c, aqr_polygon_mesh* m)
{
  aqr_status status = AQR_OK;
  size_t nv = 0, nh = 0, nf = 0, n = m->n_half_edges, n_first = m->n_vertices + 1;
  aqr_index* vertex = AQR_NEW(c, aqr_index, m->n_vertices);
  aqr_index* first = AQR_NEW0(c, aqr_index, n_first);
  aqr_index* rank = AQR_NEW(c, aqr_index, n / 2);
  aqr_index* face = AQR_NEW(c, aqr_index, m->n_faces);
  aqr_half_edge* half_edges = AQR_NEW(c, aqr_half_edge, n);
  uint8_t* edge_type = AQR_NEW(c, uint8_t, n / 2);
  aqr_index* faces = AQR_NEW(c, aqr_index, m->n_faces);
  size_t most_faces = m->n_faces;
  AQR_REQUIRE(vertex && first && rank && face && half_edges && edge_type && faces, AQR_OUT_OF_MEMORY);
  for (size_t v = 0; v < m->n_vertices; v++)
    if (m->vertices[v].out != AQR_NONE)
      vertex[v] = (aqr_index)nv++;
  rank_edges(m, vertex, first, rank);
  for (aqr_index h = 0; h < n; h++)
    if (aqr_pm_edge_lives(m, h))
    {
      const aqr_half_edge* e = &m->half_edges[h];
      half_edges[renumbered(rank, h)] =
        (aqr_half_edge){ renumbered(rank, e->next), renumbered(rank, e->prev), vertex[e->from], e->face };
      edge_type[rank[h >> 1]] = m->edge_type[h >> 1];
      nh++;
    }
  for (size_t v = 0; v < m->n_vertices; v++)
    if (m->vertices[v].out != AQR_NONE)
    {
      m->vertices[vertex[v]] = m->vertices[v];
      m->vertices[vertex[v]].out = renumbered(rank, m->vertices[v].out);
    }
  for (size_t f = 0; f < m->n_faces; f++)
    face[f] = AQR_NONE;
  for (aqr_index h = 0; h < nh; h++)
  {
    aqr_index f = half_edges[h].face;
    if (f == AQR_NONE)
      continue;
    if (face[f] == AQR_NONE)
    {
      faces[nf] = renumbered(rank, m->faces[f]);
      face[f] = (aqr_index)nf++;
    }
    half_edges[h].face = face[f];
  }
done:
  AQR_DROP(c, vertex, m->n_vertices);
  AQR_DROP(c, first, n_first);
  AQR_DROP(c, rank, n / 2);
  AQR_DROP(c, face, m->n_faces);
  if (status == AQR_OK)
  {
    AQR_DROP(c, m->half_edges, m->half_edge_capacity);
    AQR_DROP(c, m->edge_type, m->edge_capacity);
    AQR_DROP(c, m->faces, m->face_capacity);
    m->faces = faces;
    m->face_capacity = most_faces;
    m->half_edges = half_edges;
    m->half_edge_capacity = n;
    m->edge_type = edge_type;
    m->edge_capacity = n / 2;
    m->n_vertices = nv;
    m->n_half_edges = nh;
    m->n_faces = nf;
  }
  else
  {
    AQR_DROP(c, half_edges, n);
    AQR_DROP(c, edge_type, n / 2);
    AQR_DROP(c, faces, most_faces);
  }
  return status;
}

void aqr_polygon_mesh_free(aqr_context* c, aqr_polygon_mesh* m)
{
  AQR_DROP(c, m->vertices, m->vertex_capacity);
  AQR_DROP(c, m->half_edges, m->half_edge_capacity);
  AQR_DROP(c, m->edge_type, m->edge_capacity);
  AQR_DROP(c, m->faces, m->face_capacity);
  memset(m, 0, sizeof *m);
}

/* ---- checks ---- */

/* What threads found, each in its part of the mesh. */
typedef struct check
{
  const aqr_polygon_mesh* m;
  atomic_bool wrong;
  aqr_shared_size living, inside;    /* half-edges, and those that have a face */
  aqr_shared_size in_faces, in_fans; /* half-edges in the cycles that faces and vertices begin */
} check;

/* Whether a living half-edge is linked to its neighbours in its loop. */
static bool links_agree(const aqr_polygon_mesh* m, aqr_index h)
{
  const aqr_half_edge* e = m->half_edges;
  aqr_index n = e[h].next, p = e[h].prev;
  if (e[h].from >= m->n_vertices || m->vertices[e[h].from].out == AQR_NONE || n >= m->n_half_edges ||
      p >= m->n_half_edges || e[n].prev != h || e[p].next != h || e[n].from != e[h ^ 1].from || e[n].face != e[h].face)
    return false;
  if (e[h].face == AQR_NONE) /* a border vertex has one gap in its fan, and begins at it */
    return e[h ^ 1].face != AQR_NONE && m->vertices[e[h].from].out == h;
  return e[h].face < m->n_faces && m->faces[e[h].face] != AQR_NONE;
}

static void check_links(void* data, size_t begin, size_t end)
{
  check* k = data;
  const aqr_half_edge* e = k->m->half_edges;
  size_t living = 0, inside = 0;
  for (aqr_index h = (aqr_index)begin; h < end; h++)
  {
    bool lives = e[h].from != AQR_NONE;
    if (lives != (e[h ^ 1].from != AQR_NONE) || (lives && !links_agree(k->m, h)))
      k->wrong = true;
    living += lives;
    inside += lives && e[h].face != AQR_NONE;
  }
  k->living += living;
  k->inside += inside;
}

static void check_faces(void* data, size_t begin, size_t end)
{
  check* k = data;
  const aqr_polygon_mesh* m = k->m;
  size_t n = 0;
  for (aqr_index f = (aqr_index)begin; f < end; f++)
  {
    aqr_index h = m->faces[f];
    if (h == AQR_NONE)
      continue;
    if (h >= m->n_half_edges || !aqr_pm_edge_lives(m, h) || aqr_pm_face(m, h) != f)
      k->wrong = true;
    else
      n += aqr_pm_face_size(m, f);
  }
  k->in_faces += n;
}

static void check_fans(void* data, size_t begin, size_t end)
{
  check* k = data;
  const aqr_polygon_mesh* m = k->m;
  size_t n = 0;
  for (aqr_index v = (aqr_index)begin; v < end; v++)
  {
    aqr_index h = m->vertices[v].out;
    if (h == AQR_NONE)
      continue;
    if (h >= m->n_half_edges || aqr_pm_from(m, h) != v)
      k->wrong = true;
    else
      n += aqr_pm_valence(m, v);
  }
  k->in_fans += n;
}

/* No loop at a vertex, and no two edges to the same other. */
static bool is_fan_regular(const aqr_polygon_mesh* m, aqr_index v)
{
  aqr_index first = m->vertices[v].out, h = first;
  do
  {
    if (aqr_pm_to(m, h) == v)
      return false;
    for (aqr_index k = aqr_pm_next_around(m, h); k != first; k = aqr_pm_next_around(m, k))
      if (aqr_pm_to(m, k) == aqr_pm_to(m, h))
        return false;
    h = aqr_pm_next_around(m, h);
  } while (h != first);
  return true;
}

static void check_fans_regular(void* data, size_t begin, size_t end)
{
  check* k = data;
  for (aqr_index v = (aqr_index)begin; v < end; v++)
    if (k->m->vertices[v].out != AQR_NONE && !is_fan_regular(k->m, v))
      k->wrong = true;
}

static bool is_face_regular(const aqr_polygon_mesh* m, aqr_index f)
{
  aqr_index h = m->faces[f];
  if (aqr_pm_next(m, aqr_pm_next(m, h)) == h)
    return false;
  do
  {
    for (aqr_index k = aqr_pm_next(m, h); k != m->faces[f]; k = aqr_pm_next(m, k))
      if (aqr_pm_from(m, k) == aqr_pm_from(m, h))
        return false;
    h = aqr_pm_next(m, h);
  } while (h != m->faces[f]);
  return aqr_pm_duplicate(m, f) == AQR_NONE;
}

static void check_faces_regular(void* data, size_t begin, size_t end)
{
  check* k = data;
  for (aqr_index f = (aqr_index)begin; f < end; f++)
    if (k->m->faces[f] != AQR_NONE && !is_face_regular(k->m, f))
      k->wrong = true;
}

/* On the threads of the context, on this one where there is none. */
static aqr_status run_check(aqr_context* c, check* k, size_t n, void (*body)(void*, size_t, size_t))
{
  aqr_status status = AQR_OK;
  if (c)
    status = aqr_parallel(c, n, body, k, 0, 0);
  else
    body(k, 0, n);
  return status == AQR_OK && k->wrong ? AQR_INTERNAL : status;
}

static aqr_status check_consistent(aqr_context* c, const aqr_polygon_mesh* m)
{
  check k = { .m = m };
  aqr_status status = m->n_half_edges % 2 ? AQR_INTERNAL : AQR_OK;
  AQR_TRY(status);
  AQR_TRY(run_check(c, &k, m->n_half_edges, check_links));
  /* Loops and fans are cycles now. If the faces' cycles hold as many half-edges as have faces, then each face is one
   * cycle; likewise fans. */
  AQR_TRY(run_check(c, &k, m->n_faces, check_faces));
  AQR_TRY(run_check(c, &k, m->n_vertices, check_fans));
  AQR_REQUIRE(k.in_faces == k.inside && k.in_fans == k.living, AQR_INTERNAL);
done:
  return status;
}

static aqr_status check_regular(aqr_context* c, const aqr_polygon_mesh* m)
{
  check k = { .m = m };
  aqr_status status = AQR_OK;
  AQR_TRY(run_check(c, &k, m->n_vertices, check_fans_regular));
  AQR_TRY(run_check(c, &k, m->n_faces, check_faces_regular));
done:
  return status;
}

bool aqr_pm_is_consistent(const aqr_polygon_mesh* m)
{
  return check_consistent(NULL, m) == AQR_OK;
}

bool aqr_pm_is_regular(const aqr_polygon_mesh* m)
{
  return check_regular(NULL, m) == AQR_OK;
}

aqr_status aqr_pm_verify(aqr_context* c, const aqr_polygon_mesh* m, bool regular)
{
  aqr_status status = check_consistent(c, m);
  return status == AQR_OK && regular ? check_regular(c, m) : status;
}

long aqr_pm_euler(const aqr_polygon_mesh* m)
{
  long x = 0;
  for (size_t v = 0; v < m->n_vertices; v++)
    x += m->vertices[v].out != AQR_NONE;
  for (size_t h = 0; h < m->n_half_edges; h += 2)
    x -= m->half_edges[h].from != AQR_NONE;
  for (size_t f = 0; f < m->n_faces; f++)
    x += m->faces[f] != AQR_NONE;
  return x;
}
