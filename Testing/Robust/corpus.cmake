# SPDX-License-Identifier: BSD-3-Clause
# The runner over a folder of surfaces; after the filter, which it links.
set(robust "${CMAKE_CURRENT_LIST_DIR}")
set(program "${PROJECT_SOURCE_DIR}/Examples/Cxx/aqr-remesh")
add_executable(corpus
  "${robust}/corpus.cxx" "${program}/Announced.cxx" "${program}/Files.cxx" "${program}/Text.cxx")
set_target_properties(corpus PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/Testing/Robust")
target_compile_features(corpus PRIVATE cxx_std_17)
target_include_directories(corpus PRIVATE "${program}")
target_link_libraries(corpus PRIVATE aqr_examine AnisotropicQuadRemesher::AnisotropicQuadRemesher
  VTK::CommonCore VTK::CommonDataModel VTK::CommonExecutionModel VTK::FiltersCore
  VTK::IOGeometry VTK::IOLegacy VTK::IOPLY VTK::IOXML aqr_warnings)

set(nasties "${CMAKE_BINARY_DIR}/Testing/Robust/nasties")
add_test(NAME Robust.MakeNasties COMMAND "${Python3_EXECUTABLE}" "${robust}/make_nasties.py" "${nasties}" 120 7)
add_test(NAME Robust.Nasties COMMAND corpus "${nasties}" 60 4096)
set_tests_properties(Robust.MakeNasties PROPERTIES FIXTURES_SETUP nasties)
set_tests_properties(Robust.Nasties PROPERTIES FIXTURES_REQUIRED nasties TIMEOUT 600)
if (DEFINED ENV{AQR_SHARED_DATA})
  add_test(NAME Robust.SharedBroken COMMAND corpus "$ENV{AQR_SHARED_DATA}/broken" 60 4096)
  set_tests_properties(Robust.SharedBroken PROPERTIES TIMEOUT 600)
endif ()
