// SPDX-License-Identifier: BSD-3-Clause
#include "InputSurface.h"

#include "vtkAOSDataArrayTemplate.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDoubleArray.h"
#include "vtkFloatArray.h"
#include "vtkIdList.h"
#include "vtkIdTypeArray.h"
#include "vtkNew.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
#include "vtkTriangleFilter.h"

#include <algorithm>
#include <cstring>

namespace
{
//------------------------------------------------------------------------------
bool InRange(vtkCellArray* cells, vtkIdType points)
{
  double range[2] = { 0.0, 0.0 };
  if (cells->GetNumberOfConnectivityIds() > 0)
  {
    cells->GetConnectivityArray()->GetRange(range);
  }
  return range[0] >= 0.0 && range[1] < static_cast<double>(points);
}

//------------------------------------------------------------------------------
// The corners of triangles, in `copy` where they are not stored as 64-bit integers. Since VTK 9.6 any array may
// hold them, and the accessors for one width answer nothing there.
const int64_t* Corners(vtkCellArray* triangles, std::vector<int64_t>& copy)
{
  vtkDataArray* stored = triangles->GetConnectivityArray();
  if (auto* wide = vtkAOSDataArrayTemplate<vtkTypeInt64>::FastDownCast(stored))
  {
    return reinterpret_cast<const int64_t*>(wide->GetPointer(0));
  }
  copy.resize(static_cast<size_t>(stored->GetNumberOfValues()));
  for (size_t i = 0; i < copy.size(); ++i)
  {
    copy[i] = static_cast<int64_t>(stored->GetComponent(static_cast<vtkIdType>(i), 0));
  }
  return copy.data();
}

//------------------------------------------------------------------------------
// Two chains of multiply and shift over 64-bit words, with constants of their own.
void Digest(const void* bytes, size_t count, SurfaceDigest& digest)
{
  const auto* next = static_cast<const unsigned char*>(bytes);
  while (count > 0)
  {
    std::uint64_t word = 0;
    const size_t step = std::min(count, sizeof word);
    std::memcpy(&word, next, step);
    digest[0] = (digest[0] ^ word) * 0x9E3779B97F4A7C15ULL;
    digest[0] ^= digest[0] >> 29;
    digest[1] = (digest[1] + word) * 0xD6E8FEB86659FD93ULL;
    digest[1] ^= digest[1] >> 32;
    next += step;
    count -= step;
  }
}

//------------------------------------------------------------------------------
void Digest(vtkDataArray* array, SurfaceDigest& digest)
{
  const std::int64_t head[2] = { array->GetDataType(), array->GetNumberOfValues() };
  Digest(head, sizeof head, digest);
  if (head[1] > 0)
  {
    Digest(
      array->GetVoidPointer(0), static_cast<size_t>(head[1]) * static_cast<size_t>(array->GetDataTypeSize()), digest);
  }
}

//------------------------------------------------------------------------------
// Adds fans for polygons that VTK has no triangles for, as they have no area, cross or repeat themselves: of a fan the
// kernels keep what makes a surface, and say what they drop, where the polygon would be a hole that nothing speaks of.
void AddFans(vtkCellArray* polygons, vtkIdType firstCell, vtkCellArray* triangles, std::vector<vtkIdType>& cells)
{
  std::vector<bool> isThere(static_cast<size_t>(polygons->GetNumberOfCells()), false);
  for (vtkIdType cell : cells)
  {
    if (cell - firstCell < polygons->GetNumberOfCells())
    {
      isThere[static_cast<size_t>(cell - firstCell)] = true;
    }
  }
  vtkNew<vtkIdList> corners;
  for (vtkIdType i = 0; i < polygons->GetNumberOfCells(); ++i)
  {
    if (isThere[static_cast<size_t>(i)])
    {
      continue;
    }
    polygons->GetCellAtId(i, corners);
    for (vtkIdType k = 2; k < corners->GetNumberOfIds(); ++k)
    {
      triangles->InsertNextCell({ corners->GetId(0), corners->GetId(k - 1), corners->GetId(k) });
      cells.push_back(firstCell + i);
    }
  }
}
}

//------------------------------------------------------------------------------
SurfaceTimes TimesOf(vtkPolyData* surface)
{
  vtkPoints* points = surface->GetPoints();
  vtkCellArray *polys = surface->GetPolys(), *strips = surface->GetStrips();
  return { points->GetMTime(), points->GetData()->GetMTime(), polys->GetMTime(),
    polys->GetConnectivityArray()->GetMTime(), polys->GetOffsetsArray()->GetMTime(), strips->GetMTime(),
    strips->GetConnectivityArray()->GetMTime(), strips->GetOffsetsArray()->GetMTime(),
    static_cast<vtkMTimeType>(surface->GetNumberOfVerts() + surface->GetNumberOfLines()) };
}

//------------------------------------------------------------------------------
SurfaceDigest DigestOf(vtkPolyData* surface)
{
  SurfaceDigest digest = { 1, 2 };
  const std::int64_t first = surface->GetNumberOfVerts() + surface->GetNumberOfLines();
  Digest(&first, sizeof first, digest);
  Digest(surface->GetPoints()->GetData(), digest);
  for (vtkCellArray* cells : { surface->GetPolys(), surface->GetStrips() })
  {
    Digest(cells->GetOffsetsArray(), digest);
    Digest(cells->GetConnectivityArray(), digest);
  }
  return digest;
}

//------------------------------------------------------------------------------
std::vector<int64_t> LineSegments(vtkPolyData* input, vtkDataArray* chosen)
{
  std::vector<int64_t> segments;
  vtkNew<vtkIdList> line;
  const vtkIdType first = input->GetNumberOfVerts();
  for (vtkIdType i = 0; i < input->GetNumberOfLines(); ++i)
  {
    if (chosen && chosen->GetComponent(first + i, 0) == 0.0)
    {
      continue;
    }
    input->GetLines()->GetCellAtId(i, line);
    for (vtkIdType k = 1; k < line->GetNumberOfIds(); ++k)
    {
      segments.push_back(line->GetId(k - 1));
      segments.push_back(line->GetId(k));
    }
  }
  return segments;
}

//------------------------------------------------------------------------------
aqr_status InputSurface::Give(vtkPolyData* input, const std::vector<int64_t>& locked, aqr_remesher* remesher)
{
  this->Cells.clear();
  this->FirstCell = input->GetNumberOfVerts() + input->GetNumberOfLines();
  vtkSmartPointer<vtkCellArray> polys = input->GetPolys();
  if (input->GetNumberOfStrips() != 0 || polys->IsHomogeneous() != 3)
  {
    if (!InRange(polys, input->GetNumberOfPoints()) || !InRange(input->GetStrips(), input->GetNumberOfPoints()))
    {
      return AQR_INDEX_OUT_OF_RANGE; // vtkTriangleFilter would follow them
    }
    vtkNew<vtkIdTypeArray> cells;
    cells->SetName("cell");
    cells->SetNumberOfValues(input->GetNumberOfPolys() + input->GetNumberOfStrips());
    for (vtkIdType i = 0; i < cells->GetNumberOfValues(); ++i)
    {
      cells->SetValue(i, this->FirstCell + i);
    }
    vtkNew<vtkPolyData> surface;
    surface->SetPoints(input->GetPoints());
    surface->SetPolys(polys);
    surface->SetStrips(input->GetStrips());
    surface->GetCellData()->AddArray(cells);
    vtkNew<vtkTriangleFilter> triangulate;
    triangulate->PassVertsOff();
    triangulate->PassLinesOff();
    triangulate->SetInputData(surface);
    triangulate->Update();
    polys = triangulate->GetOutput()->GetPolys();
    auto* source = vtkIdTypeArray::SafeDownCast(triangulate->GetOutput()->GetCellData()->GetArray("cell"));
    this->Cells.assign(source->GetPointer(0), source->GetPointer(0) + source->GetNumberOfValues());
    AddFans(input->GetPolys(), this->FirstCell, polys, this->Cells);
  }

  aqr_input view = {};
  view.number_of_points = static_cast<size_t>(input->GetNumberOfPoints());
  view.number_of_triangles = static_cast<size_t>(polys->GetNumberOfCells());
  std::vector<int64_t> corners;
  view.triangles = Corners(polys, corners);
  view.number_of_locked = locked.size() / 2;
  view.locked = locked.data();
  vtkDataArray* data = input->GetPoints()->GetData();
  vtkNew<vtkDoubleArray> converted;
  if (auto* floats = vtkFloatArray::FastDownCast(data))
  {
    view.points_f = floats->GetPointer(0);
  }
  else if (auto* doubles = vtkDoubleArray::FastDownCast(data))
  {
    view.points_d = doubles->GetPointer(0);
  }
  else
  {
    converted->DeepCopy(data);
    view.points_d = converted->GetPointer(0);
  }
  return aqr_remesher_set_input(remesher, &view);
}
