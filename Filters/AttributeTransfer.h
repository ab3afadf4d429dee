// SPDX-License-Identifier: BSD-3-Clause
// How arrays of the input reach the outputs.
#ifndef AttributeTransfer_h
#define AttributeTransfer_h

#include "aqr.h"
#include "vtkType.h"

#include <vector>

class vtkCellData;
class vtkPointData;

// Blends arrays of floating-point numbers by the weights of the origins; other arrays (integers, strings)
// name things and take the value of the nearest point.
void InterpolatePointData(vtkPointData* from, const aqr_origin* origins, size_t count, vtkPointData* to);

// Cell i of the output takes the values of cell sources[i].
void CopyCellData(vtkCellData* from, const std::vector<vtkIdType>& sources, vtkCellData* to);

#endif
