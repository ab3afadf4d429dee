/* SPDX-License-Identifier: BSD-3-Clause */
/* Paper 3.1 and 4.2: the life of a single line. */
#include "growth.h"

#include <string.h>

enum
{
  most_steps = 200000,
  most_closing_faces = 400,
  most_glanced_at = 256,
  closing_chords = 8, /* of the line's beginning, that its head may close on */
  in_place = 48       /* steps after which a line that has not got away turns around a point of the field */
};

static const double stop_distance = 0.3; /* of the spacing: nearer than this to a line of its family a line ends */
static const double longest_line = 20;   /* diagonals */
static const double longest_step = 0.5;  /* of the smaller spacing */
static const double shortest_step = 0.1;
static const double most_stop_distance =
  0.75; /* ... of a line that comes from where more points are asked for: it does not go on between lines there */
static const double query_every = 0.6; /* of the stop distance; farther apart along stretched cells */
static const double loop_start = 3;    /* stop distances from the seed: a line that comes back to there closes */

aqr_status aqr_grower_init(aqr_context* c, const aqr_surface* s, const aqr_field* field, const aqr_sizing* sizing,
  const aqr_lines* lines, aqr_grower* g)
{
  memset(g, 0, sizeof *g);
  g->surface = s;
  g->field = field;
  g->sizing = sizing;
  g->lines = lines;
  aqr_tracer_init(&g->tracer, s, field);
  aqr_status status = aqr_pcell_init(c, s, &g->cell);
  return status == AQR_OK ? aqr_face_map_init(c, &g->draft.newest) : status;
}

void aqr_grower_free(aqr_context* c, aqr_grower* g)
{
  aqr_tracer_free(c, &g->tracer);
  aqr_pcell_free(c, &g->cell);
  aqr_face_map_free(c, &g->draft.newest);
  AQR_DROP(c, g->draft.samples, g->draft.sample_capacity);
  AQR_DROP(c, g->draft.segments, g->draft.segment_capacity);
  AQR_DROP(c, g->samples, g->capacity);
  AQR_DROP(c, g->looks, g->look_capacity);
  AQR_DROP(c, g->faces, g->face_capacity);
  memset(g, 0, sizeof *g);
}

/* ---- what queries saw ---- */

/* Samples that the tracer has taken back are no longer those that looks of this half were made from. */
static void note_taken_back(aqr_grower* g)
{
  size_t first = g->ahead ? 0 : g->n_ahead;
  for (size_t i = g->n_looks; i > first && g->looks[i - 1].n_samples > g->tracer.n_kept; i--)
    g->looks[i - 1].n_samples = SIZE_MAX;
  g->tracer.n_kept = g->tracer.n_samples;
}

static bool is_other(aqr_index line)
{
  return line != AQR_NONE && line != AQR_OWN;
}

static aqr_status keep_look(aqr_context* c, aqr_grower* g, const aqr_probe* probe, aqr_index found)
{
  if (!g->keeps_looks)
    return AQR_OK;
  size_t n = is_other(found) ? 0 : g->cell.n_entries + 1;
  if (!AQR_RESERVE(c, g->looks, g->look_capacity, g->n_looks + 1) ||
      !AQR_RESERVE(c, g->faces, g->face_capacity, g->n_faces + n))
    return AQR_OUT_OF_MEMORY;
  note_taken_back(g);
  g->looks[g->n_looks++] = (aqr_look){ *probe, g->n_faces, g->tracer.n_samples, is_other(found) && found >= AQR_GUESS };
  for (size_t i = 0; i < n; i++)
    g->faces[g->n_faces++] = i ? aqr_face_of(g->cell.entries[i - 1].h) : probe->face;
  return AQR_OK;
}

/* The first of the looks [i, end) that sees a segment from number `since` on; `end` where none does. */
static size_t first_seeing(const aqr_grower* g, size_t i, size_t end, size_t since)
{
  for (; i < end; i++)
  {
    size_t last = i + 1 < g->n_looks ? g->looks[i + 1].first_face : g->n_faces;
    for (size_t k = g->looks[i].first_face; k < last; k++)
      if (aqr_probe_sees(g->lines, g->faces[k], since, &g->looks[i].probe))
        return i;
  }
  return end;
}

/* Whether the last look [i, end) of a half, if it only guessed, does find another line. */
static aqr_status guessed_right(aqr_context* c, aqr_grower* g, size_t i, size_t end, bool* right)
{
  *right = true;
  if (i == end || !g->looks[end - 1].guessed)
    return AQR_OK;
  aqr_near near;
  aqr_probe probe = g->looks[end - 1].probe;
  probe.guesses = 0;
  aqr_status status = aqr_pcell_nearest(c, &g->cell, g->lines, &probe, &near);
  *right = is_other(near.line);
  return status;
}

aqr_status aqr_grow_review(aqr_context* c, aqr_grower* g, size_t since, size_t* queries, aqr_review* review)
{
  uint8_t* ends = g->line.ends;
  aqr_status status = AQR_OK;
  size_t ahead = first_seeing(g, 0, g->n_ahead, since), back = first_seeing(g, g->n_ahead, g->n_looks, since);
  bool is_cut[2] = { back < g->n_looks, ahead < g->n_ahead }, right[2] = { true, true };
  if (ahead == 0)
  {
    *queries += 1;
    *review = AQR_NO_ROOM;
    return AQR_OK;
  }
  *review = AQR_OUTDATED;
  /* what met itself may not have met that part of itself */
  if ((is_cut[1] && (ends[1] == AQR_END_SELF || g->line.closed || g->looks[ahead].n_samples == SIZE_MAX)) ||
      (is_cut[0] && g->looks[back].n_samples == SIZE_MAX) || ((is_cut[0] || is_cut[1]) && ends[0] == AQR_END_SELF))
    return AQR_OK;
  if (!is_cut[1])
    AQR_TRY(guessed_right(c, g, 1, g->n_ahead, &right[1]));
  if (!is_cut[0])
    AQR_TRY(guessed_right(c, g, g->n_ahead, g->n_looks, &right[0]));
  if (!right[0] || !right[1])
    goto done;
  *review = AQR_STANDS;
  *queries += g->n_looks;
  if (is_cut[1])
  {
    g->n_samples = g->looks[ahead].n_samples;
    ends[1] = AQR_END_PROXIMITY;
    *queries -= g->n_ahead - ahead - 1;
  }
  if (is_cut[0])
  {
    g->tracer.n_samples = g->looks[back].n_samples;
    ends[0] = AQR_END_PROXIMITY;
    *queries -= g->n_looks - back - 1;
  }
done:
  return status;
}

aqr_status aqr_grow_allowed(
  aqr_context* c, aqr_grower* g, aqr_index face, vec3 p, vec3 direction, double distance, bool* allowed)
{
  aqr_near near;
  aqr_probe probe = { face, p, direction, distance, true, AQR_NONE, 0, NULL, 0, 0 };
  g->n_looks = g->n_ahead = g->n_faces = g->tracer.n_samples = g->tracer.n_kept = 0;
  aqr_status status = aqr_pcell_nearest(c, &g->cell, g->lines, &probe, &near);
  *allowed = near.line == AQR_NONE;
  return status == AQR_OK ? keep_look(c, g, &probe, near.line) : status;
}

aqr_status aqr_grow_crowded(
  aqr_context* c, aqr_grower* g, aqr_index face, vec3 p, vec3 direction, double distance, bool* crowded)
{
  aqr_near near;
  aqr_probe probe = { face, p, direction, distance, true, AQR_NONE, 0, NULL, most_glanced_at, 0 };
  aqr_status status = aqr_pcell_nearest(c, &g->cell, g->lines, &probe, &near);
  *crowded = near.line != AQR_NONE;
  return status;
}

/* ---- growing ---- */

/* Makes the samples of the half visible to its own queries, with arc lengths from the seed. Their last chord is left
 * out: the tracer may still take its end back. */
static aqr_status enter_draft(aqr_context* c, aqr_grower* g)
{
  aqr_draft* l = &g->draft;
  aqr_half* w = &g->half;
  const aqr_tracer* t = &g->tracer;
  if (w->entered == 0 && t->n_samples)
    w->arc = v3_norm(v3_sub(t->samples[0].p, w->seed));
  for (; w->entered + 2 < t->n_samples; ++w->entered)
  {
    size_t n = l->n_samples;
    if (!AQR_RESERVE(c, l->samples, l->sample_capacity, n + 2) ||
        !AQR_RESERVE(c, l->segments, l->segment_capacity, l->n_segments + 1) || !aqr_face_map_reserve(c, &l->newest, 1))
      return AQR_OUT_OF_MEMORY;
    const aqr_sample* a = &t->samples[w->entered];
    l->samples[n] = a[0];
    l->samples[n + 1] = a[1];
    l->samples[n].arc = (float)(w->sign * w->arc);
    w->arc += v3_norm(v3_sub(a[1].p, a->p));
    l->samples[n + 1].arc = (float)(w->sign * w->arc);
    l->n_samples += 2;
    aqr_spot* spot = aqr_face_map_find(&l->newest, a->face);
    bool taken = aqr_face_map_has(&l->newest, spot);
    l->segments[l->n_segments] = (aqr_segment){ (aqr_index)n, AQR_OWN, taken ? spot->value : AQR_NONE };
    if (!taken)
      aqr_face_map_take(&l->newest, spot, a->face, 0);
    spot->value = (aqr_index)l->n_segments++;
  }
  return AQR_OK;
}

/* Steers to the sample of the growing line that its head has met, so that the line closes. The
 * samples before the one met are dropped. False where the way is blocked; the line then stays open.
 */
static aqr_status close_loop(aqr_context* c, aqr_grower* g, aqr_index met, double distance, bool* closed)
{
  aqr_tracer* t = &g->tracer;
  *closed = false;
  size_t m = met / 2 + 1; /* the draft's samples come in pairs: this is where that of the sample met ends */
  vec3 x = aqr_tracer_position(t), d = aqr_tracer_direction(t);
  while (m + 4 < t->n_samples && v3_dot(v3_sub(t->samples[m].p, x), d) < 2 * distance)
    m++;
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

static void begin_half(aqr_grower* g, double sign)
{
  vec3 seed = aqr_tracer_position(&g->tracer);
  g->half = (aqr_half){ .sign = sign, .densest = INFINITY, .seed = seed, .seen = seed, .end = AQR_END_LENGTH };
  g->tracer.n_kept = g->tracer.n_samples;
}

static void stop(aqr_grower* g, aqr_line_end end)
{
  g->half.end = end;
  g->half.stopped = true;
}

/* Stops the half where it is nearer than `distance` to a line of its family, its own included. */
static aqr_status look_around(aqr_context* c, aqr_grower* g, double distance)
{
  aqr_tracer* t = &g->tracer;
  aqr_status status = AQR_OK;
  aqr_near near;
  vec3 p, d;
  aqr_tracer_where(t, &p, &d);
  AQR_TRY(enter_draft(c, g));
  aqr_probe probe = { t->chart.face, p, d, distance, true, AQR_OWN, g->half.sign * t->travelled, &g->draft, 0,
    g->guesses };
  AQR_TRY(aqr_pcell_nearest(c, &g->cell, g->lines, &probe, &near));
  AQR_TRY(keep_look(c, g, &probe, near.line));
  if (near.line == AQR_NONE)
    goto done;
  stop(g, near.line == AQR_OWN ? AQR_END_SELF : AQR_END_PROXIMITY);
  if (near.line == AQR_OWN && g->half.sign > 0)
  {
    const aqr_sample* met = &g->draft.samples[near.sample];
    bool closed = false;
    if ((double)met->arc < loop_start * distance && v3_dot(v3_sub(met[1].p, met->p), d) > 0)
      AQR_TRY(close_loop(c, g, near.sample, near.distance, &closed));
    if (closed)
      g->half.end = AQR_END_LOOP;
  }
done:
  return status;
}

/* One step of the half along the field. */
static aqr_status grow_step(aqr_context* c, aqr_grower* g)
{
  aqr_half* w = &g->half;
  aqr_tracer* t = &g->tracer;
  const aqr_surface* s = g->surface;
  aqr_status status = AQR_OK;
  int i = w->steps++;
  if (i % 256 == 255)
    AQR_REQUIRE(aqr_step(c, 0), AQR_CANCELLED);
  double along, across;
  aqr_sizing_at(s, g->field, g->sizing, t->chart.face, aqr_tracer_direction(t), &along, &across);
  double scale = aqr_sizing_scale(s, g->sizing, t->chart.face);
  w->densest = lesser(w->densest, scale);
  double least = lesser(along, across);
  if (i == 0)
    w->step = longest_step * least;
  if (i % in_place == 0)
  {
    vec3 from = aqr_tracer_position(t);
    if (i && v3_norm(v3_sub(from, w->seen)) < least / 4)
    {
      stop(g, AQR_END_SELF);
      goto done;
    }
    w->seen = from;
  }
  aqr_advance result;
  AQR_TRY(aqr_tracer_step(c, t, &w->step, shortest_step * least, longest_step * least, &result));
  if (result == AQR_AT_BORDER)
  {
    aqr_index edge = t->n_samples ? t->samples[t->n_samples - 1].edge : AQR_NONE;
    stop(g, edge != AQR_NONE && aqr_is_seam(s, edge) ? AQR_END_FEATURE : AQR_END_BOUNDARY);
  }
  else if (t->travelled - w->queried >= query_every * stop_distance * greater(across, sqrt(along * across)))
  {
    w->queried = t->travelled;
    AQR_TRY(look_around(c, g, lesser(most_stop_distance, stop_distance * scale / w->densest) * across));
  }
done:
  return status;
}

/* Follows the field until the half must stop, or so many steps. */
static aqr_status grow_half(aqr_context* c, aqr_grower* g, int steps)
{
  const aqr_tracer* t = &g->tracer;
  aqr_status status = AQR_OK;
  /* a line with more crossings winds around something too thin for lines */
  const size_t most_samples = g->surface->n_faces + 1000;
  for (; steps > 0 && !g->half.stopped; steps--)
    if (g->half.steps < most_steps && t->travelled < longest_line && t->n_samples < most_samples && !t->lost)
      AQR_TRY(grow_step(c, g));
    else
      g->half.stopped = true;
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

/* Arc length, spacings passed, and the type its longest trusted part has. */
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
    e += fabs(v3_dot(d, v3_load(g->field->min_direction + 3 * (size_t)g->surface->corner[3 * face + i])));
  return e / 3 >= sqrt(0.5) ? AQR_LINE_MIN : AQR_LINE_MAX;
}

static void begin(aqr_grower* g, aqr_index face, vec3 direction)
{
  g->n_samples = 0;
  g->draft.n_samples = g->draft.n_segments = 0;
  aqr_face_map_clear(&g->draft.newest);
  memset(&g->line, 0, sizeof g->line);
  g->line.type = type_at(g, face, direction);
  g->line.partner[0] = g->line.partner[1] = AQR_NONE;
  g->ahead = true;
  g->grown = false;
  begin_half(g, 1);
}

void aqr_grow_start(aqr_grower* g, const aqr_place* at, vec3 direction)
{
  aqr_tracer_start(&g->tracer, at, direction);
  aqr_tracer_align(&g->tracer);
  g->at = *at;
  g->direction = aqr_tracer_direction(&g->tracer);
  begin(g, at->face, g->direction);
}

/* Stores the half that has stopped. */
static aqr_status end_half(aqr_context* c, aqr_grower* g)
{
  const aqr_tracer* t = &g->tracer;
  aqr_status status = AQR_OK;
  note_taken_back(g);
  g->line.ends[g->ahead] = (uint8_t)g->half.end;
  g->grown = !g->ahead || g->half.end == AQR_END_LOOP;
  if (!g->ahead)
    return AQR_OK;
  for (size_t i = 0; i < t->n_samples; i++)
    AQR_TRY(keep(c, g, &t->samples[i]));
  g->ahead = false;
  g->n_ahead = g->n_looks;
  if (g->half.end == AQR_END_LOOP)
  {
    g->line.closed = true;
    g->line.ends[0] = AQR_END_LOOP;
    goto done;
  }
  aqr_tracer_start(&g->tracer, &g->at, v3_scale(g->direction, -1));
  begin_half(g, -1);
done:
  return status;
}

aqr_status aqr_grow_on(aqr_context* c, aqr_grower* g, int steps)
{
  aqr_status status = AQR_OK;
  AQR_TRY(grow_half(c, g, steps));
  if (g->half.stopped)
    AQR_TRY(end_half(c, g));
done:
  return status;
}

/* Joins the halves. They meet in the seed's face; a line that leaves it twice over one edge does not pass it. */
static aqr_status join(aqr_context* c, aqr_grower* g)
{
  const aqr_tracer* t = &g->tracer;
  size_t drop = 0;
  while (drop < t->n_samples && drop < g->n_samples && t->samples[drop].edge == g->samples[drop].edge)
    drop++;
  size_t n = t->n_samples - drop, forward = g->n_samples - drop;
  if (!AQR_RESERVE(c, g->samples, g->capacity, n + forward))
    return AQR_OUT_OF_MEMORY;
  memmove(g->samples + n, g->samples + drop, forward * sizeof *g->samples);
  aqr_index seed_face = drop == 0 ? g->at.face : t->samples[drop - 1].face;
  for (size_t i = 0; i < n; i++)
  {
    aqr_sample a = t->samples[drop + n - 1 - i];
    a.face = i + 1 < n ? t->samples[drop + n - 2 - i].face : seed_face;
    g->samples[i] = a;
  }
  g->n_samples = n + forward;
  return AQR_OK;
}

aqr_status aqr_grow_finish(aqr_context* c, aqr_grower* g)
{
  aqr_status status = g->line.closed ? AQR_OK : join(c, g);
  if (g->n_samples > 1)
    g->samples[g->n_samples - 1].face = g->samples[g->n_samples - 2].face;
  describe(g);
  return status;
}

aqr_status aqr_grow_inside(aqr_context* c, aqr_grower* g, const aqr_place* at, vec3 direction)
{
  aqr_status status = AQR_OK;
  aqr_grow_start(g, at, direction);
  while (!g->grown)
    AQR_TRY(aqr_grow_on(c, g, most_steps));
  AQR_TRY(aqr_grow_finish(c, g));
done:
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
    while (!g->half.stopped)
      AQR_TRY(grow_half(c, g, most_steps));
    if (t->n_samples && t->samples[0].edge == edge && g->half.end != AQR_END_LOOP)
      for (size_t i = 0; i < t->n_samples; i++)
        AQR_TRY(keep(c, g, &t->samples[i]));
    if (g->n_samples > 1)
      g->samples[g->n_samples - 1].face = g->samples[g->n_samples - 2].face;
  }
  g->line.ends[0] = aqr_is_seam(s, h) ? AQR_END_FEATURE : AQR_END_BOUNDARY;
  g->line.ends[1] = (uint8_t)g->half.end;
done:
  describe(g);
  return status;
}
