/* Floating-point numbers as they are stored: whether they are finite, their bits, and their order for qsort. */
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

static inline int conic_least(int a, int b) {
  return a < b ? a : b;
}

static inline int conic_greatest(int a, int b) {
  return a > b ? a : b;
}
