/* SPDX-License-Identifier: BSD-3-Clause */
/* Arcs through the regions to be cut: the shortest from network to network that do not merely cut off a disk. */
#ifndef AQR_ARCS_H
#define AQR_ARCS_H

#include "region_cells.h"

/* Adds to `lines` arcs over the shortest links, as many as the regions need and as find room beside each other.
 * *added tells how many. */
aqr_status aqr_arcs_draw(aqr_context* c, aqr_region_cells* g, aqr_lines* lines, size_t* added);

#endif
