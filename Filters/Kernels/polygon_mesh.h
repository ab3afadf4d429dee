/* SPDX-License-Identifier: BSD-3-Clause */
/* Half-edge polygon mesh that is a cell decomposition of the input surface. Every operation is an
 * Euler operator: whatever is called in whatever order, the surface's topology stays that of the
 * input.
 *
 * Half-edges come in pairs: the twin of h is h ^ 1, the edge is h >> 1. On a boundary one of the
 * two has face AQR_NONE and runs along the border loop. */
#ifndef AQR_POLYGON_MESH_H
#define AQR_POLYGON_MESH_H

#include "context.h"
#include "vector.h"

/* A place on the working surface. */
typedef struct aqr_place
{
  aqr_index face;
  double bary[3]; /* >= 0, sum 1 */
} aqr_place;

enum aqr_vertex_kind
{
  AQR_VERTEX_INTERIOR = 0,
  AQR_VERTEX_BOUNDARY = 1, /* inside a boundary chain: may slide along it only */
  AQR_VERTEX_FEATURE = 2,  /* inside a feature chain: may slide along it only */
  AQR_VERTEX_CORNER = 3    /* stays where it is */
};

typedef struct aqr_vertex
{
  vec3 position, normal; /* in the scaled surface's coordinates; unit normal of the input surface there */
  aqr_place place;
  double size;   /* local target spacing: the smaller of the two line spacings */
  aqr_index out; /* an outgoing half-edge (on a border: the one with face AQR_NONE); AQR_NONE: deleted */
  uint8_t kind;
} aqr_vertex;

typedef struct aqr_half_edge
{
  aqr_index next, prev, from;
  aqr_index face; /* AQR_NONE on the outer side of a boundary */
} aqr_half_edge;

typedef struct aqr_polygon_mesh
{
  aqr_vertex* vertices;
  size_t n_vertices, vertex_capacity;
  aqr_half_edge* half_edges; /* from == AQR_NONE: deleted */
  size_t n_half_edges, half_edge_capacity;
  uint8_t* edge_type; /* per edge (h >> 1): aqr_line_type of the line it lies on */
  size_t edge_capacity;
  aqr_index* faces; /* a half-edge of each face; AQR_NONE: deleted */
  size_t n_faces, face_capacity;
} aqr_polygon_mesh;

static inline aqr_index aqr_pm_next(const aqr_polygon_mesh* m, aqr_index h)
{
  return m->half_edges[h].next;
}
static inline aqr_index aqr_pm_prev(const aqr_polygon_mesh* m, aqr_index h)
{
  return m->half_edges[h].prev;
}
static inline aqr_index aqr_pm_from(const aqr_polygon_mesh* m, aqr_index h)
{
  return m->half_edges[h].from;
}
static inline aqr_index aqr_pm_to(const aqr_polygon_mesh* m, aqr_index h)
{
  return m->half_edges[h ^ 1].from;
}
static inline aqr_index aqr_pm_face(const aqr_polygon_mesh* m, aqr_index h)
{
  return m->half_edges[h].face;
}
/* The next outgoing half-edge counter-clockwise around the start of h. A cycle on borders too. */
static inline aqr_index aqr_pm_next_around(const aqr_polygon_mesh* m, aqr_index h)
{
  return m->half_edges[h].prev ^ 1;
}
static inline vec3 aqr_pm_point(const aqr_polygon_mesh* m, aqr_index v)
{
  return m->vertices[v].position;
}
static inline bool aqr_pm_edge_lives(const aqr_polygon_mesh* m, aqr_index h)
{
  return m->half_edges[h].from != AQR_NONE;
}
/* Edges of chains are neither removed nor moved off their curve. */
static inline bool aqr_pm_on_chain(const aqr_polygon_mesh* m, aqr_index h)
{
  return m->edge_type[h >> 1] >= AQR_LINE_BOUNDARY;
}
static inline bool aqr_pm_on_border(const aqr_polygon_mesh* m, aqr_index v)
{
  return m->half_edges[m->vertices[v].out].face == AQR_NONE;
}

/* Makes b the half-edge after a in its loop. */
static inline void aqr_pm_link(aqr_polygon_mesh* m, aqr_index a, aqr_index b)
{
  m->half_edges[a].next = b;
  m->half_edges[b].prev = a;
}

/* Four corners, all different half-edges. */
static inline bool aqr_pm_is_quad(const aqr_polygon_mesh* m, aqr_index f)
{
  aqr_index h = m->faces[f];
  return aqr_pm_next(m, aqr_pm_next(m, h)) == aqr_pm_prev(m, aqr_pm_prev(m, h)) &&
         aqr_pm_next(m, aqr_pm_next(m, h)) != h && aqr_pm_next(m, aqr_pm_next(m, aqr_pm_next(m, h))) != h;
}

size_t aqr_pm_valence(const aqr_polygon_mesh* m, aqr_index v);
size_t aqr_pm_face_size(const aqr_polygon_mesh* m, aqr_index f);
/* Twice the vector area of a face: along its normal. */
vec3 aqr_pm_area(const aqr_polygon_mesh* m, aqr_index f);
/* The half-edge from u to v, AQR_NONE where there is none. */
aqr_index aqr_pm_find(const aqr_polygon_mesh* m, aqr_index u, aqr_index v);
/* Whether a face has a vertex twice, or more corners than `most`, which are not all compared then. */
bool aqr_pm_may_meet_itself(const aqr_polygon_mesh* m, aqr_index f, size_t most);
/* Whether v is a corner of face f. */
bool aqr_pm_face_has(const aqr_polygon_mesh* m, aqr_index f, aqr_index v);
/* Whether faces f and g have the same set of vertices. */
bool aqr_pm_same_vertices(const aqr_polygon_mesh* m, aqr_index f, aqr_index g);
/* Another face with the same vertices as f; AQR_NONE where there is none. */
aqr_index aqr_pm_duplicate(const aqr_polygon_mesh* m, aqr_index f);

/* ---- Euler operators: on success the cells change, the surface does not ---- */

/* Inserts a vertex into the edge of h, which then ends at it; the rest of the edge is next(h). */
aqr_status aqr_pm_split_edge(
  aqr_context* c, aqr_polygon_mesh* m, aqr_index h, const aqr_vertex* vertex, aqr_index* inserted);
/* New edge between the corners at the starts of h0 and h1, two different half-edges of a face. h0 keeps its face. The
 * new half-edge before h0 is prev(h0), the one before h1 is prev(h1). */
aqr_status aqr_pm_split_face(aqr_context* c, aqr_polygon_mesh* m, aqr_index h0, aqr_index h1, uint8_t type);
/* Merges the two different faces beside an edge. The face of h stays. */
bool aqr_pm_remove_edge(aqr_polygon_mesh* m, aqr_index h);
/* Deletes the start of h, a vertex of valence one, with its edge. */
bool aqr_pm_remove_leaf(aqr_polygon_mesh* m, aqr_index h);
/* Deletes a vertex of valence two, its two edges become one. */
bool aqr_pm_join_edges(aqr_polygon_mesh* m, aqr_index v);
/* Moves all edges of the end of h to its start. Refuses loops, and inner edges between two points of the border. */
bool aqr_pm_contract(aqr_polygon_mesh* m, aqr_index h);

/* ---- whole meshes ---- */

/* Appends vertices and polygons; connectivity counts from the first of the new vertices. The polygons must be a
 * manifold, consistently oriented surface, else AQR_INTERNAL and *m as it was. Edges get type MIN, on borders BOUNDARY.
 */
aqr_status aqr_pm_append(aqr_context* c, aqr_polygon_mesh* m, const aqr_vertex* vertices, size_t n_vertices,
  const size_t* offsets, size_t n_faces, const aqr_index* connectivity);
/* Appends another mesh with all that is known about it. */
aqr_status aqr_pm_append_mesh(aqr_context* c, aqr_polygon_mesh* m, const aqr_polygon_mesh* added);
/* Forgets what was deleted. Vertices keep their order, edges and faces come in that of their vertices: what lies
 * together on the surface then lies together in memory, which lines, led all over it, do not. */
aqr_status aqr_pm_compact(aqr_context* c, aqr_polygon_mesh* m);
void aqr_polygon_mesh_free(aqr_context* c, aqr_polygon_mesh* m);

/* Whether every link agrees with every other: a cell decomposition of a surface, maybe with loops and digons. */
bool aqr_pm_is_consistent(const aqr_polygon_mesh* m);
/* Whether it is an ordinary mesh besides: no loops, no two edges between the same vertices, no vertex twice in a face,
 * no two faces with the same vertices. */
bool aqr_pm_is_regular(const aqr_polygon_mesh* m);
/* The same on all threads: AQR_INTERNAL where it is not consistent, or not regular though it is to be. */
aqr_status aqr_pm_verify(aqr_context* c, const aqr_polygon_mesh* m, bool regular);
/* Vertices - edges + faces. */
long long aqr_pm_euler(const aqr_polygon_mesh* m);

#endif
