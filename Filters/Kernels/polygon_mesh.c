/* SPDX-License-Identifier: BSD-3-Clause */
#include "polygon_mesh.h"

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

vec3 aqr_pm_area(const aqr_polygon_mesh* m, aqr_index f)
{
  vec3 p = aqr_pm_point(m, aqr_pm_from(m, m->faces[f])), sum = v3(0, 0, 0);
  for (aqr_index h = aqr_pm_next(m, m->faces[f]); h != m->faces[f]; h = aqr_pm_next(m, h))
  {
    vec3 a = aqr_pm_point(m, aqr_pm_from(m, h)), b = aqr_pm_point(m, aqr_pm_to(m, h));
    sum = v3_add(sum, v3_cross(v3_sub(a, p), v3_sub(b, p)));
  }
  return sum;
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

bool aqr_pm_may_meet_itself(const aqr_polygon_mesh* m, aqr_index f, size_t most)
{
  aqr_index first = m->faces[f], h = first;
  size_t n = 0;
  do
  {
    for (aqr_index g = first; g != h; g = aqr_pm_next(m, g))
      if (aqr_pm_from(m, g) == aqr_pm_from(m, h))
        return true;
    h = aqr_pm_next(m, h);
    n++;
  } while (h != first && n < most);
  return h != first;
}

bool aqr_pm_face_has(const aqr_polygon_mesh* m, aqr_index f, aqr_index v)
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
    if (!aqr_pm_face_has(m, g, aqr_pm_from(m, h)))
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
    aqr_pm_link(m, g, g ^ 1);
  else
  {
    aqr_pm_link(m, g, next);
    aqr_pm_link(m, prev, g ^ 1);
  }
  aqr_pm_link(m, h, g);
  aqr_pm_link(m, g ^ 1, t);
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
  aqr_pm_link(m, p1, g);
  aqr_pm_link(m, g, h0);
  aqr_pm_link(m, p0, g ^ 1);
  aqr_pm_link(m, g ^ 1, h1);
  m->faces[f] = h0;
  m->faces[added] = h1;
  for (aqr_index k = h1; k != (g ^ 1); k = e[k].next)
    e[k].face = added;
  return AQR_OK;
}

/* Cuts h out of its loop. */
static void unlink_half_edge(aqr_polygon_mesh* m, aqr_index h)
{
  aqr_pm_link(m, aqr_pm_prev(m, h), aqr_pm_next(m, h));
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
    aqr_pm_link(m, h_prev, t_next);
    aqr_pm_link(m, t_prev, h_next);
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
  aqr_pm_link(m, e[t].prev, out);
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
    aqr_pm_link(m, p, g);
  else
  {
    aqr_pm_link(m, p, e[h].next);
    aqr_pm_link(m, e[t].prev, g);
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
