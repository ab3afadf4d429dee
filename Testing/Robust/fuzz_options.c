/* SPDX-License-Identifier: BSD-3-Clause */
/* Fuzzes options as raw bytes on small surfaces. */
#include "bytes.h"
#include "examine.h"
#include "mutate.h"

#include <stdio.h>
#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size);

/* Mostly a value that is allowed, from one byte: a run with one wild option among good ones goes deepest. */
static double take_value(bytes* b, double low, double high)
{
  uint8_t kind = take_8(b);
  if (kind == 255)
    return take_double(b);
  return kind < 252 ? low + (high - low) * kind / 251 : kind % 2 ? low : high;
}

/* The switches come first: fuzzers begin with few bytes, and all that is missing is 0, which is coarse and fast. */
int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size)
{
  bytes b = { data, size };
  shape m = mutate_base(take_8(&b));
  aqr_options o = aqr_default_options();
  uint8_t flags = take_8(&b), more = take_8(&b);
  o.density = flags & 1 ? AQR_DENSITY_POINTS : AQR_DENSITY_TOLERANCE;
  o.feature_lines = !(flags & 2);
  o.boundary_lines = !(flags & 4);
  o.convex_partition = !(flags & 8);
  o.preserve_topology = !(flags & 16);
  o.pure_quads = flags >> 5 & 1;
  /* small values cost time, not paths: nine tenths of the range of the logarithm are left out */
  o.tolerance = pow(10, take_value(&b, -1, -3.5));
  o.target_points = (int64_t)fmin(3000, fmax(-10, take_value(&b, 4, 1000)));
  o.largest_spacing = fmax(0.005, take_value(&b, 1, 0.01));
  o.anisotropy = take_value(&b, 1, 0);
  o.adaptivity = take_value(&b, 1, 0);
  o.feature_angle = take_value(&b, 40, 1);
  o.largest_valence = (int)fmin(100, fmax(0, take_value(&b, 5, 64)));
  o.curvature_radius = take_value(&b, 0, 0.2);
  o.smoothing_iterations = (int)fmin(60, fmax(-5, take_value(&b, 0, 20)));
  o.confidence_angle = take_value(&b, 30, 90);
  o.seed = take_8(&b);
  if (more == 255)
    take(&b, &o.cookie, sizeof o.cookie);
  double* scale = malloc(m.n_points * sizeof *scale);
  if (scale && flags & 64)
  {
    for (size_t i = 0; i < m.n_points; i++)
      scale[i] = b.left ? pow(o.density == AQR_DENSITY_POINTS ? 1e300 : 4, take_value(&b, -1, 1)) : 1;
    o.density_scale = scale;
  }
  aqr_input input = shape_input(&m);
  aqr_status status;
  int64_t* locked = lock_some(&input, more == 255 ? 0 : more);
  if (flags & 128)
  {
    set_plane(&o, &input, take_16(&b) | (uint32_t)take_8(&b) << 16);
    for (size_t k = 0; k < 3 && more == 254; k++)
    {
      o.symmetry_origin[k] = take_double(&b);
      o.symmetry_normal[k] = take_double(&b);
    }
  }
  const char* fault = examine(&input, &o, &status);
  if (fault)
  {
    fprintf(stderr, "fault: %s (%s)\n", fault, aqr_status_string(status));
    abort();
  }
  free(locked);
  free(scale);
  shape_free(&m);
  return 0;
}
