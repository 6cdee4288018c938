/* The value that stands at a place of the order, found without sorting. */
#ifndef CONIC_RANK_H
#define CONIC_RANK_H

#include <stddef.h>
#include <stdint.h>

/* The number that `rank` of the n others are not above, were they sorted; rank < n. In time that grows as their number.
 */
uint32_t conic_bits_of_rank(const uint32_t *numbers, size_t n, size_t rank);

/* The same of floats, none of which is not a number; -0 comes before 0. */
float conic_float_of_rank(const float *values, size_t n, size_t rank);

#endif
