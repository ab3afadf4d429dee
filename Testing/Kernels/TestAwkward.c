/* SPDX-License-Identifier: BSD-3-Clause */
/* Surfaces that scans, exports and mathematics hold ready, each of which must come out as a valid mesh. */
#include "test.h"

#include "examine.h"
#include "mutate.h"
#include "remesh.h"
#include "solids.h"

static const char* fault_of(const shape* m, const aqr_options* o, aqr_status* status)
{
  aqr_input input = shape_input(m);
  const char* fault = examine(&input, o, status);
  if (fault)
    printf("%s\n", fault);
  return fault;
}

/* A figure of eight swept around, turned by half a turn on the way: the grid's end joins its beginning in reverse. */
static shape shape_klein(size_t nu, size_t nv, unsigned seed)
{
  shape m = { 0 };
  unsigned state = seed;
  m.points = malloc(3 * nu * nv * sizeof *m.points);
  m.triangles = malloc(6 * nu * nv * sizeof *m.triangles);
  for (size_t i = 0; i < nu; i++)
    for (size_t j = 0; j < nv; j++, m.n_points++)
    {
      double a = shape_turn * (double)i / (double)nu, t = shape_turn * (double)j / (double)nv;
      double x = 0.5 * sin(t), y = 0.5 * sin(2 * t), q = 1.5 + x * cos(a / 2) - y * sin(a / 2);
      v3_store(m.points + 3 * m.n_points, v3(q * cos(a), q * sin(a), x * sin(a / 2) + y * cos(a / 2)));
    }
  for (size_t i = 0; i < nu; i++)
    for (size_t j = 0; j < nv; j++)
    {
      bool last = i + 1 == nu;
      size_t k = (j + 1) % nv, d = last ? (nv - j) % nv : (i + 1) * nv + j, c = last ? (nv - k) % nv : (i + 1) * nv + k;
      shape_quad(&m, (size_t[4]){ i * nv + j, d, c, i * nv + k }, &state);
    }
  return m;
}

/* It has no side to be consistently oriented by, and no border to say so. */
AQR_TEST(a_klein_bottle_is_cut_and_meshed)
{
  shape m = shape_klein(60, 24, 3);
  for (int64_t points = 20; points < 1000; points *= 4)
    for (int quads = 0; quads < 2; quads++)
    {
      aqr_options o = options_for_points(points);
      o.pure_quads = quads;
      aqr_status status;
      CHECK(!fault_of(&m, &o, &status) && status == AQR_OK);
      aqr_remesher* r = remesh(&m, &o);
      survey s = survey_mesh(aqr_remesher_mesh(r));
      printf("%s, %zu points, Euler %ld, %zu loops, %zu edges cut\n", s.flaw ? s.flaw : "valid", s.points, s.euler,
        s.loops, aqr_remesher_report(r)->unorientable_edges);
      CHECK(!s.flaw && s.components == 1 && s.loops > 0);
      CHECK(aqr_remesher_report(r)->unorientable_edges > 0);
      aqr_remesher_free(r);
    }
  shape_free(&m);
}

/* Takes out triangles that have no corner in common and none on the border, and so leave borders of three edges.
 * Returns their number. */
static size_t punch(shape* m, size_t step)
{
  uint8_t* used = calloc(m->n_points, 1);
  int64_t* around = calloc(m->n_points, sizeof *around); /* 0 where every neighbour is once before and once after */
  size_t kept = 0, holes = 0;
  for (size_t i = 0; i < 3 * m->n_triangles; i++)
    around[m->triangles[i]] += m->triangles[i - i % 3 + (i + 1) % 3] - m->triangles[i - i % 3 + (i + 2) % 3];
  for (size_t i = 0; i < m->n_points; i++)
    used[i] = around[i] != 0;
  for (size_t f = 0; f < m->n_triangles; f++)
  {
    const int64_t* t = m->triangles + 3 * f;
    if (f % step == 0 && !used[t[0]] && !used[t[1]] && !used[t[2]])
    {
      used[t[0]] = used[t[1]] = used[t[2]] = 1;
      holes++;
      continue;
    }
    memmove(m->triangles + 3 * kept++, t, 3 * sizeof *t);
  }
  m->n_triangles = kept;
  free(used);
  free(around);
  return holes;
}

/* Such a border has fewer edges than a line needs samples, and vanishes easily. */
AQR_TEST(many_borders_of_three_edges_are_all_kept)
{
  shape shapes[] = { shape_sphere(12, 1), shape_torus(6, 2), shape_grid(20, 20, false, false, 0.2, 3, place_on_plane) };
  for (size_t k = 0; k < sizeof shapes / sizeof *shapes; k++)
  {
    size_t border = survey_shape(&shapes[k]).loops, holes = punch(&shapes[k], 7);
    CHECK(holes > 20 && survey_shape(&shapes[k]).loops == border + holes);
    for (int i = 0; i < 6; i++)
    {
      aqr_options o = options_for_points(i % 3 == 0 ? 50 : i % 3 == 1 ? 400 : 1500);
      o.boundary_lines = i < 3;
      o.pure_quads = i == 4;
      check_remesh("three-edge holes", &shapes[k], &o);
    }
    shape_free(&shapes[k]);
  }
}

/* Two sheets a fiftieth of an edge apart: each must be meshed as if it were alone, and no vertex may change over. */
AQR_TEST(sheets_nearer_than_their_edges_do_not_see_each_other)
{
  const double apart[] = { 1, 0.05, 1e-3, 1e-6 };
  double alone = 0;
  for (size_t k = 0; k < sizeof apart / sizeof *apart; k++)
  {
    shape m = shape_grid(20, 20, false, false, 0.3, 4, place_on_plane);
    shape n = shape_grid(19, 21, false, false, 0.3, 5, place_on_plane);
    m.points = realloc(m.points, 3 * (m.n_points + n.n_points) * sizeof *m.points);
    m.triangles = realloc(m.triangles, 3 * (m.n_triangles + n.n_triangles) * sizeof *m.triangles);
    for (size_t i = 0; i < 3 * n.n_points; i++)
      m.points[3 * m.n_points + i] = i % 3 == 2 ? apart[k] : n.points[i];
    for (size_t i = 0; i < n.n_triangles; i++)
      for (size_t c = 0; c < 3; c++) /* facing the other */
        m.triangles[3 * (m.n_triangles + i) + c] = n.triangles[3 * i + 2 - c] + (int64_t)m.n_points;
    m.n_points += n.n_points;
    m.n_triangles += n.n_triangles;
    aqr_options o = aqr_default_options();
    o.largest_spacing = 0.1 * sqrt(2) / sqrt(2 + apart[k] * apart[k]); /* the same length for all */
    survey s = check_remesh("two sheets", &m, &o);
    alone = k ? alone : (double)s.points;
    CHECK_BELOW(fabs((double)s.points / alone - 1), 0.1);
    aqr_remesher* r = remesh(&m, &o);
    const aqr_mesh* out = aqr_remesher_mesh(r);
    for (size_t f = 0; f < out->number_of_faces; f++)
      for (int64_t i = out->offsets[f]; i < out->offsets[f + 1]; i++)
      {
        double z = out->points[3 * out->connectivity[i] + 2],
               first = out->points[3 * out->connectivity[out->offsets[f]] + 2];
        CHECK((fabs(z) < 1e-9 || fabs(z - apart[k]) < 1e-9) && fabs(z - first) < 1e-9);
      }
    aqr_remesher_free(r);
    shape_free(&m);
    shape_free(&n);
  }
}

/* Four points are asked for, fewer than lines can give; the coarsest input has more. */
AQR_TEST(a_target_of_four_leaves_every_sphere_closed)
{
  for (size_t n = 1; n <= 17; n += n < 5 ? 1 : 4)
    for (unsigned seed = 0; seed < 3; seed++)
    {
      shape m = shape_ellipsoid(n, 0.3, seed, v3(1, 1, 1));
      aqr_options o = options_for_points(4);
      o.largest_spacing = seed == 2 ? 1 : o.largest_spacing;
      aqr_status status;
      CHECK(!fault_of(&m, &o, &status) && status == AQR_OK);
      aqr_remesher* r = remesh(&m, &o);
      survey s = survey_mesh(aqr_remesher_mesh(r));
      printf("%zu points: %s, %zu points, Euler %ld\n", m.n_points, s.flaw ? s.flaw : "valid", s.points, s.euler);
      CHECK(!s.flaw && s.euler == 2 && s.loops == 0 && s.components == 1);
      CHECK((s.points == 4) == !aqr_remesher_report(r)->target_missed);
      aqr_remesher_free(r);
      shape_free(&m);
    }
}

/* Lines then run along edges and exactly through vertices all the way. */
AQR_TEST(edges_that_follow_curvature_lines_give_quads)
{
  shape shapes[] = { shape_grid(48, 24, true, false, 0, 1, place_on_cylinder),
    shape_grid(60, 24, true, true, 0, 2, place_on_torus), shape_grid(60, 30, true, false, 0, 3, place_on_catenoid),
    shape_grid(30, 30, false, false, 0, 4, place_on_plane) };
  for (size_t k = 0; k < sizeof shapes / sizeof *shapes; k++)
  {
    for (int64_t points = 100; points <= 1600; points *= 4)
    {
      aqr_options o = options_for_points(points);
      survey s = check_remesh("regular grid", &shapes[k], &o);
      if (points > 100)
        CHECK_BELOW(1 - (double)s.quads / (double)(s.faces + 1), 0.3);
    }
    shape_free(&shapes[k]);
  }
}

/* Faces turned, doubled, put across and added as fins at random, and a plane through or by a point of it. */
AQR_TEST(surfaces_that_are_not_manifold_are_mirrored)
{
  size_t done = 0, split = 0;
  unsigned state = 11;
  for (unsigned i = 0; i < 100; i++)
  {
    const uint8_t kinds[] = { 1, 2, 3, 5, 9, 9, 5, 0 };
    uint8_t code[90];
    for (size_t k = 0; k < sizeof code; k++)
      code[k] = (uint8_t)(256 * shape_random(&state));
    shape m = mutate_base(224 + i % 32);
    size_t most = 3 * (sizeof code / 10);
    m.points = realloc(m.points, 3 * (m.n_points + most) * sizeof *m.points);
    m.triangles = realloc(m.triangles, 3 * (m.n_triangles + 3 * most) * sizeof *m.triangles);
    for (size_t k = 0; k + 10 <= sizeof code; k += 10)
    {
      code[k] = kinds[code[k] % 8];
      bytes b = { code + k, 10 };
      mutate_once(&m, &b);
    }
    aqr_input input = shape_input(&m);
    aqr_options o = options_for_points(20 + 7 * (i % 30));
    o.largest_spacing = 0.3;
    o.preserve_topology = i % 4 != 0;
    o.pure_quads = i % 5 == 0;
    set_plane(&o, &input, (uint32_t)(4294967295.0 * shape_random(&state)));
    aqr_status status;
    const char* fault = examine(&input, &o, &status);
    if (fault)
      printf("%u: %s\n", i, fault);
    CHECK(!fault && (status == AQR_OK || status == AQR_BAD_OPTION));
    done += status == AQR_OK;
    aqr_remesher* r = NULL;
    CHECK(aqr_remesher_new(NULL, &r) == AQR_OK && aqr_remesher_set_input(r, &input) == AQR_OK);
    split += aqr_remesher_report(r)->split_edges + aqr_remesher_report(r)->split_points > 0;
    aqr_remesher_free(r);
    shape_free(&m);
  }
  printf("%zu mirrored, %zu not manifold\n", done, split);
  CHECK(done > 60 && split > 60);
}

AQR_TEST_MAIN
