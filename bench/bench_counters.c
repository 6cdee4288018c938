/* Cycles and instructions, where the machine counts them for us: Linux's perf events, which virtual machines often
 * lack. */
#include <unistd.h>

#include "bench/bench.h"

#if defined(__linux__) && __has_include(<linux/perf_event.h>)

#include <linux/perf_event.h>
#include <sys/syscall.h>

long syscall(long number, ...); /* which POSIX headers leave out */

static int open_counter(uint64_t what) {
  struct perf_event_attr event;
  memset(&event, 0, sizeof event);
  event.size = sizeof event;
  event.type = PERF_TYPE_HARDWARE;
  event.config = what;
  event.exclude_kernel = event.exclude_hv = 1;
  event.inherit = 1; /* threads that are started later count into it too */
  return (int)syscall(SYS_perf_event_open, &event, 0, -1, -1, 0UL);
}

cli_bench_counters cli_bench_counters_open(void) {
  return (cli_bench_counters){open_counter(PERF_COUNT_HW_CPU_CYCLES), open_counter(PERF_COUNT_HW_INSTRUCTIONS)};
}

#else

cli_bench_counters cli_bench_counters_open(void) {
  return (cli_bench_counters){-1, -1};
}

#endif

double cli_bench_counter_read(int counter) {
  uint64_t n;
  return counter >= 0 && read(counter, &n, sizeof n) == (ssize_t)sizeof n ? (double)n : (double)NAN;
}

void cli_bench_counters_close(const cli_bench_counters *counters) {
  if (counters->cycles >= 0)
    close(counters->cycles);
  if (counters->instructions >= 0)
    close(counters->instructions);
}
