/* SPDX-License-Identifier: BSD-3-Clause */
/* T-joints, where a line ends on another: the face beyond is a pentagon. A line may instead go on for a few faces, if
 * it then meets a triangle, a pentagon from its other side or the border, or go back altogether where it is short. On
 * creases that it crosses it leaves vertices whose places are not known yet. */
#ifndef AQR_JOINTS_H
#define AQR_JOINTS_H

#include "polygon_mesh.h"

/* Prolongs lines from T-joints through at most `reach` faces where that leaves fewer faces that are not quads. A
 * regular mesh stays regular but for equal faces. */
aqr_status aqr_joints_extend(aqr_context* c, aqr_polygon_mesh* m, unsigned reach);

#endif
