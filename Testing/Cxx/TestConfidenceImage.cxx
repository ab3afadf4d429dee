// SPDX-License-Identifier: BSD-3-Clause
// Fails when the confidence of the directions looks otherwise; TestPorts is its numeric twin.
#include "ImageTesting.h"

int TestConfidenceImage(int argc, char* argv[])
{
  return CompareImage(argc, argv,
    [](vtkAnisotropicQuadRemesher* filter, vtkRenderer* renderer)
    {
      vtkNew<vtkPolyDataMapper> mapper;
      mapper->SetInputConnection(filter->GetOutputPort(vtkAnisotropicQuadRemesher::CONFIDENCE));
      mapper->SetScalarModeToUseCellFieldData();
      mapper->SelectColorArray("Confidence");
      mapper->SetScalarRange(0.0, 1.0);
      AddActor(renderer, mapper);
    });
}
