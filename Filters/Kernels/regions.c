/* SPDX-License-Identifier: BSD-3-Clause */
/* Topology kept: where the paper (6) lets small handles vanish, regions that are not disks get another line. */
#include "regions.h"

#include "face_layout.h"
#include "shared.h"

#include <stdlib.h>
#include <string.h>

/* A piece of a cell's border: of an edge of the face, or a contact with the network. */
typedef struct piece
{
  aqr_index cell, half_edge;
  aqr_index from, to; /* vertices */
  double t;           /* where an arc passes, on half_edge */
  bool is_contact;    /* the network lies there: a chain's edge, or a chord past whose end on half_edge the arc goes */
  bool is_chord;
} piece;

/* The pieces of a face: of half-edge k from first[k] on, contacts with chords from first[3] to end. */
typedef struct slot
{
  aqr_index first[4], end;
} slot;

typedef _Atomic(int32_t) shared_number;
typedef _Atomic(uint8_t) shared_flag;

typedef struct regions
{
  aqr_context* c;
  const aqr_surface* s;
  const aqr_chains* chains;
  const aqr_network* net;
  aqr_lines* lines;
  /* Shared by threads; whatever their order, a root is the least item of its region and sums are the same. */
  aqr_shared_index* parent; /* union-find over items: faces without chords, then loops */
  size_t n_items;
  shared_number* euler;  /* per item, and of its whole region per root when all is counted */
  shared_flag* bordered; /* as euler: bit 0 has a loop, bit 1 has a cell, bit 2 goes on among faces not looked at */
  uint8_t* suspect;      /* per face: looked at */
  uint8_t* picked;       /* per face: to be looked at by one thread alone */
  uint8_t* is_bare;      /* per face: of a component without network */
  aqr_index* start;      /* per half-edge: the item where it begins, AQR_NONE where it is cut */
  aqr_layout at;         /* of the face looked at */
  /* of regions to be cut */
  aqr_index* slot; /* per face: where its pieces are listed, or AQR_NONE */
  slot* slots;
  size_t n_slots, slot_capacity;
  piece* pieces;
  size_t n_pieces, piece_capacity;
  struct cell
  {
    aqr_index face;
    aqr_index before;  /* the cell the search came from; AQR_NONE at a root */
    aqr_index exit;    /* the piece of this cell towards it, or the root's contact */
    uint32_t distance; /* UINT32_MAX: not reached */
    bool wanted;       /* of a region to be cut */
  } * cells;
  size_t n_cells, cell_capacity;
  aqr_index* queue;
  size_t queue_capacity;
  aqr_sample* drawn; /* of the arcs, one after the other */
  size_t n_drawn, drawn_capacity;
  aqr_line* arcs; /* `first` into drawn */
  size_t n_arcs, arc_capacity;
} regions;

/* ---- items ---- */

static aqr_index find(const regions* r, aqr_index i)
{
  return aqr_root(r->parent, i);
}

static void unite(const regions* r, aqr_index a, aqr_index b)
{
  aqr_unite(r->parent, a, b);
}

static void add_euler(const regions* r, aqr_index item, int32_t more)
{
  atomic_fetch_add_explicit(&r->euler[item], more, memory_order_relaxed);
}

static void add_border(const regions* r, aqr_index item, uint8_t bits)
{
  if (bits & ~atomic_load_explicit(&r->bordered[item], memory_order_relaxed))
    atomic_fetch_or_explicit(&r->bordered[item], bits, memory_order_relaxed);
}

static aqr_index item_after(const regions* r, const aqr_border_mark* m)
{
  return aqr_item_after(r->s, r->net, m);
}

static aqr_index item_before(const regions* r, const aqr_border_mark* m)
{
  return aqr_item_before(r->s, r->net, m);
}

static bool lay_out(regions* r, aqr_index f)
{
  return aqr_layout_face(r->c, r->s, r->lines, r->net, f, &r->at);
}

/* ---- counting ---- */

static aqr_index item_at_start(const aqr_layout* a, unsigned k)
{
  size_t first, end;
  aqr_layout_marks_on(a, k, &first, &end);
  return a->item[aqr_layout_cell_before(a, first)];
}

static size_t kept_on(const aqr_layout* a, unsigned k)
{
  size_t first, end, kept = 0;
  aqr_layout_marks_on(a, k, &first, &end);
  for (size_t i = first; i < end; i++)
    kept += a->marks[i].kept;
  return kept;
}

/* Unites the cells that border chains with the loops there, where no mark tells the loop already. */
static void unite_with_chains(const regions* r, const aqr_layout* a)
{
  for (aqr_index k = r->lines->head[a->face]; k != AQR_NONE; k = r->lines->segments[k].next)
  {
    aqr_index n = r->lines->segments[k].sample;
    if (!r->lines->lines[r->lines->segments[k].line].is_chain)
      continue;
    aqr_index left = r->lines->samples[n].edge, edge = r->net->edge_at[n];
    bool right = aqr_face_of(left) != a->face;
    aqr_index h = right ? aqr_any_twin(r->s, left) : left;
    if (kept_on(a, h % 3) == 0)
      unite(r, item_at_start(a, h % 3), (aqr_index)r->s->n_faces + r->net->loop[2 * edge + right]);
  }
}

/* Without chords and chains: one cell. */
static bool is_plain(const regions* r, aqr_index f)
{
  return r->lines->head[f] == AQR_NONE;
}

/* Unites what belongs together inside a face. */
static void unite_inside(const regions* r, const aqr_layout* a)
{
  for (size_t i = 0; i < a->n_marks; i++)
  {
    aqr_index item = a->item[a->marks[i].cell];
    if (a->marks[i].kept)
      unite(r, item, item_after(r, &a->marks[i]));
    if (a->marks[(i + 1) % a->n_marks].kept)
      unite(r, item, item_before(r, &a->marks[(i + 1) % a->n_marks]));
  }
  unite_with_chains(r, a);
  for (unsigned k = 0; k < 3; k++)
    r->start[3 * a->face + k] = kept_on(a, k) ? AQR_NONE : item_at_start(a, k);
}

static bool on_chain(const regions* r, aqr_index point)
{
  return r->chains->is_node[r->s->clean[point]] != 0;
}

/* A stretch between two cells of one region. */
static void count_stretch(const regions* r, aqr_index item, bool leaves)
{
  add_euler(r, item, -1);
  if (leaves)
    add_border(r, item, 4);
}

static void count_plain(const regions* r, aqr_index f)
{
  const aqr_surface* s = r->s;
  int32_t euler = 1;
  uint8_t bordered = 2;
  for (aqr_index h = 3 * f; h < 3 * f + 3; h++)
  {
    aqr_index t = aqr_twin(s, h), v = aqr_from(s, h);
    bool leaves = t != AQR_NONE && !r->suspect[aqr_face_of(t)];
    euler += s->fan[v] == h && !on_chain(r, v);
    euler -= t != AQR_NONE && (t > h || leaves);
    bordered |= leaves ? 4 : 0;
  }
  atomic_store_explicit(&r->euler[f], euler, memory_order_relaxed); /* the item is this face's alone */
  atomic_store_explicit(&r->bordered[f], bordered, memory_order_relaxed);
}

/* Cells minus stretches plus vertices. */
static void count_cells(const regions* r, const aqr_layout* a)
{
  const aqr_surface* s = r->s;
  for (size_t i = 0; i < a->n_cells; i++)
  {
    add_euler(r, a->item[i], 1);
    add_border(r, a->item[i], 2);
  }
  for (unsigned k = 0; k < 3; k++)
  {
    aqr_index h = 3 * a->face + k, t = aqr_twin(s, h), v = aqr_from(s, h);
    if (s->fan[v] == h && !on_chain(r, v))
      add_euler(r, item_at_start(a, k), 1);
    bool leaves = t != AQR_NONE && !r->suspect[aqr_face_of(t)];
    if (t == AQR_NONE || (t < h && !leaves))
      continue;
    size_t first, end;
    aqr_layout_marks_on(a, k, &first, &end);
    count_stretch(r, a->item[aqr_layout_cell_before(a, first)], leaves);
    for (size_t i = first; i < end; i++)
      if (a->marks[i].kept)
        count_stretch(r, a->item[a->marks[i].cell], leaves);
  }
}

static void enter_face(const regions* r, const aqr_layout* a)
{
  unite_inside(r, a);
  count_cells(r, a);
}

static void enter_faces(void* data, size_t begin, size_t end)
{
  regions* r = data;
  aqr_small_layout room;
  aqr_layout a = aqr_layout_in(&room);
  for (aqr_index f = (aqr_index)begin; f < end; f++)
    if (r->suspect[f] && is_plain(r, f))
    {
      r->start[3 * f] = r->start[3 * f + 1] = r->start[3 * f + 2] = f;
      count_plain(r, f);
    }
    else if (r->suspect[f] && aqr_layout_face(NULL, r->s, r->lines, r->net, f, &a))
      enter_face(r, &a);
    else
      r->picked[f] = r->suspect[f];
}

/* What threads have no room for. */
static aqr_status enter_large(regions* r)
{
  for (aqr_index f = 0; f < r->s->n_faces; f++)
  {
    if (!r->picked[f])
      continue;
    if (!lay_out(r, f))
      return AQR_OUT_OF_MEMORY;
    enter_face(r, &r->at);
  }
  return AQR_OK;
}

/* Unites over whole edges. Stretches of cut edges need nothing: both sides of them border the same loop. */
static void unite_over(void* data, size_t begin, size_t end)
{
  const regions* r = data;
  for (aqr_index h = (aqr_index)begin; h < end; h++)
  {
    aqr_index t = r->suspect[aqr_face_of(h)] ? aqr_twin(r->s, h) : AQR_NONE;
    if (t != AQR_NONE && t < h && r->suspect[aqr_face_of(t)] && r->start[t] != AQR_NONE && r->start[h] != AQR_NONE)
      unite(r, r->start[h], r->start[t]);
  }
}

/* What the items of a region were counted goes to its root. */
static void add_up(void* data, size_t begin, size_t end)
{
  const regions* r = data;
  for (aqr_index i = (aqr_index)begin; i < end; i++)
  {
    aqr_index root = find(r, i);
    if (root == i)
      continue;
    add_euler(r, root, atomic_load_explicit(&r->euler[i], memory_order_relaxed));
    add_border(r, root, atomic_load_explicit(&r->bordered[i], memory_order_relaxed));
  }
}

static void begin_items(void* data, size_t begin, size_t end)
{
  regions* r = data;
  for (size_t i = begin; i < end; i++)
  {
    atomic_init(&r->parent[i], (aqr_index)i);
    atomic_init(&r->euler[i], 0);
    atomic_init(&r->bordered[i], i >= r->s->n_faces);
  }
}

static void mark_bare(void* data, size_t begin, size_t end)
{
  regions* r = data;
  for (size_t f = begin; f < end; f++)
    if (r->suspect[f])
      r->is_bare[f] = r->start[3 * f] != AQR_NONE && !(r->bordered[find(r, r->start[3 * f])] & 1);
}

/* Finds the regions, of each its Euler number, and components without network. */
static aqr_status count(regions* r)
{
  aqr_status status = AQR_OK;
  size_t n = r->s->n_faces;
  AQR_TRY(aqr_parallel(r->c, r->n_items, begin_items, r, 0, 0));
  AQR_TRY(aqr_parallel(r->c, n, enter_faces, r, 0, 0.7));
  AQR_TRY(enter_large(r));
  AQR_TRY(aqr_parallel(r->c, 3 * n, unite_over, r, 0.7, 0.8));
  AQR_TRY(aqr_parallel(r->c, r->n_items, add_up, r, 0.8, 0.9));
  AQR_TRY(aqr_parallel(r->c, n, mark_bare, r, 0.9, 0.9));
done:
  return status;
}

/* A region that arcs must cut. Loops that no stretch of a border belongs to lie inside one face and are disks. */
static bool needs_cut(const regions* r, aqr_index item)
{
  aqr_index root = find(r, item);
  return r->bordered[root] == 3 && r->euler[root] < 1;
}

/* ---- the cells of the regions to be cut ---- */

/* Vertices of the graph that pieces run between: points of the surface, and both sides of the samples. */
static aqr_index vertex_beside(const regions* r, const aqr_border_mark* m, bool after)
{
  bool right = m->starts == after;
  return (aqr_index)(r->s->n_points + 2 * (size_t)m->sample + right);
}

static double position_on(const regions* r, aqr_index h, const aqr_border_mark* m)
{
  const aqr_sample* a = &r->lines->samples[m->sample];
  return a->edge == h ? a->t : 1 - a->t;
}

/* Halfway from a position on half-edge k to the next mark, kept or not, or to the end of the half-edge. */
static double halfway(const regions* r, unsigned k, double from, bool forward)
{
  size_t first, end;
  aqr_layout_marks_on(&r->at, k, &first, &end);
  double to = forward ? 1 : 0;
  for (size_t i = first; i < end; i++)
  {
    double t = position_on(r, 3 * r->at.face + k, &r->at.marks[i]);
    if (forward ? t > from && t < to : t < from && t > to)
      to = t;
  }
  return (from + to) / 2;
}

static aqr_status add_piece(regions* r, piece p)
{
  if (!AQR_RESERVE(r->c, r->pieces, r->piece_capacity, r->n_pieces + 1))
    return AQR_OUT_OF_MEMORY;
  r->pieces[r->n_pieces++] = p;
  return AQR_OK;
}

/* The pieces of half-edge k between its corners and kept marks. */
static aqr_status add_pieces_on(regions* r, unsigned k, aqr_index first_cell)
{
  const aqr_layout* a = &r->at;
  const aqr_surface* s = r->s;
  aqr_index h = 3 * a->face + k;
  size_t first, end;
  aqr_layout_marks_on(&r->at, k, &first, &end);
  piece p = { .cell = first_cell + aqr_layout_cell_before(a, first),
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
    p.t = halfway(r, k, start, true);
    aqr_status status = add_piece(r, p);
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
static aqr_status add_contacts(regions* r, aqr_index first_cell)
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
    piece p = { .cell = first_cell + cell,
      .half_edge = h,
      .from = vertex_beside(r, &a->marks[i], false),
      .to = vertex_beside(r, &a->marks[next], true),
      .is_contact = true,
      .is_chord = true };
    p.t = halfway(r, h % 3, position_on(r, h, &a->marks[i]), true);
    aqr_status status = add_piece(r, p);
    if (status != AQR_OK)
      return status;
  }
  return AQR_OK;
}

static void move_sample(regions* r, const aqr_border_mark* m, double t)
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
static void part_marks(regions* r, unsigned k)
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
static bool has_some_to_cut(const regions* r, aqr_index f)
{
  bool whole = true;
  for (aqr_index k = r->lines->head[f]; k != AQR_NONE; k = r->lines->segments[k].next)
  {
    const aqr_segment* chord = &r->lines->segments[k];
    for (aqr_index i = 0; i < 2 && !r->lines->lines[chord->line].is_chain; i++)
    {
      aqr_border_mark m = { .sample = chord->sample + i, .starts = i == 0 };
      if (r->net->edge_at[m.sample] == AQR_NONE)
        continue;
      if (needs_cut(r, item_after(r, &m)))
        return true;
      whole = false;
    }
  }
  return whole && needs_cut(r, f);
}

static void pick_faces_to_cut(void* data, size_t begin, size_t end)
{
  regions* r = data;
  for (aqr_index f = (aqr_index)begin; f < end; f++)
    r->picked[f] = r->suspect[f] && has_some_to_cut(r, f);
}

/* Lists the cells of all faces that have some of a region to be cut, and their pieces. */
static aqr_status list_cells(regions* r)
{
  const aqr_surface* s = r->s;
  aqr_status picked = aqr_parallel(r->c, s->n_faces, pick_faces_to_cut, r, 0.9, 0.95);
  if (picked != AQR_OK)
    return picked;
  for (aqr_index f = 0; f < s->n_faces; f++)
  {
    if (f % 65536 == 0 && !aqr_step(r->c, 0.95))
      return AQR_CANCELLED;
    r->slot[f] = AQR_NONE;
    if (!r->picked[f])
      continue;
    if (!lay_out(r, f))
      return AQR_OUT_OF_MEMORY;
    for (unsigned k = 0; k < 3; k++)
      part_marks(r, k);
    if (!AQR_RESERVE(r->c, r->cells, r->cell_capacity, r->n_cells + r->at.n_cells) ||
        !AQR_RESERVE(r->c, r->slots, r->slot_capacity, r->n_slots + 1))
      return AQR_OUT_OF_MEMORY;
    aqr_index first_cell = (aqr_index)r->n_cells;
    for (size_t i = 0; i < r->at.n_cells; i++)
      r->cells[r->n_cells++] = (struct cell){ f, AQR_NONE, AQR_NONE, UINT32_MAX, needs_cut(r, r->at.item[i]) };
    r->slot[f] = (aqr_index)r->n_slots;
    slot* at = &r->slots[r->n_slots++];
    for (unsigned k = 0; k < 3; k++)
    {
      at->first[k] = (aqr_index)r->n_pieces;
      aqr_status status = add_pieces_on(r, k, first_cell);
      if (status != AQR_OK)
        return status;
    }
    at->first[3] = (aqr_index)r->n_pieces;
    aqr_status status = add_contacts(r, first_cell);
    if (status != AQR_OK)
      return status;
    at->end = (aqr_index)r->n_pieces;
  }
  return AQR_OK;
}

/* The same piece seen from the other face: pieces of an edge come in opposite orders on its two sides. */
static aqr_index across(const regions* r, aqr_index i)
{
  aqr_index h = r->pieces[i].half_edge, t = aqr_twin(r->s, h);
  const slot *here = &r->slots[r->slot[h / 3]], *there = &r->slots[r->slot[t / 3]];
  return there->first[t % 3 + 1] - 1 - (i - here->first[h % 3]);
}

static bool leads_on(const regions* r, aqr_index i)
{
  aqr_index t = r->pieces[i].is_contact ? AQR_NONE : aqr_twin(r->s, r->pieces[i].half_edge);
  return t != AQR_NONE && r->slot[t / 3] != AQR_NONE;
}

/* Breadth-first forest over the cells. Its roots are the cells that touch the network; each holds the contact over
 * which an arc leaves it, the others the piece over which the search came. */
static aqr_status search(regions* r)
{
  size_t head = 0, tail = 0;
  if (!AQR_RESERVE(r->c, r->queue, r->queue_capacity, r->n_cells))
    return AQR_OUT_OF_MEMORY;
  for (aqr_index i = 0; i < r->n_pieces; i++)
  {
    aqr_index k = r->pieces[i].cell;
    struct cell* at = &r->cells[k];
    if (!r->pieces[i].is_contact || !at->wanted || at->distance == 0)
      continue;
    at->distance = 0;
    at->exit = i;
    r->queue[tail++] = k;
  }
  while (head < tail)
  {
    aqr_index k = r->queue[head++];
    if (head % 4096 == 0 && !aqr_step(r->c, 0.97))
      return AQR_CANCELLED;
    const slot* at = &r->slots[r->slot[r->cells[k].face]];
    for (aqr_index i = at->first[0]; i < at->first[3]; i++)
    {
      if (r->pieces[i].cell != k || !leads_on(r, i))
        continue;
      aqr_index back = across(r, i);
      struct cell* next = &r->cells[r->pieces[back].cell];
      if (next->distance != UINT32_MAX)
        continue;
      next->distance = r->cells[k].distance + 1;
      next->before = k;
      next->exit = back;
      r->queue[tail++] = r->pieces[back].cell;
    }
  }
  return AQR_OK;
}

/* ---- arcs ---- */

/* A piece that the forest does not use: the arc over it leads to the network on both sides. */
typedef struct link
{
  aqr_index piece;
  uint32_t length;
} link;

static int by_length(const void* a, const void* b)
{
  const link *x = a, *y = b;
  if (x->length != y->length)
    return x->length < y->length ? -1 : 1;
  return (x->piece > y->piece) - (x->piece < y->piece);
}

static aqr_status gather_links(regions* r, link** links, size_t* n, size_t* capacity)
{
  for (aqr_index i = 0; i < r->n_pieces; i++)
  {
    const struct cell* at = &r->cells[r->pieces[i].cell];
    if (at->distance == UINT32_MAX || at->exit == i)
      continue;
    uint32_t length = at->distance;
    if (!r->pieces[i].is_contact)
    {
      if (!leads_on(r, i))
        continue;
      aqr_index back = across(r, i);
      const struct cell* other = &r->cells[r->pieces[back].cell];
      if (back < i || other->distance == UINT32_MAX || other->exit == back)
        continue;
      length += other->distance;
    }
    if (!AQR_RESERVE(r->c, *links, *capacity, *n + 1))
      return AQR_OUT_OF_MEMORY;
    (*links)[(*n)++] = (link){ i, length };
  }
  return AQR_OK;
}

/* What hangs at a vertex: how many links, and the exclusive or of their numbers, which is the link where there is one.
 */
typedef struct hub
{
  uint32_t degree, links;
} hub;

static void hang(const regions* r, hub* hubs, const link* links, uint32_t i, bool off)
{
  const piece* p = &r->pieces[links[i].piece];
  for (unsigned k = 0; k < 2; k++)
  {
    hub* at = &hubs[k ? p->to : p->from];
    at->degree += off ? UINT32_MAX : 1;
    at->links ^= i;
  }
}

/* Takes away the link that hangs alone at a vertex, and what then hangs alone at its other end, and so on: an arc over
 * one of those would cut off a disk. */
static void strip(const regions* r, hub* hubs, const link* links, uint8_t* gone, aqr_index vertex)
{
  while (hubs[vertex].degree == 1)
  {
    uint32_t i = hubs[vertex].links;
    /* NOLINTNEXTLINE(clang-analyzer-core.NullDereference): where a vertex has a degree there are links */
    const piece* p = &r->pieces[links[i].piece];
    gone[i] = 1;
    hang(r, hubs, links, i, true);
    vertex = p->from == vertex ? p->to : p->from;
  }
}

static aqr_status push(regions* r, aqr_index i, aqr_index face)
{
  const piece* p = &r->pieces[i];
  aqr_index edge = aqr_edge_of(r->s, p->half_edge);
  double t = edge == p->half_edge ? p->t : 1 - p->t;
  if (!AQR_RESERVE(r->c, r->drawn, r->drawn_capacity, r->n_drawn + 1))
    return AQR_OUT_OF_MEMORY;
  r->drawn[r->n_drawn++] = (aqr_sample){ .p = aqr_edge_point(r->s, edge, t), .t = t, .edge = edge, .face = face };
  return AQR_OK;
}

static uint8_t end_of(const regions* r, aqr_index i)
{
  const piece* p = &r->pieces[i];
  if (p->is_chord)
    return AQR_END_CUT;
  return aqr_is_seam(r->s, p->half_edge) ? AQR_END_FEATURE : AQR_END_BOUNDARY;
}

/* The way from a cell to the network, over the pieces the search came by; `towards` says whether a sample's face is
 * that of the chord after it on the way out, or before. */
static aqr_status push_way_out(regions* r, aqr_index k, bool outwards, uint8_t* end)
{
  for (;;)
  {
    const struct cell* at = &r->cells[k];
    bool last = at->before == AQR_NONE;
    aqr_index face = outwards && !last ? r->cells[at->before].face : at->face;
    aqr_status status = push(r, at->exit, face);
    if (status != AQR_OK)
      return status;
    if (last)
    {
      *end = end_of(r, at->exit);
      return AQR_OK;
    }
    k = at->before;
  }
}

/* Takes out of an arc the chords that go back to the edge they come from: they have no direction, and lead around
 * nothing but the end of a chord there, which the arc may as well pass on the other side of the edge. An arc keeps its
 * ends, on the network. */
static void straighten(regions* r, aqr_line* line)
{
  aqr_sample* a = r->drawn + line->first;
  size_t n = 0, count = r->n_drawn - line->first;
  for (size_t i = 0; i < count; i++)
  {
    if (n == 0 || a[n - 1].edge != a[i].edge)
      a[n++] = a[i];
    else if (n == 1)
      a[0].face = a[i].face;
    else if (i + 1 < count)
      n--;
    else
    {
      a[n - 1] = a[i];
      a[n - 1].face = a[n - 2].face;
    }
  }
  line->count = n;
  r->n_drawn = line->first + n;
}

/* Draws the arc over a link: from the network to the link on one side, from the link to the network on the other. */
static aqr_status draw(regions* r, const link* l)
{
  aqr_line line = { .first = r->n_drawn, .type = AQR_LINE_MIN, .partner = { AQR_NONE, AQR_NONE } };
  aqr_index cell = r->pieces[l->piece].cell;
  aqr_status status = AQR_OK;
  AQR_TRY(push_way_out(r, cell, false, &line.ends[0]));
  for (size_t a = line.first, z = r->n_drawn - 1; a < z; a++, z--)
  {
    aqr_sample swap = r->drawn[a];
    r->drawn[a] = r->drawn[z];
    r->drawn[z] = swap;
  }
  if (r->pieces[l->piece].is_contact)
  {
    AQR_TRY(push(r, l->piece, r->cells[cell].face));
    line.ends[1] = end_of(r, l->piece);
  }
  else
  {
    aqr_index other = r->pieces[across(r, l->piece)].cell;
    AQR_TRY(push(r, l->piece, r->cells[other].face));
    AQR_TRY(push_way_out(r, other, true, &line.ends[1]));
  }
  straighten(r, &line);
  if (line.count < 2)
    goto done;
  for (size_t k = line.first + 1; k < r->n_drawn; k++)
    r->drawn[k].arc = r->drawn[k - 1].arc + (float)v3_norm(v3_sub(r->drawn[k].p, r->drawn[k - 1].p));
  AQR_REQUIRE(AQR_RESERVE(r->c, r->arcs, r->arc_capacity, r->n_arcs + 1), AQR_OUT_OF_MEMORY);
  r->arcs[r->n_arcs++] = line;
done:
  return status;
}

/* Claims the cells that the arc over a link passes; false where another arc of this round has one of them. */
static bool claim(const regions* r, const link* l, uint8_t* taken)
{
  bool both = !r->pieces[l->piece].is_contact;
  for (unsigned pass = 0; pass < 2; pass++)
    for (unsigned k = 0; k < 1u + both; k++)
      for (aqr_index i = r->pieces[k ? across(r, l->piece) : l->piece].cell; i != AQR_NONE; i = r->cells[i].before)
      {
        if (pass == 0 && taken[i])
          return false;
        taken[i] |= (uint8_t)pass;
      }
  return true;
}

/* Arcs over the shortest links, as many as the regions need and as find room beside each other. Lines are added only
 * when all are drawn, so that the layouts stay those of the network. */
static aqr_status draw_arcs(regions* r, size_t* added)
{
  const aqr_surface* s = r->s;
  link* links = NULL;
  size_t n = 0, capacity = 0, n_hubs = s->n_points + 2 * r->lines->n_samples;
  hub* hubs = AQR_NEW(r->c, hub, n_hubs); /* the few that links hang at are set */
  uint8_t *gone = NULL, *taken = AQR_NEW0(r->c, uint8_t, r->n_cells);
  aqr_status status = AQR_OK;
  AQR_REQUIRE(hubs && taken, AQR_OUT_OF_MEMORY);
  AQR_TRY(gather_links(r, &links, &n, &capacity));
  gone = AQR_NEW0(r->c, uint8_t, n);
  AQR_REQUIRE(gone, AQR_OUT_OF_MEMORY);
  if (n)
    qsort(links, n, sizeof *links, by_length);
  for (uint32_t i = 0; i < n; i++)
    hubs[r->pieces[links[i].piece].from] = hubs[r->pieces[links[i].piece].to] = (hub){ 0, 0 };
  for (uint32_t i = 0; i < n; i++)
    hang(r, hubs, links, i, false);
  for (uint32_t i = 0; i < n; i++)
  {
    strip(r, hubs, links, gone, r->pieces[links[i].piece].from);
    strip(r, hubs, links, gone, r->pieces[links[i].piece].to);
  }
  for (uint32_t i = 0; i < n; i++)
  {
    if (gone[i])
      continue;
    if (claim(r, &links[i], taken))
      AQR_TRY(draw(r, &links[i]));
    gone[i] = 1;
    hang(r, hubs, links, i, true);
    strip(r, hubs, links, gone, r->pieces[links[i].piece].from);
    strip(r, hubs, links, gone, r->pieces[links[i].piece].to);
  }
  size_t n_arcs = r->n_arcs;
  for (size_t i = 0; i < n_arcs; i++)
    AQR_TRY(aqr_lines_add(r->c, r->lines, s, &r->arcs[i], r->drawn + r->arcs[i].first));
  *added = n_arcs;
done:
  AQR_DROP(r->c, links, capacity);
  AQR_DROP(r->c, gone, n);
  AQR_DROP(r->c, taken, r->n_cells);
  AQR_DROP(r->c, hubs, n_hubs);
  return status;
}

aqr_status aqr_regions_cut(aqr_context* c, const aqr_surface* s, const aqr_chains* chains, const aqr_network* net,
  aqr_lines* lines, uint8_t* is_bare, uint8_t* suspect, bool cut, size_t* added)
{
  regions r = { .c = c, .s = s, .chains = chains, .net = net, .lines = lines, .suspect = suspect, .is_bare = is_bare };
  aqr_status status = AQR_OK;
  *added = 0;
  r.n_items = s->n_faces + net->n_loops;
  r.start = AQR_NEW(c, aqr_index, 3 * s->n_faces);
  r.parent = AQR_NEW(c, aqr_shared_index, r.n_items);
  r.euler = AQR_NEW(c, shared_number, r.n_items);
  r.bordered = AQR_NEW(c, shared_flag, r.n_items);
  r.picked = AQR_NEW0(c, uint8_t, s->n_faces);
  r.slot = AQR_NEW(c, aqr_index, s->n_faces);
  AQR_REQUIRE(r.start && r.parent && r.euler && r.bordered && r.picked && r.slot, AQR_OUT_OF_MEMORY);
  AQR_TRY(count(&r));
  bool any = false;
  for (aqr_index i = 0; cut && i < r.n_items && !any; i++)
    any = aqr_above(r.parent, i) == i && needs_cut(&r, i);
  if (any)
  {
    AQR_TRY(list_cells(&r));
    AQR_TRY(search(&r));
    AQR_TRY(draw_arcs(&r, added));
    for (aqr_index f = 0; f < s->n_faces; f++)
      suspect[f] = r.slot[f] != AQR_NONE;
  }
done:
  AQR_DROP(c, r.start, 3 * s->n_faces);
  AQR_DROP(c, r.picked, s->n_faces);
  AQR_DROP(c, r.parent, r.n_items);
  AQR_DROP(c, r.euler, r.n_items);
  AQR_DROP(c, r.bordered, r.n_items);
  AQR_DROP(c, r.slot, s->n_faces);
  AQR_DROP(c, r.slots, r.slot_capacity);
  AQR_DROP(c, r.pieces, r.piece_capacity);
  AQR_DROP(c, r.cells, r.cell_capacity);
  AQR_DROP(c, r.queue, r.queue_capacity);
  AQR_DROP(c, r.drawn, r.drawn_capacity);
  AQR_DROP(c, r.arcs, r.arc_capacity);
  aqr_layout_free(c, &r.at);
  return status;
}
