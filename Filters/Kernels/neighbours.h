/* SPDX-License-Identifier: BSD-3-Clause */
/* The points around every point, in counter-clockwise order. Never across borders or seams. */
#ifndef AQR_NEIGHBOURS_H
#define AQR_NEIGHBOURS_H

#include "surface.h"

typedef struct aqr_neighbours
{
  size_t n_points;
  aqr_index* first; /* n_points + 1: where each point's begin in `point` */
  aqr_index* point;
} aqr_neighbours;

aqr_status aqr_neighbours_build(aqr_context* c, const aqr_surface* s, aqr_neighbours* around);
void aqr_neighbours_free(aqr_context* c, aqr_neighbours* around);

#endif
