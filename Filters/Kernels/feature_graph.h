/* SPDX-License-Identifier: BSD-3-Clause */
/* Feature graph: creases, boundary loops, and the nodes where they meet (paper 3). */
#ifndef AQR_FEATURES_H
#define AQR_FEATURES_H

#include "surface.h"

/* A maximal run of seam or boundary edges between two nodes of the graph, or a closed loop. */
typedef struct aqr_chain
{
  size_t first, count; /* into aqr_chains.half_edges: consecutive half-edges, head to tail, surface
                          on their left */
  bool closed;
  bool is_feature; /* seam; else boundary */
} aqr_chain;

typedef struct aqr_chains
{
  aqr_chain* chains;
  size_t n_chains;
  aqr_index* half_edges;
  size_t n_half_edges;
  uint8_t* is_node; /* per cleaned point: 1 where a chain begins or ends (corner), 2 inside a chain,
                       0 elsewhere */
  size_t n_clean;
} aqr_chains;

/* Collects the seams and boundaries of a cut surface into chains. Nodes: points where other than
 * two such edges meet, or where two meet at a turn sharper than corner_angle degrees. A seam is
 * listed once (one of its two sides). */
aqr_status aqr_chains_build(aqr_context* c, const aqr_surface* s, double corner_angle, aqr_chains* chains);
void aqr_chains_free(aqr_context* c, aqr_chains* chains);

#endif
