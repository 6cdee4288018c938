/* What a whole command would take more threads: --command with --simulate-threads. */
#include "bench/bench_job.h"
#include "cli/command.h"
#include "core/base/context_struct.h"

enum { MOST_WORDS = 64, RUNS = 3 };

/* What the session's context is told once it is there. */
typedef struct whole_plan {
  int threads;
  cli_bench_trace *trace;
} whole_plan;

static void plan_context(void *cookie, conic_context *context) {
  const whole_plan *plan = cookie;
  conic_parallel_plan(context, plan->threads, cli_bench_trace_watch, plan->trace);
}

/* Runs the command once, by one thread that shares out as for more. */
static int run_once(const char *text, whole_plan *plan) {
  char *words[MOST_WORDS + 1] = {"conic"}, *room = strdup(text), *rest = NULL;
  int n_words = 1;
  if (!room)
    return cli_error(CLI_RESOURCE, "bench: out of memory");
  for (char *word = strtok_r(room, " ", &rest); word && n_words < MOST_WORDS; word = strtok_r(NULL, " ", &rest))
    words[n_words++] = word;
  cli_session_plan(plan_context, plan);
  cli_bench_trace_begin(plan->trace);
  int exit_code = cli_program(n_words, words, NULL);
  cli_bench_trace_end(plan->trace);
  cli_session_plan(NULL, NULL);
  free(room);
  return exit_code;
}

static int simulate_whole(const cli_bench_job *job, int threads, cli_bench_schedule *schedule) {
  cli_bench_trace trace = {.is_whole = 1};
  whole_plan plan = {threads, &trace};
  double start_ms[CONIC_MAX_THREADS];
  int exit_code = cli_exit_of(cli_bench_starts_measure(threads, start_ms));
  for (int i = 0; i < (job->repeat ? job->repeat : RUNS) && exit_code == CLI_DONE; i++)
    exit_code = run_once(job->command, &plan);
  if (exit_code == CLI_DONE)
    exit_code = cli_exit_of(cli_bench_trace_settle(&trace));
  if (exit_code == CLI_DONE)
    cli_bench_schedule_make(&trace, threads, start_ms, schedule);
  cli_bench_trace_release(&trace);
  return exit_code;
}

int cli_bench_whole_run(cli_bench_job *job) {
  int exit_code = CLI_DONE;
  free(job->lines); /* those of frames */
  job->n_lines = 0;
  job->lines = calloc(1, sizeof *job->lines);
  if (job->lines)
    job->lines->schedules = calloc((size_t)job->n_simulated, sizeof *job->lines->schedules);
  if (!job->lines || !job->lines->schedules)
    return cli_error(CLI_RESOURCE, "bench: out of memory");
  snprintf(job->lines->name, sizeof job->lines->name, "%s", job->command);
  job->n_lines = 1;
  for (int i = 0; i < job->n_simulated && exit_code == CLI_DONE; i++)
    exit_code = simulate_whole(job, job->simulated[i], &job->lines->schedules[job->lines->n_schedules++]);
  return exit_code;
}
