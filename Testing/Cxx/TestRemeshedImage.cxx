// SPDX-License-Identifier: BSD-3-Clause
// Fails when the remeshed surface looks otherwise; TestPorts is its numeric twin.
#include "ImageTesting.h"

int TestRemeshedImage(int argc, char* argv[])
{
  return CompareImage(argc, argv,
    [](vtkAnisotropicQuadRemesher* filter, vtkRenderer* renderer)
    {
      vtkNew<vtkPolyDataMapper> mapper;
      mapper->SetInputConnection(filter->GetOutputPort(vtkAnisotropicQuadRemesher::REMESHED));
      mapper->ScalarVisibilityOff();
      AddActor(renderer, mapper)->GetProperty()->EdgeVisibilityOn();
    });
}
