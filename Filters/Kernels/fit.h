/* SPDX-License-Identifier: BSD-3-Clause */
/* Moves the vertices of the mesh to where the surface that they stand for is met on average. */
#ifndef AQR_FIT_H
#define AQR_FIT_H

#include "polygon_mesh.h"
#include "surface.h"

/* Inner vertices are put on the surface near their place, then moved so that the polygons
 * have the least mean squared distance from the surface; edges turn little. Vertices on chains stay. m is compact.
 * normals: of the surface, 3 per point, to give the vertices new ones; or NULL. */
aqr_status aqr_fit(aqr_context* c, const aqr_surface* s, const double* normals, aqr_polygon_mesh* m);

#endif
