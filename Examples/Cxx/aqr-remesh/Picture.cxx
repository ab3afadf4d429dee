// SPDX-License-Identifier: BSD-3-Clause
#include "Picture.h"

#include "vtkActor.h"
#include "vtkCamera.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkGlyph3DMapper.h"
#include "vtkIdList.h"
#include "vtkNew.h"
#include "vtkPNGWriter.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkPolyDataMapper.h"
#include "vtkProperty.h"
#include "vtkRenderWindow.h"
#include "vtkRenderer.h"
#include "vtkSphereSource.h"
#include "vtkUnsignedCharArray.h"
#include "vtkWindowToImageFilter.h"

#include <dlfcn.h>

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

namespace
{
//------------------------------------------------------------------------------
vtkSmartPointer<vtkPolyData> WithColors(vtkPolyData* mesh)
{
  auto surface = vtkSmartPointer<vtkPolyData>::New();
  surface->SetPoints(mesh->GetPoints());
  surface->SetPolys(mesh->GetPolys());
  vtkNew<vtkUnsignedCharArray> colors;
  colors->SetNumberOfComponents(3);
  vtkCellArray* polys = mesh->GetPolys();
  for (vtkIdType face = 0; face < polys->GetNumberOfCells(); ++face)
  {
    const vtkIdType sides = polys->GetCellSize(face);
    if (sides == 4)
    {
      colors->InsertNextTuple3(235, 235, 235);
    }
    else if (sides == 3)
    {
      colors->InsertNextTuple3(120, 160, 235);
    }
    else
    {
      colors->InsertNextTuple3(245, 165, 80);
    }
  }
  surface->GetCellData()->SetScalars(colors);
  return surface;
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkPolyData> IrregularPoints(vtkPolyData* mesh)
{
  using Edge = std::pair<vtkIdType, vtkIdType>;
  std::map<Edge, int> edges;
  vtkNew<vtkIdList> corners;
  vtkCellArray* polys = mesh->GetPolys();
  for (vtkIdType face = 0; face < polys->GetNumberOfCells(); ++face)
  {
    polys->GetCellAtId(face, corners);
    const vtkIdType count = corners->GetNumberOfIds();
    for (vtkIdType i = 0; i < count; ++i)
    {
      edges[std::minmax(corners->GetId(i), corners->GetId((i + 1) % count))]++;
    }
  }
  std::vector<int> valence(static_cast<size_t>(mesh->GetNumberOfPoints()), 0);
  std::vector<bool> boundary(valence.size(), false);
  for (const auto& edge : edges)
  {
    for (const vtkIdType end : { edge.first.first, edge.first.second })
    {
      const auto point = static_cast<size_t>(end);
      valence[point]++;
      boundary[point] = boundary[point] || edge.second == 1;
    }
  }
  vtkNew<vtkPoints> points;
  for (size_t i = 0; i < valence.size(); ++i)
  {
    if (valence[i] > 0 && valence[i] != 4 && !boundary[i])
    {
      points->InsertNextPoint(mesh->GetPoint(static_cast<vtkIdType>(i)));
    }
  }
  auto irregular = vtkSmartPointer<vtkPolyData>::New();
  irregular->SetPoints(points);
  return irregular;
}
}

//------------------------------------------------------------------------------
// X11 is loaded by VTK already; asked by name, no header of it is needed to build.
bool HasDisplay()
{
  using OpenDisplay = void* (*)(const char*);
  using CloseDisplay = int (*)(void*);
  void* library = dlopen("libX11.so.6", RTLD_LAZY);
  if (!library)
  {
    return false;
  }
  const auto open = reinterpret_cast<OpenDisplay>(dlsym(library, "XOpenDisplay"));
  const auto close = reinterpret_cast<CloseDisplay>(dlsym(library, "XCloseDisplay"));
  void* display = open && close ? open(nullptr) : nullptr;
  if (!display)
  {
    return false;
  }
  close(display);
  return true;
}

//------------------------------------------------------------------------------
bool WritePicture(vtkPolyData* mesh, const std::string& file)
{
  vtkNew<vtkRenderer> renderer;
  renderer->SetBackground(1.0, 1.0, 1.0);

  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(WithColors(mesh));
  vtkNew<vtkActor> surface;
  surface->SetMapper(mapper);
  surface->GetProperty()->EdgeVisibilityOn();
  surface->GetProperty()->SetEdgeColor(0.1, 0.1, 0.1);
  surface->GetProperty()->SetLineWidth(1.2F);
  renderer->AddActor(surface);

  vtkNew<vtkSphereSource> dot;
  dot->SetRadius(0.0022 * mesh->GetLength());
  vtkNew<vtkGlyph3DMapper> dots;
  dots->SetInputData(IrregularPoints(mesh));
  dots->SetSourceConnection(dot->GetOutputPort());
  vtkNew<vtkActor> irregular;
  irregular->SetMapper(dots);
  irregular->GetProperty()->SetColor(0.85, 0.1, 0.1);
  renderer->AddActor(irregular);

  double center[3];
  mesh->GetCenter(center);
  vtkCamera* camera = renderer->GetActiveCamera();
  camera->SetFocalPoint(center);
  camera->SetPosition(center[0] + 0.6, center[1] + 0.45, center[2] + 1.0);
  camera->SetViewUp(0.0, 1.0, 0.0);
  renderer->ResetCamera(mesh->GetBounds());
  camera->Zoom(1.25);

  vtkNew<vtkRenderWindow> window;
  window->SetOffScreenRendering(1);
  window->SetMultiSamples(8);
  window->SetSize(900, 900);
  window->AddRenderer(renderer);
  window->Render();
  vtkNew<vtkWindowToImageFilter> image;
  image->SetInput(window);
  vtkNew<vtkPNGWriter> writer;
  writer->SetInputConnection(image->GetOutputPort());
  writer->SetFileName(file.c_str());
  writer->Write();
  return writer->GetErrorCode() == 0;
}
