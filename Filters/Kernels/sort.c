/* SPDX-License-Identifier: BSD-3-Clause */
#include "sort.h"

#include <stdlib.h>
#include <string.h>

enum
{
  run = 1 << 15 /* items that qsort gets: a few milliseconds */
};

typedef struct sorter
{
  aqr_context* c;
  size_t n, size;
  int (*compare)(const void* a, const void* b);
} sorter;

static size_t at_most(size_t a, size_t b)
{
  return a < b ? a : b;
}

/* Merges the `width` items from `begin` on with as many behind them. */
static aqr_status merge(const sorter* s, const uint8_t* from, uint8_t* to, size_t begin, size_t width)
{
  size_t middle = at_most(begin + width, s->n), end = at_most(middle + width, s->n), a = begin, b = middle;
  for (size_t i = begin; i < end; i++)
  {
    if (!aqr_worked(s->c, 2))
      return AQR_CANCELLED;
    bool first = b == end || (a < middle && s->compare(from + a * s->size, from + b * s->size) <= 0);
    memcpy(to + i * s->size, from + (first ? a++ : b++) * s->size, s->size);
  }
  return AQR_OK;
}

aqr_status aqr_sort(aqr_context* c, void* items, size_t n, size_t size, int (*compare)(const void* a, const void* b))
{
  const sorter s = { c, n, size, compare };
  aqr_status status = AQR_OK;
  uint8_t *from = items, *to = NULL, *spare = NULL;
  for (size_t i = 0; i < n; i += run)
  {
    size_t count = at_most(run, n - i);
    qsort(from + i * size, count, size, compare);
    AQR_REQUIRE(aqr_worked(c, 8 * count), AQR_CANCELLED);
  }
  if (n <= run)
    return AQR_OK;
  spare = aqr_alloc(c, n, size);
  AQR_REQUIRE(spare, AQR_OUT_OF_MEMORY);
  to = spare;
  for (size_t width = run; width < n; width *= 2)
  {
    for (size_t begin = 0; begin < n; begin += 2 * width)
      AQR_TRY(merge(&s, from, to, begin, width));
    uint8_t* swap = from;
    from = to;
    to = swap;
  }
  if (from != items)
    memcpy(items, from, n * size);
done:
  aqr_release(c, spare, n, size);
  return status;
}
