/* SPDX-License-Identifier: BSD-3-Clause */
#include "lines.h"

#include <string.h>

aqr_status aqr_lines_init(aqr_context* c, const aqr_surface* s, aqr_lines* l)
{
  memset(l, 0, sizeof *l);
  l->head = AQR_NEW(c, aqr_index, s->n_faces);
  if (!l->head)
    return AQR_OUT_OF_MEMORY;
  l->n_faces = s->n_faces;
  for (size_t f = 0; f < s->n_faces; f++)
    l->head[f] = AQR_NONE;
  return AQR_OK;
}

void aqr_lines_free(aqr_context* c, aqr_lines* l)
{
  AQR_DROP(c, l->lines, l->line_capacity);
  AQR_DROP(c, l->samples, l->sample_capacity);
  AQR_DROP(c, l->across, l->across_capacity);
  AQR_DROP(c, l->head, l->n_faces);
  memset(l, 0, sizeof *l);
}

bool aqr_border_before(const aqr_surface* s, aqr_index f, const aqr_sample* a, const aqr_sample* b)
{
  aqr_index ha = aqr_sample_half_edge(s, a, f), hb = aqr_sample_half_edge(s, b, f);
  if (ha != hb)
    return ha < hb;
  bool before = a->t < b->t || (a->t == b->t && a->key < b->key);
  bool same = a->t == b->t && a->key == b->key;
  return !same && (ha == a->edge ? before : !before);
}

int aqr_chords_cross(const aqr_surface* s, aqr_index f, const aqr_sample* a0, const aqr_sample* a1,
  const aqr_sample* b0, const aqr_sample* b1)
{
  bool turn = aqr_border_before(s, f, a1, a0); /* then the stretch from a1 to a0 does not wrap */
  const aqr_sample *low = turn ? a1 : a0, *high = turn ? a0 : a1;
  bool start = aqr_border_before(s, f, low, b0) && aqr_border_before(s, f, b0, high);
  bool end = aqr_border_before(s, f, low, b1) && aqr_border_before(s, f, b1, high);
  if (start == end)
    return 0;
  /* left of a is the stretch counter-clockwise from a1 to a0 */
  return end == turn ? 1 : -1;
}

aqr_index aqr_chain_at(const aqr_surface* s, const aqr_lines* l, const aqr_sample* at)
{
  aqr_index other = aqr_any_twin(s, at->edge);
  const aqr_index f = aqr_face_of(at->edge);
  for (aqr_index n = l->head[f]; n != AQR_NONE; n = aqr_next_chord(l, n, f))
  {
    aqr_index e = l->samples[n].edge;
    if (l->lines[l->samples[n].line].is_chain && (e == at->edge || e == other))
      return n;
  }
  return AQR_NONE;
}

/* A line and its continuation over a seam meet it at one place: what else meets it there lies to the same side of both.
 */
static void share_place(aqr_lines* l, size_t sample, aqr_index partner)
{
  l->samples[sample].p = l->samples[partner].p;
  l->samples[sample].t = l->samples[partner].t;
  l->samples[sample].key = l->samples[partner].key;
}

aqr_status aqr_lines_add(
  aqr_context* c, aqr_lines* l, const aqr_surface* s, const aqr_line* line, const aqr_sample* samples)
{
  size_t n = line->count;
  if (l->n_samples + n >= AQR_NONE / 2)
    return AQR_TOO_LARGE;
  if (!AQR_RESERVE(c, l->lines, l->line_capacity, l->n_lines + 1) ||
      !AQR_RESERVE(c, l->samples, l->sample_capacity, l->n_samples + n) ||
      (line->is_chain && !AQR_RESERVE(c, l->across, l->across_capacity, l->n_samples + n)))
    return AQR_OUT_OF_MEMORY;
  aqr_index id = (aqr_index)l->n_lines++;
  l->lines[id] = *line;
  l->lines[id].first = l->n_samples;
  memcpy(l->samples + l->n_samples, samples, n * sizeof *samples);
  for (size_t i = 0; i < n; i++)
  {
    aqr_sample* a = &l->samples[l->n_samples + i];
    a->key = (aqr_index)(l->n_samples + i);
    a->line = id;
    a->next = AQR_NONE;
  }
  if (line->closed) /* the closing sample is the first one again */
    l->samples[l->n_samples + n - 1].key = (aqr_index)l->n_samples;
  for (unsigned k = 0; k < 2; k++)
    if (line->partner[k] != AQR_NONE)
      share_place(l, l->n_samples + (k ? n - 1 : 0), line->partner[k]);
  for (size_t i = 0; i + 1 < n; i++)
  {
    aqr_index k = (aqr_index)(l->n_samples + i), *head = &l->head[samples[i].face];
    l->samples[k].next = *head;
    *head = k;
    aqr_index other = line->is_chain ? aqr_any_twin(s, samples[i].edge) : AQR_NONE;
    if (other == AQR_NONE)
      continue;
    l->across[k] = l->head[aqr_face_of(other)];
    l->head[aqr_face_of(other)] = k;
  }
  l->n_samples += n;
  return AQR_OK;
}
