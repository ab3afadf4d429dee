/* SPDX-License-Identifier: BSD-3-Clause */
/* Topology kept: where the paper (6) lets small handles vanish, regions that are not disks get another line. */
#include "regions.h"

#include <stdlib.h>
#include <string.h>

/* A chord's end on the border of a face. */
typedef struct border_mark
{
  aqr_index sample, chord;
  bool starts;   /* the chord starts here, else it ends here */
  bool kept;     /* an edge of the network passes */
  unsigned cell; /* of the stretch of border that follows counter-clockwise */
} border_mark;

/* The cells of one face. */
typedef struct layout
{
  aqr_index face;
  border_mark* marks; /* counter-clockwise from corner 0 */
  size_t n_marks, capacity;
  uint64_t* signature;
  size_t signature_capacity;
  aqr_index* item; /* per cell: an item of its region */
  size_t n_cells, item_capacity;
} layout;

typedef struct regions
{
  aqr_context* c;
  const aqr_surface* s;
  const aqr_chains* chains;
  const aqr_network* net;
  aqr_lines* lines;
  aqr_index* parent; /* union-find over items: faces without chords, then loops */
  size_t n_items;
  int32_t* euler;    /* per root */
  uint8_t* bordered; /* per root: bit 0 has a loop, bit 1 has a cell */
  layout at;         /* of the face looked at */
  aqr_index* base;   /* per face in a region to be cut: its first cell */
  /* per cell of such regions */
  struct cell
  {
    aqr_index face, from; /* `from`: the half-edge of its face over which the search came; AQR_NONE at the border */
    double t;             /* where on `from` */
    aqr_index before;     /* the cell it came from */
    uint32_t distance;    /* UINT32_MAX: not reached */
  } * cells;
  size_t n_cells, cell_capacity;
  aqr_index* queue;
  size_t queue_capacity;
  aqr_sample* drawn; /* of the arcs, one after the other */
  size_t n_drawn, drawn_capacity;
  aqr_line* arcs; /* `first` into drawn */
  size_t n_arcs, arc_capacity;
} regions;

static aqr_index find(aqr_index* parent, aqr_index i)
{
  while (parent[i] != i)
  {
    parent[i] = parent[parent[i]];
    i = parent[i];
  }
  return i;
}

static void unite(aqr_index* parent, aqr_index a, aqr_index b)
{
  a = find(parent, a);
  b = find(parent, b);
  if (a < b)
    parent[b] = a;
  else
    parent[a] = b;
}

static uint64_t hash(uint64_t x)
{
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

/* The loop on the stretch of border after the mark: right of a chord that starts, left of one that ends. */
static aqr_index item_after(const regions* r, const border_mark* m)
{
  aqr_index edge = r->net->edge_at[m->sample];
  return (aqr_index)r->s->n_faces + r->net->loop[2 * edge + (m->starts ? 1 : 0)];
}

static aqr_index item_before(const regions* r, const border_mark* m)
{
  aqr_index edge = r->net->edge_at[m->sample];
  return (aqr_index)r->s->n_faces + r->net->loop[2 * edge + (m->starts ? 0 : 1)];
}

static aqr_status gather_marks(regions* r, aqr_index f)
{
  layout* a = &r->at;
  const aqr_lines* l = r->lines;
  a->face = f;
  a->n_marks = 0;
  bool any = false;
  for (aqr_index k = l->head[f]; k != AQR_NONE; k = l->segments[k].next)
  {
    aqr_index n = l->segments[k].sample;
    if (l->lines[l->segments[k].line].is_chain)
      continue;
    if (!AQR_RESERVE(r->c, a->marks, a->capacity, a->n_marks + 2))
      return AQR_OUT_OF_MEMORY;
    for (unsigned i = 0; i < 2; i++)
    {
      border_mark m = { n + i, n, i == 0, r->net->edge_at[n + i] != AQR_NONE, 0 };
      any |= m.kept;
      size_t j = a->n_marks++;
      for (; j > 0 && aqr_border_before(r->s, f, &l->samples[m.sample], &l->samples[a->marks[j - 1].sample]); j--)
        a->marks[j] = a->marks[j - 1];
      a->marks[j] = m;
    }
  }
  if (!any)
    a->n_marks = 0;
  return AQR_OK;
}

/* Sorts out which stretches of the face's border belong to one cell: those that no chord separates, and those on both
 * sides of a chord's end that the network left out. */
static aqr_status lay_out(regions* r, aqr_index f)
{
  layout* a = &r->at;
  aqr_status status = gather_marks(r, f);
  if (status != AQR_OK)
    return status;
  if (!AQR_RESERVE(r->c, a->item, a->item_capacity, a->n_marks + 1) ||
      !AQR_RESERVE(r->c, a->signature, a->signature_capacity, a->n_marks + 1))
    return AQR_OUT_OF_MEMORY;
  if (a->n_marks == 0)
  {
    a->n_cells = 1;
    a->item[0] = f;
    return AQR_OK;
  }
  uint64_t signature = 0;
  for (size_t i = 0; i < a->n_marks; i++)
  {
    signature ^= hash(a->marks[i].chord);
    a->signature[i] = signature;
    a->marks[i].cell = (unsigned)i;
  }
  size_t n = a->n_marks;
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < n; j++)
    {
      bool same = a->signature[i] == a->signature[j] || (!a->marks[j].kept && (j + n - 1) % n == i);
      unsigned low = a->marks[i].cell, high = a->marks[j].cell;
      if (!same || low == high)
        continue;
      for (size_t k = 0; k < n; k++)
        if (a->marks[k].cell == high)
          a->marks[k].cell = low;
    }
  a->n_cells = 0;
  for (size_t i = 0; i < n; i++)
  {
    unsigned old = a->marks[i].cell;
    if (old < a->n_cells + n && old >= n) /* numbered already */
      continue;
    for (size_t k = i; k < n; k++)
      if (a->marks[k].cell == old)
        a->marks[k].cell = (unsigned)(n + a->n_cells);
    a->item[a->n_cells++] = AQR_NONE;
  }
  for (size_t i = 0; i < n; i++)
  {
    a->marks[i].cell -= (unsigned)n;
    if (a->marks[i].kept)
      a->item[a->marks[i].cell] = item_after(r, &a->marks[i]);
    if (a->marks[(i + 1) % n].kept)
      a->item[a->marks[i].cell] = item_before(r, &a->marks[(i + 1) % n]);
  }
  return AQR_OK;
}

/* The marks on half-edge k of the face: [*first, *end). The stretch before *first belongs to the cell of the mark
 * before. */
static void marks_on(const regions* r, unsigned k, size_t* first, size_t* end)
{
  const layout* a = &r->at;
  aqr_index h = 3 * a->face + k;
  size_t i = 0;
  while (i < a->n_marks && aqr_sample_half_edge(r->s, &r->lines->samples[a->marks[i].sample], a->face) < h)
    i++;
  *first = i;
  while (i < a->n_marks && aqr_sample_half_edge(r->s, &r->lines->samples[a->marks[i].sample], a->face) == h)
    i++;
  *end = i;
}

static unsigned cell_before(const layout* a, size_t mark)
{
  return a->n_marks ? a->marks[(mark + a->n_marks - 1) % a->n_marks].cell : 0;
}

/* ---- counting ---- */

static aqr_index item_at_start(const regions* r, unsigned k)
{
  size_t first, end;
  marks_on(r, k, &first, &end);
  return r->at.item[cell_before(&r->at, first)];
}

static size_t kept_on(const regions* r, unsigned k)
{
  size_t first, end, kept = 0;
  marks_on(r, k, &first, &end);
  for (size_t i = first; i < end; i++)
    kept += r->at.marks[i].kept;
  return kept;
}

/* Unites what belongs together inside faces and over whole edges. Stretches of cut edges need nothing: both sides of
 * them border the same loop. `start` (one per half-edge) holds the item there, AQR_NONE on cut edges. */
static aqr_status unite_cells(regions* r, aqr_index* start)
{
  const aqr_surface* s = r->s;
  for (aqr_index f = 0; f < s->n_faces; f++)
  {
    if (f % 65536 == 0 && !aqr_step(r->c, 0.5 * (double)f / (double)s->n_faces))
      return AQR_CANCELLED;
    aqr_status status = lay_out(r, f);
    if (status != AQR_OK)
      return status;
    const layout* a = &r->at;
    for (size_t i = 0; i < a->n_marks; i++)
    {
      aqr_index item = a->item[a->marks[i].cell];
      if (a->marks[i].kept)
        unite(r->parent, item, item_after(r, &a->marks[i]));
      if (a->marks[(i + 1) % a->n_marks].kept)
        unite(r->parent, item, item_before(r, &a->marks[(i + 1) % a->n_marks]));
    }
    for (unsigned k = 0; k < 3; k++)
    {
      aqr_index h = 3 * f + k, t = aqr_twin(s, h);
      start[h] = kept_on(r, k) ? AQR_NONE : item_at_start(r, k);
      if (t != AQR_NONE && t < h && start[t] != AQR_NONE && start[h] != AQR_NONE)
        unite(r->parent, start[h], start[t]);
    }
  }
  return AQR_OK;
}

static bool on_chain(const regions* r, aqr_index point)
{
  return r->chains->is_node[r->s->clean[point]] != 0;
}

/* Cells minus stretches plus vertices of every region. */
static aqr_status count_euler(regions* r)
{
  const aqr_surface* s = r->s;
  for (aqr_index f = 0; f < s->n_faces; f++)
  {
    if (f % 65536 == 0 && !aqr_step(r->c, 0.5 + 0.4 * (double)f / (double)s->n_faces))
      return AQR_CANCELLED;
    aqr_status status = lay_out(r, f);
    if (status != AQR_OK)
      return status;
    const layout* a = &r->at;
    for (size_t i = 0; i < a->n_cells; i++)
    {
      aqr_index root = find(r->parent, a->item[i]);
      r->euler[root]++;
      r->bordered[root] |= 2;
    }
    for (unsigned k = 0; k < 3; k++)
    {
      aqr_index h = 3 * f + k, t = aqr_twin(s, h), v = aqr_from(s, h);
      if (s->fan[v] == h && !on_chain(r, v))
        r->euler[find(r->parent, item_at_start(r, k))]++;
      if (t == AQR_NONE || t < h)
        continue;
      size_t first, end;
      marks_on(r, k, &first, &end);
      r->euler[find(r->parent, a->item[cell_before(a, first)])]--;
      for (size_t i = first; i < end; i++)
        if (a->marks[i].kept)
          r->euler[find(r->parent, a->item[a->marks[i].cell])]--;
    }
  }
  for (size_t i = 0; i < r->net->n_loops; i++)
    r->bordered[find(r->parent, (aqr_index)(s->n_faces + i))] |= 1;
  return AQR_OK;
}

/* A region that arcs must cut. Loops that no stretch of a border belongs to lie inside one face and are disks. */
static bool needs_cut(const regions* r, aqr_index item)
{
  aqr_index root = find(r->parent, item);
  return r->bordered[root] == 3 && r->euler[root] < 1;
}

/* ---- searching ---- */

/* Numbers the cells of all regions to be cut; base[f] is AQR_NONE in faces that have none. */
static aqr_status number_cells(regions* r)
{
  const aqr_surface* s = r->s;
  r->n_cells = 0;
  for (aqr_index f = 0; f < s->n_faces; f++)
  {
    aqr_status status = lay_out(r, f);
    if (status != AQR_OK)
      return status;
    r->base[f] = AQR_NONE;
    for (size_t i = 0; i < r->at.n_cells; i++)
      if (needs_cut(r, r->at.item[i]))
        r->base[f] = (aqr_index)r->n_cells;
    if (r->base[f] == AQR_NONE)
      continue;
    if (!AQR_RESERVE(r->c, r->cells, r->cell_capacity, r->n_cells + r->at.n_cells))
      return AQR_OUT_OF_MEMORY;
    for (size_t i = 0; i < r->at.n_cells; i++)
      r->cells[r->n_cells++] = (struct cell){ f, AQR_NONE, 0, AQR_NONE, UINT32_MAX };
  }
  return AQR_OK;
}

/* A point of the j-th stretch of half-edge k that no mark lies on, and the stretch's cell. */
static double stretch_middle(const regions* r, unsigned k, size_t first, size_t end, size_t j, unsigned* cell)
{
  const layout* a = &r->at;
  aqr_index h = 3 * a->face + k;
  double low = 0, high = 1;
  for (size_t i = first; i < end; i++)
  {
    const aqr_sample* m = &r->lines->samples[a->marks[i].sample];
    double t = m->edge == h ? m->t : 1 - m->t;
    if (i < first + j)
      low = fmax(low, t);
    else
      high = fmin(high, t);
  }
  *cell = j ? a->marks[first + j - 1].cell : cell_before(a, first);
  return (low + high) / 2;
}

/* The cell on the other side of half-edge h at position t of h. */
static aqr_status cell_across(regions* r, aqr_index h, double t, aqr_index* cell)
{
  aqr_index twin = aqr_twin(r->s, h);
  aqr_status status = lay_out(r, aqr_face_of(twin));
  if (status != AQR_OK)
    return status;
  size_t first, end;
  marks_on(r, twin % 3, &first, &end);
  unsigned local = cell_before(&r->at, first);
  for (size_t i = first; i < end; i++)
  {
    const aqr_sample* m = &r->lines->samples[r->at.marks[i].sample];
    if ((m->edge == twin ? m->t : 1 - m->t) < 1 - t)
      local = r->at.marks[i].cell;
  }
  *cell = r->base[aqr_face_of(twin)] == AQR_NONE ? AQR_NONE : r->base[aqr_face_of(twin)] + local;
  return AQR_OK;
}

/* Breadth-first forest over the cells, rooted at all cells on the border of their region. */
static aqr_status search(regions* r)
{
  const aqr_surface* s = r->s;
  size_t head = 0, tail = 0;
  if (!AQR_RESERVE(r->c, r->queue, r->queue_capacity, r->n_cells))
    return AQR_OUT_OF_MEMORY;
  for (aqr_index i = 0; i < r->n_cells; i++)
  {
    aqr_index f = r->cells[i].face;
    aqr_status status = lay_out(r, f);
    if (status != AQR_OK)
      return status;
    aqr_index local = i - r->base[f];
    if (!needs_cut(r, r->at.item[local]))
      continue;
    bool root = r->at.n_marks > 0;
    for (unsigned k = 0; k < 3; k++)
      root |= aqr_twin(s, 3 * f + k) == AQR_NONE;
    if (root)
    {
      r->cells[i].distance = 0;
      r->queue[tail++] = i;
    }
  }
  while (head < tail)
  {
    aqr_index i = r->queue[head++], f = r->cells[i].face;
    if (head % 1024 == 0 && !aqr_step(r->c, 0.95))
      return AQR_CANCELLED;
    for (unsigned k = 0; k < 3; k++)
    {
      aqr_index h = 3 * f + k;
      if (aqr_twin(s, h) == AQR_NONE)
        continue;
      aqr_status status = lay_out(r, f);
      if (status != AQR_OK)
        return status;
      size_t first, end;
      marks_on(r, k, &first, &end);
      for (size_t j = 0; j <= end - first; j++)
      {
        unsigned local;
        aqr_index next;
        double t = stretch_middle(r, k, first, end, j, &local);
        if (r->base[f] + local != i)
          continue;
        status = cell_across(r, h, t, &next);
        if (status == AQR_OK)
          status = lay_out(r, f);
        if (status != AQR_OK)
          return status;
        if (next == AQR_NONE || r->cells[next].distance != UINT32_MAX)
          continue;
        r->cells[next].distance = r->cells[i].distance + 1;
        r->cells[next].before = i;
        r->cells[next].from = aqr_twin(s, h);
        r->cells[next].t = 1 - t;
        r->queue[tail++] = next;
      }
    }
  }
  return AQR_OK;
}

/* ---- arcs ---- */

/* A whole edge inside a region that the search did not come over; the arc through it leads to the border on both sides.
 */
typedef struct link
{
  aqr_index edge;
  aqr_index cell[2]; /* of the edge's half-edge and of its twin */
  uint32_t length;
} link;

static int by_length(const void* a, const void* b)
{
  const link *x = a, *y = b;
  if (x->length != y->length)
    return x->length < y->length ? -1 : 1;
  return (x->edge > y->edge) - (x->edge < y->edge);
}

/* The links of which both ends are vertices inside a region. */
static aqr_status gather_links(regions* r, link** links, size_t* n, size_t* capacity)
{
  const aqr_surface* s = r->s;
  for (aqr_index i = 0; i < r->n_cells; i++)
  {
    aqr_index f = r->cells[i].face;
    if (r->cells[i].distance == UINT32_MAX)
      continue;
    for (unsigned k = 0; k < 3; k++)
    {
      aqr_index h = 3 * f + k, t = aqr_twin(s, h), other;
      if (t == AQR_NONE || t < h || on_chain(r, aqr_from(s, h)) || on_chain(r, aqr_to(s, h)))
        continue;
      aqr_status status = lay_out(r, f);
      if (status != AQR_OK)
        return status;
      size_t first, end;
      marks_on(r, k, &first, &end);
      if (kept_on(r, k) || r->base[f] + cell_before(&r->at, first) != i)
        continue;
      status = cell_across(r, h, 0.5, &other);
      if (status != AQR_OK)
        return status;
      if (other == AQR_NONE || r->cells[other].distance == UINT32_MAX ||
          (r->cells[i].before == other && r->cells[i].from == h) ||
          (r->cells[other].before == i && r->cells[other].from == t))
        continue;
      if (!AQR_RESERVE(r->c, *links, *capacity, *n + 1))
        return AQR_OUT_OF_MEMORY;
      (*links)[(*n)++] = (link){ h, { i, other }, r->cells[i].distance + r->cells[other].distance };
    }
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
  for (unsigned k = 0; k < 2; k++)
  {
    hub* at = &hubs[k ? aqr_to(r->s, links[i].edge) : aqr_from(r->s, links[i].edge)];
    at->degree += off ? UINT32_MAX : 1;
    at->links ^= i;
  }
}

/* Takes away the link that hangs alone at a vertex, and what then hangs alone at its other end, and so on: an arc
 * through one of those would cut off a disk. */
static void strip(const regions* r, hub* hubs, const link* links, uint8_t* gone, aqr_index vertex)
{
  while (hubs[vertex].degree == 1)
  {
    uint32_t i = hubs[vertex].links;
    gone[i] = 1;
    hang(r, hubs, links, i, true);
    aqr_index a = aqr_from(r->s, links[i].edge);
    vertex = a == vertex ? aqr_to(r->s, links[i].edge) : a;
  }
}

static aqr_sample sample_on(const regions* r, aqr_index h, double t, aqr_index face)
{
  aqr_index edge = aqr_edge_of(r->s, h);
  double at = edge == h ? t : 1 - t;
  return (aqr_sample){ .p = aqr_edge_point(r->s, edge, at), .t = at, .edge = edge, .face = face };
}

/* Where an arc leaves its last cell: over a boundary or seam of it, or past a kept mark next to it, so that it crosses
 * the mark's chord. */
static aqr_status last_sample(regions* r, aqr_index cell, aqr_sample* sample, uint8_t* end)
{
  const aqr_surface* s = r->s;
  aqr_index f = r->cells[cell].face, came = r->cells[cell].from;
  aqr_status status = lay_out(r, f);
  if (status != AQR_OK)
    return status;
  const layout* a = &r->at;
  unsigned local = cell - r->base[f];
  for (unsigned k = 0; k < 3; k++)
  {
    aqr_index h = 3 * f + k;
    size_t first, stop;
    marks_on(r, k, &first, &stop);
    if (aqr_twin(s, h) != AQR_NONE)
      continue;
    for (size_t j = 0; j <= stop - first; j++)
    {
      unsigned of;
      double t = stretch_middle(r, k, first, stop, j, &of);
      if (of != local)
        continue;
      *sample = sample_on(r, h, t, f);
      *end = aqr_is_seam(s, h) ? AQR_END_FEATURE : AQR_END_BOUNDARY;
      return AQR_OK;
    }
  }
  /* a mark at either end of a stretch of the cell, best one not on the edge the arc came over */
  for (unsigned pass = 0; pass < 2; pass++)
    for (size_t i = 0; i < a->n_marks; i++)
      for (unsigned after = 0; after < 2; after++)
      {
        unsigned of = after ? a->marks[i].cell : cell_before(a, i);
        aqr_index h = aqr_sample_half_edge(s, &r->lines->samples[a->marks[i].sample], f);
        if (!a->marks[i].kept || of != local || (pass == 0 && h == came))
          continue;
        size_t first, stop;
        unsigned beyond;
        marks_on(r, h % 3, &first, &stop);
        double t = stretch_middle(r, h % 3, first, stop, i - first + (after ? 0 : 1), &beyond);
        *sample = sample_on(r, h, t, f);
        *end = AQR_END_CUT;
        return AQR_OK;
      }
  return AQR_INTERNAL;
}

static aqr_status push(regions* r, aqr_sample sample)
{
  if (!AQR_RESERVE(r->c, r->drawn, r->drawn_capacity, r->n_drawn + 1))
    return AQR_OUT_OF_MEMORY;
  r->drawn[r->n_drawn++] = sample;
  return AQR_OK;
}

/* Draws the arc through a link: from the border to the link on one side, from the link to the border on the other. */
static aqr_status draw(regions* r, const link* l)
{
  aqr_sample last;
  aqr_line line = { .first = r->n_drawn, .type = AQR_LINE_MIN, .partner = { AQR_NONE, AQR_NONE } };
  aqr_status status = AQR_OK;
  /* towards the first border, then turned round; the face with each sample is that of the chord towards the link */
  aqr_index i = l->cell[0];
  for (; r->cells[i].before != AQR_NONE; i = r->cells[i].before)
    AQR_TRY(push(r, sample_on(r, r->cells[i].from, r->cells[i].t, r->cells[i].face)));
  AQR_TRY(last_sample(r, i, &last, &line.ends[0]));
  AQR_TRY(push(r, last));
  for (size_t a = line.first, z = r->n_drawn - 1; a < z; a++, z--)
  {
    aqr_sample swap = r->drawn[a];
    r->drawn[a] = r->drawn[z];
    r->drawn[z] = swap;
  }
  AQR_TRY(push(r, sample_on(r, l->edge, 0.5, r->cells[l->cell[1]].face)));
  for (i = l->cell[1]; r->cells[i].before != AQR_NONE; i = r->cells[i].before)
    AQR_TRY(push(r, sample_on(r, r->cells[i].from, r->cells[i].t, r->cells[r->cells[i].before].face)));
  AQR_TRY(last_sample(r, i, &last, &line.ends[1]));
  AQR_TRY(push(r, last));
  line.count = r->n_drawn - line.first;
  for (size_t k = line.first + 1; k < r->n_drawn; k++)
    r->drawn[k].arc = r->drawn[k - 1].arc + (float)v3_norm(v3_sub(r->drawn[k].p, r->drawn[k - 1].p));
  AQR_REQUIRE(AQR_RESERVE(r->c, r->arcs, r->arc_capacity, r->n_arcs + 1), AQR_OUT_OF_MEMORY);
  r->arcs[r->n_arcs++] = line;
done:
  return status;
}

/* Claims the cells that the arc through a link passes; false where another arc of this round has one of them. */
static bool claim(const regions* r, const link* l, uint8_t* taken)
{
  for (unsigned pass = 0; pass < 2; pass++)
    for (unsigned k = 0; k < 2; k++)
      for (aqr_index i = l->cell[k]; i != AQR_NONE; i = r->cells[i].before)
      {
        if (pass == 0 && taken[i])
          return false;
        taken[i] |= (uint8_t)pass;
      }
  return true;
}

/* Arcs through the shortest links, as many as the regions need and as find room beside each other. Lines are added only
 * when all are drawn, so that the layouts stay those of the network. */
static aqr_status draw_arcs(regions* r, size_t* added)
{
  const aqr_surface* s = r->s;
  link* links = NULL;
  size_t n = 0, capacity = 0;
  hub* hubs = AQR_NEW0(r->c, hub, s->n_points);
  uint8_t *gone = NULL, *taken = AQR_NEW0(r->c, uint8_t, r->n_cells);
  aqr_status status = AQR_OK;
  AQR_REQUIRE(hubs && taken, AQR_OUT_OF_MEMORY);
  AQR_TRY(gather_links(r, &links, &n, &capacity));
  gone = AQR_NEW0(r->c, uint8_t, n);
  AQR_REQUIRE(gone, AQR_OUT_OF_MEMORY);
  if (n)
    qsort(links, n, sizeof *links, by_length);
  for (uint32_t i = 0; i < n; i++)
    hang(r, hubs, links, i, false);
  for (aqr_index v = 0; v < s->n_points; v++)
    strip(r, hubs, links, gone, v);
  for (uint32_t i = 0; i < n; i++)
  {
    if (gone[i])
      continue;
    if (claim(r, &links[i], taken))
      AQR_TRY(draw(r, &links[i]));
    gone[i] = 1;
    hang(r, hubs, links, i, true);
    strip(r, hubs, links, gone, aqr_from(s, links[i].edge));
    strip(r, hubs, links, gone, aqr_to(s, links[i].edge));
  }
  for (size_t i = 0; i < r->n_arcs; i++)
    AQR_TRY(aqr_lines_add(r->c, r->lines, s, &r->arcs[i], r->drawn + r->arcs[i].first));
  *added = r->n_arcs;
done:
  AQR_DROP(r->c, links, capacity);
  AQR_DROP(r->c, gone, n);
  AQR_DROP(r->c, taken, r->n_cells);
  AQR_DROP(r->c, hubs, s->n_points);
  return status;
}

aqr_status aqr_regions_cut(aqr_context* c, const aqr_surface* s, const aqr_chains* chains, const aqr_network* net,
  aqr_lines* lines, uint8_t* is_bare, bool cut, size_t* added)
{
  regions r = { .c = c, .s = s, .chains = chains, .net = net, .lines = lines };
  aqr_status status = AQR_OK;
  *added = 0;
  r.n_items = s->n_faces + net->n_loops;
  aqr_index* start = AQR_NEW(c, aqr_index, 3 * s->n_faces);
  r.parent = AQR_NEW(c, aqr_index, r.n_items);
  r.euler = AQR_NEW0(c, int32_t, r.n_items);
  r.bordered = AQR_NEW0(c, uint8_t, r.n_items);
  r.base = AQR_NEW(c, aqr_index, s->n_faces);
  AQR_REQUIRE(start && r.parent && r.euler && r.bordered && r.base, AQR_OUT_OF_MEMORY);
  for (size_t i = 0; i < r.n_items; i++)
    r.parent[i] = (aqr_index)i;
  AQR_TRY(unite_cells(&r, start));
  AQR_TRY(count_euler(&r));
  for (aqr_index f = 0; f < s->n_faces; f++)
    is_bare[f] = lines->head[f] == AQR_NONE && !(r.bordered[find(r.parent, f)] & 1);
  bool any = false;
  for (aqr_index i = 0; cut && i < r.n_items && !any; i++)
    any = r.parent[i] == i && needs_cut(&r, i);
  if (any)
  {
    AQR_TRY(number_cells(&r));
    AQR_TRY(search(&r));
    AQR_TRY(draw_arcs(&r, added));
  }
done:
  AQR_DROP(c, start, 3 * s->n_faces);
  AQR_DROP(c, r.parent, r.n_items);
  AQR_DROP(c, r.euler, r.n_items);
  AQR_DROP(c, r.bordered, r.n_items);
  AQR_DROP(c, r.base, s->n_faces);
  AQR_DROP(c, r.cells, r.cell_capacity);
  AQR_DROP(c, r.queue, r.queue_capacity);
  AQR_DROP(c, r.drawn, r.drawn_capacity);
  AQR_DROP(c, r.arcs, r.arc_capacity);
  AQR_DROP(c, r.at.marks, r.at.capacity);
  AQR_DROP(c, r.at.signature, r.at.signature_capacity);
  AQR_DROP(c, r.at.item, r.at.item_capacity);
  return status;
}
