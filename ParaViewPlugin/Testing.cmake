# SPDX-License-Identifier: BSD-3-Clause
set(plugin_tests "${PROJECT_SOURCE_DIR}/Testing/Python")
set(plugin_python "${CMAKE_BINARY_DIR}/${AQR_PYTHON_DESTINATION}")
find_program(PVPYTHON pvpython)
if (PVPYTHON AND AQR_BUILD_PYTHON)
  add_test(NAME Python.plugin
    COMMAND "${CMAKE_COMMAND}" -E env "PYTHONPATH=${plugin_python}:$ENV{PYTHONPATH}" "PVPYTHON=${PVPYTHON}"
      "${PVPYTHON}" "${plugin_tests}/test_plugin.py"
      $<TARGET_FILE:AnisotropicQuadRemesherPlugin> "${CMAKE_CURRENT_SOURCE_DIR}/Plugin/AnisotropicQuadRemesher.xml")
  set_tests_properties(Python.plugin PROPERTIES TIMEOUT 300)
  include(${PROJECT_SOURCE_DIR}/Examples/ParaView/Testing.cmake)
endif ()

# The test of the real program needs a display server, the screenshot and Qt's Python modules.
find_program(PARAVIEW paraview)
find_program(XVFB Xvfb)
find_program(IMPORT import)
execute_process(COMMAND "${Python3_EXECUTABLE}" -c "import PyQt5.QtWidgets" RESULT_VARIABLE no_pyqt ERROR_QUIET)
if (PARAVIEW AND XVFB AND IMPORT AND no_pyqt EQUAL 0)
  set(AQR_GUI_PICTURE "${CMAKE_BINARY_DIR}/Testing/paraview.png")
  set(AQR_GUI_COMMAND "${Python3_EXECUTABLE}" "${plugin_tests}/run_gui.py" "${PARAVIEW}"
    $<TARGET_FILE:AnisotropicQuadRemesherPlugin> "${plugin_python}" "${AQR_GUI_PICTURE}")
  add_test(NAME ParaView.gui COMMAND ${AQR_GUI_COMMAND})
  set_tests_properties(ParaView.gui PROPERTIES TIMEOUT 300)
  set_property(GLOBAL PROPERTY AQR_GUI_COMMAND "${AQR_GUI_COMMAND}")
else ()
  message(STATUS "No test of the ParaView window: it needs paraview, Xvfb, ImageMagick and PyQt5")
endif ()
