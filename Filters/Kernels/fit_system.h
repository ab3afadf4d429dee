/* SPDX-License-Identifier: BSD-3-Clause */
/* The moves of the vertices for which the polygons, seen as planes at samples of them, come nearest to the surface: a
 * sparse system of normal equations. */
#ifndef AQR_FIT_SYSTEM_H
#define AQR_FIT_SYSTEM_H

#include "polygon_mesh.h"
#include "surface.h"

#include <stdatomic.h>

enum
{
  AQR_FIT_SAMPLES = 6
};

/* Quadrature of degree four over a triangle (Dunavant 1985): squared distances from a quadratic surface are exact. */
extern const double aqr_fit_place[AQR_FIT_SAMPLES][3]; /* barycentric */
extern const double aqr_fit_weight[AQR_FIT_SAMPLES];

/* A place in a triangle and the tangent plane of the surface below it, both scaled by the root of the area it stands
 * for. */
typedef struct aqr_fit_sample
{
  float normal[3], distance;
  aqr_index face; /* where the next round looks first */
} aqr_fit_sample;

/* A triangle of a polygon. */
typedef struct aqr_fit_triangle
{
  aqr_index v[3];
  aqr_fit_sample at[AQR_FIT_SAMPLES];
  float area;
} aqr_fit_triangle;

/* What a vertex has to do with a neighbour: a block of the matrix, xx yy zz xy xz yz. */
typedef struct aqr_fit_link
{
  aqr_index to; /* AQR_NONE: no further neighbours */
  float block[6];
} aqr_fit_link;

/* What threads write to without waiting for each other. */
typedef _Atomic(uint8_t) aqr_fit_flag;

typedef struct aqr_fitter
{
  const aqr_surface* s;
  const double* normals; /* of the surface, 3 per point, or NULL */
  aqr_polygon_mesh* m;
  size_t n_triangles;
  size_t* first; /* per face: its first triangle; n_faces + 1 */
  aqr_fit_triangle* triangles;
  size_t* first_corner; /* per vertex, into `corners`; n_vertices + 2 */
  aqr_index* corners;   /* 3 * triangle + corner */
  aqr_fit_link* links;  /* per vertex: one more than its corners, as a fan has at most so many neighbours */
  vec3 *move, *residual, *direction;
  vec3* image;         /* of the direction; after the solver, where the vertices were before their move */
  vec3* across;        /* per edge: unit, along the surface and across the edge as it was before the first move */
  double* share;       /* per vertex: of the error, by area, so that it is held as firmly where few samples are used */
  double* block;       /* per vertex: its own block of the matrix, as in link */
  double* inverse;     /* of it; 0 where the vertex stays */
  double* product;     /* per vertex: its term of the sum that the solver takes next */
  uint8_t* back;       /* per vertex: the last move was damped */
  aqr_fit_flag* folds; /* per vertex: at a corner that folds */
  aqr_fit_flag folded; /* any does */
  double hold;         /* along the surface */
  double step;         /* of the solver along the direction, or how much of the last direction the next one keeps */
  double keep;         /* of moves that fold */
} aqr_fitter;

/* Notes how the edges run. */
aqr_status aqr_fit_note_edges(aqr_context* c, aqr_fitter* f, double at);

/* Fills `move` from the samples' planes and distances, what holds the vertices and edges, and `hold`. */
aqr_status aqr_fit_solve(aqr_context* c, aqr_fitter* f, double at);

#endif
