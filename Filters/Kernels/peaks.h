/* SPDX-License-Identifier: BSD-3-Clause */
/* Points of cones: no line ends there, and lines around them stop where their spacing does. */
#ifndef AQR_PEAKS_H
#define AQR_PEAKS_H

#include "polygon_mesh.h"
#include "surface.h"

/* Inner points of the surface whose angles add up to less than 270 degrees become corners of the mesh where they stand
 * out of it: the nearest vertex moves there or, where none is near, the face below becomes triangles around one.
 * normals: 3 per point of s. The mesh stays as regular as it is. */
aqr_status aqr_peaks_raise(aqr_context* c, const aqr_surface* s, const double* normals, aqr_polygon_mesh* m);

#endif
