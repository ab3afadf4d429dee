/* SPDX-License-Identifier: BSD-3-Clause */
/* The working surface: oriented manifold triangles with compact adjacency, scaled to a unit box.
 *
 * Half-edge h = 3 f + i runs from corner i to corner (i + 1) % 3 of face f. Its twin is the
 * half-edge of the neighbouring face over the same edge. Crease edges are seams: the surface is cut
 * open along them (points on both sides are distinct, coincident "sector" points), so that no
 * field, ball or p-cell reaches across, but the half-edge on the other side is still known. */
#ifndef AQR_SURFACE_H
#define AQR_SURFACE_H

#include "context.h"
#include "vector.h"

#define AQR_SEAM 0x80000000u    /* set in `twin` where the edge is a seam */
#define AQR_BETWEEN 0x80000000u /* set in `origin` where the point is none of the input's */

typedef struct aqr_surface
{
  size_t n_points, n_faces;
  size_t n_clean;      /* cleaned points: those there were before creases cut sectors off */
  double* points;      /* 3 * n_points; bounding box diagonal 1, centred at 0 */
  aqr_index* corner;   /* 3 * n_faces: point at the start of each half-edge */
  aqr_index* twin;     /* 3 * n_faces: AQR_NONE at a boundary, AQR_SEAM | h over a seam, else h */
  aqr_index* fan;      /* n_points: an outgoing half-edge, the clockwise-most where the point has a border or
                          seam, so that following aqr_next_around() from it meets every face around the point */
  aqr_index* clean;    /* n_points: the cleaned point it is a sector of, < n_clean; several sectors may
                          share one */
  aqr_index* origin;   /* n_clean: the input point that the cleaned point is, or AQR_BETWEEN | one of `between` */
  aqr_origin* between; /* where cleaned points lie that are none of the input's */
  size_t n_between, between_capacity;
  aqr_index* source; /* n_faces: input triangle */
  uint8_t* locked;   /* 3 * n_faces: 1 where the half-edge is to be a crease whatever its angle; NULL: none. Only the
                        cleaned surface has it, cuts and copies do not */
  uint8_t* mirrored; /* n_clean: 1 for points on the plane over which this half will be mirrored; NULL: no plane */
  size_t mirrored_loops;                        /* borders of this half that lie wholly on that plane */
  size_t faces_held, points_held, origins_held; /* what the arrays per face, per point, and `origin` have room for */
  vec3 centre;                                  /* input = centre + diagonal * point */
  double diagonal;
} aqr_surface;

static inline aqr_index aqr_face_of(aqr_index h)
{
  return h / 3;
}
static inline aqr_index aqr_next(aqr_index h)
{
  return h % 3 == 2 ? h - 2 : h + 1;
}
static inline aqr_index aqr_prev(aqr_index h)
{
  return h % 3 == 0 ? h + 2 : h - 1;
}
/* The half-edge on the other side, across which fields are continuous; AQR_NONE at boundaries and
 * seams. */
static inline aqr_index aqr_twin(const aqr_surface* s, aqr_index h)
{
  aqr_index t = s->twin[h];
  return t & AQR_SEAM ? AQR_NONE : t; /* AQR_NONE has the bit too */
}
/* As aqr_twin, but over seams as well; AQR_NONE at boundaries only. */
static inline aqr_index aqr_any_twin(const aqr_surface* s, aqr_index h)
{
  aqr_index t = s->twin[h];
  return t == AQR_NONE ? t : t & ~AQR_SEAM;
}
static inline bool aqr_is_boundary(const aqr_surface* s, aqr_index h)
{
  return s->twin[h] == AQR_NONE;
}
static inline bool aqr_is_seam(const aqr_surface* s, aqr_index h)
{
  return s->twin[h] != AQR_NONE && (s->twin[h] & AQR_SEAM);
}
static inline aqr_index aqr_from(const aqr_surface* s, aqr_index h)
{
  return s->corner[h];
}
static inline aqr_index aqr_to(const aqr_surface* s, aqr_index h)
{
  return s->corner[aqr_next(h)];
}
/* The next outgoing half-edge counter-clockwise around the start of h; AQR_NONE past a border or
 * seam. */
static inline aqr_index aqr_next_around(const aqr_surface* s, aqr_index h)
{
  return aqr_twin(s, aqr_prev(h));
}
static inline vec3 aqr_point(const aqr_surface* s, aqr_index v)
{
  return v3_load(s->points + 3 * (size_t)v);
}
static inline vec3 aqr_edge_vector(const aqr_surface* s, aqr_index h)
{
  return v3_sub(aqr_point(s, aqr_to(s, h)), aqr_point(s, aqr_from(s, h)));
}
/* Twice the area times the unit normal. */
static inline vec3 aqr_face_cross(const aqr_surface* s, aqr_index f)
{
  vec3 a = aqr_point(s, s->corner[3 * f]), b = aqr_point(s, s->corner[3 * f + 1]),
       c = aqr_point(s, s->corner[3 * f + 2]);
  return v3_cross(v3_sub(b, a), v3_sub(c, a));
}

/* Cleans the input (see the counts in aqr_report): joins exactly coincident points, drops degenerate and duplicate
 * triangles, orients, cuts non-manifold edges and points apart, halves edges longer than longest_edge (a fraction of
 * the diagonal). No seams yet. */
aqr_status aqr_surface_build(
  aqr_context* c, const aqr_input* input, double longest_edge, aqr_surface* s, aqr_report* report);

static inline vec3 aqr_input_point(const aqr_input* in, size_t i)
{
  return in->points_f
           ? v3((double)in->points_f[3 * i], (double)in->points_f[3 * i + 1], (double)in->points_f[3 * i + 2])
           : v3_load(in->points_d + 3 * i);
}

/* Of all faces, of a surface whose diagonal is 1. */
double aqr_surface_area(const aqr_surface* s);

/* Numbers faces and points along a space-filling curve and places the points (surface_order.c), before adjacency is
 * known: centre and diagonal are set, and corners are input points still. The fan of each point is set to the first of
 * its half-edges. */
aqr_status aqr_surface_arrange(aqr_context* c, const aqr_input* input, aqr_surface* s);

/* Finds the edges that input->locked asks for on the refined surface (surface_lock.c). weld: per input point the one it
 * was joined to, as in the origins. */
aqr_status aqr_surface_lock(
  aqr_context* c, const aqr_input* input, const aqr_index* weld, aqr_surface* s, aqr_report* report);

/* The input's order: ranks of the faces by input triangle, and of the cleaned points by input point with the points
 * added by refinement behind them. */
aqr_status aqr_surface_rank_faces(aqr_context* c, const aqr_surface* s, aqr_index* rank);
aqr_status aqr_surface_rank_points(aqr_context* c, const aqr_surface* s, size_t n_input_points, aqr_index* rank);

/* Cuts the surface open along the half-edges marked in is_crease (3 * n_faces, both sides marked): twins become seams
 * and points are split into sectors. */
aqr_status aqr_surface_cut(aqr_context* c, aqr_surface* s, const uint8_t* is_crease);

/* Halves edges longer than longest_edge at their middle, longest first, with the triangles beside them (paper 3.2),
 * until there are 8 times the faces and 16000 more. */
aqr_status aqr_surface_refine(aqr_context* c, aqr_surface* s, double longest_edge, size_t* added);

/* Gives every fan of faces a cleaned point of its own, and all points their fans; clean and n_clean are set. */
aqr_status aqr_surface_split_fans(aqr_context* c, aqr_surface* s);

/* Whether the half-edge is a border on the plane over which the surface will be mirrored. */
static inline bool aqr_on_plane(const aqr_surface* s, aqr_index h)
{
  return s->mirrored && aqr_is_boundary(s, h) && s->mirrored[s->clean[aqr_from(s, h)]] &&
         s->mirrored[s->clean[aqr_to(s, h)]];
}

void aqr_surface_free(aqr_context* c, aqr_surface* s);

/* Deep copy, so that a change of feature options need not clean the input again. */
aqr_status aqr_surface_copy(aqr_context* c, const aqr_surface* from, aqr_surface* to);

/* Room for more; false when out of memory, the surface then stays as it is. Origins have room of their own, since
 * sectors have none. */
bool aqr_surface_reserve_faces(aqr_context* c, aqr_surface* s, size_t need);
bool aqr_surface_reserve_points(aqr_context* c, aqr_surface* s, size_t need);
bool aqr_surface_reserve_origins(aqr_context* c, aqr_surface* s, size_t need);

/* Whether cleaned point v is a point of the input. */
static inline bool aqr_is_input_point(const aqr_surface* s, size_t v)
{
  return !(s->origin[v] & AQR_BETWEEN);
}

/* Where cleaned point v lies on the input. */
aqr_origin aqr_origin_of(const aqr_surface* s, size_t v);

/* The place at fraction t between two cleaned points of one input triangle. */
aqr_origin aqr_origin_between(const aqr_surface* s, aqr_index a, aqr_index b, double t, aqr_index triangle);

/* Gives cleaned point v, for which there is room, an origin that is no input point; false when out of memory. */
bool aqr_surface_put_between(aqr_context* c, aqr_surface* s, size_t v, const aqr_origin* origin);

#endif
