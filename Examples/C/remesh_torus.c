/* SPDX-License-Identifier: BSD-3-Clause */
/* The kernels alone: an array of points and triangles in, polygons out, with progress and cancel.
 *
 *     remesh-torus [POINTS [CANCEL_AT]]
 *
 * makes a torus, remeshes it to POINTS points (1000) and prints the result as a .obj file. With a
 * fraction CANCEL_AT the run is cancelled there. */
#include "aqr.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum
{
  around = 160, /* points along the torus and across its tube */
  across = 80
};

static void make_torus(double* points, int64_t* triangles)
{
  const double full_turn = 6.283185307179586;
  for (int i = 0; i < around; i++)
    for (int j = 0; j < across; j++)
    {
      const double u = full_turn * i / around, v = full_turn * j / across;
      double* p = points + 3 * (i * across + j);
      p[0] = (3.0 + cos(v)) * cos(u);
      p[1] = (3.0 + cos(v)) * sin(u);
      p[2] = sin(v);

      const int64_t next_i = (i + 1) % around, next_j = (j + 1) % across;
      const int64_t a = i * across + j, b = next_i * across + j;
      const int64_t c = next_i * across + next_j, d = i * across + next_j;
      int64_t* t = triangles + 6 * (i * across + j);
      t[0] = a, t[1] = b, t[2] = c;
      t[3] = a, t[4] = c, t[5] = d;
    }
}

static int show_progress(void* user, double fraction, const char* stage)
{
  const double cancel_at = *(const double*)user;
  fprintf(stderr, "%5.1f %% %s\n", 100.0 * fraction, stage);
  return fraction < cancel_at; /* 0 cancels */
}

static void print_obj(const aqr_mesh* mesh)
{
  for (size_t p = 0; p < mesh->number_of_points; p++)
    printf("v %.9g %.9g %.9g\n", mesh->points[3 * p], mesh->points[3 * p + 1], mesh->points[3 * p + 2]);
  for (size_t f = 0; f < mesh->number_of_faces; f++)
  {
    printf("f");
    for (int64_t i = mesh->offsets[f]; i < mesh->offsets[f + 1]; i++)
      printf(" %lld", (long long)mesh->connectivity[i] + 1);
    printf("\n");
  }
}

int main(int argc, char** argv)
{
  static double points[3 * around * across];
  static int64_t triangles[6 * around * across];
  make_torus(points, triangles);

  double cancel_at = argc > 2 ? atof(argv[2]) : 2.0;
  aqr_hooks hooks = { 0 };
  hooks.user = &cancel_at;
  hooks.progress = show_progress;

  aqr_input input = { 0 };
  input.number_of_points = around * across;
  input.points_d = points;
  input.number_of_triangles = 2 * around * across;
  input.triangles = triangles;

  aqr_options options = aqr_default_options();
  options.density = AQR_DENSITY_POINTS;
  options.target_points = argc > 1 ? atoi(argv[1]) : 1000;

  aqr_remesher* remesher = NULL;
  aqr_status status = aqr_remesher_new(&hooks, &remesher);
  if (status == AQR_OK)
    status = aqr_remesher_set_input(remesher, &input);
  if (status == AQR_OK)
    status = aqr_remesher_run(remesher, &options);
  if (status == AQR_OK)
    print_obj(aqr_remesher_mesh(remesher));
  else
    fprintf(stderr, "remesh-torus: %s\n", aqr_status_string(status));
  aqr_remesher_free(remesher);
  return status == AQR_OK ? 0 : 1;
}
