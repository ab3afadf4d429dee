/* SPDX-License-Identifier: BSD-3-Clause */
/* Whether a polygon mesh is what it is to be. */
#include "polygon_mesh.h"

#include "shared.h"

/* What threads found, each in its part of the mesh. */
typedef struct check
{
  const aqr_polygon_mesh* m;
  atomic_bool wrong;
  aqr_shared_size living, inside;    /* half-edges, and those that have a face */
  aqr_shared_size in_faces, in_fans; /* half-edges in the cycles that faces and vertices begin */
} check;

/* Whether a living half-edge is linked to its neighbours in its loop. */
static bool links_agree(const aqr_polygon_mesh* m, aqr_index h)
{
  const aqr_half_edge* e = m->half_edges;
  aqr_index n = e[h].next, p = e[h].prev;
  if (e[h].from >= m->n_vertices || m->vertices[e[h].from].out == AQR_NONE || n >= m->n_half_edges ||
      p >= m->n_half_edges || e[n].prev != h || e[p].next != h || e[n].from != e[h ^ 1].from || e[n].face != e[h].face)
    return false;
  if (e[h].face == AQR_NONE) /* a border vertex has one gap in its fan, and begins at it */
    return e[h ^ 1].face != AQR_NONE && m->vertices[e[h].from].out == h;
  return e[h].face < m->n_faces && m->faces[e[h].face] != AQR_NONE;
}

static void check_links(void* data, size_t begin, size_t end)
{
  check* k = data;
  const aqr_half_edge* e = k->m->half_edges;
  size_t living = 0, inside = 0;
  for (aqr_index h = (aqr_index)begin; h < end; h++)
  {
    bool lives = e[h].from != AQR_NONE;
    if (lives != (e[h ^ 1].from != AQR_NONE) || (lives && !links_agree(k->m, h)))
      k->wrong = true;
    living += lives;
    inside += lives && e[h].face != AQR_NONE;
  }
  k->living += living;
  k->inside += inside;
}

static void check_faces(void* data, size_t begin, size_t end)
{
  check* k = data;
  const aqr_polygon_mesh* m = k->m;
  size_t n = 0;
  for (aqr_index f = (aqr_index)begin; f < end; f++)
  {
    aqr_index h = m->faces[f];
    if (h == AQR_NONE)
      continue;
    if (h >= m->n_half_edges || !aqr_pm_edge_lives(m, h) || aqr_pm_face(m, h) != f)
      k->wrong = true;
    else
      n += aqr_pm_face_size(m, f);
  }
  k->in_faces += n;
}

static void check_fans(void* data, size_t begin, size_t end)
{
  check* k = data;
  const aqr_polygon_mesh* m = k->m;
  size_t n = 0;
  for (aqr_index v = (aqr_index)begin; v < end; v++)
  {
    aqr_index h = m->vertices[v].out;
    if (h == AQR_NONE)
      continue;
    if (h >= m->n_half_edges || aqr_pm_from(m, h) != v)
      k->wrong = true;
    else
      n += aqr_pm_valence(m, v);
  }
  k->in_fans += n;
}

/* No loop at a vertex, and no two edges to the same other. */
static bool is_fan_regular(const aqr_polygon_mesh* m, aqr_index v)
{
  aqr_index first = m->vertices[v].out, h = first;
  do
  {
    if (aqr_pm_to(m, h) == v)
      return false;
    for (aqr_index k = aqr_pm_next_around(m, h); k != first; k = aqr_pm_next_around(m, k))
      if (aqr_pm_to(m, k) == aqr_pm_to(m, h))
        return false;
    h = aqr_pm_next_around(m, h);
  } while (h != first);
  return true;
}

static void check_fans_regular(void* data, size_t begin, size_t end)
{
  check* k = data;
  for (aqr_index v = (aqr_index)begin; v < end; v++)
    if (k->m->vertices[v].out != AQR_NONE && !is_fan_regular(k->m, v))
      k->wrong = true;
}

static bool is_face_regular(const aqr_polygon_mesh* m, aqr_index f)
{
  aqr_index h = m->faces[f];
  if (aqr_pm_next(m, aqr_pm_next(m, h)) == h)
    return false;
  do
  {
    for (aqr_index k = aqr_pm_next(m, h); k != m->faces[f]; k = aqr_pm_next(m, k))
      if (aqr_pm_from(m, k) == aqr_pm_from(m, h))
        return false;
    h = aqr_pm_next(m, h);
  } while (h != m->faces[f]);
  return aqr_pm_duplicate(m, f) == AQR_NONE;
}

static void check_faces_regular(void* data, size_t begin, size_t end)
{
  check* k = data;
  for (aqr_index f = (aqr_index)begin; f < end; f++)
    if (k->m->faces[f] != AQR_NONE && !is_face_regular(k->m, f))
      k->wrong = true;
}

/* On the threads of the context, on this one where there is none. */
static aqr_status run_check(aqr_context* c, check* k, size_t n, void (*body)(void*, size_t, size_t))
{
  aqr_status status = AQR_OK;
  if (c)
    status = aqr_parallel(c, n, body, k, 0, 0);
  else
    body(k, 0, n);
  return status == AQR_OK && k->wrong ? AQR_INTERNAL : status;
}

static aqr_status check_consistent(aqr_context* c, const aqr_polygon_mesh* m)
{
  check k = { .m = m };
  aqr_status status = m->n_half_edges % 2 ? AQR_INTERNAL : AQR_OK;
  AQR_TRY(status);
  AQR_TRY(run_check(c, &k, m->n_half_edges, check_links));
  /* Loops and fans are cycles now. If the faces' cycles hold as many half-edges as have faces, then each face is one
   * cycle; likewise fans. */
  AQR_TRY(run_check(c, &k, m->n_faces, check_faces));
  AQR_TRY(run_check(c, &k, m->n_vertices, check_fans));
  AQR_REQUIRE(k.in_faces == k.inside && k.in_fans == k.living, AQR_INTERNAL);
done:
  return status;
}

static aqr_status check_regular(aqr_context* c, const aqr_polygon_mesh* m)
{
  check k = { .m = m };
  aqr_status status = AQR_OK;
  AQR_TRY(run_check(c, &k, m->n_vertices, check_fans_regular));
  AQR_TRY(run_check(c, &k, m->n_faces, check_faces_regular));
done:
  return status;
}

bool aqr_pm_is_consistent(const aqr_polygon_mesh* m)
{
  return check_consistent(NULL, m) == AQR_OK;
}

bool aqr_pm_is_regular(const aqr_polygon_mesh* m)
{
  return check_regular(NULL, m) == AQR_OK;
}

aqr_status aqr_pm_verify(aqr_context* c, const aqr_polygon_mesh* m, bool regular)
{
  aqr_status status = check_consistent(c, m);
  return status == AQR_OK && regular ? check_regular(c, m) : status;
}

long long aqr_pm_euler(const aqr_polygon_mesh* m)
{
  long long x = 0;
  for (size_t v = 0; v < m->n_vertices; v++)
    x += m->vertices[v].out != AQR_NONE;
  for (size_t h = 0; h < m->n_half_edges; h += 2)
    x -= m->half_edges[h].from != AQR_NONE;
  for (size_t f = 0; f < m->n_faces; f++)
    x += m->faces[f] != AQR_NONE;
  return x;
}
