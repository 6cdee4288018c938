/* The time that passes: for statistics and limits of time, never for what is computed. */
#ifndef CONIC_CLOCK_H
#define CONIC_CLOCK_H

#include <time.h>

/* Seconds since some moment, by a clock that nobody sets. */
static inline double conic_seconds_now(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

#endif
