/* SPDX-License-Identifier: BSD-3-Clause */
/* Normal-cycle curvature tensors averaged over balls on the surface (paper section 2).
 *
 * A ball is summed over the points inside it: each carries half of its edges and a third of its
 * faces, which leaves only the edges and faces across the sphere to be set right one by one. Where
 * balls hold many points, close points' balls are all but the same, so only some points, a share of
 * the radius apart, get their own and the others a blend: the work is linear for any radius. */
#include "field.h"

#include <string.h>

enum
{
  slots = 16,          /* balls grown side by side, at most */
  first_queue = 1024,  /* points a slot has room for until a ball asks for more */
  batch_work = 1 << 18 /* points to visit between two looks at the progress hook */
};

static const double least_edges = 2; /* in mean lengths of the edges around the point */
static const double least_roots =
  3.5; /* in roots of the area around it: less where edges are long and the triangles thin */
static const double full_ball = 6; /* areas of a point in a squared radius: some 20 points inside */
static const double spacing = 0.4; /* between shared balls, in radii: every point is this near to one */
static const double reach = 0.65;  /* up to here a shared ball is blended in, in radii */

typedef struct lump /* eight numbers, a cache line */
{
  double area;    /* a third of the faces around the point */
  double sum[6];  /* half of beta |e| ebar ebar^T of its edges */
  double longest; /* of its edges */
} lump;

typedef struct slot
{
  aqr_index* queue;
  size_t room;
  uint8_t* inside;         /* a bit per point, all clear between balls */
  size_t begin, next, end; /* of the centres; next < end when a ball did not fit into the queue, or its disk */
  size_t visited;
  aqr_index* near; /* for each centre the number of points that its ball is blended into, and these */
  size_t n_near, near_room;
} slot;

typedef enum point_state
{
  uncovered,
  blended,
  own_ball,
  shared_ball
} point_state;

typedef struct job
{
  const aqr_surface* s;
  double radius;
  double* area; /* per face */
  double* beta; /* per half-edge: signed dihedral angle, 0 at borders and seams */
  lump* lumps;
  double* length;     /* per point: mean of its edges */
  aqr_index* centres; /* points with a ball of their own */
  size_t n_centres;
  uint8_t* covered; /* per point: a point_state */
  double* weight;   /* per point: of the balls blended into t and noise */
  size_t inside_bytes;
  slot slot[slots];
  float* t;
  float* noise;
  double* normal;
} job;

/* The angle at which two faces meet over an edge, positive where the edge is convex. The half-edge
 * with the lower number writes both sides. */
static void measure_angles(void* data, size_t begin, size_t end)
{
  job* j = data;
  for (aqr_index h = (aqr_index)begin; h < end; h++)
  {
    aqr_index w = aqr_twin(j->s, h);
    if (w == AQR_NONE)
      j->beta[h] = 0;
    if (w == AQR_NONE || w < h)
      continue;
    vec3 n = aqr_face_cross(j->s, aqr_face_of(h)), m = aqr_face_cross(j->s, aqr_face_of(w));
    vec3 e = v3_unit(aqr_edge_vector(j->s, h));
    bool flat = !(v3_norm2(n) > 0) || !(v3_norm2(m) > 0);
    j->beta[h] = j->beta[w] = flat ? 0 : atan2(v3_dot(e, v3_cross(n, m)), v3_dot(n, m));
  }
}

static void measure_areas(void* data, size_t begin, size_t end)
{
  job* j = data;
  for (aqr_index f = (aqr_index)begin; f < end; f++)
    j->area[f] = v3_norm(aqr_face_cross(j->s, f)) / 2;
}

static void add_edge(double* sum, vec3 e, double weight)
{
  sum[0] += weight * e.x * e.x;
  sum[1] += weight * e.y * e.y;
  sum[2] += weight * e.z * e.z;
  sum[3] += weight * e.x * e.y;
  sum[4] += weight * e.x * e.z;
  sum[5] += weight * e.y * e.z;
}

/* What a point carries, and its normal, from the faces of its sector. */
static void lump_points(void* data, size_t begin, size_t end)
{
  job* j = data;
  const aqr_surface* s = j->s;
  for (aqr_index v = (aqr_index)begin; v < end; v++)
  {
    lump p = { .area = 0 };
    vec3 u = aqr_point(s, v);
    vec3 normal = v3(0, 0, 0), any = v3(0, 0, 0);
    double length = 0;
    size_t n = 0;
    for (aqr_index first = s->fan[v], h = first; h != AQR_NONE;)
    {
      vec3 cross = aqr_face_cross(s, aqr_face_of(h));
      vec3 e = v3_sub(aqr_point(s, aqr_to(s, h)), u);
      double l = v3_norm(e);
      normal = v3_add(normal, cross);
      if (!(v3_norm2(any) > 0))
        any = cross;
      p.area += j->area[aqr_face_of(h)] / 3;
      if (l > 0)
      {
        add_edge(p.sum, e, j->beta[h] / (2 * l));
        length += l;
        p.longest = greater(p.longest, l);
        n++;
      }
      h = aqr_next_around(s, h);
      if (h == first)
        break;
    }
    j->length[v] = n ? length / (double)n : 0;
    j->lumps[v] = p;
    v3_store(j->normal + 3 * (size_t)v, v3_norm2(any) > 0 ? v3_unit(v3_norm2(normal) > 0 ? normal : any) : v3(0, 0, 1));
  }
}

static double least_radius_at(const job* j, aqr_index v)
{
  return lesser(least_edges * j->length[v], least_roots * sqrt(j->lumps[v].area));
}

static double radius_at(const job* j, aqr_index v)
{
  return greater(j->radius, least_radius_at(j, v));
}

/* Of balls that hold many points neighbours may share one. */
static bool shares(const job* j, aqr_index v)
{
  return j->radius > least_radius_at(j, v) && j->radius * j->radius > full_ball * j->lumps[v].area;
}

/* Whether a ball of this radius may stand in for that of v: not where it averages over far more. */
static bool may_stand_in(const job* j, double radius, aqr_index v)
{
  return radius < 1.5 * radius_at(j, v);
}

typedef struct ball
{
  vec3 centre;
  double radius, radius2;
  double area;
  double sum[6];
  double sizes; /* of what the points inside carry, added up */
  size_t points;
} ball;

static bool holds(const ball* b, vec3 p)
{
  return v3_norm2(v3_sub(p, b->centre)) < b->radius2;
}

/* How much of the edge from p inside along e lies inside, as a fraction, when its end does not. */
static double share_inside(const ball* b, vec3 p, vec3 e)
{
  vec3 d = v3_sub(p, b->centre);
  double a = v3_norm2(e), half = v3_dot(d, e);
  double t = (sqrt(greater(0, half * half + a * (b->radius2 - v3_norm2(d)))) - half) / a;
  return t > 0 ? lesser(1, t) : 0;
}

/* The piece of an edge between two points outside that the sphere cuts off. */
static double length_between(const ball* b, vec3 p, vec3 e)
{
  vec3 d = v3_sub(p, b->centre);
  double a = v3_norm2(e), half = v3_dot(d, e);
  if (!(half < 0) || !(half > -a))
    return 0;
  double root = half * half + a * (b->radius2 - v3_norm2(d));
  return root > 0 ? 2 * sqrt(root / a) : 0;
}

/* The part of a disk beyond its chord from p to q: the first terms of its series, a hundredth off
 * where the chord is as long as the radius. */
static double segment(const ball* b, vec3 p, vec3 q)
{
  double x2 = v3_norm2(v3_sub(p, q)) / (4 * b->radius2);
  return b->radius2 * x2 * sqrt(x2) * (2. / 3 + x2 / 5);
}

/* The edge opposite to h, both of whose ends are outside, once of its two faces. */
static void add_opposite(const job* j, ball* b, aqr_index h)
{
  const aqr_surface* s = j->s;
  aqr_index g = aqr_next(h), w = aqr_twin(s, g);
  if (w == AQR_NONE || j->beta[g] == 0)
    return;
  vec3 p = aqr_point(s, aqr_from(s, g)), e = v3_sub(aqr_point(s, aqr_to(s, g)), p);
  double l = length_between(b, p, e);
  if (l > 0 && (g < w || !holds(b, aqr_point(s, aqr_from(s, aqr_prev(w))))))
    add_edge(b->sum, e, j->beta[g] * l / v3_norm2(e));
}

typedef struct spoke /* an edge from a point inside */
{
  vec3 end;
  bool inside;  /* the end, that is */
  double share; /* of the edge that is inside */
} spoke;

static spoke spoke_to(const ball* b, vec3 u, vec3 end)
{
  bool inside = holds(b, end);
  return (spoke){ end, inside, inside ? 1 : share_inside(b, u, v3_sub(end, u)) };
}

/* Sets right what the lumps of the corners inside get wrong about the face of h, which starts inside
 * at u and leads along p. A face with two corners inside is left to the first of them. */
static void clip_face(const job* j, ball* b, aqr_index h, vec3 u, const spoke* p, const spoke* q)
{
  double area = j->area[aqr_face_of(h)], inside;
  if (!(area > 0) || q->inside)
    return;
  vec3 end = v3_madd(u, q->share, v3_sub(q->end, u));
  if (p->inside)
  {
    vec3 g = v3_sub(q->end, p->end);
    double r = share_inside(b, p->end, g);
    inside = area * (1 - (1 - q->share) * (1 - r)) + segment(b, end, v3_madd(p->end, r, g));
  }
  else
  {
    inside = area * p->share * q->share + segment(b, end, v3_madd(u, p->share, v3_sub(p->end, u)));
    add_opposite(j, b, h);
  }
  b->area += lesser(area, inside) - area * (p->inside ? 2. / 3 : 1. / 3);
}

static bool visit(slot* k, size_t* n, aqr_index v)
{
  uint8_t bit = (uint8_t)(1u << (v & 7));
  if (k->inside[v >> 3] & bit)
    return true;
  if (*n == k->room)
    return false;
  k->inside[v >> 3] = (uint8_t)(k->inside[v >> 3] | bit);
  k->queue[(*n)++] = v;
  return true;
}

/* Visits the points around u, all of which are inside. */
static bool visit_all(const job* j, slot* k, size_t* n, aqr_index first)
{
  const aqr_surface* s = j->s;
  bool fits = visit(k, n, aqr_to(s, first));
  for (aqr_index h = first; fits;)
  {
    fits = visit(k, n, aqr_from(s, aqr_prev(h)));
    h = aqr_next_around(s, h);
    if (h == AQR_NONE || h == first)
      break;
  }
  return fits;
}

/* Visits those of the points around u that are inside and sets right the edges and faces that lead
 * out. */
static bool visit_some(const job* j, slot* k, size_t* n, ball* b, aqr_index first)
{
  const aqr_surface* s = j->s;
  vec3 u = aqr_point(s, aqr_from(s, first));
  spoke p = spoke_to(b, u, aqr_point(s, aqr_to(s, first)));
  bool fits = !p.inside || visit(k, n, aqr_to(s, first));
  for (aqr_index h = first; fits;)
  {
    aqr_index to = aqr_from(s, aqr_prev(h));
    spoke q = spoke_to(b, u, aqr_point(s, to));
    fits = !q.inside || visit(k, n, to);
    if (!p.inside && j->beta[h] != 0)
    {
      vec3 e = v3_sub(p.end, u);
      add_edge(b->sum, e, j->beta[h] * (p.share - 0.5) / v3_norm(e));
    }
    if (!p.inside || !q.inside)
      clip_face(j, b, h, u, &p, &q);
    h = aqr_next_around(s, h);
    if (h == AQR_NONE || h == first)
      break;
    p = q;
  }
  return fits;
}

static double size2(const double* t)
{
  return t[0] * t[0] + t[1] * t[1] + t[2] * t[2] + 2 * (t[3] * t[3] + t[4] * t[4] + t[5] * t[5]);
}

/* Grows the ball from its centre over edges; false when it does not fit into the queue. */
static bool grow(const job* j, slot* k, aqr_index centre, ball* b)
{
  size_t n = 0;
  bool fits = visit(k, &n, centre);
  for (size_t i = 0; fits && i < n; i++)
  {
    const lump* u = &j->lumps[k->queue[i]];
    b->area += u->area;
    for (int c = 0; c < 6; c++)
      b->sum[c] += u->sum[c];
    b->sizes += sqrt(size2(u->sum));
    aqr_index first = j->s->fan[k->queue[i]];
    double clear = b->radius - u->longest;
    if (clear > 0 && v3_norm2(v3_sub(aqr_point(j->s, k->queue[i]), b->centre)) < clear * clear)
      fits = first == AQR_NONE || visit_all(j, k, &n, first);
    else
      fits = first == AQR_NONE || visit_some(j, k, &n, b, first);
  }
  for (size_t i = 0; i < n; i++)
    k->inside[k->queue[i] >> 3] = 0;
  k->visited += n;
  b->points = n;
  return fits;
}

static void store_mean(float* t, const ball* b)
{
  bool finite = b->area > 0;
  for (int c = 0; c < 6; c++)
  {
    t[c] = finite ? (float)(b->sum[c] / b->area) : 0;
    finite = finite && isfinite(t[c]);
  }
  if (!finite)
    memset(t, 0, 6 * sizeof *t);
}

/* The curvature that the ball would show were its surface flat and its points off by noise. Moving a point inside bends
 * edges one way and the others back, so that of n points only those near the sphere count, some sqrt(n), each with the
 * size of what a point carries: n^(1/4) of the n sizes in the sum. What the sum does show is no noise. */
static float noise_of(const ball* b)
{
  double root = sqrt((double)b->points), unseen = b->sizes * b->sizes - size2(b->sum);
  double noise = unseen > 0 && b->area > 0 ? sqrt(unseen) / (b->area * root * sqrt(root)) : 0;
  return isfinite((float)noise) ? (float)noise : 0;
}

/* The points within a distance of v, reached over edges, into the queue; false when they do not fit. */
static bool disk(const job* j, slot* k, aqr_index v, double radius, size_t* n)
{
  const aqr_surface* s = j->s;
  ball b = { .centre = aqr_point(j->s, v), .radius2 = radius * radius };
  *n = 0;
  bool fits = visit(k, n, v);
  for (size_t i = 0; fits && i < *n; i++)
    for (aqr_index first = s->fan[k->queue[i]], h = first; fits && h != AQR_NONE;)
    {
      aqr_index next = aqr_next_around(s, h), to = aqr_to(s, h), last = aqr_from(s, aqr_prev(h));
      if (holds(&b, aqr_point(s, to)))
        fits = visit(k, n, to);
      if (fits && next == AQR_NONE && holds(&b, aqr_point(s, last)))
        fits = visit(k, n, last);
      h = next;
      if (h == first)
        break;
    }
  for (size_t i = 0; i < *n; i++)
    k->inside[k->queue[i] >> 3] = 0;
  return fits;
}

/* Lists the points that have no ball and are near to that of v, if it is a shared one. */
static bool list_near(const job* j, slot* k, aqr_index v)
{
  double radius = radius_at(j, v);
  size_t n = 0, kept = 0;
  if (j->covered[v] == shared_ball && !disk(j, k, v, reach * radius, &n))
    return false;
  if (k->near_room - k->n_near < n + 1)
    return false;
  aqr_index* near = k->near + k->n_near;
  for (size_t i = 0; i < n; i++)
    if (j->covered[k->queue[i]] == blended && may_stand_in(j, radius, k->queue[i]))
      near[++kept] = k->queue[i];
  near[0] = (aqr_index)kept;
  k->n_near += 1 + kept;
  return true;
}

static void run_slots(void* data, size_t begin, size_t end)
{
  job* j = data;
  for (size_t i = begin; i < end; i++)
    for (slot* k = &j->slot[i]; k->next < k->end; k->next++)
    {
      aqr_index v = j->centres[k->next];
      double r = radius_at(j, v);
      ball b = { .centre = aqr_point(j->s, v), .radius = r, .radius2 = r * r };
      if (!grow(j, k, v, &b))
        break;
      store_mean(j->t + 6 * (size_t)v, &b);
      j->noise[v] = noise_of(&b);
      if (!list_near(j, k, v))
        break;
    }
}

/* Lets every slot work off its range, giving those that run out of queue more of it: a queue
 * doubles until it holds all points, so this ends. */
static aqr_status run_batch(aqr_context* c, job* j)
{
  for (bool again = true; again;)
  {
    if (c->hooks.parallel_for)
      c->hooks.parallel_for(c->hooks.user, slots, 1, run_slots, j);
    else
      run_slots(j, 0, slots);
    again = false;
    for (slot* k = j->slot; k < j->slot + slots; k++)
      if (k->next < k->end)
      {
        again = true;
        if (!AQR_RESERVE(c, k->queue, k->room, 2 * k->room) || !AQR_RESERVE(c, k->near, k->near_room, 2 * k->near_room))
          return AQR_OUT_OF_MEMORY;
      }
  }
  return AQR_OK;
}

/* Adds the balls of a slot to the points near them. */
static void blend(job* j, const slot* k)
{
  const aqr_index* near = k->near;
  for (size_t i = k->begin; i < k->end; i++)
  {
    aqr_index v = j->centres[i], n = *near++;
    double limit = reach * radius_at(j, v);
    for (; n > 0; n--)
    {
      aqr_index w = *near++;
      double x = 1 - v3_norm2(v3_sub(aqr_point(j->s, w), aqr_point(j->s, v))) / (limit * limit);
      j->weight[w] += x * x;
      for (size_t a = 0; a < 6; a++)
        j->t[6 * (size_t)w + a] += (float)(x * x) * j->t[6 * (size_t)v + a];
      j->noise[w] += (float)(x * x) * j->noise[v];
    }
  }
}

static void divide(void* data, size_t begin, size_t end)
{
  job* j = data;
  for (size_t v = begin; v < end; v++)
  {
    if (j->covered[v] != blended)
      continue;
    for (size_t a = 0; a < 6; a++)
      j->t[6 * v + a] /= (float)j->weight[v];
    j->noise[v] /= (float)j->weight[v];
  }
}

/* Fills the balls and blends them in their order. They differ in size by orders of magnitude, so the length of a batch
 * follows what the last one took; it decides nothing but how often the progress hook is asked. */
static aqr_status fill_balls(aqr_context* c, job* j, double from, double to)
{
  aqr_status status = AQR_OK;
  size_t count = 1;
  for (size_t next = 0; next < j->n_centres;)
  {
    AQR_REQUIRE(aqr_step(c, from + (to - from) * (double)next / (double)j->n_centres), AQR_CANCELLED);
    size_t last = j->n_centres - next < count ? j->n_centres : next + count, visited = 0;
    size_t each = (last - next + slots - 1) / slots;
    for (slot* k = j->slot; k < j->slot + slots; k++)
    {
      k->visited = k->n_near = 0;
      k->begin = k->next = next;
      next = k->end = last - next < each ? last : next + each;
    }
    AQR_TRY(run_batch(c, j));
    for (slot* k = j->slot; k < j->slot + slots; k++)
    {
      visited += k->visited;
      blend(j, k);
    }
    double wanted = (double)count * batch_work / (double)visited;
    count = wanted < 1 ? 1 : wanted > 4 * (double)count ? 4 * count : (size_t)wanted;
  }
done:
  return status;
}

/* Asks the progress hook once in a while. */
static aqr_status count_work(aqr_context* c, size_t* work, size_t done, double fraction)
{
  *work += done;
  if (*work < batch_work)
    return AQR_OK;
  *work = 0;
  return aqr_step(c, fraction) ? AQR_OK : AQR_CANCELLED;
}

/* Greedy in the order of the points, so that the choice is the same for any number of threads. */
static aqr_status choose_centres(aqr_context* c, job* j, double from, double to)
{
  const aqr_surface* s = j->s;
  aqr_status status = AQR_OK;
  size_t n, work = 0;
  for (aqr_index v = 0; v < s->n_points; v++)
  {
    AQR_TRY(count_work(c, &work, 1, from + (to - from) * v / (double)s->n_points));
    if (j->covered[v] != uncovered)
      continue;
    double radius = radius_at(j, v);
    j->covered[v] = shares(j, v) ? shared_ball : own_ball;
    j->centres[j->n_centres++] = v;
    if (j->covered[v] == own_ball)
      continue;
    while (!disk(j, j->slot, v, spacing * radius, &n))
      AQR_REQUIRE(AQR_RESERVE(c, j->slot->queue, j->slot->room, 2 * j->slot->room), AQR_OUT_OF_MEMORY);
    work += n;
    for (size_t i = 0; i < n; i++)
    {
      aqr_index w = j->slot->queue[i];
      if (j->covered[w] == uncovered && shares(j, w) && may_stand_in(j, radius, w))
        j->covered[w] = blended;
    }
  }
done:
  return status;
}

static void free_job(aqr_context* c, job* j)
{
  AQR_DROP(c, j->area, j->s->n_faces);
  AQR_DROP(c, j->beta, 3 * j->s->n_faces);
  AQR_DROP(c, j->lumps, j->s->n_points);
  AQR_DROP(c, j->length, j->s->n_points);
  AQR_DROP(c, j->centres, j->s->n_points);
  AQR_DROP(c, j->covered, j->s->n_points);
  AQR_DROP(c, j->weight, j->s->n_points);
  for (slot* k = j->slot; k < j->slot + slots; k++)
  {
    AQR_DROP(c, k->queue, k->room);
    AQR_DROP(c, k->near, k->near_room);
    AQR_DROP(c, k->inside, j->inside_bytes);
  }
}

static bool allocate_job(aqr_context* c, job* j)
{
  size_t n = j->s->n_points;
  j->inside_bytes = n / 8 + 1;
  j->area = AQR_NEW(c, double, j->s->n_faces);
  j->beta = AQR_NEW(c, double, 3 * j->s->n_faces);
  j->lumps = AQR_NEW(c, lump, n);
  j->length = AQR_NEW(c, double, n);
  j->centres = AQR_NEW(c, aqr_index, n);
  j->covered = AQR_NEW0(c, uint8_t, n);
  j->weight = AQR_NEW0(c, double, n);
  bool ok = j->area && j->beta && j->lumps && j->length && j->centres && j->covered && j->weight;
  for (slot* k = j->slot; ok && k < j->slot + slots; k++)
  {
    k->inside = AQR_NEW0(c, uint8_t, j->inside_bytes);
    ok =
      k->inside && AQR_RESERVE(c, k->queue, k->room, first_queue) && AQR_RESERVE(c, k->near, k->near_room, first_queue);
  }
  return ok;
}

void aqr_tensors_free(aqr_context* c, const aqr_surface* s, aqr_tensors* tensors)
{
  AQR_DROP(c, tensors->t, 6 * s->n_points);
  AQR_DROP(c, tensors->noise, s->n_points);
  AQR_DROP(c, tensors->normal, 3 * s->n_points);
}

aqr_status aqr_curvature_tensors(aqr_context* c, const aqr_surface* s, double radius, aqr_tensors* tensors)
{
  aqr_status status = AQR_OK;
  size_t n = s->n_points;
  job j = { .s = s, .radius = radius };
  tensors->t = j.t = AQR_NEW0(c, float, 6 * n);
  tensors->noise = j.noise = AQR_NEW0(c, float, n);
  tensors->normal = j.normal = AQR_NEW(c, double, 3 * n);
  AQR_REQUIRE(tensors->t && tensors->noise && tensors->normal && allocate_job(c, &j), AQR_OUT_OF_MEMORY);

  AQR_TRY(aqr_parallel(c, 3 * s->n_faces, measure_angles, &j, 0, 0.1));
  AQR_TRY(aqr_parallel(c, s->n_faces, measure_areas, &j, 0.1, 0.1));
  AQR_TRY(aqr_parallel(c, n, lump_points, &j, 0.1, 0.2));
  AQR_TRY(choose_centres(c, &j, 0.2, 0.3));
  AQR_TRY(fill_balls(c, &j, 0.3, 1));
  AQR_TRY(aqr_parallel(c, n, divide, &j, 1, 1));
done:
  free_job(c, &j);
  if (status != AQR_OK)
    aqr_tensors_free(c, s, tensors);
  return status;
}
