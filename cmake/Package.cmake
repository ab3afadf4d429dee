# SPDX-License-Identifier: BSD-3-Clause
# What find_package(AnisotropicQuadRemesher) reads; the targets are installed beside it.
include(CMakePackageConfigHelpers)
configure_package_config_file(
  cmake/AnisotropicQuadRemesherConfig.cmake.in
  "${CMAKE_BINARY_DIR}/cmake/AnisotropicQuadRemesherConfig.cmake"
  INSTALL_DESTINATION "${AQR_CMAKE_DESTINATION}"
  PATH_VARS AQR_PYTHON_DESTINATION)
write_basic_package_version_file(
  "${CMAKE_BINARY_DIR}/cmake/AnisotropicQuadRemesherConfigVersion.cmake"
  COMPATIBILITY SameMinorVersion)
install(FILES
  "${CMAKE_BINARY_DIR}/cmake/AnisotropicQuadRemesherConfig.cmake"
  "${CMAKE_BINARY_DIR}/cmake/AnisotropicQuadRemesherConfigVersion.cmake"
  DESTINATION "${AQR_CMAKE_DESTINATION}" COMPONENT development)
install(FILES LICENSE DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT runtime)
