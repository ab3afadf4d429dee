// SPDX-License-Identifier: BSD-3-Clause
// All that differs between the versions of VTK, from 9.1 on.
#ifndef ToolkitVersion_h
#define ToolkitVersion_h

#include "vtkAlgorithm.h"
#include "vtkVersionMacros.h"

#if defined(VTK_VERSION_NUMBER) && VTK_VERSION_NUMBER < VTK_VERSION_CHECK(9, 1, 0)
#error "vtkAnisotropicQuadRemesher needs VTK 9.1 or later"
#endif

// Since VTK 9.2 an algorithm asks upstream too whether it should stop, and tells the executive. Found by
// its presence, since ParaView carries VTKs from between releases.
template <typename T>
auto ShouldAbort(T* algorithm, int) -> decltype(algorithm->CheckAbort())
{
  return algorithm->CheckAbort();
}
template <typename T>
bool ShouldAbort(T* algorithm, long)
{
  return algorithm->GetAbortExecute() != 0;
}

#endif
