/* SPDX-License-Identifier: BSD-3-Clause */
/* A parallel_for hook over a given number of threads. */
#ifndef AQR_TEST_THREADS_H
#define AQR_TEST_THREADS_H

#include <pthread.h>
#include <stdbool.h>
#include <stddef.h>

typedef struct share
{
  void (*body)(void*, size_t, size_t);
  void* data;
  size_t count, grain, first, stride;
} share;

static inline void* work(void* p)
{
  const share* w = p;
  for (size_t i = w->first * w->grain; i < w->count; i += w->stride * w->grain)
    w->body(w->data, i, i + w->grain < w->count ? i + w->grain : w->count);
  return NULL;
}

/* Ranges of `grain` dealt out to *user threads. */
static inline void on_threads(
  void* user, size_t count, size_t grain, void (*body)(void* data, size_t begin, size_t end), void* data)
{
  size_t n = *(const size_t*)user;
  pthread_t threads[16];
  share shares[16];
  bool runs[16];
  if (grain == 0)
    grain = 1;
  for (size_t i = 0; i < n; i++)
  {
    shares[i] = (share){ body, data, count, grain, i, n };
    runs[i] = pthread_create(&threads[i], NULL, work, &shares[i]) == 0;
    if (!runs[i])
      work(&shares[i]);
  }
  for (size_t i = 0; i < n; i++)
    if (runs[i])
      pthread_join(threads[i], NULL);
}

#endif
