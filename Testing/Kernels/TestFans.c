/* SPDX-License-Identifier: BSD-3-Clause */
#include "test.h"

#include "fans.h"
#include "solids.h"

#include <stdlib.h>

/* One polygon in the plane, its corners counter-clockwise. */
static bool polygon(aqr_context* c, size_t n, const double (*at)[2], aqr_polygon_mesh* m)
{
  aqr_vertex v[8] = { 0 };
  aqr_index corner[8];
  const size_t offsets[2] = { 0, n };
  for (size_t i = 0; i < n; i++)
  {
    v[i].position = v3(at[i][0], at[i][1], 0);
    v[i].normal = v3(0, 0, 1);
    corner[i] = (aqr_index)i;
  }
  return aqr_pm_append(c, m, v, n, offsets, 1, corner) == AQR_OK;
}

static aqr_index first_corner(const aqr_polygon_mesh* m)
{
  return aqr_pm_from(m, m->faces[0]);
}

/* The corner at 3 is concave: fans from 0 or 1 have a triangle turned over. */
AQR_TEST(the_fan_of_a_concave_polygon_does_not_fold)
{
  const double at[5][2] = { { 0, 0 }, { 2, 0 }, { 2, 2 }, { 1, 0.2 }, { 0, 2 } };
  aqr_context c = { 0 };
  for (size_t turn = 0; turn < 5; turn++)
  {
    aqr_polygon_mesh m = { 0 };
    double turned[5][2];
    for (size_t i = 0; i < 5; i++)
      memcpy(turned[(i + turn) % 5], at[i], sizeof at[i]);
    CHECK(polygon(&c, 5, (const double(*)[2])turned, &m));
    aqr_fan_start(&m, 0);
    CHECK(first_corner(&m) == (3 + turn) % 5);
    aqr_polygon_mesh_free(&c, &m);
  }
  CHECK(c.bytes == 0);
}

AQR_TEST(a_quad_is_cut_at_its_shorter_diagonal)
{
  const double at[4][2] = { { 0, 0 }, { 1, 0 }, { 1.5, 1 }, { 0.5, 1 } };
  aqr_context c = { 0 };
  aqr_polygon_mesh m = { 0 };
  CHECK(polygon(&c, 4, at, &m));
  aqr_fan_start(&m, 0);
  CHECK(first_corner(&m) == 1);
  aqr_fan_start(&m, 0);
  CHECK(first_corner(&m) == 1);
  aqr_polygon_mesh_free(&c, &m);
  CHECK(c.bytes == 0);
}

AQR_TEST_MAIN
