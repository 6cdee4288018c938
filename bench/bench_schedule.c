/* What a frame would take more threads, by the times of its tasks. */

#include "bench/bench.h"
#include "core/base/context_struct.h"

enum { N_STARTS = 51 };

/* When the tasks of a region begin, of which each holds its thread up for longer than that takes all. */
typedef struct region_starts {
  atomic_size_t n_begun;
  double *begun;
} region_starts;

static void rest_task(void *data, size_t i_item) {
  (void)i_item;
  region_starts *starts = data;
  starts->begun[atomic_fetch_add(&starts->n_begun, 1)] = conic_seconds_now();
  nanosleep(&(struct timespec){.tv_nsec = 5000000}, NULL);
}

static void measure_starts(conic_context *context, size_t n, double *of_all, double *start_ms) {
  double begun[CONIC_MAX_THREADS];
  for (size_t round = 0; round < N_STARTS; round++) {
    region_starts starts = {.begun = begun};
    nanosleep(&(struct timespec){.tv_nsec = 300000}, NULL); /* the others fall asleep */
    double begin = conic_seconds_now();
    conic_parallel_for(context, n, rest_task, &starts);
    for (size_t i = 0; i < n; i++)
      of_all[i * N_STARTS + round] = 1e3 * (begun[i] - begin);
  }
  for (size_t i = 0; i < n; i++) {
    double median = cli_bench_median(of_all + i * N_STARTS, N_STARTS, NULL);
    start_ms[i] = i && median < start_ms[i - 1] ? start_ms[i - 1] : median;
  }
}

conic_status cli_bench_starts_measure(int threads, double *start_ms) {
  conic_context_options options;
  conic_context *context;
  conic_context_options_init(&options);
  options.threads = threads;
  double *of_all = calloc((size_t)threads * N_STARTS, sizeof *of_all);
  conic_status status = of_all ? conic_context_create(&options, &context) : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK) {
    measure_starts(context, (size_t)threads, of_all, start_ms);
    conic_context_destroy(context);
  }
  free(of_all);
  return status;
}

/* --- a heap of when threads are free, the first at the top --- */

static void sink_time(double *heap, int n) {
  for (int i = 0, child; (child = 2 * i + 1) < n; i = child) {
    child += child + 1 < n && heap[child + 1] < heap[child];
    if (heap[i] <= heap[child])
      return;
    double above = heap[i];
    heap[i] = heap[child];
    heap[child] = above;
  }
}

/* When all tasks are done, each of which the first thread takes that is free. Null start_ms: all begin at once. */
static double finish_ms(const double *seconds, size_t n_tasks, int threads, const double *start_ms) {
  double free_at[CONIC_MAX_THREADS] = {0.0}, last = 0.0; /* what rises is a heap, too */
  if (start_ms)
    memcpy(free_at, start_ms, (size_t)threads * sizeof *start_ms);
  for (size_t i = 0; i < n_tasks; i++) {
    free_at[0] += 1e3 * seconds[i];
    last = free_at[0] > last ? free_at[0] : last;
    sink_time(free_at, threads);
  }
  return last;
}

static void schedule_region(const double *seconds, size_t n_tasks, int threads, const double *start_ms,
                            cli_bench_scheduled *scheduled) {
  double work_ms = 0.0, longest_ms = 0.0;
  for (size_t i = 0; i < n_tasks; i++) {
    work_ms += 1e3 * seconds[i];
    longest_ms = 1e3 * seconds[i] > longest_ms ? 1e3 * seconds[i] : longest_ms;
  }
  int is_shared = n_tasks > 1 && threads > 1; /* else the caller does it */
  double ms = is_shared ? finish_ms(seconds, n_tasks, threads, start_ms) : work_ms;
  double at_once_ms = is_shared ? finish_ms(seconds, n_tasks, threads, NULL) : work_ms;
  double share_ms = work_ms / threads, least_ms = longest_ms > share_ms ? longest_ms : share_ms;
  scheduled->n_tasks += n_tasks;
  scheduled->n_regions++;
  scheduled->work_ms += work_ms;
  scheduled->ms += ms;
  scheduled->longest_ms = longest_ms > scheduled->longest_ms ? longest_ms : scheduled->longest_ms;
  scheduled->lost_ms[CLI_BENCH_LOSS_STARTS] += ms - at_once_ms;
  scheduled->lost_ms[CLI_BENCH_LOSS_LONGEST] += least_ms - share_ms;
  scheduled->lost_ms[CLI_BENCH_LOSS_UNEVEN] += at_once_ms - least_ms;
}

/* Where a region of the name is added up. "tile_task" is named "tile". */
static cli_bench_scheduled *scheduled_of(cli_bench_schedule *schedule, const char *name) {
  char shown[sizeof schedule->regions[0].name];
  snprintf(shown, sizeof shown, "%s", name);
  size_t length = strlen(shown);
  if (length > 5 && strcmp(shown + length - 5, "_task") == 0)
    shown[length - 5] = 0;
  for (char *c = shown; *c; c++)
    if (*c == '_')
      *c = ' ';
  for (int i = 0; i < schedule->n_regions; i++)
    if (strcmp(schedule->regions[i].name, shown) == 0)
      return &schedule->regions[i];
  if (schedule->n_regions == CLI_BENCH_MOST_REGIONS) {
    snprintf(schedule->regions[CLI_BENCH_MOST_REGIONS - 1].name, sizeof shown, "others");
    return &schedule->regions[CLI_BENCH_MOST_REGIONS - 1];
  }
  cli_bench_scheduled *next = &schedule->regions[schedule->n_regions++];
  snprintf(next->name, sizeof next->name, "%s", shown);
  return next;
}

void cli_bench_schedule_make(const cli_bench_trace *trace, int threads, const double *start_ms,
                             cli_bench_schedule *schedule) {
  const double *next = trace->kept;
  memset(schedule, 0, sizeof *schedule);
  schedule->threads = threads;
  schedule->start_ms = start_ms[threads - 1];
  for (size_t i = 0; i < trace->n_last_regions; i++) {
    size_t n_tasks = trace->last_regions[i].n_tasks;
    cli_bench_scheduled *region = scheduled_of(schedule, trace->last_regions[i].name);
    region->serial_ms += 1e3 * *next;
    schedule->serial_ms += 1e3 * *next++;
    schedule_region(next, n_tasks, threads, start_ms, region);
    next += n_tasks;
  }
  schedule->serial_ms += 1e3 * *next;
  schedule->ms = schedule->work_ms = schedule->serial_ms;
  schedule->lost_ms[CLI_BENCH_LOSS_SERIAL] = schedule->serial_ms - schedule->serial_ms / threads;
  for (int i = 0; i < schedule->n_regions; i++) {
    schedule->ms += schedule->regions[i].ms;
    schedule->work_ms += schedule->regions[i].work_ms;
    for (int loss = 0; loss < CLI_BENCH_N_LOSSES; loss++)
      schedule->lost_ms[loss] += schedule->regions[i].lost_ms[loss];
  }
}

cli_bench_loss cli_bench_schedule_limit(const cli_bench_schedule *schedule, const char **region) {
  cli_bench_loss limit = CLI_BENCH_LOSS_SERIAL;
  double most_ms = schedule->lost_ms[CLI_BENCH_LOSS_SERIAL];
  *region = NULL;
  for (int i = 0; i < schedule->n_regions; i++)
    for (int loss = 0; loss < CLI_BENCH_N_LOSSES; loss++)
      if (schedule->regions[i].lost_ms[loss] > most_ms) {
        most_ms = schedule->regions[i].lost_ms[loss];
        limit = (cli_bench_loss)loss;
        *region = schedule->regions[i].name;
      }
  return limit;
}

/* --- reports --- */

static const char *const loss_names[CLI_BENCH_N_LOSSES] = {"serial", "starts", "longest", "uneven"};

static double efficiency_of(double work_ms, double ms, int threads) {
  return work_ms / (ms * threads);
}

static void print_scheduled(const cli_bench_schedule *schedule, const cli_bench_scheduled *r) {
  printf("| | %s | %zu | %.2f | %.2f | %.3f | %.2f | %.3f | %.3f | %.3f | |\n", r->name, r->n_tasks, r->serial_ms,
         r->work_ms, r->ms, efficiency_of(r->work_ms, r->ms, schedule->threads), r->longest_ms,
         r->lost_ms[CLI_BENCH_LOSS_STARTS], r->lost_ms[CLI_BENCH_LOSS_LONGEST] + r->lost_ms[CLI_BENCH_LOSS_UNEVEN]);
}

void cli_bench_print_schedules(const cli_bench_line *line) {
  if (!line->n_schedules)
    return;
  printf("\n%s, scheduled by the times of its tasks\n\n", line->name);
  puts("| threads | region | tasks | before, ms | work, ms | ms | efficiency | longest, ms | starts, ms | uneven, ms | "
       "limit |");
  puts("|---|---|---|---|---|---|---|---|---|---|---|");
  for (int i = 0; i < line->n_schedules; i++) {
    const cli_bench_schedule *s = &line->schedules[i];
    const char *region;
    cli_bench_loss limit = cli_bench_schedule_limit(s, &region);
    printf("| %d | frame | | | %.2f | %.3f | %.2f | | %.3f | %.3f | %s%s%s |\n", s->threads, s->work_ms, s->ms,
           efficiency_of(s->work_ms, s->ms, s->threads), s->lost_ms[CLI_BENCH_LOSS_STARTS],
           s->lost_ms[CLI_BENCH_LOSS_LONGEST] + s->lost_ms[CLI_BENCH_LOSS_UNEVEN], loss_names[limit],
           region ? ": " : "", region ? region : "");
    printf("| | serial | | | %.2f | %.3f | | | | | |\n", s->serial_ms, s->serial_ms);
    for (int r = 0; r < s->n_regions; r++)
      print_scheduled(s, &s->regions[r]);
  }
}

static void report_losses(cli_json *json, const double lost_ms[CLI_BENCH_N_LOSSES]) {
  cli_json_object(json, "lost_ms");
  for (int loss = 0; loss < CLI_BENCH_N_LOSSES; loss++)
    cli_json_number(json, loss_names[loss], lost_ms[loss]);
  cli_json_close(json);
}

static void report_schedule(cli_json *json, const cli_bench_schedule *s) {
  const char *region;
  cli_json_object(json, NULL);
  cli_json_count(json, "threads", (uint64_t)s->threads);
  cli_json_figures(json, NULL, {"ms", s->ms}, {"efficiency", efficiency_of(s->work_ms, s->ms, s->threads)},
                   {"work_ms", s->work_ms}, {"serial_ms", s->serial_ms}, {"start_ms", s->start_ms});
  cli_json_text(json, "limit", loss_names[cli_bench_schedule_limit(s, &region)]);
  cli_json_text(json, "limit_region", region);
  report_losses(json, s->lost_ms);
  cli_json_array(json, "regions");
  for (int i = 0; i < s->n_regions; i++) {
    const cli_bench_scheduled *r = &s->regions[i];
    cli_json_object(json, NULL);
    cli_json_text(json, "name", r->name);
    cli_json_counts(json, NULL, {"regions", r->n_regions}, {"tasks", r->n_tasks});
    cli_json_figures(json, NULL, {"serial_ms", r->serial_ms}, {"work_ms", r->work_ms}, {"ms", r->ms},
                     {"longest_ms", r->longest_ms});
    report_losses(json, r->lost_ms);
    cli_json_close(json);
  }
  cli_json_close(json);
  cli_json_close(json);
}

void cli_bench_report_schedules(cli_json *json, const cli_bench_line *line) {
  cli_json_array(json, "schedules");
  for (int i = 0; i < line->n_schedules; i++)
    report_schedule(json, &line->schedules[i]);
  cli_json_close(json);
}
