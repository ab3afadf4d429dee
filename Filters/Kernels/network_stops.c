/* SPDX-License-Identifier: BSD-3-Clause */
/* Paper 5: nodes of the network on boundaries and creases. */
#include "network_builder.h"

#include <stdlib.h>

/* A stop at the start of a sample is before all others of it. */
aqr_status aqr_add_stop(aqr_network_builder* b, aqr_index chain, aqr_index sample, double t, aqr_index* id)
{
  if (!AQR_RESERVE(b->c, b->net->stops, b->net->stop_capacity, b->net->n_stops + 1))
    return AQR_OUT_OF_MEMORY;
  *id = (aqr_index)b->net->n_stops++;
  b->net->stops[*id] = (aqr_stop){ chain, sample, t, -INFINITY, 0, AQR_NONE, AQR_NONE, AQR_NONE, AQR_NONE };
  return AQR_OK;
}

/* Where on a chain a line ends. */
static bool landing_on(const aqr_network_builder* b, const aqr_sample* a, aqr_stop* stop)
{
  aqr_index k = aqr_chain_at(b->s, b->l, a);
  if (k == AQR_NONE)
    return false;
  const aqr_sample* on = &b->l->samples[k];
  bool forward = on->edge == a->edge;
  *stop = (aqr_stop){ on->line, k, forward ? a->t : 1 - a->t, forward ? a->t : -a->t,
    forward ? (int64_t)a->key : -(int64_t)a->key, AQR_NONE, AQR_NONE, AQR_NONE, AQR_NONE };
  return true;
}

/* Of a sample at the end of a line. */
static const aqr_index* stop_at_end(const aqr_network_builder* b, aqr_index sample)
{
  aqr_index line = b->l->samples[sample].line;
  return &b->stop_of[2 * (size_t)line + (sample != b->l->lines[line].first)];
}

/* Stops where living lines end on chains; a line and its continuation over the seam share one. */
static aqr_status stop_at_landings(aqr_network_builder* b)
{
  const aqr_lines* l = b->l;
  for (aqr_index i = 0; i < l->n_lines; i++)
  {
    const aqr_line* line = &l->lines[i];
    if (line->is_chain || !aqr_line_lives(b, i))
      continue;
    for (unsigned k = 0; k < 2; k++)
    {
      aqr_index sample = (aqr_index)(line->first + (k ? line->count - 1 : 0)), id;
      aqr_stop stop;
      if (!aqr_ends_on_chain(line, k))
        continue;
      aqr_index* own = &b->stop_of[2 * (size_t)i + k];
      if (line->partner[k] != AQR_NONE)
        *own = *stop_at_end(b, line->partner[k]);
      if (*own != AQR_NONE)
        continue;
      if (!landing_on(b, &l->samples[sample], &stop))
        return AQR_INTERNAL;
      aqr_status status = aqr_add_stop(b, stop.chain, stop.sample, stop.t, &id);
      if (status != AQR_OK)
        return status;
      b->net->stops[id] = stop;
      *own = id;
    }
  }
  return AQR_OK;
}

static int by_position(const void* a, const void* b)
{
  const aqr_stop *x = a, *y = b;
  if (x->chain != y->chain)
    return x->chain < y->chain ? -1 : 1;
  if (x->sample != y->sample)
    return x->sample < y->sample ? -1 : 1;
  if (x->along < y->along || x->along > y->along)
    return x->along < y->along ? -1 : 1;
  return (x->key > y->key) - (x->key < y->key);
}

static vec3 stop_position(const aqr_network_builder* b, const aqr_stop* x)
{
  const aqr_sample* a = &b->l->samples[x->sample];
  return x->t > 0 ? v3_madd(a->p, x->t, v3_sub(a[1].p, a->p)) : a->p;
}

/* Of the chain's samples strictly between two positions the one farthest from the chord between them; false below
 * `least`. */
static bool farthest(
  const aqr_network_builder* b, aqr_index low, aqr_index high, vec3 p, vec3 q, double least, aqr_index* sample)
{
  double best = least;
  bool found = false;
  for (aqr_index i = low; i < high; i++)
  {
    double distance = sqrt(v3_segment_distance2(b->l->samples[i].p, p, q));
    if (distance > best)
    {
      best = distance;
      *sample = i;
      found = true;
    }
  }
  return found;
}

/* Adds stops at samples in [low, high) until the chords between p and q keep the tolerance (Douglas and
 * Peucker). */
static aqr_status refine(
  aqr_network_builder* b, aqr_index chain, aqr_index low, aqr_index high, vec3 p, vec3 q, double tolerance)
{
  enum
  {
    depth = 64 /* of each two stretches the shorter is taken first: what waits is never more than there are halvings of
                  all indices, and one */
  };
  struct
  {
    aqr_index low, high;
    vec3 p, q;
  } stack[depth];
  int n = 0;
  stack[n].low = low;
  stack[n].high = high;
  stack[n].p = p;
  stack[n++].q = q;
  while (n)
  {
    n--;
    aqr_index lo = stack[n].low, hi = stack[n].high, at = lo, id;
    vec3 a = stack[n].p, z = stack[n].q;
    if (!farthest(b, lo, hi, a, z, tolerance, &at) || n + 2 > depth)
      continue;
    aqr_status status = aqr_add_stop(b, chain, at, 0, &id);
    if (status != AQR_OK)
      return status;
    vec3 m = b->l->samples[at].p;
    bool left_longer = at - lo > hi - at; /* the longer half first, so that it waits */
    for (unsigned i = 0; i < 2; i++)
    {
      bool left = (i == 0) == left_longer;
      stack[n].low = left ? lo : at + 1;
      stack[n].high = left ? at : hi;
      stack[n].p = left ? a : m;
      stack[n++].q = left ? m : z;
    }
  }
  return AQR_OK;
}

/* Stops that keep the chain's own shape; a loop gets at least three. */
static aqr_status stop_for_shape(aqr_network_builder* b, aqr_index chain, size_t first, size_t end)
{
  const aqr_line* line = &b->l->lines[chain];
  double tolerance = b->tolerance[line->type == AQR_LINE_FEATURE ? 0 : 1];
  aqr_index low = (aqr_index)line->first, last = (aqr_index)(line->first + line->count - 1);
  vec3 start = b->l->samples[low].p, p = start;
  aqr_status status = AQR_OK;
  if (line->closed && first == end) /* no line reaches the loop: thirds of it */
  {
    for (aqr_index k = 0; k < 3; k++)
    {
      aqr_index id, at = low + k * (last - low) / 3, to = low + (k + 1) * (last - low) / 3;
      AQR_TRY(aqr_add_stop(b, chain, at, 0, &id));
      AQR_TRY(refine(b, chain, at + 1, to, b->l->samples[at].p, b->l->samples[to].p, tolerance));
    }
    return AQR_OK;
  }
  if (line->closed)
  {
    /* the stretch over the loop's start is refined as two, with a stop at the start */
    aqr_index id;
    bool has_start = b->net->stops[first].sample == low && b->net->stops[first].t <= 0;
    if (!has_start)
      AQR_TRY(aqr_add_stop(b, chain, low, 0, &id));
    if (end - first == 1 && has_start) /* one stop alone: two more make it a polygon */
    {
      AQR_TRY(aqr_add_stop(b, chain, low + (last - low) / 3, 0, &id));
      AQR_TRY(aqr_add_stop(b, chain, low + 2 * (last - low) / 3, 0, &id));
    }
  }
  aqr_index from = low + 1;
  for (size_t i = first; i < end; i++)
  {
    const aqr_stop x = b->net->stops[i];
    vec3 q = stop_position(b, &x);
    aqr_index to = x.t > 0 ? x.sample + 1 : x.sample;
    if (from < to)
      AQR_TRY(refine(b, chain, from, to, p, q, tolerance));
    from = x.sample + 1;
    p = q;
  }
  if (from < last)
    AQR_TRY(refine(b, chain, from, last, p, b->l->samples[last].p, tolerance));
done:
  return status;
}

/* Sorts the stops along their chains and keeps the lines' references to them right. */
static aqr_status sort_stops(aqr_network_builder* b)
{
  aqr_network* net = b->net;
  size_t n = net->n_stops;
  aqr_index* rank = AQR_NEW(b->c, aqr_index, n);
  if (!rank)
    return AQR_OUT_OF_MEMORY;
  for (size_t i = 0; i < n; i++)
    net->stops[i].left = (aqr_index)i; /* where it stood */
  if (n)
    qsort(net->stops, n, sizeof *net->stops, by_position);
  /* two stops at one place: the first serves both */
  size_t kept = 0;
  for (size_t i = 0; i < n; i++)
  {
    aqr_stop x = net->stops[i];
    if (kept == 0 || by_position(&net->stops[kept - 1], &x) != 0 || x.t > 0)
    {
      net->stops[kept] = x;
      net->stops[kept++].left = AQR_NONE;
    }
    rank[x.left] = (aqr_index)(kept - 1);
  }
  net->n_stops = kept;
  for (size_t i = 0; i < 2 * b->l->n_lines; i++)
    if (b->stop_of[i] != AQR_NONE)
      b->stop_of[i] = rank[b->stop_of[i]];
  AQR_DROP(b->c, rank, n);
  return AQR_OK;
}

aqr_status aqr_place_stops(aqr_network_builder* b)
{
  aqr_network* net = b->net;
  aqr_status status = AQR_OK;
  AQR_TRY(stop_at_landings(b));
  AQR_TRY(sort_stops(b));
  size_t landed = net->n_stops, first = 0;
  for (aqr_index i = 0; i < b->l->n_lines && b->l->lines[i].is_chain; i++)
  {
    size_t end = first;
    while (end < landed && net->stops[end].chain == i)
      end++;
    AQR_TRY(stop_for_shape(b, i, first, end));
    first = end;
  }
  AQR_TRY(sort_stops(b));
done:
  return status;
}
