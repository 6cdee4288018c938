/* Time that passes, and time that threads work: for statistics and time limits, never for results. */
#pragma once

#include <time.h>

/* Seconds since some moment, by a clock that nobody sets. */
static inline double conic_seconds_now(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* A moment, and how long the calling thread has worked until then. */
typedef struct conic_moment {
  double clock_s, processor_s;
} conic_moment;

static inline conic_moment conic_moment_now(void) {
  struct timespec worked;
  if (clock_gettime(CLOCK_THREAD_CPUTIME_ID, &worked) != 0)
    worked = (struct timespec){0, 0};
  return (conic_moment){conic_seconds_now(), (double)worked.tv_sec + 1e-9 * (double)worked.tv_nsec};
}
