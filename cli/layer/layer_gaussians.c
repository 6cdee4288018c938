/* conic layer of Gaussian scenes: levels of merged Gaussians, by --payload gaussians. */

#include "cli/layer/layer_job.h"

int cli_layer_choose_payload(cli_layer_job *job) {
  conic_context *context = job->base.session->context;
  int n_scenes = 0;
  if (job->payload != CLI_LAYER_BY_INPUT)
    return CLI_DONE;
  for (int i = 0; i < job->n_inputs && !job->is_merging; i++)
    n_scenes += conic_gaussians_is_file(context, job->inputs[i]);
  job->payload = n_scenes ? CLI_LAYER_GAUSSIANS : CLI_LAYER_PLAIN;
  return n_scenes && n_scenes < job->n_inputs
             ? cli_usage(
                   "layer: Gaussian scenes beside other inputs; --payload plain takes the scenes as opaque splats")
             : CLI_DONE;
}

static int check_gaussian_arguments(const cli_layer_job *job) {
  const char *wrong = job->is_appending                           ? "--append"
                      : job->is_quantum_given                     ? "--quantum"
                      : job->is_resumable || job->resume_path     ? "--resumable and --resume"
                      : job->base.where                           ? "--where"
                      : job->keep                                 ? "--keep"
                      : job->coloring.options.by                  ? "--color-by"
                      : job->coloring.is_up_given                 ? "--up"
                      : job->cutoff != 1.5                        ? "--cutoff"
                      : cli_team_is_shared(job->base.session)     ? "several processes"
                      : job->cloud_size > CONIC_LEVELS_MOST_CLOUD ? "--cloud-size above 16384"
                                                                  : NULL;
  return wrong
             ? cli_usage("layer: a Gaussian scene is kept without %s; --payload plain takes it as opaque splats", wrong)
             : CLI_DONE;
}

static conic_status add_scene(cli_layer_job *job, const char *path) {
  conic_context *context = job->base.session->context;
  conic_gaussians scene;
  const double start = cli_seconds();
  job->base.input = path;
  conic_status status = conic_gaussians_read(context, path, NULL, &scene);
  if (status == CONIC_OK)
    status = conic_levels_builder_append(job->gaussian_builder, path, &scene);
  conic_gaussians_release(context, &scene);
  job->base.stages[0].seconds += cli_seconds() - start;
  return status;
}

int cli_layer_make_gaussians(cli_layer_job *job) {
  int answer = check_gaussian_arguments(job);
  if (answer != CLI_DONE)
    return answer;
  job->base.input = job->inputs[0];
  conic_status status = cli_build_know(&job->base, CLI_FACT(GAUSSIANS));
  if (status == CONIC_OK)
    status = conic_levels_builder_open(job->base.session->context, job->base.output, (uint32_t)job->cloud_size,
                                       job->options.memory_bytes, &job->gaussian_builder);
  for (int i = 0; i < job->n_inputs && status == CONIC_OK; i++)
    status = add_scene(job, job->inputs[i]);
  const double start = cli_seconds();
  if (status == CONIC_OK)
    status = conic_levels_builder_finish(job->gaussian_builder, &job->levels);
  else
    conic_levels_builder_abandon(job->gaussian_builder);
  cli_build_end_stage(&job->base.stages[1], start);
  return cli_exit_of(status);
}

void cli_layer_report_gaussians(cli_json *json, const cli_layer_job *job) {
  const conic_levels_statistics *s = &job->levels;
  cli_json_counts(json, NULL, {"gaussians", s->n}, {"gaussians_merged", s->n_merged}, {"clouds", s->n_clouds},
                  {"levels", (uint64_t)s->n_levels}, {"bytes", s->n_bytes});
  cli_build_report_cost(json, &job->base, "points_per_s", (double)s->n / job->base.total_seconds);
}

void cli_layer_tell_gaussians(const cli_layer_job *job) {
  const conic_levels_statistics *s = &job->levels;
  conic_log(job->base.session->context, CONIC_LOG_INFO,
            "%s: %llu Gaussians, and %llu merged, in %llu clouds and %d levels, %.1f MiB", job->base.output,
            (unsigned long long)s->n, (unsigned long long)s->n_merged, (unsigned long long)s->n_clouds, s->n_levels,
            (double)s->n_bytes / 1048576.0);
}
