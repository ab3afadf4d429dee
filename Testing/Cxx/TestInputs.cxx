// SPDX-License-Identifier: BSD-3-Clause
// Fails when polygons, strips, 32-bit cells or integer points are read otherwise than triangles, when
// vertices and lines shift the cell ids, when a polygon that repeats itself leaves a hole, and when a repair goes
// unsaid.
#include "RemesherTesting.h"

#include "vtkStripper.h"

namespace
{
vtkSmartPointer<vtkPolyData> Remeshed(vtkPolyData* input)
{
  vtkNew<vtkAnisotropicQuadRemesher> filter;
  filter->SetInputData(input);
  filter->SetTolerance(0.003);
  Messages messages(filter);
  filter->Update();
  std::cout << messages.Text;
  return filter->GetOutput();
}

bool Alike(vtkPolyData* a, vtkPolyData* b)
{
  const Topology first(a);
  const Topology second(b);
  const double ratio = static_cast<double>(a->GetNumberOfPoints()) / static_cast<double>(b->GetNumberOfPoints());
  return first.EulerNumber == second.EulerNumber && first.Manifold && second.Manifold && ratio > 0.9 && ratio < 1.1;
}

// Pairs of triangles as made by MakeGrid become quads again.
vtkSmartPointer<vtkPolyData> Quads(vtkPolyData* grid)
{
  vtkNew<vtkCellArray> quads;
  vtkNew<vtkIdList> a;
  vtkNew<vtkIdList> b;
  for (vtkIdType i = 0; i < grid->GetNumberOfPolys(); i += 2)
  {
    grid->GetPolys()->GetCellAtId(i, a);
    grid->GetPolys()->GetCellAtId(i + 1, b);
    const vtkIdType quad[4] = { a->GetId(0), a->GetId(1), a->GetId(2), b->GetId(2) };
    quads->InsertNextCell(4, quad);
  }
  auto surface = vtkSmartPointer<vtkPolyData>::New();
  surface->SetPoints(grid->GetPoints());
  surface->SetPolys(quads);
  return surface;
}
}

int TestInputs(int, char*[])
{
  Checks checks;
  const auto torus = MakeTorus(60, 30);
  const auto expected = Remeshed(torus);
  CHECK(expected->GetNumberOfPolys() > 0);

  const auto quads = Quads(torus);
  const auto fromQuads = Remeshed(quads);
  CHECK(Alike(fromQuads, expected));
  double range[2];
  fromQuads->GetCellData()->GetArray("SourceCellId")->GetRange(range);
  CHECK(range[0] >= 0 && range[1] < static_cast<double>(quads->GetNumberOfCells()));

  // A polygon that goes around its four corners twice has no triangles for VTK.
  vtkNew<vtkPolyData> twice;
  vtkNew<vtkCellArray> around;
  vtkNew<vtkIdList> ring;
  around->DeepCopy(quads->GetPolys());
  around->GetCellAtId(7, ring);
  for (vtkIdType k = 0; k < 4; ++k)
  {
    ring->InsertNextId(ring->GetId(k));
  }
  const vtkIdType nothing[4] = { 0, 0, 0, 0 };
  around->ReplaceCellAtId(7, 4, nothing);
  around->InsertNextCell(ring);
  twice->SetPoints(quads->GetPoints());
  twice->SetPolys(around);
  CHECK(Alike(Remeshed(twice), expected));

  vtkNew<vtkStripper> strip;
  strip->SetInputData(torus);
  strip->Update();
  CHECK(strip->GetOutput()->GetNumberOfStrips() > 0);
  CHECK(Alike(Remeshed(strip->GetOutput()), expected));

  vtkNew<vtkPolyData> narrow;
  narrow->DeepCopy(torus);
  narrow->GetPolys()->ConvertTo32BitStorage();
  CHECK(Alike(Remeshed(narrow), expected));

  vtkNew<vtkPolyData> floats;
  vtkNew<vtkPoints> points;
  points->SetDataTypeToFloat();
  points->DeepCopy(torus->GetPoints());
  floats->SetPoints(points);
  floats->SetPolys(torus->GetPolys());
  const auto fromFloats = Remeshed(floats);
  CHECK(fromFloats->GetPoints()->GetDataType() == VTK_FLOAT);
  CHECK(expected->GetPoints()->GetDataType() == VTK_DOUBLE);
  CHECK(Alike(fromFloats, expected));

  vtkNew<vtkPoints> integers;
  integers->SetDataType(VTK_INT);
  integers->SetNumberOfPoints(torus->GetNumberOfPoints());
  for (vtkIdType p = 0; p < torus->GetNumberOfPoints(); ++p)
  {
    double x[3];
    torus->GetPoint(p, x);
    integers->SetPoint(p, std::round(1000 * x[0]), std::round(1000 * x[1]), std::round(1000 * x[2]));
  }
  vtkNew<vtkPolyData> grid;
  grid->SetPoints(integers);
  grid->SetPolys(torus->GetPolys());
  CHECK(Alike(Remeshed(grid), expected));

  // Vertices and lines come before polygons in the numbering of cells.
  vtkNew<vtkPolyData> mixed;
  mixed->DeepCopy(torus);
  vtkNew<vtkCellArray> verts;
  const vtkIdType vertex = 0;
  verts->InsertNextCell(1, &vertex);
  mixed->SetVerts(verts);
  vtkNew<vtkAnisotropicQuadRemesher> filter;
  filter->SetInputData(mixed);
  filter->SetTolerance(0.003);
  Messages messages(filter);
  filter->Update();
  CHECK(messages.Warnings == 1 && messages.Errors == 0 && messages.Says("passed over"));
  CHECK(Alike(filter->GetOutput(), expected));
  CHECK(filter->GetOutput()->GetNumberOfVerts() == 0);
  filter->GetOutput()->GetCellData()->GetArray("SourceCellId")->GetRange(range);
  CHECK(range[0] >= 1);

  // One triangle turned round, one given twice, one without area.
  vtkNew<vtkPolyData> broken;
  broken->SetPoints(torus->GetPoints());
  vtkNew<vtkCellArray> polys;
  polys->DeepCopy(torus->GetPolys());
  vtkNew<vtkIdList> corners;
  polys->GetCellAtId(10, corners);
  const vtkIdType turned[3] = { corners->GetId(0), corners->GetId(2), corners->GetId(1) };
  polys->ReplaceCellAtId(10, 3, turned);
  polys->GetCellAtId(20, corners);
  polys->InsertNextCell(corners);
  const vtkIdType flat[3] = { 0, 0, 1 };
  polys->InsertNextCell(3, flat);
  broken->SetPolys(polys);
  messages.Clear();
  filter->SetInputData(broken);
  filter->Update();
  std::cout << messages.Text;
  CHECK(messages.Warnings == 1 && messages.Errors == 0);
  CHECK(messages.Says("1 degenerate") && messages.Says("1 duplicate") && messages.Says("1 triangle turned"));
  CHECK(Alike(filter->GetOutput(), expected));

  // A spacing far below what the input can carry is not met, and that is said.
  messages.Clear();
  filter->SetInputData(torus);
  filter->SetLargestSpacing(1e-4);
  filter->Update();
  CHECK(messages.Warnings == 1 && messages.Errors == 0 && messages.Says("largest spacing"));
  return checks.ExitCode();
}
