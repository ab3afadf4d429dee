/* SPDX-License-Identifier: BSD-3-Clause */
#include "context.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum
{
  grain = 1024,
  first_block = 4 * grain, /* elements before the first look at the progress hook */
  most_growth = 4,         /* of a block over the one before */
  most_unasked = 1 << 18   /* small steps between two looks */
};

static const double block_seconds = 0.02; /* between two looks: short for a cancel, long for threads to be worth it */

static void* default_reallocate(void* user, void* old, size_t old_bytes, size_t bytes)
{
  (void)user;
  (void)old_bytes;
  if (bytes == 0)
  {
    free(old);
    return NULL;
  }
  return realloc(old, bytes);
}

static void* resize(aqr_context* c, void* old, size_t old_bytes, size_t bytes)
{
  void* p = c->hooks.reallocate ? c->hooks.reallocate(c->hooks.user, old, old_bytes, bytes)
                                : default_reallocate(NULL, old, old_bytes, bytes);
  if (p || bytes == 0)
  {
    c->bytes += bytes;
    c->bytes -= old_bytes;
    if (c->bytes > c->peak_bytes)
      c->peak_bytes = c->bytes;
  }
  return p;
}

static size_t rounded(size_t count, size_t size)
{
  return count ? count * size : 1;
}

void* aqr_alloc(aqr_context* c, size_t count, size_t size)
{
  if (size && count > SIZE_MAX / 2 / size)
    return NULL;
  return resize(c, NULL, 0, rounded(count, size));
}

void* aqr_alloc0(aqr_context* c, size_t count, size_t size)
{
  void* p = aqr_alloc(c, count, size);
  if (p)
    memset(p, 0, rounded(count, size));
  return p;
}

void aqr_release(aqr_context* c, void* p, size_t count, size_t size)
{
  if (p)
    resize(c, p, rounded(count, size), 0);
}

bool aqr_reserve(aqr_context* c, void** p, size_t* capacity, size_t need, size_t size)
{
  if (need <= *capacity && *p)
    return true;
  size_t wanted = *capacity + *capacity / 2 + 16;
  if (wanted < need)
    wanted = need;
  if (wanted > SIZE_MAX / 2 / size)
    return false;
  void* grown = resize(c, *p, *p ? rounded(*capacity, size) : 0, wanted * size);
  if (!grown)
    return false;
  *p = grown;
  *capacity = wanted;
  return true;
}

bool aqr_trim(aqr_context* c, void** p, size_t* capacity, size_t need, size_t size)
{
  if (!*p || need >= *capacity)
    return true;
  void* less = resize(c, *p, rounded(*capacity, size), rounded(need, size));
  if (!less)
    return false;
  *p = less;
  *capacity = need;
  return true;
}

bool aqr_step(aqr_context* c, double fraction)
{
  c->unasked = 0;
  if (!c->hooks.progress)
    return true;
  double f = c->begin + (c->end - c->begin) * fraction;
  if (f < c->last)
    f = c->last;
  c->last = f;
  return c->hooks.progress(c->hooks.user, f, c->stage ? c->stage : "") != 0;
}

bool aqr_worked(aqr_context* c, size_t work)
{
  c->unasked += work;
  return c->unasked < most_unasked || aqr_step(c, 0);
}

double aqr_seconds(void)
{
  struct timespec t;
  return timespec_get(&t, TIME_UTC) ? (double)t.tv_sec + 1e-9 * (double)t.tv_nsec : 0;
}

struct shifted
{
  void (*body)(void*, size_t, size_t);
  void* data;
  size_t first;
};

static void run_shifted(void* data, size_t begin, size_t end)
{
  const struct shifted* s = data;
  s->body(s->data, s->first + begin, s->first + end);
}

aqr_status aqr_parallel(
  aqr_context* c, size_t count, void (*body)(void*, size_t, size_t), void* data, double from, double to)
{
  size_t block = first_block;
  for (size_t first = 0; first < count;)
  {
    if (!aqr_step(c, from + (to - from) * (double)first / (double)count))
      return AQR_CANCELLED;
    size_t n = count - first < block ? count - first : block;
    struct shifted s = { body, data, first };
    double began = aqr_seconds();
    if (c->hooks.parallel_for)
      c->hooks.parallel_for(c->hooks.user, n, grain, run_shifted, &s);
    else
      run_shifted(&s, 0, n);
    first += n;
    double ratio = block_seconds / fmax(aqr_seconds() - began, block_seconds / most_growth);
    block = (size_t)fmax(grain, (double)n * ratio);
  }
  return AQR_OK;
}
