/* SPDX-License-Identifier: BSD-3-Clause */
/* Paper 3: creases and boundaries become lines of their own, and the points where they meet or turn become nodes. */
#include "feature_graph.h"

#include <string.h>

static const double pi = 3.14159265358979323846;

/* ---- normals and dihedral angles ---- */

enum
{
  most_borrowings = 64, /* rounds in which needles look through each other */
  patch_rings = 3,
  patch_faces = 48, /* around one edge on one side */
  most_prunings = 64,
  most_rounds = 16
};

static const double rounding = 6e-8; /* of coordinates that were single precision once, relative */
static const double proper_tilt = 0.1;
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
  return v3_norm(v3_sub(aqr_point(s, aqr_to(s, h)), aqr_point(s, aqr_from(s, h))));
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
    vec3 x = v3_cross(n, m), e = v3_sub(aqr_point(s, aqr_to(s, h)), aqr_point(s, aqr_from(s, h)));
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
 * candidate. A face that candidates enclose says nothing of smoothness; as good as bent by a right angle. */
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
  detector d = { .c = c, .s = s, .angle = angle * pi / 180, .min_length = min_length, .is_crease = is_crease };
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

/* ---- chains ---- */

enum
{
  WALK_SMOOTH,
  WALK_RAGGED, /* turns sharply, and back at once */
  WALK_CORNER,
  WALK_WIDE_CORNER
};

typedef struct linker
{
  aqr_context* c;
  const aqr_surface* s;
  double corner_angle;
  aqr_chains* out;
  size_t* first;       /* per cleaned point, into `incident` */
  aqr_index* incident; /* half-edges of seams (the smaller) and boundaries */
  size_t n_edges;
  uint8_t* seen; /* per half-edge */
  aqr_chain* chains;
  size_t n_chains, chain_capacity;
  size_t n_done;   /* of out->half_edges */
  aqr_index* walk; /* half-edges of the run between branches that is being cut into chains */
  size_t n_walk;
  bool closed;
  uint8_t* corner; /* per half-edge of the run: WALK_... of its start */
  double *wide, *arc;
  double reach;
} linker;

static bool is_listed(const aqr_surface* s, aqr_index h)
{
  return aqr_is_boundary(s, h) || (aqr_is_seam(s, h) && h < aqr_any_twin(s, h));
}

static aqr_index clean_from(const aqr_surface* s, aqr_index h)
{
  return s->clean[aqr_from(s, h)];
}
static aqr_index clean_to(const aqr_surface* s, aqr_index h)
{
  return s->clean[aqr_to(s, h)];
}

static aqr_status link_edges(linker* l)
{
  const aqr_surface* s = l->s;
  l->first = AQR_NEW0(l->c, size_t, s->n_clean + 2);
  if (!l->first)
    return AQR_OUT_OF_MEMORY;
  for (aqr_index h = 0; h < 3 * s->n_faces; h++)
    if (is_listed(s, h))
    {
      l->n_edges++;
      l->first[clean_from(s, h) + 2]++;
      l->first[clean_to(s, h) + 2]++;
    }
  for (size_t v = 1; v <= s->n_clean; v++)
    l->first[v + 1] += l->first[v];
  l->incident = AQR_NEW(l->c, aqr_index, 2 * l->n_edges);
  l->walk = AQR_NEW(l->c, aqr_index, l->n_edges);
  l->corner = AQR_NEW(l->c, uint8_t, l->n_edges);
  l->arc = AQR_NEW(l->c, double, l->n_edges + 1);
  l->wide = AQR_NEW(l->c, double, l->n_edges);
  l->seen = AQR_NEW0(l->c, uint8_t, 3 * s->n_faces);
  if (!l->incident || !l->walk || !l->corner || !l->arc || !l->wide || !l->seen)
    return AQR_OUT_OF_MEMORY;
  for (aqr_index h = 0; h < 3 * s->n_faces; h++)
    if (is_listed(s, h))
    {
      l->incident[l->first[clean_from(s, h) + 1]++] = h;
      l->incident[l->first[clean_to(s, h) + 1]++] = h;
    }
  return AQR_OK;
}

/* Whether chains cannot run through the cleaned point v whatever their turn there. */
static bool is_branch(const linker* l, aqr_index v)
{
  const aqr_index* a = l->incident + l->first[v];
  return l->first[v + 1] - l->first[v] != 2 || aqr_is_seam(l->s, a[0]) != aqr_is_seam(l->s, a[1]);
}

/* The half-edge by which the chain goes on from the end of h; of a seam's two sides the one that runs on. */
static aqr_index chain_next(const linker* l, aqr_index h)
{
  const aqr_surface* s = l->s;
  aqr_index v = clean_to(s, h);
  const aqr_index* a = l->incident + l->first[v];
  if (is_branch(l, v))
    return AQR_NONE;
  aqr_index t = aqr_any_twin(s, h), g = a[0] == h || a[0] == t ? a[1] : a[0];
  return clean_from(s, g) == v ? g : aqr_any_twin(s, g);
}

static aqr_index chain_previous(const linker* l, aqr_index h)
{
  const aqr_surface* s = l->s;
  aqr_index v = clean_from(s, h);
  const aqr_index* a = l->incident + l->first[v];
  if (is_branch(l, v))
    return AQR_NONE;
  aqr_index t = aqr_any_twin(s, h), g = a[0] == h || a[0] == t ? a[1] : a[0];
  return clean_to(s, g) == v ? g : aqr_any_twin(s, g);
}

/* ---- corners ---- */

static const double reach_edges = 4;          /* mean edge lengths on either side over which a ragged border turns */
static const double reach_of_loop = 1.0 / 12; /* at most: a circle turns by 30 degrees over that */

/* Positions along the run in `walk` count on beyond its ends where it is closed. */
static size_t wrapped(const linker* l, ptrdiff_t i)
{
  ptrdiff_t n = (ptrdiff_t)l->n_walk, r = i % n;
  return (size_t)(r < 0 ? r + n : r);
}

static vec3 walk_point(const linker* l, ptrdiff_t i)
{
  if (!l->closed && (size_t)i == l->n_walk)
    return aqr_point(l->s, aqr_to(l->s, l->walk[i - 1]));
  return aqr_point(l->s, aqr_from(l->s, l->walk[wrapped(l, i)]));
}

static double walk_arc(const linker* l, ptrdiff_t i)
{
  ptrdiff_t n = (ptrdiff_t)l->n_walk;
  if (i < 0)
    return l->arc[i + n] - l->arc[n];
  return i > n ? l->arc[i - n] + l->arc[n] : l->arc[i];
}

/* Whether position i has an edge on either side, seen from `about` and no farther than once around. */
static bool is_inside(const linker* l, ptrdiff_t i, ptrdiff_t about)
{
  ptrdiff_t n = (ptrdiff_t)l->n_walk;
  return l->closed ? 2 * (i > about ? i - about : about - i) < n : i > 0 && i < n;
}

static double turn_between(const linker* l, ptrdiff_t j, ptrdiff_t i, ptrdiff_t k, vec3* axis)
{
  vec3 p = walk_point(l, i), a = v3_sub(p, walk_point(l, j)), b = v3_sub(walk_point(l, k), p);
  *axis = v3_cross(a, b);
  return atan2(v3_norm(*axis), v3_dot(a, b));
}

/* Turn at position i between chords that reach a few edges to either side. */
static double wide_turn(const linker* l, ptrdiff_t i)
{
  ptrdiff_t j = i - 1, k = i + 1;
  vec3 axis;
  while (is_inside(l, j, i) && walk_arc(l, i) - walk_arc(l, j) < l->reach)
    j--;
  while (is_inside(l, k, i) && walk_arc(l, k) - walk_arc(l, i) < l->reach)
    k++;
  return turn_between(l, j, i, k, &axis);
}

/* Whether the turns beside the one at i, opposite to it, take back half of it: a ragged border, no corner. */
static bool is_ragged(const linker* l, ptrdiff_t i)
{
  vec3 axis, other;
  double turn = turn_between(l, i - 1, i, i + 1, &axis), opposite = 0;
  for (ptrdiff_t k = i - 2; k <= i + 2; k++)
  {
    if (k == i || !is_inside(l, k, i))
      continue;
    double there = turn_between(l, k - 1, k, k + 1, &other);
    if (v3_dot(axis, other) < 0)
      opposite += there;
  }
  return 2 * opposite > turn;
}

/* Marks where the turn over a few edges is sharp and sharper than at any other point within that reach. Only near
 * ragged points: a smooth curve has no corner however fast it turns. */
static void find_wide_corners(linker* l)
{
  ptrdiff_t n = (ptrdiff_t)l->n_walk;
  for (ptrdiff_t i = l->closed ? 0 : 1; i < n; i++)
  {
    bool sharpest = l->wide[i] > l->corner_angle && l->corner[i] != WALK_CORNER, ragged = l->corner[i] == WALK_RAGGED;
    for (int by = -1; by <= 1 && sharpest; by += 2)
      for (ptrdiff_t k = i + by; is_inside(l, k, i) && sharpest; k += by)
      {
        size_t at = wrapped(l, k);
        if (fabs(walk_arc(l, k) - walk_arc(l, i)) > l->reach)
          break;
        ragged |= l->corner[at] == WALK_RAGGED;
        sharpest = l->corner[at] != WALK_CORNER && l->corner[at] != WALK_WIDE_CORNER && l->wide[at] <= l->wide[i];
      }
    if (sharpest && ragged)
      l->corner[i] = WALK_WIDE_CORNER;
  }
}

/* A clean turn is a corner at once. Along the ragged border of a scan, where every other edge turns sharply, turns are
 * judged over a few edges; creases were rid of zigzag when they were found. */
static void find_corners(linker* l)
{
  bool seam = aqr_is_seam(l->s, l->walk[0]), any_ragged = false;
  ptrdiff_t n = (ptrdiff_t)l->n_walk;
  l->arc[0] = 0;
  for (ptrdiff_t i = 0; i < n; i++)
    l->arc[i + 1] = l->arc[i] + edge_length(l->s, l->walk[i]);
  double mean = l->arc[n] / (double)n;
  l->reach = reach_edges * mean;
  if (l->closed)
    l->reach = fmin(l->reach, reach_of_loop * l->arc[n]);
  l->corner[0] = WALK_SMOOTH;
  for (ptrdiff_t i = l->closed ? 0 : 1; i < n; i++)
  {
    vec3 axis;
    l->corner[i] = WALK_SMOOTH;
    if (turn_between(l, i - 1, i, i + 1, &axis) > l->corner_angle)
      l->corner[i] = !seam && is_ragged(l, i) ? WALK_RAGGED : WALK_CORNER;
    any_ragged |= l->corner[i] == WALK_RAGGED;
  }
  if (!any_ragged || l->reach < 2 * mean)
    return;
  for (ptrdiff_t i = l->closed ? 0 : 1; i < n; i++)
    l->wide[i] = wide_turn(l, i);
  find_wide_corners(l);
}

/* ---- chains ---- */

/* Adds edges [begin, end) of the run as a chain. */
static bool add_chain(linker* l, size_t begin, size_t end, bool closed)
{
  aqr_chains* o = l->out;
  if (!AQR_RESERVE(l->c, l->chains, l->chain_capacity, l->n_chains + 1))
    return false;
  l->chains[l->n_chains++] = (aqr_chain){ l->n_done, end - begin, closed, aqr_is_seam(l->s, l->walk[0]) };
  for (size_t i = begin; i < end; i++)
  {
    aqr_index h = l->walk[i % l->n_walk];
    o->half_edges[l->n_done++] = h;
    o->is_node[clean_from(l->s, h)] = i > begin || closed ? 2 : 1;
    if (i + 1 == end && !closed)
      o->is_node[clean_to(l->s, h)] = 1;
  }
  return true;
}

/* The whole run through h between branches, cut into chains at its corners. */
static bool add_run(linker* l, aqr_index h)
{
  aqr_index start = h, g = chain_previous(l, h);
  for (size_t i = 0; g != AQR_NONE && g != h && i < l->n_edges; i++)
  {
    start = g;
    g = chain_previous(l, g);
  }
  l->closed = g == h;
  l->n_walk = 0;
  if (l->closed)
    start = h;
  g = start;
  do
  {
    l->seen[g] = 1;
    if (aqr_any_twin(l->s, g) != AQR_NONE)
      l->seen[aqr_any_twin(l->s, g)] = 1;
    l->walk[l->n_walk++] = g;
    g = chain_next(l, g);
  } while (g != AQR_NONE && g != start && l->n_walk < l->n_edges);
  find_corners(l);
  size_t begin = 0, n = l->n_walk;
  while (l->closed && begin < n && l->corner[begin] < WALK_CORNER)
    begin++;
  if (begin == n)
    return add_chain(l, 0, n, true);
  for (size_t i = begin + 1, last = begin + n; i <= last; i++)
    if (i == last || l->corner[i % n] >= WALK_CORNER)
    {
      if (!add_chain(l, begin, i, false))
        return false;
      begin = i;
    }
  return true;
}

aqr_status aqr_chains_build(aqr_context* c, const aqr_surface* s, double corner_angle, aqr_chains* chains)
{
  linker l = { .c = c, .s = s, .corner_angle = corner_angle * pi / 180, .out = chains };
  aqr_status status = AQR_OK;
  *chains = (aqr_chains){ .n_clean = s->n_clean };
  chains->is_node = AQR_NEW0(c, uint8_t, s->n_clean);
  AQR_REQUIRE(chains->is_node, AQR_OUT_OF_MEMORY);
  AQR_TRY(link_edges(&l));
  chains->half_edges = AQR_NEW(c, aqr_index, l.n_edges);
  AQR_REQUIRE(chains->half_edges, AQR_OUT_OF_MEMORY);
  chains->n_half_edges = l.n_edges;
  for (unsigned boundary = 0; boundary < 2; boundary++)
    for (aqr_index h = 0; h < 3 * s->n_faces; h++)
    {
      if (h % (1 << 18) == 0)
        AQR_REQUIRE(aqr_step(c, 0.9), AQR_CANCELLED);
      if (is_listed(s, h) && !l.seen[h] && aqr_is_boundary(s, h) == boundary)
        AQR_REQUIRE(add_run(&l, h), AQR_OUT_OF_MEMORY);
    }
  chains->chains = AQR_NEW(c, aqr_chain, l.n_chains);
  AQR_REQUIRE(chains->chains, AQR_OUT_OF_MEMORY);
  chains->n_chains = l.n_chains;
  if (l.n_chains)
    memcpy(chains->chains, l.chains, l.n_chains * sizeof *l.chains);
done:
  AQR_DROP(c, l.chains, l.chain_capacity);
  AQR_DROP(c, l.first, s->n_clean + 2);
  AQR_DROP(c, l.incident, 2 * l.n_edges);
  AQR_DROP(c, l.walk, l.n_edges);
  AQR_DROP(c, l.corner, l.n_edges);
  AQR_DROP(c, l.arc, l.n_edges + 1);
  AQR_DROP(c, l.wide, l.n_edges);
  AQR_DROP(c, l.seen, 3 * s->n_faces);
  if (status != AQR_OK)
    aqr_chains_free(c, chains);
  return status;
}

void aqr_chains_free(aqr_context* c, aqr_chains* chains)
{
  AQR_DROP(c, chains->chains, chains->n_chains);
  AQR_DROP(c, chains->half_edges, chains->n_half_edges);
  AQR_DROP(c, chains->is_node, chains->n_clean);
  *chains = (aqr_chains){ 0 };
}
