/* SPDX-License-Identifier: BSD-3-Clause */
/* Paper 3 (line seeding) and 4.2. Lines are committed one by one; each committed line is a parent that is asked for
 * seeds of lines that cross it: wherever two neighbouring crossings along it are more than one and a half spacings
 * apart, evenly placed seeds fill the gap. When no parent has a gap left, places far from all lines get a seed of their
 * own. */
#include "sampling.h"

#include "growth.h"

#include <stdlib.h>
#include <string.h>

enum
{
  most_rounds = 8,
  most_seeds_per_line = 1 << 20,
  score_levels = 64,
  most_passes = 12,   /* at reaching the number of points asked for */
  most_on_edge = 8,   /* spacings along an edge of a chain, however small the tolerance */
  most_failures = 50, /* growths that come to nothing, per line kept ... */
  free_failures = 64, /* ... and these many lines more: the bound of the work along threads without area */
  most_excess = 8,    /* of points over those asked for, beyond one per face of the surface: the attempt is lost, and
                         what it may cost is bounded */
  most_left_out = 32, /* lines that would go too far beyond the points asked for, until these count as reached */
  most_in_vain = 2    /* faces crossed by growths that came to nothing, per face crossed by the lines kept and per
                         face of the surface: among spikes a growth can cross thousands */
};

static const double seed_distance = 0.6;  /* of the spacing: nearer than this to a line of its family no line begins */
static const double cover_distance = 0.8; /* of the spacing: a place farther than this from all lines gets a seed */
static const double least_length = 1.5;   /* spacings: a line shorter than this is not worth its two T-joints */
static const double least_turning_length = 6; /* the same for a line that meets itself at both ends */
static const double damping = 0.8;       /* of the step to the number of points asked for: what is overshot is lost */
static const double enough = 0.99;       /* of that number */
static const double most_over = 0.015;   /* of it, that one more line may go beyond */
static const double most_finer = 1.5;    /* than the sizing: beyond, its bounds would no longer hold */
static const double join_distance = 0.1; /* of the spacing: ends as near on either side of a seam are one crossing */
static const double node_distance =
  0.35; /* of the spacing: a line does not go on over a seam nearer to another's end */

/* Where another line crosses a line, or ends on a chain. */
typedef struct mark
{
  double sigma; /* position along the line, in spacings */
  aqr_index next;
} mark;

/* What is known of a line as a parent. */
typedef struct parent
{
  aqr_index newest; /* of its marks */
  aqr_index n_marks;
  aqr_index asked; /* one more than the marks it had when it was last asked for seeds; 0 before */
} parent;

typedef struct sampler
{
  aqr_context* c;
  const aqr_surface* s;
  const aqr_field* field;
  aqr_sizing* sizing;
  const aqr_sampling_options* options;
  aqr_lines* lines;
  aqr_grower grower;
  mark* marks;
  size_t n_marks, mark_capacity;
  parent* parents; /* per line */
  size_t n_parents, parent_capacity;
  double* places; /* marks of the parent being asked, in order */
  size_t n_places, place_capacity;
  size_t n_failed; /* growths that came to nothing */
  size_t in_vain;  /* faces that these crossed */
  size_t crossed;  /* faces that all growths before this one crossed */
  double points;   /* expected of the lines: their crossings, and on chains their ends or the chain's own spacing */
  double goal;     /* no further seeds once as many are expected */
  int left_out;    /* lines that would have gone too far beyond it */
} sampler;

/* ---- chains ---- */

static aqr_status add_parent(sampler* m)
{
  if (!AQR_RESERVE(m->c, m->parents, m->parent_capacity, m->n_parents + 1))
    return AQR_OUT_OF_MEMORY;
  m->parents[m->n_parents++] = (parent){ AQR_NONE, 0, 0 };
  return AQR_OK;
}

/* Curvature of a chain at its i-th sample as seen at the scale `w`: of the circle through three of its points. */
static double chain_curvature(const aqr_sample* a, size_t n, size_t i, double w)
{
  size_t j = i, k = i;
  while (j > 0 && (double)(a[i].arc - a[j].arc) < w)
    j--;
  while (k + 1 < n && (double)(a[k].arc - a[i].arc) < w)
    k++;
  vec3 u = v3_sub(a[i].p, a[j].p), v = v3_sub(a[k].p, a[i].p), e = v3_sub(a[k].p, a[j].p);
  double area = v3_norm(v3_cross(u, v)), product = v3_norm(u) * v3_norm(v) * v3_norm(e);
  return product > 0 ? 2 * area / product : 0;
}

static aqr_status add_chain(sampler* m, const aqr_chains* chains, const aqr_chain* chain)
{
  const aqr_surface* s = m->s;
  size_t n = chain->count + 1;
  aqr_sample* a = AQR_NEW0(m->c, aqr_sample, n);
  if (!a)
    return AQR_OUT_OF_MEMORY;
  for (size_t i = 0; i < n; i++)
  {
    aqr_index h = chains->half_edges[chain->first + (i + 1 < n ? i : i - 1)];
    a[i].p = aqr_point(s, i + 1 < n ? aqr_from(s, h) : aqr_to(s, h));
    a[i].edge = h;
    a[i].face = aqr_face_of(h);
    if (i > 0)
      a[i].arc = a[i - 1].arc + (float)v3_norm(v3_sub(a[i].p, a[i - 1].p));
  }
  double sigma = 0;
  for (size_t i = 0; i + 1 < n; i++)
  {
    vec3 d = v3_sub(a[i + 1].p, a[i].p);
    double length = v3_norm(d), along, across;
    aqr_sizing_at(s, m->field, m->sizing, a[i].face, v3_unit(d), &along, &across);
    aqr_index other = aqr_any_twin(s, a[i].edge);
    if (other != AQR_NONE)
    {
      double there;
      aqr_sizing_at(s, m->field, m->sizing, aqr_face_of(other), v3_unit(d), &there, &across);
      along = fmin(along, there);
    }
    if (chain->is_feature || m->options->boundary_lines)
    {
      double k = chain_curvature(a, n, i, along / 2), e = m->options->tolerance;
      if (k > 0 && 2 / k > e)
        along = fmin(along, 2 * sqrt(e * (2 / k - e)));
    }
    a[i].sigma = (float)sigma;
    sigma += length / fmax(along, length / most_on_edge);
  }
  a[n - 1].sigma = (float)sigma;
  aqr_line line = { .count = n,
    .type = chain->is_feature ? AQR_LINE_FEATURE : AQR_LINE_BOUNDARY,
    .ends = { AQR_END_CORNER, AQR_END_CORNER },
    .closed = chain->closed,
    .is_chain = true,
    .partner = { AQR_NONE, AQR_NONE } };
  if (chain->closed)
    line.ends[0] = line.ends[1] = AQR_END_LOOP;
  aqr_status status = aqr_lines_add(m->c, m->lines, s, &line, a);
  AQR_DROP(m->c, a, n);
  return status == AQR_OK ? add_parent(m) : status;
}

/* The chain line and the position on it, in spacings, of a point on a boundary or seam edge. */
static bool on_chain(const sampler* m, const aqr_sample* at, aqr_index* chain, double* sigma)
{
  const aqr_lines* l = m->lines;
  aqr_index other = aqr_any_twin(m->s, at->edge);
  for (aqr_index k = l->head[aqr_face_of(at->edge)]; k != AQR_NONE; k = l->segments[k].next)
  {
    aqr_index n = l->segments[k].sample;
    const aqr_sample* a = &l->samples[n];
    if (!l->lines[l->segments[k].line].is_chain || (a->edge != at->edge && a->edge != other))
      continue;
    double t = a->edge == at->edge ? at->t : 1 - at->t;
    *chain = l->segments[k].line;
    *sigma = (double)a->sigma + t * (double)(a[1].sigma - a->sigma);
    return true;
  }
  return false;
}

/* ---- marks ---- */

static double points_on(const sampler* m, aqr_index id)
{
  const aqr_line* line = &m->lines->lines[id];
  double marks = m->parents[id].n_marks, own = (double)m->lines->samples[line->first + line->count - 1].sigma;
  return line->is_chain ? fmax(marks, own) : marks / 2; /* a crossing is marked on both its lines */
}

static aqr_status add_mark(sampler* m, aqr_index line, double sigma)
{
  if (!AQR_RESERVE(m->c, m->marks, m->mark_capacity, m->n_marks + 1))
    return AQR_OUT_OF_MEMORY;
  m->marks[m->n_marks] = (mark){ sigma, m->parents[line].newest };
  m->parents[line].newest = (aqr_index)m->n_marks++;
  m->points -= points_on(m, line);
  m->parents[line].n_marks++;
  m->points += points_on(m, line);
  return AQR_OK;
}

/* Marks the chain that a line ends on. */
static aqr_status land(sampler* m, const aqr_sample* at)
{
  aqr_index chain;
  double sigma;
  return on_chain(m, at, &chain, &sigma) ? add_mark(m, chain, sigma) : AQR_OK;
}

/* How far along the chord from a the chord from b crosses it: the ratio of a's distances from b's line. */
static double crossing_at(const aqr_sample* a, const aqr_sample* b)
{
  vec3 d = v3_sub(a[1].p, a->p), e = v3_sub(b[1].p, b->p);
  vec3 u = v3_cross(e, v3_sub(a->p, b->p)), v = v3_cross(e, d);
  double n = v3_norm2(v), t = n > 0 ? fmin(1, fmax(0, -v3_dot(u, v) / n)) : 0.5;
  return (double)a->sigma + t * (double)(a[1].sigma - a->sigma);
}

/* Marks a new line and those it crosses. Every segment is listed already, so pairs within the line are met twice. */
static aqr_status mark_crossings(sampler* m, aqr_index id)
{
  const aqr_lines* l = m->lines;
  const aqr_line* line = &l->lines[id];
  aqr_status status = AQR_OK;
  for (size_t i = line->first; i + 1 < line->first + line->count; i++)
  {
    const aqr_sample* a = &l->samples[i];
    for (aqr_index k = l->head[a->face]; k != AQR_NONE; k = l->segments[k].next)
    {
      aqr_index other = l->segments[k].line;
      const aqr_sample* b = &l->samples[l->segments[k].sample];
      if (l->lines[other].is_chain || b == a || !aqr_chords_cross(m->s, a->face, a, a + 1, b, b + 1))
        continue;
      AQR_TRY(add_mark(m, id, crossing_at(a, b)));
      if (other != id)
        AQR_TRY(add_mark(m, other, crossing_at(b, a)));
    }
  }
done:
  return status;
}

/* ---- growing and committing ---- */

/* Whether no further line is wanted. */
static bool is_full(const sampler* m)
{
  return m->points >= m->goal || m->left_out >= most_left_out;
}

/* Whether the grown line, not yet added, goes too far beyond the goal: one that winds along a tube can give half of all
 * points. Shorter ones may still fit. */
static bool is_too_much(const sampler* m)
{
  const aqr_lines* l = m->lines;
  const aqr_line* line = &m->grower.line;
  const aqr_sample* a = m->grower.samples;
  const double most = (1 + most_over) * m->goal - m->points;
  double added = 0;
  if (!isfinite(most) || 2 * (double)a[line->count - 1].sigma < most) /* crossings are a spacing apart, seldom half */
    return false;
  for (size_t i = 0; i + 1 < line->count && added <= most; i++)
    for (aqr_index k = l->head[a[i].face]; k != AQR_NONE; k = l->segments[k].next)
    {
      const aqr_sample* b = &l->samples[l->segments[k].sample];
      added += !l->lines[l->segments[k].line].is_chain && aqr_chords_cross(m->s, a[i].face, &a[i], &a[i + 1], b, b + 1);
    }
  return added > most;
}

static bool on_border(uint8_t end)
{
  return end == AQR_END_BOUNDARY || end == AQR_END_FEATURE;
}

/* Whether a grown line is worth keeping: long enough, or spanning from chain to chain, or closed. */
static bool worth_keeping(const aqr_line* line, const aqr_sample* samples)
{
  if (line->count < 2)
    return false;
  if (on_border(line->ends[0]) && on_border(line->ends[1]))
    return true;
  if (line->closed) /* around something larger than the spacing, not winding about a spike */
    return samples[line->count - 1].sigma > 1;
  bool turns = line->ends[0] == AQR_END_SELF && line->ends[1] == AQR_END_SELF; /* in place, if it is short */
  return (double)samples[line->count - 1].sigma > (turns ? least_turning_length : least_length);
}

/* An end of a line. */
typedef struct line_end
{
  aqr_index line, sample; /* AQR_NONE: there is none */
  unsigned end;
} line_end;

/* The end on the other side of a seam that a grown line's end there is joined to: the nearest one that nothing goes on
 * from, unless it is far away. Around a bar the last line of a ring comes from behind to where the first one began. */
static line_end opposite_end(const sampler* m, const aqr_sample* at, vec3 d)
{
  const aqr_surface* s = m->s;
  const aqr_lines* l = m->lines;
  line_end found = { AQR_NONE, AQR_NONE, 0 };
  aqr_index other = aqr_any_twin(s, aqr_sample_half_edge(s, at, at->face));
  double along, across;
  aqr_sizing_at(s, m->field, m->sizing, at->face, v3_unit(d), &along, &across);
  double nearest = join_distance * across;
  for (aqr_index k = l->head[aqr_face_of(other)]; k != AQR_NONE; k = l->segments[k].next)
  {
    const aqr_line* line = &l->lines[l->segments[k].line];
    for (unsigned i = 0; i < 2; i++)
    {
      size_t end = line->first + (i ? line->count - 1 : 0);
      const aqr_sample* a = &l->samples[end];
      bool is_here = l->segments[k].sample + i == end && a->edge == at->edge && line->ends[i] == AQR_END_FEATURE;
      double distance = v3_norm(v3_sub(a->p, at->p));
      if (!is_here || line->partner[i] != AQR_NONE || !(distance < nearest))
        continue;
      nearest = distance;
      found = (line_end){ l->segments[k].line, (aqr_index)end, i };
    }
  }
  return found;
}

/* Joins the free ends of the grown line, the next one to be added, to ends that they meet. */
static void join_ends(sampler* m)
{
  aqr_line* line = &m->grower.line;
  const aqr_sample* a = m->grower.samples;
  for (unsigned i = 0; i < 2; i++)
  {
    size_t end = i ? line->count - 1 : 0, before = i ? end - 1 : 1;
    if (line->ends[i] != AQR_END_FEATURE || line->partner[i] != AQR_NONE)
      continue;
    line_end met = opposite_end(m, &a[end], v3_sub(a[end].p, a[before].p));
    line->partner[i] = met.sample;
    if (met.line != AQR_NONE)
      m->lines->lines[met.line].partner[met.end] = (aqr_index)(m->lines->n_samples + end);
  }
}

/* Commits the grower's line; *id is AQR_NONE where it was not worth keeping. */
static aqr_status commit(sampler* m, aqr_index partner, aqr_index* id)
{
  aqr_grower* g = &m->grower;
  size_t crossed = g->tracer.crossed - m->crossed;
  m->crossed = g->tracer.crossed;
  *id = AQR_NONE;
  if (!worth_keeping(&g->line, g->samples))
  {
    m->n_failed++;
    m->in_vain += crossed;
    return AQR_OK;
  }
  if (is_too_much(m))
  {
    m->left_out++;
    m->in_vain += crossed;
    return AQR_OK;
  }
  *id = (aqr_index)m->lines->n_lines;
  g->line.partner[0] = partner;
  join_ends(m);
  aqr_status status = aqr_lines_add(m->c, m->lines, m->s, &g->line, g->samples);
  if (status == AQR_OK)
    status = add_parent(m);
  if (status == AQR_OK)
    status = mark_crossings(m, *id);
  for (unsigned i = 0; i < 2 && status == AQR_OK; i++)
    if (on_border(g->line.ends[i]) && g->line.partner[i] == AQR_NONE)
      status = land(m, &g->samples[i ? g->line.count - 1 : 0]);
  return status;
}

/* A line that has reached a seam goes on from the same point on the other side, unless a line is too near there. */
static aqr_status cross_seam(sampler* m, aqr_index sample, aqr_index* id)
{
  const aqr_surface* s = m->s;
  const aqr_sample a = m->lines->samples[sample];
  aqr_index here = aqr_sample_half_edge(s, &a, a.face), h = aqr_any_twin(s, here);
  *id = AQR_NONE;
  if (h == AQR_NONE)
    return AQR_OK;
  double t = h == a.edge ? a.t : 1 - a.t;
  vec3 e = v3_unit(v3_sub(aqr_point(s, aqr_to(s, h)), aqr_point(s, aqr_from(s, h))));
  vec3 inward = v3_cross(v3_unit(aqr_face_cross(s, aqr_face_of(h))), e);
  double along, across;
  bool allowed;
  aqr_sizing_at(s, m->field, m->sizing, aqr_face_of(h), inward, &along, &across);
  aqr_status status = aqr_grow_allowed(m->c, &m->grower, aqr_face_of(h), a.p, inward, node_distance * across, &allowed);
  if (status != AQR_OK || !allowed)
    return status;
  status = aqr_grow_from_border(m->c, &m->grower, h, t, inward);
  return status == AQR_OK ? commit(m, sample, id) : status;
}

/* Continues line `from` over the seams at its ends, and the continuations over theirs. */
static aqr_status cross_seams(sampler* m, aqr_index from)
{
  for (aqr_index id = from; id < m->lines->n_lines; id++)
    for (unsigned i = 0; i < 2; i++)
    {
      const aqr_line* line = &m->lines->lines[id];
      if (line->ends[i] != AQR_END_FEATURE || line->partner[i] != AQR_NONE)
        continue;
      aqr_index sample = (aqr_index)(line->first + (i ? line->count - 1 : 0)), next;
      aqr_status status = cross_seam(m, sample, &next);
      if (status != AQR_OK)
        return status;
      if (next != AQR_NONE)
        m->lines->lines[id].partner[i] = (aqr_index)m->lines->lines[next].first;
    }
  return AQR_OK;
}

/* Whether enough has been tried: nothing more will come of it that is worth the work. */
static bool gives_up(const sampler* m)
{
  size_t kept = m->crossed - m->in_vain;
  return m->n_failed > most_failures * (m->lines->n_lines + free_failures) ||
         m->in_vain > most_in_vain * (kept + m->s->n_faces);
}

/* A seed inside face f, for a line along `d`, at least `distance` from its family. */
static aqr_status seed_inside(sampler* m, aqr_index f, vec3 p, vec3 d, double distance)
{
  bool allowed;
  aqr_index id = AQR_NONE;
  if (is_full(m) || gives_up(m))
    return AQR_OK;
  aqr_status status = aqr_grow_allowed(m->c, &m->grower, f, p, d, distance, &allowed);
  if (status != AQR_OK || !allowed)
    return status;
  const aqr_surface* s = m->s;
  aqr_place at = { f, { 0, 0, 0 } };
  vec3 n = aqr_face_cross(s, f);
  double sum = 0;
  for (unsigned i = 0; i < 3; i++)
  {
    vec3 a = aqr_point(s, s->corner[3 * f + (i + 1) % 3]), b = aqr_point(s, s->corner[3 * f + (i + 2) % 3]);
    at.bary[i] = fmax(1e-6, v3_dot(n, v3_cross(v3_sub(a, p), v3_sub(b, p))));
    sum += at.bary[i];
  }
  for (unsigned i = 0; i < 3; i++)
    at.bary[i] = sum > 0 ? at.bary[i] / sum : 1.0 / 3;
  status = aqr_grow_inside(m->c, &m->grower, &at, d);
  if (status == AQR_OK)
    status = commit(m, AQR_NONE, &id);
  return status == AQR_OK && id != AQR_NONE ? cross_seams(m, id) : status;
}

/* Seeds to one or both sides of a chain. */
static aqr_status seed_on_chain(sampler* m, aqr_index h, double t, double distance)
{
  const aqr_surface* s = m->s;
  for (unsigned side = 0; side < 2 && !is_full(m); side++)
  {
    aqr_index k = side ? aqr_any_twin(s, h) : h;
    if (k == AQR_NONE)
      break;
    vec3 e = v3_unit(v3_sub(aqr_point(s, aqr_to(s, k)), aqr_point(s, aqr_from(s, k))));
    vec3 inward = v3_cross(v3_unit(aqr_face_cross(s, aqr_face_of(k))), e);
    vec3 p = aqr_edge_point(s, k, side ? 1 - t : t);
    bool allowed;
    aqr_index id;
    aqr_status status = aqr_grow_allowed(m->c, &m->grower, aqr_face_of(k), p, inward, distance, &allowed);
    if (status == AQR_OK && allowed)
    {
      status = aqr_grow_from_border(m->c, &m->grower, k, side ? 1 - t : t, inward);
      if (status == AQR_OK)
        status = commit(m, AQR_NONE, &id);
      if (status == AQR_OK && id != AQR_NONE)
      {
        /* its first end lies on the chain: the other side goes on from there */
        return cross_seams(m, id);
      }
    }
    if (status != AQR_OK)
      return status;
  }
  return AQR_OK;
}

/* ---- gaps along a parent ---- */

static aqr_status add_place(sampler* m, double sigma)
{
  if (!AQR_RESERVE(m->c, m->places, m->place_capacity, m->n_places + 1))
    return AQR_OUT_OF_MEMORY;
  m->places[m->n_places++] = sigma;
  return AQR_OK;
}

static int by_value(const void* a, const void* b)
{
  double x = *(const double*)a, y = *(const double*)b;
  return (x > y) - (x < y);
}

static aqr_status seed_at(sampler* m, aqr_index parent, double sigma)
{
  const aqr_line line = m->lines->lines[parent];
  size_t low = line.first, high = line.first + line.count - 1;
  while (high - low > 1)
  {
    size_t middle = (low + high) / 2;
    if ((double)m->lines->samples[middle].sigma <= sigma)
      low = middle;
    else
      high = middle;
  }
  const aqr_sample a = m->lines->samples[low], b = m->lines->samples[low + 1];
  double span = (double)(b.sigma - a.sigma), t = span > 0 ? (sigma - (double)a.sigma) / span : 0.5;
  t = fmin(1 - 1e-3, fmax(1e-3, t));
  vec3 d = v3_sub(b.p, a.p), p = v3_madd(a.p, t, d);
  double along = span > 0 ? v3_norm(d) / span : 0;
  if (line.is_chain)
    return seed_on_chain(m, a.edge, t, seed_distance * along);
  vec3 n = v3_unit(aqr_face_cross(m->s, a.face));
  return seed_inside(m, a.face, p, v3_unit(v3_cross(n, d)), seed_distance * along);
}

/* The places along a parent that bound its gaps, in order: its marks, and its ends where they lie on borders. */
static aqr_status collect_places(sampler* m, aqr_index id)
{
  const aqr_line line = m->lines->lines[id];
  double end = (double)m->lines->samples[line.first + line.count - 1].sigma;
  aqr_status status = AQR_OK;
  m->n_places = 0;
  for (aqr_index k = m->parents[id].newest; k != AQR_NONE; k = m->marks[k].next)
    AQR_TRY(add_place(m, m->marks[k].sigma));
  if (!line.closed && (line.is_chain || on_border(line.ends[0])))
    AQR_TRY(add_place(m, 0));
  if (!line.closed && (line.is_chain || on_border(line.ends[1])))
    AQR_TRY(add_place(m, end));
  if (m->n_places)
    qsort(m->places, m->n_places, sizeof *m->places, by_value);
  if (line.closed && m->n_places)
    AQR_TRY(add_place(m, m->places[0] + end)); /* around the seam of the loop */
done:
  return status;
}

/* Fills the gaps of one parent with seeds. Lines only come, so what was refused with the same marks is refused again.
 */
static aqr_status ask_parent(sampler* m, aqr_index id)
{
  const aqr_line line = m->lines->lines[id];
  double end = (double)m->lines->samples[line.first + line.count - 1].sigma;
  aqr_status status = AQR_OK;
  if (is_full(m) || m->parents[id].asked == m->parents[id].n_marks + 1)
    return AQR_OK;
  m->parents[id].asked = m->parents[id].n_marks + 1;
  AQR_TRY(collect_places(m, id));
  if (m->n_places == 0)
  {
    /* no neighbour yet: whole spacings from the middle outwards */
    for (int i = 0; i <= end / 2 && i < most_seeds_per_line; i++)
      for (int side = i ? -1 : 1; side <= 1; side += 2)
        if (end / 2 + side * i > 0 && end / 2 + side * i < end)
          AQR_TRY(seed_at(m, id, end / 2 + side * i));
    return AQR_OK;
  }
  double first = m->places[0], last = m->places[m->n_places - 1];
  for (size_t i = 0; i + 1 < m->n_places; i++)
  {
    double a = m->places[i], gap = m->places[i + 1] - a;
    int pieces = (int)fmin(floor(gap + 0.5), most_seeds_per_line);
    for (int k = 1; k < pieces; k++)
    {
      double at = a + gap * k / pieces;
      AQR_TRY(seed_at(m, id, at > end ? at - end : at));
    }
  }
  if (!line.closed)
  {
    for (int k = 1; first - k > 0.25 && k < most_seeds_per_line; k++)
      AQR_TRY(seed_at(m, id, first - k));
    for (int k = 1; last + k < end - 0.25 && k < most_seeds_per_line; k++)
      AQR_TRY(seed_at(m, id, last + k));
  }
done:
  return status;
}

/* Asks every line from `first` on for seeds, old ones first, until a whole round brings none. */
static aqr_status fill_gaps(sampler* m, size_t first)
{
  aqr_status status = AQR_OK;
  for (int round = 0; round < most_rounds; round++)
  {
    size_t before = m->lines->n_lines;
    for (size_t i = first; i < m->lines->n_lines; i++)
    {
      if (i % 16 == 0)
        AQR_REQUIRE(aqr_step(m->c, 0.9 * (double)i / (double)m->lines->n_lines), AQR_CANCELLED);
      AQR_TRY(ask_parent(m, (aqr_index)i));
    }
    if (m->lines->n_lines == before)
      break;
  }
done:
  return status;
}

/* ---- as many points as asked for ---- */

static void count_points(sampler* m)
{
  m->points = 0;
  for (size_t i = 0; i < m->lines->n_lines; i++)
    m->points += points_on(m, (aqr_index)i);
}

/* Makes the spacing smaller everywhere; positions along lines are in spacings and grow. */
static void shrink_spacing(sampler* m, double factor)
{
  aqr_lines* l = m->lines;
  float up = (float)factor, down = (float)(1 / factor);
  for (size_t i = 0; i < 2 * m->sizing->n_points; i++)
    m->sizing->spacing[i] *= down;
  for (size_t i = 0; i < l->n_samples; i++)
    l->samples[i].sigma *= up;
  for (size_t i = 0; i < m->n_marks; i++)
    m->marks[i].sigma *= factor;
  for (size_t i = 0; i < m->n_parents; i++)
    m->parents[i].asked = 0;
  count_points(m);
}

/* Shrinks the spacing until the lines give the points asked for: the widest gaps are filled first, and no line is
 * traced twice. */
static aqr_status reach_points(sampler* m, double points, double* finer)
{
  aqr_status status = AQR_OK;
  m->goal = points;
  for (int i = 0; i < most_passes && m->points < enough * points && !is_full(m); i++)
  {
    double factor = fmin(most_finer / *finer, pow(points / fmax(1, m->points), damping / 2));
    if (factor <= 1)
      break;
    *finer *= factor;
    shrink_spacing(m, factor);
    AQR_TRY(fill_gaps(m, 0));
  }
done:
  return status;
}

/* ---- seeds where there are no lines ---- */

/* How good a place face f is for a first seed: confidence times relative anisotropy (paper 3 and 4.1), in levels. */
static int level(const sampler* m, aqr_index f)
{
  double a = 0;
  for (unsigned i = 0; i < 3; i++)
  {
    size_t v = m->s->corner[3 * f + i];
    double p = fabs(m->field->k_min[v]), q = fabs(m->field->k_max[v]), sum = p + q;
    double strength = sum / (sum + 1); /* of a curvature radius against the diagonal */
    a += sum > 0 ? fabs(m->field->k_max[v] - m->field->k_min[v]) / sum * strength : 0;
  }
  double confidence = (double)m->field->face_confidence[f];
  double score = confidence >= m->options->min_cosine ? confidence * a / 3 : 0;
  int l = (int)(fmin(1, fmax(0, score)) * (score_levels - 1));
  return score_levels - 1 - l;
}

static uint32_t scramble(uint32_t x)
{
  x ^= x >> 16;
  x *= 0x7feb352du;
  x ^= x >> 15;
  x *= 0x846ca68bu;
  x ^= x >> 16;
  return x;
}

/* Faces in order of their level, those of one level in a fixed random order. */
static aqr_status order_faces(sampler* m, aqr_index* order)
{
  aqr_context* c = m->c;
  size_t n = m->s->n_faces, count[score_levels + 1] = { 0 };
  uint8_t* of = AQR_NEW(c, uint8_t, n);
  if (!of)
    return AQR_OUT_OF_MEMORY;
  for (aqr_index f = 0; f < n; f++)
  {
    of[f] = (uint8_t)level(m, f);
    count[of[f] + 1]++;
  }
  for (int l = 0; l < score_levels; l++)
    count[l + 1] += count[l];
  size_t start[score_levels];
  memcpy(start, count, sizeof start);
  for (aqr_index f = 0; f < n; f++)
    order[start[of[f]]++] = f;
  for (int l = 0; l < score_levels; l++)
    for (size_t i = count[l + 1]; i > count[l] + 1; i--)
    {
      size_t j = count[l] + scramble((uint32_t)i + m->options->seed * 0x9e3779b9u) % (i - count[l]);
      aqr_index f = order[i - 1];
      order[i - 1] = order[j];
      order[j] = f;
    }
  AQR_DROP(c, of, n);
  return AQR_OK;
}

/* Marks the faces connected to f whose centre is within `distance`: no seed of the same round is needed there. */
static aqr_status cover(sampler* m, uint8_t* covered, aqr_index** stack, size_t* capacity, aqr_index f, double distance)
{
  const aqr_surface* s = m->s;
  vec3 p = aqr_point(s, s->corner[3 * f]);
  size_t n = 0;
  covered[f] = 1;
  if (!AQR_RESERVE(m->c, *stack, *capacity, 1))
    return AQR_OUT_OF_MEMORY;
  (*stack)[n++] = f;
  while (n)
  {
    aqr_index g = (*stack)[--n];
    for (unsigned i = 0; i < 3; i++)
    {
      aqr_index t = aqr_twin(s, 3 * g + i);
      if (t == AQR_NONE || covered[aqr_face_of(t)] ||
          v3_norm2(v3_sub(aqr_point(s, aqr_from(s, t)), p)) > distance * distance)
        continue;
      covered[aqr_face_of(t)] = 1;
      if (!AQR_RESERVE(m->c, *stack, *capacity, n + 1))
        return AQR_OUT_OF_MEMORY;
      (*stack)[n++] = aqr_face_of(t);
    }
  }
  return AQR_OK;
}

/* Seeds both families at every face, best first, that is far from all lines of the family; each seed's line is a parent
 * at once, so that the first seed of a component covers it. */
static aqr_status cover_surface(sampler* m)
{
  aqr_context* c = m->c;
  const aqr_surface* s = m->s;
  aqr_status status = AQR_OK;
  size_t capacity = 0;
  aqr_index* stack = NULL;
  aqr_index* order = AQR_NEW(c, aqr_index, s->n_faces);
  uint8_t* covered = AQR_NEW0(c, uint8_t, s->n_faces);
  AQR_REQUIRE(order && covered, AQR_OUT_OF_MEMORY);
  AQR_TRY(order_faces(m, order));
  for (size_t i = 0; i < s->n_faces; i++)
  {
    aqr_index f = order[i];
    if (covered[f])
      continue;
    if (i % 256 == 0)
      AQR_REQUIRE(aqr_step(c, 0.9 * (double)i / (double)s->n_faces), AQR_CANCELLED);
    vec3 n = v3_unit(aqr_face_cross(s, f));
    vec3 d = v3_load(m->field->cross + 3 * (size_t)s->corner[3 * f]);
    vec3 p = { 0, 0, 0 };
    for (unsigned k = 0; k < 3; k++)
      p = v3_madd(p, 1.0 / 3, aqr_point(s, s->corner[3 * f + k]));
    double along, across;
    aqr_sizing_at(s, m->field, m->sizing, f, d, &along, &across);
    size_t before = m->lines->n_lines;
    AQR_TRY(seed_inside(m, f, p, d, cover_distance * across));
    AQR_TRY(seed_inside(m, f, p, v3_cross(n, d), cover_distance * along));
    AQR_TRY(cover(m, covered, &stack, &capacity, f, 0.5 * fmin(along, across)));
    if (m->lines->n_lines > before)
      AQR_TRY(fill_gaps(m, before));
  }
done:
  AQR_DROP(c, order, s->n_faces);
  AQR_DROP(c, covered, s->n_faces);
  AQR_DROP(c, stack, capacity);
  return status;
}

aqr_status aqr_sample_lines(aqr_context* c, const aqr_surface* s, const aqr_field* field, aqr_sizing* sizing,
  const aqr_chains* chains, const aqr_sampling_options* options, aqr_lines* lines, aqr_reached* r, aqr_report* report)
{
  sampler m = {
    .c = c, .s = s, .field = field, .sizing = sizing, .options = options, .lines = lines, .goal = INFINITY
  };
  *r = (aqr_reached){ 1, 0 };
  aqr_status status = aqr_lines_init(c, s, lines);
  if (status != AQR_OK)
    return status;
  AQR_TRY(aqr_grower_init(c, s, field, sizing, lines, &m.grower));
  for (size_t i = 0; i < chains->n_chains; i++)
    AQR_TRY(add_chain(&m, chains, &chains->chains[i]));
  count_points(&m);
  if (options->points > 0)
    m.goal = m.points + most_excess * options->points + (double)s->n_faces;
  AQR_TRY(fill_gaps(&m, 0));
  AQR_TRY(cover_surface(&m));
  AQR_TRY(fill_gaps(&m, 0));
  if (options->points > 0)
    AQR_TRY(reach_points(&m, options->points, &r->finer));
  r->points = m.points;
  report->lines = lines->n_lines;
  report->line_samples = lines->n_samples;
  report->proximity_queries += m.grower.cell.queries;
  report->faces_crossed += m.crossed;
done:
  aqr_grower_free(c, &m.grower);
  AQR_DROP(c, m.marks, m.mark_capacity);
  AQR_DROP(c, m.parents, m.parent_capacity);
  AQR_DROP(c, m.places, m.place_capacity);
  if (status != AQR_OK)
    aqr_lines_free(c, lines);
  return status;
}
