/* SPDX-License-Identifier: BSD-3-Clause */
/* Fuzzes surfaces with defects: four bytes of options, one for the surface, seven or more for every defect.
 * Half of the seeds lock some edges. */
#include "bytes.h"
#include "examine.h"
#include "mutate.h"

#include <stdio.h>
#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size)
{
  bytes b = { data, size };
  uint32_t code;
  aqr_options options = take_mild_options(&b, &code);
  shape m = mutate_base(take_8(&b));
  if (mutate(&m, &b))
  {
    aqr_input input = shape_input(&m);
    int64_t* locked = lock_some(&input, options.seed);
    if (options.symmetry)
      set_plane(&options, &input, code);
    aqr_status status;
    const char* fault = examine(&input, &options, &status);
    if (fault)
    {
      fprintf(stderr, "fault: %s (%s)\n", fault, aqr_status_string(status));
      abort();
    }
    free(locked);
  }
  shape_free(&m);
  return 0;
}
