/* SPDX-License-Identifier: BSD-3-Clause */
/* The cells of the regions to be cut and the pieces of their borders: the graph that arcs are searched in. */
#ifndef AQR_REGION_CELLS_H
#define AQR_REGION_CELLS_H

#include "regions_impl.h"

/* A piece of a cell's border: of an edge of the face, or a contact with the network. */
typedef struct aqr_piece
{
  aqr_index cell, half_edge;
  aqr_index from, to; /* vertices: points of the surface, then both sides of the samples */
  double t;           /* where an arc passes, on half_edge */
  bool is_contact;    /* the network lies there: a chain's edge, or a chord past whose end on half_edge the arc goes */
  bool is_chord;
} aqr_piece;

/* The pieces of a face: of half-edge k from first[k] on, contacts with chords from first[3] to end. */
typedef struct aqr_slot
{
  aqr_index first[4], end;
} aqr_slot;

typedef struct aqr_region_cell
{
  aqr_index face;
  aqr_index before;  /* the cell the search came from; AQR_NONE at a root */
  aqr_index exit;    /* the piece of this cell towards it, or the root's contact */
  uint32_t distance; /* UINT32_MAX: not reached */
  bool wanted;       /* of a region to be cut */
} aqr_region_cell;

typedef struct aqr_region_cells
{
  const aqr_surface* s;
  aqr_index* slot; /* per face: where its pieces are listed, or AQR_NONE */
  aqr_slot* slots;
  size_t n_slots, slot_capacity;
  aqr_piece* pieces;
  size_t n_pieces, piece_capacity;
  aqr_region_cell* cells;
  size_t n_cells, cell_capacity;
} aqr_region_cells;

/* Lists the cells of all faces that have some of a region to be cut, and their pieces; the search has reached none yet.
 * Marks of r's lines that lie at one place are moved apart. `g` starts zeroed but for s, and slot, which has room. */
aqr_status aqr_region_cells_list(aqr_regions* r, aqr_region_cells* g);
void aqr_region_cells_free(aqr_context* c, aqr_region_cells* g);

/* Whether the cell across a piece is listed too. */
bool aqr_piece_leads_on(const aqr_region_cells* g, aqr_index i);

/* The same piece seen from the other face: pieces of an edge come in opposite orders on its two sides. */
aqr_index aqr_piece_across(const aqr_region_cells* g, aqr_index i);

#endif
