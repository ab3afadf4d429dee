// SPDX-License-Identifier: BSD-3-Clause
// Fails when the principal directions look otherwise; TestPorts is its numeric twin.
#include "ImageTesting.h"

#include "vtkGlyph3DMapper.h"
#include "vtkLineSource.h"
#include "vtkMaskPoints.h"

int TestDirectionsImage(int argc, char* argv[])
{
  return CompareImage(argc, argv,
    [](vtkAnisotropicQuadRemesher* filter, vtkRenderer* renderer)
    {
      vtkNew<vtkPolyDataMapper> surface;
      surface->SetInputConnection(filter->GetOutputPort(vtkAnisotropicQuadRemesher::PRINCIPAL_DIRECTIONS));
      surface->ScalarVisibilityOff();
      AddActor(renderer, surface);
      vtkNew<vtkMaskPoints> some;
      some->SetInputConnection(filter->GetOutputPort(vtkAnisotropicQuadRemesher::PRINCIPAL_DIRECTIONS));
      some->SetOnRatio(3);
      vtkNew<vtkLineSource> line;
      line->SetPoint1(-0.5, 0.0, 0.0);
      line->SetPoint2(0.5, 0.0, 0.0);
      for (const bool minimum : { true, false })
      {
        vtkNew<vtkGlyph3DMapper> glyphs;
        glyphs->SetInputConnection(some->GetOutputPort());
        glyphs->SetSourceConnection(line->GetOutputPort());
        glyphs->SetOrientationArray(minimum ? "MinDirection" : "MaxDirection");
        glyphs->SetScaleFactor(0.3);
        glyphs->ScalarVisibilityOff();
        vtkNew<vtkActor> actor;
        actor->SetMapper(glyphs);
        actor->GetProperty()->SetColor(minimum ? 0.1 : 0.9, 0.2, minimum ? 0.9 : 0.1);
        actor->GetProperty()->SetLineWidth(minimum ? 5.0F : 1.0F);
        actor->GetProperty()->LightingOff();
        renderer->AddActor(actor);
      }
    });
}
