# SPDX-License-Identifier: BSD-3-Clause
# VTK, either plain (VTK_DIR names it) or the one that comes with ParaView. The components are named,
# since without them every package that VTK itself was built with is asked for.
if (AQR_BUILD_PLUGIN OR NOT VTK_DIR)
  find_package(ParaView QUIET COMPONENTS RemotingCore RemotingServerManager RemotingViews)
endif ()

set(components
  CommonCore CommonDataModel CommonExecutionModel FiltersCore FiltersSources
  IOGeometry IOImage IOLegacy IOPLY IOXML RenderingCore RenderingOpenGL2)
if (AQR_BUILD_PYTHON)
  list(APPEND components Python WrappingPythonCore)
endif ()
if (BUILD_TESTING)
  list(APPEND components
    CommonSystem FiltersGeneral FiltersModeling InteractionStyle TestingCore TestingRendering)
endif ()
find_package(VTK 9.1 REQUIRED COMPONENTS ${components})
if (AQR_BUILD_PYTHON)
  find_package(Python3 REQUIRED COMPONENTS Interpreter)
endif ()
message(STATUS "VTK ${VTK_VERSION}, ParaView ${ParaView_VERSION}")
