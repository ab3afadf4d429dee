/* SPDX-License-Identifier: BSD-3-Clause */
/* What threads write to without waiting for each other. Whatever their order, the result is the same. */
#ifndef AQR_SHARED_H
#define AQR_SHARED_H

#include "aqr.h"

#include <stdatomic.h>
#include <stdbool.h>

typedef _Atomic(double) aqr_shared_double;
typedef _Atomic(size_t) aqr_shared_size;

/* Raises it to x where it is less. */
static inline void aqr_shared_raise(aqr_shared_double* at, double x)
{
  double now = atomic_load_explicit(at, memory_order_relaxed);
  while (now < x &&
         !atomic_compare_exchange_weak_explicit(at, &now, x, memory_order_relaxed, memory_order_relaxed))
    ;
}

#endif
