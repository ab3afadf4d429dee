/* SPDX-License-Identifier: BSD-3-Clause */
/* Proximity queries per second on a bumpy torus with a segment in every other face: the nearest one within four
 * lengths of an edge, along the edges of faces spread over the surface. Prints one number.
 *
 *     benchmark-proximity [FACES]      1000000 */
#include "proximity.h"
#include "bumpy_torus.h"

#include <stdio.h>

enum
{
  n_queries = 200000
};

static const double edges_in_radius = 4;

/* From the middle of the first edge to that of the second. */
static aqr_status add_segments(aqr_context* c, const aqr_surface* s, aqr_lines* lines)
{
  aqr_status status = aqr_lines_init(c, s, lines);
  for (aqr_index f = 0; status == AQR_OK && f < s->n_faces; f += 2)
  {
    aqr_sample a[2];
    for (unsigned i = 0; i < 2; i++)
    {
      a[i] = (aqr_sample){ .face = f, .edge = aqr_edge_of(s, 3 * f + i), .t = 0.5 };
      a[i].p = aqr_edge_point(s, a[i].edge, a[i].t);
    }
    aqr_line line = { .count = 2, .partner = { AQR_NONE, AQR_NONE } };
    status = aqr_lines_add(c, lines, s, &line, a);
  }
  return status;
}

static aqr_status ask(aqr_context* c, const aqr_surface* s, const aqr_lines* lines, aqr_pcell* cell, double* seconds)
{
  double began = aqr_seconds();
  for (size_t i = 0; i < n_queries; i++)
  {
    aqr_index f = (aqr_index)(i * 7919 % s->n_faces);
    vec3 a = aqr_point(s, s->corner[3 * f]), d = v3_sub(aqr_point(s, s->corner[3 * f + 1]), a);
    aqr_probe probe = { .face = f, .p = v3_madd(a, 0.4, d), .direction = v3_unit(d), .self = AQR_NONE };
    aqr_near near;
    probe.radius = edges_in_radius * v3_norm(d);
    aqr_status status = aqr_pcell_nearest(c, cell, lines, &probe, &near);
    if (status != AQR_OK)
      return status;
  }
  *seconds = aqr_seconds() - began;
  return AQR_OK;
}

int main(int argc, char** argv)
{
  bumpy_torus m = bumpy_torus_make(argc > 1 ? atof(argv[1]) : 1e6);
  aqr_context c = { .end = 1 };
  aqr_surface s = { 0 };
  aqr_lines lines = { 0 };
  aqr_pcell cell = { 0 };
  aqr_report report = { 0 };
  double seconds = 0;
  aqr_input input = bumpy_torus_input(&m);
  aqr_status status = m.points && m.triangles ? aqr_surface_build(&c, &input, 1, &s, &report) : AQR_OUT_OF_MEMORY;
  if (status == AQR_OK)
    status = add_segments(&c, &s, &lines);
  if (status == AQR_OK)
    status = aqr_pcell_init(&c, &s, &cell);
  if (status == AQR_OK)
    status = ask(&c, &s, &lines, &cell, &seconds);
  if (status == AQR_OK)
    printf("%.0f\n", n_queries / seconds);
  else
    fprintf(stderr, "benchmark-proximity: %s\n", aqr_status_string(status));
  aqr_pcell_free(&c, &cell);
  aqr_lines_free(&c, &lines);
  aqr_surface_free(&c, &s);
  bumpy_torus_free(&m);
  return status == AQR_OK ? 0 : 1;
}
