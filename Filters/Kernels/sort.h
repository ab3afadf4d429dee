/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef AQR_SORT_H
#define AQR_SORT_H

#include "context.h"

/* As qsort, which cannot be cancelled. Where it fails the items are in disorder, and some may be lost. */
aqr_status aqr_sort(aqr_context* c, void* items, size_t n, size_t size, int (*compare)(const void* a, const void* b));

#endif
