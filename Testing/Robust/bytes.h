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

/* Options within their ranges, coarse enough for many runs a second: four bytes. */
static inline aqr_options take_mild_options(bytes* b)
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
  o.feature_angle = angle ? angle * (180.0 / 255) : 40;
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
