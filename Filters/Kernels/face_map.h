/* SPDX-License-Identifier: BSD-3-Clause */
/* A number for each of a few faces: a hash table that is emptied at no cost. For one of many searches that go on side
 * by side an array over all faces would be too large. */
#ifndef AQR_FACE_MAP_H
#define AQR_FACE_MAP_H

#include "context.h"

typedef struct aqr_spot
{
  aqr_index face;
  uint32_t turn; /* the spot is taken where this is the map's turn */
  aqr_index value;
} aqr_spot;

typedef struct aqr_face_map
{
  aqr_spot* spots;
  size_t size, n; /* size: of what is in use, a power of two; n spots are taken */
  size_t capacity;
  uint32_t turn;
} aqr_face_map;

aqr_status aqr_face_map_init(aqr_context* c, aqr_face_map* map);
void aqr_face_map_free(aqr_context* c, aqr_face_map* map);
void aqr_face_map_clear(aqr_face_map* map);

/* Makes room for `more` faces; false when out of memory. */
bool aqr_face_map_grow(aqr_context* c, aqr_face_map* map, size_t more);
static inline bool aqr_face_map_reserve(aqr_context* c, aqr_face_map* map, size_t more)
{
  return 2 * (map->n + more) <= map->size || aqr_face_map_grow(c, map, more);
}

/* The spot of a face, near those of the faces numbered beside it; one that is free where the map does not have it. */
static inline aqr_spot* aqr_face_map_find(const aqr_face_map* map, aqr_index face)
{
  size_t at = (((face >> 2) * (size_t)0x9e3779b97f4a7c15u >> 32 << 2) + (face & 3)) & (map->size - 1);
  while (map->spots[at].turn == map->turn && map->spots[at].face != face)
    at = (at + 1) & (map->size - 1);
  return &map->spots[at];
}

static inline bool aqr_face_map_has(const aqr_face_map* map, const aqr_spot* spot)
{
  return spot->turn == map->turn;
}

/* Takes a free spot that was found for the face. */
static inline void aqr_face_map_take(aqr_face_map* map, aqr_spot* spot, aqr_index face, aqr_index value)
{
  *spot = (aqr_spot){ face, map->turn, value };
  map->n++;
}

#endif
