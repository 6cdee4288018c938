/* conic octree: makes a point-octree from splats, raw points or a mesh. */

#include "cli/commands/build_coloring.h"
#include "cli/points/points_input.h"
#include "core/splats/repairs_log.h"

typedef struct octree_job {
  cli_build base;
  conic_estimate_options estimate;
  cli_coloring coloring;
  conic_octree_options options;
  double cutoff;

  conic_octree *octree;
  conic_octree_info info;
  size_t n_in;
  conic_repairs repairs;
} octree_job;

enum { READ, ESTIMATE, WORK, WRITE };

static conic_status build_from_model(octree_job *job) {
  conic_context *context = job->base.session->context;
  cli_stage *stages = job->base.stages;
  conic_read_options read_options;
  conic_model model;
  cli_build_reading(&job->base, &read_options);
  read_options.cutoff = job->options.cutoff;
  cli_coloring_read(&job->coloring, &read_options);
  double start = cli_seconds();
  unsigned epsg;
  conic_status status = cli_points_find_epsg(job->base.session, job->base.input, 1, &epsg);
  if (status == CONIC_OK)
    status = conic_gaussians_read_model(context, job->base.input, &read_options, &model);
  start = cli_build_end_stage(&stages[READ], start);
  if (status != CONIC_OK)
    return status;
  if (cli_build_know(&job->base, cli_build_facts(&model)) != CONIC_OK) {
    conic_model_release(context, &model);
    return CONIC_ERROR_ARGUMENT;
  }
  cli_build_hint_faces(&job->base, &model);
  job->n_in = model.points.count;
  status = cli_build_leave_far(&job->base, &model.points);
  if (status == CONIC_OK)
    status = conic_model_to_splats(context, &job->estimate, &model, &job->repairs);
  if (status == CONIC_OK)
    status = cli_coloring_apply(&job->base, &job->coloring, model.up, &model.points, NULL);
  start = cli_build_end_stage(&stages[ESTIMATE], start);
  if (status == CONIC_OK)
    status = conic_octree_build(context, &model.points, &job->options, &job->octree);
  cli_build_end_stage(&stages[WORK], start);
  conic_model_release(context, &model);
  return status;
}

static int make_octree(void *cookie) {
  octree_job *job = cookie;
  cli_build_share(&job->base);
  conic_status status = cli_build_part(&job->base, build_from_model(job));
  double start = cli_seconds();
  if (!cli_session_speaks(job->base.session))
    return cli_exit_of(status);
  if (status == CONIC_OK)
    status = conic_octree_describe(job->octree, &job->info);
  if (status == CONIC_OK)
    status = conic_octree_write(job->octree, job->base.output);
  cli_build_end_stage(&job->base.stages[WRITE], start);
  return cli_exit_of(status);
}

static void report_octree(cli_json *json, const void *cookie) {
  const octree_job *job = cookie;
  cli_json_counts(json, NULL, {"points_in", job->n_in}, {"points_out", job->info.n_leaves},
                  {"inner_nodes", job->info.n_nodes}, {"levels", (uint64_t)job->info.n_levels},
                  {"bytes", job->info.n_bytes});
  cli_json_number(json, "bytes_per_point", (double)job->info.n_bytes / (double)job->n_in);
  cli_color_report(json, &job->coloring.done);
  cli_build_report_cost(json, &job->base, "points_per_s", (double)job->n_in / job->base.stages[WORK].seconds);
  cli_json_skipped(json, &job->repairs);
}

static void tell_octree(const void *cookie) {
  const octree_job *job = cookie;
  const conic_octree_info *info = &job->info;
  conic_log(job->base.session->context, CONIC_LOG_INFO,
            "%s: %zu points in; %zu leaves and %zu inner nodes in %d levels out, %.1f MiB", job->base.input, job->n_in,
            info->n_leaves, info->n_nodes, info->n_levels, (double)info->n_bytes / 1048576.0);
  conic_repairs_log(job->base.session->context, job->base.input, &job->repairs);
}

static void release_octree(void *cookie) {
  octree_job *job = cookie;
  conic_octree_destroy(job->octree);
}

static int run_octree(cli_session *session, int argc, char **argv) {
  static const cli_build_steps steps = {make_octree, tell_octree, report_octree, release_octree};
  octree_job job = {.base = {session, .stages = {{"read"}, {"estimate"}, {"work"}, {"write"}}}};
  conic_estimate_options_init(&job.estimate);
  job.estimate.finds_dots = 1;
  conic_octree_options_init(&job.options);
  cli_coloring_init(&job.coloring);
  job.cutoff = (double)job.options.cutoff;
  const cli_option options[] = {
      {"o", CLI_TEXT, &job.base.output, "OUT.cot", "the file to write"},
      {"quantize", CLI_FLAG, &job.options.quantize, NULL, "round the splats: about half the size; the error is stated"},
      {"cutoff", CLI_NUMBER, &job.cutoff, "F", "the --cutoff of the pictures to come [1.5]", 0.25, 5},
      {"k", CLI_INT, &job.estimate.n_neighbours, "K",
       "neighbours that a raw point's size is estimated from, 6 to 64 [20]", 6, 64,
       .acts = {.on = CLI_FACT(RAW), .is_warned = 1}},
      CLI_READING(session, &job.base),
      CLI_WHERE(&job.base.where),
      CLI_BUILD_COLOR_OPTIONS(&job.coloring, CLI_UP_OF_COLORS),
  };
  int exit_code = cli_build_parse(&job.base, options, sizeof options / sizeof *options, argc, argv, "cot");
  job.options.cutoff = job.estimate.cutoff = (float)job.cutoff;
  if (exit_code == CLI_DONE)
    exit_code = cli_coloring_check(session, &job.coloring);
  return cli_build_run(&job, &steps, exit_code);
}

const cli_command cli_octree = {
    .name = "octree",
    .summary = "builds a point-octree: splats in several resolutions, for --error and --budget",
    .usage = "conic octree IN -o OUT.cot [--quantize] [--cutoff F]",
    .run = run_octree,
    .is_shared = 1,
    .description =
        "Writes the splats and means of them, level by level, so that conic render --error or --budget draws "
        "no more than a picture needs.",
    .examples = {{"build and draw with an error of half a pixel at most",
                  "conic octree scan.ply -o scan.cot\n"
                  "conic render scan.cot --error 0.5 -o scan.png"}},
};
