/* SPDX-License-Identifier: BSD-3-Clause */
/* From the regions between the lines to the faces of the mesh (paper 5.2). */
#ifndef AQR_FACES_H
#define AQR_FACES_H

#include "tips.h"

typedef struct aqr_faces_options
{
  bool convex_partition;      /* split concave faces */
  int largest_valence;        /* split faces with more corners; at least 4 */
  const aqr_tips* tips;       /* what lies far out of the faces, or NULL */
  const aqr_surface* surface; /* whose peaks are raised, or NULL */
  const double* normals;      /* 3 per point of it */
} aqr_faces_options;

/* Dangling edges go, near intersections merge, T-joints that face each other join, faces are made convex and split to
 * quads. Whatever cell decomposition came in, a regular mesh of the same topology goes out, compacted. */
aqr_status aqr_faces_finish(aqr_context* c, aqr_polygon_mesh* m, const aqr_faces_options* options);

#endif
