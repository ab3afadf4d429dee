/* SPDX-License-Identifier: BSD-3-Clause */
#include "marks.h"

typedef struct look
{
  const aqr_polygon_mesh* m;
  aqr_worth_a_look is_worth;
  const void* options;
  uint8_t* on;
} look;

static void look_at(void* data, size_t begin, size_t end)
{
  const look* l = data;
  for (size_t i = begin; i < end; i++)
    l->on[i] = l->is_worth(l->m, (aqr_index)i, l->options);
}

aqr_status aqr_mark(
  aqr_context* c, const aqr_polygon_mesh* m, size_t n, aqr_worth_a_look is_worth, const void* options, aqr_marks* marks)
{
  marks->n = n;
  if (!AQR_RESERVE(c, marks->on, marks->capacity, n))
    return AQR_OUT_OF_MEMORY;
  return aqr_parallel(c, n, look_at, &(look){ m, is_worth, options, marks->on }, 0, 0);
}

void aqr_marks_free(aqr_context* c, aqr_marks* marks)
{
  AQR_DROP(c, marks->on, marks->capacity);
}
