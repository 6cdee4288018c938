/* conic simulate: what a job of conic-mpi would take on more ranks. */
#include <math.h>

#include "bench/rank_schedule.h"
#include "cli/arguments.h"
#include "cli/command.h"
#include "cli/json_write.h"
#include "cli/outputs.h"

enum { MOST_ESTIMATES = 32 };

typedef struct simulate_job {
  int n_ranks[MOST_ESTIMATES], n; /* of the estimates */
  double latency_us, gigabytes_per_s;
  unsigned long long times;
  int is_by_processor;
  const char *picture_path; /* --svg; null: none */
  cli_rank_trace trace;
  cli_rank_estimate estimates[MOST_ESTIMATES], same; /* same: on as many ranks as the trace is of */
} simulate_job;

static const char *const loss_names[CLI_RANK_N_LOSSES] = {"open", "first", "uneven", "merge", "write"};

static int parse_ranks(const char *text, void *value) {
  simulate_job *job = value;
  unsigned long long n;
  char word[32];
  for (job->n = 0; *text; text += *text == ',') {
    size_t length = 0;
    while (*text && *text != ',' && length < sizeof word - 1)
      word[length++] = *text++;
    word[length] = '\0';
    if (job->n == MOST_ESTIMATES || !cli_parse_count(word, &n) || n < 1 || n > CLI_MOST_RANKS)
      return 0;
    job->n_ranks[job->n++] = (int)n;
  }
  return job->n > 0;
}

static cli_rank_loss limit_of(const cli_rank_estimate *e) {
  int most = 0;
  for (int i = 1; i < CLI_RANK_N_LOSSES; i++)
    if (e->lost_s[i] > e->lost_s[most])
      most = i;
  return (cli_rank_loss)most;
}

static void print_estimates(const simulate_job *job) {
  const cli_rank_trace *trace = &job->trace;
  if (trace->job != CLI_RANK_UNITS)
    printf("Building on %d ranks took %.3f s; %.3f s by the model\n\n", trace->n_ranks, trace->seconds,
           job->same.seconds);
  else
    printf("%zu units on %d ranks took %.3f s; %.3f s by the model\n\n", trace->n_units, trace->n_ranks, trace->seconds,
           job->same.seconds);
  puts("| ranks | s | efficiency | rank hours | most is lost by | s |\n|---|---|---|---|---|---|");
  for (int i = 0; i < job->n; i++) {
    const cli_rank_estimate *e = &job->estimates[i];
    cli_rank_loss limit = limit_of(e);
    printf("| %d | %.3f | %.2f | %.4f | %s | %.3f |\n", e->n_ranks, e->seconds, e->efficiency,
           e->seconds * e->n_ranks / 3600.0, loss_names[limit], e->lost_s[limit]);
  }
}

static void report_estimate(cli_json *json, const char *key, const cli_rank_estimate *e) {
  cli_json_object(json, key);
  cli_json_count(json, "ranks", (uint64_t)e->n_ranks);
  cli_json_number(json, "seconds", e->seconds);
  cli_json_number(json, "efficiency", e->efficiency);
  cli_json_number(json, "rank_hours", e->seconds * e->n_ranks / 3600.0);
  cli_json_text(json, "limit", loss_names[limit_of(e)]);
  cli_json_object(json, "lost_seconds");
  for (int i = 0; i < CLI_RANK_N_LOSSES; i++)
    cli_json_number(json, loss_names[i], e->lost_s[i]);
  cli_json_close(json);
  cli_json_close(json);
}

static int report_estimates(cli_session *session, const simulate_job *job) {
  int exit_code = CLI_DONE;
  cli_json_file *file;
  cli_json *json = cli_json_open(session, &file, &exit_code);
  if (!json)
    return exit_code;
  cli_json_count(json, "units", job->trace.n_units);
  cli_json_count(json, "times", job->times);
  cli_json_object(json, "traced");
  cli_json_count(json, "ranks", (uint64_t)job->trace.n_ranks);
  cli_json_number(json, "seconds", job->trace.seconds);
  cli_json_close(json);
  report_estimate(json, "modelled", &job->same);
  cli_json_array(json, "estimates");
  for (int i = 0; i < job->n; i++)
    report_estimate(json, NULL, &job->estimates[i]);
  cli_json_close(json);
  return cli_json_finish(file);
}

static conic_status estimate_all(cli_session *session, simulate_job *job) {
  const cli_rank_line line = {1e-6 * job->latency_us, 1e9 * job->gigabytes_per_s};
  conic_context *context = session->context;
  conic_status status = cli_rank_schedule(context, &job->trace, &line, job->trace.n_ranks, 1, &job->same);
  for (int i = 0; i < job->n && status == CONIC_OK; i++)
    status = cli_rank_schedule(context, &job->trace, &line, job->n_ranks[i], job->times, &job->estimates[i]);
  return status;
}

static int simulate(cli_session *session, const char *path, simulate_job *job) {
  int exit_code = cli_session_open(session);
  if (exit_code != CLI_DONE)
    return exit_code;
  conic_status status = cli_rank_trace_read(session->context, path, job->is_by_processor, &job->trace);
  if (status == CONIC_OK)
    status = estimate_all(session, job);
  if (status == CONIC_OK && job->picture_path)
    status = cli_rank_trace_draw(session->context, &job->trace, job->picture_path);
  int prints = !session->is_quiet && !(session->json_path && session->json_path[0] == '-' && !session->json_path[1]);
  if (status == CONIC_OK && prints)
    print_estimates(job);
  exit_code = status == CONIC_OK ? report_estimates(session, job) : cli_exit_of(status);
  cli_rank_trace_release(session->context, &job->trace);
  return exit_code;
}

static int run(cli_session *session, int argc, char **argv) {
  simulate_job job = {.latency_us = 2.0, .gigabytes_per_s = 10.0, .times = 1};
  const char *inputs[64];
  int n_inputs;
  const cli_option options[] = {
      {"ranks", CLI_PARSED, &job, "LIST", "numbers of ranks [1,2,4 … 1024]", .parse = parse_ranks},
      {"latency", CLI_NUMBER, &job.latency_us, "US", "of a message, in microseconds [2]", 0, 1e6},
      {"bandwidth", CLI_NUMBER, &job.gigabytes_per_s, "GB/S", "into one rank [10]", 1e-3, 1e6},
      {"times", CLI_COUNT, &job.times, "N", "a job of N times as many units as the trace has [1]", 1, 1e6},
      {"processor", CLI_FLAG, &job.is_by_processor, NULL,
       "count what ranks of one thread worked, not the clock's time: of a trace from busy cores"},
      {"svg", CLI_TEXT, &job.picture_path, "OUT.svg", "what each rank did when, by the trace, as a picture"},
  };
  if (argc > 64)
    return cli_usage("simulate: one trace at a time");
  parse_ranks("1,2,4,8,16,32,64,128,256,512,1024", &job);
  int exit_code = cli_parse(session, options, sizeof options / sizeof *options, argc, argv, inputs, &n_inputs);
  if (exit_code == CLI_DONE && n_inputs != 1)
    exit_code = cli_usage("simulate: %s; see conic help simulate", n_inputs ? "one trace at a time" : "no trace given");
  if (exit_code == CLI_DONE)
    exit_code = cli_check_outputs(session, (const char *const[]){job.picture_path}, 1);
  if (exit_code == CLI_DONE)
    exit_code = simulate(session, inputs[0], &job);
  return exit_code < 0 ? CLI_DONE : exit_code;
}

const cli_command cli_simulate = {
    .name = "simulate",
    .summary = "says what a job of conic-mpi would take on more ranks",
    .usage = "conic simulate TRACE.json [options]",
    .run = run,
    .description = "Reads what conic-mpi wrote by --trace, and says for each number of ranks when the job would be "
                   "done, and what would lose the most time: opening what each rank opens, waiting for the first rank, "
                   "ranks without work at the end, merging sums, or writing. Of building a layered cloud, what merges "
                   "is the exchange of samples and the top of the tree; of mls, prepare and octree, what each rank "
                   "does itself counts as opening, and what merges is what comes of shared loops.",
    .examples = {{"on up to 1024 ranks", "conic simulate trace.json"},
                 {"the same for a picture of 100 times as many windows, on a slow network",
                  "conic simulate trace.json --times 100 --bandwidth 1 --latency 50"}},
};
