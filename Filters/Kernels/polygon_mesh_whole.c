/* SPDX-License-Identifier: BSD-3-Clause */
/* Polygon meshes as a whole: made of lists of polygons, put together, compacted. */
#include "polygon_mesh.h"
#include "sort.h"

#include <string.h>

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
    aqr_pm_link(m, o, x);
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
  AQR_REQUIRE(n < (AQR_NONE - base) / 2, AQR_TOO_LARGE);
  for (size_t f = 0; f < n_faces; f++)
  {
    AQR_REQUIRE(aqr_worked(c, 8), AQR_CANCELLED);
    for (size_t i = offsets[f]; i < offsets[f + 1]; i++)
    {
      aqr_index a = connectivity[i], b = connectivity[i + 1 < offsets[f + 1] ? i + 1 : offsets[f]];
      sides[i - offsets[0]] =
        (side){ a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a, (aqr_index)(i - offsets[0]) };
    }
  }
  AQR_TRY(aqr_sort(c, sides, n, sizeof *sides, by_key));
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
    AQR_REQUIRE(aqr_worked(c, 8), AQR_CANCELLED);
    for (size_t i = offsets[f]; i < offsets[f + 1]; i++)
    {
      aqr_index h = half_edge[i - offsets[0]];
      m->half_edges[h].from = first_vertex + connectivity[i];
      m->half_edges[h].face = (aqr_index)(first_face + f);
    }
    m->faces[first_face + f] = half_edge[offsets[f] - offsets[0]];
  }
  for (size_t f = 0; f < n_faces; f++)
  {
    AQR_REQUIRE(aqr_worked(c, 8), AQR_CANCELLED);
    for (size_t i = offsets[f]; i < offsets[f + 1]; i++)
    {
      aqr_index h = half_edge[i - offsets[0]],
                k = half_edge[(i + 1 < offsets[f + 1] ? i + 1 : offsets[f]) - offsets[0]];
      aqr_pm_link(m, h, k);
      if (m->half_edges[h ^ 1].face == AQR_NONE)
        m->half_edges[h ^ 1].from = m->half_edges[k].from;
    }
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
static aqr_status rank_edges(
  aqr_context* c, const aqr_polygon_mesh* m, const aqr_index* vertex, aqr_index* first, aqr_index* rank)
{
  for (size_t e = 0; 2 * e < m->n_half_edges; e++)
  {
    if (!aqr_worked(c, 1))
      return AQR_CANCELLED;
    if (aqr_pm_edge_lives(m, (aqr_index)(2 * e)))
      first[lesser_end(m, vertex, e) + 1]++;
  }
  for (size_t v = 0; v < m->n_vertices; v++)
    first[v + 1] += first[v];
  for (size_t e = 0; 2 * e < m->n_half_edges; e++)
  {
    if (!aqr_worked(c, 1))
      return AQR_CANCELLED;
    if (aqr_pm_edge_lives(m, (aqr_index)(2 * e)))
      rank[e] = first[lesser_end(m, vertex, e)]++;
  }
  return AQR_OK;
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
  AQR_TRY(rank_edges(c, m, vertex, first, rank));
  for (aqr_index h = 0; h < n; h++)
  {
    AQR_REQUIRE(aqr_worked(c, 1), AQR_CANCELLED);
    if (aqr_pm_edge_lives(m, h))
    {
      const aqr_half_edge* e = &m->half_edges[h];
      half_edges[renumbered(rank, h)] =
        (aqr_half_edge){ renumbered(rank, e->next), renumbered(rank, e->prev), vertex[e->from], e->face };
      edge_type[rank[h >> 1]] = m->edge_type[h >> 1];
      nh++;
    }
  }
  for (size_t f = 0; f < m->n_faces; f++)
    face[f] = AQR_NONE;
  for (aqr_index h = 0; h < nh; h++)
  {
    AQR_REQUIRE(aqr_worked(c, 1), AQR_CANCELLED);
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
  /* in place, and therefore last: a cancel leaves the mesh as it was */
  for (size_t v = 0; v < m->n_vertices; v++)
    if (m->vertices[v].out != AQR_NONE)
    {
      m->vertices[vertex[v]] = m->vertices[v];
      m->vertices[vertex[v]].out = renumbered(rank, m->vertices[v].out);
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
    if (!AQR_TRIM(c, m->vertices, m->vertex_capacity, nv) || !AQR_TRIM(c, m->half_edges, m->half_edge_capacity, nh) ||
        !AQR_TRIM(c, m->edge_type, m->edge_capacity, nh / 2) || !AQR_TRIM(c, m->faces, m->face_capacity, nf))
      status = AQR_OUT_OF_MEMORY;
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
