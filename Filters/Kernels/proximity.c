/* SPDX-License-Identifier: BSD-3-Clause */
/* Paper 3.2. */
#include "proximity.h"

#include <string.h>

static const double family_cosine = 0.70710678118654752; /* of pi / 4 */

aqr_status aqr_pcell_init(aqr_context* c, const aqr_surface* s, aqr_pcell* cell)
{
  memset(cell, 0, sizeof *cell);
  cell->surface = s;
  cell->stamp = AQR_NEW0(c, uint32_t, s->n_faces);
  return cell->stamp ? AQR_OK : AQR_OUT_OF_MEMORY;
}

void aqr_pcell_free(aqr_context* c, aqr_pcell* cell)
{
  if (cell->surface)
    AQR_DROP(c, cell->stamp, cell->surface->n_faces);
  AQR_DROP(c, cell->faces, cell->capacity);
  memset(cell, 0, sizeof *cell);
}

static double distance_to_segment(vec3 p, vec3 a, vec3 b)
{
  vec3 ab = v3_sub(b, a), ap = v3_sub(p, a);
  double n = v3_norm2(ab), t = n > 0 ? fmin(1, fmax(0, v3_dot(ap, ab) / n)) : 0;
  return v3_norm(v3_madd(ap, -t, ab));
}

static bool take(aqr_context* c, aqr_pcell* cell, aqr_index f)
{
  if (!AQR_RESERVE(c, cell->faces, cell->capacity, cell->n_faces + 1))
    return false;
  cell->stamp[f] = cell->query;
  cell->faces[cell->n_faces++] = f;
  return true;
}

/* Starts a new cell that holds the point's own face. */
static aqr_status begin(aqr_context* c, aqr_pcell* cell, aqr_index face, vec3 p, double radius)
{
  cell->n_faces = 0;
  cell->p = p;
  cell->radius = radius;
  cell->queries++;
  if (++cell->query == 0) /* the counter came round: no stamp of an earlier turn may be taken for a new one */
  {
    memset(cell->stamp, 0, cell->surface->n_faces * sizeof *cell->stamp);
    cell->query = 1;
  }
  return take(c, cell, face) ? AQR_OK : AQR_OUT_OF_MEMORY;
}

/* Takes in the neighbours of the cell's i-th face that share an edge with a vertex inside the
 * radius. */
static aqr_status extend(aqr_context* c, aqr_pcell* cell, size_t i)
{
  const aqr_surface* s = cell->surface;
  aqr_index f = cell->faces[i];
  bool inside[3];
  for (unsigned k = 0; k < 3; k++)
    inside[k] = v3_norm2(v3_sub(aqr_point(s, s->corner[3 * f + k]), cell->p)) < cell->radius * cell->radius;
  for (unsigned k = 0; k < 3; k++)
  {
    aqr_index twin = aqr_twin(s, 3 * f + k);
    if (twin == AQR_NONE || cell->stamp[aqr_face_of(twin)] == cell->query)
      continue;
    bool reaches = inside[k] || inside[(k + 1) % 3];
    if (!reaches)
      reaches = v3_norm2(v3_sub(aqr_point(s, aqr_from(s, aqr_prev(twin))), cell->p)) < cell->radius * cell->radius;
    if (reaches && !take(c, cell, aqr_face_of(twin)))
      return AQR_OUT_OF_MEMORY;
  }
  return AQR_OK;
}

aqr_status aqr_pcell_nearest(
  aqr_context* c, aqr_pcell* cell, const aqr_lines* lines, const aqr_probe* probe, aqr_near* found)
{
  *found = (aqr_near){ AQR_NONE, AQR_NONE, probe->radius };
  aqr_status status = begin(c, cell, probe->face, probe->p, probe->radius);
  for (size_t i = 0; status == AQR_OK && i < cell->n_faces; i++)
  {
    for (aqr_index k = lines->head[cell->faces[i]]; k != AQR_NONE; k = lines->segments[k].next)
    {
      aqr_index n = lines->segments[k].sample, line = lines->segments[k].line;
      const aqr_sample* a = &lines->samples[n];
      vec3 d = v3_sub(a[1].p, a->p);
      if (fabs(v3_dot(d, probe->direction)) < family_cosine * v3_norm(d))
        continue;
      /* by the nearer end: in a large face a chord that starts far back ends at the probe */
      if (line == probe->self &&
          fmin(fabs((double)a->arc - probe->arc), fabs((double)a[1].arc - probe->arc)) < probe->gap)
        continue;
      double distance = distance_to_segment(probe->p, a->p, a[1].p);
      if (distance < found->distance)
        *found = (aqr_near){ line, n, distance };
    }
    if (probe->any && found->line != AQR_NONE)
      break;
    status = extend(c, cell, i);
  }
  return status;
}
