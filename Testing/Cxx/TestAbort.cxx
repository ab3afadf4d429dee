// SPDX-License-Identifier: BSD-3-Clause
// Fails when an abort is not heard, leaves anything behind, or spoils the next update; and when progress
// goes backwards or outside [0, 1].
#include "RemesherTesting.h"

namespace
{
struct Watch
{
  double AbortAt = 2.0;
  double Last = 0.0;
  int Events = 0;
  bool Backwards = false;
};

void OnProgress(vtkObject* caller, unsigned long, void* data, void*)
{
  auto* filter = static_cast<vtkAlgorithm*>(caller);
  auto* watch = static_cast<Watch*>(data);
  const double progress = filter->GetProgress();
  watch->Backwards |= progress < watch->Last || progress > 1.0;
  watch->Last = progress;
  watch->Events++;
  if (progress >= watch->AbortAt)
  {
    filter->AbortExecuteOn();
  }
}
}

int TestAbort(int, char*[])
{
  Checks checks;
  vtkNew<vtkAnisotropicQuadRemesher> filter;
  filter->SetInputData(MakeTorus());
  filter->SetTolerance(0.001);
  Messages messages(filter);
  Watch watch;
  vtkNew<vtkCallbackCommand> onProgress;
  onProgress->SetCallback(OnProgress);
  onProgress->SetClientData(&watch);
  filter->AddObserver(vtkCommand::ProgressEvent, onProgress);

  filter->Update();
  const vtkIdType faces = filter->GetOutput()->GetNumberOfPolys();
  std::cout << watch.Events << " progress events\n";
  CHECK(faces > 0 && watch.Events >= 10 && !watch.Backwards);

  for (const double fraction : { 0.0, 0.1, 0.3, 0.5, 0.7, 0.9 })
  {
    watch = Watch();
    watch.AbortAt = fraction;
    filter->SetCurvatureRadius(filter->GetCurvatureRadius() + 1e-6); // so that every stage runs
    filter->Update();
    CHECK(filter->GetAbortExecute());
    for (int port = 0; port < 4; ++port)
    {
      CHECK(filter->GetOutput(port)->GetNumberOfPoints() == 0 && filter->GetOutput(port)->GetNumberOfCells() == 0);
    }

    watch = Watch();
    filter->AbortExecuteOff();
    filter->Update();
    CHECK(std::abs(filter->GetOutput()->GetNumberOfPolys() - faces) < 0.1 * faces);
  }
  CHECK(messages.Errors == 0);
  return checks.ExitCode();
}
