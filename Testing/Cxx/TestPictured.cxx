// SPDX-License-Identifier: BSD-3-Clause
// The numeric twin of the image tests, on the surfaces they show: fails when creases are lost, the flat is
// trusted, a mesh is not mostly quads, or a line has an impossible type.
#include "ImageTesting.h"

#include "vtkFeatureEdges.h"

namespace
{
double LengthOfCreases(vtkPolyData* surface)
{
  vtkNew<vtkFeatureEdges> creases;
  creases->SetInputData(surface);
  creases->SetFeatureAngle(40.0);
  creases->BoundaryEdgesOff();
  creases->NonManifoldEdgesOff();
  creases->ManifoldEdgesOff();
  creases->Update();
  double length = 0.0;
  vtkPolyData* edges = creases->GetOutput();
  for (vtkIdType i = 0; i < edges->GetNumberOfCells(); ++i)
  {
    vtkNew<vtkIdList> line;
    edges->GetCellPoints(i, line);
    const vtkIdType size = line->GetNumberOfIds();
    const vtkIdType* ends = line->GetPointer(0);
    double a[3];
    double b[3];
    edges->GetPoint(ends[0], a);
    edges->GetPoint(ends[size - 1], b);
    length += std::sqrt(vtkMath::Distance2BetweenPoints(a, b));
  }
  return length;
}

double Mean(vtkDataArray* array)
{
  double sum = 0.0;
  for (vtkIdType i = 0; i < array->GetNumberOfTuples(); ++i)
  {
    sum += array->GetComponent(i, 0);
  }
  return sum / static_cast<double>(std::max<vtkIdType>(1, array->GetNumberOfTuples()));
}
}

int TestPictured(int, char*[])
{
  Checks checks;
  const vtkSmartPointer<vtkPolyData> surfaces[] = { MakeFlange(), MakeBumpyRing(), MakeSheet() };
  double isotropic[3];
  double confidence[3];
  for (int i = 0; i < 3; ++i)
  {
    vtkNew<vtkAnisotropicQuadRemesher> filter;
    filter->SetInputData(surfaces[i]);
    filter->SetTolerance(0.002);
    filter->Update();
    const Topology topology(filter->GetOutput());
    std::cout << topology.Faces << " faces, " << topology.Quads << " quads\n";
    CHECK(topology.Manifold && topology.EulerNumber == (i == 2 ? 1 : 0));
    CHECK((topology.BoundaryEdges > 0) == (i == 2));
    CHECK(topology.Quads > 0.6 * topology.Faces);
    vtkPolyData* lines = filter->GetOutput(vtkAnisotropicQuadRemesher::INTEGRATED_LINES);
    std::map<int, int> types;
    for (vtkIdType line = 0; line < lines->GetNumberOfLines(); ++line)
    {
      types[static_cast<int>(lines->GetCellData()->GetArray("LineType")->GetComponent(line, 0))]++;
    }
    CHECK(types[vtkAnisotropicQuadRemesher::MINIMUM_LINE] > 0 && types[vtkAnisotropicQuadRemesher::MAXIMUM_LINE] > 0);
    CHECK((types[vtkAnisotropicQuadRemesher::FEATURE_LINE] > 0) == (i == 0));
    CHECK((types[vtkAnisotropicQuadRemesher::BOUNDARY_LINE] > 0) == (i == 2));
    isotropic[i] = Mean(lines->GetPointData()->GetArray("Isotropic"));
    confidence[i] =
      Mean(filter->GetOutput(vtkAnisotropicQuadRemesher::CONFIDENCE)->GetCellData()->GetArray("Confidence"));
    if (i == 0)
    {
      const double before = LengthOfCreases(surfaces[0]);
      const double after = LengthOfCreases(filter->GetOutput());
      std::cout << "creases: " << before << " long before, " << after << " after\n";
      CHECK(after > 0.95 * before && after < 1.1 * before);
    }
  }
  std::cout << "isotropic: " << isotropic[0] << ' ' << isotropic[1] << ' ' << isotropic[2] << "; confidence "
            << confidence[0] << ' ' << confidence[1] << ' ' << confidence[2] << "\n";
  CHECK(isotropic[1] < 0.3 && confidence[1] > 0.8);
  return checks.ExitCode();
}
