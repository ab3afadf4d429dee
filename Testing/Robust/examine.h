/* SPDX-License-Identifier: BSD-3-Clause */
/* Runs the library on anything and says what is wrong with the answer: shared by the fuzz targets, the tests of faults
 * and the tests named after findings. */
#ifndef AQR_TEST_EXAMINE_H
#define AQR_TEST_EXAMINE_H

#include "aqr.h"

/* NULL when the library did as it promises: refused with a status other than AQR_INTERNAL and left no result, or
 * answered with a valid mesh of the repaired surface inside its bounding box up to the tolerance, equal bytes from
 * two runs in different order, no byte left. With symmetry the surface is its half and the mirror image, and so is the
 * mesh; a topology lost there is allowed where the report says so. *status: what the run said. */
const char* examine(const aqr_input* input, const aqr_options* options, aqr_status* status);

/* The part of it that looks at one result. */
const char* examine_results(const aqr_mesh* m, const aqr_field_view* f, const aqr_report* report,
  const aqr_input* input, const aqr_options* options);

#endif
