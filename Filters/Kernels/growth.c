/* SPDX-License-Identifier: BSD-3-Clause */
/* Paper 3.1 and 4.2: the life of a single line. */
#include "growth.h"

#include <string.h>

enum
{
  most_steps = 200000,
  most_closing_faces = 400,
  closing_chords = 8, /* of the line's beginning, that its head may close on */
  step_work = 32,     /* of a step, and of each face that it crosses */
  in_place = 48       /* steps after which a line that has not got away turns around a point of the field */
};

static const double stop_distance = 0.3; /* of the spacing: nearer than this to a line of its family a line ends */
static const double most_stop_distance =
  0.75; /* ... of a line that comes from where more points are asked for: it does not go on between lines there */
static const double longest_line = 20;   /* diagonals */
static const double longest_step = 0.5;  /* of the smaller spacing */
static const double shortest_step = 0.1; /* likewise */
static const double query_every = 0.6;   /* of the stop distance; farther apart along stretched cells */
static const double loop_start = 3;      /* stop distances from the seed: a line that comes back to there closes */

aqr_status aqr_grower_init(aqr_context* c, const aqr_surface* s, const aqr_field* field, const aqr_sizing* sizing,
  aqr_lines* lines, aqr_grower* g)
{
  memset(g, 0, sizeof *g);
  g->surface = s;
  g->field = field;
  g->sizing = sizing;
  g->lines = lines;
  aqr_tracer_init(&g->tracer, s, field);
  return aqr_pcell_init(c, s, &g->cell);
}

void aqr_grower_free(aqr_context* c, aqr_grower* g)
{
  aqr_tracer_free(c, &g->tracer);
  aqr_pcell_free(c, &g->cell);
  AQR_DROP(c, g->samples, g->capacity);
  memset(g, 0, sizeof *g);
}

aqr_status aqr_grow_allowed(
  aqr_context* c, aqr_grower* g, aqr_index face, vec3 p, vec3 direction, double distance, bool* allowed)
{
  aqr_near near;
  aqr_probe probe = { face, p, direction, distance, true, AQR_NONE, 0 };
  aqr_status status = aqr_pcell_nearest(c, &g->cell, g->lines, &probe, &near);
  *allowed = near.line == AQR_NONE;
  return status;
}

/* Makes the tracer's samples from *entered on visible to proximity queries, with arc lengths from the seed, of the
 * given sign. Their last chord is left out: the tracer may still take its end back. Provisional samples stand beyond
 * the committed ones. */
static aqr_status enter_provisionally(
  aqr_context* c, aqr_grower* g, vec3 seed, size_t* entered, double* arc, double sign)
{
  aqr_lines* l = g->lines;
  const aqr_tracer* t = &g->tracer;
  if (*entered == 0 && t->n_samples)
    *arc = v3_norm(v3_sub(t->samples[0].p, seed));
  for (; *entered + 2 < t->n_samples; ++*entered)
  {
    size_t n = l->n_samples + g->provisional;
    if (!AQR_RESERVE(c, l->samples, l->sample_capacity, n + 2))
      return AQR_OUT_OF_MEMORY;
    const aqr_sample* a = &t->samples[*entered];
    l->samples[n] = a[0];
    l->samples[n + 1] = a[1];
    l->samples[n].arc = (float)(sign * *arc);
    *arc += v3_norm(v3_sub(a[1].p, a->p));
    l->samples[n + 1].arc = (float)(sign * *arc);
    l->samples[n].line = (aqr_index)l->n_lines;
    l->samples[n].next = l->head[a->face];
    l->head[a->face] = (aqr_index)n;
    g->provisional += 2;
  }
  return AQR_OK;
}

/* Takes the provisional samples out of the lists again. */
static void leave(aqr_grower* g)
{
  aqr_lines* l = g->lines;
  for (; g->provisional; g->provisional -= 2)
  {
    const aqr_sample* a = &l->samples[l->n_samples + g->provisional - 2];
    l->head[a->face] = a->next;
  }
}

/* Steers to the sample of the growing line that its head has met, so that the line closes. The
 * samples before the one met are dropped. False where the way is blocked; the line then stays open.
 */
static aqr_status close_loop(aqr_context* c, aqr_grower* g, aqr_index met, double distance, bool* closed)
{
  aqr_tracer* t = &g->tracer;
  *closed = false;
  /* provisional samples come in pairs; the pair of the sample met starts at the tracer's sample m
   */
  size_t m = (met - g->lines->n_samples) / 2 + 1;
  vec3 x = aqr_tracer_position(t), d = aqr_tracer_direction(t);
  double ahead = -INFINITY, now = v3_dot(v3_sub(t->samples[m].p, x), d);
  for (; m + 4 < t->n_samples && now < 2 * distance && now >= ahead; m++) /* not beyond a quarter of a thin tube */
  {
    ahead = now;
    now = v3_dot(v3_sub(t->samples[m + 1].p, x), d);
  }
  if (m + 4 >= t->n_samples)
    return AQR_OK;
  aqr_sample target = t->samples[m];
  size_t n = t->n_samples, last = m + closing_chords < n - 4 ? m + closing_chords : n - 4;
  for (int i = 0; i < most_closing_faces; i++)
  {
    /* in a face that one of the chords ahead leaves as well, the line goes on over the same edge */
    size_t at = m;
    while (at <= last &&
           !(t->samples[at - 1].face == t->chart.face && t->samples[t->n_samples - 1].edge != t->samples[at].edge))
      at++;
    if (at <= last)
    {
      m = at;
      if (!AQR_RESERVE(c, t->samples, t->capacity, t->n_samples + 1))
        return AQR_OUT_OF_MEMORY;
      target = t->samples[m];
      memmove(t->samples, t->samples + m, (t->n_samples - m) * sizeof *t->samples);
      t->n_samples -= m;
      target.face = t->chart.face; /* as for every last sample: the face of the chord before */
      t->samples[t->n_samples++] = target;
      *closed = true;
      return AQR_OK;
    }
    vec3 to = v3_sub(target.p, aqr_tracer_position(t));
    double length = v3_norm(to);
    if (!aqr_tracer_steer(t, to))
      break;
    /* just out of this face: a short move at a time, aimed anew in each */
    aqr_advance result = AQR_INSIDE;
    aqr_index face = t->chart.face;
    for (int k = 0; k < 8 && t->chart.face == face && result == AQR_INSIDE; k++)
    {
      aqr_status status = aqr_tracer_straight(c, t, length / 4, &result);
      if (status != AQR_OK)
        return status;
    }
    if (result == AQR_AT_BORDER || t->n_samples + 2 < n)
      break;
  }
  if (t->n_samples > n)
    t->n_samples = n;
  return AQR_OK;
}

/* Follows the field one way until the line must stop. */
static aqr_status grow_one_way(aqr_context* c, aqr_grower* g, double sign, aqr_line_end* end)
{
  aqr_tracer* t = &g->tracer;
  const aqr_surface* s = g->surface;
  double step = 0, queried = 0, arc = 0, densest = INFINITY;
  size_t entered = 0;
  const vec3 seed = aqr_tracer_position(t);
  vec3 seen = seed;
  aqr_status status = AQR_OK;
  *end = AQR_END_LENGTH;
  /* a line with more crossings winds around something too thin for lines */
  const size_t most_samples = s->n_faces + 1000;
  for (int i = 0; i < most_steps && t->travelled < longest_line && t->n_samples < most_samples && !t->lost; i++)
  {
    double along, across;
    aqr_sizing_at(s, g->field, g->sizing, t->chart.face, aqr_tracer_direction(t), &along, &across);
    double scale = aqr_sizing_scale(s, g->sizing, t->chart.face);
    densest = lesser(densest, scale);
    double least = lesser(along, across);
    double stop = lesser(most_stop_distance, stop_distance * scale / densest) * across;
    if (step == 0)
      step = longest_step * least;
    if (i % in_place == 0)
    {
      vec3 from = aqr_tracer_position(t);
      if (i && v3_norm(v3_sub(from, seen)) < least / 4)
      {
        *end = AQR_END_SELF;
        break;
      }
      seen = from;
    }
    aqr_advance result;
    size_t crossed = t->crossed;
    AQR_TRY(aqr_tracer_step(c, t, &step, shortest_step * least, longest_step * least, &result));
    AQR_REQUIRE(aqr_worked(c, step_work * (1 + t->crossed - crossed)), AQR_CANCELLED);
    if (result == AQR_AT_BORDER)
    {
      aqr_index edge = t->n_samples ? t->samples[t->n_samples - 1].edge : AQR_NONE;
      *end = edge != AQR_NONE && aqr_is_seam(s, edge) ? AQR_END_FEATURE : AQR_END_BOUNDARY;
      break;
    }
    if (t->travelled - queried < query_every * stop_distance * greater(across, sqrt(along * across)))
      continue;
    queried = t->travelled;
    AQR_TRY(enter_provisionally(c, g, seed, &entered, &arc, sign));
    aqr_near near;
    vec3 p, d;
    aqr_tracer_where(t, &p, &d);
    aqr_probe probe = { t->chart.face, p, d, stop, true, (aqr_index)g->lines->n_lines, sign * t->travelled };
    AQR_TRY(aqr_pcell_nearest(c, &g->cell, g->lines, &probe, &near));
    if (near.line == AQR_NONE)
      continue;
    *end = near.line == probe.self ? AQR_END_SELF : AQR_END_PROXIMITY;
    if (*end == AQR_END_SELF && sign > 0)
    {
      const aqr_sample* met = &g->lines->samples[near.sample];
      bool closed = false;
      if ((double)met->arc < loop_start * stop && v3_dot(v3_sub(met[1].p, met->p), d) > 0)
        AQR_TRY(close_loop(c, g, near.sample, near.distance, &closed));
      if (closed)
        *end = AQR_END_LOOP;
    }
    break;
  }
done:
  return status;
}

static aqr_status keep(aqr_context* c, aqr_grower* g, const aqr_sample* a)
{
  if (!AQR_RESERVE(c, g->samples, g->capacity, g->n_samples + 1))
    return AQR_OUT_OF_MEMORY;
  g->samples[g->n_samples++] = *a;
  return AQR_OK;
}

/* Arc length and spacings passed. */
static void describe(aqr_grower* g)
{
  double arc = 0, sigma = 0;
  for (size_t i = 0; i < g->n_samples; i++)
  {
    aqr_sample* a = &g->samples[i];
    a->arc = (float)arc;
    a->sigma = (float)sigma;
    if (i + 1 == g->n_samples)
      break;
    vec3 d = v3_sub(a[1].p, a->p);
    double n = v3_norm(d), along, across;
    aqr_sizing_at(g->surface, g->field, g->sizing, a->face, v3_unit(d), &along, &across);
    arc += n;
    sigma += n / along;
  }
  g->line.count = g->n_samples < 2 ? 0 : g->n_samples;
}

static uint8_t type_at(const aqr_grower* g, aqr_index face, vec3 d)
{
  double e = 0;
  for (unsigned i = 0; i < 3; i++)
    e += fabs(v3_dot(d, aqr_min_direction(g->field, g->surface->corner[3 * face + i])));
  return e / 3 >= sqrt(0.5) ? AQR_LINE_MIN : AQR_LINE_MAX;
}

static void begin(aqr_grower* g, aqr_index face, vec3 direction)
{
  g->n_samples = 0;
  g->provisional = 0;
  memset(&g->line, 0, sizeof g->line);
  g->line.type = type_at(g, face, direction);
  g->line.partner[0] = g->line.partner[1] = AQR_NONE;
}

aqr_status aqr_grow_inside(aqr_context* c, aqr_grower* g, const aqr_place* at, vec3 direction)
{
  aqr_status status = AQR_OK;
  aqr_tracer* t = &g->tracer;
  aqr_line_end ends[2] = { AQR_END_LENGTH, AQR_END_LENGTH };
  aqr_tracer_start(t, at, direction);
  aqr_tracer_align(t);
  vec3 d = aqr_tracer_direction(t);
  begin(g, at->face, d);
  AQR_TRY(grow_one_way(c, g, 1, &ends[1]));
  for (size_t i = 0; i < t->n_samples; i++)
    AQR_TRY(keep(c, g, &t->samples[i]));
  g->line.closed = ends[1] == AQR_END_LOOP;
  if (!g->line.closed)
  {
    aqr_tracer_start(t, at, v3_scale(d, -1));
    AQR_TRY(grow_one_way(c, g, -1, &ends[0]));
    /* the two halves meet in the seed's face; a line that leaves it twice over one edge does not
     * pass it */
    size_t drop = 0;
    while (drop < t->n_samples && drop < g->n_samples && t->samples[drop].edge == g->samples[drop].edge)
      drop++;
    size_t n = t->n_samples - drop, forward = g->n_samples - drop;
    if (!AQR_RESERVE(c, g->samples, g->capacity, n + forward))
    {
      status = AQR_OUT_OF_MEMORY;
      goto done;
    }
    memmove(g->samples + n, g->samples + drop, forward * sizeof *g->samples);
    aqr_index seed_face = drop == 0 ? at->face : t->samples[drop - 1].face;
    for (size_t i = 0; i < n; i++)
    {
      aqr_sample a = t->samples[drop + n - 1 - i];
      a.face = i + 1 < n ? t->samples[drop + n - 2 - i].face : seed_face;
      g->samples[i] = a;
    }
    g->n_samples = n + forward;
  }
  else
    ends[0] = AQR_END_LOOP;
  if (g->n_samples > 1)
    g->samples[g->n_samples - 1].face = g->samples[g->n_samples - 2].face;
  g->line.ends[0] = (uint8_t)ends[0];
  g->line.ends[1] = (uint8_t)ends[1];
done:
  leave(g);
  describe(g);
  return status;
}

aqr_status aqr_grow_from_border(aqr_context* c, aqr_grower* g, aqr_index h, double at, vec3 direction)
{
  aqr_status status = AQR_OK;
  const aqr_surface* s = g->surface;
  aqr_tracer* t = &g->tracer;
  aqr_index edge = aqr_edge_of(s, h);
  aqr_place place = { aqr_face_of(h), { 0, 0, 0 } };
  place.bary[h % 3] = 1 - at;
  place.bary[(h % 3 + 1) % 3] = at;
  aqr_line_end end = AQR_END_LENGTH;
  aqr_tracer_start(t, &place, direction);
  vec3 inward = aqr_tracer_direction(t);
  aqr_tracer_align(t);
  begin(g, place.face, aqr_tracer_direction(t));
  if (v3_dot(inward, aqr_tracer_direction(t)) > 0.5)
  {
    AQR_REQUIRE(AQR_RESERVE(c, t->samples, t->capacity, 1), AQR_OUT_OF_MEMORY);
    double on_edge = edge == h ? at : 1 - at;
    t->samples[t->n_samples++] =
      (aqr_sample){ .p = aqr_edge_point(s, edge, on_edge), .t = on_edge, .edge = edge, .face = place.face };
    AQR_TRY(grow_one_way(c, g, 1, &end));
    if (t->n_samples && t->samples[0].edge == edge && end != AQR_END_LOOP)
      for (size_t i = 0; i < t->n_samples; i++)
        AQR_TRY(keep(c, g, &t->samples[i]));
    if (g->n_samples > 1)
      g->samples[g->n_samples - 1].face = g->samples[g->n_samples - 2].face;
  }
  g->line.ends[0] = aqr_is_seam(s, h) ? AQR_END_FEATURE : AQR_END_BOUNDARY;
  g->line.ends[1] = (uint8_t)end;
done:
  leave(g);
  describe(g);
  return status;
}
