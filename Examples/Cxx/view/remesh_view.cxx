// SPDX-License-Identifier: BSD-3-Clause
// Reader -> filter -> mapper in C++:
//
//     remesh-view [SURFACE.ply] [--picture FILE.png]
//
// shows a surface (a torus when none is named) remeshed, with the traced lines on it; with --picture
// it renders off-screen and stops. Keys: m and l toggle mesh and lines, + and - change the tolerance.
#include "vtkActor.h"
#include "vtkAnisotropicQuadRemesher.h"
#include "vtkCallbackCommand.h"
#include "vtkInteractorStyleTrackballCamera.h"
#include "vtkNew.h"
#include "vtkPLYReader.h"
#include "vtkPNGWriter.h"
#include "vtkParametricFunctionSource.h"
#include "vtkParametricTorus.h"
#include "vtkPolyData.h"
#include "vtkPolyDataMapper.h"
#include "vtkProperty.h"
#include "vtkRenderWindow.h"
#include "vtkRenderWindowInteractor.h"
#include "vtkRenderer.h"
#include "vtkWindowToImageFilter.h"

#include <iostream>
#include <string>

namespace
{
struct Scene
{
  vtkAnisotropicQuadRemesher* Filter;
  vtkActor* Mesh;
  vtkActor* Lines;
};

//------------------------------------------------------------------------------
void OnKey(vtkObject* caller, unsigned long, void* data, void*)
{
  auto* interactor = static_cast<vtkRenderWindowInteractor*>(caller);
  auto* scene = static_cast<Scene*>(data);
  const std::string key = interactor->GetKeySym();
  if (key == "m")
  {
    scene->Mesh->SetVisibility(!scene->Mesh->GetVisibility());
  }
  else if (key == "l")
  {
    scene->Lines->SetVisibility(!scene->Lines->GetVisibility());
  }
  else if (key == "plus" || key == "minus")
  {
    scene->Filter->SetTolerance(scene->Filter->GetTolerance() * (key == "plus" ? 1.5 : 1 / 1.5));
  }
  interactor->Render();
}
}

//------------------------------------------------------------------------------
int main(int argc, char** argv)
{
  std::string file;
  std::string picture;
  for (int i = 1; i < argc; ++i)
  {
    const std::string word = argv[i];
    if (word == "--picture" && i + 1 < argc)
    {
      picture = argv[++i];
    }
    else
    {
      file = word;
    }
  }

  vtkNew<vtkAnisotropicQuadRemesher> remesh;
  if (file.empty())
  {
    vtkNew<vtkParametricTorus> torus;
    vtkNew<vtkParametricFunctionSource> source;
    source->SetParametricFunction(torus);
    source->SetUResolution(150);
    source->SetVResolution(80);
    remesh->SetInputConnection(source->GetOutputPort());
  }
  else
  {
    vtkNew<vtkPLYReader> reader;
    reader->SetFileName(file.c_str());
    remesh->SetInputConnection(reader->GetOutputPort());
  }
  remesh->SetTolerance(0.001);

  vtkNew<vtkPolyDataMapper> meshMapper;
  meshMapper->SetInputConnection(remesh->GetOutputPort(vtkAnisotropicQuadRemesher::REMESHED));
  meshMapper->ScalarVisibilityOff();
  vtkNew<vtkActor> mesh;
  mesh->SetMapper(meshMapper);
  mesh->GetProperty()->EdgeVisibilityOn();

  vtkNew<vtkPolyDataMapper> linesMapper;
  linesMapper->SetInputConnection(remesh->GetOutputPort(vtkAnisotropicQuadRemesher::INTEGRATED_LINES));
  linesMapper->SetScalarModeToUseCellFieldData();
  linesMapper->SelectColorArray("LineType");
  linesMapper->SetScalarRange(vtkAnisotropicQuadRemesher::MINIMUM_LINE, vtkAnisotropicQuadRemesher::FEATURE_LINE);
  vtkNew<vtkActor> lines;
  lines->SetMapper(linesMapper);
  lines->GetProperty()->SetLineWidth(2.0F);

  vtkNew<vtkRenderer> renderer;
  renderer->SetBackground(1.0, 1.0, 1.0);
  renderer->AddActor(mesh);
  renderer->AddActor(lines);
  vtkNew<vtkRenderWindow> window;
  window->SetSize(800, 800);
  window->SetOffScreenRendering(!picture.empty());
  window->AddRenderer(renderer);

  if (!picture.empty())
  {
    window->Render();
    vtkNew<vtkWindowToImageFilter> image;
    image->SetInput(window);
    vtkNew<vtkPNGWriter> writer;
    writer->SetInputConnection(image->GetOutputPort());
    writer->SetFileName(picture.c_str());
    writer->Write();
    std::cout << remesh->GetOutput()->GetNumberOfPolys() << " faces\n";
    return remesh->GetOutput()->GetNumberOfPolys() > 0 ? 0 : 1;
  }

  Scene scene = { remesh, mesh, lines };
  vtkNew<vtkCallbackCommand> onKey;
  onKey->SetCallback(OnKey);
  onKey->SetClientData(&scene);
  vtkNew<vtkInteractorStyleTrackballCamera> style;
  vtkNew<vtkRenderWindowInteractor> interactor;
  interactor->SetInteractorStyle(style);
  interactor->SetRenderWindow(window);
  interactor->AddObserver(vtkCommand::KeyPressEvent, onKey);
  window->Render();
  interactor->Start();
  return 0;
}
