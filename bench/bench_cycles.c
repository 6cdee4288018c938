/* Cycles, where the machine counts them for us: Linux's perf events, which virtual machines often lack. */
#include <math.h>
#include <stdint.h>
#include <string.h>
#include <unistd.h>

#include "bench/bench.h"

#if defined(__linux__) && __has_include(<linux/perf_event.h>)

#include <linux/perf_event.h>
#include <sys/syscall.h>

long syscall(long number, ...); /* which POSIX headers leave out */

int cli_bench_cycles_open(void) {
  struct perf_event_attr event;
  memset(&event, 0, sizeof event);
  event.size = sizeof event;
  event.type = PERF_TYPE_HARDWARE;
  event.config = PERF_COUNT_HW_CPU_CYCLES;
  event.exclude_kernel = event.exclude_hv = 1;
  event.inherit = 1; /* threads that are started later count into it too */
  return (int)syscall(SYS_perf_event_open, &event, 0, -1, -1, 0UL);
}

#else

int cli_bench_cycles_open(void) {
  return -1;
}

#endif

double cli_bench_cycles_read(int counter) {
  uint64_t cycles;
  return counter >= 0 && read(counter, &cycles, sizeof cycles) == (ssize_t)sizeof cycles ? (double)cycles : (double)NAN;
}

void cli_bench_cycles_close(int counter) {
  if (counter >= 0)
    close(counter);
}
