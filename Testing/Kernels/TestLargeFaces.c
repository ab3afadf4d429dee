/* SPDX-License-Identifier: BSD-3-Clause */
#include "test.h"

#include "shapes.h"

/* A flat sheet of n by n square tiles, each with a hole of `sides` corners, a multiple of four. */
static shape perforated(size_t n, size_t sides, double radius)
{
  shape m = { 0 };
  size_t w = n + 1, quarter = sides / 4;
  m.points = malloc(3 * (w * w + n * n * sides) * sizeof *m.points);
  m.triangles = malloc(3 * n * n * (sides + 4) * sizeof *m.triangles);
  for (size_t y = 0; y < w; y++)
    for (size_t x = 0; x < w; x++)
      v3_store(m.points + 3 * m.n_points++, v3((double)x, (double)y, 0));
  for (size_t tile = 0; tile < n * n; tile++)
  {
    size_t x = tile % n, y = tile / n, first = m.n_points;
    const size_t corner[4] = { (y + 1) * w + x + 1, (y + 1) * w + x, y * w + x, y * w + x + 1 };
    for (size_t i = 0; i < sides; i++)
    {
      double a = shape_turn * (double)i / (double)sides;
      v3_store(
        m.points + 3 * m.n_points++, v3((double)x + 0.5 + radius * cos(a), (double)y + 0.5 + radius * sin(a), 0));
    }
    for (size_t i = 0; i < sides + 4; i++)
    {
      size_t q = i < sides ? i / quarter : i - sides;
      int64_t* t = m.triangles + 3 * m.n_triangles++;
      t[0] = (int64_t)corner[q];
      t[1] = (int64_t)(i < sides ? first + (i + 1) % sides : first + q * quarter);
      t[2] = (int64_t)(i < sides ? first + i : corner[(q + 3) % 4]);
    }
  }
  return m;
}

static double area_of_polygons(const aqr_mesh* m)
{
  double sum = 0;
  for (size_t f = 0; f < m->number_of_faces; f++)
  {
    vec3 area = { 0, 0, 0 }, p = v3_load(m->points + 3 * m->connectivity[m->offsets[f]]);
    for (int64_t k = m->offsets[f] + 1; k + 1 < m->offsets[f + 1]; k++)
      area = v3_add(area, v3_cross(v3_sub(v3_load(m->points + 3 * m->connectivity[k]), p),
                            v3_sub(v3_load(m->points + 3 * m->connectivity[k + 1]), p)));
    sum += v3_norm(area) / 2;
  }
  return sum;
}

static double area_of_triangles(const shape* m)
{
  double sum = 0;
  for (size_t t = 0; t < m->n_triangles; t++)
  {
    vec3 p[3];
    for (size_t k = 0; k < 3; k++)
      p[k] = v3_load(m->points + 3 * m->triangles[3 * t + k]);
    sum += v3_norm(v3_cross(v3_sub(p[1], p[0]), v3_sub(p[2], p[0]))) / 2;
  }
  return sum;
}

/* What the faces of the output cover twice, or cover in holes, as a share of the input. */
static double excess_area(const shape* m)
{
  aqr_input input = shape_input(m);
  aqr_options o = aqr_default_options();
  aqr_remesher* r = NULL;
  double excess = INFINITY;
  CHECK(aqr_remesher_new(NULL, &r) == AQR_OK);
  CHECK(aqr_remesher_set_input(r, &input) == AQR_OK);
  CHECK(aqr_remesher_run(r, &o) == AQR_OK);
  if (aqr_remesher_mesh(r))
    excess = area_of_polygons(aqr_remesher_mesh(r)) / area_of_triangles(m) - 1;
  aqr_remesher_free(r);
  return excess;
}

/* Bridges lead to the holes, and the one face around them is cut by diagonals. */
AQR_TEST(faces_of_a_perforated_sheet_lie_over_its_holes)
{
  for (size_t n = 2; n <= 12; n += 2)
  {
    shape m = perforated(n, 16, 0.25);
    CHECK_BELOW(fabs(excess_area(&m)), 0.005);
    shape_free(&m);
  }
}

/* Bridges end in the middle of a hole's edges, and a straight one cuts off the corner between. */
AQR_TEST(bridges_over_narrow_walls_cross_the_holes)
{
  for (size_t sides = 4; sides <= 12; sides += 4)
  {
    shape m = perforated(9, sides, 0.46);
    CHECK_BELOW(fabs(excess_area(&m)), 0.005);
    shape_free(&m);
  }
}

AQR_TEST_MAIN
