/* SPDX-License-Identifier: BSD-3-Clause */
/* Paper 3.2: dense meshes with a few very large faces are split beforehand. */
#include "shared.h"
#include "surface.h"

enum
{
  most_rounds = 400,
  most_growth = 8,   /* times the number of faces at the start ... */
  free_faces = 16000 /* ... and these many: more than a closed surface without folds takes. Beyond that the longest
                        edges are halved and the others left, or a soup of large triangles costs what a scan does */
};

static const double step_down = 0.75; /* of the length that a round halves */

typedef struct refiner
{
  aqr_context* c;
  aqr_surface* s;
  aqr_index* list; /* half-edges longer than wanted, one per edge */
  size_t n, capacity;
  aqr_shared_double longest2; /* squared length of the longest edge at the start */
} refiner;

static double length2(const aqr_surface* s, aqr_index h)
{
  return v3_norm2(aqr_edge_vector(s, h));
}

static bool listed(refiner* r, aqr_index h, double least2)
{
  if (length2(r->s, h) <= least2)
    return true;
  if (!AQR_RESERVE(r->c, r->list, r->capacity, r->n + 1))
    return false;
  r->list[r->n++] = h;
  return true;
}

/* Splits the face of h (from a to b, third corner c) into a m c, which keeps its number, and m b c, which is `fresh`.
 */
static void split_face(aqr_surface* s, aqr_index h, aqr_index m, aqr_index fresh)
{
  aqr_index next = aqr_next(h), g = 3 * fresh;
  aqr_index b = aqr_to(s, h), c = aqr_from(s, aqr_prev(h)), over = s->twin[next];
  s->corner[g] = m;
  s->corner[g + 1] = b;
  s->corner[g + 2] = c;
  s->source[fresh] = s->source[h / 3];
  s->corner[next] = m;
  s->twin[g + 1] = over;
  if (over != AQR_NONE)
    s->twin[over] = g + 1;
  s->twin[g + 2] = next;
  s->twin[next] = g + 2;
  if (s->fan[b] == next)
    s->fan[b] = g + 1;
}

static bool split_edge(refiner* r, aqr_index h)
{
  aqr_surface* s = r->s;
  aqr_index t = s->twin[h], m = (aqr_index)s->n_points, g = (aqr_index)s->n_faces;
  if (!aqr_surface_reserve_faces(r->c, s, s->n_faces + 2) || !aqr_surface_reserve_points(r->c, s, s->n_points + 1) ||
      !aqr_surface_reserve_origins(r->c, s, s->n_points + 1))
    return false;
  aqr_index a = aqr_from(s, h), b = aqr_to(s, h);
  v3_store(s->points + 3 * (size_t)m, v3_scale(v3_add(aqr_point(s, a), aqr_point(s, b)), 0.5));
  const aqr_origin middle = aqr_origin_between(s, a, b, 0.5, s->source[h / 3]);
  if (!aqr_surface_put_between(r->c, s, m, &middle))
    return false;
  s->n_points++;
  s->n_faces += t == AQR_NONE ? 1 : 2;
  split_face(s, h, m, g);
  s->fan[m] = 3 * g;
  s->twin[3 * g] = t == AQR_NONE ? AQR_NONE : t;
  if (t == AQR_NONE)
    return true;
  split_face(s, t, m, g + 1);
  s->twin[t] = 3 * g;
  s->twin[h] = 3 * (g + 1);
  s->twin[3 * (g + 1)] = h;
  return true;
}

static void find_longest(void* data, size_t begin, size_t end)
{
  refiner* r = data;
  double longest2 = 0;
  for (aqr_index h = (aqr_index)begin; h < end; h++)
    longest2 = greater(longest2, length2(r->s, h));
  aqr_shared_raise(&r->longest2, longest2);
}

static aqr_status list_long_edges(refiner* r, double least2)
{
  const aqr_surface* s = r->s;
  for (aqr_index h = 0; h < 3 * s->n_faces; h++)
    if ((s->twin[h] == AQR_NONE || h < s->twin[h]) && !listed(r, h, least2))
      return AQR_OUT_OF_MEMORY;
  return AQR_OK;
}

aqr_status aqr_surface_refine(aqr_context* c, aqr_surface* s, double longest_edge, size_t* added)
{
  refiner r = { .c = c, .s = s };
  aqr_status status = AQR_OK;
  size_t before = s->n_points, limit = most_growth * s->n_faces + free_faces;
  if (limit > AQR_SEAM / 3 - 2) /* half-edges have 31 bits, and one edge more gives two faces */
    limit = AQR_SEAM / 3 - 2;
  double least2 = longest_edge * longest_edge;
  AQR_TRY(aqr_parallel(c, 3 * s->n_faces, find_longest, &r, 0.85, 0.9));
  double longest2 = r.longest2;
  if (longest2 > least2)
    AQR_TRY(list_long_edges(&r, least2));
  for (int round = 0; round < most_rounds && r.n; round++)
  {
    AQR_REQUIRE(aqr_step(c, 0.9), AQR_CANCELLED);
    longest2 = fmax(least2, longest2 * step_down * step_down);
    for (size_t i = 0; i < r.n && s->n_faces < limit; i++) /* with those listed on the way */
    {
      aqr_index h = r.list[i];
      AQR_REQUIRE(aqr_worked(c, 4), AQR_CANCELLED);
      if (length2(s, h) <= longest2)
        continue;
      size_t faces = s->n_faces;
      AQR_REQUIRE(split_edge(&r, h), AQR_OUT_OF_MEMORY);
      /* the half that keeps its number stays listed; the edges that got new numbers are listed when long */
      for (size_t k = 3 * faces; k < 3 * s->n_faces; k++)
        AQR_REQUIRE(listed(&r, (aqr_index)k, least2), AQR_OUT_OF_MEMORY);
    }
    size_t kept = 0;
    for (size_t i = 0; i < r.n; i++)
      if (length2(s, r.list[i]) > least2)
        r.list[kept++] = r.list[i];
    r.n = s->n_faces < limit ? kept : 0;
  }
done:
  *added = s->n_points - before;
  AQR_DROP(c, r.list, r.capacity);
  return status;
}
