/* SPDX-License-Identifier: BSD-3-Clause */
/* Scores of polygons and the best way to cut one by diagonals (paper 5.2): cells that are quads with right angles are
 * best, a straight corner is where a line ends on another. */
#ifndef AQR_PARTITION_H
#define AQR_PARTITION_H

#include "polygon_mesh.h"

enum
{
  AQR_POLYGON_CORNERS = 12 /* polygons up to this many corners are cut in the best of all ways */
};

typedef struct aqr_polygon
{
  unsigned n;
  vec3 p[AQR_POLYGON_CORNERS], normal[AQR_POLYGON_CORNERS]; /* normals of the input surface at the corners */
  bool sharp[AQR_POLYGON_CORNERS]; /* vertices of creases: their normal is that of one side, or of none */
  vec3 area;                       /* vector area of the corners so far: the normal at sharp ones */
  aqr_index vertex[AQR_POLYGON_CORNERS];
} aqr_polygon;

/* Adds a corner behind the others; there must be room. */
void aqr_polygon_add(aqr_polygon* g, aqr_index index, const aqr_vertex* v);

/* What a polygon costs: 0 for a rectangle, about 1 for a triangle or a pentagon of good shape, more for every further
 * corner and for concave ones. */
double aqr_polygon_cost(const aqr_polygon* g);
/* Whether a corner is concave: its sector normal points away from the surface's (paper 5.2). Corners that are straight
 * up to ten degrees, as where a line ends on another, are not. */
bool aqr_polygon_is_concave(const aqr_polygon* g);

/* Interior angle of corner i, in [0, 2 pi). */
double aqr_polygon_angle(const aqr_polygon* g, unsigned i);
/* Interior angle at p between the edges to `next` and from `prev`, in [0, 2 pi), as seen along the normal. */
double aqr_corner_angle(vec3 prev, vec3 p, vec3 next, vec3 normal);

typedef struct aqr_partition
{
  double cost; /* sum over the parts; infinite where there is no way */
  unsigned n;  /* diagonals */
  unsigned char from[AQR_POLYGON_CORNERS], to[AQR_POLYGON_CORNERS];
} aqr_partition;

/* The cheapest partition into polygons of at most `largest` corners. Diagonals between vertices joined in m by an edge
 * other than that of `ignore` are not taken. */
aqr_partition aqr_best_partition(const aqr_polygon_mesh* m, const aqr_polygon* g, unsigned largest, aqr_index ignore);

#endif
