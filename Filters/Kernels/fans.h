/* SPDX-License-Identifier: BSD-3-Clause */
/* Polygons as fans of triangles. */
#ifndef AQR_FANS_H
#define AQR_FANS_H

#include "polygon_mesh.h"

/* Lets face f, of four or more corners, begin at the one whose fan of triangles stands for it best: that of the shorter
 * diagonal of a quad, else the one whose smallest triangle is largest, seen along the normal of the polygon. From
 * another one the fan of a concave polygon folds over, and many programs draw no other. */
void aqr_fan_start(aqr_polygon_mesh* m, aqr_index f);

#endif
