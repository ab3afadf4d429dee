// SPDX-License-Identifier: BSD-3-Clause
// Fails when an array of the input is lost or changed: linear fields must stay linear, names must stay
// names, cell data must come from below the new face.
#include "RemesherTesting.h"

#include "vtkFloatArray.h"
#include "vtkIdTypeArray.h"
#include "vtkIntArray.h"
#include "vtkStringArray.h"

namespace
{
double Linear(const double* x)
{
  return 5.0 + x[0] - 2.0 * x[1] + 3.0 * x[2];
}
}

int TestAttributes(int, char*[])
{
  Checks checks;
  const auto sheet = MakeSheet();
  const vtkIdType n = sheet->GetNumberOfPoints();
  vtkNew<vtkDoubleArray> linear;
  linear->SetName("linear");
  vtkNew<vtkFloatArray> vectors;
  vectors->SetName("position");
  vectors->SetNumberOfComponents(3);
  vtkNew<vtkFloatArray> texture;
  texture->SetName("texture");
  texture->SetNumberOfComponents(2);
  vtkNew<vtkIntArray> number;
  number->SetName("number");
  vtkNew<vtkStringArray> name;
  name->SetName("name");
  vtkNew<vtkIdTypeArray> ids;
  ids->SetName("ids");
  for (vtkIdType p = 0; p < n; ++p)
  {
    double x[3];
    sheet->GetPoint(p, x);
    linear->InsertNextValue(Linear(x));
    vectors->InsertNextTuple(x);
    texture->InsertNextTuple2(x[0] / 4, x[1] / 4);
    number->InsertNextValue(x[0] < 2 ? 7 : 9);
    name->InsertNextValue(x[0] < 2 ? "left" : "right");
    ids->InsertNextValue(p);
  }
  vtkPointData* data = sheet->GetPointData();
  data->SetScalars(linear);
  data->SetVectors(vectors);
  data->SetTCoords(texture);
  data->AddArray(number);
  data->AddArray(name);
  data->SetGlobalIds(ids);
  vtkNew<vtkDoubleArray> center;
  center->SetName("center");
  vtkNew<vtkStringArray> half;
  half->SetName("half");
  for (vtkIdType c = 0; c < sheet->GetNumberOfCells(); ++c)
  {
    double bounds[6];
    sheet->GetCellBounds(c, bounds);
    center->InsertNextValue((bounds[0] + bounds[1]) / 2);
    half->InsertNextValue(center->GetValue(c) < 2 ? "left" : "right");
  }
  sheet->GetCellData()->SetScalars(center);
  sheet->GetCellData()->AddArray(half);
  vtkNew<vtkStringArray> title;
  title->SetName("title");
  title->InsertNextValue("a sheet");
  sheet->GetFieldData()->AddArray(title);

  vtkNew<vtkAnisotropicQuadRemesher> filter;
  filter->SetInputData(sheet);
  filter->SetTolerance(0.001);
  filter->Update();

  double range[2];
  linear->GetRange(range);
  for (const int port : { 0, 1, 2 })
  {
    vtkPolyData* output = filter->GetOutput(port);
    vtkPointData* out = output->GetPointData();
    auto* outLinear = vtkDoubleArray::SafeDownCast(out->GetArray("linear"));
    auto* outName = vtkStringArray::SafeDownCast(out->GetAbstractArray("name"));
    auto* outNumber = vtkIntArray::SafeDownCast(out->GetArray("number"));
    CHECK(outLinear && outName && outNumber);
    vtkDataArray* outPosition = out->GetArray("position");
    CHECK(outPosition && out->GetVectors() && out->GetTCoords());
    CHECK(port == 1 || out->GetVectors() == outPosition);
    CHECK(out->GetGlobalIds() == nullptr && out->GetArray("ids") == nullptr);
    if (!outLinear || !outName || !outNumber || !outPosition || !out->GetTCoords())
    {
      return EXIT_FAILURE;
    }
    double worst = 0.0;
    double farthest = 0.0;
    vtkIdType wrongNames = 0;
    for (vtkIdType p = 0; p < output->GetNumberOfPoints(); ++p)
    {
      // The fit moves points off the input, and there the arrays are those of the point below. The
      // field "position" says where that is.
      double below[3];
      outPosition->GetTuple(p, below);
      worst = std::max(worst, std::abs(outLinear->GetValue(p) - Linear(below)));
      worst = std::max(worst, std::abs(out->GetTCoords()->GetComponent(p, 0) - below[0] / 4));
      const bool left = outName->GetValue(p) == "left";
      wrongNames += std::abs(below[0] - 2) > 0.1 && left != (below[0] < 2);
      wrongNames += outNumber->GetValue(p) != (left ? 7 : 9);
      double x[3];
      output->GetPoint(p, x);
      farthest = std::max(farthest, std::sqrt(vtkMath::Distance2BetweenPoints(x, below)));
    }
    CHECK(farthest < 0.15);
    std::cout << "port " << port << ": worst departure from linear " << worst / (range[1] - range[0])
              << " of the range\n";
    CHECK(worst < 1e-6 * (range[1] - range[0]));
    CHECK(wrongNames == 0);

    auto* outHalf = vtkStringArray::SafeDownCast(output->GetCellData()->GetAbstractArray("half"));
    auto* outCenter = output->GetCellData()->GetScalars();
    CHECK(outHalf && outCenter);
    vtkIdType wrongCells = 0;
    for (vtkIdType c = 0; outHalf && outCenter && c < output->GetNumberOfCells(); ++c)
    {
      double bounds[6];
      output->GetCellBounds(c, bounds);
      const double x = outCenter->GetComponent(c, 0);
      wrongCells += x < bounds[0] - 0.15 || x > bounds[1] + 0.15;
      wrongCells += (outHalf->GetValue(c) == "left") != (x < 2.0);
    }
    CHECK(wrongCells == 0);
  }
  for (int port = 0; port < 4; ++port)
  {
    CHECK(filter->GetOutput(port)->GetFieldData()->GetAbstractArray("title") != nullptr);
  }
  return checks.ExitCode();
}
