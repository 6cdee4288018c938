/* An earlier run of `conic bench`, beside this one: ratios, and where noise may have made them. */

#include "bench/bench.h"
#include "core/files/json_read.h"

static void read_ms(conic_json *json, double old_ms[CLI_BENCH_N_STAGES + 1]) {
  char key[CONIC_JSON_KEY_ROOM];
  conic_json_begin_object(json);
  while (conic_json_next_member(json, key)) {
    int i = 0;
    while (i < CLI_BENCH_N_STAGES && strcmp(key, cli_bench_stages[i]) != 0)
      i++;
    if (i < CLI_BENCH_N_STAGES || strcmp(key, "frame") == 0)
      conic_json_number(json, &old_ms[i]);
    else
      conic_json_skip(json);
  }
}

static void read_line(conic_json *json, cli_bench_line *line) {
  char key[CONIC_JSON_KEY_ROOM];
  size_t n;
  conic_json_begin_object(json);
  while (conic_json_next_member(json, key))
    if (strcmp(key, "ms") == 0)
      read_ms(json, line->old_ms);
    else if (strcmp(key, "ms_quartiles") == 0)
      conic_json_numbers(json, line->old_quartile_ms, 2, &n);
    else
      conic_json_skip(json);
}

static void read_lines(conic_json *json, cli_bench_line *lines, int n_lines) {
  char key[CONIC_JSON_KEY_ROOM];
  conic_json_begin_object(json);
  while (conic_json_next_member(json, key)) {
    int i = 0;
    while (i < n_lines && strcmp(key, lines[i].name) != 0)
      i++;
    if (i < n_lines)
      read_line(json, &lines[i]);
    else
      conic_json_skip(json);
  }
}

conic_status cli_bench_read_old(cli_session *session, const char *path, cli_bench_line *lines, int n_lines) {
  conic_json json;
  char key[CONIC_JSON_KEY_ROOM];
  int has_lines = 0;
  conic_status status = conic_json_open(session->context, path, &json);
  if (status != CONIC_OK)
    return status;
  conic_json_begin_object(&json);
  while (conic_json_next_member(&json, key))
    if (strcmp(key, "lines") == 0) {
      read_lines(&json, lines, n_lines);
      has_lines = 1;
    } else
      conic_json_skip(&json);
  conic_json_end(&json);
  if (!has_lines)
    conic_json_wrong(&json, "no \"lines\": this is not what conic bench writes");
  status = json.status;
  conic_json_close(&json);
  return status;
}

/* Whether the middle halves of both runs' frames, widened by 2 %, have times in common. */
static int may_be_noise(const cli_bench_line *line) {
  return line->quartile_ms[0] <= 1.02 * line->old_quartile_ms[1] &&
         line->old_quartile_ms[0] <= 1.02 * line->quartile_ms[1];
}

void cli_bench_print_comparison(const char *path, const cli_bench_line *lines, int n_lines) {
  int n_new = 0;
  printf("\ntimes as fast as %s\n%-34s %8s %8s %7s  %7s %6s %7s %7s %7s\n", path, "scene/method/isa/threads", "old ms",
         "new ms", "frame", "setup", "bin", "visib.", "accum.", "resolve");
  for (int i = 0; i < n_lines; i++) {
    const cli_bench_line *line = &lines[i];
    const conic_render_milliseconds *ms = &line->statistics.ms;
    const double *old_ms = line->old_ms;
    n_new += isnan(old_ms[CLI_BENCH_N_STAGES]);
    if (isnan(old_ms[CLI_BENCH_N_STAGES]))
      continue;
    printf("%-34s %8.2f %8.2f %7.2f  %7.2f %6.2f %7.2f %7.2f %7.2f%s\n", line->name, old_ms[CLI_BENCH_N_STAGES],
           ms->frame, old_ms[CLI_BENCH_N_STAGES] / ms->frame, old_ms[0] / ms->setup, old_ms[1] / ms->bin,
           old_ms[2] / ms->visibility, old_ms[3] / ms->accumulate, old_ms[4] / ms->resolve,
           may_be_noise(line) ? "  as fast, within the noise" : "");
  }
  if (n_new)
    printf("%d line%s not in it\n", n_new, n_new == 1 ? " is" : "s are");
}
