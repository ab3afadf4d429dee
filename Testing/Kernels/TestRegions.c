/* SPDX-License-Identifier: BSD-3-Clause */
/* Regions between lines drawn by hand, on surfaces whose Euler number is known. */
#include "test.h"

#include "drawing.h"
#include "regions.h"
#include "remesh.h"
#include "solids.h"

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
  bool is_bare;        /* some component has no line left */
  size_t bare_faces;
  uint64_t bare_hash;
} outcome;

/* In rounds, until no region needs an arc; `all`: each looks at all faces again. */
static outcome cut_looking_at(drawing* d, bool all)
{
  aqr_context* c = &d->e.c;
  const aqr_surface* s = &d->e.s;
  outcome r = { .first = 0 };
  uint8_t *bare = calloc(s->n_faces, 1), *suspect = malloc(s->n_faces);
  memset(suspect, 1, s->n_faces);
  for (int i = 0; i < 30; i++)
  {
    aqr_network net = { 0 };
    size_t added = 0;
    CHECK(aqr_network_build(c, s, &d->lines, &d->chains, 0.01, 0.01, &net) == AQR_OK);
    if (all)
      memset(suspect, 1, s->n_faces);
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
  for (size_t f = 0; f < s->n_faces; f++)
    r.bare_faces += bare[f];
  r.is_bare = r.bare_faces > 0;
  r.bare_hash = hash_bytes(0, bare, s->n_faces);
  free(bare);
  free(suspect);
  printf("arcs %zu, %zu in the first round; Euler number %ld\n", r.total, r.first, r.euler);
  return r;
}

static outcome cut(drawing* d)
{
  return cut_looking_at(d, false);
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

/* A closed line around vertex v that crosses the edges there at t and u in turn. */
static void add_zigzag(drawing* d, aqr_index v, double t, double u)
{
  const aqr_surface* s = &d->e.s;
  aqr_sample samples[20];
  size_t n = 0;
  aqr_index h = s->fan[v];
  do
  {
    samples[n] = place_on(d, h, n % 2 ? u : t, aqr_face_of(aqr_twin(s, h)));
    n++;
    h = aqr_next(aqr_twin(s, h));
  } while (h != s->fan[v]);
  samples[n] = samples[0];
  add(d, samples, n + 1, true);
}

/* Two pairs of closed lines around a vertex, and between them no vertex of the surface: which chords and edges an arc
 * leads over is left to how the faces are numbered. */
AQR_TEST(an_annulus_no_wider_than_a_face_gets_one_arc)
{
  unsigned tried = 0;
  for (aqr_index v = 0;; v++)
  {
    drawing d = draw_on(shape_sphere(5, 1));
    const aqr_surface* s = &d.e.s;
    if (v >= s->n_points)
    {
      drawing_free(&d);
      break;
    }
    size_t valence = 0;
    aqr_index h = s->fan[v];
    do
    {
      valence++;
      h = aqr_next_around(s, h);
    } while (h != s->fan[v]);
    if (valence % 2 == 0)
    {
      const double at[4] = { 0.2, 0.4, 0.6, 0.8 };
      for (unsigned i = 0; i < 4; i++)
        add_zigzag(&d, v, at[i], at[i ^ 1]);
      outcome r = cut(&d);
      CHECK(r.total == 1 && r.euler == 2);
      tried++;
    }
    drawing_free(&d);
  }
  CHECK(tried > 30);
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

static bool same_lines(const drawing* a, const drawing* b)
{
  bool same = a->lines.n_lines == b->lines.n_lines && a->lines.n_samples == b->lines.n_samples;
  for (size_t i = 0; same && i < a->lines.n_samples; i++)
  {
    const aqr_sample *x = &a->lines.samples[i], *y = &b->lines.samples[i];
    same = x->edge == y->edge && x->face == y->face && !(x->t < y->t) && !(x->t > y->t);
  }
  return same;
}

/* The rounds after the first look only at faces of regions that were cut: a region counted in part, or one left out,
 * would get other arcs, or none. */
AQR_TEST(rounds_that_look_at_few_faces_draw_the_arcs_of_those_that_look_at_all)
{
  unsigned state[2] = { 9, 9 };
  size_t later = 0;
  for (int i = 0; i < 100; i++)
  {
    drawing d[2];
    outcome r[2];
    for (int all = 0; all < 2; all++)
    {
      d[all] = draw_on(shape_plate(3, 3, 2, 1));
      for (int k = 0; k < 2 + i % 4; k++)
        add_walk(&d[all], 10 + (size_t)i, 1000, &state[all]);
      r[all] = cut_looking_at(&d[all], all);
    }
    CHECK(same_lines(&d[0], &d[1]) && r[0].euler == r[1].euler);
    CHECK(r[0].bare_faces == r[1].bare_faces && r[0].bare_hash == r[1].bare_hash);
    CHECK(r[0].is_bare || r[0].euler == -4);
    later += r[0].total > r[0].first;
    for (int all = 0; all < 2; all++)
      drawing_free(&d[all]);
  }
  CHECK(later > 20); /* or nothing was compared */
}

/* Two surfaces in one. */
static shape beside(shape a, shape b, vec3 off)
{
  shape m = { .n_points = a.n_points + b.n_points, .n_triangles = a.n_triangles + b.n_triangles };
  m.points = malloc(3 * m.n_points * sizeof *m.points);
  m.triangles = malloc(3 * m.n_triangles * sizeof *m.triangles);
  for (size_t i = 0; i < m.n_points; i++)
    v3_store(m.points + 3 * i,
      i < a.n_points ? v3_load(a.points + 3 * i) : v3_add(off, v3_load(b.points + 3 * (i - a.n_points))));
  for (size_t i = 0; i < 3 * m.n_triangles; i++)
    m.triangles[i] = i < 3 * a.n_triangles ? a.triangles[i] : b.triangles[i - 3 * a.n_triangles] + (int64_t)a.n_points;
  shape_free(&a);
  shape_free(&b);
  return m;
}

/* A component without lines gets its own triangles for a mesh: it must be found, whole, and no other. Lines without a
 * crossing leave no network, so they do not save it, and no arc can reach it. */
AQR_TEST(only_a_component_without_a_network_is_bare)
{
  for (int circles = 0; circles < 3; circles++)
  {
    drawing d = draw_on(beside(shape_sphere(6, 1), shape_torus(6, 2), v3(0, 0, 3)));
    const size_t ring = 2 * 30 * 12;
    add_spot(&d, v3(0, 0, 1), v3(0.3, 0, 1), 0.5);
    for (int k = 0; k < circles; k++)
      add_circle(&d, v3(1.4, 0.2 * k, 3), 0.3);
    outcome r = cut(&d);
    CHECK(r.bare_faces == (circles < 2 ? ring : 0));
    CHECK(r.total == (circles < 2 ? 0 : 2)); /* the torus' handle */
    CHECK(r.euler == 2);                     /* of the sphere; a torus has none */
    drawing_free(&d);
  }
}

AQR_TEST_MAIN
