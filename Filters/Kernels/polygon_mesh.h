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
  vec3 position,
    normal; /* in the scaled surface's coordinates; unit normal of the input surface there */
  aqr_place place;
  double size; /* local target spacing: the smaller of the two line spacings */
  aqr_index
    out; /* an outgoing half-edge (on a border: the one with face AQR_NONE); AQR_NONE: deleted */
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

#endif
