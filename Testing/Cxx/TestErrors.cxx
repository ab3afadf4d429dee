// SPDX-License-Identifier: BSD-3-Clause
// Fails when bad use gives no message or several, leaves outputs behind, or spoils the next update.
#include "RemesherTesting.h"

#include "vtkCellArray.h"
#include "vtkErrorCode.h"
#include "vtkExecutive.h"
#include "vtkFloatArray.h"

#include <cmath>
#include <limits>

namespace
{
bool AllEmpty(vtkAnisotropicQuadRemesher* filter)
{
  bool empty = true;
  for (int port = 0; port < 4; ++port)
  {
    empty &= filter->GetOutput(port)->GetNumberOfPoints() == 0 && filter->GetOutput(port)->GetNumberOfCells() == 0;
  }
  return empty;
}

vtkSmartPointer<vtkPolyData> WithPoint(vtkPolyData* surface, double x, double y, double z)
{
  auto copy = vtkSmartPointer<vtkPolyData>::New();
  copy->DeepCopy(surface);
  copy->GetPoints()->SetPoint(17, x, y, z);
  return copy;
}

// Square, of as many strips that lie at right angles to each other.
vtkSmartPointer<vtkPolyData> MakeFoldedSheet(int strips)
{
  return MakeGrid(strips, strips, false, false,
    [strips](double u, double v, double* p)
    {
      p[0] = u * strips;
      p[1] = v * strips;
      p[2] = static_cast<double>(std::lround(p[0]) % 2);
    });
}
}

int TestErrors(int, char*[])
{
  Checks checks;
  const auto good = MakeTorus(40, 20);
  vtkNew<vtkAnisotropicQuadRemesher> filter;
  filter->SetTolerance(0.005);
  Messages messages(filter);

  const auto expectError = [&](vtkPolyData* bad, const std::string& words, int line)
  {
    filter->SetInputData(good);
    filter->Update();
    checks.Check(filter->GetOutput(0)->GetNumberOfPolys() > 0 && messages.Errors == 0, "good input", line);
    filter->SetInputData(bad);
    messages.Clear();
    filter->Update();
    std::cout << messages.Text << "\n";
    checks.Check(messages.Errors == 1, "one error", line);
    checks.Check(messages.Says(words), words.c_str(), line);
    checks.Check(AllEmpty(filter), "empty outputs", line);
    checks.Check(filter->GetErrorCode() >= vtkErrorCode::UserError, "error code", line);
    messages.Clear();
  };

  // Without any input the executive speaks, once, and the filter does not run.
  {
    vtkNew<vtkAnisotropicQuadRemesher> alone;
    Messages executive(alone->GetExecutive());
    alone->Update();
    CHECK(executive.Errors == 1 && executive.Says("0 connections"));
    CHECK(AllEmpty(alone));
    alone->SetInputData(good);
    alone->Update();
    CHECK(alone->GetOutput(0)->GetNumberOfPolys() > 0);
  }

  vtkNew<vtkPolyData> empty;
  expectError(empty, "no polygons", __LINE__);

  vtkNew<vtkPolyData> onlyLines;
  onlyLines->SetPoints(good->GetPoints());
  vtkNew<vtkCellArray> lines;
  const vtkIdType line[2] = { 0, 1 };
  lines->InsertNextCell(2, line);
  onlyLines->SetLines(lines);
  expectError(onlyLines, "no polygons", __LINE__);

  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  expectError(WithPoint(good, 0, nan, 0), "finite", __LINE__);
  expectError(WithPoint(good, 0, 0, -infinity), "finite", __LINE__);

  vtkNew<vtkPolyData> coincident;
  coincident->DeepCopy(good);
  for (vtkIdType p = 0; p < coincident->GetNumberOfPoints(); ++p)
  {
    coincident->GetPoints()->SetPoint(p, 1.0, 2.0, 3.0);
  }
  expectError(coincident, "", __LINE__);

  for (const vtkIdType corners : { 3, 4 })
  {
    vtkNew<vtkPolyData> wild;
    wild->SetPoints(good->GetPoints());
    vtkNew<vtkCellArray> polys;
    const vtkIdType ids[4] = { 0, 1, 2, 1000000 };
    polys->InsertNextCell(corners, ids + 4 - corners);
    wild->SetPolys(polys);
    expectError(wild, "point", __LINE__);
  }

  filter->UseDensityArrayOn();
  filter->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "nowhere");
  filter->SetInputData(good);
  filter->Update();
  CHECK(messages.Errors == 1 && messages.Says("\"nowhere\"") && AllEmpty(filter));
  messages.Clear();

  vtkNew<vtkFloatArray> scale;
  scale->SetName("scale");
  scale->SetNumberOfTuples(good->GetNumberOfPoints());
  scale->FillValue(1.0F);
  scale->SetValue(5, -1.0F);
  vtkNew<vtkPolyData> scaled;
  scaled->ShallowCopy(good);
  scaled->GetPointData()->AddArray(scale);
  filter->SetInputData(scaled);
  filter->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "scale");
  filter->Update();
  CHECK(messages.Errors == 1 && messages.Says("greater than zero") && AllEmpty(filter));
  messages.Clear();

  filter->UseDensityArrayOff();
  filter->Update();
  CHECK(messages.Errors == 0 && filter->GetOutput(0)->GetNumberOfPolys() > 0);
  CHECK(filter->GetErrorCode() == vtkErrorCode::NoError);

  // A target that cannot be met gives the best that can be had, and says so.
  filter->SetInputData(MakeBox(4));
  filter->SetDensityModeToNumberOfPoints();
  filter->SetTargetNumberOfPoints(4);
  filter->Update();
  std::cout << messages.Text << "\n";
  CHECK(messages.Errors == 0 && messages.Warnings == 1 && messages.Says("target"));
  CHECK(filter->GetOutput(0)->GetNumberOfPolys() >= 6);
  messages.Clear();

  // So are creases that are more than it can pay for.
  filter->SetInputData(MakeFoldedSheet(40));
  filter->SetTargetNumberOfPoints(60);
  filter->Update();
  std::cout << messages.Text << "\n";
  CHECK(messages.Errors == 0 && messages.Warnings == 1 && messages.Says("few points cannot follow all creases"));
  CHECK(filter->GetReport().find("\"given_up_edges\": 0,") == std::string::npos);
  messages.Clear();
  filter->SetTargetNumberOfPoints(5000);
  filter->Update();
  CHECK(messages.Errors == 0 && messages.Warnings == 0);
  CHECK(filter->GetReport().find("\"given_up_edges\": 0,") != std::string::npos);
  return checks.ExitCode();
}
