/* SPDX-License-Identifier: BSD-3-Clause */
/* Paper 3: creases and boundaries become lines of their own, and the points where they meet or turn become nodes. */
#include "feature_graph.h"

#include <string.h>

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
  return l->first[v + 1] - l->first[v] != 2 || aqr_is_seam(l->s, a[0]) != aqr_is_seam(l->s, a[1]) ||
         aqr_on_plane(l->s, a[0]) != aqr_on_plane(l->s, a[1]);
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
static aqr_status find_corners(linker* l)
{
  bool seam = aqr_is_seam(l->s, l->walk[0]), any_ragged = false;
  ptrdiff_t n = (ptrdiff_t)l->n_walk;
  l->arc[0] = 0;
  for (ptrdiff_t i = 0; i < n; i++)
    l->arc[i + 1] = l->arc[i] + v3_norm(v3_sub(walk_point(l, i + 1), walk_point(l, i)));
  double mean = l->arc[n] / (double)n;
  l->reach = reach_edges * mean;
  if (l->closed)
    l->reach = fmin(l->reach, reach_of_loop * l->arc[n]);
  l->corner[0] = WALK_SMOOTH;
  for (ptrdiff_t i = l->closed ? 0 : 1; i < n; i++)
  {
    vec3 axis;
    if (!aqr_worked(l->c, 16))
      return AQR_CANCELLED;
    l->corner[i] = WALK_SMOOTH;
    if (turn_between(l, i - 1, i, i + 1, &axis) > l->corner_angle)
      l->corner[i] = !seam && is_ragged(l, i) ? WALK_RAGGED : WALK_CORNER;
    any_ragged |= l->corner[i] == WALK_RAGGED;
  }
  if (!any_ragged || l->reach < 2 * mean)
    return AQR_OK;
  for (ptrdiff_t i = l->closed ? 0 : 1; i < n; i++)
  {
    if (!aqr_worked(l->c, 32))
      return AQR_CANCELLED;
    l->wide[i] = wide_turn(l, i);
  }
  find_wide_corners(l);
  return AQR_OK;
}

/* ---- chains ---- */

/* Adds edges [begin, end) of the run as a chain. */
static aqr_status add_chain(linker* l, size_t begin, size_t end, bool closed)
{
  aqr_chains* o = l->out;
  if (!AQR_RESERVE(l->c, l->chains, l->chain_capacity, l->n_chains + 1))
    return AQR_OUT_OF_MEMORY;
  l->chains[l->n_chains++] = (aqr_chain){ l->n_done, end - begin, closed, aqr_is_seam(l->s, l->walk[0]) };
  for (size_t i = begin; i < end; i++)
  {
    aqr_index h = l->walk[i % l->n_walk];
    o->half_edges[l->n_done++] = h;
    o->is_node[clean_from(l->s, h)] = i > begin || closed ? 2 : 1;
    if (i + 1 == end && !closed)
      o->is_node[clean_to(l->s, h)] = 1;
  }
  return AQR_OK;
}

/* The whole run through h between branches, cut into chains at its corners. */
static aqr_status add_run(linker* l, aqr_index h)
{
  aqr_status status = AQR_OK;
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
  AQR_TRY(find_corners(l));
  size_t begin = 0, n = l->n_walk;
  while (l->closed && begin < n && l->corner[begin] < WALK_CORNER)
    begin++;
  if (begin == n)
    return add_chain(l, 0, n, true);
  for (size_t i = begin + 1, last = begin + n; i <= last; i++)
    if (i == last || l->corner[i % n] >= WALK_CORNER)
    {
      AQR_TRY(add_chain(l, begin, i, false));
      begin = i;
    }
done:
  return status;
}

aqr_status aqr_chains_build(aqr_context* c, const aqr_surface* s, double corner_angle, aqr_chains* chains)
{
  linker l = { .c = c, .s = s, .corner_angle = radians(corner_angle), .out = chains };
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
        AQR_TRY(add_run(&l, h));
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
