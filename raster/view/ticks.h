/* A clock that costs next to nothing, for shares of time only: its unit is the machine's. */
#pragma once

#include <stdint.h>

#if defined(__x86_64__)

#include <x86intrin.h>

static inline uint64_t conic_ticks(void) {
  return __rdtsc();
}

#elif defined(__aarch64__)

static inline uint64_t conic_ticks(void) {
  uint64_t ticks;
  __asm__ volatile("mrs %0, cntvct_el0" : "=r"(ticks));
  return ticks;
}

#else

#include <time.h>

static inline uint64_t conic_ticks(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (uint64_t)now.tv_sec * 1000000000u + (uint64_t)now.tv_nsec;
}

#endif
