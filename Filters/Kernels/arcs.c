/* SPDX-License-Identifier: BSD-3-Clause */
/* A forest of shortest ways to the network, and arcs over the pieces of borders where its trees meet. */
#include "arcs.h"

#include "sort.h"

#include <stdlib.h>

typedef struct drawing
{
  aqr_context* c;
  aqr_region_cells* g;
  aqr_index* queue; /* of the search */
  size_t queue_capacity;
  aqr_sample* drawn; /* of the arcs, one after the other */
  size_t n_drawn, drawn_capacity;
  aqr_line* arcs; /* `first` into drawn */
  size_t n_arcs, arc_capacity;
} drawing;

/* Breadth-first forest over the cells. Its roots are the cells that touch the network; each holds the contact over
 * which an arc leaves it, the others the piece over which the search came. */
static aqr_status search(drawing* d)
{
  aqr_region_cells* g = d->g;
  size_t head = 0, tail = 0;
  if (!AQR_RESERVE(d->c, d->queue, d->queue_capacity, g->n_cells))
    return AQR_OUT_OF_MEMORY;
  for (aqr_index i = 0; i < g->n_pieces; i++)
  {
    aqr_index k = g->pieces[i].cell;
    aqr_region_cell* at = &g->cells[k];
    if (!g->pieces[i].is_contact || !at->wanted || at->distance == 0)
      continue;
    at->distance = 0;
    at->exit = i;
    d->queue[tail++] = k;
  }
  while (head < tail)
  {
    aqr_index k = d->queue[head++];
    if (head % 4096 == 0 && !aqr_step(d->c, 0.97))
      return AQR_CANCELLED;
    const aqr_slot* at = &g->slots[g->slot[g->cells[k].face]];
    for (aqr_index i = at->first[0]; i < at->first[3]; i++)
    {
      if (g->pieces[i].cell != k || !aqr_piece_leads_on(g, i))
        continue;
      aqr_index back = aqr_piece_across(g, i);
      aqr_region_cell* next = &g->cells[g->pieces[back].cell];
      if (next->distance != UINT32_MAX)
        continue;
      next->distance = g->cells[k].distance + 1;
      next->before = k;
      next->exit = back;
      d->queue[tail++] = g->pieces[back].cell;
    }
  }
  return AQR_OK;
}

/* A piece that the forest does not use: the arc over it leads to the network on both sides. */
typedef struct link
{
  aqr_index piece;
  uint32_t length;
  aqr_index hub[2]; /* the vertices it hangs at, by rank among those that any does */
} link;

static int by_length(const void* a, const void* b)
{
  const link *x = a, *y = b;
  if (x->length != y->length)
    return x->length < y->length ? -1 : 1;
  return (x->piece > y->piece) - (x->piece < y->piece);
}

static aqr_status gather_links(aqr_context* c, const aqr_region_cells* g, link** links, size_t* n, size_t* capacity)
{
  for (aqr_index i = 0; i < g->n_pieces; i++)
  {
    const aqr_region_cell* at = &g->cells[g->pieces[i].cell];
    if (at->distance == UINT32_MAX || at->exit == i)
      continue;
    uint32_t length = at->distance;
    if (!g->pieces[i].is_contact)
    {
      if (!aqr_piece_leads_on(g, i))
        continue;
      aqr_index back = aqr_piece_across(g, i);
      const aqr_region_cell* other = &g->cells[g->pieces[back].cell];
      if (back < i || other->distance == UINT32_MAX || other->exit == back)
        continue;
      length += other->distance;
    }
    if (!AQR_RESERVE(c, *links, *capacity, *n + 1))
      return AQR_OUT_OF_MEMORY;
    (*links)[(*n)++] = (link){ i, length, { AQR_NONE, AQR_NONE } };
  }
  return AQR_OK;
}

/* What hangs at a vertex: how many links, and the exclusive or of their numbers, which is the link where there is one.
 */
typedef struct hub
{
  uint32_t degree, links;
} hub;

static int by_index(const void* a, const void* b)
{
  const aqr_index *x = a, *y = b;
  return (*x > *y) - (*x < *y);
}

/* Ranks the vertices at the ends of links: of all there are it is a few that links hang at. */
static aqr_status rank_hubs(aqr_context* c, const aqr_region_cells* g, link* links, size_t n, size_t* n_hubs)
{
  size_t used = 0;
  aqr_status status = AQR_OK;
  aqr_index* vertex = AQR_NEW(c, aqr_index, 2 * n);
  AQR_REQUIRE(vertex, AQR_OUT_OF_MEMORY);
  for (size_t i = 0; i < n; i++)
  {
    vertex[2 * i] = g->pieces[links[i].piece].from;
    vertex[2 * i + 1] = g->pieces[links[i].piece].to;
  }
  AQR_TRY(aqr_sort(c, vertex, 2 * n, sizeof *vertex, by_index));
  for (size_t i = 0; i < 2 * n; i++)
    if (used == 0 || vertex[used - 1] != vertex[i])
      vertex[used++] = vertex[i];
  for (size_t i = 0; i < n; i++)
    for (unsigned k = 0; k < 2; k++)
    {
      const aqr_piece* p = &g->pieces[links[i].piece];
      const aqr_index* at = bsearch(k ? &p->to : &p->from, vertex, used, sizeof *vertex, by_index);
      AQR_REQUIRE(at, AQR_INTERNAL);
      links[i].hub[k] = (aqr_index)(at - vertex);
    }
  *n_hubs = used;
done:
  AQR_DROP(c, vertex, 2 * n);
  return status;
}

static void hang(hub* hubs, const link* links, uint32_t i, bool off)
{
  for (unsigned k = 0; k < 2; k++)
  {
    hub* at = &hubs[links[i].hub[k]];
    at->degree += off ? UINT32_MAX : 1;
    at->links ^= i;
  }
}

/* Takes away the link that hangs alone at a vertex, and what then hangs alone at its other end, and so on: an arc over
 * one of those would cut off a disk. */
static void strip(hub* hubs, const link* links, uint8_t* gone, aqr_index at)
{
  while (hubs[at].degree == 1)
  {
    uint32_t i = hubs[at].links;
    gone[i] = 1;
    hang(hubs, links, i, true);
    /* NOLINTNEXTLINE(clang-analyzer-core.NullDereference): where a vertex has a degree there are links */
    at = links[i].hub[links[i].hub[0] == at];
  }
}

static aqr_status push(drawing* d, aqr_index i, aqr_index face)
{
  const aqr_region_cells* g = d->g;
  const aqr_piece* p = &g->pieces[i];
  aqr_index edge = aqr_edge_of(g->s, p->half_edge);
  double t = edge == p->half_edge ? p->t : 1 - p->t;
  if (!AQR_RESERVE(d->c, d->drawn, d->drawn_capacity, d->n_drawn + 1))
    return AQR_OUT_OF_MEMORY;
  d->drawn[d->n_drawn++] = (aqr_sample){ .p = aqr_edge_point(g->s, edge, t), .t = t, .edge = edge, .face = face };
  return AQR_OK;
}

static uint8_t end_of(const aqr_region_cells* g, aqr_index i)
{
  const aqr_piece* p = &g->pieces[i];
  if (p->is_chord)
    return AQR_END_CUT;
  return aqr_is_seam(g->s, p->half_edge) ? AQR_END_FEATURE : AQR_END_BOUNDARY;
}

/* The way from a cell to the network, over the pieces the search came by; `outwards` says whether a sample's face is
 * that of the chord after it on the way out, or before. */
static aqr_status push_way_out(drawing* d, aqr_index k, bool outwards, uint8_t* end)
{
  for (;;)
  {
    const aqr_region_cell* at = &d->g->cells[k];
    bool last = at->before == AQR_NONE;
    aqr_index face = outwards && !last ? d->g->cells[at->before].face : at->face;
    aqr_status status = push(d, at->exit, face);
    if (status != AQR_OK)
      return status;
    if (last)
    {
      *end = end_of(d->g, at->exit);
      return AQR_OK;
    }
    k = at->before;
  }
}

/* Takes out of an arc the chords that go back to the edge they come from: they have no direction, and lead around
 * nothing but the end of a chord there, which the arc may as well pass on the other side of the edge. An arc keeps its
 * ends, on the network. */
static void straighten(drawing* d, aqr_line* line)
{
  aqr_sample* a = d->drawn + line->first;
  size_t n = 0, count = d->n_drawn - line->first;
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
  d->n_drawn = line->first + n;
}

/* Draws the arc over a link: from the network to the link on one side, from the link to the network on the other. None
 * where nothing is left of it. */
static aqr_status draw(drawing* d, const link* l)
{
  const aqr_region_cells* g = d->g;
  aqr_line line = { .first = d->n_drawn, .type = AQR_LINE_MIN, .partner = { AQR_NONE, AQR_NONE } };
  aqr_index cell = g->pieces[l->piece].cell;
  aqr_status status = AQR_OK;
  AQR_TRY(push_way_out(d, cell, false, &line.ends[0]));
  for (size_t a = line.first, z = d->n_drawn - 1; a < z; a++, z--)
  {
    aqr_sample swap = d->drawn[a];
    d->drawn[a] = d->drawn[z];
    d->drawn[z] = swap;
  }
  if (g->pieces[l->piece].is_contact)
  {
    AQR_TRY(push(d, l->piece, g->cells[cell].face));
    line.ends[1] = end_of(g, l->piece);
  }
  else
  {
    aqr_index other = g->pieces[aqr_piece_across(g, l->piece)].cell;
    AQR_TRY(push(d, l->piece, g->cells[other].face));
    AQR_TRY(push_way_out(d, other, true, &line.ends[1]));
  }
  straighten(d, &line);
  if (line.count < 2)
  {
    d->n_drawn = line.first;
    goto done;
  }
  for (size_t k = line.first + 1; k < d->n_drawn; k++)
    d->drawn[k].arc = d->drawn[k - 1].arc + (float)v3_norm(v3_sub(d->drawn[k].p, d->drawn[k - 1].p));
  AQR_REQUIRE(AQR_RESERVE(d->c, d->arcs, d->arc_capacity, d->n_arcs + 1), AQR_OUT_OF_MEMORY);
  d->arcs[d->n_arcs++] = line;
done:
  return status;
}

/* Whether another arc of this round has one of the cells that the arc over a link passes; `take`: all are its own then.
 */
static bool is_taken(const aqr_region_cells* g, const link* l, uint8_t* taken, bool take)
{
  bool both = !g->pieces[l->piece].is_contact, any = false;
  for (unsigned k = 0; k < 1u + both; k++)
    for (aqr_index i = g->pieces[k ? aqr_piece_across(g, l->piece) : l->piece].cell; i != AQR_NONE;
         i = g->cells[i].before)
    {
      any |= taken[i];
      taken[i] |= take;
    }
  return any;
}

aqr_status aqr_arcs_draw(aqr_context* c, aqr_region_cells* g, aqr_lines* lines, size_t* added)
{
  drawing d = { .c = c, .g = g };
  link* links = NULL;
  size_t n = 0, capacity = 0, n_hubs = 0;
  hub* hubs = NULL;
  uint8_t *gone = NULL, *taken = NULL;
  aqr_status status = AQR_OK;
  AQR_TRY(search(&d));
  AQR_TRY(gather_links(c, g, &links, &n, &capacity));
  AQR_TRY(aqr_sort(c, links, n, sizeof *links, by_length));
  AQR_TRY(rank_hubs(c, g, links, n, &n_hubs));
  hubs = AQR_NEW0(c, hub, n_hubs);
  taken = AQR_NEW0(c, uint8_t, g->n_cells);
  gone = AQR_NEW0(c, uint8_t, n);
  AQR_REQUIRE(hubs && taken && gone, AQR_OUT_OF_MEMORY);
  for (uint32_t i = 0; i < n; i++)
    hang(hubs, links, i, false);
  for (uint32_t i = 0; i < n; i++)
  {
    strip(hubs, links, gone, links[i].hub[0]);
    strip(hubs, links, gone, links[i].hub[1]);
  }
  for (uint32_t i = 0; i < n; i++)
  {
    if (gone[i])
      continue;
    if (!is_taken(g, &links[i], taken, false))
    {
      size_t before = d.n_arcs;
      AQR_TRY(draw(&d, &links[i]));
      if (d.n_arcs == before)
        continue; /* between two chords that end on one edge: another link around the same hole will do */
      is_taken(g, &links[i], taken, true);
    }
    gone[i] = 1;
    hang(hubs, links, i, true);
    strip(hubs, links, gone, links[i].hub[0]);
    strip(hubs, links, gone, links[i].hub[1]);
  }
  /* not before all are drawn, so that the layouts stay those of the network */
  for (size_t i = 0; i < d.n_arcs; i++)
    AQR_TRY(aqr_lines_add(c, lines, g->s, &d.arcs[i], d.drawn + d.arcs[i].first));
  *added = d.n_arcs;
done:
  AQR_DROP(c, links, capacity);
  AQR_DROP(c, gone, n);
  AQR_DROP(c, taken, g->n_cells);
  AQR_DROP(c, hubs, n_hubs);
  AQR_DROP(c, d.queue, d.queue_capacity);
  AQR_DROP(c, d.drawn, d.drawn_capacity);
  AQR_DROP(c, d.arcs, d.arc_capacity);
  return status;
}
