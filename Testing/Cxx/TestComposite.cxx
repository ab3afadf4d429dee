// SPDX-License-Identifier: BSD-3-Clause
// Fails when blocks are mixed up or lost on a port, when an empty block is an error, or when a change of
// density computes the curvature of any block again.
#include "RemesherTesting.h"

#include "vtkMultiBlockDataSet.h"
#include "vtkTrivialProducer.h"

int TestComposite(int, char*[])
{
  Checks checks;
  vtkNew<vtkMultiBlockDataSet> blocks;
  blocks->SetBlock(0, MakeTorus(60, 30));
  blocks->SetBlock(1, MakeSheet(40));
  blocks->SetBlock(2, vtkNew<vtkPolyData>());
  blocks->SetBlock(3, MakeTorus(50, 30));
  vtkNew<vtkTrivialProducer> source;
  source->SetOutput(blocks);
  vtkNew<vtkAnisotropicQuadRemesher> filter;
  filter->SetInputConnection(source->GetOutputPort());
  filter->SetTolerance(0.004);
  Messages messages(filter);
  filter->Update();
  CHECK(messages.Errors == 0);
  for (int port = 0; port < 4; ++port)
  {
    auto* output = vtkMultiBlockDataSet::SafeDownCast(filter->GetOutputDataObject(port));
    CHECK(output && output->GetNumberOfBlocks() == 4);
    for (unsigned int block = 0; output && block < 4; ++block)
    {
      auto* surface = vtkPolyData::SafeDownCast(output->GetBlock(block));
      auto* before = vtkPolyData::SafeDownCast(blocks->GetBlock(block));
      if (block == 2)
      {
        CHECK(!surface || surface->GetNumberOfCells() == 0);
        continue;
      }
      CHECK(surface && surface->GetNumberOfCells() > 0);
      for (int i = 0; surface && i < 6; ++i)
      {
        CHECK(std::abs(surface->GetBounds()[i] - before->GetBounds()[i]) < 0.15);
      }
    }
  }

  // The stages of every block are kept. The report is that of the last block.
  int computed = 0;
  const auto count = [](vtkObject* caller, unsigned long, void* data, void*)
  {
    const char* text = static_cast<vtkAlgorithm*>(caller)->GetProgressText();
    *static_cast<int*>(data) += text && std::string(text) == "curvature";
  };
  vtkNew<vtkCallbackCommand> onProgress;
  onProgress->SetCallback(count);
  onProgress->SetClientData(&computed);
  filter->AddObserver(vtkCommand::ProgressEvent, onProgress);
  filter->SetTolerance(0.003);
  filter->Update();
  CHECK(filter->GetReport().find("\"name\": \"curvature\", \"seconds\": 0,") != std::string::npos);
  CHECK(computed == 0);
  filter->SetCurvatureRadius(0.03);
  filter->Update();
  CHECK(computed > 0);
  CHECK(messages.Errors == 0);
  return checks.ExitCode();
}
