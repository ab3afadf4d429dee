/* SPDX-License-Identifier: BSD-3-Clause */
/* From spacings to faces, again until the density asked for is met and the topology is kept. */
#include "chain_places.h"
#include "coarsen.h"
#include "faces.h"
#include "network.h"
#include "pipeline.h"
#include "regions.h"
#include "sampling.h"

#include <string.h>

enum
{
  most_attempts = 9, /* at meeting a target number of points ... */
  fine_attempts = 8, /* ... of which the first ask for better than what counts as met */
  most_retries = 12, /* at a tolerance whose lines lost the topology */
  most_cuts = 24     /* rounds of arcs that keep the topology */
};

static const double largest_excess = 2.2; /* of points over the prediction: lines are mostly nearer than the spacing */
static const double target_accuracy = 0.028;
static const double retry = 0.97; /* of the tolerance before */
static const double lost_topology =
  10; /* more than any miss: such an attempt serves only where all others lost it too */
static const double missed_accuracy = 0.045; /* of the logarithm: within 5 % */

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
      AQR_REQUIRE(aqr_worked(c, 16), AQR_CANCELLED);
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
static aqr_status run_network(aqr_remesher* r, const aqr_options* o, double tolerance, aqr_tips* tips)
{
  aqr_context* c = &r->context;
  aqr_network net = { 0 };
  aqr_status status = AQR_OK;
  const double depart =
    o->pure_quads ? AQR_QUADS_PER_FACE * tolerance : tolerance; /* of chords before they are halved */
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
  if (o->preserve_topology)
    AQR_TRY(aqr_tips_find(c, r->surface, r->field.normal, &r->lines, &net, &r->polygons, tips));
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
  const aqr_surface* s = aqr_solid(r);
  long long wanted = (long long)s->n_points + (long long)s->n_faces;
  for (aqr_index h = 0; h < 3 * s->n_faces; h++)
    wanted -= s->twin[h] == AQR_NONE || h < s->twin[h];
  if (s->mirrored)
  {
    long long joint = aqr_symmetry_joint(r->surface, m), joint_wanted = aqr_symmetry_joint_of_surface(s);
    if (joint != joint_wanted || aqr_symmetry_loops(r->surface, m) != s->mirrored_loops)
      return false;
  }
  return aqr_pm_euler(m) == wanted;
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
  aqr_tips tips = { 0 };
  aqr_polygon_mesh_free(c, &r->polygons);
  aqr_lines_free(c, &r->lines);
  r->report.topology_cuts = r->report.coarsened_components = 0;
  double began = aqr_begin_stage(r, AQR_STAGE_LINES);
  aqr_sampling_options sampling = { aqr_cosine(o->confidence_angle), tolerance, points, o->boundary_lines != 0,
    o->seed };
  status =
    aqr_sample_lines(c, r->surface, &r->field, &r->sizing, &r->chains, &sampling, &r->lines, reached, &r->report);
  tolerance /= reached->finer * reached->finer;
  r->report.tolerance = tolerance;
  aqr_end_stage(r, AQR_STAGE_LINES, began);
  if (status != AQR_OK)
    return status;
  began = aqr_begin_stage(r, AQR_STAGE_NETWORK);
  status = run_network(r, o, tolerance, &tips);
  aqr_end_stage(r, AQR_STAGE_NETWORK, began);
  if (status != AQR_OK)
    goto done;
  if (!o->show_lines) /* only their view would read them from here on */
    aqr_lines_free(c, &r->lines);
  began = aqr_begin_stage(r, AQR_STAGE_FACES);
  aqr_faces_options faces = { o->convex_partition != 0, o->largest_valence, &tips, r->surface, r->field.normal };
  status = aqr_faces_finish(c, &r->polygons, &faces);
  if (status == AQR_OK && o->pure_quads)
    status = aqr_subdivide(c, r->surface, &r->polygons);
  if (status == AQR_OK && r->surface->mirrored) /* which vertices are on the plane is asked for from here on */
    status = aqr_place_on_chains(c, r->surface, &r->polygons);
  aqr_end_stage(r, AQR_STAGE_FACES, began);
done:
  aqr_tips_free(c, &tips);
  return status;
}

/* ---- as many points as asked for ---- */

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
  const double per = aqr_points_per_crossing(o), goal = aqr_line_points(o);
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
    if (i > 0 && !aqr_differ(start, before[0]) && !aqr_differ(r->sizing.stretch, before[1]) &&
        !aqr_differ(points, before[2]))
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

/* ---- a tolerance ---- */

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

aqr_status aqr_run_lines(aqr_remesher* r, const aqr_options* o)
{
  aqr_status status = o->density == AQR_DENSITY_POINTS ? meet_target(r, o) : meet_tolerance(r, o);
  if (status == AQR_OK)
    r->report.topology_lost = o->preserve_topology && !keeps_topology(r);
  return status;
}
