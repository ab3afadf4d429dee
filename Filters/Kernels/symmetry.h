/* SPDX-License-Identifier: BSD-3-Clause */
/* Symmetric output: the half of the surface on the positive side of a plane is remeshed, and mirrored at the end. */
#ifndef AQR_SYMMETRY_H
#define AQR_SYMMETRY_H

#include "polygon_mesh.h"
#include "surface.h"

typedef struct aqr_plane
{
  vec3 origin, normal; /* unit normal; in the coordinates of whatever is mirrored */
} aqr_plane;

static inline double aqr_plane_height(const aqr_plane* p, vec3 x)
{
  return v3_dot(v3_sub(x, p->origin), p->normal);
}

/* Whether a normal on the plane tilts so far from it that surface and mirror image meet in a crease. */
static inline bool aqr_plane_creases(const aqr_plane* p, vec3 normal)
{
  return fabs(v3_dot(normal, p->normal)) > 0.3; /* sine of that angle */
}

/* Cuts the surface along the plane and keeps the positive side in *half, with the points on the plane marked as
 * mirrored; triangles across the plane are split. is_crease (3 per face of s): taken over to *crease (3 per face of
 * the half). AQR_BAD_OPTION where no triangle has a corner on the positive side. */
aqr_status aqr_symmetry_cut(aqr_context* c, const aqr_surface* s, const aqr_plane* plane, const uint8_t* is_crease,
  aqr_surface* half, uint8_t** crease);

/* How many input points of the surface have no other at their mirror image. */
aqr_status aqr_symmetry_unmatched(aqr_context* c, const aqr_surface* s, const aqr_plane* plane, size_t* count);

/* Makes tensors (6 per point: xx yy zz xy xz yz) and normals (3) on the plane those of the whole surface: the mean of
 * what the half gave and its mirror image. */
void aqr_symmetry_complete(const aqr_surface* half, const aqr_plane* plane, float* tensors, double* normals);

/* The part of a unit normal along the plane, of unit length; the normal itself where it has none. */
static inline vec3 aqr_plane_normal(const aqr_plane* p, vec3 normal)
{
  vec3 along = v3_madd(normal, -v3_dot(normal, p->normal), p->normal);
  return v3_norm2(along) > 1e-6 ? v3_unit(along) : normal;
}

/* Whether a vertex of the mesh of a half lies on the plane, where the half and its mirror image are joined. */
bool aqr_symmetry_on_plane(const aqr_surface* half, const aqr_polygon_mesh* m, aqr_index v);

/* Vertices minus edges of what a half and its mirror image have in common: the Euler number of the whole is twice that
 * of the half less this. */
long long aqr_symmetry_joint(const aqr_surface* half, const aqr_polygon_mesh* m);
long long aqr_symmetry_joint_of_surface(const aqr_surface* half);
/* The closed loops in it, as the half has in mirrored_loops. */
size_t aqr_symmetry_loops(const aqr_surface* half, const aqr_polygon_mesh* m);

/* Inserts vertices so that no inner edge joins two vertices on the plane and every face has one off it: else mirroring
 * would bring three faces to an edge or two over the same vertices. */
aqr_status aqr_symmetry_open(aqr_context* c, const aqr_surface* half, aqr_polygon_mesh* m);

#endif
