/* SPDX-License-Identifier: BSD-3-Clause */
/* How far apart lines are meant to be: a chord of a circle of curvature k departs from it by e
 * where it is d(k) = 2 sqrt(e (2 / |k| - e)) long (Alliez et al. 2003). */
#ifndef AQR_SIZING_H
#define AQR_SIZING_H

#include "field.h"

typedef struct aqr_sizing
{
  float* bend;    /* 2 per point: absolute normal curvature along the cross's first and second branch */
  float* scale;   /* per point: factor on both spacings asked for by the user's density, or NULL for 1 */
  float* area;    /* per point: a third of its faces' */
  float* spacing; /* 2 per point: distance of neighbouring crossing lines along the first and the
                     second branch */
  size_t n_points;
  double largest;
  double coarser;             /* factor on every spacing, whatever else bounds it */
  double least_bend, stretch; /* of the curvatures and of `largest`, where a number of points is asked for */
  double unit;                /* factor on `scale`: 1, or what makes its density 1 on average */
} aqr_sizing;

typedef struct aqr_sizing_options
{
  const double* density; /* NULL, or one factor per INPUT point on points per area */
  double largest_spacing;
  double largest_bend; /* curvatures above it are taken for noise */
  double anisotropy;   /* 0: both spacings as the larger curvature asks for; 1: each as its own */
  double adaptivity;   /* 0: points per area everywhere as for the mean curvature; 1: as for each place's own */
  double coarser;      /* factor on every spacing */
} aqr_sizing_options;

aqr_status aqr_sizing_build(
  aqr_context* c, const aqr_surface* s, const aqr_field* field, const aqr_sizing_options* options, aqr_sizing* sizing);
void aqr_sizing_free(aqr_context* c, aqr_sizing* sizing);

/* Fills `spacing` for a tolerance (in scaled units). */
aqr_status aqr_sizing_set(aqr_context* c, const aqr_surface* s, double tolerance, aqr_sizing* sizing);

/* Points at which even the largest spacing is less than the input can carry. */
size_t aqr_sizing_bounded(const aqr_sizing* sizing);

/* Number of crossings that lines at the spacings for a tolerance would have: the integral of 1 / (product of the
 * spacings). */
double aqr_sizing_predict(const aqr_sizing* sizing, double tolerance);

/* Fills `spacing` for the tolerance whose prediction is `points`. */
aqr_status aqr_sizing_solve(aqr_context* c, const aqr_surface* s, double points, aqr_sizing* sizing, double* tolerance);

/* Spacing of neighbouring lines along direction d at a face: *along, of the lines that cross one
 * that runs along d, and *across, of the lines beside it. */
void aqr_sizing_at(const aqr_surface* s, const aqr_field* field, const aqr_sizing* sizing, aqr_index face, vec3 d,
  double* along, double* across);

/* The part of both that the user's density has: a factor, 1 where there is none. */
double aqr_sizing_scale(const aqr_surface* s, const aqr_sizing* sizing, aqr_index face);

#endif
