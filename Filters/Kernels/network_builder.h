/* SPDX-License-Identifier: BSD-3-Clause */
/* What network.c, which makes edges and their order, and network_stops.c, which makes nodes on chains, share. */
#ifndef AQR_NETWORK_BUILDER_H
#define AQR_NETWORK_BUILDER_H

#include "crossings.h"
#include "network.h"

typedef struct aqr_network_builder
{
  aqr_context* c;
  const aqr_surface* s;
  const aqr_lines* l;
  const aqr_chains* chains;
  double tolerance[2]; /* of feature and boundary chains */
  aqr_network* net;
  aqr_crossing_order order;
  aqr_index* alive;   /* per line: its nodes that are alive */
  uint8_t* reached;   /* per line: what of it lives hangs together with an edge of the surface */
  aqr_index* stop_of; /* 2 per line, of its first and last sample: the stop on a chain, or AQR_NONE */
  aqr_index* node_of; /* per cleaned point: the stop of a node of the feature graph */
} aqr_network_builder;

static inline bool aqr_line_lives(const aqr_network_builder* b, aqr_index line)
{
  return b->l->lines[line].is_chain || b->alive[line] >= 2;
}

/* A node on a chain, at position t from one of its samples on, or of the feature graph. */
aqr_status aqr_add_stop(aqr_network_builder* b, aqr_index chain, aqr_index sample, double t, aqr_index* id);

/* Nodes where lines end on chains, and more until the chains' chords depart little from them; in order along each. */
aqr_status aqr_place_stops(aqr_network_builder* b);

#endif
