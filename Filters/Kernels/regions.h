/* SPDX-License-Identifier: BSD-3-Clause */
/* The regions that the network cuts the surface into, and what keeps each of them a disk.
 *
 * The faces of the input, cut by the chords in them, are cells; cells that meet over a stretch of an edge belong to one
 * region. A region is an open disk exactly when its cells minus its stretches plus its vertices number one. */
#ifndef AQR_REGIONS_H
#define AQR_REGIONS_H

#include "network.h"

/* Adds to `lines` an arc through every region that is not a disk for each arc it takes to make it one, ends on the
 * region's border. *added tells how many; 0: every region is a disk, or bears no line at all. is_bare (one per face): 1
 * where the region has no line on its border, that is, a whole component that carries none. suspect (one per face):
 * which faces to look at, all of them in the first round; afterwards those of the regions that arcs were drawn through,
 * the only ones that a next round needs. */
aqr_status aqr_regions_cut(aqr_context* c, const aqr_surface* s, const aqr_chains* chains, const aqr_network* net,
  aqr_lines* lines, uint8_t* is_bare, uint8_t* suspect, bool cut, size_t* added);

#endif
