/* SPDX-License-Identifier: BSD-3-Clause */
/* From the layouts of faces to cells and pieces, with room for an arc between any two chords. */
#include "region_cells.h"

/* Vertices of the graph that pieces run between: points of the surface, and both sides of the samples. The last sample
 * of a closed line is its first. */
static aqr_index vertex_beside(const aqr_regions* r, const aqr_border_mark* m, bool after)
{
  const aqr_line* line = &r->lines->lines[m->line];
  bool right = m->starts == after, closes = line->closed && m->sample == line->first + line->count - 1;
  return (aqr_index)(r->s->n_points + 2 * (closes ? line->first : (size_t)m->sample) + right);
}

static double position_on(const aqr_regions* r, aqr_index h, const aqr_border_mark* m)
{
  const aqr_sample* a = &r->lines->samples[m->sample];
  return a->edge == h ? a->t : 1 - a->t;
}

/* Halfway from a position on half-edge k to the next mark, kept or not, or to the end of the half-edge. */
static double halfway(const aqr_regions* r, unsigned k, double from)
{
  size_t first, end;
  aqr_layout_marks_on(&r->at, k, &first, &end);
  double to = 1;
  for (size_t i = first; i < end; i++)
  {
    double t = position_on(r, 3 * r->at.face + k, &r->at.marks[i]);
    if (t > from && t < to)
      to = t;
  }
  return (from + to) / 2;
}

static aqr_status add_piece(aqr_context* c, aqr_region_cells* g, aqr_piece p)
{
  if (!AQR_RESERVE(c, g->pieces, g->piece_capacity, g->n_pieces + 1))
    return AQR_OUT_OF_MEMORY;
  g->pieces[g->n_pieces++] = p;
  return AQR_OK;
}

/* The pieces of half-edge k between its corners and kept marks. */
static aqr_status add_pieces_on(const aqr_regions* r, aqr_region_cells* g, unsigned k, aqr_index first_cell)
{
  const aqr_layout* a = &r->at;
  const aqr_surface* s = r->s;
  aqr_index h = 3 * a->face + k;
  size_t first, end;
  aqr_layout_marks_on(&r->at, k, &first, &end);
  aqr_piece p = { .cell = first_cell + aqr_layout_cell_before(a, first),
    .half_edge = h,
    .from = aqr_from(s, h),
    .is_contact = aqr_twin(s, h) == AQR_NONE };
  double start = 0;
  for (size_t i = first; i <= end; i++)
  {
    bool last = i == end;
    if (!last && !a->marks[i].kept)
      continue;
    p.to = last ? aqr_to(s, h) : vertex_beside(r, &a->marks[i], false);
    p.t = halfway(r, k, start);
    aqr_status status = add_piece(r->c, g, p);
    if (status != AQR_OK || last)
      return status;
    start = position_on(r, h, &a->marks[i]);
    p.cell = first_cell + a->marks[i].cell;
    p.from = vertex_beside(r, &a->marks[i], true);
  }
  return AQR_OK;
}

/* The contacts of cells with chords: from where a stretch of a cell's border ends at a kept mark to where its next
 * begins. An arc leaves over such a contact just past the mark, so that it crosses the mark's chord. */
static aqr_status add_contacts(const aqr_regions* r, aqr_region_cells* g, aqr_index first_cell)
{
  const aqr_layout* a = &r->at;
  for (size_t i = 0; i < a->n_marks; i++)
  {
    if (!a->marks[i].kept)
      continue;
    unsigned cell = aqr_layout_cell_before(a, i);
    size_t next = i;
    do
      next = (next + 1) % a->n_marks;
    while (next != i && !(a->marks[next].kept && a->marks[next].cell == cell));
    aqr_index h = a->marks[i].half_edge;
    aqr_piece p = { .cell = first_cell + cell,
      .half_edge = h,
      .from = vertex_beside(r, &a->marks[i], false),
      .to = vertex_beside(r, &a->marks[next], true),
      .is_contact = true,
      .is_chord = true };
    p.t = halfway(r, h % 3, position_on(r, h, &a->marks[i]));
    aqr_status status = add_piece(r->c, g, p);
    if (status != AQR_OK)
      return status;
  }
  return AQR_OK;
}

static void move_sample(aqr_regions* r, const aqr_border_mark* m, double t)
{
  aqr_lines* l = r->lines;
  const aqr_line* line = &l->lines[m->line];
  size_t ends[2] = { m->sample, m->sample }, last = line->first + line->count - 1;
  if (line->closed && (m->sample == line->first || m->sample == last))
  {
    ends[0] = line->first;
    ends[1] = last;
  }
  for (unsigned i = 0; i < 2; i++)
  {
    l->samples[ends[i]].t = t;
    l->samples[ends[i]].p = aqr_edge_point(r->s, l->samples[m->sample].edge, t);
  }
}

/* Moves apart, by less than a thousandth of the way to the next, marks on half-edge k that lie at one place, so that an
 * arc can pass between any two. Their order stays. */
static void part_marks(aqr_regions* r, unsigned k)
{
  size_t first, end, n;
  aqr_layout_marks_on(&r->at, k, &first, &end);
  n = end - first;
  if (n < 2)
    return;
  const aqr_border_mark* m = r->at.marks;
  bool along = r->lines->samples[m[first].sample].edge == 3 * r->at.face + k;
  for (size_t i = 0, j; i < n; i = j)
  {
    double t = r->lines->samples[m[along ? first + i : end - 1 - i].sample].t, next = 1;
    for (j = i + 1; j < n; j++)
    {
      double after = r->lines->samples[m[along ? first + j : end - 1 - j].sample].t;
      if (after > t)
      {
        next = after;
        break;
      }
    }
    for (size_t a = i + 1; a < j; a++)
      move_sample(r, &m[along ? first + a : end - 1 - a], t + (next - t) * (double)(a - i) / (double)(1024 * (j - i)));
  }
}

/* Whether a face has a cell of a region to be cut. Every cell begins after an end of a chord that the network kept; a
 * face without such ends is one cell. */
static bool has_some_to_cut(const aqr_regions* r, aqr_index f)
{
  bool whole = true;
  for (aqr_index k = r->lines->head[f]; k != AQR_NONE; k = aqr_next_chord(r->lines, k, f))
    for (aqr_index i = 0; i < 2 && !r->lines->lines[r->lines->samples[k].line].is_chain; i++)
    {
      aqr_border_mark m = { .sample = k + i, .starts = i == 0 };
      if (r->net->edge_at[m.sample] == AQR_NONE)
        continue;
      if (aqr_region_needs_cut(r, aqr_item_after(r->s, r->net, &m)))
        return true;
      whole = false;
    }
  return whole && aqr_region_needs_cut(r, f);
}

static void pick_faces_to_cut(void* data, size_t begin, size_t end)
{
  aqr_regions* r = data;
  for (aqr_index f = (aqr_index)begin; f < end; f++)
    r->picked[f] = r->suspect[f] && has_some_to_cut(r, f);
}

aqr_status aqr_region_cells_list(aqr_regions* r, aqr_region_cells* g)
{
  const aqr_surface* s = r->s;
  aqr_status picked = aqr_parallel(r->c, s->n_faces, pick_faces_to_cut, r, 0.9, 0.95);
  if (picked != AQR_OK)
    return picked;
  for (aqr_index f = 0; f < s->n_faces; f++)
  {
    if (f % 65536 == 0 && !aqr_step(r->c, 0.95))
      return AQR_CANCELLED;
    g->slot[f] = AQR_NONE;
    if (!r->picked[f])
      continue;
    if (!aqr_layout_face(r->c, r->s, r->lines, r->net, f, &r->at))
      return AQR_OUT_OF_MEMORY;
    for (unsigned k = 0; k < 3; k++)
      part_marks(r, k);
    if (!AQR_RESERVE(r->c, g->cells, g->cell_capacity, g->n_cells + r->at.n_cells) ||
        !AQR_RESERVE(r->c, g->slots, g->slot_capacity, g->n_slots + 1))
      return AQR_OUT_OF_MEMORY;
    aqr_index first_cell = (aqr_index)g->n_cells;
    for (size_t i = 0; i < r->at.n_cells; i++)
      g->cells[g->n_cells++] =
        (aqr_region_cell){ f, AQR_NONE, AQR_NONE, UINT32_MAX, aqr_region_needs_cut(r, r->at.item[i]) };
    g->slot[f] = (aqr_index)g->n_slots;
    aqr_slot* at = &g->slots[g->n_slots++];
    for (unsigned k = 0; k < 3; k++)
    {
      at->first[k] = (aqr_index)g->n_pieces;
      aqr_status status = add_pieces_on(r, g, k, first_cell);
      if (status != AQR_OK)
        return status;
    }
    at->first[3] = (aqr_index)g->n_pieces;
    aqr_status status = add_contacts(r, g, first_cell);
    if (status != AQR_OK)
      return status;
    at->end = (aqr_index)g->n_pieces;
  }
  return AQR_OK;
}

aqr_index aqr_piece_across(const aqr_region_cells* g, aqr_index i)
{
  aqr_index h = g->pieces[i].half_edge, t = aqr_twin(g->s, h);
  const aqr_slot *here = &g->slots[g->slot[h / 3]], *there = &g->slots[g->slot[t / 3]];
  return there->first[t % 3 + 1] - 1 - (i - here->first[h % 3]);
}

bool aqr_piece_leads_on(const aqr_region_cells* g, aqr_index i)
{
  aqr_index t = g->pieces[i].is_contact ? AQR_NONE : aqr_twin(g->s, g->pieces[i].half_edge);
  return t != AQR_NONE && g->slot[t / 3] != AQR_NONE;
}

void aqr_region_cells_free(aqr_context* c, aqr_region_cells* g)
{
  AQR_DROP(c, g->slot, g->s->n_faces);
  AQR_DROP(c, g->slots, g->slot_capacity);
  AQR_DROP(c, g->pieces, g->piece_capacity);
  AQR_DROP(c, g->cells, g->cell_capacity);
}
