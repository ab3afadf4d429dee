/* SPDX-License-Identifier: BSD-3-Clause */
/* Components of the surface that are too small to carry lines keep their triangles, in smaller number. */
#ifndef AQR_COARSEN_H
#define AQR_COARSEN_H

#include "field.h"
#include "polygon_mesh.h"

/* Adds the faces listed (a component, or what seams cut off from one) to m as triangles on about `points` vertices,
 * contracted in order of the error made (Garland and Heckbert 1997). Fewer than `points` vertices pass as they are, and
 * where the topology needs more, more stay. Seams inside are feature edges. */
aqr_status aqr_coarsen_component(aqr_context* c, const aqr_surface* s, const aqr_field* field, const aqr_index* faces,
  size_t n_faces, size_t points, aqr_polygon_mesh* m);

#endif
