/* SPDX-License-Identifier: BSD-3-Clause */
/* Triangles whose corners lie on one line, as between vertices of a straight crease or peaks in a row: faces without
 * area. */
#ifndef AQR_THIN_TRIANGLES_H
#define AQR_THIN_TRIANGLES_H

#include "polygon_mesh.h"

/* Each becomes part of the face across its longest side, unless that side is one of a chain, or the face there then has
 * a vertex twice, more than `largest_valence` corners, or a concave one that it had not. AQR_CANCELLED. */
aqr_status aqr_open_thin_triangles(aqr_context* c, aqr_polygon_mesh* m, int largest_valence);

#endif
