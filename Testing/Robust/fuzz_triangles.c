/* SPDX-License-Identifier: BSD-3-Clause */
/* Fuzzes raw triangles: four bytes of options, the number of points, float coordinates, 16-bit indices. The highest bit
 * of the number of points asks for whole coordinates from one byte each instead, where coincidences are likely. */
#include "bytes.h"
#include "examine.h"

#include <stdio.h>
#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size)
{
  bytes b = { data, size };
  uint32_t code;
  aqr_options options = take_mild_options(&b, &code);
  uint16_t n = take_16(&b);
  int whole = n >> 15;
  size_t width = whole ? 1 : sizeof(float), n_points = n & 0x7fff;
  if (n_points * 3 * width > b.left)
    n_points = b.left / (3 * width);
  float* points = malloc((3 * n_points + 1) * sizeof *points);
  for (size_t i = 0; points && i < 3 * n_points; i++)
    if (whole)
      points[i] = (float)take_8(&b);
    else
      take(&b, &points[i], sizeof points[i]);
  size_t n_triangles = b.left / (3 * (whole ? 1 : 2));
  int64_t* triangles = malloc((3 * n_triangles + 1) * sizeof *triangles);
  for (size_t i = 0; triangles && i < 3 * n_triangles; i++)
    triangles[i] = whole ? take_8(&b) : take_16(&b);
  if (points && triangles)
  {
    aqr_input input = {
      .number_of_points = n_points, .points_f = points, .number_of_triangles = n_triangles, .triangles = triangles
    };
    int64_t* locked = lock_some(&input, options.seed);
    if (options.symmetry)
      set_plane(&options, &input, code);
    aqr_status status;
    const char* fault = examine(&input, &options, &status);
    if (fault)
    {
      fprintf(stderr, "fault: %s (%s)\n", fault, aqr_status_string(status));
      abort();
    }
    free(locked);
  }
  free(points);
  free(triangles);
  return 0;
}
