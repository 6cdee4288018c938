#include "cli/judge/judge_intermediates.h"

#include "cli/commands/gaussian_commands.h"
#include "cli/outputs.h"

typedef struct intermediates_job {
  cli_render_job scene;
  const char *path;
  unsigned long long max_wrong;
  int floats;
  conic_intermediates_verdict verdict;
  double ms;
} intermediates_job;

static int is_array_wrong(const intermediates_job *job, const conic_judged_array *a) {
  return a->wrong > job->max_wrong;
}

/* The first of the arrays in the order of the stages that is wrong; null: none. */
static const conic_judged_array *first_wrong(const intermediates_job *job) {
  for (int k = 0; k < job->verdict.n_arrays; k++)
    if (is_array_wrong(job, &job->verdict.arrays[k]))
      return &job->verdict.arrays[k];
  return NULL;
}

static void write_worst_number(cli_json *json, const conic_judged_array *a) {
  cli_json_object(json, "worst");
  cli_json_counts(json, NULL, {"row", a->row}, {"column", (uint64_t)a->column});
  if (a->gaussian != CONIC_NO_ID)
    cli_json_count(json, "gaussian", a->gaussian);
  if (a->what)
    cli_json_text(json, "what", a->what);
  cli_json_figures(json, NULL, {"found", a->found}, {"value", a->value}, {"low", a->low}, {"high", a->high});
  cli_json_close(json);
}

static void write_intermediates(cli_json *json, const void *cookie) {
  const intermediates_job *job = cookie;
  const conic_judged_array *first = first_wrong(job);
  cli_json_text(json, "verdict", first ? "wrong" : "right");
  cli_json_text(json, "profile", conic_gaussian_profile_name(job->scene.shot.gaussians.profile));
  cli_json_text(json, "floats", cli_float_words[job->floats]);
  if (first)
    cli_json_text(json, "stage", conic_gaussian_stage_name(first->stage));
  cli_json_array(json, "arrays");
  for (int k = 0; k < job->verdict.n_arrays; k++) {
    const conic_judged_array *a = &job->verdict.arrays[k];
    cli_json_object(json, NULL);
    cli_json_texts(json, NULL, {"name", a->name}, {"stage", conic_gaussian_stage_name(a->stage)});
    cli_json_counts(json, NULL, {"judged", a->judged}, {"wrong", a->wrong});
    if (a->wrong)
      write_worst_number(json, a);
    cli_json_close(json);
  }
  cli_json_close(json);
  cli_json_figures(json, "ms", {"judge", job->ms});
}

static void print_intermediates(const intermediates_job *job) {
  const conic_judged_array *first = first_wrong(job);
  for (int k = 0; k < job->verdict.n_arrays; k++) {
    const conic_judged_array *a = &job->verdict.arrays[k];
    printf("%-10s %-15s %zu of %zu wrong\n", conic_gaussian_stage_name(a->stage), a->name, a->wrong, a->judged);
  }
  if (first) {
    printf("the first stage that is wrong is %s: %s[%zu][%d]", conic_gaussian_stage_name(first->stage), first->name,
           first->row, first->column);
    if (first->gaussian != CONIC_NO_ID)
      printf(" of Gaussian %u", first->gaussian);
    if (strncmp(first->name, "render_", 7) == 0)
      printf(" at pixel %zu,%zu", first->row % (size_t)job->scene.shot.camera.width,
             first->row / (size_t)job->scene.shot.camera.width);
    printf(" is %.9g", first->found);
    if (first->what)
      printf(": %s", first->what);
    if (!first->what || first->low != first->high)
      printf("; it may be %.9g to %.9g", first->low, first->high);
    putchar('\n');
  }
  puts(first ? "WRONG" : "right");
}

static conic_status judge_arrays(cli_session *session, intermediates_job *job) {
  conic_gaussian_options options;
  conic_float_model model;
  conic_status status = cli_gaussians_begin(session, &job->scene, job->floats, &options, &model);
  const double start = cli_seconds();
  if (status == CONIC_OK)
    status = conic_gaussian_intermediates_judge(session->context, conic_source_gaussians(job->scene.source),
                                                &job->scene.shot.camera, &options, &model, job->path, &job->verdict);
  job->ms = 1e3 * (cli_seconds() - start);
  return status;
}

static int judge_intermediates(cli_session *session, void *cookie) {
  intermediates_job *job = cookie;
  int exit_code = cli_exit_of(judge_arrays(session, job));
  if (exit_code == CLI_DONE)
    exit_code = cli_json_write(session, write_intermediates, job);
  if (exit_code == CLI_DONE) {
    if (cli_json_leaves_text(session))
      print_intermediates(job);
    exit_code = first_wrong(job) ? CLI_DIFFERENT : CLI_DONE;
  }
  return exit_code;
}

static int check_intermediates(cli_session *session, const intermediates_job *job) {
  const cli_render_job *scene = &job->scene;
  if (!cli_is_composited(scene))
    return cli_usage("judge: --intermediates is of Gaussian scenes by a profile");
  if (scene->abilities & CONIC_SOURCE_MIXES)
    return cli_usage("judge: --intermediates is of Gaussians before they are composited: leave the surfaces out");
  if (scene->shot.view.samples > 1 || scene->shot.gaussians.prefilter != 0.0)
    return cli_usage("judge: --intermediates is of one sample a pixel, without a prefilter");
  int exit_code = cli_check_inputs_stay(session, &job->path, 1, NULL, 0);
  return exit_code == CLI_DONE ? cli_scene_inputs_stay(session, scene, NULL, 0) : exit_code;
}

int cli_intermediates_run(cli_session *session, int argc, char **argv) {
  intermediates_job job = {.floats = CONIC_FLOATS_FAST};
  cli_scene_defaults(&job.scene);
  const cli_option own[] = {
      CLI_INTERMEDIATES_OPTION(job.path),
      {"floats", CLI_CHOICE, &job.floats, "KIND", "of what found them: own, strict or fast [fast]",
       .choices = cli_float_words},
      {"max-wrong", CLI_COUNT, &job.max_wrong, "N", "so many rows of an array may be wrong [0]", 0, 4294836225.0},
  };
  int exit_code = cli_scene_parse(session, own, (int)(sizeof own / sizeof own[0]), argc, argv, &job.scene);
  if (exit_code == CLI_DONE)
    exit_code = check_intermediates(session, &job);
  return cli_scene_run(session, exit_code, &job.scene, judge_intermediates, &job);
}
