// SPDX-License-Identifier: BSD-3-Clause
// Fails when a parameter is not clamped, not printed, or does not do what its documentation says.
#include "RemesherTesting.h"

#include "vtkDataArray.h"

#include <algorithm>
#include <limits>
#include <sstream>

namespace
{
vtkIdType CountTuples(vtkDataArray* array, double value)
{
  vtkIdType count = 0;
  for (vtkIdType i = 0; i < array->GetNumberOfTuples(); ++i)
  {
    count += array->GetComponent(i, 0) == value;
  }
  return count;
}

vtkIdType LinesOfType(vtkAnisotropicQuadRemesher* filter, int type)
{
  return CountTuples(filter->GetOutput(3)->GetCellData()->GetArray("LineType"), type);
}

double Largest(vtkPolyData* output, const char* name)
{
  double range[2];
  output->GetPointData()->GetArray(name)->GetRange(range);
  return range[1];
}

double Mean(vtkDataArray* array)
{
  double sum = 0.0;
  for (vtkIdType i = 0; i < array->GetNumberOfTuples(); ++i)
  {
    sum += array->GetComponent(i, 0);
  }
  return sum / static_cast<double>(array->GetNumberOfTuples());
}

std::string Shape(vtkPolyData* output)
{
  std::string bytes;
  for (vtkIdType p = 0; p < output->GetNumberOfPoints(); ++p)
  {
    bytes.append(reinterpret_cast<const char*>(output->GetPoint(p)), 3 * sizeof(double));
  }
  return bytes;
}

vtkSmartPointer<vtkPolyData> NoisyTorus()
{
  auto torus = MakeTorus();
  vtkMath::RandomSeed(1);
  for (vtkIdType p = 0; p < torus->GetNumberOfPoints(); ++p)
  {
    double x[3];
    torus->GetPoint(p, x);
    for (double& value : x)
    {
      value += vtkMath::Random(-0.004, 0.004);
    }
    torus->GetPoints()->SetPoint(p, x);
  }
  return torus;
}
}

int TestParameters(int, char*[])
{
  Checks checks;
  using Filter = vtkAnisotropicQuadRemesher;

  {
    vtkNew<Filter> filter;
    filter->SetTolerance(7.0);
    filter->SetTargetNumberOfPoints(-3);
    filter->SetCurvatureRadius(-1.0);
    filter->SetSmoothingIterations(5000);
    filter->SetConfidenceAngle(91.0);
    filter->SetFeatureAngle(0.0);
    filter->SetLargestSpacing(0.0);
    filter->SetAnisotropy(2.0);
    filter->SetAdaptivity(-1.0);
    filter->SetLargestValence(3);
    filter->SetSeed(-1);
    filter->SetNumberOfThreads(-1);
    filter->SetDensityMode(5);
    CHECK(filter->GetTolerance() == 0.1 && filter->GetTargetNumberOfPoints() == 4);
    CHECK(filter->GetCurvatureRadius() == 0.0 && filter->GetSmoothingIterations() == 1000);
    CHECK(filter->GetConfidenceAngle() == 90.0 && filter->GetFeatureAngle() == 0.1);
    CHECK(filter->GetLargestSpacing() == 1e-4 && filter->GetLargestValence() == 4);
    CHECK(filter->GetAnisotropy() == 1.0 && filter->GetAdaptivity() == 0.0);
    CHECK(filter->GetSeed() == 0 && filter->GetNumberOfThreads() == 0);
    CHECK(filter->GetDensityMode() == Filter::NUMBER_OF_POINTS);
    std::ostringstream text;
    filter->Print(text);
    for (const char* name : { "DensityMode", "Tolerance", "TargetNumberOfPoints", "UseDensityArray", "CurvatureRadius",
           "SmoothingIterations", "ConfidenceAngle", "FeatureLines", "FeatureAngle", "BoundaryLines", "LockLines",
           "UseLockArray", "LargestSpacing", "Anisotropy", "Adaptivity", "PureQuads", "Symmetry", "SymmetryOrigin",
           "SymmetryNormal", "LargestValence", "ConvexPartition", "PreserveTopology", "Seed", "NumberOfThreads",
           "GenerateDirections", "GenerateConfidence", "GenerateLines" })
    {
      checks.Check(text.str().find(std::string("  ") + name + ": ") != std::string::npos, name, __LINE__);
    }
  }

  { // Whatever a number is set to: clamped into its range and used, but for NaN, which passes every clamp and must end
    // in
    // a message that names it.
    struct Number
    {
      const char* Name;
      void (Filter::*Set)(double);
      double (Filter::*Get)();
      double Low, High;
    };
    const Number numbers[] = { { "tolerance", &Filter::SetTolerance, &Filter::GetTolerance, 1e-7, 0.1 },
      { "curvature_radius", &Filter::SetCurvatureRadius, &Filter::GetCurvatureRadius, 0.0, 0.2 },
      { "confidence_angle", &Filter::SetConfidenceAngle, &Filter::GetConfidenceAngle, 0.0, 90.0 },
      { "feature_angle", &Filter::SetFeatureAngle, &Filter::GetFeatureAngle, 0.1, 180.0 },
      { "largest_spacing", &Filter::SetLargestSpacing, &Filter::GetLargestSpacing, 1e-4, 1.0 },
      { "anisotropy", &Filter::SetAnisotropy, &Filter::GetAnisotropy, 0.0, 1.0 },
      { "adaptivity", &Filter::SetAdaptivity, &Filter::GetAdaptivity, 0.0, 1.0 } };
    constexpr double infinite = std::numeric_limits<double>::infinity();
    const auto torus = MakeTorus(12, 6);
    for (const Number& number : numbers)
    {
      vtkNew<Filter> filter;
      Messages messages(filter);
      filter->SetInputData(torus);
      filter->SetTolerance(0.02);
      for (const double value : { -infinite, -1e300, -1.0, -0.0, 0.0, 1e-300, 1e300, infinite })
      {
        (filter->*number.Set)(value);
        CHECK((filter->*number.Get)() == std::min(number.High, std::max(number.Low, value)));
        filter->Update();
        checks.Check(messages.Errors == 0 && filter->GetOutput()->GetNumberOfPolys() > 0, number.Name, __LINE__);
      }
      (filter->*number.Set)(std::numeric_limits<double>::quiet_NaN());
      filter->Update();
      CHECK(messages.Errors == 1 && messages.Says(number.Name) && filter->GetOutput()->GetNumberOfPoints() == 0);
    }
    struct Whole
    {
      const char* Name;
      void (Filter::*Set)(int);
      int (Filter::*Get)();
      int Low, High;
    };
    const Whole wholes[] = { { "SmoothingIterations", &Filter::SetSmoothingIterations, &Filter::GetSmoothingIterations,
                               0, 1000 },
      { "LargestValence", &Filter::SetLargestValence, &Filter::GetLargestValence, 4, 64 },
      { "Seed", &Filter::SetSeed, &Filter::GetSeed, 0, 2147483647 },
      { "NumberOfThreads", &Filter::SetNumberOfThreads, &Filter::GetNumberOfThreads, 0, 1024 },
      { "DensityMode", &Filter::SetDensityMode, &Filter::GetDensityMode, 0, 1 } };
    for (const Whole& whole : wholes)
    {
      vtkNew<Filter> filter;
      Messages messages(filter);
      filter->SetInputData(torus);
      for (const int value : { std::numeric_limits<int>::min(), -1, 0, std::numeric_limits<int>::max() })
      {
        (filter->*whole.Set)(value);
        CHECK((filter->*whole.Get)() == std::min(whole.High, std::max(whole.Low, value)));
        filter->Update();
        checks.Check(messages.Errors == 0 && filter->GetOutput()->GetNumberOfPolys() > 0, whole.Name, __LINE__);
      }
    }
    vtkNew<Filter> filter;
    Messages messages(filter);
    filter->SetInputData(torus);
    filter->SetDensityModeToNumberOfPoints();
    for (const vtkIdType value : { VTK_ID_MIN, vtkIdType(-1), vtkIdType(0), VTK_ID_MAX })
    {
      filter->SetTargetNumberOfPoints(value);
      CHECK(filter->GetTargetNumberOfPoints() == (value > 0 ? 2147483647 : 4));
      filter->Update();
      CHECK(messages.Errors == 0 && filter->GetOutput()->GetNumberOfPolys() > 0);
    }
    filter->SetTargetNumberOfPoints(100);
    filter->SymmetryOn();
    for (const double value : { std::numeric_limits<double>::quiet_NaN(), infinite, -infinite, 1e300 })
    {
      for (int k = 0; k < 6; ++k)
      {
        double plane[6] = { 1.0, 0.0, 0.0, 0.0, 0.0, 0.0 };
        plane[k] = value;
        filter->SetSymmetryNormal(plane);
        filter->SetSymmetryOrigin(plane + 3);
        messages.Clear();
        filter->Update();
        // only a normal that long is as good as any
        const bool good = k < 3 && value == 1e300;
        CHECK(messages.Errors == (good ? 0 : 1) && messages.Says("symmetry_") != good);
        CHECK((filter->GetOutput()->GetNumberOfPoints() > 0) == good);
      }
    }
  }

  { // Density
    vtkNew<Filter> filter;
    filter->SetInputData(MakeTorus());
    filter->SetLargestSpacing(0.3);
    filter->SetTolerance(0.004);
    filter->Update();
    const vtkIdType coarse = filter->GetOutput()->GetNumberOfPoints();
    filter->SetTolerance(0.001);
    filter->Update();
    const vtkIdType fine = filter->GetOutput()->GetNumberOfPoints();
    std::cout << "tolerance 0.004: " << coarse << " points, 0.001: " << fine << "\n";
    // The number of points is inversely proportional to the tolerance.
    CHECK(fine > 2.5 * coarse && fine < 6 * coarse);
    for (const vtkIdType target : { 400, 1500 })
    {
      filter->SetDensityModeToNumberOfPoints();
      filter->SetTargetNumberOfPoints(target);
      filter->Update();
      std::cout << "target " << target << ": " << filter->GetOutput()->GetNumberOfPoints() << " points\n";
      CHECK(std::abs(filter->GetOutput()->GetNumberOfPoints() - target) <= 0.05 * target);
    }
  }

  { // Density array: four times the points on one half.
    auto torus = MakeTorus();
    vtkNew<vtkDoubleArray> scale;
    scale->SetName("scale");
    for (vtkIdType p = 0; p < torus->GetNumberOfPoints(); ++p)
    {
      scale->InsertNextValue(torus->GetPoint(p)[0] > 0 ? 4.0 : 1.0);
    }
    torus->GetPointData()->AddArray(scale);
    vtkNew<Filter> filter;
    filter->SetInputData(torus);
    filter->SetTolerance(0.002);
    filter->UseDensityArrayOn();
    filter->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "scale");
    filter->Update();
    vtkIdType right = 0;
    vtkPolyData* mesh = filter->GetOutput();
    for (vtkIdType p = 0; p < mesh->GetNumberOfPoints(); ++p)
    {
      right += mesh->GetPoint(p)[0] > 0;
    }
    const double ratio = static_cast<double>(right) / static_cast<double>(mesh->GetNumberOfPoints() - right);
    std::cout << "points on the dense half over the other: " << ratio << "\n";
    // Lines around the whole torus must not be as many on both halves: every other one ends.
    CHECK(ratio > 2.8 && ratio < 5.5);
  }

  { // Features
    vtkNew<Filter> filter;
    filter->SetInputData(MakeBox());
    filter->SetLargestSpacing(0.1);
    filter->Update();
    vtkDataArray* kind = filter->GetOutput()->GetPointData()->GetArray("PointKind");
    std::cout << "box: " << CountTuples(kind, 3) << " corners, " << LinesOfType(filter, Filter::FEATURE_LINE)
              << " feature lines, " << Topology(filter->GetOutput()).EulerNumber << " Euler number\n";
    CHECK(CountTuples(kind, 3) == 8 && CountTuples(kind, 2) > 12);
    CHECK(LinesOfType(filter, Filter::FEATURE_LINE) == 12);
    CHECK(Topology(filter->GetOutput()).EulerNumber == 2);
    const vtkIdType points = filter->GetOutput()->GetNumberOfPoints();

    filter->SetLargestSpacing(0.05);
    filter->Update();
    std::cout << "largest spacing 0.1: " << points << " points, 0.05: " << filter->GetOutput()->GetNumberOfPoints()
              << "\n";
    CHECK(filter->GetOutput()->GetNumberOfPoints() > 2 * points);

    filter->SetFeatureAngle(100.0);
    filter->Update();
    CHECK(LinesOfType(filter, Filter::FEATURE_LINE) == 0);
    filter->SetFeatureAngle(80.0);
    filter->FeatureLinesOff();
    filter->Update();
    CHECK(LinesOfType(filter, Filter::FEATURE_LINE) == 0);
  }

  { // Boundary
    vtkNew<Filter> filter;
    filter->SetInputData(MakeSheet());
    filter->SetTolerance(0.002);
    filter->Update();
    CHECK(LinesOfType(filter, Filter::BOUNDARY_LINE) > 0);
    const Topology with(filter->GetOutput());
    filter->BoundaryLinesOff();
    filter->Update();
    const Topology without(filter->GetOutput());
    std::cout << "boundary edges with lines: " << with.BoundaryEdges << ", without: " << without.BoundaryEdges << "\n";
    CHECK(with.EulerNumber == 1 && without.EulerNumber == 1);
    CHECK(without.BoundaryEdges <= with.BoundaryEdges);
  }

  { // Curvature radius and smoothing both calm a noisy field.
    vtkNew<Filter> filter;
    filter->SetInputData(NoisyTorus());
    filter->SetTolerance(0.005);
    filter->SetSmoothingIterations(0);
    filter->SetCurvatureRadius(0.0);
    filter->Update();
    const double sharp = Largest(filter->GetOutput(1), "MaxCurvature");
    const double doubtful = Mean(filter->GetOutput(2)->GetCellData()->GetArray("Confidence"));
    filter->SetSmoothingIterations(20);
    filter->Update();
    const double smoothed = Mean(filter->GetOutput(2)->GetCellData()->GetArray("Confidence"));
    filter->SetSmoothingIterations(0);
    filter->SetCurvatureRadius(0.05);
    filter->Update();
    const double averaged = Largest(filter->GetOutput(1), "MaxCurvature");
    std::cout << "largest curvature " << sharp << ", averaged " << averaged << "; mean confidence " << doubtful
              << ", smoothed " << smoothed << "\n";
    CHECK(averaged < sharp);
    CHECK(smoothed > doubtful);

    // Directions that are not trusted do not lead lines.
    filter->SetCurvatureRadius(0.01);
    filter->SetConfidenceAngle(90.0);
    filter->Update();
    const std::string trusting = Shape(filter->GetOutput(3));
    filter->SetConfidenceAngle(1.0);
    filter->Update();
    CHECK(Shape(filter->GetOutput(3)) != trusting);
  }

  { // Faces
    vtkNew<Filter> filter;
    filter->SetInputData(NoisyTorus());
    filter->SetTolerance(0.001);
    for (const int valence : { 4, 5, 8 })
    {
      filter->SetLargestValence(valence);
      filter->Update();
      double range[2];
      filter->GetOutput()->GetCellData()->GetArray("NumberOfSides")->GetRange(range);
      std::cout << "largest valence " << valence << ": " << filter->GetOutput()->GetNumberOfPolys()
                << " faces of up to " << range[1] << " sides\n";
      CHECK(range[1] <= valence);
    }
    const vtkIdType convex = filter->GetOutput()->GetNumberOfPolys();
    filter->ConvexPartitionOff();
    filter->Update();
    std::cout << "faces with concave ones split: " << convex << ", left: " << filter->GetOutput()->GetNumberOfPolys()
              << "\n";
    CHECK(filter->GetOutput()->GetNumberOfPolys() <= convex);
  }

  { // Topology: a thin handle survives a coarse mesh.
    vtkNew<Filter> filter;
    filter->SetInputData(MakeTorus());
    filter->SetTolerance(0.03);
    filter->SetLargestSpacing(0.5);
    filter->Update();
    std::cout << "coarse torus: " << filter->GetOutput()->GetNumberOfPoints() << " points, Euler number "
              << Topology(filter->GetOutput()).EulerNumber << "\n";
    CHECK(Topology(filter->GetOutput()).EulerNumber == 0 && Topology(filter->GetOutput()).Manifold);
    filter->PreserveTopologyOff();
    filter->Update();
    CHECK(Topology(filter->GetOutput()).Manifold);
  }
  return checks.ExitCode();
}
