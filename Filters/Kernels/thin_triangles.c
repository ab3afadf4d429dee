/* SPDX-License-Identifier: BSD-3-Clause */
#include "thin_triangles.h"

#include "partition.h"

static const double thin = 0.01; /* of the longest side: the height over it */

static bool is_triangle(const aqr_polygon_mesh* m, aqr_index h)
{
  aqr_index third = aqr_pm_next(m, aqr_pm_next(m, h));
  return third != h && aqr_pm_next(m, third) == h;
}

static double length2(const aqr_polygon_mesh* m, aqr_index h)
{
  return v3_norm2(v3_sub(aqr_pm_point(m, aqr_pm_to(m, h)), aqr_pm_point(m, aqr_pm_from(m, h))));
}

/* The longest side of face f where it is a thin triangle; AQR_NONE where it is not. */
static aqr_index longest_side(const aqr_polygon_mesh* m, aqr_index f)
{
  aqr_index h = m->faces[f];
  if (h == AQR_NONE || !is_triangle(m, h))
    return AQR_NONE;
  aqr_index side = h;
  for (unsigned i = 0; i < 2; i++)
  {
    h = aqr_pm_next(m, h);
    side = length2(m, h) > length2(m, side) ? h : side;
  }
  double longest2 = length2(m, side);
  return v3_norm2(aqr_pm_area(m, f)) <= thin * thin * longest2 * longest2 ? side : AQR_NONE;
}

/* Adds the corners of h's face from the end of h on; false where it has more than there is room for, or `vertex`. */
static bool add_corners(const aqr_polygon_mesh* m, aqr_index h, aqr_index vertex, aqr_polygon* g)
{
  aqr_index k = h;
  do
  {
    k = aqr_pm_next(m, k);
    aqr_index v = aqr_pm_from(m, k);
    if (g->n == AQR_POLYGON_CORNERS || v == vertex)
      return false;
    aqr_polygon_add(g, k, &m->vertices[v]);
  } while (k != h);
  return true;
}

/* Whether the face across the longest side of a thin triangle can take it in. */
static bool can_open(const aqr_polygon_mesh* m, aqr_index side, int largest_valence)
{
  const aqr_index apex = aqr_pm_from(m, aqr_pm_prev(m, side));
  if (aqr_pm_face(m, side ^ 1) == AQR_NONE || aqr_pm_on_chain(m, side))
    return false;
  aqr_polygon alone = { .n = 0 }, both = { .n = 0 };
  if (!add_corners(m, side ^ 1, apex, &alone))
    return false;
  aqr_polygon_add(&both, apex, &m->vertices[apex]);
  return add_corners(m, side ^ 1, apex, &both) && (int)both.n <= largest_valence &&
         (!aqr_polygon_is_concave(&both) || aqr_polygon_is_concave(&alone));
}

aqr_status aqr_open_thin_triangles(aqr_context* c, aqr_polygon_mesh* m, int largest_valence)
{
  for (aqr_index f = 0; f < m->n_faces; f++)
  {
    if (!aqr_worked(c, 2))
      return AQR_CANCELLED;
    aqr_index side = longest_side(m, f);
    if (side != AQR_NONE && can_open(m, side, largest_valence))
      aqr_pm_remove_edge(m, side ^ 1);
  }
  return AQR_OK;
}
