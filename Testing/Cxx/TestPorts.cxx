// SPDX-License-Identifier: BSD-3-Clause
// Fails when a port is empty, misnames an array or holds values that cannot be.
#include "RemesherTesting.h"

#include "vtkDataArray.h"

namespace
{
bool HasTuples(vtkDataSetAttributes* data, const char* name, vtkIdType tuples, int components)
{
  vtkDataArray* array = data->GetArray(name);
  return array && array->GetNumberOfTuples() == tuples && array->GetNumberOfComponents() == components;
}

bool Within(vtkDataArray* array, double low, double high)
{
  double range[2];
  array->GetRange(range, 0);
  return range[0] >= low && range[1] <= high;
}
}

int TestPorts(int, char*[])
{
  Checks checks;
  const auto torus = MakeTorus();
  vtkNew<vtkAnisotropicQuadRemesher> filter;
  filter->SetInputData(torus);
  filter->SetDensityModeToNumberOfPoints();
  filter->SetTargetNumberOfPoints(800);
  filter->Update();

  vtkPolyData* mesh = filter->GetOutput(vtkAnisotropicQuadRemesher::REMESHED);
  const vtkIdType points = mesh->GetNumberOfPoints();
  const vtkIdType faces = mesh->GetNumberOfPolys();
  const Topology topology(mesh);
  std::cout << points << " points, " << faces << " faces, " << topology.Quads << " quads\n";
  CHECK(points >= 760 && points <= 840);
  CHECK(topology.Manifold && topology.BoundaryEdges == 0 && topology.EulerNumber == 0);
  CHECK(topology.Quads > 0.72 * faces);
  CHECK(HasTuples(mesh->GetPointData(), "Normals", points, 3));
  CHECK(HasTuples(mesh->GetPointData(), "PointKind", points, 1));
  CHECK(HasTuples(mesh->GetCellData(), "NumberOfSides", faces, 1));
  CHECK(Within(mesh->GetCellData()->GetArray("NumberOfSides"), 3, 5));
  CHECK(HasTuples(mesh->GetCellData(), "SourceCellId", faces, 1));
  CHECK(Within(mesh->GetCellData()->GetArray("SourceCellId"), 0, static_cast<double>(torus->GetNumberOfCells() - 1)));
  for (vtkIdType p = 0; p < points; ++p)
  {
    double x[3];
    double normal[3];
    mesh->GetPoint(p, x);
    mesh->GetPointData()->GetArray("Normals")->GetTuple(p, normal);
    const double ring = std::hypot(x[0], x[1]);
    const double outward[3] = { x[0] - 3 * x[0] / ring, x[1] - 3 * x[1] / ring, x[2] };
    CHECK(vtkMath::Dot(normal, outward) > 0.9);
  }

  vtkPolyData* directions = filter->GetOutput(vtkAnisotropicQuadRemesher::PRINCIPAL_DIRECTIONS);
  const vtkIdType n = directions->GetNumberOfPoints();
  CHECK(n >= torus->GetNumberOfPoints() && directions->GetNumberOfPolys() >= torus->GetNumberOfPolys());
  for (const char* name : { "MinDirection", "MaxDirection", "Normals" })
  {
    CHECK(HasTuples(directions->GetPointData(), name, n, 3));
  }
  for (const char* name : { "MinCurvature", "MaxCurvature" })
  {
    CHECK(HasTuples(directions->GetPointData(), name, n, 1));
  }
  // Across the tube the curvature is 1 everywhere; along it, between -1/2 inside and 1/4 outside.
  double largest = 0.0;
  double smallest = 0.0;
  for (vtkIdType p = 0; p < n; ++p)
  {
    largest += directions->GetPointData()->GetArray("MaxCurvature")->GetComponent(p, 0) / n;
    smallest = std::min(smallest, directions->GetPointData()->GetArray("MinCurvature")->GetComponent(p, 0));
  }
  std::cout << "mean maximum curvature " << largest << ", least minimum curvature " << smallest << "\n";
  CHECK(std::abs(largest - 1.0) < 0.1);
  CHECK(std::abs(smallest + 0.5) < 0.1);

  vtkPolyData* confidence = filter->GetOutput(vtkAnisotropicQuadRemesher::CONFIDENCE);
  CHECK(HasTuples(confidence->GetPointData(), "Confidence", n, 1));
  CHECK(Within(confidence->GetPointData()->GetArray("Confidence"), 0, 1));
  CHECK(HasTuples(confidence->GetCellData(), "Confidence", confidence->GetNumberOfPolys(), 1));
  CHECK(Within(confidence->GetCellData()->GetArray("Confidence"), 0, 1));

  vtkPolyData* lines = filter->GetOutput(vtkAnisotropicQuadRemesher::INTEGRATED_LINES);
  CHECK(lines->GetNumberOfLines() > 10);
  for (const char* name : { "LineType", "LineId", "StartReason", "EndReason" })
  {
    CHECK(HasTuples(lines->GetCellData(), name, lines->GetNumberOfLines(), 1));
  }
  for (const char* name : { "Curvature", "ArcLength", "SourceCellId", "Isotropic" })
  {
    CHECK(HasTuples(lines->GetPointData(), name, lines->GetNumberOfPoints(), 1));
  }
  CHECK(Within(lines->GetCellData()->GetArray("LineType"), vtkAnisotropicQuadRemesher::MINIMUM_LINE,
    vtkAnisotropicQuadRemesher::MAXIMUM_LINE));

  filter->GenerateDirectionsOff();
  filter->GenerateConfidenceOff();
  filter->GenerateLinesOff();
  filter->Update();
  CHECK(filter->GetOutput(0)->GetNumberOfPolys() == faces);
  for (int port = 1; port < 4; ++port)
  {
    CHECK(filter->GetOutput(port)->GetNumberOfPoints() == 0);
  }
  return checks.ExitCode();
}
