/* SPDX-License-Identifier: BSD-3-Clause */
/* Topology kept: where the paper (6) lets small handles vanish, regions that are not disks get another line. Which
 * these are is counted here. */
#include "regions.h"

#include "arcs.h"
#include "region_cells.h"
#include "regions_impl.h"

/* ---- items ---- */

static aqr_index find(const aqr_regions* r, aqr_index i)
{
  return aqr_root(r->parent, i);
}

static void unite(const aqr_regions* r, aqr_index a, aqr_index b)
{
  aqr_unite(r->parent, a, b);
}

static void add_euler(const aqr_regions* r, aqr_index item, int32_t more)
{
  atomic_fetch_add_explicit(&r->euler[item], more, memory_order_relaxed);
}

static void add_border(const aqr_regions* r, aqr_index item, uint8_t bits)
{
  if (bits & ~atomic_load_explicit(&r->bordered[item], memory_order_relaxed))
    atomic_fetch_or_explicit(&r->bordered[item], bits, memory_order_relaxed);
}

static aqr_index item_after(const aqr_regions* r, const aqr_border_mark* m)
{
  return aqr_item_after(r->s, r->net, m);
}

static aqr_index item_before(const aqr_regions* r, const aqr_border_mark* m)
{
  return aqr_item_before(r->s, r->net, m);
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
static void unite_with_chains(const aqr_regions* r, const aqr_layout* a)
{
  for (aqr_index n = r->lines->head[a->face]; n != AQR_NONE; n = aqr_next_chord(r->lines, n, a->face))
  {
    if (!r->lines->lines[r->lines->samples[n].line].is_chain)
      continue;
    aqr_index left = r->lines->samples[n].edge, edge = r->net->edge_at[n];
    bool right = aqr_face_of(left) != a->face;
    aqr_index h = right ? aqr_any_twin(r->s, left) : left;
    if (kept_on(a, h % 3) == 0)
      unite(r, item_at_start(a, h % 3), (aqr_index)r->s->n_faces + r->net->loop[2 * edge + right]);
  }
}

/* Without chords and chains: one cell. */
static bool is_plain(const aqr_regions* r, aqr_index f)
{
  return r->lines->head[f] == AQR_NONE;
}

/* Unites what belongs together inside a face. */
static void unite_inside(const aqr_regions* r, const aqr_layout* a)
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

static bool on_chain(const aqr_regions* r, aqr_index point)
{
  return r->chains->is_node[r->s->clean[point]] != 0;
}

/* A stretch between two cells of one region. */
static void count_stretch(const aqr_regions* r, aqr_index item, bool leaves)
{
  add_euler(r, item, -1);
  if (leaves)
    add_border(r, item, AQR_GOES_ON);
}

static void count_plain(const aqr_regions* r, aqr_index f)
{
  const aqr_surface* s = r->s;
  int32_t euler = 1;
  uint8_t bordered = AQR_HAS_CELL;
  for (aqr_index h = 3 * f; h < 3 * f + 3; h++)
  {
    aqr_index t = aqr_twin(s, h), v = aqr_from(s, h);
    bool leaves = t != AQR_NONE && !r->suspect[aqr_face_of(t)];
    euler += s->fan[v] == h && !on_chain(r, v);
    euler -= t != AQR_NONE && (t > h || leaves);
    bordered |= leaves ? AQR_GOES_ON : 0;
  }
  atomic_store_explicit(&r->euler[f], euler, memory_order_relaxed); /* the item is this face's alone */
  atomic_store_explicit(&r->bordered[f], bordered, memory_order_relaxed);
}

/* Cells minus stretches plus vertices. */
static void count_cells(const aqr_regions* r, const aqr_layout* a)
{
  const aqr_surface* s = r->s;
  for (size_t i = 0; i < a->n_cells; i++)
  {
    add_euler(r, a->item[i], 1);
    add_border(r, a->item[i], AQR_HAS_CELL);
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

static void enter_face(const aqr_regions* r, const aqr_layout* a)
{
  unite_inside(r, a);
  count_cells(r, a);
}

static void enter_faces(void* data, size_t begin, size_t end)
{
  aqr_regions* r = data;
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
static aqr_status enter_large(aqr_regions* r)
{
  for (aqr_index f = 0; f < r->s->n_faces; f++)
  {
    if (!r->picked[f])
      continue;
    if (!aqr_layout_face(r->c, r->s, r->lines, r->net, f, &r->at))
      return AQR_OUT_OF_MEMORY;
    enter_face(r, &r->at);
  }
  return AQR_OK;
}

/* Unites over whole edges. Stretches of cut edges need nothing: both sides of them border the same loop. */
static void unite_over(void* data, size_t begin, size_t end)
{
  const aqr_regions* r = data;
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
  const aqr_regions* r = data;
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
  aqr_regions* r = data;
  for (size_t i = begin; i < end; i++)
  {
    atomic_init(&r->parent[i], (aqr_index)i);
    atomic_init(&r->euler[i], 0);
    atomic_init(&r->bordered[i], i < r->s->n_faces ? 0 : AQR_HAS_LOOP);
  }
}

static void mark_bare(void* data, size_t begin, size_t end)
{
  aqr_regions* r = data;
  for (size_t f = begin; f < end; f++)
    if (r->suspect[f])
      r->is_bare[f] = r->start[3 * f] != AQR_NONE && !(r->bordered[find(r, r->start[3 * f])] & AQR_HAS_LOOP);
}

/* Finds the regions, of each its Euler number, and components without network. */
static aqr_status count(aqr_regions* r)
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

/* Loops that no stretch of a border belongs to lie inside one face and are disks. */
bool aqr_region_needs_cut(const aqr_regions* r, aqr_index item)
{
  aqr_index root = find(r, item);
  return r->bordered[root] == (AQR_HAS_LOOP | AQR_HAS_CELL) && r->euler[root] < 1;
}

aqr_status aqr_regions_cut(aqr_context* c, const aqr_surface* s, const aqr_chains* chains, const aqr_network* net,
  aqr_lines* lines, uint8_t* is_bare, uint8_t* suspect, bool cut, size_t* added)
{
  aqr_regions r = {
    .c = c, .s = s, .chains = chains, .net = net, .lines = lines, .suspect = suspect, .is_bare = is_bare
  };
  aqr_region_cells cells = { .s = s };
  aqr_status status = AQR_OK;
  *added = 0;
  r.n_items = s->n_faces + net->n_loops;
  r.start = AQR_NEW(c, aqr_index, 3 * s->n_faces);
  r.parent = AQR_NEW(c, aqr_shared_index, r.n_items);
  r.euler = AQR_NEW(c, aqr_shared_number, r.n_items);
  r.bordered = AQR_NEW(c, aqr_shared_flag, r.n_items);
  r.picked = AQR_NEW0(c, uint8_t, s->n_faces);
  AQR_REQUIRE(r.start && r.parent && r.euler && r.bordered && r.picked, AQR_OUT_OF_MEMORY);
  AQR_TRY(count(&r));
  bool any = false;
  for (aqr_index i = 0; cut && i < r.n_items && !any; i++)
    any = aqr_above(r.parent, i) == i && aqr_region_needs_cut(&r, i);
  if (any)
  {
    cells.slot = AQR_NEW(c, aqr_index, s->n_faces);
    AQR_REQUIRE(cells.slot, AQR_OUT_OF_MEMORY);
    AQR_TRY(aqr_region_cells_list(&r, &cells));
    AQR_TRY(aqr_arcs_draw(c, &cells, lines, added));
    for (aqr_index f = 0; f < s->n_faces; f++)
      suspect[f] = cells.slot[f] != AQR_NONE;
  }
done:
  AQR_DROP(c, r.start, 3 * s->n_faces);
  AQR_DROP(c, r.picked, s->n_faces);
  AQR_DROP(c, r.parent, r.n_items);
  AQR_DROP(c, r.euler, r.n_items);
  AQR_DROP(c, r.bordered, r.n_items);
  aqr_region_cells_free(c, &cells);
  aqr_layout_free(c, &r.at);
  return status;
}
