/* SPDX-License-Identifier: BSD-3-Clause */
/* Seconds and memory of every stage on a bumpy torus, on one thread.
 *
 *     benchmark-stages [FACES [POINTS]]      1000000 and 20000 */
#include "aqr.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static void make_surface(size_t around, size_t across, double* points, int64_t* triangles)
{
  const double full_turn = 6.283185307179586;
  for (size_t i = 0; i < around; i++)
    for (size_t j = 0; j < across; j++)
    {
      const double u = full_turn * (double)i / (double)around, v = full_turn * (double)j / (double)across;
      const double tube = 1 + 0.2 * cos(5 * u) + 0.1 * sin(4 * v);
      double* p = points + 3 * (i * across + j);
      p[0] = (3 + tube * cos(v)) * cos(u);
      p[1] = (3 + tube * cos(v)) * sin(u);
      p[2] = tube * sin(v);

      const size_t next_i = (i + 1) % around, next_j = (j + 1) % across;
      const int64_t a = (int64_t)(i * across + j), b = (int64_t)(next_i * across + j);
      const int64_t c = (int64_t)(next_i * across + next_j), d = (int64_t)(i * across + next_j);
      int64_t* t = triangles + 6 * (i * across + j);
      t[0] = a, t[1] = b, t[2] = c;
      t[3] = a, t[4] = c, t[5] = d;
    }
}

int main(int argc, char** argv)
{
  const double faces = argc > 1 ? atof(argv[1]) : 1e6;
  const size_t across = (size_t)fmax(8, sqrt(faces / 6)), around = 3 * across;
  const size_t n = around * across;
  double* points = malloc(3 * n * sizeof *points);
  int64_t* triangles = malloc(6 * n * sizeof *triangles);
  aqr_remesher* remesher = NULL;
  aqr_status status = points && triangles ? aqr_remesher_new(NULL, &remesher) : AQR_OUT_OF_MEMORY;
  if (status == AQR_OK)
  {
    make_surface(around, across, points, triangles);
    aqr_input input = { 0 };
    input.number_of_points = n;
    input.points_d = points;
    input.number_of_triangles = 2 * n;
    input.triangles = triangles;
    status = aqr_remesher_set_input(remesher, &input);
  }
  if (status == AQR_OK)
  {
    aqr_options options = aqr_default_options();
    options.density = AQR_DENSITY_POINTS;
    options.target_points = argc > 2 ? atoll(argv[2]) : 20000;
    status = aqr_remesher_run(remesher, &options);
  }
  if (status == AQR_OK)
  {
    size_t count = 0;
    const aqr_stage* stages = aqr_remesher_stages(remesher, &count);
    printf("%zu faces in, %zu points out\n", 2 * n, aqr_remesher_mesh(remesher)->number_of_points);
    for (size_t i = 0; i < count; i++)
      printf("%-20s %8.3f s  %6.0f bytes/face at peak  %6.0f kept\n", stages[i].name, stages[i].seconds,
        (double)stages[i].peak_bytes / (double)(2 * n), (double)stages[i].end_bytes / (double)(2 * n));
  }
  else
    fprintf(stderr, "benchmark-stages: %s\n", aqr_status_string(status));
  aqr_remesher_free(remesher);
  free(points);
  free(triangles);
  return status == AQR_OK ? 0 : 1;
}
