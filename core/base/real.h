/* Floating-point numbers as they are stored: whether they are finite, their bits, and comparisons for qsort; and
 * searches in what is in order. */
#pragma once

#include <stdint.h>
#include <string.h>

/* Also for floats, and for products that may have become infinite. */
static inline int conic_is_finite(double value) {
  return value - value == 0.0;
}

/* The bits of numbers that are not negative have the numbers' order. */
static inline uint64_t conic_bits_of_double(double value) {
  uint64_t bits;
  memcpy(&bits, &value, sizeof bits);
  return bits;
}

static inline double conic_double_of_bits(uint64_t bits) {
  double value;
  memcpy(&value, &bits, sizeof value);
  return value;
}

static inline uint32_t conic_bits_of_float(float value) {
  uint32_t bits;
  memcpy(&bits, &value, sizeof bits);
  return bits;
}

static inline float conic_float_of_bits(uint32_t bits) {
  float value;
  memcpy(&value, &bits, sizeof value);
  return value;
}

/* 2^exponent, from 2^-1022 to 2^1023. */
static inline double conic_power_of_two(int exponent) {
  return conic_double_of_bits((uint64_t)(exponent + 1023) << 52);
}

static inline int conic_compare_doubles(const void *a, const void *b) {
  const double *first = a, *second = b;
  return (*first > *second) - (*first < *second);
}

/* The nearest number from 0 to 1; 0 for NaN. */
static inline double conic_unit(double v) {
  return v > 0.0 ? v < 1.0 ? v : 1.0 : 0.0;
}

static inline int conic_least(int a, int b) {
  return a < b ? a : b;
}

static inline int conic_greatest(int a, int b) {
  return a > b ? a : b;
}

/* Below, at or above zero, as a is below, at or above b. */
#define CONIC_ORDER(a, b) (((a) > (b)) - ((a) < (b)))

/* Defines a static comparison of structs by a member; and by one that decides where the first is the same. */
/* NOLINTBEGIN(bugprone-macro-parentheses): types and members, which stand bare */
#define CONIC_DEFINE_ORDER(function, type, member)                                                                     \
  static int function(const void *a, const void *b) {                                                                  \
    const type *first = a, *second = b;                                                                                \
    return CONIC_ORDER(first->member, second->member);                                                                 \
  }
#define CONIC_DEFINE_ORDER_BY_TWO(function, type, member, other)                                                       \
  static int function(const void *a, const void *b) {                                                                  \
    const type *first = a, *second = b;                                                                                \
    int order = CONIC_ORDER(first->member, second->member);                                                            \
    return order ? order : CONIC_ORDER(first->other, second->other);                                                   \
  }
/* And of numbers. */
#define CONIC_DEFINE_ORDER_OF(function, type)                                                                          \
  static inline int function(const void *a, const void *b) {                                                           \
    return CONIC_ORDER(*(const type *)a, *(const type *)b);                                                            \
  }
/* NOLINTEND(bugprone-macro-parentheses) */

/* Raises `low`, a size_t, to the number of the first of n items for which `comes_before`, an expression of the number
 * `middle`, is false. It is true of all items before that, and false of all behind. */
/* NOLINTBEGIN(bugprone-macro-parentheses): a variable, which is set */
#define CONIC_BISECT(low, n, comes_before)                                                                             \
  do {                                                                                                                 \
    size_t behind = (n);                                                                                               \
    while (low < behind) {                                                                                             \
      const size_t middle = low + (behind - low) / 2;                                                                  \
      if (comes_before)                                                                                                \
        low = middle + 1;                                                                                              \
      else                                                                                                             \
        behind = middle;                                                                                               \
    }                                                                                                                  \
  } while (0)
/* NOLINTEND(bugprone-macro-parentheses) */
