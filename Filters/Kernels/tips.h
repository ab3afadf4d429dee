/* SPDX-License-Identifier: BSD-3-Clause */
/* Tips of limbs that no two lines cross on: without a vertex of their own the mesh would end at the last crossings
 * before them. */
#ifndef AQR_TIPS_H
#define AQR_TIPS_H

#include "field.h"
#include "network.h"

/* A region that a line leads into without crossing another. */
typedef struct aqr_bay
{
  size_t points, border; /* its first of aqr_tips.points and .border; the next bay's follow */
} aqr_bay;

typedef struct aqr_tips
{
  const aqr_surface* s;
  const double* normals; /* 3 per point of s */
  aqr_bay* bays;         /* one more than there are, to end the last */
  size_t n_bays, bay_capacity;
  aqr_index* points; /* of the surface, inside the bays */
  size_t n_points, point_capacity;
  aqr_index* border; /* vertices of the mesh around the bays, some of them just near it */
  size_t n_border, border_capacity;
} aqr_tips;

/* Lists the bays of a network, of which m is the mesh as aqr_network_mesh() leaves it. */
aqr_status aqr_tips_find(aqr_context* c, const aqr_surface* s, const double* normals, const aqr_lines* l,
  const aqr_network* net, const aqr_polygon_mesh* m, aqr_tips* tips);
void aqr_tips_free(aqr_context* c, aqr_tips* tips);

/* Where a bay lies far out of the face that stands for it, its farthest point becomes a vertex, and the face triangles
 * that meet there. */
aqr_status aqr_tips_raise(aqr_context* c, const aqr_tips* tips, aqr_polygon_mesh* m);

/* ---- a face that something stands out of ---- */

/* Mean distance of the corners from the centre, and mean of their sizes. */
double aqr_face_radius(const aqr_polygon_mesh* m, aqr_index f, double* size);
/* Of p from the triangles between the sides of a face and its centre. */
double aqr_face_distance2(const aqr_polygon_mesh* m, aqr_index f, vec3 p);
/* Cuts a face into triangles that meet at a new vertex. */
aqr_status aqr_raise_face(aqr_context* c, aqr_polygon_mesh* m, aqr_index f, const aqr_vertex* tip);
/* A free vertex at a point of the surface. */
aqr_vertex aqr_vertex_at(const aqr_surface* s, const double* normals, aqr_index point, double size);

#endif
