/* conic layer: makes a layered point cloud from any number of samples. */

#include "cli/layer/layer_job.h"
#include "cli/points/points_input.h"
#include "lod/layers/build/layers_team.h"

static const char *const payload_words[] = {"plain", "full", "gaussians", NULL};

static void report_finished_samples(cli_json *json, const cli_layer_job *job) {
  if (job->is_resumable || job->resume_path)
    cli_json_count(json, "samples_finished", job->n_finished);
}

static void report_layers(cli_json *json, const void *cookie) {
  const cli_layer_job *job = cookie;
  const conic_layers_statistics *s = &job->statistics;
  const conic_repairs repairs = {.nan = (size_t)s->n_nan, .zero = (size_t)s->n_zero};
  if (job->payload == CLI_LAYER_GAUSSIANS) {
    cli_layer_report_gaussians(json, job);
    return;
  }
  cli_json_counts(json, NULL, {"points_in", s->n_in}, {"points_out", s->n_samples});
  report_finished_samples(json, job);
  cli_json_counts(json, NULL, {"clouds", s->n_clouds}, {"levels", (uint64_t)s->n_levels}, {"bytes", s->n_bytes});
  cli_json_figures(json, NULL, {"bits_per_sample", 8.0 * (double)s->n_bytes / (double)s->n_samples},
                   {"spacing", s->spacing}, {"quantum", s->quantum});
  cli_color_report(json, &job->coloring.done);
  cli_build_report_cost(json, &job->base, "points_per_s", (double)s->n_in / job->base.total_seconds);
  cli_json_skipped(json, &repairs);
  cli_team_report_write(json, "points", &job->team);
}

static void tell_layers(const void *cookie) {
  const cli_layer_job *job = cookie;
  const conic_layers_statistics *s = &job->statistics;
  if (job->payload == CLI_LAYER_GAUSSIANS) {
    cli_layer_tell_gaussians(job);
    return;
  }
  if (job->n_finished)
    cli_note(job->base.session, "%llu of %llu samples were in finished branches", (unsigned long long)job->n_finished,
             (unsigned long long)s->n_samples);
  conic_log(job->base.session->context, CONIC_LOG_INFO,
            "%s: %llu points in; %llu samples in %llu clouds and %d levels out, %.1f MiB; a sample every %.4g, in "
            "steps of %.4g",
            job->base.output, (unsigned long long)s->n_in, (unsigned long long)s->n_samples,
            (unsigned long long)s->n_clouds, s->n_levels, (double)s->n_bytes / 1048576.0, s->spacing, s->quantum);
  if (s->n_in > s->n_samples || s->n_zero)
    conic_log(job->base.session->context, CONIC_LOG_INFO,
              "%s: left out %llu points, %llu of them not finite or farther out than 1e15; %llu without a normal or "
              "size got one",
              job->base.output, (unsigned long long)(s->n_in - s->n_samples), (unsigned long long)s->n_nan,
              (unsigned long long)s->n_zero);
}

/* Finds what points up: by the options, by the files that are continued, or by the habit of surveys; else it is
 * unknown. */
static void settle_up(cli_layer_job *job) {
  static const double survey_up[3] = {0.0, 0.0, 1.0};
  if (job->coloring.is_up_given)
    memcpy(job->options.up, job->coloring.options.up, sizeof job->options.up);
  else if (job->n_continued == 0 && job->share.are_surveys)
    memcpy(job->options.up, survey_up, sizeof job->options.up);
}

/* The coordinate system that all inputs have. */
static conic_status settle_system(cli_layer_job *job) {
  conic_status status = CONIC_OK;
  int differs = 0;
  for (int i = job->n_continued; i < job->share.n_inputs && status == CONIC_OK; i++) {
    unsigned epsg;
    status = cli_points_find_epsg(job->base.session, job->share.inputs[i], 0, &epsg);
    differs |= i > 0 && epsg != job->options.epsg;
    job->options.epsg = i > 0 ? job->options.epsg : epsg;
  }
  if (differs)
    cli_warn(job->base.session, "%s: its inputs are not all of one coordinate system, and none is kept",
             job->base.output);
  if (differs)
    job->options.epsg = 0;
  return status;
}

/* Files that are continued come before the added ones, as inputs that are read differently. */
static conic_status list_layer_inputs(cli_layer_job *job) {
  cli_session *session = job->base.session;
  const char *all[job->n_inputs + 1];
  int n = 0;
  if (job->is_appending)
    all[n++] = job->base.output;
  memcpy(all + n, job->inputs, (size_t)job->n_inputs * sizeof *all);
  job->n_continued = job->is_merging ? job->n_inputs : n;
  return cli_points_share_list(session, all, n + job->n_inputs, job->n_continued, &job->share);
}

/* What any of the inputs may be. */
static conic_status know_layer_inputs(cli_layer_job *job) {
  cli_facts possible = 0;
  for (int i = job->n_continued; i < job->share.n_inputs; i++)
    possible |= cli_build_facts_of_file(&job->base, job->share.inputs[i]);
  job->base.input = job->share.inputs[job->n_continued];
  return job->is_merging ? CONIC_OK : cli_build_know(&job->base, possible);
}

/* Settles everything before samples come, the same in every process. */
static conic_status plan_layers(cli_layer_job *job, conic_read_options *options) {
  conic_moment start = conic_moment_now();
  conic_status status = list_layer_inputs(job);
  if (status == CONIC_OK)
    status = conic_team_agree(job->share.team, cli_layer_continue(job, job->share.inputs, job->n_continued));
  if (status != CONIC_OK)
    return status;
  status = know_layer_inputs(job);
  if (status != CONIC_OK)
    return status;
  settle_up(job);
  status = conic_team_agree(job->share.team, settle_system(job));
  if (status != CONIC_OK)
    return status;
  cli_layer_reading(job, options);
  options->where = job->base.where;
  status = cli_points_share_out(&job->share, options, cli_layer_most_whole(job));
  options->where = NULL; /* the range is that of all points */
  if (status == CONIC_OK && !job->is_merging)
    status = cli_coloring_find_range(&job->coloring, &job->share, options);
  cli_team_trace(job->base.session, "open", "inputs", 0, start, 0);
  return status;
}

static int make_layers(void *cookie) {
  cli_layer_job *job = cookie;
  cli_session *session = job->base.session;
  int answer = cli_layer_choose_payload(job);
  if (answer != CLI_DONE || job->payload == CLI_LAYER_GAUSSIANS)
    return answer == CLI_DONE ? cli_layer_make_gaussians(job) : answer;
  conic_read_options options;
  conic_status status = plan_layers(job, &options);
  char key[CONIC_SHA256_ROOM];
  const conic_layers_keeping keeping = {key, job->resume_path != NULL, job->is_resumable};
  int keeps = job->is_resumable || job->resume_path;
  if (status == CONIC_OK && keeps)
    status = cli_layer_make_key(job, key);
  if (status == CONIC_OK)
    status = conic_layers_builder_open_team(session->context, job->base.output, &job->options, job->share.team,
                                            keeps ? &keeping : NULL, &job->builder);
  if (status == CONIC_OK) {
    job->n_finished = conic_layers_builder_finished(job->builder);
    status = cli_layer_read_share(job, &options);
    if (status == CONIC_OK && !job->share.team) /* else others may have read them */
      status = cli_build_know(&job->base, job->base.effects.possible & ~((job->was_raw ? 0 : CLI_FACT(RAW)) |
                                                                         (job->has_values ? 0 : CLI_FACT(MEASURED))));
    if (status == CONIC_OK)
      status = conic_layers_builder_finish(job->builder, &job->statistics);
    else
      conic_layers_builder_abandon(job->builder);
  }
  job->base.stages[0].seconds = job->statistics.read_seconds;
  job->base.stages[1].seconds = job->statistics.work_seconds;
  job->base.stages[2].seconds = job->statistics.write_seconds;
  int exit_code = cli_team_exit(session, status);
  if (exit_code == CLI_DONE && job->share.team)
    cli_team_report_gather(session, (cli_team_work){job->n_pieces, job->busy_seconds}, &job->team);
  return exit_code;
}

static void release_layers(void *cookie) {
  cli_layer_job *job = cookie;
  if (job->continued)
    conic_memory_release(job->base.session->context, job->continued);
  cli_points_share_end(&job->share);
  cli_team_report_release(&job->team);
}

static int check_layer_arguments(cli_layer_job *job) {
  if (job->n_inputs == 0)
    return cli_usage("layer: no input given; see conic help layer");
  if (!job->base.output)
    return cli_usage("layer: no output given (-o OUT.lpc)");
  if (!(job->quantum.value > 0.0))
    return cli_usage("layer: --quantum must be above 0");
  if (job->is_appending && (job->is_quantum_given || job->payload == CLI_LAYER_FULL || job->keep))
    return cli_usage("layer: --append adds to a file as it was built: not with --quantum, --payload or --keep");
  if (job->is_appending)
    job->base.session->replaced_path = job->base.output;
  job->options.keeps_all = job->payload == CLI_LAYER_FULL;
  if (job->payload == CLI_LAYER_FULL && !job->is_quantum_given)
    job->quantum = (cli_length){1.0 / 4096.0, 1};
  job->options.cloud_size = (uint32_t)job->cloud_size;
  job->options.memory_bytes = (uint64_t)(job->memory_mib * 1048576.0);
  job->options.quantum = job->quantum.value;
  job->options.quantum_in_spacings = job->quantum.is_in_spacings;
  job->options.cutoff = job->estimate.cutoff = (float)job->cutoff;
  int answer = cli_coloring_check(job->base.session, &job->coloring);
  if (answer != CLI_DONE)
    return answer;
  answer = cli_layer_check_keeping(job);
  return answer == CLI_DONE ? cli_build_check(&job->base, job->inputs, job->n_inputs, "lpc") : answer;
}

static const cli_build_steps layer_steps = {make_layers, tell_layers, report_layers, release_layers};

static int run_layer(cli_session *session, int argc, char **argv) {
  cli_layer_job job = {.base = {session, .stages = {{"read"}, {"work"}, {"write"}}},
                       .cloud_size = 2048,
                       .memory_mib = 1024.0,
                       .cutoff = 1.5,
                       .payload = CLI_LAYER_BY_INPUT,
                       .quantum = {0.5, 1}};
  const char *positional[argc];
  conic_estimate_options_init(&job.estimate);
  job.estimate.finds_dots = 1;
  conic_layers_options_init(&job.options);
  cli_coloring_init(&job.coloring);
  job.coloring.keeps_up = 1;
  const cli_option options[] = {
      {"o", CLI_TEXT, &job.base.output, "OUT.lpc", "the file to write"},
      {"cloud-size", CLI_INT, &job.cloud_size, "M", "about how many samples a cloud has, 64 to 32768 [2048]", 64,
       32768},
      {"memory", CLI_NUMBER, &job.memory_mib, "MIB",
       "what building may take in memory; what does not fit goes to files beside the output [1024]", 16, 1e9,
       .acts.is_work = 1},
      {"quantum", CLI_PARSED, &job.quantum, "Q",
       "the steps that positions are rounded to: a length, also in spacings (2x) [0.5x; x/4096 with --payload full]",
       .parse = cli_parse_length, .is_given = &job.is_quantum_given},
      {"cutoff", CLI_NUMBER, &job.cutoff, "F", "the --cutoff of the pictures to come [1.5]", 0.25, 5},
      {"k", CLI_INT, &job.estimate.n_neighbours, "K",
       "neighbours that raw points' normals are estimated from, 6 to 64 [20]", 6, 64,
       .acts = {.on = CLI_FACT(RAW), .is_warned = 1}},
      {"payload", CLI_CHOICE, &job.payload, "WHAT",
       "what of a splat is kept: plain, its place, size, direction and colour, and that it is a dot; full, also "
       "ellipses, opacities and clip lines, and all of it finely; gaussians, of Gaussian scenes all, in levels of "
       "merged ones [gaussians of such scenes, else plain]",
       .choices = payload_words},
      {"keep", CLI_TEXT, &job.keep, "NAMES",
       "which values of the points are kept, for --color-by and --where: intensity,gps_time or all [none]",
       .acts = {.on = CLI_FACT(MEASURED), .is_warned = 1}},
      {"append", CLI_FLAG, &job.is_appending, NULL,
       "add to the OUT.lpc that there is; its samples stay where they are"},
      CLI_LAYER_KEEPING(job),
      CLI_WHERE(&job.base.where),
      CLI_READING(session, &job.base),
      CLI_WAITING(session),
      CLI_BUILD_COLOR_OPTIONS(&job.coloring, NULL),
  };
  int exit_code =
      cli_build_arguments(&job.base, options, sizeof options / sizeof *options, argc, argv, positional, &job.n_inputs);
  job.inputs = positional;
  return cli_build_run(&job, &layer_steps, exit_code == CLI_DONE ? check_layer_arguments(&job) : exit_code);
}

const cli_command cli_layer = {
    .name = "layer",
    .summary = "builds a layered point cloud: samples of any number, for pictures in bounded memory",
    .usage = "conic layer IN… -o OUT.lpc [--cloud-size M] [--memory MIB] [--quantum Q] [--payload WHAT] [--keep NAMES] "
             "[--append]",
    .run = run_layer,
    .description =
        "Writes the samples in small clouds, coarse ones first. conic render reads only those that a picture shows, "
        "from a file or from a web server. A folder stands for its files of points, in the order of their names.",
    .examples = {{"join scans that do not fit into memory", "conic layer scans/*.ply -o all.lpc --memory 4096"},
                 {"keep all that a survey says of its points", "conic layer survey.las -o survey.lpc --keep all"},
                 {"build a survey of thousands of tiles", "conic layer tiles -o survey.lpc"}},
    .is_shared = 1,
};

static int check_merge_arguments(cli_layer_job *job) {
  if (job->n_inputs < 2)
    return cli_usage("merge: two inputs or more are needed; see conic help merge");
  if (!job->base.output)
    return cli_usage("merge: no output given (-o OUT.lpc)");
  job->options.memory_bytes = (uint64_t)(job->memory_mib * 1048576.0);
  int answer = cli_layer_check_keeping(job);
  return answer == CLI_DONE ? cli_build_check(&job->base, job->inputs, job->n_inputs, "lpc") : answer;
}

static int run_merge(cli_session *session, int argc, char **argv) {
  cli_layer_job job = {
      .base = {session, .stages = {{"read"}, {"work"}, {"write"}}}, .memory_mib = 1024.0, .is_merging = 1};
  const char *positional[argc];
  conic_layers_options_init(&job.options);
  const cli_option options[] = {
      {"o", CLI_TEXT, &job.base.output, "OUT.lpc", "the file to write"},
      {"memory", CLI_NUMBER, &job.memory_mib, "MIB",
       "what building may take in memory; what does not fit goes to files beside the output [1024]", 16, 1e9,
       .acts.is_work = 1},
      CLI_LAYER_KEEPING(job),
      CLI_WAITING(session),
  };
  int exit_code =
      cli_parse(session, options, sizeof options / sizeof options[0], argc, argv, positional, &job.n_inputs);
  job.inputs = positional;
  return cli_build_run(&job, &layer_steps, exit_code == CLI_DONE ? check_merge_arguments(&job) : exit_code);
}

const cli_command cli_merge = {
    .name = "merge",
    .summary = "joins layered point clouds",
    .usage = "conic merge A.lpc B.lpc… -o OUT.lpc [--memory MIB]",
    .run = run_merge,
    .description =
        "Builds one file of the samples of all, in the order given. Those of the first stay exactly where they "
        "are; those of the others move by half a step of its grid at most.",
    .examples = {{"join two surveys", "conic merge west.lpc east.lpc -o all.lpc"}},
    .is_shared = 1,
};
