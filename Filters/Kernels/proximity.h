/* SPDX-License-Identifier: BSD-3-Clause */
/* Proximity queries by p-cells (paper 3.2): the faces connected to a point's own over edges that come
 * within a radius of it, and the segments listed in them. Distances are measured inside the p-cell
 * only, never through space to another sheet. */
#ifndef AQR_PROXIMITY_H
#define AQR_PROXIMITY_H

#include "face_map.h"
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
  aqr_face_map inside; /* the faces of the cell */
  aqr_entry* entries;  /* nearest the point's face first in edges crossed */
  size_t n_entries, capacity;
  size_t queries;
} aqr_pcell;

aqr_status aqr_pcell_init(aqr_context* c, const aqr_surface* s, aqr_pcell* cell);
void aqr_pcell_free(aqr_context* c, aqr_pcell* cell);

#define AQR_OWN (AQR_NONE - 1) /* stands for the line that is growing, ... */
#define AQR_GUESS                                                                                                      \
  (AQR_NONE - 64) /* ... AQR_GUESS + k for one of a few that grow beside it, as far as they are known                  \
                   */

/* A growing line as its own queries see it. */
typedef struct aqr_draft
{
  aqr_sample* samples; /* in pairs */
  size_t n_samples, sample_capacity;
  aqr_segment* segments; /* of line AQR_OWN; their samples are those of the draft */
  size_t n_segments, segment_capacity;
  aqr_face_map newest; /* per face: of its segments */
} aqr_draft;

/* What a query looks for: segments nearer than the radius that run within a quarter right angle of
 * a direction. */
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
  const aqr_draft* draft; /* looked at besides the lines, or NULL */
  size_t most_faces;      /* looked at; 0: as many as there are */
  unsigned guesses;       /* how many of the lines AQR_GUESS + k are seen */
} aqr_probe;

/* The nearest segment of the direction's family (angle below pi/4; paper 4.2) within the radius. */
aqr_status aqr_pcell_nearest(
  aqr_context* c, aqr_pcell* cell, const aqr_lines* lines, const aqr_probe* probe, aqr_near* found);

/* Whether the probe sees one of the face's segments from number `since` on. */
bool aqr_probe_sees(const aqr_lines* lines, aqr_index face, size_t since, const aqr_probe* probe);

#endif
