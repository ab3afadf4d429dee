# SPDX-License-Identifier: BSD-3-Clause
find_program(PVPYTHON pvpython)
if (PVPYTHON)
  add_test(NAME Python.plugin
    COMMAND "${PVPYTHON}" "${PROJECT_SOURCE_DIR}/Testing/Python/test_plugin.py"
      $<TARGET_FILE:AnisotropicQuadRemesherPlugin> "${CMAKE_CURRENT_SOURCE_DIR}/Plugin/AnisotropicQuadRemesher.xml")
  set_tests_properties(Python.plugin PROPERTIES TIMEOUT 120)
endif ()
