# SPDX-License-Identifier: BSD-3-Clause
# Runs every example, each with a little surface of its own; what it writes must be there.
file(MAKE_DIRECTORY "${CMAKE_BINARY_DIR}/Testing/Examples")
function (add_paraview_example name output)
  add_test(NAME Example.ParaView.${name}
    COMMAND "${CMAKE_COMMAND}" -DOUTPUT=${CMAKE_BINARY_DIR}/Testing/Examples/${output}
      "-DCOMMAND=${PVPYTHON};${PROJECT_SOURCE_DIR}/Examples/ParaView/${name}.py;$<TARGET_FILE:AnisotropicQuadRemesherPlugin>;${ARGN}"
      -P "${PROJECT_SOURCE_DIR}/cmake/RunExample.cmake")
  set_tests_properties(Example.ParaView.${name} PROPERTIES TIMEOUT 300)
endfunction ()
set(out "${CMAKE_BINARY_DIR}/Testing/Examples")
add_paraview_example(directions_as_glyphs directions.png "${out}/directions.png")
add_paraview_example(sweep_tolerances sweep.ogv "${out}/sweep.ogv")
add_paraview_example(compare_with_decimation compare.png "${out}/compare.png")
