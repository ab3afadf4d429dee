// SPDX-License-Identifier: BSD-3-Clause
// Fails when a change of density computes the curvature again or copies its ports anew, or when a change of the input
// does not.
#include "RemesherTesting.h"
#include "vtkIntArray.h"

#include <chrono>

namespace
{
bool Reused(vtkAnisotropicQuadRemesher* filter, const std::string& stage)
{
  const std::string report = filter->GetReport();
  const size_t begin = report.find("\"name\": \"" + stage + "\"");
  if (begin == std::string::npos)
  {
    std::cout << "no stage " << stage << " in " << report << "\n";
    return false;
  }
  return report.substr(begin, report.find('}', begin) - begin).find("\"reused\": true") != std::string::npos;
}

std::string Shape(vtkPolyData* mesh)
{
  std::string bytes;
  for (vtkIdType p = 0; p < mesh->GetNumberOfPoints(); ++p)
  {
    double x[3];
    mesh->GetPoint(p, x);
    bytes.append(reinterpret_cast<const char*>(x), sizeof x);
  }
  return bytes;
}
}

int TestCaching(int, char*[])
{
  Checks checks;
  const auto torus = MakeTorus(60, 30);
  vtkNew<vtkAnisotropicQuadRemesher> filter;
  filter->SetInputData(torus);
  filter->SetTolerance(0.004);
  filter->Update();
  CHECK(!Reused(filter, "curvature"));
  const std::string first = Shape(filter->GetOutput());
  CHECK(!first.empty());
  vtkSmartPointer<vtkDataArray> direction = filter->GetOutput(1)->GetPointData()->GetArray("MinDirection");
  vtkSmartPointer<vtkDataArray> confidence = filter->GetOutput(2)->GetPointData()->GetArray("Confidence");
  CHECK(direction && confidence);

  filter->SetTolerance(0.002);
  filter->Update();
  CHECK(Reused(filter, "curvature"));
  const std::string finer = Shape(filter->GetOutput());
  CHECK(finer.size() > first.size());
  CHECK(filter->GetOutput(1)->GetPointData()->GetArray("MinDirection") == direction);
  CHECK(filter->GetOutput(2)->GetPointData()->GetArray("Confidence") == confidence);

  // A port that was off is there again, the other one leaves.
  filter->GenerateDirectionsOff();
  filter->SetTolerance(0.0021);
  filter->Update();
  CHECK(filter->GetOutput(1)->GetNumberOfPoints() == 0);
  CHECK(filter->GetOutput(2)->GetPointData()->GetArray("Confidence") == confidence);
  filter->GenerateDirectionsOn();
  filter->SetTolerance(0.002);
  filter->Update();
  CHECK(filter->GetOutput(1)->GetNumberOfPoints() == filter->GetOutput(2)->GetNumberOfPoints());
  direction = filter->GetOutput(1)->GetPointData()->GetArray("MinDirection");

  // A cached run gives what a fresh filter gives.
  vtkNew<vtkAnisotropicQuadRemesher> fresh;
  fresh->SetInputData(torus);
  fresh->SetTolerance(0.002);
  fresh->Update();
  CHECK(Shape(fresh->GetOutput()) == finer);

  filter->SetCurvatureRadius(0.03);
  filter->Update();
  CHECK(!Reused(filter, "curvature"));
  CHECK(filter->GetOutput(1)->GetPointData()->GetArray("MinDirection") != direction);
  CHECK(filter->GetOutput(2)->GetPointData()->GetArray("Confidence") != confidence);

  // New attributes do not change the geometry; a moved point does.
  vtkNew<vtkDoubleArray> array;
  array->SetName("new");
  array->SetNumberOfTuples(torus->GetNumberOfPoints());
  array->FillValue(1.0);
  torus->GetPointData()->AddArray(array);
  torus->Modified();
  filter->SetTolerance(0.003);
  filter->Update();
  CHECK(Reused(filter, "curvature"));
  for (int port = 0; port < 3; ++port)
  {
    CHECK(filter->GetOutput(port)->GetPointData()->GetArray("new") != nullptr);
  }
  array->FillValue(2.0);
  array->Modified();
  filter->Update();
  for (int port = 0; port < 3; ++port)
  {
    CHECK(filter->GetOutput(port)->GetPointData()->GetArray("new")->GetComponent(0, 0) == 2.0);
  }
  vtkNew<vtkIntArray> cells;
  cells->SetName("cells");
  cells->SetNumberOfTuples(torus->GetNumberOfCells());
  cells->FillValue(7);
  torus->GetCellData()->AddArray(cells);
  filter->Update();
  CHECK(filter->GetOutput(1)->GetCellData()->GetArray("cells") != nullptr);

  double x[3];
  torus->GetPoint(0, x);
  torus->GetPoints()->SetPoint(0, x[0] + 0.01, x[1], x[2]);
  torus->GetPoints()->Modified();
  filter->Update();
  CHECK(!Reused(filter, "curvature"));

  // Other polygons over the same points, which were changed last.
  vtkNew<vtkPolyData> half;
  vtkNew<vtkCellArray> polys;
  vtkNew<vtkIdList> corners;
  for (vtkIdType cell = 0; cell < torus->GetNumberOfPolys() / 2; ++cell)
  {
    torus->GetPolys()->GetCellAtId(cell, corners);
    polys->InsertNextCell(corners);
  }
  half->SetPoints(torus->GetPoints());
  half->SetPolys(polys);
  torus->GetPoints()->Modified();
  torus->GetPoints()->GetData()->Modified();
  filter->SetInputData(torus);
  filter->Update();
  const std::string whole = Shape(filter->GetOutput());
  filter->SetInputData(half);
  filter->Update();
  CHECK(!Reused(filter, "curvature"));
  CHECK(Shape(filter->GetOutput()) != whole);

  // Verts come before the polygons and move their numbers.
  const auto lastCell = [&] { return filter->GetOutput()->GetCellData()->GetArray("SourceCellId")->GetRange()[1]; };
  const double before = lastCell();
  vtkNew<vtkPolyData> withVerts;
  vtkNew<vtkCellArray> verts;
  for (vtkIdType point = 0; point < 5000; ++point)
  {
    verts->InsertNextCell({ point % 100 });
  }
  withVerts->SetPoints(torus->GetPoints());
  withVerts->SetVerts(verts);
  withVerts->SetPolys(polys);
  torus->GetPoints()->Modified();
  filter->SetInputData(withVerts);
  filter->Update();
  CHECK(lastCell() == before + 5000);

  // Another input of the same size, then the first again.
  filter->SetInputData(MakeTorus(60, 30));
  filter->Update();
  CHECK(!Reused(filter, "curvature"));
  return checks.ExitCode();
}
