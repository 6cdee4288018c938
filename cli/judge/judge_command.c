/* conic judge: tells whether somebody's picture is right, pixel by pixel, and if not, where and why. */

#include "cli/command.h"
#include "cli/commands/gaussian_commands.h"
#include "cli/commands/verify_reference.h"
#include "cli/host.h"
#include "cli/judge/judge_gradients.h"
#include "cli/judge/judge_intermediates.h"
#include "cli/judge/judge_job.h"
#include "cli/judge/suite_judge.h"
#include "cli/outputs.h"

static unsigned judged_planes(const cli_judge_job *job) {
  unsigned planes = cli_is_composited(&job->scene) ? CLI_COMPOSITED_PLANES : CONIC_DRAWN_PLANES;
  return job->scene.is_aov_given ? planes & job->scene.shot.planes : planes;
}

/* conic's own EXRs state how many samples a pixel has. */
static void take_samples_of_picture(cli_judge_job *job) {
  const conic_image *image = &job->picture.image;
  for (int i = 0; i < image->n_attributes && !job->scene.is_samples_given; i++) {
    const conic_attribute *a = &image->attributes[i];
    if (strcmp(a->name, "conicSamples") == 0 && a->type == CONIC_ATTRIBUTE_DOUBLE && a->values[0] >= 1.0 &&
        a->values[0] <= CONIC_MAX_SAMPLES)
      job->scene.shot.view.samples = (int)a->values[0];
  }
}

static conic_status take_picture_in(cli_session *session, cli_judge_job *job) {
  const unsigned planes = judged_planes(job);
  conic_status status = conic_picture_read(session->context, job->picture_path, planes, &job->reading, &job->picture);
  conic_image *const both[] = {&job->picture.image, &job->picture.greatest};
  for (int k = 0; k < 2 && status == CONIC_OK; k++)
    for (int plane = 0; plane < CONIC_N_PLANES; plane++)
      if (!(planes >> plane & 1)) {
        conic_image alone = {.width = 1, .height = 1, .planes[0] = both[k]->planes[plane]};
        conic_image_release(session->context, &alone);
        both[k]->planes[plane] = NULL;
      }
  if (status == CONIC_OK && !conic_image_planes(&job->picture.image)) {
    cli_error(CLI_INPUT, "%s: it has no plane that is judged", job->picture_path);
    return CONIC_ERROR_INPUT;
  }
  take_samples_of_picture(job);
  return status;
}

/* Takes the times of the stages. */
static double pass_stage(cli_judge_job *job, int stage, double start) {
  double now = cli_seconds();
  job->seconds[stage] += now - start;
  return now;
}

static conic_status make_ready(cli_session *session, cli_judge_job *job) {
  double at = cli_seconds();
  conic_status status = cli_scene_begin(session, &job->scene);
  if (status == CONIC_OK)
    status = take_picture_in(session, job);
  if (status == CONIC_OK && job->scene.camera_path) /* before the scene is read */
    status = cli_reference_check_size(job->picture_path, &job->picture.image, &job->scene.camera);
  at = pass_stage(job, CLI_JUDGE_READ, at);
  if (status == CONIC_OK)
    status = cli_scene_open(session, &job->scene);
  if (status == CONIC_OK)
    status = cli_scene_camera(session, &job->scene, 0);
  job->camera = job->scene.shot.camera;
  if (status == CONIC_OK)
    status = cli_reference_check_size(job->picture_path, &job->picture.image, &job->camera);
  pass_stage(job, CLI_JUDGE_OPEN, at);
  if (status != CONIC_OK)
    return status;
  job->found.n_whole = (size_t)job->camera.width * (size_t)job->camera.height;
  job->classes = malloc(job->found.n_whole);
  job->ranges = calloc(job->found.n_whole, sizeof *job->ranges);
  job->wrong_values = calloc(job->found.n_whole, sizeof *job->wrong_values);
  if (!job->classes || !job->ranges || !job->wrong_values) {
    cli_error(CLI_RESOURCE, "judge: out of memory");
    return CONIC_ERROR_MEMORY;
  }
  memset(job->classes, CONIC_N_PIXEL_CLASSES, job->found.n_whole);
  return CONIC_OK;
}

static conic_status find_out(cli_session *session, cli_judge_job *job) {
  double at = cli_seconds();
  conic_status status =
      cli_is_composited(&job->scene) ? cli_judge_gaussians(session, job) : cli_judge_splats(session, job);
  at = pass_stage(job, CLI_JUDGE_JUDGE, at);
  if (status == CONIC_OK && job->found.n_worst)
    status = cli_judge_explain(session, job);
  if (status == CONIC_OK && job->found.vague && job->scene.shot.view.samples == 1)
    status = cli_judge_explain_vague(session, job);
  at = pass_stage(job, CLI_JUDGE_EXPLAIN, at);
  if (status == CONIC_OK)
    conic_faults_locate(&job->picture.image, job->picture.greatest.width ? &job->picture.greatest : NULL, job->classes,
                        cli_is_composited(&job->scene) ? job->wrong_values : NULL, job->found.places,
                        &job->found.n_places);
  if (status == CONIC_OK && !cli_judge_is_right(job) && !job->skips_diagnosis)
    status = cli_judge_diagnose(session, job);
  pass_stage(job, CLI_JUDGE_DIAGNOSE, at);
  return status;
}

static conic_status put_map(cli_session *session, const cli_judge_job *job) {
  conic_image map;
  conic_status status = cli_judge_map(session, job, &map);
  if (status == CONIC_OK)
    status = conic_image_write(session->context, job->map_path, &map);
  conic_image_release(session->context, &map);
  return status;
}

static conic_status show_maps(cli_session *session, cli_judge_job *job) {
  double at = cli_seconds();
  conic_status status = job->map_path ? put_map(session, job) : CONIC_OK;
  if (status == CONIC_OK && job->report_path)
    status = cli_judge_report(session, job);
  pass_stage(job, CLI_JUDGE_SHOW, at);
  return status;
}

static int tell_judged(cli_session *session, const cli_judge_job *job) {
  int exit_code = cli_json_write(session, cli_judge_members, job);
  if (exit_code != CLI_DONE)
    return exit_code;
  if (cli_json_leaves_text(session))
    cli_judge_print(job);
  return cli_judge_is_right(job) && !cli_judge_is_undecided(job) ? CLI_DONE : CLI_DIFFERENT;
}

static int judge_scene(cli_session *session, void *cookie) {
  cli_judge_job *job = cookie;
  conic_status status = make_ready(session, job);
  if (status == CONIC_OK)
    status = find_out(session, job);
  if (status == CONIC_OK)
    status = show_maps(session, job);
  int exit_code = status == CONIC_OK ? tell_judged(session, job) : cli_exit_of(status);
  free(job->classes);
  free(job->ranges);
  free(job->wrong_values);
  conic_image_release(session->context, &job->drawn.image);
  conic_image_release(session->context, &job->ours);
  conic_picture_release(session->context, &job->picture);
  return exit_code;
}

static int check_judge(cli_session *session, cli_judge_job *job) {
  const char *const outputs[] = {job->map_path, job->report_path};
  if (!job->picture_path)
    return cli_usage("judge: no picture; give --picture FILE");
  if (job->scene.is_aov_given && !judged_planes(job))
    return cli_usage("judge: none of these planes is judged of such a scene");
  if (!job->is_transfer_given) /* pictures of Gaussians hold display values */
    job->transfer = !cli_is_composited(&job->scene);
  job->reading.is_srgb = job->transfer;
  int exit_code = cli_check_ending(job->report_path, "html");
  if (exit_code == CLI_DONE)
    exit_code = cli_check_outputs(session, outputs, 2);
  if (exit_code == CLI_DONE)
    exit_code = cli_check_inputs_stay(session, &job->picture_path, 1, outputs, 2);
  return exit_code == CLI_DONE ? cli_scene_inputs_stay(session, &job->scene, outputs, 2) : exit_code;
}

/* Whether an option is among the arguments, or among a host's values. */
static int names_option(const cli_session *session, int argc, char **argv, const char *option) {
  size_t n = strlen(option);
  for (size_t i = 0; session->host && i < session->host->n_values; i++)
    if (strcmp(session->host->values[i].name, option + 2) == 0)
      return 1;
  for (int i = 1; i < argc && strcmp(argv[i], "--") != 0; i++)
    if (strncmp(argv[i], option, n) == 0 && (argv[i][n] == '\0' || argv[i][n] == '='))
      return 1;
  return 0;
}

/* Pictures of codes. */
#define CODED "picture=.png|picture=.npy|picture=.npz"

static int run_judge(cli_session *session, int argc, char **argv) {
  static const char *const transfers[] = {"linear", "srgb", NULL}, *const roundings[] = {"either", "nearest", "down",
                                                                                         NULL};
  cli_judge_job job = {.floats = CONIC_FLOATS_FAST, .argc = argc, .argv = argv};
  int rounding = CONIC_CODES_EITHER;
  suite_run suite = {.most_level = 0}; /* unused here: its options are for the help */
  if (names_option(session, argc, argv, "--suite"))
    return cli_suite_run(session, argc, argv);
  if (names_option(session, argc, argv, "--intermediates"))
    return cli_intermediates_run(session, argc, argv);
  cli_gradient_files gradients = {NULL}; /* unused here, as is the next */
  const char *intermediates = NULL;
  if (names_option(session, argc, argv, "--gradients"))
    return cli_gradients_run(session, argc, argv);
  conic_picture_options_init(&job.reading);
  cli_scene_defaults(&job.scene);
  const cli_option own[] = {
      {"picture", CLI_TEXT, &job.picture_path, "FILE",
       "what is judged: EXR, PFM or NPY (with planes beside it, P.Z.npy …), NPZ, or PNG"},
      {"floats", CLI_CHOICE, &job.floats, "KIND",
       "of what drew it: own (conic's), strict (all in float, in any order), or fast (and a GPU's fast exponential) "
       "[fast]",
       .choices = cli_float_words},
      {"max-wrong", CLI_COUNT, &job.max_wrong, "N", "so many pixels may be wrong [0]", 0, 4294836225.0},
      {"pixels", CLI_COUNT, &job.n_pixels, "N", "judge this many pixels, spread evenly; always the same ones [all]",
       .minimum = 1, .maximum = 4294836225.0},
      {"map", CLI_TEXT, &job.map_path, "FILE", "the class of every pixel in false colours, with a legend"},
      {"report", CLI_TEXT, &job.report_path, "FILE.html", "a page with all that was found, pictures and all"},
      {"transfer", CLI_CHOICE, &job.transfer, "HOW",
       "codes of 8 or 16 bits: linear (code / 255) or srgb (decoded) [linear of Gaussian scenes, else srgb]",
       .choices = transfers, .is_given = &job.is_transfer_given, .acts.with = CODED},
      {"codes", CLI_CHOICE, &rounding, "HOW", "codes were rounded to the nearest, down, or either [either]",
       .choices = roundings, .acts.with = CODED},
      {"clipped", CLI_FLAG, &job.reading.is_clipped, NULL,
       "colours of 0 and 1 stand for what is beyond, in floats, too", .acts.with = "!picture=.png"},
      {"straight", CLI_FLAG, &job.reading.is_straight, NULL,
       "colours are not multiplied by alpha; of a PNG they never are", .acts.with = "!picture=.png"},
      {"no-diagnosis", CLI_FLAG, &job.skips_diagnosis, NULL,
       "don't look for the mistake that explains wrong pixels, which may take longer than judging them",
       .acts.is_work = 1},
      {"allow-vague", CLI_FLAG, &job.allows_vague, NULL,
       "a picture may be right although more than 1 % of its pixels may be anything within more than 1/255"},
      {"time", CLI_FLAG, &job.shows_times, NULL, "print what each stage took", .acts.is_work = 1},
      CLI_SUITE_OPTIONS(suite),
      CLI_GRADIENT_OPTIONS(gradients),
      CLI_INTERMEDIATES_OPTION(intermediates),
  };
  int exit_code = cli_scene_parse(session, own, (int)(sizeof own / sizeof own[0]), argc, argv, &job.scene);
  job.reading.rounding = (conic_code_rounding)rounding;
  if (exit_code == CLI_DONE)
    exit_code = check_judge(session, &job);
  return cli_scene_run(session, exit_code, &job.scene, judge_scene, &job);
}

const cli_command cli_judge = {
    .name = "judge",
    .summary = "says whether a picture that somebody drew is right, and where not",
    .usage = "conic judge SCENE --camera C [--view V] --picture P [--profile NAME | --method M] [--json FILE] "
             "[--report F.html] [--map F.png] [--max-wrong N] [camera and render options]\n"
             "       conic judge SCENE --camera C --weights W.exr --gradients G.ply --profile NAME [--raw]\n"
             "       conic judge SCENE --camera C --intermediates MINE.npz --profile NAME\n"
             "       conic judge --suite FOLDER --pictures FOLDER [--profile NAMES] [--junit FILE]",
    .run = run_judge,
    .description = "Takes a picture that any renderer drew of the scene, bounds what each pixel can be at most and at "
                   "least, and says of every pixel whether it is equal, within rounding, explained by a decision that "
                   "may go either way, or wrong; and, where it is wrong, which fault explains it. --suite judges the "
                   "pictures of a whole suite, which conic conformance writes.",
    .examples = {{"judge a picture that gsplat 1.6 has drawn, and write a report",
                  "conic judge scene.ply --camera sparse/0 --view 0 --picture theirs.npy --profile gsplat-1.6 "
                  "--report report.html"},
                 {"judge the pictures of a suite, for a CI system",
                  "conic judge --suite suite --pictures mine --profile gsplat-1.6 --junit report.xml"}},
};
