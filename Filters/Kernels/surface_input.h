/* SPDX-License-Identifier: BSD-3-Clause */
/* From the points and triangles of the input, whatever they are, to triangles that a surface can be made of. */
#ifndef AQR_SURFACE_INPUT_H
#define AQR_SURFACE_INPUT_H

#include "surface.h"

/* Checks the input and joins points with the same coordinates. weld, to be released with a length of the input's points
 * whatever the status: per input point the one it was joined to, AQR_NONE where nothing uses it. */
aqr_status aqr_input_weld(aqr_context* c, const aqr_input* input, aqr_report* report, aqr_index** weld);

/* Takes the triangles with three different points, on request each set of points once, and finds centre and diagonal.
 * The corners are input points still. */
aqr_status aqr_input_take(
  aqr_context* c, const aqr_input* input, aqr_index* weld, bool unique, aqr_surface* s, aqr_report* report);

#endif
