/* All loops beside plain C: for the test `cross` and for `conic bench --kernels`. */
#pragma once

#include <stdint.h>

#define CONIC_CROSS_SEED 20260718

/* Prints the seed and compares, or compares less and prints times, which end where something failed. Returns how much
 * failed. */
int cli_cross_all(uint64_t seed, int is_bench);
