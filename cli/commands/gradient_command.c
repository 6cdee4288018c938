/* conic gradient: the derivative of a Gaussian scene's picture by all numbers of the scene and the camera. */

#include "cli/command.h"
#include "cli/commands/gaussian_commands.h"
#include "cli/outputs.h"
#include "cli/scene/surfaces_drawn.h"
#include "core/files/disk.h"

typedef struct gradient_job {
  cli_render_job scene;
  const char *weights_path, *output;
  int is_raw, leaves_doubts, floats;
  conic_gaussian_weights weights;
  conic_gaussian_gradient gradient;
  double ms;
} gradient_job;

static void write_camera_gradient(cli_json *json, const conic_gaussian_gradient *g) {
  cli_json_object(json, "camera");
  cli_json_array(json, "world_to_camera");
  for (int row = 0; row < 4; row++) {
    cli_json_array(json, NULL);
    for (int k = 0; k < 4; k++)
      cli_json_number(json, NULL, row < 3 ? g->cam_from_world[row][k] : 0.0);
    cli_json_close(json);
  }
  cli_json_close(json);
  cli_json_figures(json, NULL, {"fx", g->fx}, {"fy", g->fy}, {"cx", g->cx}, {"cy", g->cy});
  cli_json_close(json);
}

/* The largest number in a group of parameters. */
static double greatest_in_columns(const double *const *columns, int n_columns, size_t n) {
  double greatest = 0.0;
  for (int k = 0; k < n_columns; k++)
    for (size_t i = 0; columns[k] && i < n; i++) {
      double size = columns[k][i] < 0.0 ? -columns[k][i] : columns[k][i];
      greatest = size > greatest ? size : greatest;
    }
  return greatest;
}

static void write_greatest(cli_json *json, const conic_gaussian_gradient *g) {
  const double *const means[] = {g->mean[0], g->mean[1], g->mean[2]}, *const sh = g->sh, *const opacity = g->opacity;
  const double *const scales[] = {g->scale[0], g->scale[1], g->scale[2]}, *const places[] = {g->place[0], g->place[1]};
  const double *const turns[] = {g->rotation[0], g->rotation[1], g->rotation[2], g->rotation[3]};
  const size_t n_sh = 3 * (size_t)(g->sh_degree + 1) * (size_t)(g->sh_degree + 1);
  cli_json_figures(
      json, "greatest", {"mean", greatest_in_columns(means, 3, g->count)},
      {"scale", greatest_in_columns(scales, 3, g->count)}, {"rotation", greatest_in_columns(turns, 4, g->count)},
      {"opacity", greatest_in_columns(&opacity, 1, g->count)}, {"sh", greatest_in_columns(&sh, 1, g->count * n_sh)},
      {"place", greatest_in_columns(places, 2, g->count)});
}

static void report_gradient(cli_json *json, const void *cookie) {
  const gradient_job *job = cookie;
  const conic_gaussian_gradient *g = &job->gradient;
  cli_json_text(json, "profile", conic_gaussian_profile_name(job->scene.shot.gaussians.profile));
  cli_json_text(json, "parameters", g->is_raw ? "raw" : "activated");
  cli_json_counts(json, NULL, {"width", (uint64_t)job->weights.width}, {"height", (uint64_t)job->weights.height},
                  {"gaussians", g->count}, {"shown", g->n_shown});
  cli_json_number(json, "loss", g->loss);
  write_camera_gradient(json, g);
  write_greatest(json, g);
  if (!job->leaves_doubts) {
    cli_json_count(json, "doubtful", g->n_doubtful);
    cli_json_object(json, "doubtful_by_reason");
    for (int k = 0; k < CONIC_N_GRADIENT_DOUBTS; k++)
      cli_json_count(json, conic_gradient_doubt_name(k), g->doubtful[k]);
    cli_json_close(json);
  }
  cli_json_figures(json, "ms", {"gradient", job->ms});
  cli_json_count(json, "peak_rss_bytes", cli_peak_rss_bytes());
}

static void tell_gradient(const cli_session *session, const gradient_job *job) {
  const conic_gaussian_gradient *g = &job->gradient;
  if (!cli_json_leaves_text(session) || (job->output && strcmp(job->output, "-") == 0))
    return;
  printf("L = %.9g; %zu of %zu Gaussians are shown", g->loss, g->n_shown, g->count);
  if (!job->leaves_doubts)
    printf(", %zu with a decision in doubt", g->n_doubtful);
  printf(" (%.0f ms)\n", job->ms);
}

/* Weights of another size cannot be used. */
static conic_status check_weight_size(const gradient_job *job, const conic_camera *camera) {
  if (job->weights.width == camera->width && job->weights.height == camera->height)
    return CONIC_OK;
  cli_error(CLI_INPUT, "%s: it has %d x %d pixels, and the picture %d x %d", job->weights_path, job->weights.width,
            job->weights.height, camera->width, camera->height);
  return CONIC_ERROR_INPUT;
}

static conic_status differentiate(cli_session *session, gradient_job *job) {
  const conic_gaussian_options options = cli_gaussian_options(&job->scene);
  conic_camera camera;
  conic_gradient_options how;
  conic_float_model model;
  cli_surfaces_drawn drawn = {.given = NULL};
  conic_status status = cli_scene_camera(session, &job->scene, 0);
  camera = job->scene.shot.camera;
  if (status == CONIC_OK)
    status = check_weight_size(job, &camera);
  conic_gradient_options_init(&how);
  conic_float_model_init(&model, (conic_float_kind)job->floats);
  how.model = &model;
  how.is_raw = job->is_raw != 0;
  how.leaves_doubts = job->leaves_doubts != 0;
  double start = cli_seconds();
  if (status == CONIC_OK)
    status = cli_draw_surfaces(&job->scene, &camera, 0, &drawn);
  how.surfaces = drawn.given;
  if (status == CONIC_OK)
    status = conic_gaussian_gradient_find(session->context, conic_source_gaussians(job->scene.source), &camera,
                                          &options, &job->weights, &how, &job->gradient);
  conic_image_release(session->context, &drawn.image);
  job->ms = 1e3 * (cli_seconds() - start);
  if (status == CONIC_OK && job->output)
    status = conic_gaussian_gradient_write(session->context, job->output, &job->gradient);
  return status;
}

static int produce_gradient(cli_session *session, void *cookie) {
  gradient_job *job = cookie;
  conic_status status = cli_scene_begin(session, &job->scene);
  if (status == CONIC_OK)
    status = conic_gaussian_weights_read(session->context, job->weights_path, &job->weights);
  if (status == CONIC_OK)
    status = cli_scene_open(session, &job->scene);
  if (status == CONIC_OK)
    status = differentiate(session, job);
  int exit_code = cli_exit_of(status);
  if (exit_code == CLI_DONE)
    exit_code = cli_json_write(session, report_gradient, job);
  if (exit_code == CLI_DONE)
    tell_gradient(session, job);
  conic_gaussian_gradient_release(session->context, &job->gradient);
  conic_gaussian_weights_release(session->context, &job->weights);
  return exit_code;
}

static int check_gradient(cli_session *session, const gradient_job *job) {
  const char *const outputs[] = {job->output};
  const cli_render_job *scene = &job->scene;
  if (!job->weights_path)
    return cli_usage("gradient: no weights given (--weights W.exr)");
  if (!job->output && !session->json_path)
    return cli_usage("gradient: nothing to write; give -o G.ply or --json FILE");
  if (!cli_is_composited(scene) && conic_disk_can_read(scene->inputs[0])) /* else opening it says more */
    return cli_usage("gradient: it is of Gaussian scenes by a profile; surfels have none yet");
  if (!conic_gradient_has_profile(scene->shot.gaussians.profile))
    return cli_usage("gradient: the profile %s has none yet",
                     conic_gaussian_profile_name(scene->shot.gaussians.profile));
  if (scene->shot.gaussians.prefilter != 0.0)
    return cli_usage("gradient: a picture under --prefilter has none yet");
  if (scene->shot.view.samples > 1)
    return cli_usage("gradient: it is of one sample a pixel");
  int exit_code = cli_check_outputs(session, outputs, 1);
  if (exit_code == CLI_DONE)
    exit_code = cli_check_ending(job->output, "ply");
  if (exit_code == CLI_DONE)
    exit_code = cli_check_inputs_stay(session, &job->weights_path, 1, outputs, 1);
  return exit_code == CLI_DONE ? cli_scene_inputs_stay(session, scene, outputs, 1) : exit_code;
}

static int run_gradient(cli_session *session, int argc, char **argv) {
  gradient_job job = {.floats = CONIC_FLOATS_STRICT};
  cli_scene_defaults(&job.scene);
  const cli_option own[] = {
      {"weights", CLI_TEXT, &job.weights_path, "FILE",
       "W of L = sum W C: a picture with R, G, B and, where they count, A and Z, or an .npy (height, width, 3 to 5)"},
      {"o", CLI_TEXT, &job.output, "G.ply", "the derivative by each Gaussian's parameters, and its doubts"},
      {"raw", CLI_FLAG, &job.is_raw, NULL, "by what files store: the logarithms of scales and the opacity's logit"},
      {"floats", CLI_CHOICE, &job.floats, "WHOSE",
       "whose roundings may put a decision in doubt: own, strict or fast (a GPU's) [strict]",
       .choices = cli_float_words},
      {"no-doubts", CLI_FLAG, &job.leaves_doubts, NULL, "do not look for decisions in doubt, which is faster"},
  };
  int exit_code = cli_scene_parse(session, own, (int)(sizeof own / sizeof own[0]), argc, argv, &job.scene);
  if (exit_code == CLI_DONE)
    exit_code = check_gradient(session, &job);
  return cli_scene_run(session, exit_code, &job.scene, produce_gradient, &job);
}

const cli_command cli_gradient = {
    .name = "gradient",
    .summary = "differentiates a Gaussian scene's picture, in double precision",
    .usage = "conic gradient SCENE --camera C --weights W.exr -o G.ply [--raw] [camera and render options]",
    .run = run_gradient,
    .description = "Computes the derivatives of a weighted sum of a picture's pixels by every parameter of every "
                   "Gaussian, slowly and in double precision, as a reference for those that train.",
    .examples = {{"differentiate what the weights in an EXR ask for",
                  "conic gradient scene.ply --camera camera.json --weights W.exr -o G.ply"}},
};
