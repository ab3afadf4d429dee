/* SPDX-License-Identifier: BSD-3-Clause */
/* Fuzzes options as raw bytes on small surfaces. */
#include "bytes.h"
#include "examine.h"
#include "mutate.h"

#include <stdio.h>
#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size);

/* Any bytes for a while, then a value that is allowed: a run with one wild option among good ones goes deepest. */
static double take_value(bytes* b, double low, double high)
{
  uint8_t kind = take_8(b);
  if (kind == 255)
    return take_double(b);
  return kind < 250 ? low + (high - low) * take_16(b) / 65535 : kind % 2 ? low : high;
}

int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size)
{
  bytes b = { data, size };
  shape m = mutate_base(take_8(&b));
  aqr_options o = aqr_default_options();
  if (take_8(&b) == 255)
    take(&b, &o.cookie, sizeof o.cookie);
  o.density = (aqr_density)(take_8(&b) % 2);
  /* small values cost time, not paths: nine tenths of the range of the logarithm are left out, and zeros are coarse */
  o.tolerance = pow(10, take_value(&b, -1, -3.5));
  o.target_points = (int64_t)fmin(3000, fmax(-10, take_value(&b, 4, 2000)));
  o.curvature_radius = take_value(&b, 0, 0.2);
  o.smoothing_iterations = (int)fmin(60, fmax(-5, take_value(&b, 0, 20)));
  o.confidence_angle = take_value(&b, 0, 90);
  o.feature_lines = take_8(&b) % 2;
  o.feature_angle = take_value(&b, 1, 180);
  o.boundary_lines = take_8(&b) % 2;
  o.anisotropy = take_value(&b, 1, 0);
  o.adaptivity = take_value(&b, 1, 0);
  o.pure_quads = take_8(&b) % 2;
  o.largest_spacing = fmax(0.005, take_value(&b, 1, 0.01));
  o.largest_valence = (int)fmin(100, fmax(0, take_value(&b, 4, 64)));
  o.convex_partition = take_8(&b) % 2;
  o.preserve_topology = take_8(&b) % 2;
  take(&b, &o.seed, sizeof o.seed);
  double* scale = malloc(m.n_points * sizeof *scale);
  if (scale && take_8(&b) % 4 == 0)
  {
    for (size_t i = 0; i < m.n_points; i++)
      scale[i] = b.left ? pow(o.density == AQR_DENSITY_POINTS ? 1e300 : 4, take_value(&b, -1, 1)) : 1;
    o.density_scale = scale;
  }
  aqr_input input = shape_input(&m);
  aqr_status status;
  const char* fault = examine(&input, &o, &status);
  if (fault)
  {
    fprintf(stderr, "fault: %s (%s)\n", fault, aqr_status_string(status));
    abort();
  }
  free(scale);
  shape_free(&m);
  return 0;
}
