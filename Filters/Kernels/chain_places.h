/* SPDX-License-Identifier: BSD-3-Clause */
/* Places for vertices that were inserted into edges of borders and creases. */
#ifndef AQR_CHAIN_PLACES_H
#define AQR_CHAIN_PLACES_H

#include "polygon_mesh.h"
#include "surface.h"

/* Spreads runs of vertices without a place (all weights 0) evenly along the surface's border or crease between the
 * placed vertices on either side, so that a hole with a single placed vertex opens to a triangle. */
aqr_status aqr_place_on_chains(aqr_context* c, const aqr_surface* s, aqr_polygon_mesh* m);

#endif
