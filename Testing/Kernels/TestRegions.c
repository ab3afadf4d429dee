/* SPDX-License-Identifier: BSD-3-Clause */
/* Regions between lines drawn by hand, on surfaces whose Euler number is known. */
#include "test.h"

#include "model.h"
#include "regions.h"
#include "solids.h"

typedef struct drawing
{
  model e;
  aqr_chains chains;
  aqr_lines lines;
} drawing;

static drawing draw_on(shape m)
{
  drawing d = { .e = model_surface(m) };
  CHECK(aqr_chains_build(&d.e.c, &d.e.s, 45, &d.chains) == AQR_OK);
  CHECK(aqr_lines_init(&d.e.c, &d.e.s, &d.lines) == AQR_OK);
  return d;
}

static void drawing_free(drawing* d)
{
  aqr_lines_free(&d->e.c, &d->lines);
  aqr_chains_free(&d->e.c, &d->chains);
  model_free(&d->e);
}

static aqr_sample place_on(const drawing* d, aqr_index h, double t, aqr_index face)
{
  aqr_index edge = aqr_edge_of(&d->e.s, h);
  t = edge == h ? t : 1 - t;
  return (aqr_sample){ .p = aqr_edge_point(&d->e.s, edge, t), .t = t, .edge = edge, .face = face };
}

static void add(drawing* d, aqr_sample* samples, size_t n, bool closed)
{
  uint8_t end = closed ? AQR_END_LOOP : AQR_END_PROXIMITY;
  aqr_line line = { .count = n, .ends = { end, end }, .closed = closed, .partner = { AQR_NONE, AQR_NONE } };
  samples[n - 1].face = samples[n - 2].face;
  CHECK(aqr_lines_add(&d->e.c, &d->lines, &d->e.s, &line, samples) == AQR_OK);
}

/* A circle: where the surface meets a sphere. Closed, around one spot. */
static void add_circle(drawing* d, vec3 centre, double radius)
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

/* Two circles that cross twice, around one spot. */
static void add_spot(drawing* d, vec3 centre, vec3 other, double radius)
{
  add_circle(d, centre, radius);
  add_circle(d, other, radius);
}

typedef struct outcome
{
  size_t first, total; /* arcs drawn in the first round, and in all */
  long euler;          /* nodes - edges + loops */
  bool is_bare;        /* no line was left */
} outcome;

static outcome cut(drawing* d)
{
  aqr_context* c = &d->e.c;
  const aqr_surface* s = &d->e.s;
  outcome r = { 0, 0, 0, false };
  uint8_t *bare = calloc(s->n_faces, 1), *suspect = malloc(s->n_faces);
  memset(suspect, 1, s->n_faces);
  for (int i = 0; i < 30; i++)
  {
    aqr_network net = { 0 };
    size_t added = 0;
    CHECK(aqr_network_build(c, s, &d->lines, &d->chains, 0.01, 0.01, &net) == AQR_OK);
    CHECK(aqr_regions_cut(c, s, &d->chains, &net, &d->lines, bare, suspect, true, &added) == AQR_OK);
    r.euler = (long)net.n_stops + (long)net.n_loops - (long)net.n_edges;
    for (size_t k = 0; k < net.n_crossings; k++)
      r.euler += net.crossings[k].alive;
    aqr_network_free(c, &net);
    r.total += added;
    if (i == 0)
      r.first = added;
    if (!added)
      break;
  }
  for (size_t k = 0; k < d->lines.n_lines; k++)
    for (size_t i = d->lines.lines[k].first; i + 1 < d->lines.lines[k].first + d->lines.lines[k].count; i++)
      CHECK(d->lines.samples[i].edge != d->lines.samples[i + 1].edge);
  r.is_bare = memchr(bare, 1, s->n_faces);
  free(bare);
  free(suspect);
  printf("arcs %zu, %zu in the first round; Euler number %ld\n", r.total, r.first, r.euler);
  return r;
}

/* Two circles on a sphere: four disks. */
AQR_TEST(disks_are_left_alone)
{
  drawing d = draw_on(shape_sphere(10, 1));
  add_spot(&d, v3(0, 0, 1), v3(0.3, 0, 1), 0.5);
  outcome r = cut(&d);
  CHECK(r.total == 0 && r.euler == 2);
  drawing_free(&d);
}

/* A spot at either pole, an annulus between them. */
AQR_TEST(an_annulus_gets_one_arc)
{
  drawing d = draw_on(shape_sphere(10, 1));
  add_spot(&d, v3(0, 0, 1), v3(0.3, 0, 1), 0.5);
  add_spot(&d, v3(0, 0, -1), v3(0.3, 0, -1), 0.5);
  outcome r = cut(&d);
  CHECK(r.total == 1 && r.euler == 2);
  drawing_free(&d);
}

/* Outside of one spot lie all handles, two arcs each; every further spot takes one more. */
AQR_TEST(every_handle_gets_two_arcs)
{
  for (size_t holes = 1; holes <= 3; holes++)
    for (size_t spots = 1; spots <= 2; spots++)
    {
      drawing d = draw_on(shape_plate(holes, 6, 3, 1));
      double end = (double)(2 * holes + 1) * 6;
      add_spot(&d, v3(2, 9, 6), v3(4, 9, 6), 3.2);
      if (spots > 1)
        add_spot(&d, v3(end - 2, 9, 6), v3(end - 4, 9, 6), 3.2);
      outcome r = cut(&d);
      CHECK(r.total == 2 * holes + spots - 1);
      CHECK(r.euler == 2 - 2 * (long)holes);
      drawing_free(&d);
    }
}

static vec3 place_on_thread(double u, double v)
{
  double s = shape_turn * u, t = shape_turn * v, q = 1 + 1e-4 * cos(t);
  return v3(q * cos(s), q * sin(s), 1e-4 * sin(t));
}

/* A ring whose tube is three faces around and a thousandth of them thick. */
AQR_TEST(a_tube_far_thinner_than_its_faces_are_long_is_cut)
{
  drawing d = draw_on(shape_grid(40, 3, true, true, 0, 1, place_on_thread));
  for (aqr_index f = 0; f < 2; f++) /* two closed lines around a vertex each, that cross */
  {
    const aqr_surface* s = &d.e.s;
    aqr_sample samples[20];
    size_t n = 0;
    aqr_index v = f ? aqr_to(s, s->fan[0]) : 0, h = s->fan[v];
    do
    {
      samples[n++] = place_on(&d, h, 0.75, aqr_face_of(aqr_any_twin(s, h)));
      h = aqr_next(aqr_any_twin(s, h));
    } while (h != s->fan[v]);
    samples[n] = samples[0];
    add(&d, samples, n + 1, true);
  }
  outcome r = cut(&d);
  CHECK(r.first > 0 && r.euler == 0);
  drawing_free(&d);
}

/* Three lines that cross in one face and end there cut nothing off, so they must not count as a region's border. */
AQR_TEST(lines_that_cross_in_one_face_only_are_no_network)
{
  drawing d = draw_on(shape_sphere(10, 1));
  add_spot(&d, v3(0, 0, 1), v3(0.3, 0, 1), 0.5);
  aqr_index f = 0;
  while (v3_dot(aqr_face_cross(&d.e.s, f), v3(0, 0, 1)) >= 0)
    f++;
  for (unsigned k = 0; k < 3; k++)
  {
    aqr_sample samples[2] = { place_on(&d, 3 * f + k, 0.8, f), place_on(&d, 3 * f + (k + 1) % 3, 0.8, f) };
    samples[1].t = aqr_edge_of(&d.e.s, 3 * f + (k + 1) % 3) == 3 * f + (k + 1) % 3 ? 0.9 : 0.1;
    add(&d, samples, 2, false);
  }
  outcome r = cut(&d);
  CHECK(r.total == 0 && r.euler == 2);
  drawing_free(&d);
}

/* A line that leaves every face over one of its two other edges, at one of few places. */
static void add_walk(drawing* d, size_t n, unsigned places, unsigned* state)
{
  const aqr_surface* s = &d->e.s;
  aqr_sample* samples = malloc(n * sizeof *samples);
  aqr_index h = (aqr_index)(3 * (double)s->n_faces * shape_random(state));
  for (size_t i = 0; i < n; i++)
  {
    double t = (1 + floor(places * shape_random(state))) / (places + 1);
    samples[i] = place_on(d, h, t, aqr_face_of(h));
    h = aqr_twin(s, shape_random(state) < 0.5 ? aqr_next(h) : aqr_prev(h));
  }
  add(d, samples, n, false);
  free(samples);
}

/* Where many chords of a face begin and end at the same places, and coincide, no straight line tells the order of their
 * crossings; it must be that of some lines all the same, or the loops close no disks. */
AQR_TEST(lines_through_the_same_places_cut_the_surface_into_disks)
{
  unsigned state = 5;
  for (int i = 0; i < 300; i++)
  {
    bool ring = i % 2;
    drawing d = draw_on(ring ? shape_grid(8, 3, true, true, 0, 1, place_on_thread) : shape_sphere(2, 1));
    for (int k = 0; k < 6; k++)
      add_walk(&d, 10 + (size_t)i / 10, 3, &state);
    outcome r = cut(&d);
    CHECK(r.is_bare || r.euler == (ring ? 0 : 2));
    drawing_free(&d);
  }
}

/* Few lines, so that arcs are drawn: none of their chords may begin and end on one edge, where it has no direction. */
AQR_TEST(few_lines_get_arcs_that_cross_faces)
{
  unsigned state = 5;
  for (int i = 0; i < 300; i++)
  {
    bool ring = i % 2;
    drawing d = draw_on(ring ? shape_grid(8, 3, true, true, 0, 1, place_on_thread) : shape_sphere(2, 1));
    for (int k = 0; k < 2 + i / 2 % 4; k++)
      add_walk(&d, 10 + (size_t)i / 10, 1000, &state);
    outcome r = cut(&d);
    CHECK(r.is_bare || r.euler == (ring ? 0 : 2));
    drawing_free(&d);
  }
}

AQR_TEST_MAIN
