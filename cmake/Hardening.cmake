# SPDX-License-Identifier: BSD-3-Clause
# What Debian builds its packages with (dpkg-buildflags, hardening=+all): guards on the stack, checked copies and
# formats, addresses that differ from run to run, tables that cannot be written once the program runs.
# Sanitizers bring checks of their own, which these would hide.
if (NOT AQR_HARDENING OR AQR_SANITIZE OR AQR_FUZZ OR NOT CMAKE_C_COMPILER_ID MATCHES "GNU|Clang" OR APPLE OR WIN32)
  return ()
endif ()
include(CheckCCompilerFlag)
include(CheckPIESupported)
check_pie_supported(LANGUAGES C)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
add_compile_options(-fstack-protector-strong -Wformat -Werror=format-security)
foreach (flag stack-clash-protection cf-protection)
  string(MAKE_C_IDENTIFIER "AQR_HAS_${flag}" has)
  check_c_compiler_flag("-f${flag}" ${has})
  if (${has})
    add_compile_options(-f${flag})
  endif ()
endforeach ()
if (NOT "${CMAKE_C_FLAGS} ${CMAKE_CXX_FLAGS}" MATCHES "FORTIFY_SOURCE")
  # It needs an optimizing compiler.
  add_compile_options("$<$<NOT:$<CONFIG:Debug>>:-D_FORTIFY_SOURCE=2>")
endif ()
add_link_options(-Wl,-z,relro -Wl,-z,now)
