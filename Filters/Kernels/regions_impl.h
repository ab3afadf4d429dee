/* SPDX-License-Identifier: BSD-3-Clause */
/* What the count of the regions leaves for those that list the cells of some. */
#ifndef AQR_REGIONS_IMPL_H
#define AQR_REGIONS_IMPL_H

#include "face_layout.h"
#include "shared.h"

typedef _Atomic(int32_t) aqr_shared_number;
typedef _Atomic(uint8_t) aqr_shared_flag;

/* What a region has. */
enum
{
  AQR_HAS_LOOP = 1,
  AQR_HAS_CELL = 2,
  AQR_GOES_ON = 4 /* among faces not looked at */
};

typedef struct aqr_regions
{
  aqr_context* c;
  const aqr_surface* s;
  const aqr_chains* chains;
  const aqr_network* net;
  aqr_lines* lines;
  /* Shared by threads; whatever their order, a root is the least item of its region and sums are the same. */
  aqr_shared_index* parent; /* union-find over items: faces without chords, then loops */
  size_t n_items;
  aqr_shared_number* euler;  /* per item, and of its whole region per root when all is counted */
  aqr_shared_flag* bordered; /* as euler: bits of the above */
  uint8_t* suspect;          /* per face: looked at */
  uint8_t* picked;           /* per face: to be looked at by one thread alone */
  uint8_t* is_bare;          /* per face: of a component without network */
  aqr_index* start;          /* per half-edge: the item where it begins, AQR_NONE where it is cut */
  aqr_layout at;             /* of the face looked at */
} aqr_regions;

/* Whether arcs must cut the region of an item, when all is counted. */
bool aqr_region_needs_cut(const aqr_regions* r, aqr_index item);

#endif
