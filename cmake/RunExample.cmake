# SPDX-License-Identifier: BSD-3-Clause
# Runs COMMAND (a list) and fails unless it succeeds and writes OUTPUT anew.
file(REMOVE "${OUTPUT}")
execute_process(COMMAND ${COMMAND} RESULT_VARIABLE failed)
if (failed)
  message(FATAL_ERROR "the example ended with ${failed}")
endif ()
if (NOT EXISTS "${OUTPUT}")
  message(FATAL_ERROR "the example did not write ${OUTPUT}")
endif ()
