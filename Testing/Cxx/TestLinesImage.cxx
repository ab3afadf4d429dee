// SPDX-License-Identifier: BSD-3-Clause
// Fails when the integrated lines look otherwise; TestPorts is its numeric twin.
#include "ImageTesting.h"

int TestLinesImage(int argc, char* argv[])
{
  return CompareImage(argc, argv,
    [](vtkAnisotropicQuadRemesher* filter, vtkRenderer* renderer)
    {
      vtkNew<vtkPolyDataMapper> surface;
      surface->SetInputConnection(filter->GetOutputPort(vtkAnisotropicQuadRemesher::CONFIDENCE));
      surface->ScalarVisibilityOff();
      surface->SetResolveCoincidentTopologyToPolygonOffset();
      AddActor(renderer, surface);
      vtkNew<vtkPolyDataMapper> lines;
      lines->SetInputConnection(filter->GetOutputPort(vtkAnisotropicQuadRemesher::INTEGRATED_LINES));
      lines->SetScalarModeToUseCellFieldData();
      lines->SelectColorArray("LineType");
      lines->SetScalarRange(vtkAnisotropicQuadRemesher::MINIMUM_LINE, vtkAnisotropicQuadRemesher::FEATURE_LINE);
      AddActor(renderer, lines)->GetProperty()->SetLineWidth(2.0F);
    });
}
