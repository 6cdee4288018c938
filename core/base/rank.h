/* The value at a place of the order, found without sorting. */
#pragma once

#include <stddef.h>
#include <stdint.h>

/* The number at place `rank` of n floats without NaN, were they sorted; rank < n. -0 comes before 0. Takes time
 * proportional to n. */
float conic_float_of_rank(const float *values, size_t n, size_t rank);
