/* Random numbers for tests: the same on every machine. */
#pragma once

#include <stdint.h>

/* In [0, 1); moves the state on. */
static inline double random_unit(uint64_t *state) {
  uint64_t x = *state += 0x9E3779B97F4A7C15u;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
  return (double)((x ^ (x >> 31)) >> 11) / 9007199254740992.0;
}
