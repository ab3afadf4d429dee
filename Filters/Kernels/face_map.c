/* SPDX-License-Identifier: BSD-3-Clause */
#include "face_map.h"

#include <string.h>

enum
{
  first_size = 256
};

aqr_status aqr_face_map_init(aqr_context* c, aqr_face_map* map)
{
  *map = (aqr_face_map){ .size = first_size, .capacity = first_size, .turn = 1 };
  map->spots = AQR_NEW0(c, aqr_spot, first_size);
  return map->spots ? AQR_OK : AQR_OUT_OF_MEMORY;
}

void aqr_face_map_free(aqr_context* c, aqr_face_map* map)
{
  AQR_DROP(c, map->spots, map->capacity);
  memset(map, 0, sizeof *map);
}

/* Becomes smaller by and by, since a large table that holds little is slow. */
void aqr_face_map_clear(aqr_face_map* map)
{
  if (map->size > first_size && 8 * map->n < map->size)
    map->size /= 2;
  map->n = 0;
  if (++map->turn == 0) /* the counter came round: no spot of an earlier turn may be taken for a new one */
  {
    memset(map->spots, 0, map->capacity * sizeof *map->spots);
    map->turn = 1;
  }
}

bool aqr_face_map_grow(aqr_context* c, aqr_face_map* map, size_t more)
{
  aqr_face_map larger = { .size = map->size, .turn = 1 };
  while (larger.size < 2 * (map->n + more))
    larger.size *= 2;
  larger.capacity = larger.size;
  larger.spots = AQR_NEW0(c, aqr_spot, larger.size);
  if (!larger.spots)
    return false;
  for (size_t i = 0; i < map->size; i++)
  {
    const aqr_spot* from = &map->spots[i];
    if (aqr_face_map_has(map, from))
      aqr_face_map_take(&larger, aqr_face_map_find(&larger, from->face), from->face, from->value);
  }
  aqr_face_map_free(c, map);
  *map = larger;
  return true;
}
