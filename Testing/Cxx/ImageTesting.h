// SPDX-License-Identifier: BSD-3-Clause
// What the image tests share: three surfaces side by side, seen alike.
#ifndef ImageTesting_h
#define ImageTesting_h

#include "RemesherTesting.h"

#include "vtkActor.h"
#include "vtkCamera.h"
#include "vtkPolyDataMapper.h"
#include "vtkProperty.h"
#include "vtkRegressionTestImage.h"
#include "vtkRenderWindow.h"
#include "vtkRenderWindowInteractor.h"
#include "vtkRenderer.h"

// The renderer of Mesa and those of graphics cards differ by less; a missing or wrong mesh by far more.
constexpr double ImageTolerance = 15.0;

// A turned part: rims with sharp edges, a bore and a groove.
inline vtkSmartPointer<vtkPolyData> MakeFlange()
{
  const double profile[][2] = { { 1.0, 0.0 }, { 2.6, 0.0 }, { 2.6, 0.5 }, { 1.7, 0.5 }, { 1.5, 1.6 }, { 1.0, 1.6 } };
  constexpr int corners = 6;
  constexpr int steps = 10;
  return MakeGrid(120, corners * steps, true, true,
    [&](double u, double v, double* p)
    {
      const double position = v * corners;
      const int corner = static_cast<int>(position + 1e-9);
      const double t = position - corner;
      const double* a = profile[corner % corners];
      const double* b = profile[(corner + 1) % corners];
      const double radius = a[0] + t * (b[0] - a[0]);
      p[0] = radius * std::cos(2 * vtkMath::Pi() * u);
      p[1] = radius * std::sin(2 * vtkMath::Pi() * u);
      p[2] = a[1] + t * (b[1] - a[1]);
    });
}

// A ring with bumps.
inline vtkSmartPointer<vtkPolyData> MakeBumpyRing()
{
  return MakeGrid(160, 60, true, true,
    [](double u, double v, double* p)
    {
      u *= 2 * vtkMath::Pi();
      v *= 2 * vtkMath::Pi();
      const double tube = 0.8 + 0.2 * std::cos(5 * u) + 0.08 * std::sin(3 * v);
      p[0] = (2.2 + tube * std::cos(v)) * std::cos(u);
      p[1] = (2.2 + tube * std::cos(v)) * std::sin(u);
      p[2] = tube * std::sin(v);
    });
}

// Calls show(filter, renderer) for a technical part, an organic shape and an open sheet, renders them in
// three viewports and compares with the baseline.
inline int CompareImage(
  int argc, char* argv[], const std::function<void(vtkAnisotropicQuadRemesher*, vtkRenderer*)>& show)
{
  vtkNew<vtkRenderWindow> window;
  window->SetMultiSamples(0);
  window->SetSize(900, 300);
  const vtkSmartPointer<vtkPolyData> surfaces[] = { MakeFlange(), MakeBumpyRing(), MakeSheet() };
  for (int i = 0; i < 3; ++i)
  {
    vtkNew<vtkAnisotropicQuadRemesher> filter;
    filter->SetInputData(surfaces[i]);
    filter->SetTolerance(0.002);
    vtkNew<vtkRenderer> renderer;
    renderer->SetViewport(i / 3.0, 0.0, (i + 1) / 3.0, 1.0);
    renderer->SetBackground(1.0, 1.0, 1.0);
    show(filter, renderer);
    renderer->GetActiveCamera()->SetPosition(0.0, -1.2, 1.0);
    renderer->GetActiveCamera()->SetViewUp(0.0, 0.0, 1.0);
    renderer->ResetCamera(surfaces[i]->GetBounds());
    renderer->GetActiveCamera()->Zoom(1.3);
    window->AddRenderer(renderer);
  }
  vtkNew<vtkRenderWindowInteractor> interactor;
  interactor->SetRenderWindow(window);
  window->Render();
  const int result = vtkRegressionTestImageThreshold(window, ImageTolerance);
  if (result == vtkRegressionTester::DO_INTERACTOR)
  {
    interactor->Start();
  }
  return result ? EXIT_SUCCESS : EXIT_FAILURE;
}

inline vtkSmartPointer<vtkActor> AddActor(vtkRenderer* renderer, vtkPolyDataMapper* mapper)
{
  auto actor = vtkSmartPointer<vtkActor>::New();
  actor->SetMapper(mapper);
  renderer->AddActor(actor);
  return actor;
}

#endif
