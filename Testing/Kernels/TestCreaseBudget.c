/* SPDX-License-Identifier: BSD-3-Clause */
/* Creases that few points cannot pay for are given up, the least bent first; no others are. */
#include "test.h"

#include "pipeline.h"
#include "remesh.h"

enum
{
  cells = 12,  /* of the egg crate, a side */
  strips = 60, /* of the folded sheet */
  sharp = 5,   /* every fifth of its folds is: by 90 degrees, the others by 45 */
  fine = 4     /* quads across a cell or a strip */
};

static double saw(double x)
{
  return fabs(x - 2 * round(x / 2));
}

/* Creases along both directions that cross at (cells - 1)^2 places. */
static vec3 place_in_egg_crate(double u, double v)
{
  return v3(cells * u, cells * v, saw(cells * u) + saw(cells * v));
}

static shape egg_crate(void)
{
  return shape_grid(cells * fine, cells * fine, false, false, 0, 1, place_in_egg_crate);
}

static vec3 place_on_folds(double u, double v)
{
  const double turn[sharp] = { shape_turn / 8, -shape_turn / 8, 0, -shape_turn / 8, 0 };
  double x = 0, z = 0, left = strips * u;
  for (int i = 0; left > 0; i++, left -= 1)
  {
    x += fmin(left, 1) * cos(turn[i % sharp]);
    z += fmin(left, 1) * sin(turn[i % sharp]);
  }
  return v3(x, strips * v, z);
}

static shape folded_sheet(void)
{
  return shape_grid(strips * fine, strips * fine, false, false, 0, 1, place_on_folds);
}

static bool on_fold(const aqr_mesh* mesh, int64_t point, int fold)
{
  vec3 p = v3_load(mesh->points + 3 * point), q = place_on_folds((double)fold / strips, 0);
  return (p.x - q.x) * (p.x - q.x) + (p.z - q.z) * (p.z - q.z) < 1e-12;
}

/* The part of a fold of the folded sheet that edges of the mesh follow. */
static double followed(const aqr_mesh* mesh, int fold)
{
  double length = 0;
  for (size_t f = 0; f < mesh->number_of_faces; f++)
    for (int64_t k = mesh->offsets[f]; k < mesh->offsets[f + 1]; k++)
    {
      int64_t a = mesh->connectivity[k],
              b = mesh->connectivity[k + 1 < mesh->offsets[f + 1] ? k + 1 : mesh->offsets[f]];
      if (on_fold(mesh, a, fold) && on_fold(mesh, b, fold))
        length += fabs(mesh->points[3 * a + 1] - mesh->points[3 * b + 1]);
    }
  return length / (2 * strips); /* every edge was met from both sides */
}

AQR_TEST(creases_do_not_eat_all_of_few_points)
{
  shape m = egg_crate();
  for (int64_t points = 100; points <= 180; points += 20)
  {
    aqr_options o = options_for_points(points);
    survey s = check_remesh("egg crate", &m, &o);
    CHECK_BELOW(fabs((double)s.points / (double)points - 1), 0.05);
  }
  shape_free(&m);
}

AQR_TEST(what_bends_most_is_kept)
{
  shape m = folded_sheet();
  aqr_options o = options_for_points(118);
  aqr_remesher* r = remesh(&m, &o);
  int lost[2] = { 0, 0 };
  for (int i = 1; i < strips; i++)
    lost[i % sharp == 1] += followed(aqr_remesher_mesh(r), i) < 1 - 1e-6;
  CHECK(lost[1] == 0 && lost[0] > 0);
  CHECK(aqr_remesher_report(r)->given_up_edges > 0);
  aqr_remesher_free(r);
  shape_free(&m);
}

/* Pinions and vented cases of flat faces have no use for points elsewhere. */
AQR_TEST(many_creases_between_flat_faces_are_kept)
{
  aqr_chain_cost cost = { .creases = 120, .boundary = 40, .bend = 1 };
  aqr_options o = options_for_points(240);
  CHECK(aqr_crease_budget(&o, &cost) > 1e300);
  cost.bend = 0.1;
  CHECK_BELOW(fabs(aqr_crease_budget(&o, &cost) - 50), 1e-9);
  shape m = egg_crate();
  aqr_remesher* r = remesh(&m, &o);
  CHECK(aqr_remesher_report(r)->given_up_edges == 0);
  aqr_remesher_free(r);
  shape_free(&m);
}

AQR_TEST(locked_edges_are_not_given_up)
{
  enum
  {
    fold = 30 /* none of the sharp ones */
  };
  shape m = folded_sheet();
  int64_t locked[2 * strips * fine];
  for (int64_t j = 0; j < strips * fine; j++)
    for (int64_t k = 0; k < 2; k++)
      locked[2 * j + k] = fold * fine * (strips * fine + 1) + j + k;
  aqr_input input = shape_input(&m);
  aqr_options o = options_for_points(100);
  for (int lock = 0; lock < 2; lock++)
  {
    input.locked = lock ? locked : NULL;
    input.number_of_locked = lock ? strips * fine : 0;
    aqr_remesher* r = NULL;
    CHECK(aqr_remesher_new(NULL, &r) == AQR_OK);
    CHECK(aqr_remesher_set_input(r, &input) == AQR_OK);
    CHECK(aqr_remesher_run(r, &o) == AQR_OK);
    CHECK((followed(aqr_remesher_mesh(r), fold) > 1 - 1e-6) == lock);
    aqr_remesher_free(r);
  }
  shape_free(&m);
}

AQR_TEST(creases_come_back_with_the_points_to_pay_for_them)
{
  shape m = egg_crate();
  const int64_t asked[] = { 150, 4000, 240, 150 };
  aqr_options o = options_for_points(asked[0]);
  aqr_remesher* again = remesh(&m, &o);
  for (int i = 0; i < 4; i++)
  {
    o.target_points = asked[i];
    CHECK(aqr_remesher_run(again, &o) == AQR_OK);
    aqr_remesher* fresh = remesh(&m, &o);
    CHECK(hash_results(again) == hash_results(fresh));
    CHECK((aqr_remesher_report(again)->given_up_edges > 0) == (asked[i] < 200));
    CHECK(aqr_remesher_report(again)->given_up_edges == aqr_remesher_report(fresh)->given_up_edges);
    CHECK(aqr_remesher_report(again)->feature_edges == 2 * cells * fine * (cells - 1));
    aqr_remesher_free(fresh);
  }
  aqr_remesher_free(again);
  shape_free(&m);
}

/* Where a tolerance is asked for, points are what it takes. */
AQR_TEST(a_tolerance_keeps_all_creases)
{
  shape m = egg_crate();
  aqr_options o = options_for_points(150);
  o.density = AQR_DENSITY_TOLERANCE;
  o.tolerance = 0.05;
  aqr_remesher* r = remesh(&m, &o);
  CHECK(aqr_remesher_report(r)->given_up_edges == 0);
  aqr_remesher_free(r);
  shape_free(&m);
}

AQR_TEST_MAIN
