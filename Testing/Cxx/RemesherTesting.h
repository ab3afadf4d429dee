// SPDX-License-Identifier: BSD-3-Clause
// What the tests of the filter share: checks, surfaces and an observer of messages.
#ifndef RemesherTesting_h
#define RemesherTesting_h

#include "vtkAnisotropicQuadRemesher.h"
#include "vtkCallbackCommand.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkIdList.h"
#include "vtkMath.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"

#include <cmath>
#include <cstdlib>
#include <functional>
#include <iostream>
#include <map>
#include <string>
#include <utility>

// Counts failures of one test program; CHECK reports and goes on.
class Checks
{
public:
  void Check(bool good, const char* what, int line)
  {
    if (!good)
    {
      std::cout << "line " << line << ": failed: " << what << std::endl;
      this->Failures++;
    }
  }
  int ExitCode() const { return this->Failures ? EXIT_FAILURE : EXIT_SUCCESS; }

private:
  int Failures = 0;
};
#define CHECK(condition) checks.Check(condition, #condition, __LINE__)

// Counts the errors and warnings of an algorithm and keeps the last text; nothing is printed.
class Messages
{
public:
  explicit Messages(vtkObject* object)
  {
    this->OnError->SetCallback(Messages::Keep);
    this->OnError->SetClientData(this);
    object->AddObserver(vtkCommand::ErrorEvent, this->OnError);
    object->AddObserver(vtkCommand::WarningEvent, this->OnError);
  }
  void Clear()
  {
    this->Errors = this->Warnings = 0;
    this->Text.clear();
  }
  bool Says(const std::string& words) const { return this->Text.find(words) != std::string::npos; }

  int Errors = 0;
  int Warnings = 0;
  std::string Text;

private:
  static void Keep(vtkObject*, unsigned long event, void* self, void* text)
  {
    auto* messages = static_cast<Messages*>(self);
    (event == vtkCommand::ErrorEvent ? messages->Errors : messages->Warnings)++;
    // Without the place in the source, which says "ERROR" where ctest looks for errors.
    const std::string message = static_cast<const char*>(text);
    const size_t begin = message.find("): ");
    messages->Text = message.substr(begin == std::string::npos ? 0 : begin + 3);
  }
  vtkNew<vtkCallbackCommand> OnError;
};

// A grid of n x m points as triangles; closed in a direction where it wraps.
inline vtkSmartPointer<vtkPolyData> MakeGrid(
  int n, int m, bool wrapN, bool wrapM, const std::function<void(double u, double v, double* point)>& shape)
{
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (int i = 0; i < n; ++i)
  {
    for (int j = 0; j < m; ++j)
    {
      double p[3];
      shape(static_cast<double>(i) / (wrapN ? n : n - 1), static_cast<double>(j) / (wrapM ? m : m - 1), p);
      points->InsertNextPoint(p);
    }
  }
  vtkNew<vtkCellArray> polys;
  for (int i = 0; i < (wrapN ? n : n - 1); ++i)
  {
    for (int j = 0; j < (wrapM ? m : m - 1); ++j)
    {
      const vtkIdType a = i * m + j;
      const vtkIdType b = (i + 1) % n * m + j;
      const vtkIdType c = (i + 1) % n * m + (j + 1) % m;
      const vtkIdType d = i * m + (j + 1) % m;
      const vtkIdType first[3] = { a, b, c };
      const vtkIdType second[3] = { a, c, d };
      polys->InsertNextCell(3, first);
      polys->InsertNextCell(3, second);
    }
  }
  auto surface = vtkSmartPointer<vtkPolyData>::New();
  surface->SetPoints(points);
  surface->SetPolys(polys);
  return surface;
}

inline vtkSmartPointer<vtkPolyData> MakeTorus(int n = 100, int m = 50)
{
  return MakeGrid(n, m, true, true,
    [](double u, double v, double* p)
    {
      u *= 2 * vtkMath::Pi();
      v *= 2 * vtkMath::Pi();
      p[0] = (3 + std::cos(v)) * std::cos(u);
      p[1] = (3 + std::cos(v)) * std::sin(u);
      p[2] = std::sin(v);
    });
}

// An open sheet with two humps.
inline vtkSmartPointer<vtkPolyData> MakeSheet(int n = 60)
{
  return MakeGrid(n, n, false, false,
    [](double u, double v, double* p)
    {
      p[0] = 4 * u;
      p[1] = 4 * v;
      p[2] = 0.5 * std::sin(4 * u) * std::cos(3 * v);
    });
}

// A cube whose sides are grids of 2 * n * n triangles with points of their own on the twelve edges.
inline vtkSmartPointer<vtkPolyData> MakeBox(int n = 20)
{
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkCellArray> polys;
  for (int side = 0; side < 6; ++side)
  {
    const int axis = side / 2;
    const bool far = side % 2 != 0;
    const vtkIdType first = points->GetNumberOfPoints();
    for (int i = 0; i <= n; ++i)
    {
      for (int j = 0; j <= n; ++j)
      {
        double p[3];
        p[axis] = far ? 1.0 : 0.0;
        p[(axis + 1) % 3] = static_cast<double>(far ? i : j) / n;
        p[(axis + 2) % 3] = static_cast<double>(far ? j : i) / n;
        points->InsertNextPoint(p);
      }
    }
    for (int i = 0; i < n; ++i)
    {
      for (int j = 0; j < n; ++j)
      {
        const vtkIdType a = first + i * (n + 1) + j;
        const vtkIdType triangles[2][3] = { { a, a + n + 1, a + n + 2 }, { a, a + n + 2, a + 1 } };
        polys->InsertNextCell(3, triangles[0]);
        polys->InsertNextCell(3, triangles[1]);
      }
    }
  }
  auto surface = vtkSmartPointer<vtkPolyData>::New();
  surface->SetPoints(points);
  surface->SetPolys(polys);
  return surface;
}

// What the connectivity of a mesh says about it.
struct Topology
{
  bool Manifold = true; // no edge has more than two faces or is run through twice in one direction
  vtkIdType BoundaryEdges = 0;
  vtkIdType EulerNumber = 0;
  vtkIdType Quads = 0;
  vtkIdType Faces = 0;

  explicit Topology(vtkPolyData* mesh)
  {
    std::map<std::pair<vtkIdType, vtkIdType>, int> halfEdges;
    vtkNew<vtkIdList> corners;
    this->Faces = mesh->GetPolys()->GetNumberOfCells();
    for (vtkIdType face = 0; face < this->Faces; ++face)
    {
      mesh->GetPolys()->GetCellAtId(face, corners);
      const vtkIdType n = corners->GetNumberOfIds();
      this->Quads += n == 4;
      for (vtkIdType i = 0; i < n; ++i)
      {
        this->Manifold &= ++halfEdges[{ corners->GetId(i), corners->GetId((i + 1) % n) }] == 1;
      }
    }
    vtkIdType edges = 0;
    for (const auto& half : halfEdges)
    {
      const bool paired = halfEdges.count({ half.first.second, half.first.first }) != 0;
      this->BoundaryEdges += !paired;
      edges += !paired || half.first.first < half.first.second;
    }
    this->EulerNumber = mesh->GetNumberOfPoints() - edges + this->Faces;
  }
};

#endif
