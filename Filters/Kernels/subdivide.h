/* SPDX-License-Identifier: BSD-3-Clause */
/* Pure quads: every face is cut by its centre and the middles of its edges, as one step of Catmull and Clark (1978)
 * does. What is not a quad leaves one vertex that has not four edges, and no face. */
#ifndef AQR_SUBDIVIDE_H
#define AQR_SUBDIVIDE_H

#include "polygon_mesh.h"
#include "surface.h"

enum
{
  AQR_QUADS_PER_FACE = 4 /* of quads: a mesh gets as many times its points and faces */
};

/* m: without deleted parts. A face of n corners becomes n quads; a regular mesh stays regular. New vertices lie
 * on the surface below the middles and centres; those on chains are placed by the fit. */
aqr_status aqr_subdivide(aqr_context* c, const aqr_surface* s, aqr_polygon_mesh* m);

#endif
