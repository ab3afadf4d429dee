/* SPDX-License-Identifier: BSD-3-Clause */
/* The stages behind aqr_remesher and the results they leave. */
#ifndef AQR_PIPELINE_H
#define AQR_PIPELINE_H

#include "crease_budget.h"
#include "feature_graph.h"
#include "field.h"
#include "lines.h"
#include "polygon_mesh.h"
#include "sizing.h"
#include "subdivide.h"
#include "symmetry.h"

enum aqr_stage_id
{
  AQR_STAGE_SURFACE,
  AQR_STAGE_FEATURES,
  AQR_STAGE_CURVATURE,
  AQR_STAGE_FIELD,
  AQR_STAGE_SIZING,
  AQR_STAGE_LINES,
  AQR_STAGE_NETWORK,
  AQR_STAGE_FACES,
  AQR_STAGE_FIT,
  AQR_STAGE_RESULT,
  AQR_STAGES
};

struct aqr_remesher
{
  aqr_context context;
  aqr_report report;
  aqr_report surface_report; /* what cleaning found: part of every run's report */
  aqr_stage stages[AQR_STAGES];
  int valid; /* stages up to this one hold results for `done`; -1: none */
  aqr_options done;
  uint64_t done_density; /* fingerprint of the density array */
  size_t n_input_points;
  aqr_surface base;     /* cleaned */
  double area;          /* of it */
  aqr_surface half;     /* of it, when the output is to be symmetric */
  aqr_surface cut;      /* cut open along creases, when there are any */
  aqr_surface* surface; /* the one in use */
  aqr_chains chains;
  aqr_chain_cost chain_cost; /* with all creases that were found */
  aqr_tensors tensors;
  aqr_field field;
  uint64_t field_revision; /* how often it was computed */
  aqr_sizing sizing;
  aqr_lines lines;
  aqr_polygon_mesh polygons;
  aqr_mesh mesh;
  aqr_field_view field_view;
  aqr_lines_view lines_view;
  bool has_result;
};

/* Of any finite length above 0: by a power of two, which does not round, it is brought to where squares neither
 * overflow nor vanish. */
static inline vec3 aqr_symmetry_normal(const aqr_options* o)
{
  const double* n = o->symmetry_normal;
  int exponent;
  frexp(fmax(fmax(fabs(n[0]), fabs(n[1])), fabs(n[2])), &exponent);
  return v3_unit(v3(ldexp(n[0], -exponent), ldexp(n[1], -exponent), ldexp(n[2], -exponent)));
}

/* The plane that the options of the last run name, in the input's coordinates. */
static inline aqr_plane aqr_symmetry_plane(const aqr_options* o)
{
  return (aqr_plane){ v3_load(o->symmetry_origin), aqr_symmetry_normal(o) };
}

/* What is remeshed: the cleaned input, or half of it. */
static inline aqr_surface* aqr_solid(aqr_remesher* r)
{
  return r->half.n_faces ? &r->half : &r->base;
}

/* Points of the output over points that lines give. */
static inline double aqr_points_per_crossing(const aqr_options* o)
{
  return (o->pure_quads ? AQR_QUADS_PER_FACE : 1) * (o->symmetry ? 2 : 1);
}

/* Points that lines are to give, where a number is asked for. */
static inline double aqr_line_points(const aqr_options* o)
{
  return (double)o->target_points / aqr_points_per_crossing(o);
}

static inline double aqr_cosine(double degrees)
{
  return cos(radians(degrees));
}

static inline bool aqr_differ(double a, double b)
{
  return a < b || a > b;
}

/* Time and memory of a stage (remesher.c): returns when it began, which its end is to be given. */
double aqr_begin_stage(aqr_remesher* r, int stage);
void aqr_end_stage(aqr_remesher* r, int stage, double began);

/* AQR_BAD_OPTION, and a message, where an option is outside its range (options.c). */
aqr_status aqr_check_options(aqr_remesher* r, const aqr_options* o);
/* Points that creases may take (options.c): infinitely many where no number of points is asked for. */
double aqr_crease_budget(const aqr_options* o, const aqr_chain_cost* cost);
/* Of the balls that curvature is averaged over, fraction of the diagonal (options.c). */
double aqr_averaging_radius(const aqr_remesher* r, const aqr_options* o);
/* Of n factors on the density, which may be NULL. */
uint64_t aqr_fingerprint(const double* a, size_t n);
/* The first stage that reads an option which changed since the last run. */
int aqr_first_changed(const aqr_remesher* r, const aqr_options* o, uint64_t density);

/* The stages from the lines to the faces, at the tolerance or for the number of points asked for (density.c). */
aqr_status aqr_run_lines(aqr_remesher* r, const aqr_options* o);

/* Fill and release the views (results.c). */
aqr_status aqr_results_mesh(aqr_remesher* r);
aqr_status aqr_results_field(aqr_remesher* r);
aqr_status aqr_results_lines(aqr_remesher* r);
void aqr_results_free_mesh(aqr_remesher* r);
void aqr_results_free_field(aqr_remesher* r);
void aqr_results_free_lines(aqr_remesher* r);

#endif
