/* SPDX-License-Identifier: BSD-3-Clause */
/* What sampling.c, which decides where seeds go, and sampled_lines.c, which makes lines of them, share. */
#ifndef AQR_SAMPLER_H
#define AQR_SAMPLER_H

#include "growth.h"
#include "sampling.h"

enum
{
  AQR_MOST_LEFT_OUT = 32 /* lines that would go too far beyond the points asked for, until these count as reached */
};

/* Where another line crosses a line, or ends on a chain. */
typedef struct aqr_line_mark
{
  double sigma; /* position along the line, in spacings */
  aqr_index next;
} aqr_line_mark;

/* What is known of a line as a parent. */
typedef struct aqr_line_parent
{
  aqr_index newest; /* of its marks */
  aqr_index n_marks;
  aqr_index asked; /* one more than the marks it had when it was last asked for seeds; 0 before */
} aqr_line_parent;

typedef struct aqr_sampler
{
  aqr_context* c;
  const aqr_surface* s;
  const aqr_field* field;
  aqr_sizing* sizing;
  const aqr_sampling_options* options;
  aqr_lines* lines;
  aqr_grower grower;
  aqr_line_mark* marks;
  size_t n_marks, mark_capacity;
  aqr_line_parent* parents; /* per line */
  size_t n_parents, parent_capacity;
  double* places; /* marks of the parent being asked, in order */
  size_t n_places, place_capacity;
  size_t n_failed; /* growths that came to nothing */
  size_t in_vain;  /* faces that these crossed */
  size_t crossed;  /* faces that all growths before this one crossed */
  double points;   /* expected of the lines: their crossings, and on chains their ends or the chain's own spacing */
  double goal;     /* no further seeds once as many are expected */
  int left_out;    /* lines that would have gone too far beyond it */
} aqr_sampler;

/* Whether no further line is wanted. */
static inline bool aqr_is_full(const aqr_sampler* m)
{
  return m->points >= m->goal || m->left_out >= AQR_MOST_LEFT_OUT;
}

/* The points expected of a line. */
double aqr_points_on(const aqr_sampler* m, aqr_index line);

/* Adds a chain of the surface as a line. */
aqr_status aqr_sample_chain(aqr_sampler* m, const aqr_chains* chains, const aqr_chain* chain);

/* A line from a point inside face f along direction d, unless one of its family is nearer than `distance`, or what
 * comes of it is not worth keeping. */
aqr_status aqr_seed_inside(aqr_sampler* m, aqr_index f, vec3 p, vec3 d, double distance);

/* The same from a point on half-edge h of a chain, to one or both sides. */
aqr_status aqr_seed_on_chain(aqr_sampler* m, aqr_index h, double t, double distance);

#endif
