// SPDX-License-Identifier: BSD-3-Clause
// Fails when a change of density computes the curvature again, or when a change of the input does not.
#include "RemesherTesting.h"

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

  filter->SetTolerance(0.002);
  filter->Update();
  CHECK(Reused(filter, "curvature"));
  const std::string finer = Shape(filter->GetOutput());
  CHECK(finer.size() > first.size());

  // A cached run gives what a fresh filter gives.
  vtkNew<vtkAnisotropicQuadRemesher> fresh;
  fresh->SetInputData(torus);
  fresh->SetTolerance(0.002);
  fresh->Update();
  CHECK(Shape(fresh->GetOutput()) == finer);

  filter->SetCurvatureRadius(0.03);
  filter->Update();
  CHECK(!Reused(filter, "curvature"));

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
  CHECK(filter->GetOutput()->GetPointData()->GetArray("new") != nullptr);

  double x[3];
  torus->GetPoint(0, x);
  torus->GetPoints()->SetPoint(0, x[0] + 0.01, x[1], x[2]);
  torus->GetPoints()->Modified();
  filter->Update();
  CHECK(!Reused(filter, "curvature"));

  // Another input of the same size, then the first again.
  filter->SetInputData(MakeTorus(60, 30));
  filter->Update();
  CHECK(!Reused(filter, "curvature"));
  return checks.ExitCode();
}
