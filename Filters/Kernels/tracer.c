/* SPDX-License-Identifier: BSD-3-Clause */
/* Paper 3.1 (local parameterization, unfolding, polar map) and 4.2 (trusted directions). */
#include "tracer.h"

#include <string.h>

enum
{
  most_faces = 400 /* crossed by one straight move, and some more in dense surfaces */
};

static const double vertex_band = 1e-9; /* of an edge: nearer to its end counts as passing through the vertex */
static const double sample_band = 1e-7; /* samples stay this far inside their edge */
static const double parallel = 1e-9;    /* sine of the angle between a ray and an edge that it runs along */
static const double inward = 1e-6;      /* of the way to the middle of the triangle */
static const double turn_error = 0.05;  /* radians a step may be off by its own estimate */

static aqr_complex cx_conj(aqr_complex a)
{
  return cx(a.x, -a.y);
}
static aqr_complex cx_sub(aqr_complex a, aqr_complex b)
{
  return cx(a.x - b.x, a.y - b.y);
}
static aqr_complex cx_madd(aqr_complex a, double s, aqr_complex b)
{
  return cx(a.x + s * b.x, a.y + s * b.y);
}
static double cx_cross(aqr_complex a, aqr_complex b)
{
  return a.x * b.y - a.y * b.x;
}
static double cx_dot(aqr_complex a, aqr_complex b)
{
  return a.x * b.x + a.y * b.y;
}
/* Lays face f into its own plane. */
static void lay_out(const aqr_surface* s, aqr_index f, aqr_complex q[3])
{
  const aqr_index* corner = s->corner + 3 * (size_t)f;
  aqr_lay_flat(aqr_point(s, corner[0]), aqr_point(s, corner[1]), aqr_point(s, corner[2]), q);
}

/* Where the face's own +x axis, along its half-edge 0, lies in the chart. */
static aqr_complex turn_of(const aqr_chart* chart)
{
  return cx_unit(cx_sub(chart->q[1], chart->q[0]));
}

/* Whether the crosses at the corners of the face agree well enough to be blended. */
static bool is_coherent(const aqr_tracer* t)
{
  if (!t->flat)
    return false;
  const aqr_short_rotor* u = t->flat + 3 * (size_t)t->chart.face;
  return aqr_agree(u[0], u[1]) && aqr_agree(u[1], u[2]) && aqr_agree(u[2], u[0]);
}

/* Lays face f, whose own layout is q, so that its corner `k` comes to `at` and its +x axis to the unit number `turn`.
 */
static void place(aqr_index f, const aqr_complex q[3], unsigned k, aqr_complex at, aqr_complex turn, aqr_chart* chart)
{
  chart->face = f;
  for (unsigned i = 0; i < 3; i++)
  {
    aqr_complex d = cx_mul(turn, cx_sub(q[i], q[k]));
    chart->q[i] = cx(at.x + d.x, at.y + d.y);
  }
}

void aqr_chart_lay(const aqr_tracer* t, aqr_index f, aqr_chart* chart)
{
  aqr_complex q[3];
  lay_out(t->surface, f, q);
  place(f, q, 0, cx(0, 0), cx(1, 0), chart);
}

void aqr_chart_unfold(const aqr_tracer* t, const aqr_chart* from, unsigned k, aqr_chart* to)
{
  const aqr_surface* s = t->surface;
  aqr_index twin = aqr_any_twin(s, 3 * from->face + k);
  unsigned i = twin % 3, j = (i + 1) % 3, apex = (i + 2) % 3;
  aqr_complex a = from->q[k], b = from->q[(k + 1) % 3], e = cx_unit(cx_sub(a, b)); /* the twin runs the other way */
  to->face = aqr_face_of(twin);
  const aqr_index* corner = s->corner + 3 * (size_t)to->face;
  vec3 p = aqr_point(s, corner[i]), u = v3_sub(aqr_point(s, corner[j]), p), v = v3_sub(aqr_point(s, corner[apex]), p);
  double length = v3_norm(u), one_over = length > 0 ? 1 / length : 0;
  double along = v3_dot(u, v) * one_over, height = v3_norm(v3_cross(u, v)) * one_over;
  to->q[i] = b;
  to->q[j] = a;
  to->q[apex] = cx(b.x + along * e.x - height * e.y, b.y + along * e.y + height * e.x);
}

/* The plane's axes in space. */
static void axes(const aqr_tracer* t, vec3* ex, vec3* ey)
{
  const aqr_surface* s = t->surface;
  const aqr_index* corner = s->corner + 3 * (size_t)t->chart.face;
  vec3 a = aqr_point(s, corner[0]), ab = v3_sub(aqr_point(s, corner[1]), a), ac = v3_sub(aqr_point(s, corner[2]), a);
  vec3 x = v3_unit(ab), y = v3_cross(v3_unit(v3_cross(ab, ac)), x);
  aqr_complex turn = turn_of(&t->chart);
  *ex = v3_madd(v3_scale(x, turn.x), -turn.y, y);
  *ey = v3_madd(v3_scale(x, turn.y), turn.x, y);
}

void aqr_tracer_init(aqr_tracer* t, const aqr_surface* s, const aqr_field* field)
{
  memset(t, 0, sizeof *t);
  t->surface = s;
  t->flat = field ? field->flat : NULL;
}

void aqr_tracer_free(aqr_context* c, aqr_tracer* t)
{
  AQR_DROP(c, t->samples, t->capacity);
  t->capacity = t->n_samples = 0;
}

bool aqr_tracer_steer(aqr_tracer* t, vec3 direction)
{
  vec3 ex, ey;
  axes(t, &ex, &ey);
  aqr_complex d = cx(v3_dot(direction, ex), v3_dot(direction, ey));
  t->d = cx_unit(d);
  return d.x != 0 || d.y != 0;
}

void aqr_tracer_start(aqr_tracer* t, const aqr_place* at, vec3 direction)
{
  aqr_chart_lay(t, at->face, &t->chart);
  t->x = cx(0, 0);
  for (unsigned i = 0; i < 3; i++)
    t->x = cx_madd(t->x, at->bary[i], t->chart.q[i]);
  aqr_tracer_steer(t, direction);
  t->isotropic = false;
  t->n_samples = 0;
  t->travelled = 0;
  t->lost = false;
}

void aqr_tracer_where(const aqr_tracer* t, vec3* position, vec3* direction)
{
  vec3 ex, ey;
  axes(t, &ex, &ey);
  aqr_complex r = cx_sub(t->x, t->chart.q[0]);
  vec3 p = aqr_point(t->surface, t->surface->corner[3 * t->chart.face]);
  *position = v3_madd(v3_madd(p, r.x, ex), r.y, ey);
  *direction = v3_madd(v3_scale(ex, t->d.x), t->d.y, ey);
}

vec3 aqr_tracer_position(const aqr_tracer* t)
{
  vec3 position, direction;
  aqr_tracer_where(t, &position, &direction);
  return position;
}

vec3 aqr_tracer_direction(const aqr_tracer* t)
{
  vec3 position, direction;
  aqr_tracer_where(t, &position, &direction);
  return direction;
}

/* The cross's branch nearest to d at x: the linear blend of the corners' values (paper 2). */
static aqr_complex nearest_branch(const aqr_tracer* t, aqr_complex d)
{
  const aqr_chart* chart = &t->chart;
  const aqr_short_rotor* cross = t->flat + 3 * (size_t)chart->face;
  aqr_complex x = t->x;
  double w[3], sum = 0;
  for (unsigned i = 0; i < 3; i++)
  {
    aqr_complex a = chart->q[(i + 1) % 3], b = chart->q[(i + 2) % 3];
    w[i] = greater(0, cx_cross(cx_sub(b, a), cx_sub(x, a)));
    sum += w[i];
  }
  aqr_complex u = cx(0, 0);
  for (unsigned i = 0; i < 3; i++)
    u = cx_madd(u, sum > 0 ? w[i] : 1, cx((double)cross[i].x, (double)cross[i].y));
  aqr_complex off = cx_unit(cx_mul(u, cx_conj(cx_fourth(cx_mul(d, cx_conj(turn_of(chart)))))));
  return cx_unit(cx_mul(d, cx_fourth_root(off)));
}

bool aqr_tracer_align(aqr_tracer* t)
{
  t->isotropic = !is_coherent(t);
  if (!t->isotropic)
    t->d = nearest_branch(t, t->d);
  return !t->isotropic;
}

/* The angle of h's face at the start of h. */
static double corner_angle(const aqr_surface* s, aqr_index h)
{
  vec3 o = aqr_point(s, aqr_from(s, h));
  vec3 a = v3_sub(aqr_point(s, aqr_to(s, h)), o), b = v3_sub(aqr_point(s, aqr_from(s, aqr_prev(h))), o);
  return atan2(v3_norm(v3_cross(a, b)), v3_dot(a, b));
}

bool aqr_polar_exit(const aqr_surface* s, aqr_index arrival, double angle, aqr_index* exit, double* exit_angle)
{
  double total = 0;
  aqr_index h = arrival;
  do
  {
    total += corner_angle(s, h);
    h = aqr_next_around(s, h);
    if (h == AQR_NONE)
      return false;
  } while (h != arrival);
  double way = fmod(angle + total / 2, total); /* half of the full turn, in the vertex's own angles */
  for (;;)
  {
    double a = corner_angle(s, h);
    aqr_index next = aqr_next_around(s, h);
    if (way < a || next == arrival)
    {
      *exit = h;
      *exit_angle = fmin(way, a);
      return true;
    }
    way -= a;
    h = next;
  }
}

/* Leaves a sample where the point passes over half-edge h of the face it leaves. A crossing of the
 * edge that the newest sample lies on takes that sample back: the line only touched the face in
 * between. */
static aqr_status record(aqr_context* c, aqr_tracer* t, aqr_index h, double at, aqr_index into)
{
  const aqr_surface* s = t->surface;
  aqr_index edge = aqr_edge_of(s, h);
  if (t->n_samples && t->samples[t->n_samples - 1].edge == edge)
  {
    t->n_samples--;
    return AQR_OK;
  }
  if (!AQR_RESERVE(c, t->samples, t->capacity, t->n_samples + 1))
    return AQR_OUT_OF_MEMORY;
  at = lesser(1 - sample_band, greater(sample_band, at));
  if (edge != h)
    at = 1 - at;
  t->samples[t->n_samples++] =
    (aqr_sample){ .p = aqr_edge_point(s, edge, at), .t = at, .edge = edge, .face = into, .isotropic = t->isotropic };
  return AQR_OK;
}

/* Passes exactly through corner k of the chart's face (paper 3.1, case 3): the samples go around
 * the vertex on the shorter side, and the new face is turned so that the direction keeps its
 * coordinates. *vertex tells which corner of the new face the point stands on. */
static aqr_status pass_vertex(
  aqr_context* c, aqr_tracer* t, unsigned k, aqr_complex d, bool recording, aqr_advance* result, unsigned* vertex)
{
  const aqr_surface* s = t->surface;
  aqr_index arrival = 3 * t->chart.face + k, exit;
  aqr_complex at = t->chart.q[k], e = cx_sub(t->chart.q[(k + 1) % 3], at), back = cx(-d.x, -d.y);
  double exit_angle, angle = fmax(0, atan2(cx_cross(e, back), cx_dot(e, back)));
  if (!aqr_polar_exit(s, arrival, angle, &exit, &exit_angle))
  {
    *result = AQR_AT_BORDER;
    return AQR_OK;
  }
  unsigned ccw = 0, valence = 0;
  aqr_index h = arrival;
  do
  {
    if (h == exit)
      ccw = valence;
    valence++;
    h = aqr_next_around(s, h);
  } while (h != arrival);
  aqr_status status = AQR_OK;
  bool left = 2 * ccw <= valence;
  for (unsigned i = left ? ccw : valence - ccw; recording && i > 0 && status == AQR_OK; i--)
  {
    /* leave the face of h over its edge at the vertex: the previous half-edge to the left, h itself
     * to the right */
    aqr_index over = left ? aqr_prev(h) : h;
    aqr_index into = aqr_twin(s, over);
    status = record(c, t, over, left ? 1 : 0, aqr_face_of(into));
    h = left ? into : aqr_next(into);
  }
  aqr_complex q[3];
  unsigned from = exit % 3;
  lay_out(s, aqr_face_of(exit), q);
  aqr_complex out = cx_mul(cx_unit(cx_sub(q[(from + 1) % 3], q[from])), cx(cos(exit_angle), sin(exit_angle)));
  place(aqr_face_of(exit), q, from, at, cx_mul(d, cx_conj(out)), &t->chart);
  t->x = at;
  *vertex = from;
  *result = AQR_INSIDE;
  return status;
}

/* The edge through which a ray from x along d leaves the chart's triangle: its start lies to the
 * right of the ray, its end to the left. A point on the border of the triangle may see its own
 * edge: of those that qualify the one farthest ahead counts. 3 where rounding leaves none. */
static unsigned exit_edge(const aqr_chart* chart, aqr_complex x, aqr_complex d, double side[3])
{
  for (unsigned i = 0; i < 3; i++)
    side[i] = cx_cross(d, cx_sub(chart->q[i], x));
  unsigned best = 3;
  double ahead = 0;
  for (unsigned i = 0; i < 3; i++)
  {
    unsigned j = (i + 1) % 3;
    if (side[i] <= 0 && side[j] >= 0 && side[j] > side[i])
    {
      double at = side[i] / (side[i] - side[j]);
      aqr_complex p = cx_madd(chart->q[i], at, cx_sub(chart->q[j], chart->q[i]));
      double reach = cx_dot(d, cx_sub(p, x));
      if (best == 3 || reach > ahead)
      {
        best = i;
        ahead = reach;
      }
    }
  }
  return best;
}

/* A ray from a corner into the face leaves over the edge opposite. Asked by its sides it might, along one of the
 * corner's own edges, pass the same vertex again. */
static unsigned opposite_edge(const aqr_chart* chart, unsigned corner, aqr_complex d, double* at)
{
  unsigned k = (corner + 1) % 3;
  double a = cx_cross(d, cx_sub(chart->q[k], chart->q[corner]));
  double b = cx_cross(d, cx_sub(chart->q[(k + 1) % 3], chart->q[corner]));
  *at = b > a ? lesser(1, greater(0, a / (a - b))) : 0.5;
  return k;
}

static aqr_complex middle(const aqr_chart* chart)
{
  const aqr_complex* q = chart->q;
  return cx((q[0].x + q[1].x + q[2].x) / 3, (q[0].y + q[1].y + q[2].y) / 3);
}

static unsigned foremost_edge(const aqr_chart* chart, aqr_complex d)
{
  unsigned best = 0;
  double most = -INFINITY;
  for (unsigned i = 0; i < 3; i++)
  {
    aqr_complex a = chart->q[i], b = chart->q[(i + 1) % 3];
    double ahead = cx_dot(d, cx(a.x + b.x, a.y + b.y));
    if (ahead > most)
    {
      most = ahead;
      best = i;
    }
  }
  return best;
}

/* Where the way out of a face is. */
typedef struct way_out
{
  unsigned k; /* edge of the chart's face */
  double at;  /* fraction of it */
  aqr_complex p;
  double reach; /* from the point */
} way_out;

/* vertex: corner that the point stands on, 3 for none. */
static way_out find_way_out(aqr_tracer* t, aqr_complex d, unsigned vertex)
{
  const aqr_chart* chart = &t->chart;
  way_out w = { .at = 0.5 };
  double side[3];
  w.k = vertex < 3 ? opposite_edge(chart, vertex, d, &w.at) : exit_edge(chart, t->x, d, side);
  if (w.k == 3) /* beside its triangle by rounding: a little towards the middle it sees an edge again */
  {
    aqr_complex to = cx_sub(middle(chart), t->x);
    t->x = cx_madd(t->x, inward, to);
    w.k = exit_edge(chart, t->x, d, side);
  }
  if (w.k == 3) /* a triangle without area: over the middle of the edge that lies farthest ahead */
    w.k = foremost_edge(chart, d);
  else if (vertex == 3)
    w.at = side[w.k] / (side[w.k] - side[(w.k + 1) % 3]);
  aqr_complex q = chart->q[w.k], e = cx_sub(chart->q[(w.k + 1) % 3], q);
  w.p = cx_madd(q, w.at, e);
  w.reach = cx_dot(d, cx_sub(w.p, t->x));
  if (w.reach < 0 && cx_cross(d, cx_unit(e)) < parallel)
  {
    /* along the very edge it stands on, on its outer side by rounding: over it where it stands */
    w.at = lesser(1, greater(0, cx_dot(cx_sub(t->x, q), e) / cx_dot(e, e)));
    w.p = t->x;
  }
  w.reach = greater(0, w.reach);
  return w;
}

/* Over the edge into the face beside it, unless there is none. */
static aqr_status pass_edge(aqr_context* c, aqr_tracer* t, const way_out* w, bool recording, aqr_advance* result)
{
  aqr_index h = 3 * t->chart.face + w->k, twin = aqr_twin(t->surface, h);
  *result = twin == AQR_NONE ? AQR_AT_BORDER : AQR_INSIDE;
  if (recording)
  {
    aqr_status status = record(c, t, h, w->at, twin == AQR_NONE ? t->chart.face : aqr_face_of(twin));
    if (status != AQR_OK)
      return status;
  }
  if (twin != AQR_NONE)
  {
    aqr_chart next;
    aqr_chart_unfold(t, &t->chart, w->k, &next);
    t->chart = next;
  }
  return AQR_OK;
}

/* Moves the point straight along d. The chart, and with it the meaning of d, stays unfolded into
 * one plane. */
static aqr_status move(aqr_context* c, aqr_tracer* t, aqr_complex d, double length, bool recording, aqr_advance* result)
{
  unsigned vertex = 3; /* corner that the point stands on, just passed; 3: none */
  aqr_status status = AQR_OK;
  *result = AQR_INSIDE;
  const int most = most_faces + 4 * (int)sqrt((double)t->surface->n_faces);
  for (int i = 0; i < most; i++)
  {
    t->crossed++;
    way_out w = find_way_out(t, d, vertex);
    vertex = 3;
    if (recording)
      t->travelled += lesser(length, w.reach);
    if (w.reach >= length)
    {
      t->x = cx_madd(t->x, length, d);
      return AQR_OK;
    }
    length -= w.reach;
    t->x = w.p;
    if (w.at < vertex_band || w.at > 1 - vertex_band)
    {
      AQR_TRY(pass_vertex(c, t, w.at < vertex_band ? w.k : (w.k + 1) % 3, d, recording, result, &vertex));
      if (*result == AQR_INSIDE)
        continue;
    }
    AQR_TRY(pass_edge(c, t, &w, recording, result));
    if (*result == AQR_AT_BORDER)
      return AQR_OK;
  }
  t->lost = true;
done:
  return status;
}

aqr_status aqr_tracer_straight(aqr_context* c, aqr_tracer* t, double length, aqr_advance* result)
{
  return move(c, t, t->d, length, true, result);
}

/* The field's direction at x + length * d, nearest to d; d itself where the field gives none. The
 * context is restored. */
static aqr_status predict(aqr_context* c, aqr_tracer* t, aqr_complex d, double length, aqr_complex* direction)
{
  aqr_chart chart = t->chart;
  aqr_complex x = t->x;
  aqr_advance result;
  aqr_status status = move(c, t, d, length, false, &result);
  *direction = is_coherent(t) ? nearest_branch(t, d) : d;
  t->chart = chart;
  t->x = x;
  return status;
}

aqr_status aqr_tracer_step(
  aqr_context* c, aqr_tracer* t, double* step, double shortest, double longest, aqr_advance* result)
{
  double h = lesser(longest, greater(shortest, *step));
  aqr_status status = AQR_OK;
  if (!aqr_tracer_align(t))
  {
    *step = h;
    return move(c, t, t->d, lesser(h, 2 * shortest), true, result);
  }
  aqr_complex k1 = t->d, k2, k3, k4, mean;
  for (;;)
  {
    AQR_TRY(predict(c, t, k1, h / 2, &k2));
    AQR_TRY(predict(c, t, k2, h / 2, &k3));
    AQR_TRY(predict(c, t, k3, h, &k4));
    mean = cx_unit(cx(k1.x + 2 * k2.x + 2 * k3.x + k4.x, k1.y + 2 * k2.y + 2 * k3.y + k4.y));
    double error = fabs(cx_cross(mean, k2)) + fabs(cx_cross(k2, k3));
    if (error <= turn_error || h <= shortest)
    {
      *step = error < turn_error / 4 ? lesser(2 * h, longest) : h;
      break;
    }
    h = greater(h / 2, shortest);
  }
  t->d = mean;
  AQR_TRY(move(c, t, mean, h, true, result));
  /* arrive with the direction the field has there, so that stops and branches are judged by it */
  if (is_coherent(t))
    t->d = nearest_branch(t, k4);
done:
  return status;
}
