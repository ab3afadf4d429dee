// SPDX-License-Identifier: BSD-3-Clause
// The input as the kernels read it, and what tells one input from another.
#ifndef InputSurface_h
#define InputSurface_h

#include "aqr.h"
#include "vtkType.h"

#include <array>
#include <cstdint>
#include <vector>

class vtkDataArray;
class vtkPolyData;

// When each array of the geometry and the connectivity of a surface was changed, and how many cells come before its
// polygons. VTK gives no two changes the same time, so that surfaces with equal times are equal. Attributes do not
// count.
using SurfaceTimes = std::array<vtkMTimeType, 9>;
SurfaceTimes TimesOf(vtkPolyData* surface);

// Digest of points and polygons. A reader that gives the same surface at the next time step, or a block
// whose turn comes again, gives new arrays with the digest of the old.
using SurfaceDigest = std::array<std::uint64_t, 2>;
SurfaceDigest DigestOf(vtkPolyData* surface);

// The two points of every piece of the lines and polylines; where an array over the cells is given, of those only
// where it is not zero.
std::vector<int64_t> LineSegments(vtkPolyData* input, vtkDataArray* chosen);

// Leads from triangles of the kernels back to cells of the input.
class InputSurface
{
public:
  vtkIdType Cell(aqr_index triangle) const
  {
    return this->Cells.empty() ? this->FirstCell + static_cast<vtkIdType>(triangle) : this->Cells[triangle];
  }

  // Hands points, triangles and locked edges (see LineSegments) to the remesher.
  aqr_status Give(vtkPolyData* input, const std::vector<int64_t>& locked, aqr_remesher* remesher);

private:
  std::vector<vtkIdType> Cells; // input cell of a triangle; empty: triangle i is cell FirstCell + i
  vtkIdType FirstCell = 0;
};

#endif
