/* The value at a place of the order, found without sorting. */
#pragma once

#include <stddef.h>
#include <stdint.h>

/* The number at place `rank` of the n numbers, were they sorted; rank < n. Takes time proportional to n. */
uint32_t conic_bits_of_rank(const uint32_t *numbers, size_t n, size_t rank);

/* The same for floats without NaN; -0 comes before 0. */
float conic_float_of_rank(const float *values, size_t n, size_t rank);
