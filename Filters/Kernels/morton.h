/* SPDX-License-Identifier: BSD-3-Clause */
/* Places along a space-filling curve: near in number is near in space. */
#ifndef AQR_MORTON_H
#define AQR_MORTON_H

#include "vector.h"

#include <stdint.h>

/* Spreads the lower ten bits of x to every third bit. */
static inline uint32_t aqr_spread_bits(uint32_t x)
{
  x = (x | x << 16) & 0x030000ffu;
  x = (x | x << 8) & 0x0300f00fu;
  x = (x | x << 4) & 0x030c30c3u;
  return (x | x << 2) & 0x09249249u;
}

/* The Morton code of a point of the unit box around the origin. */
static inline uint32_t aqr_morton(vec3 p)
{
  uint32_t x = (uint32_t)(1023 * lesser(1, greater(0, p.x + 0.5))),
           y = (uint32_t)(1023 * lesser(1, greater(0, p.y + 0.5)));
  uint32_t z = (uint32_t)(1023 * lesser(1, greater(0, p.z + 0.5)));
  return aqr_spread_bits(x) | aqr_spread_bits(y) << 1 | aqr_spread_bits(z) << 2;
}

#endif
