#include "cli/judge/judge_gradients.h"

#include "cli/commands/gaussian_commands.h"
#include "cli/outputs.h"

enum { MOST_RUNS = 64, MOST_RUNS_PRINTED = 8 };

typedef struct gradients_job {
  cli_render_job scene;
  cli_gradient_files files;
  unsigned long long max_wrong;
  int floats;
  conic_gaussian_weights weights;
  conic_gaussian_gradient theirs;
  conic_gradient_verdict verdict;
  uint8_t *wrong_kinds; /* of each Gaussian */
  double ms;
} gradients_job;

static int is_gradient_right(const gradients_job *job) {
  return job->verdict.gaussians[CONIC_PIXEL_WRONG] <= job->max_wrong;
}

/* The Gaussians of which the kind is wrong, in runs: the next after *at. */
static int next_wrong_run(const gradients_job *job, int kind, size_t *at, size_t *last) {
  const size_t n = job->theirs.count;
  while (*at < n && !(job->wrong_kinds[*at] >> kind & 1))
    (*at)++;
  for (*last = *at; *last + 1 < n && job->wrong_kinds[*last + 1] >> kind & 1;)
    (*last)++;
  return *at < n;
}

static void write_gradient_mistake(cli_json *json, const gradients_job *job, int kind) {
  const conic_gradient_mistake *m = &job->verdict.mistakes[kind];
  size_t last;
  cli_json_object(json, NULL);
  cli_json_text(json, "kind", conic_gradient_kind_name((conic_gradient_kind)kind));
  if (m->name) {
    cli_json_text(json, "name", m->name);
    cli_json_bool(json, "named", m->is_named);
    cli_json_count(json, "righted", m->righted);
    cli_json_count(json, "spoilt", m->spoilt);
  }
  cli_json_array(json, "runs");
  for (size_t at = 0, n = 0; n < MOST_RUNS && next_wrong_run(job, kind, &at, &last); at = last + 1, n++) {
    cli_json_array(json, NULL);
    cli_json_count(json, NULL, at);
    cli_json_count(json, NULL, last);
    cli_json_close(json);
  }
  cli_json_close(json);
  cli_json_close(json);
}

static void print_gradient_mistake(const gradients_job *job, int kind) {
  const conic_gradient_mistake *m = &job->verdict.mistakes[kind];
  const char *name = conic_gradient_kind_name((conic_gradient_kind)kind);
  const size_t wrong = job->verdict.wrong[kind];
  size_t at = 0, last, n = 0;
  if (!wrong)
    return;
  printf("wrong     %s of Gaussians", name);
  for (; n < MOST_RUNS_PRINTED && next_wrong_run(job, kind, &at, &last); at = last + 1, n++)
    printf(at == last ? "%s %zu" : "%s %zu-%zu", n ? "," : "", at, last);
  puts(next_wrong_run(job, kind, &at, &last) ? ", and more" : "");
  if (m->name && m->is_named)
    printf("mistake   %s: %s; it rights %zu of %zu and spoils none\n", name, m->name, m->righted, wrong);
  else if (m->name)
    printf("nearest   %s: %s; it rights %zu of %zu, and would spoil %zu that are right\n", name, m->name, m->righted,
           wrong, m->spoilt);
  else
    printf("mistake   %s: none that is known\n", name);
}

static void write_gradient_worst(cli_json *json, const conic_gradient_verdict *v) {
  cli_json_array(json, "worst");
  for (int k = 0; k < v->n_worst; k++) {
    const conic_gradient_fault *f = &v->worst[k];
    cli_json_object(json, NULL);
    cli_json_count(json, "gaussian", f->gaussian);
    cli_json_text(json, "kind", conic_gradient_kind_name((conic_gradient_kind)f->kind));
    cli_json_count(json, "number", (uint64_t)f->number);
    cli_json_figures(json, NULL, {"found", f->found}, {"value", f->value}, {"low", f->low}, {"high", f->high});
    cli_json_close(json);
  }
  cli_json_close(json);
}

static void write_gradient_verdict(cli_json *json, const void *cookie) {
  const gradients_job *job = cookie;
  const conic_gradient_verdict *v = &job->verdict;
  cli_json_text(json, "verdict", is_gradient_right(job) ? "right" : "wrong");
  cli_json_text(json, "profile", conic_gaussian_profile_name(job->scene.shot.gaussians.profile));
  cli_json_text(json, "parameters", job->files.is_raw ? "raw" : "activated");
  cli_json_object(json, "gaussians");
  for (int k = 0; k < CONIC_N_GAUSSIAN_CLASSES; k++)
    cli_json_count(json, cli_class_words[k], v->gaussians[k]);
  cli_json_close(json);
  cli_json_object(json, "kinds");
  for (int k = 0; k < CONIC_N_GRADIENT_KINDS; k++) {
    if (job->theirs.lacks >> k & 1)
      continue;
    cli_json_object(json, conic_gradient_kind_name((conic_gradient_kind)k));
    cli_json_count(json, "wrong", v->wrong[k]);
    cli_json_figures(json, NULL, {"greatest", v->greatest[k]}, {"max_abs", v->max_abs[k]},
                     {"share_of_bound", v->share_of_bound[k]});
    cli_json_close(json);
  }
  cli_json_close(json);
  cli_json_array(json, "mistakes");
  for (int k = 0; k < CONIC_N_GRADIENT_KINDS; k++)
    if (v->wrong[k])
      write_gradient_mistake(json, job, k);
  cli_json_close(json);
  write_gradient_worst(json, v);
  cli_json_figures(json, "ms", {"judge", job->ms});
}

static void print_gradient_verdict(const gradients_job *job) {
  const conic_gradient_verdict *v = &job->verdict;
  for (int k = 0; k < CONIC_N_GRADIENT_KINDS; k++)
    if (!(job->theirs.lacks >> k & 1))
      printf("%-9s max %-11.4g of %-11.4g %zu wrong\n", conic_gradient_kind_name((conic_gradient_kind)k), v->max_abs[k],
             v->greatest[k], v->wrong[k]);
  printf("Gaussians ");
  for (int k = 0; k < CONIC_N_GAUSSIAN_CLASSES; k++)
    printf("%s%zu %s", k ? ", " : "", v->gaussians[k], cli_class_words[k]);
  putchar('\n');
  for (int k = 0; k < v->n_worst; k++)
    printf("worst     Gaussian %zu: %s[%d] is %.9g; it may be %.9g to %.9g\n", v->worst[k].gaussian,
           conic_gradient_kind_name((conic_gradient_kind)v->worst[k].kind), v->worst[k].number, v->worst[k].found,
           v->worst[k].low, v->worst[k].high);
  for (int k = 0; k < CONIC_N_GRADIENT_KINDS; k++)
    print_gradient_mistake(job, k);
  puts(is_gradient_right(job) ? "right" : "WRONG");
}

/* Files that do not fit the scene cannot be used. */
static conic_status check_gradient_files(const gradients_job *job, const conic_camera *camera,
                                         const conic_gaussians *scene) {
  const cli_gradient_files *files = &job->files;
  if (job->weights.width != camera->width || job->weights.height != camera->height)
    cli_error(CLI_INPUT, "%s: it has %d x %d pixels, and the picture %d x %d", files->weights, job->weights.width,
              job->weights.height, camera->width, camera->height);
  else if (job->theirs.count != scene->count)
    cli_error(CLI_INPUT, "%s: it is of %zu Gaussians, and the scene has %zu", files->gradients, job->theirs.count,
              scene->count);
  else if (!(job->theirs.lacks >> CONIC_GRADIENT_SH & 1) && job->theirs.sh_degree < scene->sh_degree)
    cli_error(CLI_INPUT, "%s: its harmonics are of degree %d, and the scene's of %d", files->gradients,
              job->theirs.sh_degree, scene->sh_degree);
  else
    return CONIC_OK;
  return CONIC_ERROR_INPUT;
}

static conic_status judge_gradient(cli_session *session, gradients_job *job) {
  const conic_gaussian_options options = cli_gaussian_options(&job->scene);
  const conic_gaussians *scene = conic_source_gaussians(job->scene.source);
  conic_camera camera;
  conic_gradient_options how;
  conic_float_model model;
  conic_gradient_options_init(&how);
  conic_float_model_init(&model, (conic_float_kind)job->floats);
  how.model = &model;
  how.is_raw = job->files.is_raw != 0;
  conic_status status = cli_scene_camera(session, &job->scene, 0);
  camera = job->scene.shot.camera;
  if (status == CONIC_OK)
    status = check_gradient_files(job, &camera, scene);
  job->wrong_kinds = status == CONIC_OK ? calloc(scene->count + 1, 1) : NULL;
  if (status == CONIC_OK && !job->wrong_kinds)
    status = CONIC_ERROR_MEMORY;
  how.wrong_kinds = job->wrong_kinds;
  const double start = cli_seconds();
  if (status == CONIC_OK)
    status = conic_gaussian_gradient_judge(session->context, scene, &camera, &options, &job->weights, &how,
                                           &job->theirs, NULL, &job->verdict);
  job->ms = 1e3 * (cli_seconds() - start);
  return status;
}

static int judge_gradient_files(cli_session *session, void *cookie) {
  gradients_job *job = cookie;
  conic_status status = cli_scene_begin(session, &job->scene);
  if (status == CONIC_OK)
    status = conic_gaussian_weights_read(session->context, job->files.weights, &job->weights);
  if (status == CONIC_OK)
    status = conic_gaussian_gradient_read(session->context, job->files.gradients, &job->theirs);
  if (status == CONIC_OK)
    status = cli_scene_open(session, &job->scene);
  if (status == CONIC_OK)
    status = judge_gradient(session, job);
  int exit_code = cli_exit_of(status);
  if (exit_code == CLI_DONE)
    exit_code = cli_json_write(session, write_gradient_verdict, job);
  if (exit_code == CLI_DONE) {
    if (cli_json_leaves_text(session))
      print_gradient_verdict(job);
    exit_code = is_gradient_right(job) ? CLI_DONE : CLI_DIFFERENT;
  }
  free(job->wrong_kinds);
  conic_gaussian_gradient_release(session->context, &job->theirs);
  conic_gaussian_weights_release(session->context, &job->weights);
  return exit_code;
}

static int check_gradient_judging(cli_session *session, const gradients_job *job) {
  const char *const inputs[] = {job->files.gradients, job->files.weights};
  const cli_render_job *scene = &job->scene;
  const conic_gaussian_profile profile = scene->shot.gaussians.profile;
  if (!job->files.weights)
    return cli_usage("judge: --gradients needs --weights W.exr");
  if (job->scene.abilities & CONIC_SOURCE_MIXES)
    return cli_usage("judge: --gradients is of Gaussians alone: leave the surfaces out; conic gradient takes both");
  if (!cli_is_composited(scene) || !conic_gradient_has_profile(profile) || profile == CONIC_PROFILE_EXACT)
    return cli_usage("judge: --gradients is of Gaussian scenes by a profile of ellipses without limits of axes, as "
                     "gsplat-1.6; give --profile");
  if (scene->shot.view.samples > 1 || scene->shot.gaussians.prefilter != 0.0)
    return cli_usage("judge: --gradients is of one sample a pixel, without a prefilter");
  int exit_code = cli_check_outputs(session, NULL, 0);
  if (exit_code == CLI_DONE)
    exit_code = cli_check_inputs_stay(session, inputs, 2, NULL, 0);
  return exit_code == CLI_DONE ? cli_scene_inputs_stay(session, scene, NULL, 0) : exit_code;
}

int cli_gradients_run(cli_session *session, int argc, char **argv) {
  gradients_job job = {.floats = CONIC_FLOATS_FAST};
  cli_scene_defaults(&job.scene);
  const cli_option own[] = {
      CLI_GRADIENT_OPTIONS(job.files),
      {"floats", CLI_CHOICE, &job.floats, "KIND", "of what found it: own, strict or fast [fast]",
       .choices = cli_float_words},
      {"max-wrong", CLI_COUNT, &job.max_wrong, "N", "so many Gaussians may be wrong [0]", 0, 4294836225.0},
  };
  int exit_code = cli_scene_parse(session, own, (int)(sizeof own / sizeof own[0]), argc, argv, &job.scene);
  if (exit_code == CLI_DONE)
    exit_code = check_gradient_judging(session, &job);
  return cli_scene_run(session, exit_code, &job.scene, judge_gradient_files, &job);
}
