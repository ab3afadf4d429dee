/* SPDX-License-Identifier: BSD-3-Clause */
#include "neighbours.h"

typedef struct job
{
  const aqr_surface* s;
  aqr_neighbours* around;
} job;

/* Lists the points around v where `out` is not NULL; gives their number. */
static aqr_index walk(const aqr_surface* s, aqr_index v, aqr_index* out)
{
  aqr_index n = 0, start = s->fan[v], h = start;
  while (h != AQR_NONE)
  {
    if (out)
      out[n] = aqr_to(s, h);
    n++;
    aqr_index back = aqr_prev(h);
    h = aqr_twin(s, back);
    if (h == start)
      break;
    if (h == AQR_NONE) /* a border or seam: the edge there leads away from v on no face of its own */
    {
      if (out)
        out[n] = aqr_from(s, back);
      n++;
    }
  }
  return n;
}

static void count(void* data, size_t begin, size_t end)
{
  const job* j = data;
  for (size_t v = begin; v < end; v++)
    j->around->first[v + 1] = walk(j->s, (aqr_index)v, NULL);
}

static void list(void* data, size_t begin, size_t end)
{
  const job* j = data;
  for (size_t v = begin; v < end; v++)
    walk(j->s, (aqr_index)v, j->around->point + j->around->first[v]);
}

void aqr_neighbours_free(aqr_context* c, aqr_neighbours* around)
{
  if (around->first)
    AQR_DROP(c, around->point, around->first[around->n_points]);
  AQR_DROP(c, around->first, around->n_points + 1);
  *around = (aqr_neighbours){ 0 };
}

aqr_status aqr_neighbours_build(aqr_context* c, const aqr_surface* s, aqr_neighbours* around)
{
  aqr_status status = AQR_OK;
  job j = { s, around };
  *around = (aqr_neighbours){ .n_points = s->n_points };
  around->first = AQR_NEW0(c, aqr_index, s->n_points + 1);
  AQR_REQUIRE(around->first, AQR_OUT_OF_MEMORY);
  AQR_TRY(aqr_parallel(c, s->n_points, count, &j, 0, 0));
  for (size_t v = 0; v < s->n_points; v++)
    around->first[v + 1] += around->first[v];
  around->point = AQR_NEW(c, aqr_index, around->first[s->n_points]);
  AQR_REQUIRE(around->point, AQR_OUT_OF_MEMORY);
  AQR_TRY(aqr_parallel(c, s->n_points, list, &j, 0, 0));
done:
  if (status != AQR_OK)
    aqr_neighbours_free(c, around);
  return status;
}
