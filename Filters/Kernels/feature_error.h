/* SPDX-License-Identifier: BSD-3-Clause */
/* How far the edges of the mesh are from the creases, locked edges and borders that they stand for. */
#ifndef AQR_FEATURE_ERROR_H
#define AQR_FEATURE_ERROR_H

#include "feature_graph.h"
#include "polygon_mesh.h"

typedef struct aqr_distance
{
  double rms, largest; /* scaled units; 0 where there is nothing to measure */
} aqr_distance;

/* Distances of points of the chains, spread by length over the surface's edges on them, from the nearest edge of the
 * mesh. */
aqr_status aqr_feature_error(aqr_context* c, const aqr_surface* s, const aqr_chains* chains, const aqr_polygon_mesh* m,
  aqr_distance* features, aqr_distance* boundary);

#endif
