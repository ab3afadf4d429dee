/* SPDX-License-Identifier: BSD-3-Clause */
#include "test.h"

#include "drawing.h"
#include "network.h"
#include "solids.h"
#include "tracer.h"

static aqr_sample end_on(const model* e, aqr_index h, double t, aqr_index key)
{
  aqr_index edge = aqr_edge_of(&e->s, h);
  t = edge == h ? t : 1 - t;
  return (aqr_sample){ .p = aqr_edge_point(&e->s, edge, t), .t = t, .edge = edge, .face = aqr_face_of(h), .key = key };
}

static double side(vec3 n, vec3 a, vec3 b, vec3 p)
{
  return v3_dot(n, v3_cross(v3_sub(b, a), v3_sub(p, a)));
}

/* The order of the chords' ends along the border of their face says what their geometry says. */
AQR_TEST(chords_cross_by_order_exactly_where_they_cross_in_the_plane)
{
  model e = model_surface(shape_sphere(4, 1));
  unsigned state = 2, crossed = 0;
  for (int i = 0; i < 20000; i++)
  {
    aqr_index f = (aqr_index)((double)e.s.n_faces * shape_random(&state));
    vec3 n = aqr_face_cross(&e.s, f);
    aqr_sample a[4];
    for (aqr_index k = 0; k < 4; k += 2)
    {
      unsigned from = (unsigned)(3 * shape_random(&state)), to = (from + 1 + (shape_random(&state) < 0.5)) % 3;
      a[k] = end_on(&e, 3 * f + from, shape_random(&state), k);
      a[k + 1] = end_on(&e, 3 * f + to, shape_random(&state), k + 1);
    }
    double b0 = side(n, a[0].p, a[1].p, a[2].p), b1 = side(n, a[0].p, a[1].p, a[3].p);
    double a0 = side(n, a[2].p, a[3].p, a[0].p), a1 = side(n, a[2].p, a[3].p, a[1].p);
    if (fmin(fmin(fabs(a0), fabs(a1)), fmin(fabs(b0), fabs(b1))) < 1e-12 * v3_norm2(n))
      continue;
    int expected = (b0 > 0) == (b1 > 0) || (a0 > 0) == (a1 > 0) ? 0 : b0 < 0 ? 1 : -1;
    CHECK(aqr_chords_cross(&e.s, f, &a[0], &a[1], &a[2], &a[3]) == expected);
    CHECK(aqr_chords_cross(&e.s, f, &a[2], &a[3], &a[0], &a[1]) == -expected);
    crossed += expected != 0;
  }
  CHECK(crossed > 2000);
  model_free(&e);
}

/* Two chords that leave through the very same point of an edge, as at a vertex, are told apart by their keys, and the
 * same way on both sides of the edge. */
AQR_TEST(lines_through_one_point_of_an_edge_cross_once_and_not_twice)
{
  model e = model_surface(shape_sphere(4, 3));
  unsigned state = 4;
  for (int i = 0; i < 2000; i++)
  {
    aqr_index h = (aqr_index)(3 * (double)e.s.n_faces * shape_random(&state)), g = aqr_twin(&e.s, h);
    aqr_index f = aqr_face_of(h), o = aqr_face_of(g);
    aqr_sample a[2], b[2], before[2], after[2];
    for (aqr_index k = 0; k < 2; k++)
    {
      a[k] = end_on(&e, h, 0.5, 10 + k);
      before[k] = end_on(&e, k ? aqr_next(h) : aqr_prev(h), 0.5, k);
      after[k] = end_on(&e, k ? aqr_next(g) : aqr_prev(g), 0.5, 20 + k);
      b[k] = a[k];
    }
    int in = aqr_chords_cross(&e.s, f, &before[0], &a[0], &before[1], &a[1]);
    int out = aqr_chords_cross(&e.s, o, &b[0], &after[0], &b[1], &after[1]);
    /* line 0 comes from the start of h and leaves beside its end, line 1 the other way round: they change sides */
    CHECK((in != 0) + (out != 0) == 1);
  }
  model_free(&e);
}

/* The first of two lines to be added was taken for the nearer to the edge's start on its own side of a crease only. */
AQR_TEST(lines_that_meet_an_edge_at_one_place_keep_their_order_on_its_other_side)
{
  drawing d = draw_on(shape_sphere(4, 3));
  const aqr_surface* s = &d.e.s;
  for (aqr_index h = 0; h < 60; h++)
  {
    aqr_index side[2] = { h, aqr_twin(s, h) }, first = (aqr_index)d.lines.n_samples;
    double t = 0.3;
    for (unsigned k = 0; k < 2; k++)
      for (unsigned i = 0; i < 2; i++)
      {
        aqr_index f = aqr_face_of(side[k]), partner = k ? first + (i ? 0 : 2) : AQR_NONE;
        aqr_sample a[2] = { place_on(&d, side[k], k ? 1 - t : t, f), place_on(&d, aqr_next(side[k]), 0.5, f) };
        aqr_line line = {
          .count = 2, .ends = { AQR_END_FEATURE, AQR_END_PROXIMITY }, .partner = { partner, AQR_NONE }
        };
        CHECK(aqr_lines_add(&d.e.c, &d.lines, s, &line, a) == AQR_OK);
      }
    const aqr_sample* a = d.lines.samples + first;
    bool here = aqr_border_before(s, aqr_face_of(side[0]), &a[0], &a[2]);
    bool there = aqr_border_before(s, aqr_face_of(side[1]), &a[6], &a[4]); /* the continuations of the two */
    CHECK(here != there);
  }
  drawing_free(&d);
}

static aqr_network network_of(drawing* d)
{
  aqr_network net = { 0 };
  CHECK(aqr_network_build(&d->e.c, &d->e.s, &d->lines, &d->chains, 0.01, 0.01, &net) == AQR_OK);
  return net;
}

/* Where directions are not trusted, lines of one family meet; crossings were once looked for between families only
 * (paper 5.1). */
AQR_TEST(lines_of_one_type_that_cross_make_vertices)
{
  drawing d = draw_on(shape_sphere(10, 1));
  add_circle(&d, v3(0, 0, 1), 0.8);
  add_circle(&d, v3(0.6, 0, 0.8), 0.8);
  CHECK(d.lines.lines[0].type == d.lines.lines[1].type);
  aqr_network net = network_of(&d);
  CHECK(net.n_crossings == 2 && net.n_edges == 4 && net.n_loops == 4);
  aqr_network_free(&d.e.c, &net);
  drawing_free(&d);
}

/* Half of a small circle around a place on the border of a spot's first circle: it crosses that once. */
static void add_loose_line(drawing* d)
{
  drawing whole = draw_on(shape_sphere(10, 1));
  add_circle(&whole, v3(-0.733, 0, 0.68), 0.3);
  add(d, whole.lines.samples, whole.lines.n_samples / 2, false);
  drawing_free(&whole);
}

/* What a line runs on beyond its last crossing would be an edge with a loose end inside a face (paper 5.2). */
AQR_TEST(the_ends_of_lines_beyond_their_last_crossings_are_no_edges)
{
  drawing d = draw_on(shape_sphere(10, 1));
  add_circle(&d, v3(0, 0, 1), 0.8);
  add_circle(&d, v3(0.6, 0, 0.8), 0.8);
  add_loose_line(&d);
  aqr_network net = network_of(&d);
  CHECK(net.n_crossings == 3 && net.n_edges == 4 && net.n_loops == 4);
  for (aqr_index h = 0; h < 2 * net.n_edges; h++)
    CHECK(net.next[h] != (h ^ 1));
  aqr_network_free(&d.e.c, &net);
  drawing_free(&d);
}

static void add_straight(drawing* d, vec3 way)
{
  aqr_tracer t;
  aqr_advance result;
  vec3 from = v3_madd(v3(0.5, 0.5, 0), -0.4, way);
  aqr_place at = model_place_at(&d->e, v3_madd(from, 0.2 / 16, way));
  aqr_tracer_init(&t, &d->e.s, NULL);
  aqr_tracer_start(&t, &at, way);
  CHECK(aqr_tracer_straight(&d->e.c, &t, 5, &result) == AQR_OK && result == AQR_AT_BORDER);
  add(d, t.samples, t.n_samples, false);
  aqr_tracer_free(&d->e.c, &t);
}

static bool touches(const model* e, aqr_index f, vec3 p)
{
  bool found = false;
  for (unsigned i = 0; i < 3; i++)
    found |= v3_norm(v3_sub(model_shape_point(e, aqr_point(&e->s, e->s.corner[3 * f + i])), p)) < 1e-12;
  return found;
}

/* Lines on an even grid run through its vertices, passing each on one side or the other; they may cross there three
 * times, for faces to merge, but not be missed. */
AQR_TEST(lines_that_meet_in_a_vertex_change_sides_there_and_nowhere_else)
{
  const vec3 ways[4] = { v3(1, 0, 0), v3(0, 1, 0), v3(1, 1, 0), v3(1, -1, 0) };
  for (int k = 0; k < 16; k++)
  {
    if (k / 4 == k % 4)
      continue;
    drawing d = draw_on(shape_grid(16, 16, false, false, 0, 3, place_on_plane));
    add_straight(&d, ways[k / 4]);
    add_straight(&d, ways[k % 4]);
    const aqr_line *first = &d.lines.lines[0], *second = &d.lines.lines[1];
    size_t crossed = 0;
    for (size_t i = first->first; i + 1 < first->first + first->count; i++)
      for (size_t j = second->first; j + 1 < second->first + second->count; j++)
      {
        const aqr_sample *a = &d.lines.samples[i], *b = &d.lines.samples[j];
        if (a->face != b->face || !aqr_chords_cross(&d.e.s, a->face, a, a + 1, b, b + 1))
          continue;
        crossed++;
        CHECK(touches(&d.e, a->face, v3(0.5, 0.5, 0)));
      }
    CHECK(crossed % 2 == 1);
    drawing_free(&d);
  }
}

AQR_TEST_MAIN
