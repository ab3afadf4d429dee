/* SPDX-License-Identifier: BSD-3-Clause */
/* Faces of more corners than can be cut in the best of all ways, and those that meet themselves: around the holes of a
 * plate, to which bridges lead (paper 5.2). */
#ifndef AQR_LARGE_FACES_H
#define AQR_LARGE_FACES_H

#include "polygon_mesh.h"

/* Cuts faces with more corners than AQR_POLYGON_CORNERS and largest_valence, or a vertex twice, along diagonals that do
 * not leave them, into parts that have neither: as far as there are such diagonals between vertices that no edge joins.
 * The mesh need not be regular. Progress stays at `at`. */
aqr_status aqr_cut_large_faces(aqr_context* c, aqr_polygon_mesh* m, int largest_valence, double at);

#endif
