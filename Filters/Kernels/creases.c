/* SPDX-License-Identifier: BSD-3-Clause */
/* Creases (paper 3): edges of sharp dihedral angle that stand out of a smooth surface, in chains of some length. */
#include "creases.h"

#include <string.h>

/* ---- normals and dihedral angles ---- */

enum
{
  most_borrowings = 64, /* rounds in which needles look through each other */
  patch_rings = 3,      /* faces beside an edge that tell how smooth the surface is */
  patch_faces = 48,
  most_prunings = 64,
  most_rounds = 16
};

static const double rounding = 6e-8;   /* of coordinates that were single precision once, relative */
static const double proper_tilt = 0.1; /* radians that rounding may turn a normal to be trusted */
static const double weak = 0.6;        /* of the angle: how far hysteresis goes down */
static const double straight = 0.7071; /* cosine of the turn that hysteresis follows */
static const double roughest = 0.35;   /* mean dihedral around an edge of a crease, relative to its own */
static const double rough = 0.125;     /* the same, on average over a crease */
static const double zigzag = 0.4;      /* radians per edge that a chain may turn back and forth */

typedef struct crease_edge
{
  aqr_index h; /* the smaller of the two */
  aqr_index end[2];
  float deviation; /* radians from flat, positive where convex */
  float roughness; /* mean deviation around, relative to its own */
  bool kept;
} crease_edge;

typedef struct detector
{
  aqr_context* c;
  const aqr_surface* s;
  double angle, min_length;
  double* normal;     /* per face; zero where unknown */
  float* deviation;   /* per half-edge */
  uint8_t* is_crease; /* per half-edge: not given up yet */
  crease_edge* edges;
  size_t n_edges, capacity;
  size_t* first; /* per point, into `incident` */
  aqr_index* incident;
} detector;

/* Faces so thin that rounding of their corners turns their normal have none of their own. */
static void find_normals(void* data, size_t begin, size_t end)
{
  detector* d = data;
  const aqr_surface* s = d->s;
  double error = rounding * (1 + v3_norm(s->centre) / s->diagonal);
  for (size_t f = begin; f < end; f++)
  {
    vec3 p[3], x = aqr_face_cross(s, (aqr_index)f);
    for (unsigned k = 0; k < 3; k++)
      p[k] = aqr_point(s, s->corner[3 * f + k]);
    double longest = 0, area = v3_norm(x);
    for (unsigned k = 0; k < 3; k++)
      longest = fmax(longest, v3_norm(v3_sub(p[(k + 1) % 3], p[k])));
    v3_store(d->normal + 3 * f, area * proper_tilt > error * longest ? v3_scale(x, 1 / area) : v3(0, 0, 0));
  }
}

static bool has_normal(const detector* d, aqr_index f)
{
  return v3_norm2(v3_load(d->normal + 3 * (size_t)f)) > 0;
}

static double edge_length(const aqr_surface* s, aqr_index h)
{
  return v3_norm(aqr_edge_vector(s, h));
}

/* A needle takes the normal from over its longest side, so that the dihedral angle between the faces beside it appears
 * at its other side. */
static aqr_status borrow_normals(detector* d)
{
  const aqr_surface* s = d->s;
  aqr_status status = AQR_OK;
  aqr_index *list = NULL, *lender = NULL;
  size_t n = 0, capacity = 0, lenders = 0;
  for (aqr_index f = 0; f < s->n_faces; f++)
    if (!has_normal(d, f))
    {
      AQR_REQUIRE(AQR_RESERVE(d->c, list, capacity, n + 1), AQR_OUT_OF_MEMORY);
      list[n++] = f;
    }
  lenders = n;
  lender = AQR_NEW(d->c, aqr_index, lenders);
  AQR_REQUIRE(lender, AQR_OUT_OF_MEMORY);
  for (unsigned round = 0; round < most_borrowings && n; round++)
  {
    AQR_REQUIRE(aqr_step(d->c, 0.1), AQR_CANCELLED);
    for (size_t i = 0; i < n; i++)
    {
      double longest = -1;
      lender[i] = AQR_NONE;
      for (unsigned k = 0; k < 3; k++)
      {
        aqr_index h = 3 * list[i] + k, t = s->twin[h];
        double length = edge_length(s, h);
        if (t == AQR_NONE || !has_normal(d, t / 3) || length <= longest)
          continue;
        longest = length;
        lender[i] = t / 3;
      }
    }
    size_t left = 0;
    for (size_t i = 0; i < n; i++)
      if (lender[i] == AQR_NONE)
        list[left++] = list[i];
      else
        memcpy(d->normal + 3 * (size_t)list[i], d->normal + 3 * (size_t)lender[i], 3 * sizeof *d->normal);
    if (left == n)
      break;
    n = left;
  }
done:
  AQR_DROP(d->c, list, capacity);
  AQR_DROP(d->c, lender, lenders);
  return status;
}

/* An edge is measured by its smaller half-edge, for both. */
static void find_deviations(void* data, size_t begin, size_t end)
{
  detector* d = data;
  const aqr_surface* s = d->s;
  for (size_t i = begin; i < end; i++)
  {
    aqr_index h = (aqr_index)i, t = s->twin[h];
    if (t == AQR_NONE)
      d->deviation[h] = 0;
    if (t == AQR_NONE || t < h)
      continue;
    vec3 n = v3_load(d->normal + 3 * (size_t)(h / 3)), m = v3_load(d->normal + 3 * (size_t)(t / 3));
    vec3 x = v3_cross(n, m), e = aqr_edge_vector(s, h);
    bool known = v3_norm2(n) > 0 && v3_norm2(m) > 0;
    double size = known ? atan2(v3_norm(x), v3_dot(n, m)) : 0;
    d->deviation[h] = d->deviation[t] = (float)(v3_dot(x, e) < 0 ? -size : size);
  }
}

/* ---- candidates, and the faces beside them ---- */

static double size_at(const detector* d, aqr_index h)
{
  return fabs((double)d->deviation[h]);
}

static aqr_status list_candidates(detector* d)
{
  const aqr_surface* s = d->s;
  for (aqr_index h = 0; h < 3 * s->n_faces; h++)
  {
    if (h % (1 << 18) == 0 && !aqr_step(d->c, 0.4))
      return AQR_CANCELLED;
    if (s->twin[h] == AQR_NONE || s->twin[h] < h || size_at(d, h) <= weak * d->angle)
      continue;
    if (!AQR_RESERVE(d->c, d->edges, d->capacity, d->n_edges + 1))
      return AQR_OUT_OF_MEMORY;
    d->is_crease[h] = d->is_crease[s->twin[h]] = 1;
    d->edges[d->n_edges++] =
      (crease_edge){ .h = h, .end = { aqr_from(s, h), aqr_to(s, h) }, .deviation = d->deviation[h] };
  }
  return AQR_OK;
}

/* Mean deviation, by length, of the edges inside the patch that is reached from the face of h without crossing a
 * candidate: 0 where candidates enclose the face itself. */
static double patch_bend(const detector* d, aqr_index h)
{
  const aqr_surface* s = d->s;
  aqr_index face[patch_faces];
  unsigned ring[patch_faces], n = 1;
  double bend = 0, length = 0;
  face[0] = h / 3;
  ring[0] = 0;
  for (unsigned i = 0; i < n; i++)
    for (unsigned k = 0; k < 3; k++)
    {
      aqr_index g = 3 * face[i] + k, t = s->twin[g];
      if (t == AQR_NONE || g == h)
        continue;
      unsigned j = 0;
      while (j < n && face[j] != t / 3)
        j++;
      if (j == n)
      {
        if (n == patch_faces || ring[i] == patch_rings || d->is_crease[g])
          continue;
        face[n] = t / 3;
        ring[n++] = ring[i] + 1;
      }
      double l = edge_length(s, g);
      bend += l * size_at(d, g);
      length += l;
    }
  return length > 0 ? bend / length : 0;
}

/* At a crease the surface on either side is smooth compared with it; in the noise of a scan it is not. */
static void find_roughness(void* data, size_t begin, size_t end)
{
  detector* d = data;
  for (size_t i = begin; i < end; i++)
  {
    crease_edge* e = &d->edges[i];
    if (!d->is_crease[e->h])
      continue;
    double bend = patch_bend(d, e->h) + patch_bend(d, d->s->twin[e->h]);
    e->roughness = (float)(bend / 2 / fabs((double)e->deviation));
  }
}

/* ---- hysteresis ---- */

static aqr_status link_candidates(detector* d)
{
  size_t n = d->s->n_points;
  d->first = AQR_NEW0(d->c, size_t, n + 2);
  d->incident = AQR_NEW(d->c, aqr_index, 2 * d->n_edges);
  if (!d->first || !d->incident)
    return AQR_OUT_OF_MEMORY;
  for (size_t i = 0; i < d->n_edges; i++)
    for (unsigned k = 0; k < 2; k++)
      d->first[d->edges[i].end[k] + 2]++;
  for (size_t v = 1; v <= n; v++)
    d->first[v + 1] += d->first[v];
  for (size_t i = 0; i < d->n_edges; i++)
    for (unsigned k = 0; k < 2; k++)
      d->incident[d->first[d->edges[i].end[k] + 1]++] = (aqr_index)i;
  return AQR_OK;
}

/* Unit vector along edge e away from its end `v`. */
static vec3 away(const detector* d, const crease_edge* e, aqr_index v)
{
  aqr_index w = e->end[0] == v ? e->end[1] : e->end[0];
  return v3_unit(v3_sub(aqr_point(d->s, w), aqr_point(d->s, v)));
}

/* Keeps steep edges in smooth surroundings, and what goes straight on from them and is not much flatter. */
static aqr_status grow(detector* d)
{
  size_t n = d->n_edges, tail = 0;
  aqr_index* queue = AQR_NEW(d->c, aqr_index, n);
  if (!queue)
    return AQR_OUT_OF_MEMORY;
  for (size_t i = 0; i < n; i++)
  {
    crease_edge* e = &d->edges[i];
    e->kept = d->is_crease[e->h] && fabs((double)e->deviation) > d->angle && (double)e->roughness < roughest;
    if (e->kept)
      queue[tail++] = (aqr_index)i;
  }
  for (size_t head = 0; head < tail; head++)
  {
    const crease_edge* e = &d->edges[queue[head]];
    for (unsigned k = 0; k < 2; k++)
    {
      vec3 back = away(d, e, e->end[k]);
      for (size_t j = d->first[e->end[k]]; j < d->first[e->end[k] + 1]; j++)
      {
        crease_edge* g = &d->edges[d->incident[j]];
        if (g->kept || !d->is_crease[g->h] || (g->deviation > 0) != (e->deviation > 0) ||
            (double)g->roughness >= roughest || -v3_dot(back, away(d, g, e->end[k])) < straight)
          continue;
        g->kept = true;
        queue[tail++] = d->incident[j];
      }
    }
  }
  AQR_DROP(d->c, queue, n);
  return AQR_OK;
}

/* ---- pruning ---- */

/* A maximal run of kept edges through points where two of them meet. */
typedef struct run
{
  size_t first, count; /* into runs.edges */
  aqr_index end[2];
  double length;
  double roughness; /* mean of its edges */
  bool free[2];     /* nothing goes on at this end */
  bool closed, dropped;
} run;

typedef struct runs
{
  run* list;
  size_t n, capacity;
  aqr_index* edges;
  size_t n_edges;
  uint8_t* seen;
} runs;

static unsigned degree(const detector* d, aqr_index v)
{
  unsigned n = 0;
  for (size_t j = d->first[v]; j < d->first[v + 1]; j++)
    n += d->edges[d->incident[j]].kept;
  return n;
}

static bool on_border(const aqr_surface* s, aqr_index v)
{
  return s->twin[aqr_prev(s->fan[v])] == AQR_NONE || s->twin[s->fan[v]] == AQR_NONE;
}

/* The other kept edge at v when there is exactly one. */
static aqr_index follow(const detector* d, aqr_index e, aqr_index v)
{
  aqr_index next = AQR_NONE;
  if (degree(d, v) != 2 || on_border(d->s, v))
    return AQR_NONE;
  for (size_t j = d->first[v]; j < d->first[v + 1]; j++)
    if (d->incident[j] != e && d->edges[d->incident[j]].kept)
      next = d->incident[j];
  return next;
}

static aqr_index other_end(const detector* d, aqr_index e, aqr_index v)
{
  return d->edges[e].end[0] == v ? d->edges[e].end[1] : d->edges[e].end[0];
}

static bool collect_run(detector* d, runs* r, aqr_index start)
{
  if (!AQR_RESERVE(d->c, r->list, r->capacity, r->n + 1))
    return false;
  aqr_index e = start, v = d->edges[start].end[0], next;
  bool closed = false;
  while ((next = follow(d, e, v)) != AQR_NONE)
  {
    e = next;
    v = other_end(d, e, v);
    closed = e == start;
    if (closed)
      break;
  }
  run a = { .first = r->n_edges, .closed = closed };
  if (closed)
    v = d->edges[start].end[0];
  a.end[0] = v;
  while (e != AQR_NONE && !r->seen[e])
  {
    r->seen[e] = 1;
    r->edges[r->n_edges++] = e;
    double length = edge_length(d->s, d->edges[e].h);
    a.length += length;
    a.roughness += length * (double)d->edges[e].roughness;
    v = other_end(d, e, v);
    e = follow(d, e, v);
  }
  a.end[1] = v;
  a.count = r->n_edges - a.first;
  a.roughness /= fmax(a.length, 1e-300);
  for (unsigned k = 0; k < 2; k++)
    a.free[k] = !closed && degree(d, a.end[k]) == 1 && !on_border(d->s, a.end[k]);
  r->list[r->n++] = a;
  return true;
}

/* How much a run turns back and forth, in radians per edge: of three edges in a row, the turns that cancel. */
static double wobble(const detector* d, const runs* r, const run* a)
{
  double sum = 0;
  aqr_index v = a->end[0];
  vec3 before[2] = { { 0, 0, 0 }, { 0, 0, 0 } };
  if (a->count < 4)
    return 0;
  for (size_t i = 0; i < a->count; i++)
  {
    aqr_index e = r->edges[a->first + i];
    vec3 u = away(d, &d->edges[e], v);
    v = other_end(d, e, v);
    if (i >= 2)
    {
      double s = acos(fmax(-1, fmin(1, v3_dot(before[0], before[1])))),
             t = acos(fmax(-1, fmin(1, v3_dot(before[1], u))));
      sum += s + t - acos(fmax(-1, fmin(1, v3_dot(before[0], u))));
    }
    before[0] = before[1];
    before[1] = u;
  }
  return sum / (double)(a->count - 2);
}

/* Whether run a is the shortest of the short free ones at its bound end, the one to go first. */
static bool goes_first(const double* shortest, const run* a)
{
  if (a->free[0] && a->free[1])
    return true;
  aqr_index v = a->free[0] ? a->end[1] : a->end[0];
  return a->length <= shortest[v];
}

/* Drops what is short and free at an end, stubs before what they hang on, until nothing more is. */
static aqr_status prune(detector* d)
{
  aqr_status status = AQR_OK;
  size_t n = d->n_edges, points = d->s->n_points;
  runs r = { 0 };
  double* shortest = AQR_NEW(d->c, double, points);
  r.edges = AQR_NEW(d->c, aqr_index, n);
  r.seen = AQR_NEW(d->c, uint8_t, n);
  AQR_REQUIRE(shortest && r.edges && r.seen, AQR_OUT_OF_MEMORY);
  bool changed = true;
  for (unsigned round = 0; round < most_prunings && changed; round++)
  {
    AQR_REQUIRE(aqr_step(d->c, 0.7), AQR_CANCELLED);
    changed = false;
    r.n = r.n_edges = 0;
    memset(r.seen, 0, n);
    for (size_t i = 0; i < n; i++)
      if (d->edges[i].kept && !r.seen[i])
        AQR_REQUIRE(collect_run(d, &r, (aqr_index)i), AQR_OUT_OF_MEMORY);
    for (size_t i = 0; i < r.n; i++)
      shortest[r.list[i].end[0]] = shortest[r.list[i].end[1]] = INFINITY;
    for (size_t i = 0; i < r.n; i++)
      if (r.list[i].free[0] || r.list[i].free[1])
        for (unsigned k = 0; k < 2; k++)
          shortest[r.list[i].end[k]] = fmin(shortest[r.list[i].end[k]], r.list[i].length);
    for (size_t i = 0; i < r.n; i++)
    {
      run* a = &r.list[i];
      bool loose = a->free[0] || a->free[1];
      /* what hangs together in short pieces must be cleaner */
      double allowed = rough * fmin(1, 0.5 + 0.5 * a->length / d->min_length);
      a->dropped = (a->closed && a->length < d->min_length) ||
                   (loose && a->length < d->min_length && goes_first(shortest, a)) || wobble(d, &r, a) > zigzag ||
                   a->roughness > allowed;
    }
    for (size_t i = 0; i < r.n; i++)
      for (size_t j = 0; r.list[i].dropped && j < r.list[i].count; j++)
      {
        d->edges[r.edges[r.list[i].first + j]].kept = false;
        changed = true;
      }
  }
done:
  AQR_DROP(d->c, shortest, points);
  AQR_DROP(d->c, r.list, r.capacity);
  AQR_DROP(d->c, r.edges, n);
  AQR_DROP(d->c, r.seen, n);
  return status;
}

/* Drops connected clusters of creases that fit into a box smaller than the shortest chain, unless they are one loop:
 * folds and spikes of a scan, whose runs are all short but hold each other. */
static aqr_status drop_clusters(detector* d)
{
  const aqr_surface* s = d->s;
  size_t n = d->n_edges;
  aqr_index* queue = AQR_NEW(d->c, aqr_index, n);
  uint8_t* seen = AQR_NEW0(d->c, uint8_t, n);
  aqr_status status = AQR_OK;
  AQR_REQUIRE(queue && seen, AQR_OUT_OF_MEMORY);
  AQR_REQUIRE(aqr_step(d->c, 0.8), AQR_CANCELLED);
  for (size_t i = 0; i < n; i++)
  {
    if (!d->edges[i].kept || seen[i])
      continue;
    size_t tail = 0;
    bool branches = false;
    vec3 low = aqr_point(s, d->edges[i].end[0]), high = low;
    seen[i] = 1;
    queue[tail++] = (aqr_index)i;
    for (size_t head = 0; head < tail; head++)
      for (unsigned k = 0; k < 2; k++)
      {
        aqr_index v = d->edges[queue[head]].end[k];
        vec3 p = aqr_point(s, v);
        low = v3(fmin(low.x, p.x), fmin(low.y, p.y), fmin(low.z, p.z));
        high = v3(fmax(high.x, p.x), fmax(high.y, p.y), fmax(high.z, p.z));
        branches |= degree(d, v) > 2;
        for (size_t j = d->first[v]; j < d->first[v + 1]; j++)
        {
          aqr_index g = d->incident[j];
          if (!d->edges[g].kept || seen[g])
            continue;
          seen[g] = 1;
          queue[tail++] = g;
        }
      }
    for (size_t j = 0; branches && v3_norm(v3_sub(high, low)) < d->min_length && j < tail; j++)
      d->edges[queue[j]].kept = false;
  }
done:
  AQR_DROP(d->c, queue, n);
  AQR_DROP(d->c, seen, n);
  return status;
}

/* Forgets the candidates that were not kept; returns how many were. */
static size_t give_up(detector* d)
{
  size_t left = 0;
  for (size_t i = 0; i < d->n_edges; i++)
  {
    const crease_edge* e = &d->edges[i];
    d->is_crease[e->h] = d->is_crease[d->s->twin[e->h]] = e->kept;
    left += e->kept;
  }
  return left;
}

aqr_status aqr_features_detect(
  aqr_context* c, const aqr_surface* s, double angle, double min_length, uint8_t* is_crease, aqr_report* report)
{
  detector d = { .c = c, .s = s, .angle = radians(angle), .min_length = min_length, .is_crease = is_crease };
  aqr_status status = AQR_OK;
  memset(is_crease, 0, 3 * s->n_faces);
  d.normal = AQR_NEW(c, double, 3 * s->n_faces);
  d.deviation = AQR_NEW(c, float, 3 * s->n_faces);
  AQR_REQUIRE(d.normal && d.deviation, AQR_OUT_OF_MEMORY);
  AQR_TRY(aqr_parallel(c, s->n_faces, find_normals, &d, 0, 0.1));
  AQR_TRY(borrow_normals(&d));
  AQR_TRY(aqr_parallel(c, 3 * s->n_faces, find_deviations, &d, 0.1, 0.4));
  AQR_TRY(list_candidates(&d));
  AQR_TRY(link_candidates(&d));
  /* what is given up counts as roughness beside what is left */
  size_t left = d.n_edges, before = left + 1;
  for (unsigned round = 0; round < most_rounds && left < before; round++)
  {
    AQR_TRY(aqr_parallel(c, d.n_edges, find_roughness, &d, 0.4, 0.7));
    AQR_TRY(grow(&d));
    AQR_TRY(prune(&d));
    AQR_TRY(drop_clusters(&d));
    before = left;
    left = give_up(&d);
  }
  report->feature_edges = left;
done:
  AQR_DROP(c, d.normal, 3 * s->n_faces);
  AQR_DROP(c, d.deviation, 3 * s->n_faces);
  AQR_DROP(c, d.edges, d.capacity);
  AQR_DROP(c, d.first, s->n_points + 2);
  AQR_DROP(c, d.incident, 2 * d.n_edges);
  return status;
}
