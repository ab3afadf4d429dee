/* SPDX-License-Identifier: BSD-3-Clause */
#include "face_layout.h"

#include <string.h>

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

/* Right of a chord that starts, left of one that ends. */
aqr_index aqr_item_after(const aqr_surface* s, const aqr_network* net, const aqr_border_mark* m)
{
  return (aqr_index)s->n_faces + net->loop[2 * net->edge_at[m->sample] + (m->starts ? 1 : 0)];
}

aqr_index aqr_item_before(const aqr_surface* s, const aqr_network* net, const aqr_border_mark* m)
{
  return (aqr_index)s->n_faces + net->loop[2 * net->edge_at[m->sample] + (m->starts ? 0 : 1)];
}

aqr_layout aqr_layout_in(aqr_small_layout* room)
{
  return (aqr_layout){ .marks = room->marks,
    .signature = room->signature,
    .group = room->group,
    .item = room->item,
    .capacity = AQR_SMALL_LAYOUT };
}

void aqr_layout_free(aqr_context* c, aqr_layout* a)
{
  AQR_DROP(c, a->marks, a->capacity);
  AQR_DROP(c, a->signature, a->capacity);
  AQR_DROP(c, a->group, a->capacity);
  AQR_DROP(c, a->item, a->capacity);
  memset(a, 0, sizeof *a);
}

/* Room for so many marks, one capacity for all arrays. What was laid out is lost. */
static bool reserve(aqr_context* c, aqr_layout* a, size_t n)
{
  if (n <= a->capacity)
    return true;
  if (!c)
    return false;
  aqr_layout_free(c, a);
  a->capacity = 2 * n;
  a->marks = AQR_NEW(c, aqr_border_mark, a->capacity);
  a->signature = AQR_NEW(c, uint64_t, a->capacity);
  a->group = AQR_NEW(c, aqr_index, a->capacity);
  a->item = AQR_NEW(c, aqr_index, a->capacity);
  return a->marks && a->signature && a->group && a->item;
}

/* As aqr_border_before, of marks that know their half-edge. */
static bool before(const aqr_lines* lines, const aqr_border_mark* m, const aqr_border_mark* n)
{
  if (m->half_edge != n->half_edge)
    return m->half_edge < n->half_edge;
  const aqr_sample *a = &lines->samples[m->sample], *b = &lines->samples[n->sample];
  if (a->t < b->t || a->t > b->t)
    return (a->t < b->t) == (m->half_edge == a->edge);
  return a->key != b->key && (a->key < b->key) == (m->half_edge == a->edge);
}

static bool gather_marks(
  aqr_context* c, const aqr_surface* s, const aqr_lines* lines, const aqr_network* net, aqr_index f, aqr_layout* a)
{
  size_t n = 1;
  for (aqr_index k = lines->head[f]; k != AQR_NONE; k = aqr_next_chord(lines, k, f))
    n += 2;
  if (!reserve(c, a, n))
    return false;
  a->face = f;
  a->n_marks = 0;
  bool any = false;
  for (aqr_index k = lines->head[f]; k != AQR_NONE; k = aqr_next_chord(lines, k, f))
  {
    aqr_index line = lines->samples[k].line;
    if (lines->lines[line].is_chain)
      continue;
    for (aqr_index i = 0; i < 2; i++)
    {
      aqr_border_mark m = { .sample = k + i,
        .chord = k,
        .line = line,
        .half_edge = aqr_sample_half_edge(s, &lines->samples[k + i], f),
        .starts = i == 0,
        .kept = net->edge_at[k + i] != AQR_NONE };
      any |= m.kept;
      size_t j = a->n_marks++;
      for (; j > 0 && before(lines, &m, &a->marks[j - 1]); j--)
        a->marks[j] = a->marks[j - 1];
      a->marks[j] = m;
    }
  }
  if (!any)
    a->n_marks = 0;
  return true;
}

/* Sorts out which stretches of the face's border belong to one cell: those that no chord separates, and those on both
 * sides of a chord's end that the network left out. */
bool aqr_layout_face(
  aqr_context* c, const aqr_surface* s, const aqr_lines* lines, const aqr_network* net, aqr_index f, aqr_layout* a)
{
  if (!gather_marks(c, s, lines, net, f, a))
    return false;
  if (a->n_marks == 0)
  {
    a->n_cells = 1;
    a->item[0] = f;
    return true;
  }
  uint64_t signature = 0;
  for (size_t i = 0; i < a->n_marks; i++)
  {
    signature ^= hash(a->marks[i].chord);
    a->signature[i] = signature;
  }
  size_t n = a->n_marks;
  for (size_t i = 0; i < n; i++)
    a->group[i] = (aqr_index)i;
  for (size_t i = 0; i < n; i++)
  {
    if (!a->marks[i].kept)
      unite(a->group, (aqr_index)i, (aqr_index)((i + n - 1) % n));
    size_t j = i; /* equal signatures: to the nearest one before is enough */
    while (j > 0 && a->signature[j - 1] != a->signature[i])
      j--;
    if (j > 0)
      unite(a->group, (aqr_index)i, (aqr_index)(j - 1));
  }
  a->n_cells = 0;
  for (size_t i = 0; i < n; i++)
    if (find(a->group, (aqr_index)i) == i) /* the least of its group, so that it is numbered first */
    {
      a->marks[i].cell = (unsigned)a->n_cells;
      a->item[a->n_cells++] = AQR_NONE;
    }
  for (size_t i = 0; i < n; i++)
    a->marks[i].cell = a->marks[find(a->group, (aqr_index)i)].cell;
  for (size_t i = 0; i < n; i++)
  {
    if (a->marks[i].kept)
      a->item[a->marks[i].cell] = aqr_item_after(s, net, &a->marks[i]);
    if (a->marks[(i + 1) % n].kept)
      a->item[a->marks[i].cell] = aqr_item_before(s, net, &a->marks[(i + 1) % n]);
  }
  return true;
}

void aqr_layout_marks_on(const aqr_layout* a, unsigned k, size_t* first, size_t* end)
{
  aqr_index h = 3 * a->face + k;
  size_t i = 0;
  while (i < a->n_marks && a->marks[i].half_edge < h)
    i++;
  *first = i;
  while (i < a->n_marks && a->marks[i].half_edge == h)
    i++;
  *end = i;
}

unsigned aqr_layout_cell_before(const aqr_layout* a, size_t mark)
{
  return a->n_marks ? a->marks[(mark + a->n_marks - 1) % a->n_marks].cell : 0;
}
