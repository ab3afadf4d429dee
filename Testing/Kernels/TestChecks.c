/* SPDX-License-Identifier: BSD-3-Clause */
/* Right results made wrong in one place: the checks that all other tests, the fuzz targets and the corpus rely on must
 * say what is wrong. */
#include "test.h"

#include "cells.h"
#include "examine.h"
#include "faces.h"
#include "judge.h"
#include "remesh.h"

/* Copies of a result that may be changed. */
typedef struct wrong
{
  aqr_mesh mesh;
  aqr_field_view field;
  aqr_report report;
  double *points, *normals, *directions, *curvature;
  int64_t *offsets, *connectivity;
  aqr_origin* origins;
  aqr_index* sources;
} wrong;

static void* copy_of(const void* from, size_t n, size_t size)
{
  void* to = malloc((n + 16) * size); /* room for a few more */
  if (to)
    memcpy(to, from, n * size);
  return to;
}

static wrong copy_result(const aqr_remesher* r)
{
  wrong w = { *aqr_remesher_mesh(r), *aqr_remesher_field(r), *aqr_remesher_report(r), .points = NULL };
  w.mesh.points = w.points = copy_of(w.mesh.points, 3 * w.mesh.number_of_points, sizeof *w.points);
  w.mesh.normals = w.normals = copy_of(w.mesh.normals, 3 * w.mesh.number_of_points, sizeof *w.normals);
  w.mesh.origins = w.origins = copy_of(w.mesh.origins, w.mesh.number_of_points, sizeof *w.origins);
  w.mesh.offsets = w.offsets = copy_of(w.mesh.offsets, w.mesh.number_of_faces + 1, sizeof *w.offsets);
  w.mesh.connectivity = w.connectivity = copy_of(w.mesh.connectivity, w.mesh.number_of_corners, sizeof *w.connectivity);
  w.mesh.face_source = w.sources = copy_of(w.mesh.face_source, w.mesh.number_of_faces, sizeof *w.sources);
  w.field.min_direction = w.directions =
    copy_of(w.field.min_direction, 3 * w.field.number_of_points, sizeof *w.directions);
  w.field.min_curvature = w.curvature = copy_of(w.field.min_curvature, w.field.number_of_points, sizeof *w.curvature);
  return w;
}

static void wrong_free(wrong* w)
{
  free(w->points);
  free(w->normals);
  free(w->origins);
  free(w->offsets);
  free(w->connectivity);
  free(w->sources);
  free(w->directions);
  free(w->curvature);
}

static void add_face(wrong* w, const int64_t* corner, size_t n)
{
  int64_t* to = w->connectivity + w->mesh.number_of_corners;
  memmove(to, corner, n * sizeof *corner);
  w->mesh.number_of_corners += n;
  w->sources[w->mesh.number_of_faces] = 0;
  w->offsets[++w->mesh.number_of_faces] = (int64_t)w->mesh.number_of_corners;
}

static int64_t add_point(wrong* w)
{
  size_t n = w->mesh.number_of_points++;
  memcpy(w->points + 3 * n, w->points, 3 * sizeof *w->points);
  memcpy(w->normals + 3 * n, w->normals, 3 * sizeof *w->normals);
  w->origins[n] = w->origins[0];
  return (int64_t)n;
}

enum
{
  lost_bits = 1,  /* wrong whatever the surface: the survey finds it too */
  lost_pairs = 2, /* wrong beside that surface */
  lost_values = 4
};

/* Makes one thing wrong. What the checks must say. */
static const char* spoil(wrong* w, int what, int* kind)
{
  int64_t *c = w->connectivity, swap = c[0], island[3];
  size_t n = w->mesh.number_of_faces;
  *kind = what < 9 ? lost_bits : what < 12 ? lost_pairs : lost_values;
  switch (what)
  {
    case 0: /* a face turned over */
      c[0] = c[2];
      c[2] = swap;
      return "two faces disagree about their side";
    case 1: /* a face twice */
      add_face(w, c, (size_t)w->offsets[1]);
      return "two faces have the same points";
    case 2: /* a third face at an edge */
      c[w->mesh.number_of_corners] = c[0];
      c[w->mesh.number_of_corners + 1] = c[1];
      c[w->mesh.number_of_corners + 2] = add_point(w);
      add_face(w, c + w->mesh.number_of_corners, 3);
      return "an edge has more than two faces";
    case 3: /* a point that no face uses */
      add_point(w);
      return "a point has no face";
    case 4: /* a corner beyond the points */
      c[1] = (int64_t)w->mesh.number_of_points;
      return "a corner is no point";
    case 5:
      c[1] = -1;
      return "a corner is no point";
    case 6: /* a face that comes back to a point */
      c[2] = c[0];
      return "a face meets a point twice";
    case 7: /* a face of two corners */
      w->offsets[1] = 2;
      return "a face has fewer than three corners";
    case 8: /* two points far from each other become one; the other goes to the end, where it is cut off */
      for (size_t i = 0; i < w->mesh.number_of_corners; i++)
        c[i] = c[i] == (int64_t)w->mesh.number_of_points - 1 ? 0 : c[i];
      w->mesh.number_of_points--;
      return "a point has two fans";
    case 9: /* a face lost */
      w->mesh.number_of_corners -= (size_t)(w->offsets[n] - w->offsets[n - 1]);
      w->mesh.number_of_faces--;
      return "the number of boundary loops changed";
    case 10: /* an island */
      for (int i = 0; i < 3; i++)
        island[i] = add_point(w);
      add_face(w, island, 3);
      return "the number of components changed";
    case 11:
      w->report.boundary_loops++;
      return "the report's boundary loops are not those of the surface";
    case 12:
      w->points[4] = NAN;
      return "a point is not finite";
    case 13:
      w->points[4] = -INFINITY;
      return "a point is not finite";
    case 14: /* out of the bounding box */
      w->points[4] += 10;
      return "a point lies outside the bounding box";
    case 15:
      w->normals[3] += 0.1;
      return "a normal is not of unit length";
    case 16:
      w->normals[3] = NAN;
      return "a normal is not of unit length";
    case 17:
      w->origins[1].point[0] = AQR_NONE - 1;
      return "an origin is no point of the input";
    case 18:
      w->origins[1].weight[0] += 0.5F;
      return "weights of an origin do not add up to one";
    case 19:
      w->sources[1] = AQR_NONE;
      return "a face has no source";
    case 20:
      w->directions[3] = 2;
      return "a direction is not of unit length";
    case 21:
      w->curvature[1] = NAN;
      return "curvatures are not in order";
    case 22:
      w->report.components = 7;
      return "the report's components are not those of the surface";
    case 23: /* with symmetry */
      w->points[3] += 1e-4;
      return "a point has no mirror image";
    default:
      return NULL;
  }
}

static void check_that_wrongs_are_found(int symmetry)
{
  shape m = shape_torus(12, 1);
  aqr_input input = shape_input(&m);
  aqr_options o = options_for_points(200);
  o.symmetry = symmetry;
  aqr_remesher* r = remesh(&m, &o);
  CHECK(!examine_results(aqr_remesher_mesh(r), aqr_remesher_field(r), aqr_remesher_report(r), &input, &o));
  for (int what = 0; what < 24; what++)
  {
    if (symmetry ? what == 11 || what == 22 : what == 23) /* the report is on the input, the surface is of a half */
      continue;
    int kind;
    wrong w = copy_result(r);
    const char* wanted = spoil(&w, what, &kind);
    const char* said = examine_results(&w.mesh, &w.field, &w.report, &input, &o);
    if (!wanted || !said || strcmp(said, wanted) != 0)
      printf("%d: \"%s\", not \"%s\"\n", what, said ? said : "nothing", wanted ? wanted : "");
    CHECK(wanted && said && !strcmp(said, wanted));
    CHECK(!(kind & lost_bits) || survey_mesh(&w.mesh).flaw);
    wrong_free(&w);
  }
  aqr_remesher_free(r);
  shape_free(&m);
}

AQR_TEST(a_result_that_is_wrong_in_one_place_is_found_out)
{
  check_that_wrongs_are_found(0);
}

AQR_TEST(a_symmetric_result_that_is_wrong_in_one_place_is_found_out)
{
  check_that_wrongs_are_found(1);
}

/* Half an open box and its image: joined at what lies on the plane of the border. */
AQR_TEST(a_half_is_judged_together_with_its_mirror_image)
{
  double points[] = { 0, 0, 0, 0, 1, 0, 0, 0, 1, 2, 0, 0 };
  const int64_t offsets[] = { 0, 3, 6 }, corners[] = { 0, 1, 3, 0, 3, 2 };
  const judge_plane plane = { { 0, 7, -3 }, { 1, 0, 0 } };
  verdict v = judge_mirrored(4, points, 2, offsets, corners, &plane); /* 1 and 2 are joined to 0 along the plane */
  CHECK(!v.fault && v.euler == 1 && v.boundary_loops == 1 && v.components == 1);
  points[0] = 1; /* touches the plane in two points, and along no edge */
  v = judge_mirrored(4, points, 2, offsets, corners, &plane);
  CHECK(!v.fault && v.euler == 2 && v.boundary_loops == 2 && v.components == 2);
  points[0] = -1;
  v = judge_mirrored(4, points, 2, offsets, corners, &plane);
  CHECK(v.fault && strstr(v.fault, "wrong side"));
}

AQR_TEST(a_handle_that_is_lost_is_found_out)
{
  verdict torus = { NULL, 0, 0, 1 }, sphere = { NULL, 2, 0, 1 };
  CHECK(!judge_pair(&torus, &torus));
  CHECK(judge_pair(&torus, &sphere) && !strcmp(judge_pair(&torus, &sphere), "the Euler number changed"));
}

/* Whatever a stage before leaves wrong in the half-edges ends the run with a status, not as a mesh. */
AQR_TEST(broken_half_edges_are_an_internal_error_and_no_mesh)
{
  const aqr_faces_options usual = { .convex_partition = true, .largest_valence = 5 };
  for (int what = 0; what < 6; what++)
  {
    aqr_context c = { 0 };
    aqr_polygon_mesh m = { 0 };
    CHECK(torus_of_quads(&c, 6, 5, &m));
    aqr_half_edge* e = &m.half_edges[7];
    aqr_index other = e->from ? 0 : 1;
    if (what == 0)
      e->next = e->prev;
    else if (what == 1)
      e->from = other;
    else if (what == 2)
      e->face = e->face ? 0 : 1;
    else if (what == 3)
      m.faces[2] = m.faces[3];
    else if (what == 4)
      m.vertices[2].out = m.vertices[3].out;
    else
      e->prev = (aqr_index)m.n_half_edges;
    CHECK(aqr_faces_finish(&c, &m, &usual) == AQR_INTERNAL);
    aqr_polygon_mesh_free(&c, &m);
    CHECK(c.bytes == 0);
  }
}

AQR_TEST_MAIN
