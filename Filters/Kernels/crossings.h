/* SPDX-License-Identifier: BSD-3-Clause */
/* The crossings of lines, found in each face and ordered along each chord. */
#ifndef AQR_CROSSINGS_H
#define AQR_CROSSINGS_H

#include "network.h"

/* Crossings along chords. */
typedef struct aqr_crossing_order
{
  aqr_index* first; /* per sample: its chord's crossings begin here in `on`, and end where the next one's begin;
                       n_samples + 2, of which the last serves only while they are listed */
  aqr_index* on;    /* crossings along chords, in order */
  size_t n_samples, n_on;
} aqr_crossing_order;

/* Which of the two sides of a crossing a chord is. */
static inline unsigned aqr_side_of(const aqr_crossing* x, aqr_index chord)
{
  return x->chord[0] == chord ? 0 : 1;
}

/* Fills the network's crossings, and their order. */
aqr_status aqr_crossings_find(
  aqr_context* c, const aqr_surface* s, const aqr_lines* lines, aqr_network* net, aqr_crossing_order* order);
void aqr_crossing_order_free(aqr_context* c, aqr_crossing_order* order);

#endif
