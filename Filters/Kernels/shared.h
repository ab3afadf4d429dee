/* SPDX-License-Identifier: BSD-3-Clause */
/* What threads write to without waiting for each other. Whatever their order, the result is the same. */
#ifndef AQR_SHARED_H
#define AQR_SHARED_H

#include "aqr.h"

#include <stdatomic.h>

typedef _Atomic(aqr_index) aqr_shared_index;
typedef _Atomic(double) aqr_shared_double;
typedef _Atomic(size_t) aqr_shared_size;

/* Raises it to x where it is less. */
static inline void aqr_shared_raise(aqr_shared_double* at, double x)
{
  double now = atomic_load_explicit(at, memory_order_relaxed);
  while (now < x && !atomic_compare_exchange_weak_explicit(at, &now, x, memory_order_relaxed, memory_order_relaxed))
    ;
}

/* Lowers it to x where it is more. */
static inline void aqr_shared_lower(aqr_shared_index* at, aqr_index x)
{
  aqr_index now = atomic_load_explicit(at, memory_order_relaxed);
  while (now > x && !atomic_compare_exchange_weak_explicit(at, &now, x, memory_order_relaxed, memory_order_relaxed))
    ;
}

/* ---- sets of items: each names one above it in its set, the root, which is the least, itself ---- */

static inline aqr_index aqr_above(const aqr_shared_index* parent, aqr_index i)
{
  return atomic_load_explicit(&parent[i], memory_order_relaxed);
}

static inline aqr_index aqr_root(aqr_shared_index* parent, aqr_index i)
{
  for (;;)
  {
    aqr_index a = aqr_above(parent, i), b = aqr_above(parent, a);
    if (a == b)
      return a;
    atomic_store_explicit(&parent[i], b, memory_order_relaxed); /* whoever else does that stores an ancestor too */
    i = b;
  }
}

static inline void aqr_unite(aqr_shared_index* parent, aqr_index a, aqr_index b)
{
  for (;;)
  {
    a = aqr_root(parent, a);
    b = aqr_root(parent, b);
    if (a == b)
      return;
    aqr_index high = a > b ? a : b, low = a > b ? b : a;
    if (atomic_compare_exchange_strong_explicit(
          &parent[high], &(aqr_index){ high }, low, memory_order_relaxed, memory_order_relaxed))
      return;
  }
}

#endif
