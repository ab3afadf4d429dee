// SPDX-License-Identifier: BSD-3-Clause
// Fails when creases look otherwise than edges of the mesh; TestPictured is its numeric twin.
#include "ImageTesting.h"

#include "vtkFeatureEdges.h"

int TestFeaturesImage(int argc, char* argv[])
{
  return CompareImage(argc, argv,
    [](vtkAnisotropicQuadRemesher* filter, vtkRenderer* renderer)
    {
      vtkNew<vtkPolyDataMapper> mesh;
      mesh->SetInputConnection(filter->GetOutputPort(vtkAnisotropicQuadRemesher::REMESHED));
      mesh->ScalarVisibilityOff();
      mesh->SetResolveCoincidentTopologyToPolygonOffset();
      AddActor(renderer, mesh);
      vtkNew<vtkFeatureEdges> creases;
      creases->SetInputConnection(filter->GetOutputPort(vtkAnisotropicQuadRemesher::REMESHED));
      creases->SetFeatureAngle(40.0);
      creases->ManifoldEdgesOff();
      vtkNew<vtkPolyDataMapper> edges;
      edges->SetInputConnection(creases->GetOutputPort());
      edges->ScalarVisibilityOff();
      const auto actor = AddActor(renderer, edges);
      actor->GetProperty()->SetColor(0.8, 0.1, 0.1);
      actor->GetProperty()->SetLineWidth(6.0F);
    });
}
