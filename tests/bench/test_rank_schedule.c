/* Jobs on more ranks: traces, and what the model makes of them where it can be told without it. */
#include "bench/rank_schedule.h"
#include "tests/support/check.h"

static const char *const path = "trace.json";

static void write_trace(const char *text) {
  FILE *file = fopen(path, "wb");
  CHECK(file && fputs(text, file) >= 0 && fclose(file) == 0);
}

static conic_status read_trace(conic_context *context, const char *text, cli_rank_trace *trace) {
  write_trace(text);
  return cli_rank_trace_read(context, path, 0, trace);
}

/* Two ranks, three units, one merging. */
static void test_rank_trace(conic_context *context) {
  cli_rank_trace trace;
  CHECK_OK(read_trace(
      context,
      "{\"displayTimeUnit\": \"ms\", \"traceEvents\": ["
      "{\"name\": \"scene 0\", \"cat\": \"open\", \"ph\": \"X\", \"ts\": 1e6, \"dur\": 2e6, \"pid\": 0, \"tid\": 0},"
      "{\"name\": \"scene 0\", \"cat\": \"open\", \"ts\": 1e6, \"dur\": 1e6, \"pid\": 1},"
      "{\"name\": \"samples 0\", \"cat\": \"unit\", \"ts\": 3e6, \"dur\": 5e5, \"pid\": 0, \"args\": {\"sent_bytes\": "
      "7}},"
      "{\"name\": \"samples 1\", \"cat\": \"unit\", \"ts\": 2e6, \"dur\": 4e6, \"pid\": 1, \"args\": {\"sent_bytes\": "
      "0}},"
      "{\"name\": \"samples 2\", \"cat\": \"unit\", \"ts\": 4e6, \"dur\": 25e4, \"pid\": 0},"
      "{\"name\": \"swap 0\", \"cat\": \"join\", \"ts\": 6e6, \"dur\": 5e6, \"pid\": 1, \"args\": {\"sent_bytes\": "
      "100}},"
      "{\"name\": \"swap 0\", \"cat\": \"join\", \"ts\": 6e6, \"dur\": 5e6, \"pid\": 0, \"args\": {\"sent_bytes\": "
      "100}},"
      "{\"name\": \"parts 0\", \"cat\": \"join\", \"ts\": 6e6, \"dur\": 5e6, \"pid\": 0},"
      "{\"name\": \"sums 1\", \"cat\": \"join\", \"ts\": 6e6, \"dur\": 3e6, \"pid\": 0},"
      "{\"name\": \"OUT\", \"cat\": \"write\", \"ts\": 9e6, \"dur\": 2e6, \"pid\": 0}]}",
      &trace));
  CHECK(trace.n_ranks == 2 && trace.n_units == 3 && trace.seconds == 10.0 && trace.open_s == 1.5);
  CHECK(trace.units[0].seconds == 4.0 && trace.units[1].bytes == 7.0 && trace.units[2].seconds == 0.25);
  CHECK(trace.merge_s == 3.0 && trace.merge_bytes == 200.0 && trace.n_merges == 1.0 && trace.write_s == 2.0 &&
        trace.join_s == 0.0);
  cli_rank_trace_release(context, &trace);
}

/* Of two ranks that built a cloud: what they waited is no work. */
static cli_rank_trace build_trace(conic_context *context) {
  cli_rank_trace trace;
  CHECK_OK(read_trace(context,
                      "{\"traceEvents\": ["
                      "{\"name\": \"inputs 0\", \"cat\": \"open\", \"ts\": 0, \"dur\": 1e5, \"pid\": 0},"
                      "{\"name\": \"read 0\", \"cat\": \"stage\", \"ts\": 1e5, \"dur\": 5e6, \"pid\": 0},"
                      "{\"name\": \"read 0\", \"cat\": \"stage\", \"ts\": 1e5, \"dur\": 7e6, \"pid\": 1},"
                      "{\"name\": \"read 0\", \"cat\": \"wait\", \"ts\": 1e5, \"dur\": 2e6, \"pid\": 1},"
                      "{\"name\": \"exchange 1000000\", \"cat\": \"stage\", \"ts\": 7e6, \"dur\": 1e6, \"pid\": 0, "
                      "\"args\": {\"sent_bytes\": 8e6}},"
                      "{\"name\": \"exchange 1000000\", \"cat\": \"stage\", \"ts\": 7e6, \"dur\": 1e6, \"pid\": 1, "
                      "\"args\": {\"sent_bytes\": 8e6}},"
                      "{\"name\": \"grow 1000000\", \"cat\": \"stage\", \"ts\": 8e6, \"dur\": 40e6, \"pid\": 0},"
                      "{\"name\": \"grow 1000000\", \"cat\": \"stage\", \"ts\": 8e6, \"dur\": 40e6, \"pid\": 1},"
                      "{\"name\": \"order 2000\", \"cat\": \"stage\", \"ts\": 48e6, \"dur\": 5e5, \"pid\": 0}]}",
                      &trace));
  return trace;
}

static void test_rank_build(conic_context *context) {
  const cli_rank_line line = {1e-6, 1e9}, slow = {1e-3, 1e6};
  cli_rank_trace trace = build_trace(context);
  cli_rank_estimate alone, few, many, late;
  CHECK(trace.job == CLI_RANK_LAYERS && trace.n_units == 2 && trace.n_ranks == 2);
  CHECK(trace.stages[CLI_STAGE_READ].seconds == 10.0 && trace.stages[CLI_STAGE_GROW].number == 2e6);
  CHECK_OK(cli_rank_schedule(context, &trace, &line, 1, 1, &alone));
  CHECK(fabs(alone.seconds - 90.55) < 0.01 && alone.efficiency == 1.0); /* without an exchange */
  CHECK_OK(cli_rank_schedule(context, &trace, &line, 16, 1, &few));
  CHECK(few.seconds > 92.0 / 16.0 + 0.55 && few.seconds < 92.0 / 16.0 + 1.2 && few.efficiency > 0.8);
  CHECK_OK(cli_rank_schedule(context, &trace, &line, 1024, 1, &many));
  CHECK(many.efficiency < few.efficiency && many.lost_s[CLI_RANK_FIRST] == 0.5);
  CHECK_OK(cli_rank_schedule(context, &trace, &slow, 16, 1, &late));
  CHECK(late.lost_s[CLI_RANK_MERGE] > few.lost_s[CLI_RANK_MERGE] + 1.0);
  CHECK_OK(cli_rank_schedule(context, &trace, &line, 16, 10, &late));
  CHECK(fabs(late.lost_s[CLI_RANK_FIRST] - 5.0) < 1e-9 && late.seconds > 9.0 * few.seconds);
  cli_rank_trace_release(context, &trace);
}

/* Two ranks that do the same for a second, and share loops of 3 s each, of which one waits for a half. */
static void test_rank_loops(conic_context *context) {
  const cli_rank_line line = {1e-6, 1e9}, slow = {1e-6, 1e6};
  cli_rank_trace trace;
  cli_rank_estimate alone, same, many, late;
  CHECK_OK(read_trace(context,
                      "{\"traceEvents\": ["
                      "{\"name\": \"measure 9\", \"cat\": \"stage\", \"ts\": 1e6, \"dur\": 3e6, \"pid\": 0, "
                      "\"args\": {\"sent_bytes\": 2e6}},"
                      "{\"name\": \"measure 9\", \"cat\": \"stage\", \"ts\": 1e6, \"dur\": 3e6, \"pid\": 1, "
                      "\"args\": {\"sent_bytes\": 1e6}},"
                      "{\"name\": \"measure 9\", \"cat\": \"wait\", \"ts\": 35e5, \"dur\": 5e5, \"pid\": 1},"
                      "{\"name\": \"prepare 0\", \"cat\": \"build\", \"ts\": 0, \"dur\": 35e5, \"pid\": 1},"
                      "{\"name\": \"prepare 0\", \"cat\": \"build\", \"ts\": 0, \"dur\": 4e6, \"pid\": 0}]}",
                      &trace));
  CHECK(trace.job == CLI_RANK_LOOPS && trace.n_units == 2 && trace.n_events == 5 && trace.seconds == 4.0);
  CHECK(trace.alone_s == 1.0 && trace.loops.seconds == 5.5);
  CHECK_OK(cli_rank_schedule(context, &trace, &line, 1, 1, &alone));
  CHECK(alone.seconds == 6.5 && alone.efficiency == 1.0);
  CHECK_OK(cli_rank_schedule(context, &trace, &line, 2, 1, &same));
  CHECK(fabs(same.seconds - (1.0 + 2.75 + 3e-3)) < 1e-4); /* 2 MB, of which half comes to rank 0 first */
  CHECK_OK(cli_rank_schedule(context, &trace, &line, 64, 10, &many));
  CHECK(many.lost_s[CLI_RANK_OPEN] == 10.0 && fabs(many.seconds - (10.0 + 55.0 / 64.0)) < 0.05);
  CHECK_OK(cli_rank_schedule(context, &trace, &slow, 2, 1, &late));
  CHECK(fabs(late.lost_s[CLI_RANK_MERGE] - 3.0) < 1e-3);
  cli_rank_trace_release(context, &trace);
}

/* A picture whose light the ranks share is no building; its light is shared like its windows. */
static void test_rank_light(conic_context *context) {
  const cli_rank_line line = {0.0, 1e12};
  cli_rank_trace trace;
  cli_rank_estimate e;
  CHECK_OK(read_trace(context,
                      "{\"traceEvents\": ["
                      "{\"name\": \"direction 9\", \"cat\": \"stage\", \"ts\": 0, \"dur\": 3e6, \"pid\": 0},"
                      "{\"name\": \"read 9\", \"cat\": \"stage\", \"ts\": 0, \"dur\": 3e6, \"pid\": 1},"
                      "{\"name\": \"window 0\", \"cat\": \"unit\", \"ts\": 3e6, \"dur\": 1e6, \"pid\": 0},"
                      "{\"name\": \"window 1\", \"cat\": \"unit\", \"ts\": 3e6, \"dur\": 1e6, \"pid\": 1}]}",
                      &trace));
  CHECK(trace.job == CLI_RANK_UNITS && trace.n_units == 2 && trace.units[1].seconds == 1.0);
  CHECK_OK(cli_rank_schedule(context, &trace, &line, 2, 1, &e));
  CHECK(fabs(e.seconds - 4.0) < 1e-4);
  cli_rank_trace_release(context, &trace);
}

/* A rank that was kept from its core: what it worked is all that counts, and what it waited is no work. */
static void test_processor_time(conic_context *context) {
  cli_rank_trace trace;
  write_trace("{\"traceEvents\": ["
              "{\"name\": \"scene 0\", \"cat\": \"open\", \"ts\": 0, \"dur\": 4e6, \"tdur\": 1e6, \"pid\": 0},"
              "{\"name\": \"read 9\", \"cat\": \"stage\", \"ts\": 4e6, \"dur\": 3e6, \"tdur\": 1e6, \"pid\": 0},"
              "{\"name\": \"read 9\", \"cat\": \"wait\", \"ts\": 5e6, \"dur\": 2e6, \"tdur\": 0, \"pid\": 0},"
              "{\"name\": \"window 0\", \"cat\": \"unit\", \"ts\": 7e6, \"dur\": 9e6, \"tdur\": 2e6, \"pid\": 0}]}");
  CHECK_OK(cli_rank_trace_read(context, path, 1, &trace));
  CHECK(trace.seconds == 16.0 && trace.open_s == 1.0 && trace.loops.seconds == 1.0 && trace.units[0].seconds == 2.0);
  cli_rank_trace_release(context, &trace);
  CHECK_OK(cli_rank_trace_read(context, path, 0, &trace));
  CHECK(trace.open_s == 4.0 && trace.units[0].seconds == 9.0);
  cli_rank_trace_release(context, &trace);
  write_trace(
      "{\"traceEvents\": [{\"name\": \"window 0\", \"cat\": \"unit\", \"ts\": 7e6, \"dur\": 9e6, \"pid\": 0}]}");
  CHECK(cli_rank_trace_read(context, path, 1, &trace) == CONIC_ERROR_INPUT && !trace.units);
}

static void test_wrong_traces(conic_context *context) {
  static const char *const wrong[] = {"",
                                      "[]",
                                      "{}",
                                      "{\"traceEvents\": []}",
                                      "{\"traceEvents\": [{\"cat\": \"open\", \"dur\": 1}]}",
                                      "{\"traceEvents\": [{\"cat\": \"unit\", \"dur\": -1}]}",
                                      "{\"traceEvents\": [{\"cat\": \"unit\", \"pid\": 1e9}]}",
                                      "{\"traceEvents\": [{\"cat\": \"unit\", \"dur\": 1}"};
  for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
    cli_rank_trace trace;
    CHECK(read_trace(context, wrong[i], &trace) == CONIC_ERROR_INPUT && !trace.units);
  }
}

/* 96 units of a second each, of so many bytes. */
static cli_rank_trace even_trace(conic_context *context, double bytes) {
  cli_rank_trace trace = {.n_ranks = 1, .n_units = 96};
  trace.units = calloc(trace.n_units, sizeof *trace.units);
  CHECK(trace.units != NULL);
  for (size_t i = 0; i < trace.n_units; i++)
    trace.units[i] = (cli_rank_unit){1.0, bytes};
  (void)context;
  return trace;
}

static cli_rank_estimate estimate(conic_context *context, const cli_rank_trace *trace, int n_ranks, uint64_t times) {
  const cli_rank_line line = {1e-6, 1e9};
  cli_rank_estimate e;
  CHECK_OK(cli_rank_schedule(context, trace, &line, n_ranks, times, &e));
  CHECK(e.n_ranks == n_ranks && e.efficiency <= 1.0);
  return e;
}

static void check_near(double got, double wanted, double off) {
  if (!(fabs(got - wanted) <= off))
    fprintf(stderr, "%g instead of %g\n", got, wanted);
  CHECK(fabs(got - wanted) <= off);
}

static void test_rank_schedule(conic_context *context) {
  cli_rank_trace light = even_trace(context, 0.0), heavy = even_trace(context, 2e8);
  check_near(estimate(context, &light, 1, 1).seconds, 96.0, 1e-3);
  check_near(estimate(context, &light, 32, 1).seconds, 3.0, 1e-3);
  check_near(estimate(context, &light, 64, 1).seconds, 2.0, 1e-3); /* half of the ranks have one unit, the others two */
  check_near(estimate(context, &light, 64, 1).lost_s[CLI_RANK_UNEVEN], 0.5, 1e-3);
  check_near(estimate(context, &light, 64, 10).seconds, 15.0, 1e-3);
  /* Rank 0 takes a fifth of a second for each result of others, which go on meanwhile: five keep it busy. */
  check_near(estimate(context, &heavy, 1, 1).seconds, 96.0, 1e-3);
  check_near(estimate(context, &heavy, 2, 1).seconds, 96.0 / 1.8, 1.0);
  check_near(estimate(context, &heavy, 3, 1).seconds, 96.0 / 2.6, 1.5);         /* and the last ten to others */
  check_near(estimate(context, &heavy, 12, 8).seconds, 1.0 + 768.0 * 0.2, 0.8); /* it leaves all to the others, */
  CHECK(estimate(context, &heavy, 12, 8).lost_s[CLI_RANK_FIRST] > 80.0);        /* which wait for it */
  check_near(estimate(context, &heavy, 96, 1).seconds, 1.0 + 96.0 * 0.2, 1e-2); /* rank 0 has none of its own */
  CHECK(estimate(context, &heavy, 96, 1).lost_s[CLI_RANK_UNEVEN] > 17.0);
  for (size_t i = 0; i < 96; i++)
    heavy.units[i] = i < 80 ? (cli_rank_unit){1.0, 5e7} : (cli_rank_unit){0.05, 1e6};
  CHECK(estimate(context, &heavy, 16, 1).seconds < 6.5); /* 7 s if rank 0 went on as long as there are units */
  for (size_t i = 0; i < 96; i++)
    heavy.units[i] = (cli_rank_unit){1.0, i < 95 ? 0.0 : 2e8};
  heavy.join_s = 9.6;
  check_near(estimate(context, &heavy, 1, 1).seconds, 96.0 + 9.6, 1e-3);
  check_near(estimate(context, &heavy, 2, 1).seconds, 48.0 + 9.6 + 0.2,
             0.1); /* joining takes as long as there are bytes */
  light.open_s = 4.0;
  light.write_s = 1.0;
  check_near(estimate(context, &light, 32, 1).seconds, 8.0, 1e-3);
  check_near(estimate(context, &light, 32, 10).seconds, 4.0 + 30.0 + 10.0, 1e-3);
  light.n_merges = 1.0;
  light.merge_s = 0.5;
  light.merge_bytes = 1e9;
  check_near(estimate(context, &light, 2, 1).seconds, 53.0 + 0.5 * 2.5, 1e-3);
  check_near(estimate(context, &light, 32, 1).seconds, 8.0 + 2.5 * 31.0 / 32.0, 2e-3); /* the bytes go twice */
  check_near(estimate(context, &light, 32, 10).seconds, 4.0 + 30.0 + 1.0 + 2.5 * 31.0 / 32.0, 2e-3);
  free(light.units);
  free(heavy.units);
}

int main(void) {
  conic_context *context = check_context(1);
  test_rank_trace(context);
  test_processor_time(context);
  test_wrong_traces(context);
  test_rank_schedule(context);
  test_rank_build(context);
  test_rank_loops(context);
  test_rank_light(context);
  conic_context_destroy(context);
  remove(path);
  return check_result();
}
