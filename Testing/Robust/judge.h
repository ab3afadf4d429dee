/* SPDX-License-Identifier: BSD-3-Clause */
/* Judges a polygon mesh from its arrays alone, without any code of the library. */
#ifndef AQR_TEST_JUDGE_H
#define AQR_TEST_JUDGE_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C"
{
#endif

  typedef struct verdict
  {
    const char* fault; /* NULL: every edge at most two faces that agree, every vertex one fan, nothing degenerate,
                          duplicate, unused or not finite; the counts below are then set */
    long euler;
    size_t boundary_loops, components;
  } verdict;

  /* offsets has n_faces + 1 entries. */
  verdict judge_mesh(
    size_t n_points, const double* points, size_t n_faces, const int64_t* offsets, const int64_t* connectivity);

  /* A plane in the coordinates of what it is used on; the normal is of unit length. */
  typedef struct judge_plane
  {
    double origin[3], normal[3];
  } judge_plane;

  double judge_height(const judge_plane* plane, const double* point);

  /* A mesh and its mirror image about the plane as one surface: joined where an edge of the mesh's border lies on the
   * plane. The mesh lies on the positive side. */
  verdict judge_mirrored(size_t n_points, const double* points, size_t n_faces, const int64_t* offsets,
    const int64_t* connectivity, const judge_plane* plane);

  /* What is wrong with `mesh` as a remesh of `surface`; NULL when nothing is. */
  const char* judge_pair(const verdict* surface, const verdict* mesh);

#ifdef __cplusplus
}
#endif

#endif
