/* SPDX-License-Identifier: BSD-3-Clause */
/* One line: integrated from a seed to both sides until something stops it (paper 3.1, 3.2, 4.2). */
#ifndef AQR_GROWTH_H
#define AQR_GROWTH_H

#include "proximity.h"
#include "sizing.h"
#include "tracer.h"

typedef struct aqr_grower
{
  const aqr_surface* surface;
  const aqr_field* field;
  const aqr_sizing* sizing;
  aqr_lines* lines; /* committed lines; the growing one is entered provisionally and taken out again */
  aqr_tracer tracer;
  aqr_pcell cell;
  aqr_sample* samples; /* of the line grown last */
  size_t n_samples, capacity;
  aqr_line line;      /* its description; count 0: nothing grew */
  size_t provisional; /* samples of the growing line held beyond lines->n_samples */
} aqr_grower;

aqr_status aqr_grower_init(aqr_context* c, const aqr_surface* s, const aqr_field* field, const aqr_sizing* sizing,
  aqr_lines* lines, aqr_grower* g);
void aqr_grower_free(aqr_context* c, aqr_grower* g);

/* Whether a line along `direction` may start at p: no line of its family within `distance`. */
aqr_status aqr_grow_allowed(
  aqr_context* c, aqr_grower* g, aqr_index face, vec3 p, vec3 direction, double distance, bool* allowed);

/* Grows a line through a place in both directions, along the branch of the field nearest to `direction`. */
aqr_status aqr_grow_inside(aqr_context* c, aqr_grower* g, const aqr_place* at, vec3 direction);

/* Grows a line from fraction `at` of a boundary or seam half-edge into its face; none where the branch of the field
 * nearest to `direction` turns more than 60 degrees away from it. */
aqr_status aqr_grow_from_border(aqr_context* c, aqr_grower* g, aqr_index h, double at, vec3 direction);

#endif
