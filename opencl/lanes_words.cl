/* The words of core/lanes in OpenCL C, so that what is written in them compiles for devices too: 16 lanes, a block's
 * pixels or as many splats. */
#define CONIC_LANES_H
#define CONIC_LANES_DOUBLE_H
#define CONIC_LANES_TABLE_H
#define CONIC_LANES 16
#define CONIC_WIDE_LANES 8
#define CONIC_INLINE static inline CONIC_ALWAYS_INLINE /* opencl/program.c */
#define CONIC_OUTLINE static
/* A block of 4 × 4 pixels is one vector, column by column. */
#define CONIC_PARTS 1

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
#define lanes_columns() ((int_lanes)(0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3))
#define lanes_rows() ((int_lanes)(0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3))
#define lanes_ascending(first) ((index_lanes)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15) + (uint)(first))
#define lanes_load(from) vload16(0, from)
#define lanes_store(to, value) vstore16(value, 0, to)
#define lanes_load_indices(from) vload16(0, from)
#define lanes_store_indices(to, value) vstore16(value, 0, to)
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

CONIC_INLINE int_lanes lanes_select_ints(lanes_mask mask, int_lanes yes, int_lanes no) {
  return mask ? yes : no;
}

CONIC_INLINE void lanes_replace_indices(uint *to, lanes_mask mask, index_lanes value) {
  vstore16(mask ? value : vload16(0, to), 0, to);
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

/* Bit l for lane l, where the compiler has no word for it (opencl/program.c). */
CONIC_INLINE uint lanes_gather_bits(lanes_mask mask) {
  int16 bits = mask & (int16)(1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024, 2048, 4096, 8192, 16384, 32768);
  int8 a = bits.lo | bits.hi;
  int4 b = a.lo | a.hi;
  int2 c = b.lo | b.hi;
  return (uint)(c.x | c.y);
}

CONIC_INLINE int lanes_find_any(lanes_mask mask) {
  int8 a = mask.lo | mask.hi;
  int4 b = a.lo | a.hi;
  long2 c = as_long2(b);
  return (c.x | c.y) != 0;
}

#define lanes_any(mask) CONIC_LANES_ANY(mask)
#define lanes_bits(mask) CONIC_LANES_BITS(mask)

CONIC_INLINE lanes_mask lanes_mask_of(uint bits) {
  return (bits & (index_lanes)(1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024, 2048, 4096, 8192, 16384, 32768)) != 0u;
}

CONIC_INLINE index_lanes lanes_bring_forward(lanes_mask mask, index_lanes value) {
  index_lanes packed = 0;
  for (uint bits = lanes_gather_bits(mask), n = 0; bits; bits &= bits - 1)
    ((uint *)&packed)[n++] = ((const uint *)&value)[31 - clz(bits & -bits)];
  return packed;
}

/* There is room for all lanes. */
CONIC_INLINE size_t lanes_append(uint *to, lanes_mask mask, index_lanes value) {
  vstore16(CONIC_LANES_PACK(mask, value), 0, to);
  return popcount(lanes_bits(mask));
}

#define __builtin_prefetch(pointer) CONIC_FETCH_AHEAD(pointer)

CONIC_INLINE uint lanes_count(lanes_mask mask) {
  int8 a = mask.lo + mask.hi;
  int4 b = a.lo + a.hi;
  int2 c = b.lo + b.hi;
  return (uint)-(c.x + c.y);
}

#define CONIC_TABLE_PARTS 1

typedef struct lanes_table {
  lanes part[CONIC_TABLE_PARTS];
} lanes_table;

CONIC_INLINE lanes lanes_look_up(const lanes_table *table, int_lanes place) {
  lanes value;
  for (int lane = 0; lane < CONIC_LANES; lane++)
    ((float *)&value)[lane] = ((const float *)table)[((const int *)&place)[lane] & 15];
  return value;
}

#include "core/lanes/lanes_exponential.h"
