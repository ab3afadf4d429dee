/* SPDX-License-Identifier: BSD-3-Clause */
/* From a cell decomposition of the surface to an ordinary polygon mesh: no loops, no two edges between the same
 * vertices, no vertex twice in a face, no two faces with the same vertices. */
#ifndef AQR_REGULARIZE_H
#define AQR_REGULARIZE_H

#include "polygon_mesh.h"

/* Removes what draws nothing: dangling edges (paper 5), digons, loops around nothing, vertices in the middle of a
 * straight line. Only ever removes; chains stay. */
aqr_status aqr_tidy(aqr_context* c, aqr_polygon_mesh* m);

/* Makes any consistent mesh regular by inserting vertices and splitting faces, for every input. New vertices carry the
 * place of a neighbour. */
aqr_status aqr_regularize(aqr_context* c, aqr_polygon_mesh* m);

/* ---- operators that keep a regular mesh regular but for equal faces, or do nothing and say so ---- */

/* Whether the edge of h may be contracted so that chains stay apart and on their curves, and no cell degenerates:
 * common neighbours of its ends are corners of the triangles beside it only, common faces are those beside it only. */
bool aqr_can_contract(const aqr_polygon_mesh* m, aqr_index h);
/* Contracts into the more constrained end, or into `middle` where both are equally free; returns the vertex that stays.
 */
aqr_index aqr_contract(aqr_polygon_mesh* m, aqr_index h, const aqr_vertex* middle);
/* Whether the two faces beside h touch only along it, so that merging them makes a proper face. */
bool aqr_can_merge(const aqr_polygon_mesh* m, aqr_index h);
/* Whether v is an inner vertex of valence two whose edges may become one. */
bool aqr_can_join(const aqr_polygon_mesh* m, aqr_index v);

/* A vertex in the middle of the edge of h. On a chain its place is a face nearby with all weights 0, until the fit puts
 * it there. */
aqr_vertex aqr_middle(const aqr_polygon_mesh* m, aqr_index h);

#endif
