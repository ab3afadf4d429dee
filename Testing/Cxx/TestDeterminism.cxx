// SPDX-License-Identifier: BSD-3-Clause
// Fails when repeated runs, or other numbers of threads, give other bytes on any port.
#include "RemesherTesting.h"

#include "vtkAbstractArray.h"
#include "vtkDataArray.h"

namespace
{
void Append(std::string& bytes, vtkDataArray* array)
{
  const vtkIdType size = array->GetNumberOfValues() * array->GetDataTypeSize();
  bytes.append(static_cast<const char*>(array->GetVoidPointer(0)), static_cast<size_t>(size));
}

std::string Bytes(int threads, vtkPolyData* input)
{
  vtkNew<vtkAnisotropicQuadRemesher> filter;
  filter->SetInputData(input);
  filter->SetTolerance(0.001);
  filter->SetNumberOfThreads(threads);
  filter->Update();
  std::string bytes;
  for (int port = 0; port < 4; ++port)
  {
    vtkPolyData* output = filter->GetOutput(port);
    Append(bytes, output->GetPoints()->GetData());
    Append(bytes, output->GetPolys()->GetConnectivityArray());
    Append(bytes, output->GetLines()->GetConnectivityArray());
    for (vtkDataSetAttributes* data : { static_cast<vtkDataSetAttributes*>(output->GetPointData()),
           static_cast<vtkDataSetAttributes*>(output->GetCellData()) })
    {
      for (int i = 0; i < data->GetNumberOfArrays(); ++i)
      {
        Append(bytes, data->GetArray(i));
      }
    }
  }
  return bytes;
}
}

int TestDeterminism(int, char*[])
{
  Checks checks;
  for (const auto& input : { MakeTorus(120, 60), MakeSheet(), MakeBox() })
  {
    const std::string expected = Bytes(1, input);
    CHECK(expected.size() > 10000);
    CHECK(Bytes(1, input) == expected);
    CHECK(Bytes(2, input) == expected);
    CHECK(Bytes(7, input) == expected);
    CHECK(Bytes(0, input) == expected);
  }
  return checks.ExitCode();
}
