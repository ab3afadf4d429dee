/* SPDX-License-Identifier: BSD-3-Clause */
/* Lines from seeds: grown, judged, committed with the marks of their crossings, and led on over seams. */
#include "closest.h"
#include "sampler.h"

enum
{
  most_of_speck = 12, /* faces */
  most_on_edge = 8,   /* spacings along an edge of a chain, however small the tolerance */
  most_failures = 50, /* growths that come to nothing, per line kept ... */
  free_failures = 64, /* ... and these many lines more: the bound of the work along threads without area */
  most_in_vain = 2    /* faces crossed by growths that came to nothing, per face crossed by the lines kept and per
                         face of the surface: among spikes a growth can cross thousands */
};

static const double least_length = 1.5;       /* spacings: a line shorter than this is not worth its two T-joints */
static const double least_turning_length = 6; /* the same for a line that meets itself at both ends */
static const double most_over = 0.015;        /* of the points asked for, that one more line may go beyond */
static const double join_distance = 0.1; /* of the spacing: ends as near on either side of a seam are one crossing */
static const double node_distance =
  0.35; /* of the spacing: a line does not go on over a seam nearer to another's end */

/* ---- chains ---- */

static aqr_status add_parent(aqr_sampler* m)
{
  if (!AQR_RESERVE(m->c, m->parents, m->parent_capacity, m->n_parents + 1))
    return AQR_OUT_OF_MEMORY;
  m->parents[m->n_parents++] = (aqr_line_parent){ AQR_NONE, 0, 0 };
  return AQR_OK;
}

/* The nearest samples before and after the i-th of a chain that are w away along it, or its ends: halved, since a fine
 * border can have most of its samples within w. */
static void find_window(const aqr_sample* a, size_t n, size_t i, double w, size_t* before, size_t* after)
{
  size_t low = 0, high = i;
  while (low < high)
  {
    size_t middle = (low + high + 1) / 2;
    if ((double)(a[i].arc - a[middle].arc) < w)
      high = middle - 1;
    else
      low = middle;
  }
  *before = low;
  low = i;
  high = n - 1;
  while (low < high)
  {
    size_t middle = (low + high) / 2;
    if ((double)(a[middle].arc - a[i].arc) < w)
      low = middle + 1;
    else
      high = middle;
  }
  *after = low;
}

/* Curvature of a chain at its i-th sample as seen at the scale `w`: of the circle through three of its points. */
static double chain_curvature(const aqr_sample* a, size_t n, size_t i, double w)
{
  size_t j, k;
  find_window(a, n, i, w, &j, &k);
  vec3 u = v3_sub(a[i].p, a[j].p), v = v3_sub(a[k].p, a[i].p), e = v3_sub(a[k].p, a[j].p);
  double area = v3_norm(v3_cross(u, v)), product = v3_norm(u) * v3_norm(v) * v3_norm(e);
  return product > 0 ? 2 * area / product : 0;
}

aqr_status aqr_sample_chain(aqr_sampler* m, const aqr_chains* chains, const aqr_chain* chain)
{
  const aqr_surface* s = m->s;
  size_t n = chain->count + 1;
  aqr_status status = AQR_OK;
  aqr_sample* a = AQR_NEW0(m->c, aqr_sample, n);
  AQR_REQUIRE(a, AQR_OUT_OF_MEMORY);
  for (size_t i = 0; i < n; i++)
  {
    AQR_REQUIRE(aqr_worked(m->c, 4), AQR_CANCELLED);
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
    AQR_REQUIRE(aqr_worked(m->c, 16), AQR_CANCELLED);
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
  AQR_TRY(aqr_lines_add(m->c, m->lines, s, &line, a));
  AQR_TRY(add_parent(m));
done:
  AQR_DROP(m->c, a, n);
  return status;
}

/* ---- marks ---- */

double aqr_points_on(const aqr_sampler* m, aqr_index id)
{
  const aqr_line* line = &m->lines->lines[id];
  double marks = m->parents[id].n_marks, own = (double)m->lines->samples[line->first + line->count - 1].sigma;
  return line->is_chain ? fmax(marks, own) : marks / 2; /* a crossing is marked on both its lines */
}

static aqr_status add_mark(aqr_sampler* m, aqr_index line, double sigma)
{
  if (!AQR_RESERVE(m->c, m->marks, m->mark_capacity, m->n_marks + 1))
    return AQR_OUT_OF_MEMORY;
  m->marks[m->n_marks] = (aqr_line_mark){ sigma, m->parents[line].newest };
  m->parents[line].newest = (aqr_index)m->n_marks++;
  m->points -= aqr_points_on(m, line);
  m->parents[line].n_marks++;
  m->points += aqr_points_on(m, line);
  return AQR_OK;
}

/* Marks the chain that a line ends on. */
static aqr_status land(aqr_sampler* m, const aqr_sample* at)
{
  aqr_index n = aqr_chain_at(m->s, m->lines, at);
  if (n == AQR_NONE)
    return AQR_OK;
  const aqr_sample* a = &m->lines->samples[n];
  double t = a->edge == at->edge ? at->t : 1 - at->t;
  return add_mark(m, a->line, (double)a->sigma + t * (double)(a[1].sigma - a->sigma));
}

/* How far along the chord from a the chord from b crosses it: the ratio of a's distances from b's line. */
static double crossing_at(const aqr_sample* a, const aqr_sample* b)
{
  vec3 d = v3_sub(a[1].p, a->p), e = v3_sub(b[1].p, b->p);
  vec3 u = v3_cross(e, v3_sub(a->p, b->p)), v = v3_cross(e, d);
  double n = v3_norm2(v), t = n > 0 ? fmin(1, fmax(0, -v3_dot(u, v) / n)) : 0.5;
  return (double)a->sigma + t * (double)(a[1].sigma - a->sigma);
}

/* Marks a new line and those it crosses. Every chord is listed already, so pairs within the line are met twice. */
static aqr_status mark_crossings(aqr_sampler* m, aqr_index id)
{
  const aqr_lines* l = m->lines;
  const aqr_line* line = &l->lines[id];
  aqr_status status = AQR_OK;
  for (size_t i = line->first; i + 1 < line->first + line->count; i++)
  {
    const aqr_sample* a = &l->samples[i];
    for (aqr_index k = l->head[a->face]; k != AQR_NONE; k = aqr_next_chord(l, k, a->face))
    {
      const aqr_sample* b = &l->samples[k];
      aqr_index other = b->line;
      AQR_REQUIRE(aqr_worked(m->c, 1), AQR_CANCELLED);
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

/* Whether the grown line, not yet added, goes too far beyond the goal: one that winds along a tube can give half of all
 * points. Shorter ones may still fit. */
static bool is_too_much(const aqr_sampler* m)
{
  const aqr_lines* l = m->lines;
  const aqr_line* line = &m->grower.line;
  const aqr_sample* a = m->grower.samples;
  const double most = (1 + most_over) * m->goal - m->points;
  double added = 0;
  if (!isfinite(most) || 2 * (double)a[line->count - 1].sigma < most) /* crossings are a spacing apart, seldom half */
    return false;
  for (size_t i = 0; i + 1 < line->count && added <= most; i++)
    for (aqr_index k = l->head[a[i].face]; k != AQR_NONE; k = aqr_next_chord(l, k, a[i].face))
    {
      const aqr_sample* b = &l->samples[k];
      added += !l->lines[b->line].is_chain && aqr_chords_cross(m->s, a[i].face, &a[i], &a[i + 1], b, b + 1);
    }
  return added > most;
}

/* Whether a grown line is worth keeping: long enough, or spanning from chain to chain, or closed. */
static bool worth_keeping(const aqr_line* line, const aqr_sample* samples)
{
  if (line->count < 2)
    return false;
  if (aqr_ends_on_chain(line, 0) && aqr_ends_on_chain(line, 1))
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
static line_end opposite_end(const aqr_sampler* m, const aqr_sample* at, vec3 d)
{
  const aqr_surface* s = m->s;
  const aqr_lines* l = m->lines;
  line_end found = { AQR_NONE, AQR_NONE, 0 };
  aqr_index other = aqr_any_twin(s, aqr_sample_half_edge(s, at, at->face));
  double along, across;
  aqr_sizing_at(s, m->field, m->sizing, at->face, v3_unit(d), &along, &across);
  double nearest = join_distance * across;
  const aqr_index f = aqr_face_of(other);
  for (aqr_index k = l->head[f]; k != AQR_NONE; k = aqr_next_chord(l, k, f))
  {
    const aqr_line* line = &l->lines[l->samples[k].line];
    for (unsigned i = 0; i < 2; i++)
    {
      size_t end = line->first + (i ? line->count - 1 : 0);
      const aqr_sample* a = &l->samples[end];
      bool is_here = k + i == end && a->edge == at->edge && line->ends[i] == AQR_END_FEATURE;
      double distance = v3_norm(v3_sub(a->p, at->p));
      if (!is_here || line->partner[i] != AQR_NONE || !(distance < nearest))
        continue;
      nearest = distance;
      found = (line_end){ l->samples[k].line, (aqr_index)end, i };
    }
  }
  return found;
}

/* Joins the free ends of the grown line, the next one to be added, to ends that they meet. */
static void join_ends(aqr_sampler* m)
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
static aqr_status commit(aqr_sampler* m, aqr_index partner, aqr_index* id)
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
    if (aqr_ends_on_chain(&g->line, i) && g->line.partner[i] == AQR_NONE)
      status = land(m, &g->samples[i ? g->line.count - 1 : 0]);
  return status;
}

/* A line that has reached a seam goes on from the same point on the other side, unless a line is too near there. */
static aqr_status cross_seam(aqr_sampler* m, aqr_index sample, aqr_index* id)
{
  const aqr_surface* s = m->s;
  const aqr_sample a = m->lines->samples[sample];
  aqr_index here = aqr_sample_half_edge(s, &a, a.face), h = aqr_any_twin(s, here);
  *id = AQR_NONE;
  if (h == AQR_NONE)
    return AQR_OK;
  double t = h == a.edge ? a.t : 1 - a.t;
  vec3 e = v3_unit(aqr_edge_vector(s, h));
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
static aqr_status cross_seams(aqr_sampler* m, aqr_index from)
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
static bool gives_up(const aqr_sampler* m)
{
  size_t kept = m->crossed - m->in_vain;
  return m->n_failed > most_failures * (m->lines->n_lines + free_failures) ||
         m->in_vain > most_in_vain * (kept + m->s->n_faces);
}

/* Whether f belongs to a closed surface of no more faces than a cube's, without creases. Long edges have been halved:
 * it is small, and lines around it would have more crossings than it has points, and miss its shape. */
static bool is_on_speck(const aqr_surface* s, aqr_index f)
{
  aqr_index faces[most_of_speck] = { f };
  unsigned n = 1;
  for (unsigned i = 0; i < n; i++)
    for (unsigned k = 0; k < 3; k++)
    {
      aqr_index t = aqr_twin(s, 3 * faces[i] + k);
      unsigned at = 0;
      if (t == AQR_NONE)
        return false;
      while (at < n && faces[at] != aqr_face_of(t))
        at++;
      if (at == most_of_speck)
        return false;
      if (at == n)
        faces[n++] = aqr_face_of(t);
    }
  return true;
}

/* A seed inside face f, for a line along `d`, at least `distance` from its family. */
aqr_status aqr_seed_inside(aqr_sampler* m, aqr_index f, vec3 p, vec3 d, double distance)
{
  bool allowed;
  aqr_index id = AQR_NONE;
  if (aqr_is_full(m) || gives_up(m))
    return AQR_OK;
  aqr_status status = aqr_grow_allowed(m->c, &m->grower, f, p, d, distance, &allowed);
  if (status != AQR_OK || !allowed || is_on_speck(m->s, f))
    return status;
  aqr_place at = aqr_place_in(m->s, f, p, 1e-6);
  status = aqr_grow_inside(m->c, &m->grower, &at, d);
  if (status == AQR_OK)
    status = commit(m, AQR_NONE, &id);
  return status == AQR_OK && id != AQR_NONE ? cross_seams(m, id) : status;
}

/* Seeds to one or both sides of a chain. */
aqr_status aqr_seed_on_chain(aqr_sampler* m, aqr_index h, double t, double distance)
{
  const aqr_surface* s = m->s;
  for (unsigned side = 0; side < 2 && !aqr_is_full(m); side++)
  {
    aqr_index k = side ? aqr_any_twin(s, h) : h;
    if (k == AQR_NONE)
      break;
    vec3 e = v3_unit(aqr_edge_vector(s, k));
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
