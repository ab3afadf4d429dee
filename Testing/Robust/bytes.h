/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads a fuzzer's bytes; past their end everything is 0. */
#ifndef AQR_TEST_BYTES_H
#define AQR_TEST_BYTES_H

#include "aqr.h"

#include <stdlib.h>
#include <string.h>

typedef struct bytes
{
  const uint8_t* at;
  size_t left;
} bytes;

static inline void take(bytes* b, void* to, size_t n)
{
  size_t k = n < b->left ? n : b->left;
  memset(to, 0, n);
  if (k)
    memcpy(to, b->at, k);
  b->at += k;
  b->left -= k;
}
static inline uint8_t take_8(bytes* b)
{
  uint8_t x;
  take(b, &x, sizeof x);
  return x;
}
static inline uint16_t take_16(bytes* b)
{
  uint16_t x;
  take(b, &x, sizeof x);
  return x;
}
static inline double take_double(bytes* b)
{
  double x;
  take(b, &x, sizeof x);
  return x;
}

/* Symmetry about a plane by the mean of all points or another at or near one of them, across a direction of small whole
 * numbers; 0 is the mean and x. */
static inline void set_plane(aqr_options* o, const aqr_input* in, uint32_t code)
{
  const double toward[] = { 0, 1, 0.5, -0.4 }; /* 1: exactly through a point */
  size_t n = in->number_of_points, p = code / 2048 % (n ? n : 1);
  if (!n)
    return;
  o->symmetry = 1;
  for (size_t k = 0; k < 3; k++)
  {
    double sum = 0, at = in->points_f ? (double)in->points_f[3 * p + k] : in->points_d[3 * p + k];
    for (size_t i = 0; i < n; i++)
      sum += in->points_f ? (double)in->points_f[3 * i + k] : in->points_d[3 * i + k];
    o->symmetry_normal[k] = (double)((code >> 3 * k & 7) ^ 4) - 4;
    o->symmetry_origin[k] = sum / (double)n + toward[code >> 9 & 3] * (at - sum / (double)n);
    if ((code >> 9 & 3) == 1)
      o->symmetry_origin[k] = at;
  }
  if ((code & 511) == 0)
    o->symmetry_normal[0] = 1;
}

/* Options within their ranges, coarse enough for many runs a second: four bytes, and one of `code` for set_plane()
 * where the highest bit of the third asks for symmetry. */
static inline aqr_options take_mild_options(bytes* b, uint32_t* code)
{
  aqr_options o = aqr_default_options();
  uint8_t flags = take_8(b), fineness = take_8(b), angle = take_8(b), rest = take_8(b);
  o.density = flags & 1 ? AQR_DENSITY_POINTS : AQR_DENSITY_TOLERANCE;
  o.feature_lines = !(flags & 2);
  o.boundary_lines = !(flags & 4);
  o.convex_partition = !(flags & 8);
  o.preserve_topology = !(flags & 16);
  o.curvature_radius = flags & 32 ? 0 : 0.02;
  o.smoothing_iterations = flags & 64 ? 0 : 5;
  o.largest_spacing = flags & 128 ? 0.3 : 0.1;
  o.tolerance = 0.0265 - 0.0001 * fineness; /* zeros are coarse, and fast */
  o.target_points = 4 + 2 * fineness;
  o.feature_angle = angle % 128 ? angle % 128 * (180.0 / 127) : 40;
  o.symmetry = angle >> 7;
  *code = fineness | (uint32_t)rest << 9;
  o.largest_valence = 4 + rest % 8;
  o.pure_quads = rest >> 6 & 1;
  o.seed = rest / 8;
  return o;
}

/* Locks a side of every third triangle, and a pair that may be no edge, where the seed says so; the caller frees. */
static inline int64_t* lock_some(aqr_input* in, uint32_t seed)
{
  size_t n = in->number_of_triangles;
  int64_t* locked = seed & 16 && n ? malloc(2 * (n / 3 + 2) * sizeof *locked) : NULL;
  if (!locked)
    return NULL;
  for (size_t i = 0; i < n; i += 3, in->number_of_locked++)
    for (size_t k = 0; k < 2; k++)
      locked[2 * in->number_of_locked + k] = in->triangles[3 * i + (seed + k) % 3];
  locked[2 * in->number_of_locked] = in->triangles[0];
  locked[2 * in->number_of_locked++ + 1] = in->triangles[3 * n - 1];
  in->locked = locked;
  return locked;
}

#endif
