/* SPDX-License-Identifier: BSD-3-Clause */
/* Marks on faces or vertices of a mesh that all threads find worth a look, so that one alone needs to look at few. */
#ifndef AQR_MARKS_H
#define AQR_MARKS_H

#include "polygon_mesh.h"

typedef struct aqr_marks
{
  uint8_t* on;
  size_t n, capacity;
} aqr_marks;

typedef bool (*aqr_worth_a_look)(const aqr_polygon_mesh* m, aqr_index i, const void* options);

/* Marks those of the first n that are worth a look. The marks start zeroed, and may be set anew. */
aqr_status aqr_mark(aqr_context* c, const aqr_polygon_mesh* m, size_t n, aqr_worth_a_look is_worth, const void* options,
  aqr_marks* marks);
void aqr_marks_free(aqr_context* c, aqr_marks* marks);

/* Of those that have come since nothing is known: they are worth a look. */
static inline bool aqr_is_marked(const aqr_marks* marks, aqr_index i)
{
  return i >= marks->n || marks->on[i];
}

#endif
