/* How long the tasks of a frame take, one after the other. */

#include "bench/bench.h"

/* Makes room in an array, of which this is the address. Returns 0 where there is no memory. */
static int make_trace_room(cli_bench_trace *trace, void *array, size_t wanted, size_t *room, size_t size) {
  if (trace->is_broken)
    return 0;
  if (wanted <= *room)
    return 1;
  size_t larger = wanted + wanted / 2 + 64;
  void **place = array, *moved = realloc(*place, larger * size);
  if (!moved) {
    trace->is_broken = 1;
    return 0;
  }
  *place = moved;
  *room = larger;
  return 1;
}

static double trace_now(const cli_bench_trace *trace) {
  struct timespec now;
  if (!trace->is_whole)
    return conic_seconds_now();
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* What passed since the part before. */
static void note_trace_part(cli_bench_trace *trace) {
  double now = trace_now(trace);
  if (make_trace_room(trace, &trace->seconds, trace->n_seconds + 1, &trace->seconds_room, sizeof *trace->seconds)) {
    trace->seconds[trace->n_seconds++] = now - trace->now;
  }
  trace->now = trace_now(trace);
}

void cli_bench_trace_begin(cli_bench_trace *trace) {
  trace->n_regions = trace->n_seconds = 0;
  trace->now = trace_now(trace);
}

void cli_bench_trace_watch(void *cookie, const char *name, size_t n_tasks, size_t n_done) {
  cli_bench_trace *trace = cookie;
  note_trace_part(trace);
  if (n_done ||
      !make_trace_room(trace, &trace->regions, trace->n_regions + 1, &trace->regions_room, sizeof *trace->regions))
    return;
  trace->regions[trace->n_regions++] = (cli_bench_region){name, n_tasks};
}

static int has_last_regions(const cli_bench_trace *trace) {
  int is_same = trace->n_rows && trace->n_regions == trace->n_last_regions;
  for (size_t i = 0; i < trace->n_regions && is_same; i++)
    is_same = trace->regions[i].n_tasks == trace->last_regions[i].n_tasks &&
              strcmp(trace->regions[i].name, trace->last_regions[i].name) == 0;
  return is_same;
}

static void take_regions(cli_bench_trace *trace) {
  if (!make_trace_room(trace, &trace->last_regions, trace->n_regions, &trace->last_regions_room,
                       sizeof *trace->last_regions))
    return;
  if (trace->n_regions)
    memcpy(trace->last_regions, trace->regions, trace->n_regions * sizeof *trace->regions);
  trace->n_last_regions = trace->n_regions;
  trace->n_a_row = trace->n_seconds;
  trace->n_rows = 0;
}

void cli_bench_trace_end(cli_bench_trace *trace) {
  note_trace_part(trace);
  if (!has_last_regions(trace))
    take_regions(trace);
  if (!make_trace_room(trace, &trace->kept, (trace->n_rows + 1) * trace->n_a_row, &trace->kept_room,
                       sizeof *trace->kept))
    return;
  memcpy(trace->kept + trace->n_rows++ * trace->n_a_row, trace->seconds, trace->n_a_row * sizeof *trace->kept);
}

conic_status cli_bench_trace_settle(cli_bench_trace *trace) {
  size_t first = trace->n_rows > 1, n = trace->n_rows - first;
  double *of_part = trace->is_broken || !trace->n_rows ? NULL : malloc(n * sizeof *of_part);
  if (!of_part)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < trace->n_a_row; i++) {
    for (size_t row = 0; row < n; row++)
      of_part[row] = trace->kept[(first + row) * trace->n_a_row + i];
    trace->kept[i] = cli_bench_median(of_part, n, NULL);
  }
  trace->n_rows = 1;
  free(of_part);
  return CONIC_OK;
}

void cli_bench_trace_release(cli_bench_trace *trace) {
  free(trace->regions);
  free(trace->last_regions);
  free(trace->seconds);
  free(trace->kept);
  memset(trace, 0, sizeof *trace);
}
