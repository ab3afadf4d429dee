/* SPDX-License-Identifier: BSD-3-Clause */
/* One line: integrated from a seed to both sides until something stops it (paper 3.1, 3.2, 4.2). */
#ifndef AQR_GROWTH_H
#define AQR_GROWTH_H

#include "proximity.h"
#include "sizing.h"
#include "tracer.h"

/* Half of a line: what has grown from the seed one way. Its samples are the tracer's. */
typedef struct aqr_half
{
  double sign; /* of arc lengths: -1 on the way back */
  double step, queried, arc, densest;
  size_t entered; /* samples that the draft has */
  vec3 seed, seen;
  int steps;
  aqr_line_end end;
  bool stopped;
} aqr_half;

/* What a query saw, so that it can be asked again of lines that have come since. */
typedef struct aqr_look
{
  aqr_probe probe;
  size_t first_face; /* of those looked at, up to the next look's; none where another line was found */
  size_t n_samples;  /* of the half at that time; SIZE_MAX where the line has taken some of these back */
  bool guessed;      /* found a line that grows beside: the half has stopped there, but the line may not come so far */
} aqr_look;

typedef struct aqr_grower
{
  const aqr_surface* surface;
  const aqr_field* field;
  const aqr_sizing* sizing;
  const aqr_lines* lines; /* committed lines */
  aqr_tracer tracer;
  aqr_pcell cell;
  aqr_draft draft; /* of the growing line */
  aqr_place at;    /* its seed */
  vec3 direction;
  aqr_half half;       /* the one that grows */
  bool ahead, grown;   /* whether it is the first one; whether both have stopped */
  aqr_sample* samples; /* of the line grown last; of its first half, before that */
  size_t n_samples, capacity;
  aqr_line line;    /* its description; count 0: nothing grew */
  unsigned guesses; /* how many of the lines that grow beside count as if they were there */
  bool keeps_looks; /* since the last seed */
  aqr_look* looks;  /* the first asked whether the line may start */
  size_t n_looks, n_ahead, look_capacity;
  aqr_index* faces; /* seen by looks */
  size_t n_faces, face_capacity;
} aqr_grower;

aqr_status aqr_grower_init(aqr_context* c, const aqr_surface* s, const aqr_field* field, const aqr_sizing* sizing,
  const aqr_lines* lines, aqr_grower* g);
void aqr_grower_free(aqr_context* c, aqr_grower* g);

/* Whether a line along `direction` may start at p: no line of its family within `distance`. */
aqr_status aqr_grow_allowed(
  aqr_context* c, aqr_grower* g, aqr_index face, vec3 p, vec3 direction, double distance, bool* allowed);

/* Whether that can be said not to be at a glance. */
aqr_status aqr_grow_crowded(
  aqr_context* c, aqr_grower* g, aqr_index face, vec3 p, vec3 direction, double distance, bool* crowded);

/* Grows a line through a place in both directions. */
aqr_status aqr_grow_inside(aqr_context* c, aqr_grower* g, const aqr_place* at, vec3 direction);

/* The same piece by piece, so that several growers can be at work on one set of lines: each half of the line by at most
 * so many steps a call, until `grown`. It is then to be finished, after a review where lines have been committed since:
 * what a line that grew after them would have been is cut out of it, unless it has to be grown again. */
void aqr_grow_start(aqr_grower* g, const aqr_place* at, vec3 direction);
aqr_status aqr_grow_on(aqr_context* c, aqr_grower* g, int most_steps);
aqr_status aqr_grow_finish(aqr_context* c, aqr_grower* g);

typedef enum aqr_review
{
  AQR_STANDS,
  AQR_NO_ROOM, /* may not start any more */
  AQR_OUTDATED /* has to be grown again */
} aqr_review;
/* Of a line whose looks were kept, against the segments from number `since` on. Counts in *queries the queries that a
 * line grown after them would have made. */
aqr_status aqr_grow_review(aqr_context* c, aqr_grower* g, size_t since, size_t* queries, aqr_review* review);

/* Grows a line from a point of a boundary or seam half-edge into its face. */
aqr_status aqr_grow_from_border(aqr_context* c, aqr_grower* g, aqr_index h, double t, vec3 direction);

#endif
