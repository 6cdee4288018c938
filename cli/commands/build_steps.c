#include "cli/commands/build_steps.h"

#include "cli/outputs.h"
#include "cli/points/points_input.h"
#include "core/base/team_runs.h"
#include "core/formats/model_read.h"
#include "source/reach.h"

int cli_build_check(const cli_build *build, const char *const *inputs, int n_inputs, const char *ending) {
  int exit_code = cli_check_ending(build->output, ending);
  for (int i = 0; i < n_inputs && exit_code == CLI_DONE && cli_team_is_shared(build->session); i++)
    if (strcmp(inputs[i], "-") == 0)
      exit_code = cli_usage("%s: several processes cannot share standard input; give files", build->session->command);
  if (exit_code == CLI_DONE)
    exit_code = cli_check_outputs(build->session, &build->output, 1);
  return exit_code == CLI_DONE
             ? cli_check_inputs_stay(build->session, inputs, n_inputs, &build->output, !build->is_in_place)
             : exit_code;
}

void cli_build_share(cli_build *build) {
  build->is_shared = cli_team_is_shared(build->session);
  conic_context_join(build->session->context, cli_team_of(build->session));
}

conic_status cli_build_part(cli_build *build, conic_status status) {
  status = conic_context_part(build->session->context, status);
  cli_team_exit(build->session, status); /* messages of a failure appear now */
  return status;
}

int cli_build_take_paths(cli_build *build, const char *input, const char *ending) {
  const char *command = build->session->command;
  build->input = input;
  if (build->is_in_place && build->output)
    return cli_usage("%s: --in-place writes over the input, and -o elsewhere; give one of both", command);
  if (build->is_in_place && strcmp(input, "-") == 0)
    return cli_usage("%s: --in-place needs a file, and not standard input", command);
  if (build->is_in_place)
    build->output = build->session->replaced_path = input;
  if (!build->output)
    return cli_usage("%s: no output given (-o OUT.%s)", command, ending);
  return CLI_DONE;
}

int cli_build_arguments(cli_build *build, const cli_option *options, int n_options, int argc, char **argv,
                        const char **positional, int *n_positional) {
  const char *values[n_options];
  int exit_code = cli_parse_noting(build->session, options, n_options, argc, argv, positional, n_positional, values);
  if (exit_code == CLI_DONE)
    cli_effects_note(&build->effects, options, n_options, values);
  return exit_code;
}

void cli_build_reading(const cli_build *build, conic_read_options *options) {
  conic_read_options_init(options);
  options->columns = build->columns;
  options->where = build->where;
  options->colors_are = build->colors_are;
}

conic_status cli_build_know(cli_build *build, cli_facts possible) {
  build->effects.possible = possible | (conic_layers_is_url(build->input) ? CLI_FACT(URL) : 0);
  int answer = cli_effects_check_given(build->session, &build->effects, build->input, NULL);
  return answer == CLI_DONE ? CONIC_OK : CONIC_ERROR_ARGUMENT;
}

cli_facts cli_build_facts(const conic_model *model) {
  const int is_raw = !model->points.tangent_u[0] && !model->n_triangles;
  return CLI_FACT(SPLATS) | CLI_FACT(VALUED) | (is_raw ? CLI_FACT(RAW) : 0) |
         (model->n_triangles ? CLI_FACT(FACES) : 0) | (model->kind == CONIC_MODEL_XYZ ? CLI_FACT(TEXT) : 0) |
         (conic_model_has_fractions(model) ? CLI_FACT(FRACTIONS) : 0);
}

/* Only the whole file tells: it is read once more where --colors is given. */
static int may_have_fractions(const cli_build *build, const char *path) {
  conic_read_options options;
  conic_model model;
  if (!build->colors_are || strcmp(path, "-") == 0)
    return 1;
  cli_build_reading(build, &options);
  options.where = NULL;
  if (cli_points_are_hierarchy(path) || conic_layers_is_file(path))
    return 0;
  if (conic_model_read(build->session->context, path, &options, &model) != CONIC_OK)
    return 1; /* reading it is to say more */
  const int has = conic_model_has_fractions(&model);
  conic_model_release(build->session->context, &model);
  return has;
}

cli_facts cli_build_facts_of_file(const cli_build *build, const char *path) {
  const int may_be_text = !build->columns || cli_points_may_be_text(build->session->context, path);
  return CLI_SOURCE_FACTS & ~((conic_layers_is_url(path) ? 0 : CLI_FACT(URL)) | (may_be_text ? 0 : CLI_FACT(TEXT)) |
                              (may_have_fractions(build, path) ? 0 : CLI_FACT(FRACTIONS)));
}

int cli_build_parse(cli_build *build, const cli_option *options, int n_options, int argc, char **argv,
                    const char *ending) {
  const char *positional[argc], *command = build->session->command;
  int n_positional;
  int exit_code = cli_build_arguments(build, options, n_options, argc, argv, positional, &n_positional);
  if (exit_code != CLI_DONE)
    return exit_code;
  if (n_positional != 1)
    return cli_usage("%s: %s; see conic help %s", command, n_positional ? "one input at a time" : "no input given",
                     command);
  exit_code = cli_build_take_paths(build, positional[0], ending);
  return exit_code == CLI_DONE ? cli_build_check(build, &build->input, 1, ending) : exit_code;
}

conic_status cli_build_leave_far(const cli_build *build, conic_splats *points) {
  double low[3], high[3];
  return conic_leave_far_points(build->session->context, build->input, points, low, high);
}

void cli_build_hint_faces(const cli_build *build, const conic_model *model) {
  if (model->n_triangles)
    cli_warn(build->session,
             "%s: the vertices become splats, and its %zu faces are left out; conic render --as mesh and conic hybrid "
             "draw faces",
             build->input, model->n_triangles);
}

static int count_stages(const cli_build *build) {
  int n = 0;
  while (n < (int)(sizeof build->stages / sizeof *build->stages) && build->stages[n].name)
    n++;
  return n;
}

static int write_report(cli_build *build, const cli_build_steps *steps) {
  cli_json *json;
  int exit_code = cli_json_open(build->session, &json);
  if (!json)
    return exit_code;
  steps->report(json, build);
  cli_team_report_write(json, "points", &build->team);
  return cli_json_finish(json);
}

/* Agrees on all processes' exit code. Only the first process reports anything afterwards. */
static int agree_on_build(cli_build *build, conic_moment start, int exit_code) {
  if (!build->is_shared)
    return exit_code;
  cli_team_trace(build->session, "build", build->session->command, 0, start, 0);
  exit_code = cli_team_agree(build->session, exit_code);
  if (exit_code == CLI_DONE)
    cli_team_report_gather(build->session, cli_team_stages(), &build->team);
  return exit_code;
}

int cli_build_run(void *job, const cli_build_steps *steps, int parsed) {
  cli_build *build = job;
  conic_moment start = conic_moment_now();
  if (parsed != CLI_DONE)
    return parsed < 0 ? CLI_DONE : parsed;
  int exit_code = cli_session_open(build->session);
  if (exit_code != CLI_DONE)
    return exit_code;
  exit_code = agree_on_build(build, start, steps->make(job));
  build->total_seconds = cli_seconds() - start.clock_s;
  if (exit_code == CLI_DONE && cli_session_speaks(build->session)) {
    steps->tell(job);
    cli_tell_run(build->session, build->stages, count_stages(build), build->total_seconds);
    exit_code = write_report(build, steps);
  }
  if (steps->release)
    steps->release(job);
  cli_team_report_release(&build->team);
  return exit_code;
}

double cli_build_end_stage(cli_stage *stage, double start) {
  double now = cli_seconds();
  stage->seconds = now - start;
  return now;
}

void cli_build_report_cost(cli_json *json, const cli_build *build, const char *rate_key, double rate) {
  cli_json_object(json, "seconds");
  for (int i = 0; i < count_stages(build); i++) {
    const cli_stage *stage = &build->stages[i];
    cli_json_number(json, stage->key ? stage->key : stage->name, stage->seconds > 0.0 ? stage->seconds : 0.0);
  }
  cli_json_number(json, "other", cli_other_seconds(build->stages, count_stages(build), build->total_seconds));
  cli_json_number(json, "total", build->total_seconds);
  cli_json_close(json);
  cli_json_number(json, rate_key, rate);
  cli_json_count(json, "peak_rss_bytes", cli_peak_rss_bytes());
}
