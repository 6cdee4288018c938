/* All loops beside plain C: for the test `cross` and for `conic bench --kernels`. */
#pragma once

#include <stdint.h>

#define CONIC_CROSS_SEED 20260718

/* Prints the seed and compares; or, n_timed above 0, compares less and prints the least of so many times, which ends
 * where something failed. Returns how much failed. */
int cli_cross_all(uint64_t seed, int n_timed);
