/* SPDX-License-Identifier: BSD-3-Clause */
/* Curvature tensors and the direction field of a (cut) surface: paper sections 2 and 4.1. */
#ifndef AQR_FIELD_H
#define AQR_FIELD_H

#include "flatten.h"
#include "surface.h"

typedef struct aqr_field
{
  const double* normal;  /* those of the tensors, which outlive the field */
  double* min_direction; /* 3 per point, unit, tangent to normal; max direction = normal x min
                            direction */
  double* k_min;         /* per point, signed, k_min <= k_max, in units of the scaled surface; positive on a
                            sphere */
  double* k_max;
  double* cross;   /* 3 per point, unit, tangent: one branch of a smooth cross field that equals the
                      principal directions where they are trusted and extends them elsewhere; branches
                      of neighbouring points agree up to quarter turns */
  aqr_rotor* flat; /* 3 per face: fourth powers of the corners' crosses, flattened into the plane of the face whose
                      half-edge 0 runs along +x (paper 2) */
  float* point_confidence; /* per point, [0,1] */
  float* face_confidence;  /* per face, [0,1], equation 1 of the paper */
} aqr_field;

/* Symmetric 3x3 tensors, six numbers: xx yy zz xy xz yz. */
typedef struct aqr_tensors
{
  float* t;       /* 6 per point: normal-cycle tensor averaged over the ball, eigenvalues = curvatures,
                     with the eigenvectors of the two tangent ones swapped as DESIGN.md says (minimum
                     direction carries k_max) */
  double* normal; /* 3 per point, unit, averaged over the sector's faces only */
} aqr_tensors;

/* Normal-cycle tensors over a ball of `radius` (paper 2). Never reaches across borders or seams. */
aqr_status aqr_curvature_tensors(aqr_context* c, const aqr_surface* s, double radius, aqr_tensors* tensors);
void aqr_tensors_free(aqr_context* c, const aqr_surface* s, aqr_tensors* tensors);

/* Principal frames rotated to the averaged normal, confidence, `iterations` of confidence-weighted
 * smoothing (paper 4.1), then the cross field. min_cosine: cos of the confidence angle. The tensors
 * are read, not changed. */
aqr_status aqr_direction_field(aqr_context* c, const aqr_surface* s, const aqr_tensors* tensors, int iterations,
  double min_cosine, aqr_field* field);
void aqr_field_free(aqr_context* c, const aqr_surface* s, aqr_field* field);

#endif
