/* SPDX-License-Identifier: BSD-3-Clause */
#include "test.h"

#include "shapes.h"
#include "triangulation.h"

enum
{
  most = 400
};

typedef struct drawing
{
  size_t n;
  double xy[2 * most];
  aqr_index name[most];
  aqr_triangle triangles[most];
} drawing;

static void add(drawing* d, double x, double y, aqr_index name)
{
  d->xy[2 * d->n] = x;
  d->xy[2 * d->n + 1] = y;
  d->name[d->n++] = name;
}

static double turn_of(const drawing* d, aqr_index a, aqr_index b, aqr_index c)
{
  const double *p = d->xy + 2 * a, *q = d->xy + 2 * b, *r = d->xy + 2 * c;
  return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
}

static double area_of(const drawing* d)
{
  double sum = 0;
  for (aqr_index i = 1; i + 1 < d->n; i++)
    sum += turn_of(d, 0, i, i + 1);
  return sum;
}

/* A star around 0, or a hole in one: clockwise, and of names of its own. */
static void add_star(
  drawing* d, size_t n, double inner, double outer, double x, double y, bool clockwise, unsigned* state)
{
  aqr_index first = (aqr_index)d->n;
  for (size_t i = 0; i < n; i++)
  {
    double r = inner + (outer - inner) * shape_random(state), a = shape_turn * (double)i / (double)n;
    add(d, x + r * cos(a), y + (clockwise ? -r : r) * sin(a), first + (aqr_index)i);
  }
}

static void triangulate(drawing* d)
{
  aqr_context c = { 0 };
  const aqr_outline o = { d->n, d->xy, d->name };
  CHECK(aqr_triangulate(&c, &o, 0, d->triangles) == AQR_OK);
  CHECK(c.bytes == 0);
}

/* Triangles beside each other say so of each other, and have two corners in common. */
static bool hangs_together(const drawing* d)
{
  size_t sides = 0;
  for (aqr_index t = 0; t + 2 < d->n; t++)
    for (unsigned i = 0; i < 3; i++)
    {
      const aqr_triangle *a = &d->triangles[t], *b;
      aqr_index from = a->corner[i], to = a->corner[(i + 1) % 3];
      if (a->beside[i] == AQR_NONE)
      {
        sides++;
        if (to != (from + 1) % d->n)
          return false;
        continue;
      }
      b = &d->triangles[a->beside[i]];
      unsigned j = b->beside[0] == t ? 0 : b->beside[1] == t ? 1 : 2;
      if (b->beside[j] != t || b->corner[j] != to || b->corner[(j + 1) % 3] != from)
        return false;
    }
  return sides == d->n;
}

static bool fills(const drawing* d)
{
  double sum = 0, area = area_of(d);
  for (aqr_index t = 0; t + 2 < d->n; t++)
  {
    const aqr_index* k = d->triangles[t].corner;
    double a = turn_of(d, k[0], k[1], k[2]);
    if (a < -1e-12 * area)
      return false;
    sum += a;
  }
  return fabs(sum - area) < 1e-9 * area;
}

AQR_TEST(triangles_reach_out_of_a_star)
{
  unsigned state = 1;
  for (size_t n = 3; n <= 300; n += 1 + n / 8)
    for (unsigned k = 0; k < 20; k++)
    {
      drawing d = { 0 };
      add_star(&d, n, 0.1 + 0.04 * k, 1, 3, -2, false, &state);
      triangulate(&d);
      CHECK(hangs_together(&d) && fills(&d));
    }
}

/* The corner after the bridge's last comes again where the bridge ends. */
AQR_TEST(a_hole_with_a_bridge_is_filled)
{
  unsigned state = 1;
  for (unsigned k = 0; k < 100; k++)
  {
    drawing d = { 0 };
    add_star(&d, 20, 2, 3, 0, 0, false, &state);
    add(&d, d.xy[0], d.xy[1], 0);
    aqr_index hole = (aqr_index)d.n;
    add_star(&d, 5 + k % 20, 0.5, 1.5, 0, 0, true, &state);
    add(&d, d.xy[2 * hole], d.xy[2 * hole + 1], hole);
    triangulate(&d);
    CHECK(hangs_together(&d) && fills(&d));
  }
}

/* Corners in a row on straight sides, which are no ears, and on lines through others. */
AQR_TEST(corners_on_a_line_leave_something_unfilled)
{
  drawing d = { 0 };
  const int steps = 12;
  for (int side = 0; side < 4; side++)
    for (int i = 0; i < steps; i++)
    {
      double t = (double)i / steps;
      const double x[4] = { t, 1, 1 - t, 0 }, y[4] = { 0, t, 1, 1 - t };
      add(&d, x[side], y[side], (aqr_index)d.n);
    }
  triangulate(&d);
  CHECK(hangs_together(&d) && fills(&d));
}

/* Of two triangles that make a convex quad, the diagonal is the one with the smaller angles before it. */
AQR_TEST(a_needle_is_cut_where_a_fat_triangle_could_be)
{
  unsigned state = 1;
  drawing d = { 0 };
  add_star(&d, 120, 0.7, 1, 0, 0, false, &state);
  triangulate(&d);
  for (aqr_index t = 0; t + 2 < d.n; t++)
    for (unsigned i = 0; i < 3; i++)
    {
      const aqr_triangle* a = &d.triangles[t];
      if (a->beside[i] == AQR_NONE)
        continue;
      const aqr_triangle* b = &d.triangles[a->beside[i]];
      unsigned j = b->beside[0] == t ? 0 : b->beside[1] == t ? 1 : 2;
      aqr_index p = a->corner[i], q = a->corner[(i + 1) % 3],
                far[2] = { a->corner[(i + 2) % 3], b->corner[(j + 2) % 3] };
      double angle = 0;
      for (unsigned k = 0; k < 2; k++)
      {
        const double *o = d.xy + 2 * far[k], *u = d.xy + 2 * p, *v = d.xy + 2 * q;
        angle += atan2(fabs(turn_of(&d, far[k], p, q)), (u[0] - o[0]) * (v[0] - o[0]) + (u[1] - o[1]) * (v[1] - o[1]));
      }
      bool convex = turn_of(&d, far[1], far[0], p) > 0 && turn_of(&d, far[0], far[1], q) > 0;
      CHECK(!convex || angle < shape_turn / 2 + 1e-6);
    }
}

AQR_TEST(an_outline_that_crosses_itself_is_never_done_with)
{
  unsigned state = 1;
  for (size_t n = 4; n < 200; n += 1 + n / 4)
    for (unsigned k = 0; k < 10; k++)
    {
      drawing d = { 0 };
      for (size_t i = 0; i < n; i++) /* some at one place, with one name or with two */
      {
        double x = floor(8 * shape_random(&state)), y = floor(8 * shape_random(&state));
        add(&d, x, y, k % 2 ? (aqr_index)(8 * x + y) : (aqr_index)i);
      }
      triangulate(&d);
      CHECK(hangs_together(&d));
    }
}

static int stop(void* user, double fraction, const char* stage)
{
  (void)user;
  (void)fraction;
  (void)stage;
  return 0;
}

AQR_TEST(a_triangulation_cannot_be_cancelled)
{
  unsigned state = 1;
  drawing d = { 0 };
  aqr_context c = { 0 };
  c.hooks.progress = stop;
  c.end = 1;
  add_star(&d, 300, 0.1, 1, 0, 0, false, &state);
  const aqr_outline o = { d.n, d.xy, d.name };
  CHECK(aqr_triangulate(&c, &o, 0, d.triangles) == AQR_CANCELLED);
  CHECK(c.bytes == 0);
}

AQR_TEST_MAIN
