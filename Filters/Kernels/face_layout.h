/* SPDX-License-Identifier: BSD-3-Clause */
/* What the chords of lines make of one face: cells, and the stretches of the face's border that belong to each. */
#ifndef AQR_FACE_LAYOUT_H
#define AQR_FACE_LAYOUT_H

#include "network.h"

/* A chord's end on the border of a face. */
typedef struct aqr_border_mark
{
  aqr_index sample, chord, line;
  aqr_index half_edge;
  bool starts;   /* the chord starts here, else it ends here */
  bool kept;     /* an edge of the network passes */
  unsigned cell; /* of the stretch of border that follows counter-clockwise */
} aqr_border_mark;

/* Items are what regions are made of: faces without chords, then loops of the network. */
typedef struct aqr_layout
{
  aqr_index face;
  aqr_border_mark* marks; /* counter-clockwise from corner 0 */
  size_t n_marks;
  uint64_t* signature; /* per mark, as the following are: of the chords around the stretch after it */
  aqr_index* group;    /* of stretches, union-find */
  aqr_index* item;     /* per cell: an item of its region */
  size_t n_cells;
  size_t capacity;
} aqr_layout;

/* Lays out face f; false when that takes more room than there is. `a` starts zeroed. */
bool aqr_layout_face(
  aqr_context* c, const aqr_surface* s, const aqr_lines* lines, const aqr_network* net, aqr_index f, aqr_layout* a);
void aqr_layout_free(aqr_context* c, aqr_layout* a);

enum
{
  AQR_SMALL_LAYOUT = 64 /* marks; most faces have a few */
};

/* Room for a small layout, without asking a context for it. */
typedef struct aqr_small_layout
{
  aqr_border_mark marks[AQR_SMALL_LAYOUT];
  uint64_t signature[AQR_SMALL_LAYOUT];
  aqr_index group[AQR_SMALL_LAYOUT], item[AQR_SMALL_LAYOUT];
} aqr_small_layout;
aqr_layout aqr_layout_in(aqr_small_layout* room); /* to be laid out with context NULL, and not to be freed */

/* The loop on the stretch of border after or before a kept mark. */
aqr_index aqr_item_after(const aqr_surface* s, const aqr_network* net, const aqr_border_mark* m);
aqr_index aqr_item_before(const aqr_surface* s, const aqr_network* net, const aqr_border_mark* m);

/* The marks on half-edge k of the face: [*first, *end). The stretch before *first belongs to the cell of the mark
 * before. */
void aqr_layout_marks_on(const aqr_layout* a, unsigned k, size_t* first, size_t* end);
unsigned aqr_layout_cell_before(const aqr_layout* a, size_t mark);

#endif
