/* SPDX-License-Identifier: BSD-3-Clause */
/* Seconds and memory of every stage on a bumpy torus, on one thread, and the longest times between two calls of the
 * progress hook, which is how long a cancel waits.
 *
 *     benchmark-stages [FACES [POINTS]]      1000000 and 20000 */
#include "bumpy_torus.h"

#include <stdio.h>
#include <string.h>
#include <time.h>

enum
{
  n_gaps = 5
};

typedef struct watch
{
  double last, fraction;
  struct
  {
    double seconds, from, to;
  } longest[n_gaps];
} watch;

static double seconds_now(void)
{
  struct timespec t;
  timespec_get(&t, TIME_UTC);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int note(void* user, double fraction, const char* stage)
{
  watch* w = user;
  double now = seconds_now(), gap = now - w->last;
  int at = n_gaps;
  (void)stage;
  while (at > 0 && gap > w->longest[at - 1].seconds)
    at--;
  if (at < n_gaps)
  {
    memmove(w->longest + at + 1, w->longest + at, (size_t)(n_gaps - 1 - at) * sizeof *w->longest);
    w->longest[at].seconds = gap;
    w->longest[at].from = w->fraction;
    w->longest[at].to = fraction;
  }
  w->fraction = fraction;
  w->last = seconds_now();
  return 1;
}

int main(int argc, char** argv)
{
  bumpy_torus m = bumpy_torus_make(argc > 1 ? atof(argv[1]) : 1e6);
  aqr_remesher* remesher = NULL;
  watch w = { .last = seconds_now() };
  aqr_hooks hooks = { .user = &w, .progress = note };
  aqr_status status = m.points && m.triangles ? aqr_remesher_new(&hooks, &remesher) : AQR_OUT_OF_MEMORY;
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
    for (size_t i = 0; i < n_gaps; i++)
      printf("%.3f s between two calls of the progress hook, at %.4f and %.4f\n", w.longest[i].seconds,
        w.longest[i].from, w.longest[i].to);
  }
  else
    fprintf(stderr, "benchmark-stages: %s\n", aqr_status_string(status));
  aqr_remesher_free(remesher);
  bumpy_torus_free(&m);
  return status == AQR_OK ? 0 : 1;
}
