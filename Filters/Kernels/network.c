/* SPDX-License-Identifier: BSD-3-Clause */
/* Paper 5: edges along lines, and the half-edge structure. */
#include "network_builder.h"

#include <stdlib.h>
#include <string.h>

/* ---- pruning ---- */

/* The crossings of a line, in order along it: [*first, *end) of `on`. */
static void crossings_of(const aqr_network_builder* b, aqr_index id, size_t* first, size_t* end)
{
  const aqr_line* line = &b->l->lines[id];
  *first = b->order.first[line->first];
  *end = b->order.first[line->first + line->count - 1];
}

/* Whether the part of a line that lives passes an edge of the surface. */
static bool passes_edge(const aqr_network_builder* b, aqr_index id)
{
  const aqr_line* line = &b->l->lines[id];
  if (line->closed || aqr_ends_on_chain(line, 0) || aqr_ends_on_chain(line, 1))
    return true;
  aqr_index chord = AQR_NONE;
  for (size_t a = line->first; a + 1 < line->first + line->count; a++)
    for (size_t i = b->order.first[a]; i < b->order.first[a + 1]; i++)
      if (b->net->crossings[b->order.on[i]].alive)
      {
        if (chord != AQR_NONE && chord != a)
          return true;
        chord = (aqr_index)a;
      }
  return false;
}

/* A part of the network that no edge of the surface passes lies inside one face and cuts nothing off: it goes. */
static void prune_inside_faces(aqr_network_builder* b, aqr_index* stack)
{
  const aqr_lines* l = b->l;
  aqr_network* net = b->net;
  size_t n = 0, first, end;
  uint8_t* reached = b->reached;
  for (aqr_index i = 0; i < l->n_lines; i++)
    if (!l->lines[i].is_chain && b->alive[i] >= 2 && passes_edge(b, i))
    {
      reached[i] = 1;
      stack[n++] = i;
    }
  while (n)
  {
    crossings_of(b, stack[--n], &first, &end);
    for (size_t i = first; i < end; i++)
    {
      const aqr_crossing* x = &net->crossings[b->order.on[i]];
      for (unsigned k = 0; k < 2; k++)
        if (x->alive && !reached[x->line[k]])
        {
          reached[x->line[k]] = 1;
          stack[n++] = x->line[k];
        }
    }
  }
  for (aqr_index i = 0; i < l->n_lines; i++)
    if (!l->lines[i].is_chain && !reached[i])
      b->alive[i] = 0;
  for (size_t i = 0; i < net->n_crossings; i++)
    net->crossings[i].alive = net->crossings[i].alive && reached[net->crossings[i].line[0]];
}

/* Lines with fewer than two nodes have no edge: they go, and their crossings with them, until every line left has. */
static aqr_status prune(aqr_network_builder* b)
{
  const aqr_lines* l = b->l;
  b->alive = AQR_NEW0(b->c, aqr_index, l->n_lines);
  b->reached = AQR_NEW0(b->c, uint8_t, l->n_lines);
  aqr_index* stack = AQR_NEW(b->c, aqr_index, l->n_lines);
  if (!b->alive || !b->reached || !stack)
  {
    AQR_DROP(b->c, stack, l->n_lines);
    return AQR_OUT_OF_MEMORY;
  }
  for (size_t i = 0; i < b->net->n_crossings; i++)
    for (unsigned k = 0; k < 2; k++)
      b->alive[b->net->crossings[i].line[k]]++;
  size_t n = 0;
  for (aqr_index i = 0; i < l->n_lines; i++)
  {
    if (l->lines[i].is_chain)
      continue;
    for (unsigned k = 0; k < 2; k++)
      b->alive[i] += aqr_ends_on_chain(&l->lines[i], k);
    if (b->alive[i] < 2)
      stack[n++] = i;
  }
  while (n)
  {
    size_t first, end;
    crossings_of(b, stack[--n], &first, &end);
    for (size_t i = first; i < end; i++)
    {
      aqr_crossing* x = &b->net->crossings[b->order.on[i]];
      if (!x->alive)
        continue;
      x->alive = false;
      for (unsigned k = 0; k < 2; k++)
        if (b->alive[x->line[k]]-- == 2)
          stack[n++] = x->line[k];
    }
  }
  prune_inside_faces(b, stack);
  AQR_DROP(b->c, stack, l->n_lines);
  return AQR_OK;
}

/* ---- edges ---- */

static aqr_status add_edge(aqr_network_builder* b, aqr_index from, aqr_index to, uint8_t type, aqr_index* id)
{
  aqr_network* net = b->net;
  size_t old = net->edge_capacity;
  if (net->n_edges + 1 > old || !net->from)
  {
    size_t wanted = old < 512 ? 1024 : 2 * old;
    size_t halves = 2 * old, types = old;
    if (!AQR_RESERVE(b->c, net->from, halves, 2 * wanted) || !AQR_RESERVE(b->c, net->type, types, wanted))
    {
      if (halves != 2 * old) /* the first array has grown already: give it back so that one capacity describes both */
        AQR_DROP(b->c, net->from, halves);
      return AQR_OUT_OF_MEMORY;
    }
    net->edge_capacity = wanted;
  }
  *id = (aqr_index)net->n_edges++;
  net->from[2 * *id] = from;
  net->from[2 * *id + 1] = to;
  net->type[*id] = type;
  return AQR_OK;
}

typedef struct walker
{
  aqr_index node; /* the newest node on the line; AQR_NONE before the first */
  size_t sample;  /* the sample that starts the chord it lies on */
  unsigned side;  /* of a crossing: which of its two lines */
} walker;

static void set_out(aqr_network_builder* b, const walker* w, aqr_index edge)
{
  size_t n = b->net->n_crossings;
  if (w->node < n)
    b->net->crossings[w->node].out[w->side] = edge;
}

static void set_in(aqr_network_builder* b, const walker* w, aqr_index edge)
{
  size_t n = b->net->n_crossings;
  if (w->node < n)
    b->net->crossings[w->node].in[w->side] = edge;
}

/* An edge along the line between two nodes; samples after the first node's chord start up to the second's lie on it. */
static aqr_status join(aqr_network_builder* b, uint8_t type, const walker* a, const walker* z, aqr_index* edge)
{
  aqr_status status = add_edge(b, a->node, z->node, type, edge);
  if (status != AQR_OK)
    return status;
  set_out(b, a, *edge);
  set_in(b, z, *edge);
  for (size_t i = a->sample + 1; i <= z->sample; i++)
    b->net->edge_at[i] = *edge;
  return AQR_OK;
}

/* On a stop: the outgoing half-edge of a line that ends there, on the chain's left or right. */
static void attach(aqr_network_builder* b, aqr_index stop, const aqr_sample* end, aqr_index half_edge)
{
  aqr_stop* x = &b->net->stops[stop];
  bool left = end->face == aqr_face_of(b->l->samples[x->sample].edge);
  *(left ? &x->left : &x->right) = half_edge;
}

static aqr_status connect_line(aqr_network_builder* b, aqr_index id)
{
  const aqr_line* line = &b->l->lines[id];
  const aqr_sample* m = b->l->samples;
  const aqr_index* stops = b->stop_of + 2 * (size_t)id;
  size_t first = line->first, last = line->first + line->count - 1;
  walker before = { AQR_NONE, 0, 0 }, start = before;
  aqr_index edge = AQR_NONE, n = (aqr_index)b->net->n_crossings;
  aqr_status status = AQR_OK;
  if (stops[0] != AQR_NONE)
    before = start = (walker){ n + stops[0], first, 0 };
  for (size_t a = first; a < last; a++)
    for (size_t i = b->order.first[a]; i < b->order.first[a + 1]; i++)
    {
      const aqr_crossing* x = &b->net->crossings[b->order.on[i]];
      if (!x->alive)
        continue;
      walker here = { b->order.on[i], a, aqr_side_of(x, (aqr_index)a) };
      if (before.node == AQR_NONE)
        start = here;
      else
      {
        AQR_TRY(join(b, line->type, &before, &here, &edge));
        if (before.node == n + stops[0] && stops[0] != AQR_NONE)
        {
          b->net->edge_at[first] = edge;
          attach(b, stops[0], &m[first], 2 * edge);
        }
      }
      before = here;
    }
  if (stops[1] != AQR_NONE)
  {
    walker here = { n + stops[1], last, 0 };
    AQR_TRY(join(b, line->type, &before, &here, &edge));
    if (before.node == n + stops[0] && stops[0] != AQR_NONE)
    {
      b->net->edge_at[first] = edge;
      attach(b, stops[0], &m[first], 2 * edge);
    }
    attach(b, stops[1], &m[last], 2 * edge + 1);
  }
  else if (line->closed)
  {
    walker end = { start.node, last, start.side };
    AQR_TRY(join(b, line->type, &before, &end, &edge));
    for (size_t i = first; i <= start.sample; i++)
      b->net->edge_at[i] = edge;
  }
done:
  return status;
}

/* The stop of a node of the feature graph, made when first met. */
static aqr_status corner_stop(aqr_network_builder* b, aqr_index point, aqr_index* stop)
{
  aqr_index clean = b->s->clean[point];
  if (b->node_of[clean] == AQR_NONE)
  {
    aqr_status status = aqr_add_stop(b, AQR_NONE, point, 0, &b->node_of[clean]);
    if (status != AQR_OK)
      return status;
  }
  *stop = b->node_of[clean];
  return AQR_OK;
}

/* Notes the edge on the chain's samples [from, to): those whose half-edge it covers from the start on. */
static void cover_samples(aqr_network* net, aqr_index from, aqr_index to, aqr_index edge)
{
  for (aqr_index i = from; i < to; i++)
    net->edge_at[i] = edge;
}

/* The first sample at or after a stop. */
static aqr_index sample_from(const aqr_stop* x)
{
  return x->t > 0 ? x->sample + 1 : x->sample;
}

static aqr_status connect_chain(aqr_network_builder* b, aqr_index id, size_t first, size_t end)
{
  const aqr_line* line = &b->l->lines[id];
  const aqr_sample* m = b->l->samples;
  aqr_network* net = b->net;
  aqr_index n = (aqr_index)net->n_crossings, edge, before = AQR_NONE, last = AQR_NONE;
  aqr_index start = (aqr_index)line->first, stop = (aqr_index)(line->first + line->count - 1), from = start;
  aqr_status status = AQR_OK;
  if (!line->closed)
  {
    AQR_TRY(corner_stop(b, aqr_from(b->s, m[start].edge), &before));
    AQR_TRY(corner_stop(b, aqr_to(b->s, m[stop - 1].edge), &last));
  }
  else
    before = last = (aqr_index)(end - 1);
  for (size_t i = first; i < end; i++)
  {
    AQR_TRY(add_edge(b, n + before, n + (aqr_index)i, line->type, &edge));
    if (i > first || line->closed)
      net->stops[before].out = edge;
    net->stops[i].in = edge;
    cover_samples(net, from, sample_from(&net->stops[i]), edge);
    if (i == first && line->closed) /* around the loop's start */
      cover_samples(net, sample_from(&net->stops[end - 1]), stop, edge);
    from = sample_from(&net->stops[i]);
    before = (aqr_index)i;
  }
  if (!line->closed)
  {
    AQR_TRY(add_edge(b, n + before, n + last, line->type, &edge));
    if (end > first)
      net->stops[before].out = edge;
    cover_samples(net, from, stop, edge);
  }
done:
  return status;
}

/* ---- order around nodes ---- */

/* Links the half-edges that leave a node, given counter-clockwise: who arrives over the twin of one goes on along the
 * one clockwise of it, with the same region on its left. */
static void link_around(aqr_network* net, const aqr_index* out, unsigned n)
{
  for (unsigned i = 0; i < n; i++)
    net->next[out[i] ^ 1] = out[(i + n - 1) % n];
}

static unsigned push(aqr_index* out, unsigned n, aqr_index half_edge)
{
  if (half_edge != AQR_NONE)
    out[n++] = half_edge;
  return n;
}

static aqr_index forth(aqr_index edge)
{
  return edge == AQR_NONE ? AQR_NONE : 2 * edge;
}

static aqr_index back(aqr_index edge)
{
  return edge == AQR_NONE ? AQR_NONE : 2 * edge + 1;
}

/* A chain's end at a node of the feature graph. */
typedef struct spoke
{
  aqr_index node, edge, out; /* stop, edge of the surface, outgoing half-edge of the network */
} spoke;

static int by_node(const void* a, const void* b)
{
  const spoke *x = a, *y = b;
  return x->node != y->node ? (x->node < y->node ? -1 : 1) : (x->edge > y->edge) - (x->edge < y->edge);
}

/* The outgoing half-edge of a point from which turning counter-clockwise, over seams too, meets all faces around it. */
static aqr_index first_around(const aqr_surface* s, aqr_index point)
{
  aqr_index start = s->fan[point], h = start;
  for (;;)
  {
    aqr_index t = aqr_any_twin(s, h);
    if (t == AQR_NONE)
      return h;
    h = aqr_next(t);
    if (h == start)
      return h;
  }
}

/* Links the n spokes of one node in the order in which the surface's fan meets their edges. */
static aqr_status link_corner(aqr_network_builder* b, const spoke* spokes, size_t n)
{
  const aqr_surface* s = b->s;
  aqr_index* out = AQR_NEW(b->c, aqr_index, n);
  if (!out)
    return AQR_OUT_OF_MEMORY;
  unsigned found = 0;
  aqr_index start = first_around(s, b->net->stops[spokes[0].node].sample), h = start;
  for (;;)
  {
    for (size_t i = 0; i < n; i++)
      if (spokes[i].edge == aqr_edge_of(s, h))
        found = push(out, found, spokes[i].out);
    aqr_index last = aqr_prev(h);
    h = aqr_any_twin(s, last);
    if (h == AQR_NONE)
    {
      for (size_t i = 0; i < n; i++)
        if (spokes[i].edge == aqr_edge_of(s, last))
          found = push(out, found, spokes[i].out);
      break;
    }
    if (h == start || found >= n)
      break;
  }
  if (found == n)
    link_around(b->net, out, found);
  AQR_DROP(b->c, out, n);
  return found == n ? AQR_OK : AQR_INTERNAL;
}

static aqr_status link_corners(aqr_network_builder* b)
{
  aqr_network* net = b->net;
  const aqr_lines* l = b->l;
  size_t n = 0, capacity = 0, e = 0;
  spoke* spokes = NULL;
  aqr_status status = AQR_OK;
  aqr_index offset = (aqr_index)net->n_crossings;
  for (aqr_index i = 0; i < l->n_lines && l->lines[i].is_chain; i++)
  {
    const aqr_line* line = &l->lines[i];
    /* the chain's edges were added one after the other: find its first and its last */
    size_t begin = e;
    if (line->closed)
    {
      aqr_index origin = net->from[2 * e];
      while (net->from[2 * e + 1] != origin)
        e++;
      e++;
      continue;
    }
    aqr_index last = b->node_of[b->s->clean[aqr_to(b->s, l->samples[line->first + line->count - 2].edge)]];
    while (net->from[2 * e + 1] != offset + last)
      e++;
    AQR_REQUIRE(AQR_RESERVE(b->c, spokes, capacity, n + 2), AQR_OUT_OF_MEMORY);
    spokes[n++] =
      (spoke){ net->from[2 * begin] - offset, aqr_edge_of(b->s, l->samples[line->first].edge), (aqr_index)(2 * begin) };
    spokes[n++] =
      (spoke){ last, aqr_edge_of(b->s, l->samples[line->first + line->count - 2].edge), (aqr_index)(2 * e + 1) };
    e++;
  }
  if (n)
    qsort(spokes, n, sizeof *spokes, by_node);
  for (size_t i = 0, j; i < n; i = j)
  {
    for (j = i + 1; j < n && spokes[j].node == spokes[i].node;)
      j++;
    AQR_TRY(link_corner(b, spokes + i, j - i));
  }
done:
  AQR_DROP(b->c, spokes, capacity);
  return status;
}

static void link_nodes(aqr_network_builder* b)
{
  aqr_network* net = b->net;
  for (size_t i = 0; i < net->n_crossings; i++)
  {
    const aqr_crossing* x = &net->crossings[i];
    if (!x->alive)
      continue;
    aqr_index out[4];
    unsigned n = push(out, 0, forth(x->out[0]));
    n = push(out, n, x->turn > 0 ? forth(x->out[1]) : back(x->in[1]));
    n = push(out, n, back(x->in[0]));
    n = push(out, n, x->turn > 0 ? back(x->in[1]) : forth(x->out[1]));
    link_around(net, out, n);
  }
  for (size_t i = 0; i < net->n_stops; i++)
  {
    const aqr_stop* x = &net->stops[i];
    if (x->chain == AQR_NONE)
      continue;
    aqr_index out[4];
    unsigned n = push(out, 0, forth(x->out));
    n = push(out, n, x->left);
    n = push(out, n, back(x->in));
    n = push(out, n, x->right);
    link_around(net, out, n);
  }
}

/* Numbers the loops; the outer sides of boundary chains get none. */
static void number_loops(aqr_network* net)
{
  size_t n = 2 * net->n_edges;
  for (size_t h = 0; h < n; h++)
    net->loop[h] = AQR_NONE;
  for (size_t h = 0; h < n; h++)
  {
    if (net->loop[h] != AQR_NONE || (h % 2 == 1 && net->type[h / 2] == AQR_LINE_BOUNDARY))
      continue;
    aqr_index id = (aqr_index)net->n_loops++;
    size_t k = h;
    do
    {
      net->loop[k] = id;
      k = net->next[k];
    } while (k != h);
  }
}

static aqr_status connect(aqr_network_builder* b)
{
  aqr_network* net = b->net;
  const aqr_lines* l = b->l;
  aqr_status status = AQR_OK;
  size_t first = 0, landed = net->n_stops;
  aqr_index i = 0;
  for (; i < l->n_lines && l->lines[i].is_chain; i++)
  {
    size_t end = first;
    while (end < landed && net->stops[end].chain == i)
      end++;
    AQR_TRY(connect_chain(b, i, first, end));
    first = end;
  }
  for (; i < l->n_lines; i++)
    if (aqr_line_lives(b, i))
      AQR_TRY(connect_line(b, i));
  net->next = AQR_NEW(b->c, aqr_index, 2 * net->edge_capacity);
  net->loop = AQR_NEW(b->c, aqr_index, 2 * net->edge_capacity);
  AQR_REQUIRE(net->next && net->loop, AQR_OUT_OF_MEMORY);
  for (size_t h = 0; h < 2 * net->n_edges; h++)
    net->next[h] = AQR_NONE;
  link_nodes(b);
  AQR_TRY(link_corners(b));
  for (size_t h = 0; h < 2 * net->n_edges; h++)
    AQR_REQUIRE(net->next[h] != AQR_NONE, AQR_INTERNAL);
  number_loops(net);
done:
  return status;
}

aqr_status aqr_network_build(aqr_context* c, const aqr_surface* s, const aqr_lines* lines, const aqr_chains* chains,
  double chain_tolerance, double boundary_tolerance, aqr_network* net)
{
  memset(net, 0, sizeof *net);
  aqr_network_builder b = {
    .c = c, .s = s, .l = lines, .chains = chains, .tolerance = { chain_tolerance, boundary_tolerance }, .net = net
  };
  aqr_status status = AQR_OK;
  net->n_samples = lines->n_samples;
  net->edge_at = AQR_NEW(c, aqr_index, lines->n_samples);
  b.stop_of = AQR_NEW(c, aqr_index, 2 * lines->n_lines);
  b.node_of = AQR_NEW(c, aqr_index, s->n_clean);
  AQR_REQUIRE(net->edge_at && b.stop_of && b.node_of, AQR_OUT_OF_MEMORY);
  for (size_t i = 0; i < lines->n_samples; i++)
    net->edge_at[i] = AQR_NONE;
  for (size_t i = 0; i < 2 * lines->n_lines; i++)
    b.stop_of[i] = AQR_NONE;
  for (size_t i = 0; i < s->n_clean; i++)
    b.node_of[i] = AQR_NONE;
  AQR_TRY(aqr_crossings_find(c, s, lines, net, &b.order));
  AQR_TRY(prune(&b));
  AQR_TRY(aqr_place_stops(&b));
  AQR_TRY(connect(&b));
done:
  aqr_crossing_order_free(c, &b.order);
  AQR_DROP(c, b.alive, lines->n_lines);
  AQR_DROP(c, b.reached, lines->n_lines);
  AQR_DROP(c, b.stop_of, 2 * lines->n_lines);
  AQR_DROP(c, b.node_of, s->n_clean);
  if (status != AQR_OK)
    aqr_network_free(c, net);
  return status;
}

void aqr_network_free(aqr_context* c, aqr_network* net)
{
  AQR_DROP(c, net->crossings, net->crossing_capacity);
  AQR_DROP(c, net->stops, net->stop_capacity);
  AQR_DROP(c, net->from, 2 * net->edge_capacity);
  AQR_DROP(c, net->next, 2 * net->edge_capacity);
  AQR_DROP(c, net->loop, 2 * net->edge_capacity);
  AQR_DROP(c, net->type, net->edge_capacity);
  AQR_DROP(c, net->edge_at, net->n_samples);
  memset(net, 0, sizeof *net);
}
