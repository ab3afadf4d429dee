/* SPDX-License-Identifier: BSD-3-Clause */
/* Integration of lines directly on the surface by local unfolding (paper 3.1 and 4.2). */
#ifndef AQR_TRACER_H
#define AQR_TRACER_H

#include "field.h"
#include "flatten.h"
#include "lines.h"
#include "polygon_mesh.h"

/* The parameterization context: one face laid isometrically into the plane. */
typedef struct aqr_chart
{
  aqr_index face;
  aqr_complex q[3]; /* its corners */
} aqr_chart;

typedef enum aqr_advance
{
  AQR_INSIDE,   /* the target was reached */
  AQR_AT_BORDER /* a boundary or seam was reached first */
} aqr_advance;

/* A point that moves over the surface and leaves samples where it crosses edges. */
typedef struct aqr_tracer
{
  const aqr_surface* surface;
  const aqr_short_rotor* flat; /* of aqr_field; NULL for pure geodesics */
  aqr_chart chart;
  aqr_complex x, d; /* position and unit direction in the chart */
  bool isotropic;   /* the last step followed the trusted direction, not the field */
  bool lost;        /* among faces so thin that no move came to its end */
  size_t crossed;   /* faces entered by all moves and trial moves, from any start: the work done */
  double travelled; /* along the surface since the start: around a thin tube far more than through space */
  aqr_sample* samples;
  size_t n_samples, capacity;
} aqr_tracer;

void aqr_tracer_init(aqr_tracer* t, const aqr_surface* s, const aqr_field* field);
void aqr_tracer_free(aqr_context* c, aqr_tracer* t);

/* Puts the point at a place with a direction in space, projected into the face. Forgets the
 * samples. */
void aqr_tracer_start(aqr_tracer* t, const aqr_place* at, vec3 direction);

/* Points the direction along one in space, projected into the face; false where nothing is left of it. */
bool aqr_tracer_steer(aqr_tracer* t, vec3 direction);

/* Turns the direction to the branch of the cross field nearest to it; false where the field is not
 * coherent. */
bool aqr_tracer_align(aqr_tracer* t);

/* Moves the point straight along its direction by `length`: a geodesic. */
aqr_status aqr_tracer_straight(aqr_context* c, aqr_tracer* t, double length, aqr_advance* result);

/* One Runge-Kutta step of the field line; *step is shortened until the estimated turn error is
 * below a fixed angle, and set to what the next step should try, within [shortest, longest]. Goes
 * straight where the field is not coherent. */
aqr_status aqr_tracer_step(
  aqr_context* c, aqr_tracer* t, double* step, double shortest, double longest, aqr_advance* result);

void aqr_tracer_where(const aqr_tracer* t, vec3* position, vec3* direction);
vec3 aqr_tracer_position(const aqr_tracer* t);
vec3 aqr_tracer_direction(const aqr_tracer* t);

/* Lays face f into the plane with corner 0 at the origin and half-edge 0 along +x. */
void aqr_chart_lay(const aqr_tracer* t, aqr_index f, aqr_chart* chart);
/* Lays the face over half-edge k of the chart beside it. The half-edge must have a twin. */
void aqr_chart_unfold(const aqr_tracer* t, const aqr_chart* from, unsigned k, aqr_chart* to);

/* Where a straight line that arrives exactly at a vertex leaves it: the polar map scales the angles
 * around the vertex so that they sum to a full turn (paper 3.1, case 3). `arrival` is an outgoing
 * half-edge of the vertex and `angle` the angle counter-clockwise from it to the way back. Gives
 * the outgoing half-edge clockwise-next to the way out and the angle from it inside its face. False
 * at a border vertex, where there is no way out. */
bool aqr_polar_exit(const aqr_surface* s, aqr_index arrival, double angle, aqr_index* exit, double* exit_angle);

#endif
