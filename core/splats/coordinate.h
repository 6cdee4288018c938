/* A point's coordinate as its file has it, for comparisons that a user writes. */
#pragma once

#include <float.h>
#include <math.h>

/* A set keeps a coordinate as a float beside an origin, and so rounds it. Files mostly have few decimals. The number
 * that is asked for is the nearest one with so many decimals as the float can tell apart, if it becomes the same float;
 * else origin + offset. So 121 is 121, where the sum is 120.99999997. Cannot fail. */
static inline double conic_coordinate_of(double origin, float offset) {
  const double place = origin + (double)offset;
  int binary;
  (void)frexp((double)offset, &binary); /* a step of the float is 2^(binary - 24) */
  int decimals = (int)floor((24 - binary) * 0.30102999566398120);
  if (offset == 0.0f || decimals < 0 || decimals > 15 || !(fabs(place) < 1e9))
    return place;
  double parts = 1.0;
  for (int i = 0; i < decimals; i++)
    parts *= 10.0;
  const double known = nearbyint(place * parts) / parts;
  return (float)(known - origin) == offset ? known : place;
}
