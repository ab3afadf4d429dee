/* SPDX-License-Identifier: BSD-3-Clause */
/* Paper 3.2. */
#include "proximity.h"

#include <string.h>

enum
{
  entry_work = 8 /* of a face of a cell, with the chords in it */
};

static const double detour =
  3; /* times its distance: the way back along a line to where the line itself is a neighbour */
static const double family_cosine2 = 0.5; /* of pi / 4, squared */

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
  AQR_DROP(c, cell->entries, cell->capacity);
  memset(cell, 0, sizeof *cell);
}

/* Whether the inside of an edge whose ends are not comes within the radius of the probe. */
static bool passes_by(const aqr_probe* probe, vec3 a, vec3 b)
{
  vec3 ab = v3_sub(b, a), ap = v3_sub(probe->p, a);
  double n = v3_norm2(ab), along = v3_dot(ab, ap);
  return along > 0 && along < n && (v3_norm2(ap) - probe->radius * probe->radius) * n < along * along;
}

/* Room for the cell's next two faces. */
static bool reserve(aqr_context* c, aqr_pcell* cell)
{
  return AQR_RESERVE(c, cell->entries, cell->capacity, cell->n_entries + 3);
}

/* Takes in the face over half-edge h, unless no part of that edge is within the radius. */
static void cross(aqr_pcell* cell, const aqr_probe* probe, aqr_index h, vec3 from, vec3 to, bool from_in, bool to_in)
{
  aqr_index twin = aqr_twin(cell->surface, h);
  if (twin == AQR_NONE || cell->stamp[aqr_face_of(twin)] == cell->query)
    return;
  if (!from_in && !to_in && !passes_by(probe, from, to))
    return;
  cell->stamp[aqr_face_of(twin)] = cell->query;
  cell->entries[cell->n_entries++] = (aqr_entry){ twin, to_in, from_in };
}

static bool inside(const aqr_probe* probe, vec3 p)
{
  return v3_norm2(v3_sub(p, probe->p)) < probe->radius * probe->radius;
}

/* Starts a new cell around the point's own face. */
static aqr_status begin(aqr_context* c, aqr_pcell* cell, const aqr_probe* probe)
{
  const aqr_surface* s = cell->surface;
  if (++cell->query == 0) /* the counter came round: no stamp of an earlier turn may be taken for a new one */
  {
    memset(cell->stamp, 0, s->n_faces * sizeof *cell->stamp);
    cell->query = 1;
  }
  if (!reserve(c, cell))
    return AQR_OUT_OF_MEMORY;
  cell->stamp[probe->face] = cell->query;
  vec3 p[3];
  bool in[3];
  for (unsigned i = 0; i < 3; i++)
  {
    p[i] = aqr_point(s, s->corner[3 * probe->face + i]);
    in[i] = inside(probe, p[i]);
  }
  for (unsigned i = 0; i < 3; i++)
    cross(cell, probe, 3 * probe->face + i, p[i], p[(i + 1) % 3], in[i], in[(i + 1) % 3]);
  return AQR_OK;
}

/* Takes in what lies over the two other edges of the face that an entry leads to. */
static aqr_status extend(aqr_context* c, aqr_pcell* cell, const aqr_probe* probe, aqr_entry e)
{
  const aqr_surface* s = cell->surface;
  if (!reserve(c, cell))
    return AQR_OUT_OF_MEMORY;
  aqr_index next = aqr_next(e.h), prev = aqr_prev(e.h);
  vec3 from = aqr_point(s, s->corner[e.h]), to = aqr_point(s, s->corner[next]), apex = aqr_point(s, s->corner[prev]);
  bool apex_in = inside(probe, apex);
  cross(cell, probe, next, to, apex, e.to_inside, apex_in);
  cross(cell, probe, prev, apex, from, apex_in, e.from_inside);
  return AQR_OK;
}

/* The chords of the direction's family in one face. */
static void look(const aqr_lines* lines, aqr_index face, const aqr_probe* probe, double* nearest2, aqr_near* found)
{
  for (aqr_index n = lines->head[face]; n != AQR_NONE; n = aqr_next_chord(lines, n, face))
  {
    const aqr_sample* a = &lines->samples[n];
    aqr_index line = a->line;
    vec3 d = v3_sub(a[1].p, a->p);
    double along = v3_dot(d, probe->direction);
    if (along * along < family_cosine2 * v3_norm2(d))
      continue;
    double distance2 = v3_segment_distance2(probe->p, a->p, a[1].p);
    if (line == probe->self)
    {
      /* by the nearer end: in a large face a chord that starts far back ends at the probe */
      double back = lesser(fabs((double)a->arc - probe->arc), fabs((double)a[1].arc - probe->arc));
      if (back * back < detour * detour * distance2)
        continue;
    }
    if (distance2 < *nearest2)
    {
      *nearest2 = distance2;
      *found = (aqr_near){ line, n, 0 };
    }
  }
}

/* Whether what is found will do, so that the cell need not grow. */
static bool ends(const aqr_probe* probe, const aqr_near* found)
{
  return probe->any && found->line != AQR_NONE;
}

aqr_status aqr_pcell_nearest(
  aqr_context* c, aqr_pcell* cell, const aqr_lines* lines, const aqr_probe* probe, aqr_near* found)
{
  double nearest2 = probe->radius * probe->radius;
  *found = (aqr_near){ AQR_NONE, AQR_NONE, 0 };
  cell->n_entries = 0;
  cell->queries++;
  look(lines, probe->face, probe, &nearest2, found);
  aqr_status status = ends(probe, found) ? AQR_OK : begin(c, cell, probe);
  for (size_t i = 0; status == AQR_OK && !ends(probe, found) && i < cell->n_entries; i++)
  {
    look(lines, aqr_face_of(cell->entries[i].h), probe, &nearest2, found);
    if (!ends(probe, found))
      status = extend(c, cell, probe, cell->entries[i]);
  }
  found->distance = sqrt(nearest2);
  if (status == AQR_OK && !aqr_worked(c, entry_work * (1 + cell->n_entries)))
    status = AQR_CANCELLED;
  return status;
}
