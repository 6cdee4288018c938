/* The words of core/lanes/lanes_double.h in OpenCL C, for devices with double precision. */
typedef double8 half_doubles;

typedef struct doubles {
  half_doubles half[2];
} doubles;

#define half_of_value(value) ((half_doubles)(value))
#define half_sqrt(value) sqrt((half_doubles)(value))

CONIC_INLINE half_doubles half_of(lanes value, int i_half) {
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

CONIC_INLINE half_doubles half_max(half_doubles a, half_doubles b) {
  return a > b ? a : b;
}

CONIC_INLINE half_doubles half_min(half_doubles a, half_doubles b) {
  return a < b ? a : b;
}

CONIC_INLINE lanes_mask lanes_greater_double(const doubles *a, double b) {
  return (lanes_mask)(convert_int8(a->half[0] > b), convert_int8(a->half[1] > b));
}
