/* SPDX-License-Identifier: BSD-3-Clause */
#include "test.h"

#include "thin_triangles.h"

enum
{
  a,
  b,
  c,
  d,
  e
};

/* The triangle abc, b on the line from a to c or at `apex`, with a face on every side of it. */
static aqr_polygon_mesh mesh_with_apex(aqr_context* context, vec3 apex)
{
  const aqr_index corner[] = { a, b, c, a, c, d, a, e, b, b, e, c };
  const size_t offsets[] = { 0, 3, 6, 9, 12 };
  const vec3 place[] = { v3(0, 0, 0), apex, v3(2, 0, 0), v3(1, 1, 0), v3(1, -1, 0) };
  aqr_vertex vertices[5];
  aqr_polygon_mesh m = { 0 };
  for (unsigned i = 0; i < 5; i++)
    vertices[i] = (aqr_vertex){ .position = place[i], .normal = v3(0, 0, 1), .size = 1 };
  CHECK(aqr_pm_append(context, &m, vertices, 5, offsets, 4, corner) == AQR_OK);
  return m;
}

static size_t faces_left(const aqr_polygon_mesh* m)
{
  size_t n = 0;
  for (size_t f = 0; f < m->n_faces; f++)
    n += m->faces[f] != AQR_NONE;
  return n;
}

/* The faces there are once thin triangles have been opened. */
static size_t opened(vec3 apex, bool on_chain, int largest_valence)
{
  aqr_context context = { 0 };
  aqr_polygon_mesh m = mesh_with_apex(&context, apex);
  if (on_chain)
    m.edge_type[aqr_pm_find(&m, a, c) >> 1] = AQR_LINE_FEATURE;
  CHECK(aqr_open_thin_triangles(&context, &m, largest_valence) == AQR_OK);
  CHECK(aqr_pm_is_consistent(&m) && aqr_pm_euler(&m) == 1);
  size_t n = faces_left(&m);
  aqr_polygon_mesh_free(&context, &m);
  CHECK(context.bytes == 0);
  return n;
}

AQR_TEST(three_vertices_in_a_row_are_a_face_without_area)
{
  aqr_context context = { 0 };
  aqr_polygon_mesh m = mesh_with_apex(&context, v3(1, 0, 0));
  CHECK(aqr_open_thin_triangles(&context, &m, 5) == AQR_OK);
  CHECK(faces_left(&m) == 3 && aqr_pm_find(&m, a, c) == AQR_NONE);
  aqr_index h = aqr_pm_find(&m, c, d);
  CHECK(h != AQR_NONE && aqr_pm_face_size(&m, aqr_pm_face(&m, h)) == 4);
  aqr_polygon_mesh_free(&context, &m);
}

AQR_TEST(a_triangle_with_area_is_taken_for_thin)
{
  CHECK(opened(v3(1, -0.1, 0), false, 5) == 4);
}

AQR_TEST(opening_takes_away_a_crease)
{
  CHECK(opened(v3(1, 0, 0), true, 5) == 4);
}

AQR_TEST(opening_makes_a_face_too_large)
{
  CHECK(opened(v3(1, 0, 0), false, 3) == 4);
}

AQR_TEST(opening_makes_a_face_concave)
{
  CHECK(opened(v3(0.012, 0.012, 0), false, 5) == 4);
  CHECK(opened(v3(1, 0.012, 0), false, 5) == 3); /* nearly straight */
}

AQR_TEST_MAIN
