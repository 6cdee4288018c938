/* conic project: what a Gaussian scene's profile makes of each Gaussian before it is composited. */

#include "cli/command.h"
#include "cli/commands/gaussian_commands.h"
#include "cli/outputs.h"
#include "core/files/disk.h"
#include "core/image/view_arguments.h"
#include "core/splats/gaussian_profile.h"

typedef struct project_job {
  cli_render_job scene;
  const char *output;
  int floats;
  conic_gaussian_intermediates found;
  double ms;
} project_job;

static size_t count_shown(const conic_gaussian_intermediates *found) {
  const double *depths = found->arrays[CONIC_INTERMEDIATE_DEPTHS].value; /* 0: left out */
  size_t n = 0;
  for (size_t i = 0; i < found->count; i++)
    n += depths[i] != 0.0;
  return n;
}

static void report_project(cli_json *json, const void *cookie) {
  const project_job *job = cookie;
  cli_json_text(json, "profile", conic_gaussian_profile_name(job->scene.shot.gaussians.profile));
  cli_json_text(json, "floats", cli_float_words[job->floats]);
  cli_json_counts(json, NULL, {"gaussians", job->found.count}, {"shown", count_shown(&job->found)},
                  {"tile_width", (uint64_t)job->found.tile_width}, {"tile_height", (uint64_t)job->found.tile_height},
                  {"isects", job->found.n_isects});
  cli_json_figures(json, "ms", {"project", job->ms});
}

static conic_status project_scene(cli_session *session, project_job *job) {
  conic_gaussian_options options;
  conic_float_model model;
  conic_status status = cli_gaussians_begin(session, &job->scene, job->floats, &options, &model);
  const double start = cli_seconds();
  if (status == CONIC_OK)
    status = conic_view_bounded_check(session->context, "project", conic_profile_row_of(options.profile),
                                      &job->scene.shot.camera);
  if (status == CONIC_OK)
    status = conic_gaussian_intermediates_find(session->context, conic_source_gaussians(job->scene.source),
                                               &job->scene.shot.camera, &options, &model, &job->found);
  job->ms = 1e3 * (cli_seconds() - start);
  if (status == CONIC_OK && job->output)
    status = conic_gaussian_intermediates_write(session->context, job->output, &job->found);
  return status;
}

static int produce_projection(cli_session *session, void *cookie) {
  project_job *job = cookie;
  int exit_code = cli_exit_of(project_scene(session, job));
  if (exit_code == CLI_DONE)
    exit_code = cli_json_write(session, report_project, job);
  if (exit_code == CLI_DONE)
    cli_note(session, "%zu Gaussians, %zu of them shown, %zu entries of tiles' lists", job->found.count,
             count_shown(&job->found), job->found.n_isects);
  conic_gaussian_intermediates_release(session->context, &job->found);
  return exit_code;
}

static int check_project(cli_session *session, const project_job *job) {
  const cli_render_job *scene = &job->scene;
  if (!job->output && !session->json_path)
    return cli_usage("project: nothing to write; give -o FILE.npz or FILE.csv, or --json FILE");
  const char *dot = job->output ? strrchr(job->output, '.') : ".npz";
  if (!dot || (strcmp(dot, ".npz") != 0 && strcmp(dot, ".csv") != 0))
    return cli_usage("project: %s: its name ends in neither .npz nor .csv", job->output);
  if (!cli_is_composited(scene) && conic_disk_can_read(scene->inputs[0])) /* else opening it says more */
    return cli_usage("project: it is of Gaussian scenes by a profile; conic explain --dump-projection is of splats");
  if (scene->shot.gaussians.prefilter != 0.0 || scene->shot.view.samples > 1)
    return cli_usage("project: it is of one sample a pixel, without a prefilter");
  int exit_code = cli_check_outputs(session, &job->output, 1);
  return exit_code == CLI_DONE ? cli_scene_inputs_stay(session, scene, &job->output, 1) : exit_code;
}

static int run_project(cli_session *session, int argc, char **argv) {
  project_job job = {.floats = CONIC_FLOATS_FAST};
  cli_scene_defaults(&job.scene);
  const cli_option own[] = {
      {"o", CLI_TEXT, &job.output, "FILE",
       "all arrays by gsplat's names, and their ranges: .npz; or .csv, without lists"},
      {"floats", CLI_CHOICE, &job.floats, "WHOSE",
       "whose roundings the ranges are of: own, strict or fast (a GPU's) [fast]", .choices = cli_float_words},
  };
  int exit_code = cli_scene_parse(session, own, (int)(sizeof own / sizeof own[0]), argc, argv, &job.scene);
  if (exit_code == CLI_DONE)
    exit_code = check_project(session, &job);
  return cli_scene_run(session, exit_code, &job.scene, produce_projection, &job);
}

const cli_command cli_project = {
    .name = "project",
    .summary = "tells what each Gaussian is on the screen, and which tiles list it",
    .usage = "conic project SCENE --camera C -o FILE.npz [--profile NAME] [camera and render options]",
    .run = run_project,
    .description = "Computes what a renderer has of each Gaussian before it composites, in double precision, with the "
                   "range that floats may give: means, depths, conics, radii, opacities, colours, and the sorted lists "
                   "of tiles, by gsplat's names. conic judge --intermediates compares a renderer's own with them.",
    .examples = {{"the intermediates of a view, for NumPy",
                  "conic project scene.ply --camera camera.json --profile gsplat-1.6 -o intermediates.npz"}},
};
