/* SPDX-License-Identifier: BSD-3-Clause */
/* Curvature tensors and the direction field of a (cut) surface: paper sections 2 and 4.1. */
#ifndef AQR_FIELD_H
#define AQR_FIELD_H

#include "flatten.h"
#include "surface.h"

/* Directions are narrowed, as there is one per point: aqr_min_direction() and aqr_cross() give them unit and tangent.
 */
typedef struct aqr_field
{
  const double* normal; /* those of the tensors, which outlive the field */
  const float* noise;   /* likewise */
  aqr_rotor* direction; /* per point: the minimum direction in the frame of its normal */
  float* k_min;         /* per point, signed, k_min <= k_max, in units of the scaled surface; positive on a
                           sphere */
  float* k_max;
  float* cross; /* 3 per point: one branch of a smooth cross field that equals the principal directions where they
                   are trusted and extends them elsewhere; branches of neighbouring points agree up to quarter
                   turns */
  aqr_short_rotor* flat;   /* 3 per face: fourth powers of the corners' crosses, flattened into the plane of the face
                        whose   half-edge 0 runs along +x (paper 2) */
  float* point_confidence; /* per point, [0,1] */
  float* face_confidence;  /* per face, [0,1], equation 1 of the paper */
} aqr_field;

typedef struct aqr_frame
{
  vec3 x, y;
} aqr_frame;

/* Of the plane that a unit normal stands on. */
static inline aqr_frame aqr_frame_on(vec3 n)
{
  vec3 x = v3_unit(v3_cross(n, fabs(n.x) < 0.8 ? v3(1, 0, 0) : v3(0, 1, 0)));
  return (aqr_frame){ x, v3_cross(n, x) };
}

/* The maximum direction is normal x min direction. */
static inline vec3 aqr_min_direction(const aqr_field* field, size_t v)
{
  aqr_frame at = aqr_frame_on(v3_load(field->normal + 3 * v));
  aqr_complex d = cx_unit(cx_wide(field->direction[v]));
  return v3_madd(v3_scale(at.x, d.x), d.y, at.y);
}

static inline vec3 aqr_cross(const aqr_field* field, size_t v)
{
  return v3_unit(v3_reject(v3_widen(field->cross + 3 * v), v3_load(field->normal + 3 * v)));
}

/* Symmetric 3x3 tensors, six numbers: xx yy zz xy xz yz. */
typedef struct aqr_tensors
{
  float* t;       /* 6 per point: normal-cycle tensor averaged over the ball, eigenvalues = curvatures,
                     with the eigenvectors of the two tangent ones swapped as DESIGN.md says (minimum
                     direction carries k_max) */
  float* noise;   /* per point, >= 0: the curvature that noise feigns: on a plane with noise half the difference of the
                     two curvatures is below it in 98 balls of 100; 0 where all that bends in the ball agrees */
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
