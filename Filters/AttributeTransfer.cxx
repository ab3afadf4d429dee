// SPDX-License-Identifier: BSD-3-Clause
#include "AttributeTransfer.h"

#include "vtkAbstractArray.h"
#include "vtkCellData.h"
#include "vtkIdList.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"

#include <algorithm>

namespace
{
bool IsContinuous(vtkAbstractArray* array)
{
  return array->GetDataType() == VTK_FLOAT || array->GetDataType() == VTK_DOUBLE;
}
}

//------------------------------------------------------------------------------
void InterpolatePointData(vtkPointData* from, const aqr_origin* origins, size_t count, vtkPointData* to)
{
  const vtkIdType points = static_cast<vtkIdType>(count);
  vtkNew<vtkIdList> corners;
  corners->SetNumberOfIds(3);
  for (int i = 0; i < from->GetNumberOfArrays(); ++i)
  {
    vtkAbstractArray* source = from->GetAbstractArray(i);
    const int attribute = from->IsArrayAnAttribute(i);
    // Normals are computed anew, and copied global ids would no longer be unique.
    if (attribute == vtkDataSetAttributes::NORMALS || attribute == vtkDataSetAttributes::GLOBALIDS)
    {
      continue;
    }
    auto target = vtkSmartPointer<vtkAbstractArray>::Take(source->NewInstance());
    target->SetName(source->GetName());
    target->SetNumberOfComponents(source->GetNumberOfComponents());
    target->CopyComponentNames(source);
    target->SetNumberOfTuples(points);
    const bool blend = IsContinuous(source);
    for (vtkIdType p = 0; p < points; ++p)
    {
      const aqr_origin& origin = origins[p];
      const auto nearest = std::max_element(origin.weight, origin.weight + 3) - origin.weight;
      if (!blend || origin.weight[nearest] >= 1.0F)
      {
        target->SetTuple(p, origin.point[nearest], source);
        continue;
      }
      // The weights are single-precision numbers; their sum must be exact for constants to stay so.
      const double sum = static_cast<double>(origin.weight[0]) + origin.weight[1] + origin.weight[2];
      double weights[3];
      for (int k = 0; k < 3; ++k)
      {
        corners->SetId(k, origin.point[k]);
        weights[k] = origin.weight[k] / sum;
      }
      target->InterpolateTuple(p, corners, source, weights);
    }
    const int index = to->AddArray(target);
    if (attribute >= 0)
    {
      to->SetActiveAttribute(index, attribute);
    }
  }
}

//------------------------------------------------------------------------------
void CopyCellData(vtkCellData* from, const std::vector<vtkIdType>& sources, vtkCellData* to)
{
  const vtkIdType count = static_cast<vtkIdType>(sources.size());
  to->CopyGlobalIdsOff();
  to->CopyAllocate(from, count);
  for (vtkIdType i = 0; i < count; ++i)
  {
    to->CopyData(from, sources[static_cast<size_t>(i)], i);
  }
}
