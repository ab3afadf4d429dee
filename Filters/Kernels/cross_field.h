/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef AQR_CROSS_FIELD_H
#define AQR_CROSS_FIELD_H

#include "field.h"
#include "neighbours.h"

/* Fills field->cross from the rest of the field: the principal directions where they are trusted,
 * creases and borders elsewhere, and a smooth blend between. min_cosine as in aqr_direction_field. */
aqr_status aqr_cross_field(
  aqr_context* c, const aqr_surface* s, const aqr_neighbours* around, double min_cosine, aqr_field* field);

#endif
