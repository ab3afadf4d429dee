/* SPDX-License-Identifier: BSD-3-Clause */
/* Crease edges by dihedral angle (paper 3). */
#ifndef AQR_CREASES_H
#define AQR_CREASES_H

#include "surface.h"

/* Marks crease half-edges (both sides) in is_crease (3 * n_faces, caller's): dihedral deviation
 * from flat above `angle` degrees, grown along the crease by hysteresis to 0.6 of it, and chains
 * shorter than min_length (a fraction of the diagonal) or zigzagging (noise of a scan) left out.
 * Counts go to the report. */
aqr_status aqr_features_detect(
  aqr_context* c, const aqr_surface* s, double angle, double min_length, uint8_t* is_crease, aqr_report* report);

#endif
