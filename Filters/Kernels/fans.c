/* SPDX-License-Identifier: BSD-3-Clause */
#include "fans.h"

static vec3 corner(const aqr_polygon_mesh* m, aqr_index h)
{
  return aqr_pm_point(m, aqr_pm_from(m, h));
}

/* The smallest triangle of the fan from h, as seen along `normal`. */
static double least_of_fan(const aqr_polygon_mesh* m, aqr_index h, vec3 normal)
{
  vec3 p = corner(m, h);
  double least = INFINITY;
  for (aqr_index k = aqr_pm_next(m, h); aqr_pm_next(m, k) != h; k = aqr_pm_next(m, k))
  {
    vec3 area = v3_cross(v3_sub(corner(m, k), p), v3_sub(corner(m, aqr_pm_next(m, k)), p));
    least = lesser(least, v3_dot(area, normal));
  }
  return least;
}

void aqr_fan_start(aqr_polygon_mesh* m, aqr_index f)
{
  aqr_index first = m->faces[f], h = first, b = aqr_pm_next(m, first), c = aqr_pm_next(m, b);
  if (aqr_pm_is_quad(m, f))
  {
    vec3 across = v3_sub(corner(m, aqr_pm_next(m, c)), corner(m, b));
    if (v3_norm2(v3_sub(corner(m, c), corner(m, first))) > v3_norm2(across))
      m->faces[f] = b;
    return;
  }
  if (aqr_pm_next(m, c) == first)
    return;
  vec3 normal = aqr_pm_area(m, f);
  double most = -INFINITY;
  do
  {
    double least = least_of_fan(m, h, normal);
    if (least > most)
    {
      most = least;
      m->faces[f] = h;
    }
    h = aqr_pm_next(m, h);
  } while (h != first);
}
