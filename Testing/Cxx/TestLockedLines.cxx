// SPDX-License-Identifier: BSD-3-Clause
// Fails when lines of the input are lost, kept without being asked for, or kept from the run before.
#include "RemesherTesting.h"

#include "vtkIntArray.h"

namespace
{
vtkIdType FeaturePoints(vtkAnisotropicQuadRemesher* filter)
{
  vtkDataArray* kind = filter->GetOutput()->GetPointData()->GetArray("PointKind");
  vtkIdType count = 0;
  for (vtkIdType p = 0; kind && p < kind->GetNumberOfTuples(); ++p)
  {
    count += kind->GetComponent(p, 0) >= 2;
  }
  return count;
}
}

int TestLockedLines(int, char*[])
{
  Checks checks;
  constexpr int n = 60;
  constexpr int m = 30;
  auto torus = MakeTorus(n, m);
  // A polyline around the outside, and a line of points of its own up the tube.
  vtkNew<vtkCellArray> lines;
  lines->InsertNextCell(n + 1);
  for (int i = 0; i <= n; ++i)
  {
    lines->InsertCellPoint(i % n * m);
  }
  vtkIdType last = 4;
  for (vtkIdType j = 5; j < 10; ++j)
  {
    const vtkIdType next = torus->GetPoints()->InsertNextPoint(torus->GetPoint(j));
    const vtkIdType ends[2] = { last, next };
    lines->InsertNextCell(2, ends);
    last = next;
  }
  torus->SetLines(lines);

  vtkNew<vtkAnisotropicQuadRemesher> filter;
  Messages messages(filter);
  filter->SetInputData(torus);
  filter->SetTolerance(0.003);
  filter->Update();
  CHECK(messages.Warnings == 1 && messages.Says("passed over: 0 and 6 cells"));
  CHECK(FeaturePoints(filter) == 0);
  messages.Clear();

  filter->LockLinesOn();
  filter->Update();
  CHECK(messages.Warnings == 0 && messages.Errors == 0);
  const vtkIdType both = FeaturePoints(filter);
  vtkPolyData* mesh = filter->GetOutput();
  vtkDataArray* kind = mesh->GetPointData()->GetArray("PointKind");
  vtkIdType around = 0;
  vtkIdType astray = 0;
  for (vtkIdType p = 0; p < mesh->GetNumberOfPoints(); ++p)
  {
    const double* x = mesh->GetPoint(p);
    const double radius = std::hypot(x[0], x[1]);
    const bool onCircle = std::abs(x[2]) < 1e-9 && radius > 3.9;
    const bool onTube = std::abs(x[1]) < 1e-9 && x[0] > 0;
    const bool feature = kind->GetComponent(p, 0) >= 2;
    around += feature && onCircle;
    astray += feature && !onCircle && !onTube;
  }
  std::cout << both << " points on locked lines, " << around << " of them on the circle\n";
  CHECK(around >= 8 && astray == 0 && both > around);
  CHECK(Topology(mesh).Manifold && Topology(mesh).EulerNumber == 0);

  // Only the circle.
  vtkNew<vtkIntArray> lock;
  lock->SetName("lock");
  lock->SetNumberOfTuples(torus->GetNumberOfCells());
  lock->FillValue(0);
  lock->SetValue(0, 2);
  torus->GetCellData()->AddArray(lock);
  filter->UseLockArrayOn();
  filter->SetInputArrayToProcess(1, 0, 0, vtkDataObject::FIELD_ASSOCIATION_CELLS, "lock");
  filter->Update();
  CHECK(messages.Warnings == 0 && messages.Errors == 0);
  std::cout << FeaturePoints(filter) << " points with the circle alone\n";
  CHECK(FeaturePoints(filter) >= 8 && FeaturePoints(filter) < both);

  filter->SetInputArrayToProcess(1, 0, 0, vtkDataObject::FIELD_ASSOCIATION_CELLS, "nowhere");
  filter->Update();
  CHECK(messages.Errors == 1 && messages.Says("\"nowhere\"") && filter->GetOutput()->GetNumberOfCells() == 0);
  messages.Clear();
  filter->SetInputArrayToProcess(1, 0, 0, vtkDataObject::FIELD_ASSOCIATION_CELLS, "lock");

  // Another choice on the same surface must not be served from the stages of the one before.
  lock->FillValue(1);
  lock->Modified();
  torus->Modified();
  filter->Update();
  CHECK(FeaturePoints(filter) == both);

  // A line through the inside is no edge.
  const vtkIdType across[2] = { 0, m / 2 };
  lines->InsertNextCell(2, across);
  filter->UseLockArrayOff();
  torus->GetCellData()->Initialize();
  torus->SetLines(lines);
  filter->Update();
  CHECK(messages.Warnings == 1 && messages.Says("1 of 66 locked edges are no edges"));
  CHECK(filter->GetReport().find("\"locked_missed\": 1,") != std::string::npos);
  messages.Clear();

  // Off again, nothing is left of them.
  filter->LockLinesOff();
  filter->Update();
  CHECK(FeaturePoints(filter) == 0);
  return checks.ExitCode();
}
