/* SPDX-License-Identifier: BSD-3-Clause */
/* Lines drawn by hand on a shape's surface, for tests of what is built on lines. */
#ifndef AQR_TEST_DRAWING_H
#define AQR_TEST_DRAWING_H

#include "feature_graph.h"
#include "lines.h"
#include "model.h"

typedef struct drawing
{
  model e;
  aqr_chains chains;
  aqr_lines lines;
} drawing;

static inline drawing draw_on(shape m)
{
  drawing d = { .e = model_surface(m) };
  CHECK(aqr_chains_build(&d.e.c, &d.e.s, 45, &d.chains) == AQR_OK);
  CHECK(aqr_lines_init(&d.e.c, &d.e.s, &d.lines) == AQR_OK);
  return d;
}

static inline void drawing_free(drawing* d)
{
  aqr_lines_free(&d->e.c, &d->lines);
  aqr_chains_free(&d->e.c, &d->chains);
  model_free(&d->e);
}

static inline aqr_sample place_on(const drawing* d, aqr_index h, double t, aqr_index face)
{
  aqr_index edge = aqr_edge_of(&d->e.s, h);
  t = edge == h ? t : 1 - t;
  return (aqr_sample){ .p = aqr_edge_point(&d->e.s, edge, t), .t = t, .edge = edge, .face = face };
}

static inline void add(drawing* d, aqr_sample* samples, size_t n, bool closed)
{
  uint8_t end = closed ? AQR_END_LOOP : AQR_END_PROXIMITY;
  aqr_line line = { .count = n, .ends = { end, end }, .closed = closed, .partner = { AQR_NONE, AQR_NONE } };
  samples[n - 1].face = samples[n - 2].face;
  CHECK(aqr_lines_add(&d->e.c, &d->lines, &d->e.s, &line, samples) == AQR_OK);
}

/* A circle: where the surface meets a sphere. Closed, around one spot. */
static inline void add_circle(drawing* d, vec3 centre, double radius)
{
  const aqr_surface* s = &d->e.s;
  aqr_sample* samples = malloc((s->n_faces + 1) * sizeof *samples);
  double* height = malloc(s->n_points * sizeof *height);
  size_t n = 0;
  aqr_index first = AQR_NONE;
  for (aqr_index v = 0; v < s->n_points; v++)
    height[v] = v3_norm(v3_sub(model_shape_point(&d->e, aqr_point(s, v)), centre)) - radius;
  for (aqr_index h = 0; h < 3 * s->n_faces && first == AQR_NONE; h++)
    if (height[aqr_from(s, h)] < 0 && height[aqr_to(s, h)] >= 0)
      first = h;
  CHECK(first != AQR_NONE);
  for (aqr_index h = first; first != AQR_NONE;)
  {
    double a = height[aqr_from(s, h)], b = height[aqr_to(s, h)];
    samples[n++] = place_on(d, h, a / (a - b), aqr_face_of(h));
    if (n > 1 && h == first)
      break;
    aqr_index k = aqr_next(h);
    while ((height[aqr_from(s, k)] < 0) == (height[aqr_to(s, k)] < 0))
      k = aqr_next(k);
    h = aqr_twin(s, k);
  }
  add(d, samples, n, true);
  free(samples);
  free(height);
}

#endif
