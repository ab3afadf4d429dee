/* SPDX-License-Identifier: BSD-3-Clause */
/* Triangles that fill a polygon of the plane: ears are cut off one by one (Meisters 1975), then diagonals turned until
 * all of them are Delaunay's (Lawson 1977). */
#ifndef AQR_TRIANGULATION_H
#define AQR_TRIANGULATION_H

#include "context.h"

/* Corners anticlockwise. Several may lie at one place, as where a bridge to a hole is walked along in both directions:
 * they have one name. */
typedef struct aqr_outline
{
  size_t n;              /* at least 3 */
  const double* xy;      /* 2 * n */
  const aqr_index* name; /* n */
} aqr_outline;

typedef struct aqr_triangle
{
  aqr_index corner[3]; /* of the outline */
  aqr_index beside[3]; /* triangle over the side from corner i to corner i + 1; AQR_NONE: a side of the outline */
} aqr_triangle;

/* Fills n - 2 triangles. Where the outline crosses itself they are such that every corner has some, no more. Progress
 * stays at `at`. AQR_CANCELLED, AQR_OUT_OF_MEMORY. */
aqr_status aqr_triangulate(aqr_context* c, const aqr_outline* outline, double at, aqr_triangle* triangles);

#endif
