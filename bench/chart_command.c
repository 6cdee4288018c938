/* conic chart: every method and kernel on scenes whose surface is known, every profile of a Gaussian scene, or any
 * scene along the options of conic render: error over time. */

#include "bench/bench.h"
#include "bench/chart_axes.h"
#include "bench/chart_gaussians.h"
#include "bench/chart_job.h"
#include "bench/chart_methods.h"
#include "cli/command.h"
#include "cli/outputs.h"
#include "core/files/disk.h"

typedef struct chart_job {
  cli_session *session;
  cli_chart_options own;
  cli_render_job scene;         /* as the arguments have it */
  cli_gaussian_chart gaussians; /* with a path, it is all that is charted */
  cli_axis_chart scenes;        /* likewise */
  cli_method_chart methods;
} chart_job;

static int write_statistics(const chart_job *job, double seconds) {
  cli_json *json;
  int exit_code = cli_json_open(job->session, &json);
  if (!json)
    return exit_code;
  const int n_named = job->scene.n_inputs;
  cli_json_count(json, "scenes", (uint64_t)(n_named ? n_named : CLI_N_CHART_SCENES));
  cli_json_count(json, "methods", n_named ? 0 : CONIC_N_METHODS);
  cli_json_count(json, "points", (uint64_t)job->methods.n_points + (uint64_t)job->scenes.n_points);
  cli_json_count(json, "representation_points", (uint64_t)cli_axis_count_of(&job->scenes, "as"));
  if (cli_axis_in_time(&job->scenes)) {
    char line[1024];
    cli_axis_command(&job->scenes, cli_axis_in_time(&job->scenes), line, sizeof line);
    cli_json_text(json, "in_time", line);
  }
  if (job->gaussians.path)
    cli_gaussian_chart_report(json, &job->gaussians);
  cli_json_number(json, "seconds", seconds);
  cli_json_count(json, "threads", (uint64_t)conic_context_threads(job->session->context));
  cli_json_count(json, "peak_rss_bytes", cli_peak_rss_bytes());
  return cli_json_finish(json);
}

static int make_folder(const char *path) {
  conic_disk_entry found;
  if (conic_disk_make_folder(path) || (errno == EEXIST && conic_disk_look(path, &found) && found.is_folder))
    return CLI_DONE;
  return cli_error(CLI_RESOURCE, "%s: cannot make the folder: %s", path, strerror(errno));
}

static int chart_gaussians(chart_job *job) {
  conic_status status = cli_gaussian_chart_measure(job->session, &job->gaussians);
  if (status == CONIC_OK)
    status = cli_gaussian_chart_write(job->session, job->own.folder, &job->gaussians);
  if (status != CONIC_OK)
    return cli_exit_of(status);
  if (cli_json_leaves_text(job->session))
    cli_gaussian_chart_print(&job->gaussians);
  return CLI_DONE;
}

static int chart_scenes(chart_job *job) {
  int exit_code = cli_axis_chart_measure(job->session, &job->scenes);
  if (exit_code == CLI_DONE)
    exit_code = cli_exit_of(cli_axis_chart_write(job->session, job->own.folder, &job->scenes));
  if (exit_code == CLI_DONE && cli_json_leaves_text(job->session))
    cli_axis_chart_print(&job->scenes);
  return exit_code;
}

static int chart_methods(chart_job *job) {
  conic_status status = cli_method_chart_measure(job->session, &job->methods);
  if (status == CONIC_OK)
    status = cli_method_chart_write(job->session, job->own.folder, &job->methods);
  if (status == CONIC_OK && cli_json_leaves_text(job->session))
    cli_method_chart_print(&job->methods);
  return cli_exit_of(status);
}

static int chart(chart_job *job) {
  double start = cli_seconds();
  job->session->draws_many_frames = 1;
  int exit_code = cli_session_open(job->session);
  if (exit_code == CLI_DONE)
    exit_code = make_folder(job->own.folder);
  if (exit_code != CLI_DONE)
    return exit_code;
  exit_code = job->gaussians.path          ? chart_gaussians(job)
              : job->scenes.asked.n_scenes ? chart_scenes(job)
                                           : chart_methods(job);
  return exit_code == CLI_DONE ? write_statistics(job, cli_seconds() - start) : exit_code;
}

int cli_chart_parse(cli_session *session, int argc, char **argv, cli_render_job *scene, cli_chart_options *own) {
  cli_chart_options dropped;
  if (!own)
    own = &dropped;
  *own = (cli_chart_options){.truth_samples = 8, .most_pixels = 1000};
  cli_scene_defaults(scene);
  scene->may_lack_inputs = 1;
  scene->effects.is_strict = own == &dropped;
  scene->shot.planes = 1u << CONIC_PLANE_RGBA;
  const cli_option options[] = {
      {"o", CLI_TEXT, &own->folder, "DIR", "the folder of the chart"},
      {"over", CLI_TEXT, &own->over, "AXES",
       "of a SCENE: options of conic render, with commas between, each perhaps with =VALUE:VALUE..., or several whose "
       "values are combined, as as=mesh:hybrid+error=1:2 [what fits]",
       .acts.with = "@"},
      {"time", CLI_NUMBER, &own->most_seconds, "SECONDS",
       "of a SCENE: also say the command whose picture is the nearest of those that take no longer", 1e-6, 1e6,
       .acts.with = "@"},
      {"quick", CLI_FLAG, &own->is_quick, NULL, "a small chart in seconds, to try it"},
      {"beside", CLI_PARSED, &own->beside, "NAME=MS:PICTURE",
       "another program's picture of the first SCENE, and the milliseconds that it took; may be given again",
       .parse = cli_chart_parse_beside, .may_repeat = 1, .acts.with = "@"},
      {"truth", CLI_INT, &own->truth_samples, "N",
       "samples along a pixel's edge in the picture that a SCENE's are compared with [8]", 1, CONIC_MAX_SAMPLES,
       .acts.with = "@"},
      {"pixels", CLI_INT, &own->most_pixels, "N",
       "of a Gaussian SCENE: where to find the truth, which is slow, at most [1000]", 1, 1 << 24, .acts.with = "@"},
      {"accumulate", CLI_COUNT, &scene->accumulating.n_samples, "N", "of a SCENE: as conic render has it", .minimum = 1,
       .maximum = 65536, .acts.with = "@"},
      /* An old spelling. */
      {"mesh", CLI_TEXT, &own->mesh, "MESH", "a SCENE", .now = "MESH --over as"},
  };
  return cli_scene_parse(session, options, sizeof options / sizeof options[0], argc, argv, scene);
}

/* Options that the kind of chart has no use for. */
static int check_kind(const chart_job *job) {
  static const char *const sceneless[] = {"o", "quick", NULL};
  static const char *const of_profiles[] = {"o", "quick", "pixels", "camera", "view", "size", NULL};
  const int is_sceneless = !job->scene.n_inputs;
  const char *const *known = is_sceneless ? sceneless : of_profiles;
  for (int i = 0; i < job->scene.effects.n_given; i++) {
    const cli_given *given = &job->scene.effects.given[i];
    int k = 0;
    while (known[k] && strcmp(known[k], given->name) != 0)
      k++;
    const int is_for_profiles = strcmp(given->name, "pixels") == 0;
    if (!is_sceneless && !job->gaussians.path ? is_for_profiles : !known[k])
      return cli_usage("chart: %s%s has no effect: %s", given->dashes, given->name,
                       is_sceneless      ? "it is of a SCENE, and none is named"
                       : is_for_profiles ? "it is of a Gaussian SCENE alone, without --over"
                                         : "a Gaussian SCENE alone is charted by its profiles; give --over, too");
  }
  return CLI_DONE;
}

/* The arguments without the old --only methods or representations, which says what else is known; whether it was there.
 * `now` has room for all. */
static int leave_out_only(int argc, char **argv, char **now, int *n) {
  for (int i = *n = 0; i < argc; i++) {
    const char *only = strcmp(argv[i], "--only") == 0 && i + 1 < argc        ? argv[i + 1]
                       : strncmp(argv[i], "--only=", strlen("--only=")) == 0 ? argv[i] + strlen("--only=")
                                                                             : "";
    if (strcmp(only, "methods") != 0 && strcmp(only, "representations") != 0)
      now[(*n)++] = argv[i];
    else
      i += argv[i][strlen("--only")] == 0;
  }
  return *n < argc;
}

/* Reads the arguments. The old spelling of a mesh is a SCENE that is drawn as what it can be. */
static int read_arguments(chart_job *job, int argc, char **argv, char **now, int *n) {
  static char over[] = "--over", as[] = "as";
  const int has_only = leave_out_only(argc, argv, now, n);
  int exit_code = cli_chart_parse(job->session, *n, now, &job->scene, &job->own);
  if (exit_code != CLI_DONE)
    return exit_code;
  if (job->scene.n_inputs && (has_only || job->own.mesh))
    return cli_usage("chart: of a SCENE there is one chart, without another mesh and --only");
  if (!job->own.mesh)
    return CLI_DONE;
  now[(*n)++] = job->own.mesh;
  now[(*n)++] = over;
  now[(*n)++] = as;
  free(job->scene.inputs);
  return cli_chart_parse(job->session, *n, now, &job->scene, &job->own);
}

/* A Gaussian scene alone is charted by its profiles. */
static void take_scenes(chart_job *job, int argc, char **argv) {
  const cli_chart_options *own = &job->own;
  const cli_render_job *scene = &job->scene;
  job->methods.is_quick = job->gaussians.is_quick = own->is_quick;
  job->gaussians.camera_path = scene->camera_path;
  job->gaussians.view = scene->view_name;
  for (int i = 0; i < 2; i++)
    job->gaussians.size[i] = scene->camera_size[i] ? scene->camera_size[i] : own->is_quick ? 96 : 1024;
  job->gaussians.most_pixels = own->most_pixels;
  if (scene->n_inputs == 1 && !own->over && !own->beside.n && cli_bench_is_gaussian_file(scene->inputs[0])) {
    job->gaussians.path = scene->inputs[0];
    return;
  }
  job->scenes.truth_samples = own->truth_samples;
  job->scenes.most_seconds = own->most_seconds;
  job->scenes.asked = (cli_chart_asked){.argc = argc,
                                        .argv = argv,
                                        .is_quick = own->is_quick,
                                        .scenes = scene->inputs,
                                        .n_scenes = scene->n_inputs,
                                        .over = own->over,
                                        .beside = own->beside};
}

static int run_chart(cli_session *session, int argc, char **argv) {
  chart_job *job = calloc(1, sizeof *job);
  if (!job)
    return cli_error(CLI_RESOURCE, "chart: out of memory");
  char *now[argc + 3];
  int n_now;
  job->session = session;
  int exit_code = read_arguments(job, argc, argv, now, &n_now);
  if (exit_code == CLI_DONE) {
    take_scenes(job, n_now, now);
    exit_code = check_kind(job);
  }
  if (exit_code == CLI_DONE && !job->own.folder)
    exit_code = cli_usage("chart: no folder; give one with -o DIR");
  if (exit_code == CLI_DONE)
    exit_code = cli_check_outputs(session, NULL, 0);
  if (exit_code == CLI_DONE)
    exit_code = chart(job);
  free(job->scenes.points);
  free(job->scene.inputs);
  free(job);
  return exit_code < 0 ? CLI_DONE : exit_code;
}

const cli_command cli_chart = {
    .name = "chart",
    .summary = "charts error over time: of methods and kernels, or of your own scenes in every way to draw them",
    .usage = "conic chart [SCENE...] -o DIR [--over AXES] [--time SECONDS] [--quick] [camera and render options]",
    .run = run_chart,
    .description = "Draws the same scenes in every way, measures time and error, and writes charts and tables into a "
                   "folder: what is best for its time. Of a SCENE, each axis is an option of conic render that trades "
                   "one for the other; all else is drawn as the other options say, with one sample a pixel. The "
                   "truth is the first SCENE in full detail, supersampled. A Gaussian SCENE alone is charted by its "
                   "profiles. Without a SCENE, it is methods and kernels on scenes whose surface is known.",
    .examples = {{"try it", "conic chart --quick -o chart"},
                 {"what a scan's level of detail costs and loses",
                  "conic chart scan.cot -o chart --over error=1:2:4:8,budget"},
                 {"how a mesh is drawn best in a tenth of a second",
                  "conic chart mesh.obj -o chart --over as=mesh:points:hybrid --time 0.1"}},
};
