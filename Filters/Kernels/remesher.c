/* SPDX-License-Identifier: BSD-3-Clause */
/* The pipeline: surface -> features -> curvature -> direction field -> sizing -> lines -> network -> faces -> fit. */
#include "chain_places.h"
#include "creases.h"
#include "feature_error.h"
#include "fit.h"
#include "pipeline.h"

#include <stdio.h>
#include <string.h>

static const double farthest_plane = 1e6; /* of symmetry, in diagonals: beyond, mirror images lose their shape */

static const double longest_edge = 0.025; /* edges longer than this are halved (paper 3.2): half the default spacing */
static const double corner_angle = 45;    /* a chain turning more sharply has a corner there */
static const double shortest_feature = 0.02;
enum
{
  most_economies = 12 /* each halves what creases take too much */
};
static const double sharpest = 2; /* over the averaging radius: bends sharper than that it cannot tell from noise */
static const double least_radius = 0.001;

static const char* const stage_names[AQR_STAGES] = { "surface", "features", "curvature", "direction field", "spacing",
  "lines", "network", "faces", "fit", "results" };
/* where each stage ends in the overall progress */
static const double stage_ends[AQR_STAGES] = { 0.05, 0.08, 0.3, 0.4, 0.42, 0.75, 0.85, 0.92, 0.98, 1 };

const char* aqr_status_string(aqr_status status)
{
  switch (status)
  {
    case AQR_OK:
      return "no failure";
    case AQR_CANCELLED:
      return "cancelled by the caller";
    case AQR_OUT_OF_MEMORY:
      return "out of memory";
    case AQR_EMPTY_INPUT:
      return "the input has no points or no triangles";
    case AQR_NON_FINITE_POINT:
      return "a point of the input is not finite";
    case AQR_INDEX_OUT_OF_RANGE:
      return "a triangle or a locked edge of the input names a point that does not exist";
    case AQR_DEGENERATE_INPUT:
      return "the input has no triangle of positive area";
    case AQR_TOO_LARGE:
      return "the input is too large for the index type";
    case AQR_BAD_OPTION:
      return "an option is outside its range";
    case AQR_NO_INPUT:
      return "no input was set";
    case AQR_INTERNAL:
      return "an internal invariant did not hold";
  }
  return "unknown status";
}

aqr_status aqr_remesher_new(const aqr_hooks* hooks, aqr_remesher** remesher)
{
  aqr_context c = { 0 };
  if (hooks)
    c.hooks = *hooks;
  *remesher = AQR_NEW0(&c, aqr_remesher, 1);
  if (!*remesher)
    return AQR_OUT_OF_MEMORY;
  (*remesher)->context = c;
  (*remesher)->valid = -1;
  return AQR_OK;
}

/* Drops what stages from `first` on hold. */
static void drop_from(aqr_remesher* r, int first)
{
  aqr_context* c = &r->context;
  r->has_result = false;
  if (r->valid >= first)
    r->valid = first - 1;
  aqr_results_free_mesh(r);
  aqr_results_free_lines(r);
  if (first <= AQR_STAGE_FIELD)
    aqr_results_free_field(r);
  if (first <= AQR_STAGE_FACES)
    aqr_polygon_mesh_free(c, &r->polygons);
  if (first <= AQR_STAGE_LINES)
    aqr_lines_free(c, &r->lines);
  if (first <= AQR_STAGE_SIZING)
    aqr_sizing_free(c, &r->sizing);
  if (first <= AQR_STAGE_FIELD && r->surface)
    aqr_field_free(c, r->surface, &r->field);
  if (first <= AQR_STAGE_CURVATURE && r->surface)
    aqr_tensors_free(c, r->surface, &r->tensors);
  if (first <= AQR_STAGE_FEATURES)
  {
    aqr_chains_free(c, &r->chains);
    if (r->surface == &r->cut)
      aqr_surface_free(c, &r->cut);
    aqr_surface_free(c, &r->half);
    r->surface = NULL;
  }
  if (first <= AQR_STAGE_SURFACE)
  {
    aqr_surface_free(c, &r->base);
    memset(&r->surface_report, 0, sizeof r->surface_report);
  }
}

void aqr_remesher_free(aqr_remesher* remesher)
{
  if (!remesher)
    return;
  drop_from(remesher, AQR_STAGE_SURFACE);
  aqr_context c = remesher->context;
  AQR_DROP(&c, remesher, 1);
}

void aqr_remesher_set_hooks(aqr_remesher* remesher, const aqr_hooks* hooks)
{
  aqr_hooks h = { 0 };
  if (hooks)
    h = *hooks;
  /* what was allocated by one allocator must be released by it, with the user data it was given */
  if (remesher->context.hooks.reallocate)
  {
    h.reallocate = remesher->context.hooks.reallocate;
    h.user = remesher->context.hooks.user;
  }
  else
    h.reallocate = NULL;
  remesher->context.hooks = h;
}

/* ---- stages ---- */

double aqr_begin_stage(aqr_remesher* r, int stage)
{
  aqr_context* c = &r->context;
  c->stage = stage_names[stage];
  c->begin = stage ? stage_ends[stage - 1] : 0;
  c->end = stage_ends[stage];
  c->peak_bytes = c->bytes;
  return aqr_seconds();
}

void aqr_end_stage(aqr_remesher* r, int stage, double began)
{
  aqr_stage* s = &r->stages[stage];
  s->seconds += aqr_seconds() - began;
  s->end_bytes = r->context.bytes;
  if (r->context.peak_bytes > s->peak_bytes)
    s->peak_bytes = r->context.peak_bytes;
}

static void forget_stages(aqr_remesher* r, int first)
{
  for (int i = first; i < AQR_STAGES; i++)
    r->stages[i] = (aqr_stage){ .name = stage_names[i] };
}

aqr_status aqr_remesher_set_input(aqr_remesher* r, const aqr_input* input)
{
  drop_from(r, AQR_STAGE_SURFACE);
  forget_stages(r, 0);
  r->context.last = 0;
  r->context.message[0] = '\0';
  r->n_input_points = input->number_of_points;
  double began = aqr_begin_stage(r, AQR_STAGE_SURFACE);
  aqr_status status = aqr_surface_build(&r->context, input, longest_edge, &r->base, &r->surface_report);
  r->report = r->surface_report;
  if (status == AQR_OK)
  {
    r->area = aqr_surface_area(&r->base);
    r->valid = AQR_STAGE_SURFACE;
  }
  aqr_end_stage(r, AQR_STAGE_SURFACE, began);
  return status;
}

/* The half that decides, with its creases in the place of the whole's. */
static aqr_status cut_half(aqr_remesher* r, const aqr_options* o, uint8_t** crease, size_t* n)
{
  aqr_context* c = &r->context;
  const double scale = 1 / r->base.diagonal;
  aqr_plane plane = aqr_symmetry_plane(o);
  uint8_t* kept = NULL;
  plane.origin = v3_scale(v3_sub(plane.origin, r->base.centre), scale);
  if (!(v3_norm(plane.origin) <= farthest_plane))
  {
    snprintf(c->message, sizeof c->message, "symmetry_origin lies more than %g diagonals of the surface from it",
      farthest_plane);
    return AQR_BAD_OPTION;
  }
  aqr_status status = aqr_symmetry_unmatched(c, &r->base, &plane, &r->report.asymmetric_points);
  r->surface_report.asymmetric_points = r->report.asymmetric_points;
  if (status == AQR_OK)
    status = aqr_symmetry_cut(c, &r->base, &plane, *crease, &r->half, &kept);
  if (status == AQR_BAD_OPTION)
    snprintf(c->message, sizeof c->message, "nothing lies on the positive side of the plane of symmetry");
  if (status != AQR_OK)
    return status;
  AQR_DROP(c, *crease, *n);
  *crease = kept;
  *n = 3 * r->half.n_faces;
  return AQR_OK;
}

/* Cuts what is to be remeshed open along its creases, and collects them. */
static aqr_status cut_open(aqr_remesher* r, const uint8_t* crease, size_t n)
{
  aqr_context* c = &r->context;
  aqr_status status = AQR_OK;
  bool any = false;
  for (size_t h = 0; h < n && !any; h++)
    any = crease[h];
  aqr_chains_free(c, &r->chains);
  aqr_surface_free(c, &r->cut);
  r->surface = aqr_solid(r);
  if (any)
  {
    AQR_TRY(aqr_surface_copy(c, aqr_solid(r), &r->cut));
    r->surface = &r->cut;
    AQR_TRY(aqr_surface_cut(c, &r->cut, crease));
  }
  AQR_TRY(aqr_chains_build(c, r->surface, corner_angle, &r->chains));
done:
  return status;
}

/* Gives up creases until the target can pay for those that are left. */
static aqr_status afford_creases(aqr_remesher* r, const aqr_options* o, uint8_t* crease, size_t n)
{
  aqr_context* c = &r->context;
  aqr_status status = aqr_chains_measure(c, r->surface, &r->chains, &r->chain_cost);
  if (status == AQR_OK && aqr_crease_budget(o, &r->chain_cost) < INFINITY)
    r->chain_cost.bend = aqr_crease_bend(r->surface, &r->chains);
  const double budget = aqr_crease_budget(o, &r->chain_cost);
  aqr_chain_cost left = r->chain_cost;
  size_t given_up = 1;
  for (int i = 0; status == AQR_OK && i < most_economies && left.creases > budget && given_up; i++)
  {
    AQR_TRY(aqr_creases_give_up(c, &r->cut, &r->chains, budget, crease, &given_up));
    aqr_chains_free(c, &r->chains);
    AQR_TRY(aqr_chains_build(c, &r->cut, corner_angle, &r->chains));
    AQR_TRY(aqr_chains_measure(c, &r->cut, &r->chains, &left));
    r->report.given_up_edges += given_up;
  }
  if (r->report.given_up_edges)
    AQR_TRY(cut_open(r, crease, n));
done:
  return status;
}

static aqr_status run_features(aqr_remesher* r, const aqr_options* o)
{
  aqr_context* c = &r->context;
  aqr_status status = AQR_OK;
  size_t n = 3 * r->base.n_faces;
  uint8_t* crease = AQR_NEW0(c, uint8_t, n);
  AQR_REQUIRE(crease, AQR_OUT_OF_MEMORY);
  r->report.feature_edges = r->report.asymmetric_points = 0;
  if (o->feature_lines)
    AQR_TRY(aqr_features_detect(c, &r->base, o->feature_angle, shortest_feature, crease, &r->report));
  r->surface_report.feature_edges = r->report.feature_edges;
  r->surface_report.asymmetric_points = 0;
  for (size_t h = 0; r->base.locked && h < n; h++)
    if (r->base.locked[h] && !aqr_is_boundary(&r->base, (aqr_index)h))
      crease[h] = AQR_CREASE_LOCKED;
  if (o->symmetry)
    AQR_TRY(cut_half(r, o, &crease, &n));
  AQR_TRY(cut_open(r, crease, n));
  r->report.given_up_edges = 0;
  AQR_TRY(afford_creases(r, o, crease, n));
  r->surface_report.given_up_edges = r->report.given_up_edges;
done:
  AQR_DROP(c, crease, n);
  return status;
}

/* Runs one stage that leaves a cached result, unless its result is still there. */
static aqr_status run_cached(
  aqr_remesher* r, int stage, const aqr_options* o, aqr_status (*run)(aqr_remesher*, const aqr_options*))
{
  if (r->valid >= stage)
  {
    r->stages[stage].reused = 1;
    r->stages[stage].seconds = 0;
    return AQR_OK;
  }
  double began = aqr_begin_stage(r, stage);
  aqr_status status = run(r, o);
  aqr_end_stage(r, stage, began);
  if (status == AQR_OK)
    r->valid = stage;
  return status;
}

static aqr_status run_curvature(aqr_remesher* r, const aqr_options* o)
{
  aqr_status status = aqr_curvature_tensors(&r->context, r->surface, aqr_averaging_radius(r, o), &r->tensors);
  if (status == AQR_OK && r->surface->mirrored)
  {
    const aqr_plane plane = aqr_symmetry_plane(o);
    aqr_symmetry_complete(r->surface, &plane, r->tensors.t, r->tensors.normal);
  }
  return status;
}

static aqr_status run_field(aqr_remesher* r, const aqr_options* o)
{
  r->field_revision++;
  return aqr_direction_field(
    &r->context, r->surface, &r->tensors, o->smoothing_iterations, aqr_cosine(o->confidence_angle), &r->field);
}

static aqr_status run_sizing(aqr_remesher* r, const aqr_options* o)
{
  const aqr_sizing_options sizing = { .density = o->density_scale,
    .largest_spacing = o->largest_spacing,
    .largest_bend = sharpest / fmax(aqr_averaging_radius(r, o), least_radius),
    .anisotropy = o->anisotropy,
    .adaptivity = o->adaptivity,
    .coarser = o->pure_quads ? sqrt(AQR_QUADS_PER_FACE) : 1 };
  return aqr_sizing_build(&r->context, r->surface, &r->field, &sizing, &r->sizing);
}

/* The lines are as large as all else together and nothing after them reads them: their view takes their place. */
static aqr_status show_lines(aqr_remesher* r, const aqr_options* o)
{
  double began = aqr_seconds();
  r->context.peak_bytes = r->context.bytes;
  aqr_status status = o->show_lines ? aqr_results_lines(r) : AQR_OK;
  aqr_lines_free(&r->context, &r->lines);
  aqr_end_stage(r, AQR_STAGE_RESULT, began);
  return status;
}

static aqr_status run_results(aqr_remesher* r, const aqr_options* o)
{
  aqr_distance features, boundary;
  aqr_status status = aqr_feature_error(&r->context, r->surface, &r->chains, &r->polygons, &features, &boundary);
  r->report.feature_rms = features.rms;
  r->report.feature_max = features.largest;
  r->report.boundary_rms = boundary.rms;
  r->report.boundary_max = boundary.largest;
  if (status == AQR_OK)
    status = aqr_results_mesh(r);
  aqr_polygon_mesh_free(&r->context, &r->polygons);
  if (!o->show_field)
    aqr_results_free_field(r);
  else if (status == AQR_OK && !r->field_view.points)
    status = aqr_results_field(r);
  return status;
}

static aqr_status run_stages(aqr_remesher* r, const aqr_options* o)
{
  aqr_status status = AQR_OK;
  AQR_TRY(run_cached(r, AQR_STAGE_FEATURES, o, run_features));
  AQR_TRY(run_cached(r, AQR_STAGE_CURVATURE, o, run_curvature));
  AQR_TRY(run_cached(r, AQR_STAGE_FIELD, o, run_field));
  AQR_TRY(run_cached(r, AQR_STAGE_SIZING, o, run_sizing));
  AQR_TRY(aqr_run_lines(r, o));
  AQR_TRY(show_lines(r, o));
  double began = aqr_begin_stage(r, AQR_STAGE_FIT);
  if (r->surface->mirrored)
    AQR_TRY(aqr_symmetry_open(&r->context, r->surface, &r->polygons));
  AQR_TRY(aqr_fit(&r->context, r->surface, r->field.normal, &r->polygons));
  aqr_end_stage(r, AQR_STAGE_FIT, began);
  began = aqr_begin_stage(r, AQR_STAGE_RESULT);
  AQR_TRY(run_results(r, o));
  aqr_end_stage(r, AQR_STAGE_RESULT, began);
done:
  return status;
}

aqr_status aqr_remesher_run(aqr_remesher* r, const aqr_options* options)
{
  r->context.message[0] = '\0';
  r->context.last = 0;
  r->has_result = false;
  if (r->valid < AQR_STAGE_SURFACE)
    return AQR_NO_INPUT;
  aqr_status status = aqr_check_options(r, options);
  if (status != AQR_OK)
    return status;
  uint64_t density = aqr_fingerprint(options->density_scale, r->n_input_points);
  int first = r->valid > AQR_STAGE_SURFACE ? aqr_first_changed(r, options, density) : AQR_STAGE_FEATURES;
  drop_from(r, first < r->valid + 1 ? first : r->valid + 1);
  forget_stages(r, AQR_STAGE_FEATURES);
  r->report = r->surface_report;
  r->done = *options;
  r->done.density_scale = NULL;
  r->done_density = density;
  status = run_stages(r, options);
  if (status != AQR_OK)
    drop_from(r, r->valid + 1);
  r->has_result = status == AQR_OK;
  if (r->has_result)
    aqr_step(&r->context, 1);
  return status;
}

/* ---- results ---- */

const aqr_mesh* aqr_remesher_mesh(const aqr_remesher* r)
{
  return r->has_result ? &r->mesh : NULL;
}

const aqr_field_view* aqr_remesher_field(const aqr_remesher* r)
{
  return r->has_result && r->field_view.points ? &r->field_view : NULL;
}

const aqr_lines_view* aqr_remesher_lines(const aqr_remesher* r)
{
  return r->has_result && r->lines_view.offsets ? &r->lines_view : NULL;
}

const aqr_report* aqr_remesher_report(const aqr_remesher* r)
{
  return &r->report;
}

const aqr_stage* aqr_remesher_stages(const aqr_remesher* r, size_t* count)
{
  *count = AQR_STAGES;
  return r->stages;
}

const char* aqr_remesher_message(const aqr_remesher* r)
{
  return r->context.message;
}
