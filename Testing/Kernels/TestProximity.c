/* SPDX-License-Identifier: BSD-3-Clause */
#include "test.h"

#include "model.h"
#include "proximity.h"
#include "solids.h"

/* One chord from edge to edge in every face that the dice choose, each a line of its own. */
static void scatter(model* e, aqr_lines* l, double share, unsigned seed)
{
  unsigned state = seed;
  CHECK(aqr_lines_init(&e->c, &e->s, l) == AQR_OK);
  for (aqr_index f = 0; f < e->s.n_faces; f++)
  {
    if (shape_random(&state) > share)
      continue;
    aqr_sample a[2] = { { .face = f }, { .face = f } };
    unsigned first = (unsigned)(3 * shape_random(&state));
    for (unsigned i = 0; i < 2; i++)
    {
      aqr_index h = 3 * f + (first + i) % 3;
      a[i].edge = aqr_edge_of(&e->s, h);
      a[i].t = 0.1 + 0.8 * shape_random(&state);
      a[i].p = aqr_edge_point(&e->s, a[i].edge, a[i].t);
    }
    aqr_line line = { .count = 2, .partner = { AQR_NONE, AQR_NONE } };
    CHECK(aqr_lines_add(&e->c, l, &e->s, &line, a) == AQR_OK);
  }
}

static double to_segment(vec3 p, vec3 a, vec3 b)
{
  vec3 d = v3_sub(b, a);
  double t = fmin(1, fmax(0, v3_dot(v3_sub(p, a), d) / fmax(1e-300, v3_norm2(d))));
  return v3_norm(v3_sub(p, v3_madd(a, t, d)));
}

/* The nearest segment of the family in any face that is reached over edges nearer than the radius. */
static double by_brute_force(const model* e, const aqr_lines* l, const aqr_probe* probe)
{
  const aqr_surface* s = &e->s;
  uint8_t* in = calloc(s->n_faces, 1);
  double nearest = probe->radius;
  in[probe->face] = 1;
  for (bool more = true; more;)
  {
    more = false;
    for (aqr_index h = 0; h < 3 * s->n_faces; h++)
    {
      aqr_index t = aqr_twin(s, h);
      if (t == AQR_NONE || !in[h / 3] || in[t / 3] ||
          to_segment(probe->p, aqr_point(s, aqr_from(s, h)), aqr_point(s, aqr_to(s, h))) >= probe->radius)
        continue;
      in[t / 3] = 1;
      more = true;
    }
  }
  for (size_t i = 0; i < l->n_lines; i++)
  {
    const aqr_sample* a = &l->samples[l->lines[i].first];
    vec3 d = v3_unit(v3_sub(a[1].p, a->p));
    if (in[a->face] && fabs(v3_dot(d, probe->direction)) >= sqrt(0.5))
      nearest = fmin(nearest, to_segment(probe->p, a->p, a[1].p));
  }
  free(in);
  return nearest;
}

static aqr_probe random_probe(const model* e, unsigned* state, double radius)
{
  aqr_index f = (aqr_index)((double)e->s.n_faces * shape_random(state));
  vec3 p = { 0, 0, 0 }, n = v3_unit(aqr_face_cross(&e->s, f));
  for (unsigned i = 0; i < 3; i++)
    p = v3_madd(p, 1.0 / 3, aqr_point(&e->s, e->s.corner[3 * f + i]));
  vec3 d = v3_unit(v3_reject(v3(shape_random(state) - 0.5, shape_random(state) - 0.5, shape_random(state) - 0.5), n));
  return (aqr_probe){ .face = f, .p = p, .direction = d, .radius = radius, .self = AQR_NONE };
}

AQR_TEST(queries_find_what_a_search_of_all_faces_in_reach_finds)
{
  shape shapes[] = { shape_sphere(10, 1), shape_torus(7, 2), shape_plate(2, 3, 0, 3),
    shape_grid(20, 20, false, false, 0.4, 4, place_on_plane) };
  for (unsigned k = 0; k < sizeof shapes / sizeof *shapes; k++)
  {
    model e = model_surface(shapes[k]);
    aqr_lines l;
    aqr_pcell cell;
    unsigned state = k, found = 0;
    scatter(&e, &l, 0.15, k + 10);
    CHECK(aqr_pcell_init(&e.c, &e.s, &cell) == AQR_OK);
    for (int i = 0; i < 300; i++)
    {
      aqr_probe probe = random_probe(&e, &state, 0.02 + 0.15 * shape_random(&state));
      aqr_near near;
      CHECK(aqr_pcell_nearest(&e.c, &cell, &l, &probe, &near) == AQR_OK);
      double expected = by_brute_force(&e, &l, &probe);
      CHECK((near.line == AQR_NONE) == (expected >= probe.radius));
      CHECK(fabs(near.distance - expected) < 1e-12);
      if (near.line != AQR_NONE)
      {
        const aqr_sample* a = &l.samples[near.sample];
        CHECK(fabs(to_segment(probe.p, a->p, a[1].p) - expected) < 1e-12);
      }
      found += near.line != AQR_NONE;
      probe.any = true;
      CHECK(aqr_pcell_nearest(&e.c, &cell, &l, &probe, &near) == AQR_OK);
      CHECK((near.line == AQR_NONE) == (expected >= probe.radius) && near.distance < probe.radius + 1e-12);
    }
    CHECK(found > 30 && found < 300);
    aqr_pcell_free(&e.c, &cell);
    aqr_lines_free(&e.c, &l);
    model_free(&e);
  }
}

/* Two sheets a hundredth apart, joined far away. */
static vec3 place_on_fold(double u, double v)
{
  double s = 2.02 * u - 1.01;
  return fabs(s) < 0.01 ? v3(0.01 * cos(s * 50 * shape_turn / 2 / 2), v, 0.005 * s / 0.01)
                        : v3(0.01 - fabs(s), v, s < 0 ? -0.005 : 0.005);
}
AQR_TEST(a_line_on_the_sheet_behind_is_not_near)
{
  model e = model_surface(shape_grid(202, 60, false, false, 0, 5, place_on_fold));
  aqr_lines l;
  aqr_pcell cell;
  unsigned below = 0, state = 3;
  CHECK(aqr_lines_init(&e.c, &e.s, &l) == AQR_OK);
  for (aqr_index f = 0; f < e.s.n_faces; f++)
  {
    vec3 p = model_shape_point(&e, aqr_point(&e.s, e.s.corner[3 * f]));
    if (p.z > -0.004 || p.x > -0.1)
      continue;
    aqr_sample a[2] = { { .face = f }, { .face = f } };
    for (unsigned i = 0; i < 2; i++)
    {
      a[i].edge = aqr_edge_of(&e.s, 3 * f + i);
      a[i].t = 0.5;
      a[i].p = aqr_edge_point(&e.s, a[i].edge, 0.5);
    }
    aqr_line line = { .count = 2, .partner = { AQR_NONE, AQR_NONE } };
    CHECK(aqr_lines_add(&e.c, &l, &e.s, &line, a) == AQR_OK);
    below++;
  }
  CHECK(below > 1000);
  CHECK(aqr_pcell_init(&e.c, &e.s, &cell) == AQR_OK);
  unsigned asked = 0;
  for (int i = 0; i < 2000; i++)
  {
    aqr_probe probe = random_probe(&e, &state, 0.04);
    aqr_near near;
    if (model_shape_point(&e, probe.p).z < 0.004 || model_shape_point(&e, probe.p).x > -0.1)
      continue;
    asked++;
    CHECK(aqr_pcell_nearest(&e.c, &cell, &l, &probe, &near) == AQR_OK && near.line == AQR_NONE);
  }
  CHECK(asked > 500);
  aqr_pcell_free(&e.c, &cell);
  aqr_lines_free(&e.c, &l);
  model_free(&e);
}

/* The counter of queries comes round: stamps of a former turn must not hide faces. */
AQR_TEST(the_query_after_the_last_number_still_sees_every_face)
{
  model e = model_surface(shape_sphere(6, 6));
  aqr_lines l;
  aqr_pcell cell;
  unsigned state = 6;
  scatter(&e, &l, 0.2, 8);
  CHECK(aqr_pcell_init(&e.c, &e.s, &cell) == AQR_OK);
  for (int i = 0; i < 40; i++)
  {
    aqr_probe probe = random_probe(&e, &state, 0.3);
    aqr_near near;
    if (i == 20)
      cell.query = UINT32_MAX - 5;
    CHECK(aqr_pcell_nearest(&e.c, &cell, &l, &probe, &near) == AQR_OK);
    CHECK(fabs(near.distance - by_brute_force(&e, &l, &probe)) < 1e-12);
  }
  CHECK(cell.query < 20);
  aqr_pcell_free(&e.c, &cell);
  aqr_lines_free(&e.c, &l);
  model_free(&e);
}

/* One chord of the growing line beside the probe: the line's own recent past is no neighbour, its distant past is. */
AQR_TEST(a_line_meets_its_distant_past_but_not_its_own_tail)
{
  model e = model_surface(shape_grid(10, 10, false, false, 0, 7, place_on_plane));
  const double past[] = { 0, 0.5, 1, 20, 100 };
  for (int i = 0; i < 5; i++)
  {
    aqr_lines l;
    aqr_pcell cell;
    aqr_near near;
    scatter(&e, &l, 0, 1);
    CHECK(aqr_pcell_init(&e.c, &e.s, &cell) == AQR_OK);
    unsigned state = 5;
    aqr_probe probe = random_probe(&e, &state, 0.05);
    aqr_sample a[2] = { { .face = probe.face }, { .face = probe.face } };
    for (unsigned k = 0; k < 2; k++)
    {
      a[k].edge = aqr_edge_of(&e.s, 3 * probe.face + k);
      a[k].t = 0.5;
      a[k].p = aqr_edge_point(&e.s, a[k].edge, 0.5);
    }
    vec3 d = v3_sub(a[1].p, a->p);
    double away = to_segment(probe.p, a->p, a[1].p);
    a[1].arc = (float)v3_norm(d);
    aqr_line line = { .count = 2, .partner = { AQR_NONE, AQR_NONE } };
    CHECK(aqr_lines_add(&e.c, &l, &e.s, &line, a) == AQR_OK);
    probe.direction = v3_unit(d);
    probe.arc = (double)a[1].arc + past[i] * away;
    CHECK(aqr_pcell_nearest(&e.c, &cell, &l, &probe, &near) == AQR_OK && near.line == 0); /* as a stranger's */
    probe.self = 0;
    CHECK(aqr_pcell_nearest(&e.c, &cell, &l, &probe, &near) == AQR_OK);
    CHECK((near.line == AQR_NONE) == (past[i] < 2));
    aqr_pcell_free(&e.c, &cell);
    aqr_lines_free(&e.c, &l);
    model_free(&e);
    e = model_surface(shape_grid(10, 10, false, false, 0, 7, place_on_plane));
  }
  model_free(&e);
}

AQR_TEST_MAIN
