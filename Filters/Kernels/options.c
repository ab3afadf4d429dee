/* SPDX-License-Identifier: BSD-3-Clause */
/* Options: their defaults, their ranges, and what has to be done anew when they change. */
#include "pipeline.h"

#include <stdio.h>
#include <string.h>

enum
{
  cookie = 0x41515233
};

/* Shares of the points that creases may take: with more the surface between starves. Flat faces have no use for points
 * of their own, so there as many more can be borne; but once that is not enough either, what a share in between keeps
 * is worse than what the small one does (measured). */
static const double crease_share = 0.25, share_between_flat_faces = 0.5;
static const double fewest_on_creases = 12; /* what is left is no surface worth the loss of a block's corners */

/* Balls much wider than the faces hide the curvature that these are to follow, much narrower ones show more than they
 * can follow. In octaves, so that a change of density seldom asks for other curvatures: .7 to 1.4 spacings of the
 * points were the best for 4K to 125K points on two large scans (measured). */
static const double halved_below = 1. / 120;   /* between points, of the diagonal */
static const double points_at_tolerance = 1.7; /* times the tolerance: the mean of seven scans, 1.3 to 3.5 */

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

static aqr_status check(aqr_remesher* r, const char* name, double value, double low, double high)
{
  if (value >= low && value <= high)
    return AQR_OK;
  snprintf(r->context.message, sizeof r->context.message, "%s is %g, outside [%g, %g]", name, value, low, high);
  return AQR_BAD_OPTION;
}

aqr_status aqr_check_options(aqr_remesher* r, const aqr_options* o)
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

uint64_t aqr_fingerprint(const double* a, size_t n)
{
  uint64_t h = 0xcbf29ce484222325u;
  for (size_t i = 0; a && i < n; i++)
  {
    uint64_t bits;
    memcpy(&bits, &a[i], sizeof bits);
    h = (h ^ bits) * 0x9e3779b97f4a7c15u;
    h ^= h >> 29; /* or what differs in the high bits alone never reaches the others */
  }
  return a ? h : 0;
}

double aqr_crease_budget(const aqr_options* o, const aqr_chain_cost* cost)
{
  const double all = aqr_line_points(o), points = fmax(all / 4, all - cost->boundary);
  const double bearable = crease_share + share_between_flat_faces * cost->bend;
  if (o->density != AQR_DENSITY_POINTS || cost->creases <= fmax(fewest_on_creases, bearable * points))
    return INFINITY;
  return fmax(fewest_on_creases, crease_share * points);
}

double aqr_averaging_radius(const aqr_remesher* r, const aqr_options* o)
{
  const double points =
    o->density == AQR_DENSITY_POINTS ? (double)o->target_points : points_at_tolerance / o->tolerance;
  const double spacing = sqrt(r->area / points);
  const double factor = spacing > halved_below ? 1 : spacing > halved_below / 2 ? 0.5 : 0.25;
  return factor * o->curvature_radius;
}

/* Whether creases would be given up, or come back, or others would be. */
static bool other_creases(const aqr_chain_cost* cost, const aqr_options* a, const aqr_options* b)
{
  return aqr_differ(aqr_crease_budget(a, cost), aqr_crease_budget(b, cost));
}

int aqr_first_changed(const aqr_remesher* r, const aqr_options* o, uint64_t density)
{
  const aqr_options* d = &r->done;
  bool moved = false;
  for (unsigned k = 0; k < 3; k++)
    moved |= aqr_differ(o->symmetry_origin[k], d->symmetry_origin[k]) ||
             aqr_differ(o->symmetry_normal[k], d->symmetry_normal[k]);
  if (o->feature_lines != d->feature_lines || aqr_differ(o->feature_angle, d->feature_angle) ||
      !o->symmetry != !d->symmetry || (o->symmetry && moved) || other_creases(&r->chain_cost, o, d))
    return AQR_STAGE_FEATURES;
  if (aqr_differ(aqr_averaging_radius(r, o), aqr_averaging_radius(r, d)))
    return AQR_STAGE_CURVATURE;
  if (o->smoothing_iterations != d->smoothing_iterations || aqr_differ(o->confidence_angle, d->confidence_angle))
    return AQR_STAGE_FIELD;
  if (density != r->done_density || aqr_differ(o->largest_spacing, d->largest_spacing) ||
      aqr_differ(o->anisotropy, d->anisotropy) || aqr_differ(o->adaptivity, d->adaptivity) ||
      !o->pure_quads != !d->pure_quads)
    return AQR_STAGE_SIZING;
  return AQR_STAGE_LINES;
}
