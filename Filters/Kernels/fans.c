/* SPDX-License-Identifier: BSD-3-Clause */
#include "fans.h"

static vec3 corner(const aqr_polygon_mesh* m, aqr_index h)
{
  return aqr_pm_point(m, aqr_pm_from(m, h));
}

/* Twice the vector area of the fan from h and, in *least, its smallest triangle's part along `normal`. */
static vec3 fan_from(const aqr_polygon_mesh* m, aqr_index h, vec3 normal, double* least)
{
  vec3 p = corner(m, h), sum = v3(0, 0, 0);
  *least = INFINITY;
  for (aqr_index k = aqr_pm_next(m, h); aqr_pm_next(m, k) != h; k = aqr_pm_next(m, k))
  {
    vec3 area = v3_cross(v3_sub(corner(m, k), p), v3_sub(corner(m, aqr_pm_next(m, k)), p));
    sum = v3_add(sum, area);
    *least = lesser(*least, v3_dot(area, normal));
  }
  return sum;
}

static bool is_quad(const aqr_polygon_mesh* m, aqr_index h)
{
  aqr_index opposite = aqr_pm_next(m, aqr_pm_next(m, h));
  return opposite != h && aqr_pm_next(m, opposite) != h && aqr_pm_next(m, aqr_pm_next(m, opposite)) == h;
}

void aqr_fan_start(aqr_polygon_mesh* m, aqr_index f)
{
  aqr_index first = m->faces[f], best = first, b = aqr_pm_next(m, first), c = aqr_pm_next(m, b);
  if (is_quad(m, first))
  {
    vec3 across = v3_sub(corner(m, aqr_pm_next(m, c)), corner(m, b));
    if (v3_norm2(v3_sub(corner(m, c), corner(m, first))) > v3_norm2(across))
      m->faces[f] = b;
    return;
  }
  double most = -INFINITY, least = 0;
  vec3 normal = fan_from(m, first, v3(0, 0, 0), &least);
  aqr_index h = first;
  do
  {
    fan_from(m, h, normal, &least);
    if (least > most)
    {
      most = least;
      best = h;
    }
    h = aqr_pm_next(m, h);
  } while (h != first);
  m->faces[f] = best;
}
