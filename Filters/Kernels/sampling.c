/* SPDX-License-Identifier: BSD-3-Clause */
/* Paper 3 (line seeding) and 4.2. Lines are committed one by one; each committed line is a parent that is asked for
 * seeds of lines that cross it: wherever two neighbouring crossings along it are more than one and a half spacings
 * apart, evenly placed seeds fill the gap. When no parent has a gap left, places far from all lines get a seed of their
 * own. */
#include "sampler.h"

#include <stdlib.h>
#include <string.h>

enum
{
  most_rounds = 8,
  most_seeds_per_line = 1 << 20,
  score_levels = 64,
  room_for_cuts = 32, /* of the samples: lines that keep the topology are added later */
  most_passes = 12,   /* at reaching the number of points asked for */
  most_excess = 8 /* of points over those asked for, beyond one per face of the surface: the attempt is lost, and what
                     it may cost is bounded */
};

static const double seed_distance = 0.6;  /* of the spacing: nearer than this to a line of its family no line begins */
static const double cover_distance = 0.8; /* of the spacing: a place farther than this from all lines gets a seed */
static const double damping = 0.8;        /* of the step to the number of points asked for: what is overshot is lost */
static const double enough = 0.99;        /* of that number */
static const double most_finer = 1.5;     /* than the sizing: beyond, its bounds would no longer hold */

/* ---- gaps along a parent ---- */

static aqr_status add_place(aqr_sampler* m, double sigma)
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

static aqr_status seed_at(aqr_sampler* m, aqr_index parent, double sigma)
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
    return aqr_seed_on_chain(m, a.edge, t, seed_distance * along);
  vec3 n = v3_unit(aqr_face_cross(m->s, a.face));
  return aqr_seed_inside(m, a.face, p, v3_unit(v3_cross(n, d)), seed_distance * along);
}

/* The places along a parent that bound its gaps, in order: its marks, and its ends where they lie on borders. */
static aqr_status collect_places(aqr_sampler* m, aqr_index id)
{
  const aqr_line line = m->lines->lines[id];
  double end = (double)m->lines->samples[line.first + line.count - 1].sigma;
  aqr_status status = AQR_OK;
  m->n_places = 0;
  for (aqr_index k = m->parents[id].newest; k != AQR_NONE; k = m->marks[k].next)
    AQR_TRY(add_place(m, m->marks[k].sigma));
  if (!line.closed && (line.is_chain || aqr_ends_on_chain(&line, 0)))
    AQR_TRY(add_place(m, 0));
  if (!line.closed && (line.is_chain || aqr_ends_on_chain(&line, 1)))
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
static aqr_status ask_parent(aqr_sampler* m, aqr_index id)
{
  const aqr_line line = m->lines->lines[id];
  double end = (double)m->lines->samples[line.first + line.count - 1].sigma;
  aqr_status status = AQR_OK;
  if (aqr_is_full(m) || m->parents[id].asked == m->parents[id].n_marks + 1)
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
static aqr_status fill_gaps(aqr_sampler* m, size_t first)
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

static void count_points(aqr_sampler* m)
{
  m->points = 0;
  for (size_t i = 0; i < m->lines->n_lines; i++)
    m->points += aqr_points_on(m, (aqr_index)i);
}

/* Makes the spacing smaller everywhere; positions along lines are in spacings and grow. */
static void shrink_spacing(aqr_sampler* m, double factor)
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
static aqr_status reach_points(aqr_sampler* m, double points, double* finer)
{
  aqr_status status = AQR_OK;
  m->goal = points;
  for (int i = 0; i < most_passes && m->points < enough * points && !aqr_is_full(m); i++)
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
static int level(const aqr_sampler* m, aqr_index f)
{
  double a = 0;
  for (unsigned i = 0; i < 3; i++)
  {
    size_t v = m->s->corner[3 * f + i];
    double k_min = (double)m->field->k_min[v], k_max = (double)m->field->k_max[v], sum = fabs(k_min) + fabs(k_max);
    double strength = sum / (sum + 1); /* of a curvature radius against the diagonal */
    a += sum > 0 ? (k_max - k_min) / sum * strength : 0;
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

typedef struct levels
{
  const aqr_sampler* m;
  uint8_t* of; /* each face */
} levels;

static void find_levels(void* data, size_t begin, size_t end)
{
  levels* l = data;
  for (size_t f = begin; f < end; f++)
    l->of[f] = (uint8_t)level(l->m, (aqr_index)f);
}

/* Faces in order of their level, those of one level in a fixed random order. */
static aqr_status order_faces(aqr_sampler* m, aqr_index* order)
{
  aqr_context* c = m->c;
  aqr_status status = AQR_OK;
  size_t n = m->s->n_faces, count[score_levels + 1] = { 0 };
  uint8_t* of = AQR_NEW(c, uint8_t, n);
  AQR_REQUIRE(of, AQR_OUT_OF_MEMORY);
  AQR_TRY(aqr_parallel(c, n, find_levels, &(levels){ m, of }, 0, 0));
  for (size_t f = 0; f < n; f++)
    count[of[f] + 1]++;
  for (int l = 0; l < score_levels; l++)
    count[l + 1] += count[l];
  size_t start[score_levels];
  memcpy(start, count, sizeof start);
  for (aqr_index f = 0; f < n; f++)
    order[start[of[f]]++] = f;
  for (int l = 0; l < score_levels; l++)
    for (size_t i = count[l + 1]; i > count[l] + 1; i--)
    {
      AQR_REQUIRE(aqr_worked(c, 1), AQR_CANCELLED);
      size_t j = count[l] + scramble((uint32_t)i + m->options->seed * 0x9e3779b9u) % (i - count[l]);
      aqr_index f = order[i - 1];
      order[i - 1] = order[j];
      order[j] = f;
    }
done:
  AQR_DROP(c, of, n);
  return status;
}

/* Marks f and the faces reached from it over edges that end within `distance` of its first corner: no seed of the same
 * round is needed there. */
static aqr_status cover(
  aqr_sampler* m, uint8_t* covered, aqr_index** stack, size_t* capacity, aqr_index f, double distance)
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
    if (!aqr_worked(m->c, 8))
      return AQR_CANCELLED;
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
static aqr_status cover_surface(aqr_sampler* m)
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
    if (i % 1024 == 0)
      AQR_REQUIRE(aqr_step(c, 0.9 * (double)i / (double)s->n_faces), AQR_CANCELLED);
    if (covered[f])
      continue;
    vec3 n = v3_unit(aqr_face_cross(s, f));
    vec3 d = aqr_cross(m->field, s->corner[3 * f]);
    vec3 p = { 0, 0, 0 };
    for (unsigned k = 0; k < 3; k++)
      p = v3_madd(p, 1.0 / 3, aqr_point(s, s->corner[3 * f + k]));
    double along, across;
    aqr_sizing_at(s, m->field, m->sizing, f, d, &along, &across);
    size_t before = m->lines->n_lines;
    AQR_TRY(aqr_seed_inside(m, f, p, d, cover_distance * across));
    AQR_TRY(aqr_seed_inside(m, f, p, v3_cross(n, d), cover_distance * along));
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
  aqr_sampler m = {
    .c = c, .s = s, .field = field, .sizing = sizing, .options = options, .lines = lines, .goal = INFINITY
  };
  *r = (aqr_reached){ 1, 0 };
  aqr_status status = aqr_lines_init(c, s, lines);
  if (status != AQR_OK)
    return status;
  AQR_TRY(aqr_grower_init(c, s, field, sizing, lines, &m.grower));
  for (size_t i = 0; i < chains->n_chains; i++)
    AQR_TRY(aqr_sample_chain(&m, chains, &chains->chains[i]));
  count_points(&m);
  if (options->points > 0)
    m.goal = m.points + most_excess * options->points + (double)s->n_faces;
  AQR_TRY(fill_gaps(&m, 0));
  AQR_TRY(cover_surface(&m));
  AQR_TRY(fill_gaps(&m, 0));
  if (options->points > 0)
    AQR_TRY(reach_points(&m, options->points, &r->finer));
  r->points = m.points;
  const size_t room = lines->n_samples + lines->n_samples / room_for_cuts;
  AQR_REQUIRE(AQR_TRIM(c, lines->samples, lines->sample_capacity, room), AQR_OUT_OF_MEMORY);
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
