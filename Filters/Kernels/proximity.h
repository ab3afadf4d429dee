/* SPDX-License-Identifier: BSD-3-Clause */
/* Proximity queries by p-cells (paper 3.2): the faces connected to a point's own over edges that come
 * within a radius of it, and the segments listed in them. Distances are measured inside the p-cell
 * only, never through space to another sheet. */
#ifndef AQR_PROXIMITY_H
#define AQR_PROXIMITY_H

#include "lines.h"

/* A face of the cell and the half-edge of it that the cell came in over. */
typedef struct aqr_entry
{
  aqr_index h;
  uint8_t from_inside, to_inside; /* whether the ends of h lie inside the radius */
} aqr_entry;

typedef struct aqr_pcell
{
  const aqr_surface* surface;
  uint32_t* stamp; /* per face: the query that took it in */
  uint32_t query;
  aqr_entry* entries; /* nearest the point's face first in edges crossed */
  size_t n_entries, capacity;
  size_t queries;
} aqr_pcell;

aqr_status aqr_pcell_init(aqr_context* c, const aqr_surface* s, aqr_pcell* cell);
void aqr_pcell_free(aqr_context* c, aqr_pcell* cell);

/* What a query finds: of the segments nearer than the radius that run within half a right angle of a direction, or of
 * its opposite, the nearest. */
typedef struct aqr_near
{
  aqr_index line, sample; /* AQR_NONE: nothing found */
  double distance;
} aqr_near;

typedef struct aqr_probe
{
  aqr_index face; /* where p lies */
  vec3 p, direction;
  double radius;
  bool any;       /* the first segment found inside the radius will do */
  aqr_index self; /* segments of this line count only where the line has come back: seen from `arc`, farther along the
                     line than across the surface */
  double arc;
} aqr_probe;

/* The nearest segment of the direction's family (angle below pi/4; paper 4.2) within the radius. */
aqr_status aqr_pcell_nearest(
  aqr_context* c, aqr_pcell* cell, const aqr_lines* lines, const aqr_probe* probe, aqr_near* found);

#endif
