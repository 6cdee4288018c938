/* conic octree: splats, raw points or a mesh in, a point-octree out. */
#include <string.h>

#include "cli/arguments.h"
#include "cli/command.h"
#include "cli/json_write.h"
#include "cli/outputs.h"
#include "cli/tell.h"
#include "core/base/message.h"
#include "core/splats/repairs_log.h"
#include "source/reach.h"

typedef struct octree_job {
  cli_session *session;
  const char *input, *output;
  conic_estimate_options estimate;
  conic_octree_options options;
  double cutoff;

  conic_octree *octree;
  conic_octree_info info;
  size_t n_in;
  conic_repairs repairs;
  double read_seconds, estimate_seconds, work_seconds, write_seconds;
} octree_job;

static conic_status build(octree_job *job) {
  conic_context *context = job->session->context;
  conic_read_options read_options;
  conic_model model;
  conic_read_options_init(&read_options);
  read_options.cutoff = job->options.cutoff;
  double start = cli_seconds();
  conic_status status = conic_model_read(context, job->input, &read_options, &model);
  double read = cli_seconds();
  job->read_seconds = read - start;
  if (status != CONIC_OK)
    return status;
  job->n_in = model.points.count;
  const char *why = conic_why_out_of_reach(&model.points);
  if (why) {
    cli_error(CLI_INPUT, "%s: cannot be drawn: %s", job->input, why);
    conic_model_release(context, &model);
    return CONIC_ERROR_INPUT;
  }
  status = conic_model_to_splats(context, &job->estimate, &model, &job->repairs);
  double estimated = cli_seconds();
  job->estimate_seconds = estimated - read;
  if (status == CONIC_OK)
    status = conic_octree_build(context, &model.points, &job->options, &job->octree);
  job->work_seconds = cli_seconds() - estimated;
  conic_model_release(context, &model);
  return status;
}

static conic_status write_octree(octree_job *job) {
  double start = cli_seconds();
  conic_status status = conic_octree_describe(job->octree, &job->info);
  if (status == CONIC_OK)
    status = conic_octree_write(job->octree, job->output);
  job->write_seconds = cli_seconds() - start;
  return status;
}

static int write_statistics(octree_job *job, double total_seconds) {
  int exit_code = CLI_DONE;
  cli_json_file *file;
  cli_json *json = cli_json_open(job->session, &file, &exit_code);
  if (!json)
    return exit_code;
  cli_json_count(json, "points_in", job->n_in);
  cli_json_count(json, "points_out", job->info.n_leaves);
  cli_json_count(json, "inner_nodes", job->info.n_nodes);
  cli_json_count(json, "levels", (uint64_t)job->info.n_levels);
  cli_json_count(json, "bytes", job->info.n_bytes);
  cli_json_number(json, "bytes_per_point", (double)job->info.n_bytes / (double)job->n_in);
  cli_json_object(json, "seconds");
  cli_json_number(json, "read", job->read_seconds);
  cli_json_number(json, "estimate", job->estimate_seconds);
  cli_json_number(json, "work", job->work_seconds);
  cli_json_number(json, "write", job->write_seconds);
  cli_json_number(json, "total", total_seconds);
  cli_json_close(json);
  cli_json_number(json, "points_per_s", (double)job->n_in / job->work_seconds);
  cli_json_count(json, "peak_rss_bytes", cli_peak_rss_bytes());
  cli_json_skipped(json, &job->repairs);
  return cli_json_finish(file);
}

static void tell(const octree_job *job, double total_seconds) {
  const cli_stage stages[] = {{"read", job->read_seconds},
                              {"estimate", job->estimate_seconds},
                              {"work", job->work_seconds},
                              {"write", job->write_seconds}};
  const conic_octree_info *info = &job->info;
  conic_log(job->session->context, CONIC_LOG_INFO,
            "%s: %zu points in; %zu leaves and %zu inner nodes in %d levels out, %.1f MiB", job->input, job->n_in,
            info->n_leaves, info->n_nodes, info->n_levels, (double)info->n_bytes / 1048576.0);
  conic_repairs_log(job->session->context, job->input, &job->repairs);
  cli_tell_run(job->session, stages, 4, total_seconds);
}

static int run_job(octree_job *job) {
  double start = cli_seconds();
  int exit_code = cli_session_open(job->session);
  if (exit_code != CLI_DONE)
    return exit_code;
  conic_status status = build(job);
  if (status == CONIC_OK)
    status = write_octree(job);
  double total_seconds = cli_seconds() - start;
  if (status == CONIC_OK)
    tell(job, total_seconds);
  exit_code = status == CONIC_OK ? write_statistics(job, total_seconds) : cli_exit_of(status);
  conic_octree_destroy(job->octree);
  return exit_code;
}

static int run(cli_session *session, int argc, char **argv) {
  octree_job job = {.session = session};
  const char *positional[argc];
  int n_positional;
  conic_estimate_options_init(&job.estimate);
  conic_octree_options_init(&job.options);
  job.cutoff = (double)job.options.cutoff;
  const cli_option options[] = {
      {.name = "o", .type = CLI_TEXT, .value = &job.output, .argument = "OUT.cot", .help = "the file to write"},
      {.name = "quantize",
       .type = CLI_FLAG,
       .value = &job.options.quantize,
       .help = "round the splats: about half the size; the error is stated"},
      {.name = "cutoff",
       .type = CLI_NUMBER,
       .value = &job.cutoff,
       .argument = "F",
       .help = "standard deviations at which a splat ends; that of the pictures [1.5]",
       .minimum = 0.25,
       .maximum = 5},
      {.name = "k",
       .type = CLI_INT,
       .value = &job.estimate.n_neighbours,
       .argument = "K",
       .help = "neighbours that a raw point's size is estimated from, 6 to 64 [20]",
       .minimum = 6,
       .maximum = 64},
  };
  int exit_code =
      cli_parse(session, options, sizeof options / sizeof options[0], argc, argv, positional, &n_positional);
  if (exit_code != CLI_DONE)
    return exit_code < 0 ? CLI_DONE : exit_code;
  if (n_positional != 1)
    return cli_usage("octree: %s; see conic help octree", n_positional ? "one input at a time" : "no input given");
  if (!job.output)
    return cli_usage("octree: no output given (-o OUT.cot)");
  job.input = positional[0];
  job.options.cutoff = job.estimate.cutoff = (float)job.cutoff;
  exit_code = cli_check_ending(job.output, "cot");
  if (exit_code == CLI_DONE)
    exit_code = cli_check_outputs(session, &job.output, 1);
  if (exit_code == CLI_DONE)
    exit_code = cli_check_inputs_stay(session, &job.input, 1, &job.output, 1);
  return exit_code == CLI_DONE ? run_job(&job) : exit_code;
}

const cli_command cli_octree = {
    .name = "octree",
    .summary = "builds a point-octree: splats in several resolutions, for --error and --budget",
    .usage = "conic octree IN -o OUT.cot [--quantize] [--cutoff F]",
    .run = run,
};
