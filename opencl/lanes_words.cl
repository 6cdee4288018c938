/* The words of core/lanes in OpenCL C, so that what is written in them compiles for devices too: 16 lanes, a block's
 * pixels or as many splats. */
#define CONIC_LANES_H
#define CONIC_LANES_DOUBLE_H
#define CONIC_LANES 16
#define CONIC_HALF_LANES 8
#define CONIC_INLINE static inline

typedef float16 lanes;
typedef int16 int_lanes;
typedef uint16 index_lanes;
typedef int16 lanes_mask;

#define lanes_of(value) ((lanes)(value))
#define lanes_of_index(value) ((index_lanes)(value))
#define lanes_of_int(value) ((int_lanes)(value))
#define lanes_of_ints(value) convert_float16((int_lanes)(value))
#define lanes_to_ints(value) convert_int16_rtz((lanes)(value))
#define lanes_of_bits(bits) as_float16((index_lanes)(bits))
#define lanes_to_bits(value) as_uint16((lanes)(value))
#define ints_of_indices(value) as_int16((index_lanes)(value))
#define indices_of_ints(value) as_uint16((int_lanes)(value))
#define lanes_sqrt(value) sqrt((lanes)(value))
#define lanes_absolute(value) fabs((lanes)(value))

CONIC_INLINE lanes_mask lanes_less(lanes a, lanes b) {
  return a < b;
}

CONIC_INLINE lanes_mask lanes_at_least(lanes a, lanes b) {
  return a >= b;
}

CONIC_INLINE lanes_mask lanes_less_int(int_lanes a, int_lanes b) {
  return a < b;
}

CONIC_INLINE lanes_mask lanes_not(lanes_mask mask) {
  return ~mask;
}

CONIC_INLINE lanes lanes_select(lanes_mask mask, lanes yes, lanes no) {
  return mask ? yes : no;
}

CONIC_INLINE index_lanes lanes_select_indices(lanes_mask mask, index_lanes yes, index_lanes no) {
  return mask ? yes : no;
}

CONIC_INLINE lanes lanes_keep(lanes_mask mask, lanes value) {
  return mask ? value : (lanes)0.0f;
}

CONIC_INLINE index_lanes lanes_increment(lanes_mask mask, index_lanes value) {
  return value - as_uint16(mask);
}

CONIC_INLINE lanes_mask lanes_has_bits(index_lanes value, uint mask) {
  return (value & mask) != 0u;
}

CONIC_INLINE lanes lanes_max(lanes a, lanes b) {
  return a > b ? a : b;
}

CONIC_INLINE lanes lanes_min(lanes a, lanes b) {
  return a < b ? a : b;
}

CONIC_INLINE int lanes_any(lanes_mask mask) {
  int8 a = mask.lo | mask.hi;
  int4 b = a.lo | a.hi;
  long2 c = as_long2(b);
  return (c.x | c.y) != 0;
}

#include "core/lanes/lanes_exponential.h"
