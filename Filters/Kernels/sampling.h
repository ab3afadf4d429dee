/* SPDX-License-Identifier: BSD-3-Clause */
/* Placing lines over the whole surface: seeds, stops, spacing (paper 3 and 4.2). */
#ifndef AQR_SAMPLING_H
#define AQR_SAMPLING_H

#include "feature_graph.h"
#include "lines.h"
#include "sizing.h"

typedef struct aqr_sampling_options
{
  double min_cosine; /* of the confidence angle: seeds lie in faces at least this confident where
                        there are any */
  double tolerance;  /* in scaled units */
  double points;     /* of the mesh, to be reached by shrinking the spacing where the sizing gives fewer; 0: as it is */
  bool boundary_lines;
  uint32_t seed;
} aqr_sampling_options;

typedef struct aqr_reached
{
  double finer;  /* what the spacings of the sizing were divided by to reach the points asked for */
  double points; /* expected of the lines */
} aqr_reached;

/* Fills `lines` (initialised here) with the chains first, then the curvature lines. */
aqr_status aqr_sample_lines(aqr_context* c, const aqr_surface* s, const aqr_field* field, aqr_sizing* sizing,
  const aqr_chains* chains, const aqr_sampling_options* options, aqr_lines* lines, aqr_reached* r, aqr_report* report);

#endif
