// SPDX-License-Identifier: BSD-3-Clause
// Fails when lines look otherwise where directions are not trusted; TestPictured is its numeric twin.
#include "ImageTesting.h"

int TestIsotropicImage(int argc, char* argv[])
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
      lines->SetScalarModeToUsePointFieldData();
      lines->SelectColorArray("Isotropic");
      lines->SetScalarRange(0, 1);
      AddActor(renderer, lines)->GetProperty()->SetLineWidth(2.0F);
    });
}
