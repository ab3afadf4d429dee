/* SPDX-License-Identifier: BSD-3-Clause */
#include "surface_input.h"

#include "shared.h"

#include <string.h>

typedef struct reader
{
  aqr_context* c;
  const aqr_input* in;
  aqr_surface* s;
  aqr_report* report;
  aqr_index* weld;         /* per input point: the input point it was joined to */
  atomic_bool faulty;      /* some corner of the input */
  aqr_shared_index* table; /* of points by their coordinates */
  size_t table_size;
  aqr_shared_index* first_use; /* per input point: the first corner of a triangle that it is, or AQR_NONE */
  aqr_shared_size used_points, merged_points;
  atomic_bool* used;        /* per input point: by a triangle */
  aqr_shared_double box[6]; /* of the points in use: their highest coordinates, and the negatives of the lowest */
} reader;

/* ---- what may be read ---- */

static bool is_inside(const aqr_input* in, int64_t i)
{
  return i >= 0 && (size_t)i < in->number_of_points;
}

/* Of the triangles' corners. */
static aqr_status check_corners(const aqr_input* in, size_t begin, size_t end)
{
  for (size_t i = begin; i < end; i++)
  {
    if (!is_inside(in, in->triangles[i]))
      return AQR_INDEX_OUT_OF_RANGE;
    vec3 p = aqr_input_point(in, (size_t)in->triangles[i]);
    if (!isfinite(p.x) || !isfinite(p.y) || !isfinite(p.z))
      return AQR_NON_FINITE_POINT;
  }
  return AQR_OK;
}

static void look_for_faults(void* data, size_t begin, size_t end)
{
  reader* r = data;
  if (check_corners(r->in, begin, end) != AQR_OK)
    atomic_store(&r->faulty, true);
}

static aqr_status check_input(reader* r)
{
  const aqr_input* in = r->in;
  aqr_status status = AQR_OK;
  if (in->number_of_points == 0 || in->number_of_triangles == 0)
    return AQR_EMPTY_INPUT;
  if (in->number_of_points >= AQR_SEAM / 3 || in->number_of_triangles >= AQR_SEAM / 6)
    return AQR_TOO_LARGE;
  AQR_TRY(aqr_parallel(r->c, 3 * in->number_of_triangles, look_for_faults, r, 0, 0));
  if (r->faulty)
    AQR_TRY(check_corners(in, 0, 3 * in->number_of_triangles)); /* the first fault is told */
  for (size_t i = 0; i < 2 * in->number_of_locked; i++)
    AQR_REQUIRE(is_inside(in, in->locked[i]), AQR_INDEX_OUT_OF_RANGE);
done:
  return status;
}

static uint64_t mix(uint64_t h, uint64_t x)
{
  h = (h ^ x) * 0x9e3779b97f4a7c15u;
  return h ^ (h >> 29);
}

static bool same_point(vec3 a, vec3 b)
{
  return !(a.x < b.x || a.x > b.x || a.y < b.y || a.y > b.y || a.z < b.z || a.z > b.z);
}

static size_t table_size(size_t n)
{
  size_t size = 16;
  while (size < 2 * n)
    size *= 2;
  return size;
}

/* ---- points ---- */

static uint64_t hash_point(vec3 p)
{
  uint64_t bits[3];
  double q[3] = { p.x + 0.0, p.y + 0.0, p.z + 0.0 }; /* one zero, not two */
  memcpy(bits, q, sizeof bits);
  return mix(mix(mix(0, bits[0]), bits[1]), bits[2]);
}

static aqr_index at_place(const reader* r, size_t at)
{
  return atomic_load_explicit(&r->table[at], memory_order_relaxed);
}

/* The place in the table of a point with the same coordinates, or the free one where it would be. */
static size_t find_place(const reader* r, vec3 p)
{
  size_t at = hash_point(p) & (r->table_size - 1);
  for (aqr_index v = at_place(r, at); v != AQR_NONE && !same_point(aqr_input_point(r->in, v), p); v = at_place(r, at))
    at = (at + 1) & (r->table_size - 1);
  return at;
}

/* Enters a point; false where there is one with the same coordinates. Of these the first that is used stays in the end,
 * in whatever order threads enter them. */
static bool enter_point(reader* r, aqr_index v)
{
  vec3 p = aqr_input_point(r->in, v);
  for (;;)
  {
    size_t at = find_place(r, p);
    aqr_index there = AQR_NONE;
    if (atomic_compare_exchange_strong_explicit(&r->table[at], &there, v, memory_order_relaxed, memory_order_relaxed))
      return true;
    if (!same_point(aqr_input_point(r->in, there), p)) /* another thread took the place meanwhile */
      continue;
    while (r->first_use[v] < r->first_use[there] &&
           !atomic_compare_exchange_weak_explicit(&r->table[at], &there, v, memory_order_relaxed, memory_order_relaxed))
      ;
    return false;
  }
}

static void empty_table(void* data, size_t begin, size_t end)
{
  reader* r = data;
  for (size_t i = begin; i < end; i++)
    atomic_init(&r->table[i], AQR_NONE);
}

static void begin_points(void* data, size_t begin, size_t end)
{
  reader* r = data;
  for (size_t v = begin; v < end; v++)
    atomic_init(&r->first_use[v], AQR_NONE);
}

static void find_first_uses(void* data, size_t begin, size_t end)
{
  reader* r = data;
  for (size_t i = begin; i < end; i++)
    aqr_shared_lower(&r->first_use[r->in->triangles[i]], (aqr_index)i);
}

static void enter_points(void* data, size_t begin, size_t end)
{
  reader* r = data;
  size_t used = 0, merged = 0;
  for (aqr_index v = (aqr_index)begin; v < end; v++)
    if (r->first_use[v] != AQR_NONE)
    {
      used++;
      merged += !enter_point(r, v);
    }
  r->used_points += used;
  r->merged_points += merged;
}

static void weld(void* data, size_t begin, size_t end)
{
  reader* r = data;
  for (aqr_index v = (aqr_index)begin; v < end; v++)
    r->weld[v] = r->first_use[v] == AQR_NONE ? AQR_NONE
                 : r->merged_points          ? at_place(r, find_place(r, aqr_input_point(r->in, v)))
                                             : v;
}

/* Joins points with the same coordinates to the first of them that a triangle uses; points that neither a triangle nor
 * a locked edge uses stay AQR_NONE. */
static aqr_status weld_points(reader* r)
{
  const aqr_input* in = r->in;
  size_t n = in->number_of_points;
  aqr_status status = AQR_OK;
  r->table_size = table_size(n);
  r->table = AQR_NEW(r->c, aqr_shared_index, r->table_size);
  r->weld = AQR_NEW(r->c, aqr_index, n);
  r->first_use = AQR_NEW(r->c, aqr_shared_index, n);
  AQR_REQUIRE(r->table && r->weld && r->first_use, AQR_OUT_OF_MEMORY);
  AQR_TRY(aqr_parallel(r->c, r->table_size, empty_table, r, 0.1, 0.1));
  AQR_TRY(aqr_parallel(r->c, n, begin_points, r, 0.1, 0.1));
  AQR_TRY(aqr_parallel(r->c, 3 * in->number_of_triangles, find_first_uses, r, 0.1, 0.12));
  AQR_TRY(aqr_parallel(r->c, n, enter_points, r, 0.12, 0.15));
  AQR_TRY(aqr_parallel(r->c, n, weld, r, 0.15, 0.15));
  r->report->unused_points = n - r->used_points;
  r->report->merged_points = r->merged_points;
  for (size_t i = 0; i < 2 * in->number_of_locked; i++)
  {
    aqr_index v = (aqr_index)in->locked[i];
    vec3 p = aqr_input_point(in, v);
    if (r->weld[v] == AQR_NONE && isfinite(p.x) && isfinite(p.y) && isfinite(p.z))
      r->weld[v] = at_place(r, find_place(r, p));
  }
done:
  AQR_DROP(r->c, r->table, r->table_size);
  AQR_DROP(r->c, r->first_use, n);
  return status;
}

/* ---- triangles ---- */

static void sort3(aqr_index* k)
{
  for (unsigned i = 0; i < 3; i++)
  {
    unsigned j = i % 2;
    if (k[j] > k[j + 1])
    {
      aqr_index swap = k[j];
      k[j] = k[j + 1];
      k[j + 1] = swap;
    }
  }
}

/* Of triangles with the same points all but the first lose their source. */
static aqr_status drop_duplicates(reader* r)
{
  aqr_surface* s = r->s;
  size_t n = r->in->number_of_triangles, size = table_size(n);
  aqr_index* table = AQR_NEW(r->c, aqr_index, size);
  aqr_status status = AQR_OK;
  AQR_REQUIRE(table, AQR_OUT_OF_MEMORY);
  memset(table, 0xff, size * sizeof *table);
  for (size_t f = 0; f < n; f++)
  {
    if (f % (1 << 18) == 0)
      AQR_REQUIRE(aqr_step(r->c, 0.2), AQR_CANCELLED);
    if (s->source[f] == AQR_NONE)
      continue;
    aqr_index key[3];
    memcpy(key, s->corner + 3 * f, sizeof key);
    sort3(key);
    size_t at = mix(mix(mix(0, key[0]), key[1]), key[2]) & (size - 1);
    for (; table[at] != AQR_NONE; at = (at + 1) & (size - 1))
    {
      aqr_index other[3];
      memcpy(other, s->corner + 3 * (size_t)table[at], sizeof other);
      sort3(other);
      if (memcmp(key, other, sizeof key) == 0)
        break;
    }
    if (table[at] == AQR_NONE)
      table[at] = (aqr_index)f;
    else
    {
      s->source[f] = AQR_NONE;
      r->report->duplicate_triangles++;
    }
  }
done:
  AQR_DROP(r->c, table, size);
  return status;
}

/* Takes the corners of triangles from the input; those without three different points get no source. */
static void take_triangles(void* data, size_t begin, size_t end)
{
  reader* r = data;
  aqr_surface* s = r->s;
  for (size_t f = begin; f < end; f++)
  {
    aqr_index* corner = s->corner + 3 * f;
    for (unsigned k = 0; k < 3; k++)
      corner[k] = r->weld[r->in->triangles[3 * f + k]];
    bool flat = corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0];
    s->source[f] = flat ? AQR_NONE : (aqr_index)f;
  }
}

/* Keeps the triangles with three different points, on request each set of points once; corners are input points
 * still. */
static aqr_status keep_triangles(reader* r, bool unique)
{
  aqr_surface* s = r->s;
  size_t n = r->in->number_of_triangles;
  aqr_status status = AQR_OK;
  s->n_faces = 0;
  AQR_REQUIRE(aqr_surface_reserve_faces(r->c, s, n), AQR_OUT_OF_MEMORY);
  AQR_TRY(aqr_parallel(r->c, n, take_triangles, r, 0.15, 0.2));
  if (unique)
    AQR_TRY(drop_duplicates(r));
  for (size_t f = 0; f < n; f++)
    if (s->source[f] != AQR_NONE)
    {
      s->source[s->n_faces] = s->source[f];
      memmove(s->corner + 3 * s->n_faces++, s->corner + 3 * f, 3 * sizeof *s->corner);
    }
  r->report->degenerate_triangles = n - r->report->duplicate_triangles - s->n_faces;
  AQR_REQUIRE(s->n_faces > 0, AQR_DEGENERATE_INPUT);
done:
  return status;
}

/* ---- the box of the points in use ---- */

static void mark_used(void* data, size_t begin, size_t end)
{
  reader* r = data;
  for (size_t i = begin; i < end; i++)
    atomic_store_explicit(&r->used[r->s->corner[i]], true, memory_order_relaxed);
}

static void widen_box(void* data, size_t begin, size_t end)
{
  reader* r = data;
  vec3 low = v3(INFINITY, INFINITY, INFINITY), high = v3(-INFINITY, -INFINITY, -INFINITY);
  for (size_t i = begin; i < end; i++)
  {
    if (!atomic_load_explicit(&r->used[i], memory_order_relaxed))
      continue;
    vec3 p = aqr_input_point(r->in, i);
    low = v3(lesser(low.x, p.x), lesser(low.y, p.y), lesser(low.z, p.z));
    high = v3(greater(high.x, p.x), greater(high.y, p.y), greater(high.z, p.z));
  }
  const double sides[6] = { high.x, high.y, high.z, -low.x, -low.y, -low.z };
  for (unsigned k = 0; k < 6; k++)
    aqr_shared_raise(&r->box[k], sides[k]);
}

/* Finds the centre and the diagonal of the points in use. */
static aqr_status measure_box(reader* r)
{
  aqr_surface* s = r->s;
  size_t n = r->in->number_of_points;
  aqr_status status = AQR_OK;
  r->used = AQR_NEW(r->c, atomic_bool, n);
  AQR_REQUIRE(r->used, AQR_OUT_OF_MEMORY);
  for (size_t i = 0; i < n; i++)
    atomic_init(&r->used[i], false);
  for (unsigned k = 0; k < 6; k++)
    atomic_init(&r->box[k], -INFINITY);
  AQR_TRY(aqr_parallel(r->c, 3 * s->n_faces, mark_used, r, 0.23, 0.25));
  AQR_TRY(aqr_parallel(r->c, n, widen_box, r, 0.25, 0.28));
  /* halves and hypot, so that coordinates near the largest number do not overflow */
  double high[3], low[3];
  for (unsigned k = 0; k < 3; k++)
  {
    high[k] = r->box[k] / 2;
    low[k] = -r->box[k + 3] / 2;
  }
  s->centre = v3(low[0] + high[0], low[1] + high[1], low[2] + high[2]);
  s->diagonal = 2 * hypot(hypot(high[0] - low[0], high[1] - low[1]), high[2] - low[2]);
  AQR_REQUIRE(s->diagonal > 0 && isfinite(s->diagonal), AQR_DEGENERATE_INPUT);
done:
  AQR_DROP(r->c, r->used, n);
  return status;
}

aqr_status aqr_input_weld(aqr_context* c, const aqr_input* input, aqr_report* report, aqr_index** weld)
{
  reader r = { .c = c, .in = input, .report = report };
  aqr_status status = check_input(&r);
  if (status == AQR_OK)
    status = weld_points(&r);
  *weld = r.weld;
  return status;
}

aqr_status aqr_input_take(
  aqr_context* c, const aqr_input* input, aqr_index* weld, bool unique, aqr_surface* s, aqr_report* report)
{
  reader r = { .c = c, .in = input, .s = s, .report = report, .weld = weld };
  aqr_status status = keep_triangles(&r, unique);
  return status == AQR_OK ? measure_box(&r) : status;
}
