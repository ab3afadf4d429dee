/* SPDX-License-Identifier: BSD-3-Clause */
/* Seconds and memory of every stage on a bumpy torus, on one thread.
 *
 *     benchmark-stages [FACES [POINTS]]      1000000 and 20000 */
#include "bumpy_torus.h"

#include <stdio.h>

int main(int argc, char** argv)
{
  bumpy_torus m = bumpy_torus_make(argc > 1 ? atof(argv[1]) : 1e6);
  aqr_remesher* remesher = NULL;
  aqr_status status = m.points && m.triangles ? aqr_remesher_new(NULL, &remesher) : AQR_OUT_OF_MEMORY;
  if (status == AQR_OK)
  {
    aqr_input input = bumpy_torus_input(&m);
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
    printf("%zu faces in, %zu points out\n", m.n_faces, aqr_remesher_mesh(remesher)->number_of_points);
    for (size_t i = 0; i < count; i++)
      printf("%-20s %8.3f s  %6.0f bytes/face at peak  %6.0f kept\n", stages[i].name, stages[i].seconds,
        (double)stages[i].peak_bytes / (double)m.n_faces, (double)stages[i].end_bytes / (double)m.n_faces);
  }
  else
    fprintf(stderr, "benchmark-stages: %s\n", aqr_status_string(status));
  aqr_remesher_free(remesher);
  bumpy_torus_free(&m);
  return status == AQR_OK ? 0 : 1;
}
