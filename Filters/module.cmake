# SPDX-License-Identifier: BSD-3-Clause
# The VTK module itself, run by vtk_module_build().
set(filter "${CMAKE_CURRENT_LIST_DIR}/vtkAnisotropicQuadRemesher")
set(parts AttributeTransfer InputSurface KeptSurfaces RunReport)
list(TRANSFORM parts PREPEND "${CMAKE_CURRENT_LIST_DIR}/")
list(TRANSFORM parts APPEND ".cxx" OUTPUT_VARIABLE sources)
list(TRANSFORM parts APPEND ".h" OUTPUT_VARIABLE headers)
vtk_module_add_module(AnisotropicQuadRemesher::AnisotropicQuadRemesher
  SOURCES "${filter}.cxx" ${sources}
  PRIVATE_HEADERS ${headers} "${CMAKE_CURRENT_LIST_DIR}/ToolkitVersion.h"
  HEADERS "${filter}.h")
# The header lies below vtk.module's directory, where the wrappers do not look by themselves.
vtk_module_include(AnisotropicQuadRemesher::AnisotropicQuadRemesher
  PUBLIC $<BUILD_INTERFACE:${CMAKE_CURRENT_LIST_DIR}>)
vtk_module_compile_features(AnisotropicQuadRemesher::AnisotropicQuadRemesher PUBLIC cxx_std_17)
vtk_module_link(AnisotropicQuadRemesher::AnisotropicQuadRemesher
  PRIVATE aqr_kernels $<BUILD_INTERFACE:aqr_warnings>)
