/* SPDX-License-Identifier: BSD-3-Clause */
/* The pipeline: surface -> features -> curvature -> direction field -> sizing -> lines -> network -> faces -> fit. */
#include "chain_places.h"
#include "coarsen.h"
#include "faces.h"
#include "feature_error.h"
#include "fit.h"
#include "network.h"
#include "pipeline.h"
#include "regions.h"
#include "sampling.h"
#include "subdivide.h"

#include <stdio.h>
#include <string.h>

enum
{
  cookie = 0x41515233,
  most_attempts = 9, /* at meeting a target number of points ... */
  fine_attempts = 4, /* ... of which the first ask for better than what counts as met */
  most_retries = 12, /* at a tolerance whose lines lost the topology */
  most_cuts = 24     /* rounds of arcs that keep the topology */
};

static const double farthest_plane = 1e6; /* of symmetry, in diagonals: beyond, mirror images lose their shape */
static const double quads_per_face = 4;   /* of quads cut by their centres and the middles of their edges */

static const double longest_edge = 0.025; /* edges longer than this are halved (paper 3.2): half the default spacing */
static const double corner_angle = 45;    /* a chain turning more sharply has a corner there */
static const double shortest_feature = 0.02;
static const double sharpest = 2; /* over the averaging radius: bends sharper than that it cannot tell from noise */
static const double least_radius = 0.001;
static const double largest_excess = 2.2; /* of points over the prediction: lines are mostly nearer than the spacing */
static const double target_accuracy = 0.028;
static const double retry = 0.97; /* of the tolerance before */
static const double lost_topology =
  10; /* more than any miss: such an attempt serves only where all others lost it too */
static const double missed_accuracy = 0.045; /* of the logarithm: within 5 % */

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

aqr_options aqr_default_options(void)
{
  return (aqr_options){ .cookie = cookie,
    .density = AQR_DENSITY_TOLERANCE,
    .tolerance = 0.0005,
    .target_points = 5000,
    .curvature_radius = 0.01,
    .smoothing_iterations = 5,
    .confidence_angle = 30,
    .feature_lines = 1,
    .feature_angle = 40,
    .boundary_lines = 1,
    .largest_spacing = 0.05,
    .anisotropy = 1,
    .adaptivity = 1,
    .symmetry_normal = { 1, 0, 0 },
    .largest_valence = 5,
    .convex_partition = 1,
    .preserve_topology = 1,
    .show_field = 1,
    .show_lines = 1 };
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

static double begin_stage(aqr_remesher* r, int stage)
{
  aqr_context* c = &r->context;
  c->stage = stage_names[stage];
  c->begin = stage ? stage_ends[stage - 1] : 0;
  c->end = stage_ends[stage];
  c->peak_bytes = c->bytes;
  return aqr_seconds();
}

static void end_stage(aqr_remesher* r, int stage, double began)
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
  double began = begin_stage(r, AQR_STAGE_SURFACE);
  aqr_status status = aqr_surface_build(&r->context, input, longest_edge, &r->base, &r->surface_report);
  r->report = r->surface_report;
  if (status == AQR_OK)
    r->valid = AQR_STAGE_SURFACE;
  end_stage(r, AQR_STAGE_SURFACE, began);
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

/* What is remeshed: the cleaned input, or half of it. */
static aqr_surface* solid(aqr_remesher* r)
{
  return r->half.n_faces ? &r->half : &r->base;
}

static aqr_status run_features(aqr_remesher* r, const aqr_options* o)
{
  aqr_context* c = &r->context;
  aqr_status status = AQR_OK;
  size_t n = 3 * r->base.n_faces;
  uint8_t* crease = AQR_NEW0(c, uint8_t, n);
  AQR_REQUIRE(crease, AQR_OUT_OF_MEMORY);
  if (o->feature_lines)
    AQR_TRY(aqr_features_detect(c, &r->base, o->feature_angle, shortest_feature, crease, &r->report));
  r->surface_report.feature_edges = r->report.feature_edges;
  r->surface_report.asymmetric_points = 0;
  for (size_t h = 0; r->base.locked && h < n; h++)
    crease[h] |= r->base.locked[h] && !aqr_is_boundary(&r->base, (aqr_index)h);
  if (o->symmetry)
    AQR_TRY(cut_half(r, o, &crease, &n));
  bool any = memchr(crease, 1, n) != NULL;
  if (any)
  {
    AQR_TRY(aqr_surface_copy(c, solid(r), &r->cut));
    r->surface = &r->cut;
    AQR_TRY(aqr_surface_cut(c, &r->cut, crease));
  }
  r->surface = any ? &r->cut : solid(r);
  AQR_TRY(aqr_chains_build(c, r->surface, corner_angle, &r->chains));
done:
  AQR_DROP(c, crease, n);
  return status;
}

static double cosine(double degrees)
{
  return cos(degrees * 0.017453292519943295);
}

static size_t count_vertices(const aqr_polygon_mesh* m)
{
  size_t n = 0;
  for (size_t v = 0; v < m->n_vertices; v++)
    n += m->vertices[v].out != AQR_NONE;
  return n;
}

/* Decimates components that carry no lines and adds them to the mesh. */
static aqr_status add_bare_components(aqr_remesher* r, const uint8_t* is_bare)
{
  aqr_context* c = &r->context;
  const aqr_surface* s = r->surface;
  aqr_status status = AQR_OK;
  if (!memchr(is_bare, 1, s->n_faces))
    return AQR_OK;
  uint8_t* seen = AQR_NEW0(c, uint8_t, s->n_faces);
  aqr_index* faces = AQR_NEW(c, aqr_index, s->n_faces);
  AQR_REQUIRE(seen && faces, AQR_OUT_OF_MEMORY);
  for (aqr_index f = 0; f < s->n_faces; f++)
  {
    if (!is_bare[f] || seen[f])
      continue;
    size_t n = 0;
    double points = 0; /* as lines would have: the smallest spacing would make one needle speak for all */
    seen[f] = 1;
    faces[n++] = f;
    for (size_t i = 0; i < n; i++)
    {
      double third = v3_norm(aqr_face_cross(s, faces[i])) / 6;
      for (unsigned k = 0; k < 3; k++)
      {
        const float* d = r->sizing.spacing + 2 * (size_t)s->corner[3 * faces[i] + k];
        points += third / ((double)d[0] * (double)d[1]);
        aqr_index t = aqr_twin(s, 3 * faces[i] + k);
        if (t != AQR_NONE && !seen[aqr_face_of(t)])
        {
          seen[aqr_face_of(t)] = 1;
          faces[n++] = aqr_face_of(t);
        }
      }
    }
    points = fmin((double)n, fmax(8, points));
    AQR_TRY(aqr_coarsen_component(c, s, &r->field, faces, n, (size_t)points, &r->polygons));
    r->report.coarsened_components++;
  }
done:
  AQR_DROP(c, seen, s->n_faces);
  AQR_DROP(c, faces, s->n_faces);
  return status;
}

/* Lines to polygons, with regions that are not disks cut until none is left. */
static aqr_status run_network(aqr_remesher* r, const aqr_options* o, double tolerance)
{
  aqr_context* c = &r->context;
  aqr_network net = { 0 };
  aqr_status status = AQR_OK;
  const double depart = o->pure_quads ? quads_per_face * tolerance : tolerance; /* of chords before they are halved */
  uint8_t* is_bare = AQR_NEW0(c, uint8_t, r->surface->n_faces);
  uint8_t* suspect = AQR_NEW(c, uint8_t, r->surface->n_faces);
  AQR_REQUIRE(is_bare && suspect, AQR_OUT_OF_MEMORY);
  memset(suspect, 1, r->surface->n_faces);
  for (int i = 0; i < most_cuts; i++)
  {
    size_t added = 0;
    aqr_network_free(c, &net);
    AQR_TRY(
      aqr_network_build(c, r->surface, &r->lines, &r->chains, depart, o->boundary_lines ? depart : 8 * depart, &net));
    AQR_TRY(
      aqr_regions_cut(c, r->surface, &r->chains, &net, &r->lines, is_bare, suspect, o->preserve_topology, &added));
    r->report.topology_cuts += added;
    if (!added)
      break;
  }
  AQR_TRY(aqr_network_mesh(c, r->surface, &r->field, &r->sizing, &r->lines, &net, &r->polygons));
  AQR_TRY(add_bare_components(r, is_bare));
done:
  aqr_network_free(c, &net);
  AQR_DROP(c, is_bare, r->surface->n_faces);
  AQR_DROP(c, suspect, r->surface->n_faces);
  return status;
}

/* Whether the output has the Euler number of the cleaned input: rounds of arcs end after a number of them, whether or
 * not every region between the lines is a disk by then, and with few points the border of a half can leave the plane.
 */
static bool keeps_topology(aqr_remesher* r)
{
  const aqr_polygon_mesh* m = &r->polygons;
  const aqr_surface* s = solid(r);
  long long chi = 0, wanted = (long long)s->n_points + (long long)s->n_faces;
  for (size_t h = 0; h < m->n_half_edges; h += 2)
    chi -= m->half_edges[h].from != AQR_NONE;
  for (size_t f = 0; f < m->n_faces; f++)
    chi += m->faces[f] != AQR_NONE;
  chi += (long long)count_vertices(m);
  for (aqr_index h = 0; h < 3 * s->n_faces; h++)
    wanted -= s->twin[h] == AQR_NONE || h < s->twin[h];
  if (s->mirrored)
  {
    long long joint = aqr_symmetry_joint(r->surface, m), joint_wanted = aqr_symmetry_joint_of_surface(s);
    if (joint != joint_wanted || aqr_symmetry_loops(r->surface, m) != s->mirrored_loops)
      return false;
  }
  return chi == wanted;
}

/* Of the whole output: the half's vertices twice, those on the plane once. */
static size_t count_output(const aqr_remesher* r)
{
  size_t n = count_vertices(&r->polygons), once = 0;
  if (!r->surface->mirrored)
    return n;
  for (aqr_index v = 0; v < r->polygons.n_vertices; v++)
    once += r->polygons.vertices[v].out != AQR_NONE && aqr_symmetry_on_plane(r->surface, &r->polygons, v);
  return 2 * n - once;
}

/* Lines, network and faces for one tolerance; a smaller one where that gives fewer than `points`. */
static aqr_status attempt(aqr_remesher* r, const aqr_options* o, double tolerance, double points, aqr_reached* reached)
{
  aqr_context* c = &r->context;
  aqr_status status = AQR_OK;
  aqr_polygon_mesh_free(c, &r->polygons);
  aqr_lines_free(c, &r->lines);
  r->report.topology_cuts = r->report.coarsened_components = 0;
  double began = begin_stage(r, AQR_STAGE_LINES);
  aqr_sampling_options sampling = { cosine(o->confidence_angle), tolerance, points, o->boundary_lines != 0, o->seed };
  status =
    aqr_sample_lines(c, r->surface, &r->field, &r->sizing, &r->chains, &sampling, &r->lines, reached, &r->report);
  tolerance /= reached->finer * reached->finer;
  r->report.tolerance = tolerance;
  end_stage(r, AQR_STAGE_LINES, began);
  if (status != AQR_OK)
    return status;
  began = begin_stage(r, AQR_STAGE_NETWORK);
  status = run_network(r, o, tolerance);
  end_stage(r, AQR_STAGE_NETWORK, began);
  if (status != AQR_OK)
    return status;
  began = begin_stage(r, AQR_STAGE_FACES);
  aqr_faces_options faces = { o->convex_partition != 0, o->largest_valence };
  status = aqr_faces_finish(c, &r->polygons, &faces);
  if (status == AQR_OK && o->pure_quads)
    status = aqr_subdivide(c, r->surface, &r->polygons);
  if (status == AQR_OK && r->surface->mirrored) /* which vertices are on the plane is asked for from here on */
    status = aqr_place_on_chains(c, r->surface, &r->polygons);
  end_stage(r, AQR_STAGE_FACES, began);
  return status;
}

static bool differ(double a, double b)
{
  return a < b || a > b;
}

/* One attempt's outcome, held while another is made. */
typedef struct outcome
{
  aqr_lines lines;
  aqr_polygon_mesh polygons;
  aqr_report report;
  double error; /* of the logarithm of the number of points */
} outcome;

static void forget_outcome(aqr_context* c, outcome* kept)
{
  aqr_lines_free(c, &kept->lines);
  aqr_polygon_mesh_free(c, &kept->polygons);
  kept->error = INFINITY;
}

/* Exchanges the outcome kept and the remesher's, which is the newer. */
static void exchange(aqr_remesher* r, outcome* kept, double error)
{
  outcome now = { r->lines, r->polygons, r->report, error };
  r->lines = kept->lines;
  r->polygons = kept->polygons;
  r->report = kept->report;
  r->report.proximity_queries = now.report.proximity_queries; /* of all attempts so far */
  r->report.faces_crossed = now.report.faces_crossed;
  *kept = now;
}

/* What one attempt at a target asked of the sizing and what came of it. */
typedef struct trial
{
  double ask;
  aqr_reached reached;
} trial;

/* The points to ask of the sizing after `n` trials so that lines for `points` come of it: what was expected of the last
 * one's lines, corrected by what came of them, and below all that was found too many, since the spacing only shrinks.
 */
static double ask_again(const trial* trials, int n, double points)
{
  const trial* last = &trials[n - 1];
  double excess = points / fmax(1, last->reached.points), ask = last->ask;
  if (log(excess) > target_accuracy) /* too much to be made up for by shrinking */
    ask *= excess;
  else /* begins below the points wanted, however little it then shrinks */
    ask *= fmin(1, 0.9 * excess * last->reached.finer * last->reached.finer);
  for (int i = 0; i < n; i++)
    if (trials[i].reached.points > points)
      ask = fmin(ask, 0.9 * trials[i].ask * trials[i].reached.finer * trials[i].reached.finer);
  return ask;
}

/* Attempts that gave too few points and too many: those expected of the lines and those of the output. */
typedef struct bracket
{
  double few, made_of_few, many, made_of_many;
} bracket;

/* The points to want of the next attempt's lines, after lines for `reached` gave an output of `made`. */
static double want_next(bracket* b, double goal, double reached, double made)
{
  if (made < goal && reached > b->few)
  {
    b->few = reached;
    b->made_of_few = made;
  }
  if (made >= goal && reached < b->many)
  {
    b->many = reached;
    b->made_of_many = made;
  }
  /* cuts for the topology add points whatever the lines; vertices that merge are a share of them */
  double next = made > reached ? fmax(1, goal - (made - reached)) : goal * reached / made;
  bool is_bracket = b->few > 0 && b->few < b->many && isfinite(b->many);
  if (!is_bracket)
    return next;
  return b->few + (b->many - b->few) * (goal - b->made_of_few) / (b->made_of_many - b->made_of_few);
}

/* Searches the tolerance that gives the target. The spacing first taken is one whose lines are seldom too many, and
 * shrinks as lines come. The best attempt is kept. */
static aqr_status meet_target(aqr_remesher* r, const aqr_options* o)
{
  aqr_context* c = &r->context;
  aqr_status status = AQR_OK;
  /* points of the output over points that lines give */
  const double per = (o->pure_quads ? quads_per_face : 1) * (o->symmetry ? 2 : 1),
               goal = (double)o->target_points / per;
  double ask = goal / largest_excess, points = goal, before[3] = { 0, 0, 0 };
  double last_made = INFINITY;
  trial trials[most_attempts];
  bracket between = { 0, 0, INFINITY, INFINITY };
  outcome best = { .report = r->report, .error = INFINITY };
  for (int i = 0; i < most_attempts; i++)
  {
    double start;
    aqr_reached reached;
    AQR_TRY(aqr_sizing_solve(c, r->surface, ask, &r->sizing, &start));
    if (i > 0 && !differ(start, before[0]) && !differ(r->sizing.stretch, before[1]) && !differ(points, before[2]))
      break; /* as many or as few as the input can carry */
    before[0] = start;
    before[1] = r->sizing.stretch;
    before[2] = points;
    AQR_TRY(attempt(r, o, start, points, &reached));
    double made = fmax(1, (double)count_output(r)) / per, error = fabs(log(made / goal));
    if (o->preserve_topology && !keeps_topology(r))
      error += lost_topology;
    if (error < best.error)
    {
      forget_outcome(c, &best);
      exchange(r, &best, error);
    }
    if (error < (i < fine_attempts ? target_accuracy : missed_accuracy))
      break;
    if (points <= 1 && made > 0.98 * last_made)
      break; /* no fewer come where fewest are asked for: chains alone give more */
    last_made = made;
    points = want_next(&between, goal, reached.points, made);
    trials[i] = (trial){ ask, reached };
    ask = ask_again(trials, i + 1, points);
  }
  best.report.target_missed = best.error > missed_accuracy;
  exchange(r, &best, 0);
done:
  forget_outcome(c, &best);
  return status;
}

/* ---- options and reuse ---- */

static aqr_status check(aqr_remesher* r, const char* name, double value, double low, double high)
{
  if (value >= low && value <= high)
    return AQR_OK;
  snprintf(r->context.message, sizeof r->context.message, "%s is %g, outside [%g, %g]", name, value, low, high);
  return AQR_BAD_OPTION;
}

static aqr_status check_options(aqr_remesher* r, const aqr_options* o)
{
  const struct
  {
    const char* name;
    double value, low, high;
  } ranges[] = {
    { "cookie (use aqr_default_options)", o->cookie, cookie, cookie },
    { "density", (double)o->density, AQR_DENSITY_TOLERANCE, AQR_DENSITY_POINTS },
    { "tolerance", o->tolerance, 1e-7, 0.1 },
    { "target_points", (double)o->target_points, 4, 2147483647.0 },
    { "curvature_radius", o->curvature_radius, 0, 0.2 },
    { "smoothing_iterations", o->smoothing_iterations, 0, 1000 },
    { "confidence_angle", o->confidence_angle, 0, 90 },
    { "feature_angle", o->feature_angle, 1e-6, 180 },
    { "largest_spacing", o->largest_spacing, 1e-4, 1 },
    { "anisotropy", o->anisotropy, 0, 1 },
    { "adaptivity", o->adaptivity, 0, 1 },
    { "largest_valence", o->largest_valence, 4, 64 },
  };
  for (size_t i = 0; i < sizeof ranges / sizeof *ranges; i++)
  {
    aqr_status status = check(r, ranges[i].name, ranges[i].value, ranges[i].low, ranges[i].high);
    if (status != AQR_OK)
      return status;
  }
  const double *at = o->symmetry_origin, *up = o->symmetry_normal;
  bool good = fmax(fmax(fabs(up[0]), fabs(up[1])), fabs(up[2])) > 0;
  for (unsigned k = 0; k < 3; k++)
    good &= isfinite(at[k]) && isfinite(up[k]);
  if (o->symmetry && !good)
  {
    snprintf(r->context.message, sizeof r->context.message, "%s",
      "symmetry_origin and symmetry_normal must be finite, and the normal no zero vector");
    return AQR_BAD_OPTION;
  }
  for (size_t i = 0; o->density_scale && i < r->n_input_points; i++)
    if (!(o->density_scale[i] > 0) || !isfinite(o->density_scale[i]))
    {
      snprintf(r->context.message, sizeof r->context.message, "density_scale[%zu] is %g, not a finite factor above 0",
        i, o->density_scale[i]);
      return AQR_BAD_OPTION;
    }
  return AQR_OK;
}

static uint64_t fingerprint(const double* a, size_t n)
{
  uint64_t h = 0xcbf29ce484222325u;
  for (size_t i = 0; a && i < n; i++)
  {
    uint64_t bits;
    memcpy(&bits, &a[i], sizeof bits);
    h = (h ^ bits) * 0x100000001b3u;
  }
  return a ? h : 0;
}

/* The first stage that reads an option which changed. */
static int first_changed(const aqr_remesher* r, const aqr_options* o, uint64_t density)
{
  const aqr_options* d = &r->done;
  bool moved = false;
  for (unsigned k = 0; k < 3; k++)
    moved |=
      differ(o->symmetry_origin[k], d->symmetry_origin[k]) || differ(o->symmetry_normal[k], d->symmetry_normal[k]);
  if (o->feature_lines != d->feature_lines || differ(o->feature_angle, d->feature_angle) ||
      !o->symmetry != !d->symmetry || (o->symmetry && moved))
    return AQR_STAGE_FEATURES;
  if (differ(o->curvature_radius, d->curvature_radius))
    return AQR_STAGE_CURVATURE;
  if (o->smoothing_iterations != d->smoothing_iterations || differ(o->confidence_angle, d->confidence_angle))
    return AQR_STAGE_FIELD;
  if (density != r->done_density || differ(o->largest_spacing, d->largest_spacing) ||
      differ(o->anisotropy, d->anisotropy) || differ(o->adaptivity, d->adaptivity) || !o->pure_quads != !d->pure_quads)
    return AQR_STAGE_SIZING;
  return AQR_STAGE_LINES;
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
  double began = begin_stage(r, stage);
  aqr_status status = run(r, o);
  end_stage(r, stage, began);
  if (status == AQR_OK)
    r->valid = stage;
  return status;
}

static aqr_status run_curvature(aqr_remesher* r, const aqr_options* o)
{
  aqr_status status = aqr_curvature_tensors(&r->context, r->surface, o->curvature_radius, &r->tensors);
  if (status == AQR_OK && r->surface->mirrored)
  {
    const aqr_plane plane = aqr_symmetry_plane(o);
    aqr_symmetry_complete(r->surface, &plane, r->tensors.t, r->tensors.normal);
  }
  return status;
}

static aqr_status run_field(aqr_remesher* r, const aqr_options* o)
{
  return aqr_direction_field(
    &r->context, r->surface, &r->tensors, o->smoothing_iterations, cosine(o->confidence_angle), &r->field);
}

static aqr_status run_sizing(aqr_remesher* r, const aqr_options* o)
{
  const aqr_sizing_options sizing = { .density = o->density_scale,
    .largest_spacing = o->largest_spacing,
    .largest_bend = sharpest / fmax(o->curvature_radius, least_radius),
    .anisotropy = o->anisotropy,
    .adaptivity = o->adaptivity,
    .coarser = o->pure_quads ? sqrt(quads_per_face) : 1 };
  return aqr_sizing_build(&r->context, r->surface, &r->field, &sizing, &r->sizing);
}

static aqr_status meet_tolerance(aqr_remesher* r, const aqr_options* o)
{
  aqr_reached reached;
  double tolerance = o->tolerance;
  aqr_status status = aqr_sizing_set(&r->context, r->surface, o->tolerance, &r->sizing);
  if (status == AQR_OK)
    status = attempt(r, o, o->tolerance, 0, &reached);
  r->report.bounded_points = aqr_sizing_bounded(&r->sizing);
  for (int i = 1; status == AQR_OK && i < most_retries && o->preserve_topology && !keeps_topology(r); i++)
  {
    tolerance *= retry;
    status = aqr_sizing_set(&r->context, r->surface, tolerance, &r->sizing);
    if (status == AQR_OK)
      status = attempt(r, o, tolerance, 0, &reached);
  }
  return status;
}

static aqr_status run_lines(aqr_remesher* r, const aqr_options* o)
{
  aqr_status status = o->density == AQR_DENSITY_POINTS ? meet_target(r, o) : meet_tolerance(r, o);
  if (status == AQR_OK)
    r->report.topology_lost = o->preserve_topology && !keeps_topology(r);
  return status;
}

/* The lines are as large as all else together and nothing after them reads them: their view takes their place. */
static aqr_status show_lines(aqr_remesher* r, const aqr_options* o)
{
  double began = aqr_seconds();
  r->context.peak_bytes = r->context.bytes;
  aqr_status status = o->show_lines ? aqr_results_lines(r) : AQR_OK;
  aqr_lines_free(&r->context, &r->lines);
  end_stage(r, AQR_STAGE_RESULT, began);
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
  AQR_TRY(run_lines(r, o));
  AQR_TRY(show_lines(r, o));
  double began = begin_stage(r, AQR_STAGE_FIT);
  if (r->surface->mirrored)
    AQR_TRY(aqr_symmetry_open(&r->context, r->surface, &r->polygons));
  AQR_TRY(aqr_fit(&r->context, r->surface, r->field.normal, &r->polygons));
  end_stage(r, AQR_STAGE_FIT, began);
  began = begin_stage(r, AQR_STAGE_RESULT);
  AQR_TRY(run_results(r, o));
  end_stage(r, AQR_STAGE_RESULT, began);
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
  aqr_status status = check_options(r, options);
  if (status != AQR_OK)
    return status;
  uint64_t density = fingerprint(options->density_scale, r->n_input_points);
  int first = r->valid > AQR_STAGE_SURFACE ? first_changed(r, options, density) : AQR_STAGE_FEATURES;
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
