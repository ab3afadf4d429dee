/* SPDX-License-Identifier: BSD-3-Clause */
/* The graph that the lines draw on the surface (paper 5): its nodes are crossings and ends of lines, its half-edges run
 * along the lines, and the order of half-edges around a node is known exactly from the order of the chords' ends along
 * the borders of the input's faces. Its loops are the borders of the regions that the lines cut the surface into. */
#ifndef AQR_NETWORK_H
#define AQR_NETWORK_H

#include "feature_graph.h"
#include "lines.h"
#include "polygon_mesh.h"
#include "sizing.h"

/* Two chords that cross. side 0 is the line whose chord was entered first. */
typedef struct aqr_crossing
{
  aqr_index chord[2]; /* samples the chords start at */
  aqr_index line[2];
  aqr_index in[2], out[2]; /* edges of the network before and after, along each line; AQR_NONE at its end */
  int8_t turn;             /* 1: the second runs from the right of the first to its left; -1 the other way */
  bool alive;
} aqr_crossing;

/* A node on a chain. */
typedef struct aqr_stop
{
  aqr_index chain;  /* line, or AQR_NONE for a node of the feature graph */
  aqr_index sample; /* of the chain; for a node of the feature graph the cleaned point */
  double t;
  double along;      /* orders the stops of one sample as aqr_border_before() does the lines' ends, which t may not */
  int64_t key;       /* the same where they lie at one place */
  aqr_index out, in; /* edges along the chain after and before; AQR_NONE where there are none */
  aqr_index left, right; /* outgoing half-edges of lines that end here, on either side of the chain */
} aqr_stop;

typedef struct aqr_network
{
  aqr_crossing* crossings;
  size_t n_crossings, crossing_capacity;
  aqr_stop* stops;
  size_t n_stops, stop_capacity;
  /* Half-edges come in pairs, 2 e along the line of edge e. Node k < n_crossings is a crossing, others are stops. */
  aqr_index* from;
  aqr_index* next;
  aqr_index* loop; /* AQR_NONE on the outer side of a boundary */
  uint8_t* type;   /* per edge, aqr_line_type */
  size_t n_edges, edge_capacity;
  size_t n_loops;
  aqr_index* edge_at; /* per sample: the edge that passes through it, on a chain that goes on from it; or AQR_NONE */
  size_t n_samples;
} aqr_network;

/* Chains get nodes of their own until their chords depart from them by no more than chain_tolerance where they are
 * creases, boundary_tolerance where they are borders (scaled units). */
aqr_status aqr_network_build(aqr_context* c, const aqr_surface* s, const aqr_lines* lines, const aqr_chains* chains,
  double chain_tolerance, double boundary_tolerance, aqr_network* net);
void aqr_network_free(aqr_context* c, aqr_network* net);

/* The polygon mesh with the network's nodes as vertices and its loops as faces. */
aqr_status aqr_network_mesh(aqr_context* c, const aqr_surface* s, const aqr_field* field, const aqr_sizing* sizing,
  const aqr_lines* lines, const aqr_network* net, aqr_polygon_mesh* mesh);

#endif
