/* The words of core/lanes/lanes_double.h in OpenCL C, for devices with double precision. */
typedef double8 wide;

typedef struct doubles {
  wide half[2];
} doubles;

#define wide_of(value) ((wide)(value))
#define wide_sqrt(value) sqrt((wide)(value))

CONIC_INLINE wide half_of(lanes value, int i_half) {
  if (i_half == 0)
    return convert_double8(value.lo);
  return convert_double8(value.hi);
}

CONIC_INLINE lanes lanes_narrow(const doubles *value) {
  return (lanes)(convert_float8(value->half[0]), convert_float8(value->half[1]));
}

CONIC_INLINE int_lanes lanes_truncate(const doubles *value) {
  return (int_lanes)(convert_int8(value->half[0]), convert_int8(value->half[1]));
}

CONIC_INLINE wide wide_max(wide a, wide b) {
  return a > b ? a : b;
}

CONIC_INLINE wide wide_min(wide a, wide b) {
  return a < b ? a : b;
}

CONIC_INLINE lanes_mask lanes_greater_double(const doubles *a, double b) {
  return (lanes_mask)(convert_int8(a->half[0] > b), convert_int8(a->half[1] > b));
}
