/* SPDX-License-Identifier: BSD-3-Clause */
/* What every stage is handed: memory, progress and cancellation, threads, all through the caller's
 * hooks. */
#ifndef AQR_CONTEXT_H
#define AQR_CONTEXT_H

#include "aqr.h"

#include <stdbool.h>

typedef struct aqr_context
{
  aqr_hooks hooks;
  size_t bytes;      /* held now */
  size_t peak_bytes; /* largest `bytes` since the stage began */
  double begin, end; /* range of the overall progress that the running stage fills */
  double last;       /* last fraction reported, so that progress never goes backwards */
  size_t unasked;    /* work since the hook was asked last */
  const char* stage;
  char message[160];
} aqr_context;

/* Memory. Zero bytes give a valid pointer. Sizes are told back so that the total is known. */
void* aqr_alloc(aqr_context* c, size_t count, size_t size);  /* NULL when out of memory or on overflow */
void* aqr_alloc0(aqr_context* c, size_t count, size_t size); /* zero-filled */
void aqr_release(aqr_context* c, void* p, size_t count, size_t size);

#define AQR_NEW(c, type, count) ((type*)aqr_alloc(c, count, sizeof(type)))
#define AQR_NEW0(c, type, count) ((type*)aqr_alloc0(c, count, sizeof(type)))
/* Releases and forgets; safe on NULL. */
#define AQR_DROP(c, p, count) (aqr_release(c, p, count, sizeof *(p)), (p) = NULL)

/* Grows *p to at least `need` elements of `size` bytes, by half as many again; false when out of memory (*p
 * stays valid). */
bool aqr_reserve(aqr_context* c, void** p, size_t* capacity, size_t need, size_t size);
#define AQR_RESERVE(c, p, capacity, need)                                                                              \
  (((need) <= (capacity) && (p)) || aqr_reserve(c, (void**)&(p), &(capacity), need, sizeof *(p)))

/* Gives back what *p has room for beyond `need` elements; false as above. */
bool aqr_trim(aqr_context* c, void** p, size_t* capacity, size_t need, size_t size);
#define AQR_TRIM(c, p, capacity, need) aqr_trim(c, (void**)&(p), &(capacity), need, sizeof *(p))

/* Reports that `fraction` of the running stage is done; false when the caller wants to stop.
 * Costs what the caller's hook costs, so once in some milliseconds: aqr_worked() sees to that. Only
 * on the thread that called set_input or run. */
bool aqr_step(aqr_context* c, double fraction);

/* `work` more small steps are done, of some ten nanoseconds each; false when the caller wants to stop. Asks the hook
 * once in many steps, so that any loop may call it. On the same thread. */
bool aqr_worked(aqr_context* c, size_t work);

/* Of a clock that goes on; only for figures and for how often to look at the hooks, never for results. */
double aqr_seconds(void);

/* Runs body over [0, count) through the parallel_for hook, in blocks between which progress moves
 * from `from` to `to` of the stage and cancellation is heard. */
aqr_status aqr_parallel(
  aqr_context* c, size_t count, void (*body)(void* data, size_t begin, size_t end), void* data, double from, double to);

/* Leaves through label `done` with `status` set when the call fails. */
#define AQR_TRY(call)                                                                                                  \
  do                                                                                                                   \
  {                                                                                                                    \
    status = (call);                                                                                                   \
    if (status != AQR_OK)                                                                                              \
      goto done;                                                                                                       \
  } while (0)

#define AQR_REQUIRE(condition, failure)                                                                                \
  do                                                                                                                   \
  {                                                                                                                    \
    if (!(condition))                                                                                                  \
    {                                                                                                                  \
      status = (failure);                                                                                              \
      goto done;                                                                                                       \
    }                                                                                                                  \
  } while (0)

#endif
