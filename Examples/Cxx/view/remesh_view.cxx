// SPDX-License-Identifier: BSD-3-Clause
// Reader -> filter -> mapper in C++:
//
//     remesh-view [SURFACE.ply] [--tolerance FRACTION] [--off-screen FILE.png]
//
// shows a surface (a torus when none is named) remeshed. A slider changes the tolerance; four check boxes
// show and hide the ports: mesh, directions, confidence, lines. With --off-screen the picture is written to a
// file and no window opens.
#include "vtkActor.h"
#include "vtkAnisotropicQuadRemesher.h"
#include "vtkButtonRepresentation.h"
#include "vtkButtonWidget.h"
#include "vtkCallbackCommand.h"
#include "vtkCamera.h"
#include "vtkCommand.h"
#include "vtkGlyph3DMapper.h"
#include "vtkImageData.h"
#include "vtkInteractorStyleTrackballCamera.h"
#include "vtkLineSource.h"
#include "vtkLookupTable.h"
#include "vtkMaskPoints.h"
#include "vtkNew.h"
#include "vtkPLYReader.h"
#include "vtkPNGWriter.h"
#include "vtkParametricFunctionSource.h"
#include "vtkParametricTorus.h"
#include "vtkPolyData.h"
#include "vtkPolyDataMapper.h"
#include "vtkProperty.h"
#include "vtkProperty2D.h"
#include "vtkRenderWindow.h"
#include "vtkRenderWindowInteractor.h"
#include "vtkRenderer.h"
#include "vtkSliderRepresentation2D.h"
#include "vtkSliderWidget.h"
#include "vtkSmartPointer.h"
#include "vtkTextActor.h"
#include "vtkTextProperty.h"
#include "vtkTexturedButtonRepresentation2D.h"
#include "vtkWindowToImageFilter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <string>
#include <vector>

namespace
{
// What is drawn of one port: switched on and off as a whole.
struct Port
{
  const char* Name;
  std::vector<vtkSmartPointer<vtkActor>> Actors;

  void Show(bool visible)
  {
    for (vtkActor* actor : this->Actors)
    {
      actor->SetVisibility(visible);
    }
  }
};
using Ports = std::array<Port, 4>;

//------------------------------------------------------------------------------
vtkSmartPointer<vtkActor> NewActor(vtkMapper* mapper)
{
  auto actor = vtkSmartPointer<vtkActor>::New();
  actor->SetMapper(mapper);
  return actor;
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkActor> Mesh(vtkAnisotropicQuadRemesher* remesh)
{
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputConnection(remesh->GetOutputPort(vtkAnisotropicQuadRemesher::REMESHED));
  mapper->ScalarVisibilityOff();
  auto actor = NewActor(mapper);
  actor->GetProperty()->EdgeVisibilityOn();
  return actor;
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkActor> Directions(vtkAnisotropicQuadRemesher* remesh, bool minimum, double length)
{
  vtkNew<vtkMaskPoints> some;
  some->SetInputConnection(remesh->GetOutputPort(vtkAnisotropicQuadRemesher::PRINCIPAL_DIRECTIONS));
  some->SetOnRatio(5);
  vtkNew<vtkLineSource> stroke;
  stroke->SetPoint1(-0.5, 0.0, 0.0);
  stroke->SetPoint2(0.5, 0.0, 0.0);
  vtkNew<vtkGlyph3DMapper> mapper;
  mapper->SetInputConnection(some->GetOutputPort());
  mapper->SetSourceConnection(stroke->GetOutputPort());
  mapper->SetOrientationArray(minimum ? "MinDirection" : "MaxDirection");
  mapper->SetScaleFactor(length);
  mapper->ScalarVisibilityOff();
  auto actor = NewActor(mapper);
  actor->GetProperty()->SetColor(minimum ? 0.16 : 0.84, 0.25, minimum ? 0.79 : 0.15);
  actor->GetProperty()->SetLineWidth(2.0F);
  actor->GetProperty()->LightingOff();
  return actor;
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkActor> Confidence(vtkAnisotropicQuadRemesher* remesh)
{
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputConnection(remesh->GetOutputPort(vtkAnisotropicQuadRemesher::CONFIDENCE));
  mapper->SetScalarModeToUsePointFieldData();
  mapper->SelectColorArray("Confidence");
  mapper->SetScalarRange(0.0, 1.0);
  return NewActor(mapper);
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkActor> Lines(vtkAnisotropicQuadRemesher* remesh)
{
  vtkNew<vtkLookupTable> colors;
  colors->SetNumberOfTableValues(4);
  colors->SetTableValue(vtkAnisotropicQuadRemesher::MINIMUM_LINE, 0.16, 0.38, 0.79);
  colors->SetTableValue(vtkAnisotropicQuadRemesher::MAXIMUM_LINE, 0.84, 0.19, 0.15);
  colors->SetTableValue(vtkAnisotropicQuadRemesher::BOUNDARY_LINE, 0.10, 0.55, 0.20);
  colors->SetTableValue(vtkAnisotropicQuadRemesher::FEATURE_LINE, 0.95, 0.65, 0.10);
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputConnection(remesh->GetOutputPort(vtkAnisotropicQuadRemesher::INTEGRATED_LINES));
  mapper->SetScalarModeToUseCellFieldData();
  mapper->SelectColorArray("LineType");
  mapper->SetLookupTable(colors);
  mapper->SetScalarRange(vtkAnisotropicQuadRemesher::MINIMUM_LINE, vtkAnisotropicQuadRemesher::FEATURE_LINE);
  auto actor = NewActor(mapper);
  actor->GetProperty()->SetLineWidth(2.0F);
  return actor;
}

//------------------------------------------------------------------------------
// The slider moves in powers of ten, since the number of points does so too.
void OnSlider(vtkObject* caller, unsigned long, void* data, void*)
{
  auto* slider = static_cast<vtkSliderWidget*>(caller);
  const double power = static_cast<vtkSliderRepresentation2D*>(slider->GetRepresentation())->GetValue();
  static_cast<vtkAnisotropicQuadRemesher*>(data)->SetTolerance(std::pow(10.0, power));
}

void OnToggle(vtkObject* caller, unsigned long, void* data, void*)
{
  auto* button = static_cast<vtkButtonWidget*>(caller);
  static_cast<Port*>(data)->Show(static_cast<vtkButtonRepresentation*>(button->GetRepresentation())->GetState() == 0);
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkSliderWidget> AddSlider(vtkRenderWindowInteractor* interactor, vtkAnisotropicQuadRemesher* remesh)
{
  vtkNew<vtkSliderRepresentation2D> looks;
  looks->SetMinimumValue(-4.0);
  looks->SetMaximumValue(-2.0);
  looks->SetValue(std::log10(remesh->GetTolerance()));
  looks->SetTitleText("log10(tolerance)");
  looks->GetTitleProperty()->SetColor(0.0, 0.0, 0.0);
  looks->GetLabelProperty()->SetColor(0.0, 0.0, 0.0);
  looks->GetPoint1Coordinate()->SetCoordinateSystemToNormalizedDisplay();
  looks->GetPoint1Coordinate()->SetValue(0.35, 0.08);
  looks->GetPoint2Coordinate()->SetCoordinateSystemToNormalizedDisplay();
  looks->GetPoint2Coordinate()->SetValue(0.95, 0.08);
  auto slider = vtkSmartPointer<vtkSliderWidget>::New();
  slider->SetInteractor(interactor);
  slider->SetRepresentation(looks);
  vtkNew<vtkCallbackCommand> onRelease;
  onRelease->SetCallback(OnSlider);
  onRelease->SetClientData(remesh);
  slider->AddObserver(vtkCommand::EndInteractionEvent, onRelease); // not while it is being dragged
  slider->EnabledOn();
  return slider;
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkImageData> Box(bool full)
{
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetDimensions(20, 20, 1);
  image->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
  auto* pixel = static_cast<unsigned char*>(image->GetScalarPointer());
  for (int i = 0; i < 400; ++i, pixel += 3)
  {
    const bool frame = i % 20 < 2 || i % 20 > 17 || i / 20 < 2 || i / 20 > 17;
    std::fill_n(pixel, 3, static_cast<unsigned char>(frame ? 0 : (full ? 90 : 255)));
  }
  return image;
}

vtkSmartPointer<vtkButtonWidget> AddToggle(
  vtkRenderWindowInteractor* interactor, vtkRenderer* renderer, Port& port, int row, bool on)
{
  vtkNew<vtkTexturedButtonRepresentation2D> looks;
  looks->SetNumberOfStates(2);
  looks->SetButtonTexture(0, Box(true));
  looks->SetButtonTexture(1, Box(false));
  looks->SetState(on ? 0 : 1);
  looks->SetPlaceFactor(1.0);
  const double y = 20.0 + 30.0 * row;
  double bounds[6] = { 20.0, 40.0, y, y + 20.0, 0.0, 0.0 };
  looks->PlaceWidget(bounds);
  auto button = vtkSmartPointer<vtkButtonWidget>::New();
  button->SetInteractor(interactor);
  button->SetRepresentation(looks);
  vtkNew<vtkCallbackCommand> onChange;
  onChange->SetCallback(OnToggle);
  onChange->SetClientData(&port);
  button->AddObserver(vtkCommand::StateChangedEvent, onChange);
  button->EnabledOn();
  vtkNew<vtkTextActor> label;
  label->SetInput(port.Name);
  label->SetPosition(50.0, y);
  label->GetTextProperty()->SetFontSize(16);
  label->GetTextProperty()->SetColor(0.0, 0.0, 0.0);
  renderer->AddViewProp(label);
  return button;
}

//------------------------------------------------------------------------------
int WritePicture(vtkRenderWindow* window, vtkAnisotropicQuadRemesher* remesh, const std::string& file)
{
  window->Render();
  vtkNew<vtkWindowToImageFilter> image;
  image->SetInput(window);
  vtkNew<vtkPNGWriter> writer;
  writer->SetInputConnection(image->GetOutputPort());
  writer->SetFileName(file.c_str());
  writer->Write();
  std::cout << remesh->GetOutput()->GetNumberOfPolys() << " faces\n";
  return remesh->GetOutput()->GetNumberOfPolys() > 0 && writer->GetErrorCode() == 0 ? 0 : 1;
}
}

//------------------------------------------------------------------------------
int main(int argc, char** argv)
{
  std::string file;
  std::string picture;
  vtkNew<vtkAnisotropicQuadRemesher> remesh;
  remesh->SetTolerance(0.001);
  for (int i = 1; i < argc; ++i)
  {
    const std::string word = argv[i];
    if (word == "--off-screen" && i + 1 < argc)
    {
      picture = argv[++i];
    }
    else if (word == "--tolerance" && i + 1 < argc)
    {
      remesh->SetTolerance(std::atof(argv[++i]));
    }
    else
    {
      file = word;
    }
  }

  vtkSmartPointer<vtkPolyDataAlgorithm> source;
  if (file.empty())
  {
    vtkNew<vtkParametricTorus> torus;
    vtkNew<vtkParametricFunctionSource> surface;
    surface->SetParametricFunction(torus);
    surface->SetUResolution(150);
    surface->SetVResolution(80);
    source = surface;
  }
  else
  {
    vtkNew<vtkPLYReader> reader;
    reader->SetFileName(file.c_str());
    source = reader;
  }
  source->Update();
  remesh->SetInputConnection(source->GetOutputPort());

  const double stroke = 0.02 * source->GetOutput()->GetLength();
  Ports ports = { { { "Remeshed", { Mesh(remesh) } },
    { "Principal directions", { Directions(remesh, true, stroke), Directions(remesh, false, stroke) } },
    { "Confidence", { Confidence(remesh) } }, { "Integrated lines", { Lines(remesh) } } } };
  vtkNew<vtkRenderer> renderer;
  renderer->SetBackground(1.0, 1.0, 1.0);
  vtkNew<vtkRenderWindow> window;
  window->SetSize(900, 800);
  window->SetOffScreenRendering(!picture.empty());
  window->AddRenderer(renderer);
  vtkNew<vtkRenderWindowInteractor> interactor;
  vtkNew<vtkInteractorStyleTrackballCamera> style;
  interactor->SetInteractorStyle(style);
  interactor->SetRenderWindow(window);

  for (Port& port : ports)
  {
    for (vtkActor* actor : port.Actors)
    {
      renderer->AddActor(actor);
    }
  }
  ports[vtkAnisotropicQuadRemesher::PRINCIPAL_DIRECTIONS].Show(false);
  ports[vtkAnisotropicQuadRemesher::CONFIDENCE].Show(false);
  renderer->GetActiveCamera()->SetPosition(0.0, -1.0, 1.0);
  renderer->GetActiveCamera()->SetViewUp(0.0, 0.0, 1.0);
  renderer->ResetCamera(source->GetOutput()->GetBounds());
  if (!picture.empty())
  {
    return WritePicture(window, remesh, picture);
  }

  window->Render();
  const auto slider = AddSlider(interactor, remesh);
  std::vector<vtkSmartPointer<vtkButtonWidget>> toggles;
  for (int i = 0; i < 4; ++i)
  {
    Port& port = ports[static_cast<size_t>(i)];
    toggles.push_back(AddToggle(interactor, renderer, port, 3 - i, port.Actors[0]->GetVisibility() != 0));
  }
  window->Render();
  interactor->Start();
  return 0;
}
