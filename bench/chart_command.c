/* conic chart: every method and kernel on every scene, every representation of a mesh, every profile of a Gaussian
 * scene, or any scene along its options: its error over its time. */

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "bench/bench.h"
#include "bench/chart_axes.h"
#include "bench/chart_gaussians.h"
#include "bench/chart_mesh.h"
#include "bench/chart_methods.h"
#include "cli/arguments.h"
#include "cli/command.h"
#include "cli/json_write.h"
#include "cli/outputs.h"
#include "core/files/disk.h"

/* --only: one of the two charts. */
enum { ONLY_METHODS, ONLY_REPRESENTATIONS };
static const char *const shading_words[] = {"none", "lambert", "phong", NULL};
static const char *const only_words[] = {"methods", "representations", NULL};

typedef struct chart_job {
  cli_session *session;
  const char *folder;
  int is_quick, only; /* -1: both */
  cli_mesh_chart mesh;
  cli_gaussian_chart gaussians; /* with a path, it is all that is charted */
  cli_axis_chart scenes;        /* likewise */
  cli_method_chart methods;
} chart_job;

static int write_statistics(const chart_job *job, double seconds) {
  cli_json *json;
  int exit_code = cli_json_open(job->session, &json);
  if (!json)
    return exit_code;
  const int n_named = job->gaussians.path ? 1 : job->scenes.n_paths;
  cli_json_count(json, "scenes", (uint64_t)(n_named ? n_named : CLI_N_CHART_SCENES));
  cli_json_count(json, "methods", n_named ? 0 : CONIC_N_METHODS);
  cli_json_count(json, "points", (uint64_t)(job->methods.n_points + job->scenes.n_points));
  cli_json_count(json, "representation_points", (uint64_t)job->mesh.n_sizes * CLI_N_CHART_MODELS);
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
    status = cli_gaussian_chart_write(job->session, job->folder, &job->gaussians);
  if (status != CONIC_OK)
    return cli_exit_of(status);
  if (cli_json_leaves_text(job->session))
    cli_gaussian_chart_print(&job->gaussians);
  return CLI_DONE;
}

static int chart_scenes(chart_job *job) {
  int exit_code = cli_axis_chart_measure(job->session, &job->scenes);
  if (exit_code == CLI_DONE)
    exit_code = cli_exit_of(cli_axis_chart_write(job->session, job->folder, &job->scenes));
  if (exit_code == CLI_DONE && cli_json_leaves_text(job->session))
    cli_axis_chart_print(&job->scenes);
  return exit_code;
}

static int chart_methods(chart_job *job) {
  const int has_models = job->only != ONLY_METHODS, has_methods = job->only != ONLY_REPRESENTATIONS;
  conic_status status = has_models ? cli_mesh_chart_measure(job->session, &job->mesh) : CONIC_OK;
  if (status == CONIC_OK && has_methods)
    status = cli_method_chart_measure(job->session, &job->methods);
  if (status == CONIC_OK && has_models)
    status = cli_mesh_chart_write(job->session, job->folder, &job->mesh);
  if (status == CONIC_OK && has_methods)
    status = cli_method_chart_write(job->session, job->folder, &job->methods);
  if (status != CONIC_OK || !cli_json_leaves_text(job->session))
    return cli_exit_of(status);
  if (has_methods)
    cli_method_chart_print(&job->methods);
  if (has_models)
    cli_mesh_chart_print(&job->mesh);
  return CLI_DONE;
}

static int chart(chart_job *job) {
  double start = cli_seconds();
  job->session->draws_many_frames = 1;
  int exit_code = cli_session_open(job->session);
  if (exit_code != CLI_DONE)
    return exit_code;
  exit_code = make_folder(job->folder);
  if (exit_code != CLI_DONE)
    return exit_code;
  exit_code = job->gaussians.path       ? chart_gaussians(job)
              : job->scenes.n_paths > 0 ? chart_scenes(job)
                                        : chart_methods(job);
  return exit_code == CLI_DONE ? write_statistics(job, cli_seconds() - start) : exit_code;
}

/* A Gaussian scene alone is charted by its profiles. */
static void take_scenes(chart_job *job, const char *const *paths, int n_paths) {
  for (int i = 0; i < 2; i++) {
    job->gaussians.size[i] = job->gaussians.size[i] ? job->gaussians.size[i] : job->is_quick ? 96 : 640;
    job->scenes.size[i] = job->gaussians.size[i];
  }
  job->scenes.is_quick = job->is_quick;
  job->scenes.camera_path = job->gaussians.camera_path;
  job->scenes.view = job->gaussians.view;
  if (n_paths == 1 && !job->scenes.over && !job->scenes.beside.n && cli_bench_is_gaussian_file(paths[0])) {
    job->gaussians.path = paths[0];
    return;
  }
  job->scenes.paths = paths;
  job->scenes.n_paths = n_paths;
}

static int run_chart(cli_session *session, int argc, char **argv) {
  chart_job *job = calloc(1, sizeof *job);
  const char *positional[argc];
  int n_positional;
  if (!job)
    return cli_error(CLI_RESOURCE, "chart: out of memory");
  job->session = session;
  job->only = -1;
  job->gaussians.most_pixels = 1000;
  job->scenes.truth_samples = 8;
  int shading = CONIC_SHADE_PHONG;
  const cli_option options[] = {
      {"o", CLI_TEXT, &job->folder, "DIR", "the folder of the chart"},
      {"quick", CLI_FLAG, &job->is_quick, NULL, "a small chart in seconds, to try it"},
      {"only", CLI_CHOICE, &job->only, "CHART", "methods or representations [both]", .choices = only_words},
      {"mesh", CLI_TEXT, &job->mesh.path, "MESH", "whose representations are charted [a generated terrain]"},
      {"over", CLI_TEXT, &job->scenes.over, "AXES",
       "of a SCENE: method, kernel, prefilter, samples, passes, error, budget, as, isa, device; with commas between, "
       "each perhaps with =VALUE:VALUE... [what fits]",
       .acts.with = "@"},
      {"beside", CLI_PARSED, &job->scenes.beside, "NAME=MS:PICTURE",
       "another program's picture of the first SCENE, and the milliseconds that it took; may be given again",
       .parse = cli_chart_parse_beside, .may_repeat = 1, .acts.with = "@"},
      {"shade", CLI_CHOICE, &shading, "MODEL", "of a SCENE: none, lambert, phong [phong]", .choices = shading_words,
       .acts.with = "@"},
      {"truth", CLI_INT, &job->scenes.truth_samples, "N",
       "samples along a pixel's edge in the picture that a SCENE's are compared with [8]", 1, CONIC_MAX_SAMPLES,
       .acts.with = "@"},
      {"camera", CLI_TEXT, &job->gaussians.camera_path, "FILE", "of a SCENE [framed as by conic render]",
       .acts.with = "@"},
      {"view", CLI_TEXT, &job->gaussians.view, "VIEW", "which of its cameras: a name or an index",
       .acts.with = "camera"},
      {"size", CLI_SIZE, job->gaussians.size, "WxH", "of a SCENE's pictures [640x640]", 1, 65535, .acts.with = "@"},
      {"pixels", CLI_INT, &job->gaussians.most_pixels, "N",
       "of a Gaussian SCENE: where to find the truth, which is slow, at most [1000]", 1, 1 << 24, .acts.with = "@"},
  };
  int exit_code =
      cli_parse(session, options, sizeof options / sizeof options[0], argc, argv, positional, &n_positional);
  if (exit_code == CLI_DONE && n_positional && (job->only >= 0 || job->mesh.path))
    exit_code = cli_usage("chart: of a scene there is one chart, without --only and --mesh");
  else if (exit_code == CLI_DONE && !job->folder)
    exit_code = cli_usage("chart: no folder; give one with -o DIR");
  else if (exit_code == CLI_DONE)
    exit_code = cli_check_outputs(session, NULL, 0);
  job->methods.is_quick = job->mesh.is_quick = job->gaussians.is_quick = job->is_quick;
  job->scenes.shading = (conic_shading)shading;
  take_scenes(job, positional, exit_code == CLI_DONE ? n_positional : 0);
  if (exit_code == CLI_DONE && job->folder)
    exit_code = chart(job);
  free(job->scenes.points);
  free(job);
  return exit_code < 0 ? CLI_DONE : exit_code;
}

const cli_command cli_chart = {
    .name = "chart",
    .summary = "charts error over time: of methods and kernels, of what draws a mesh, or of your own scenes",
    .usage = "conic chart [SCENE...] -o DIR [--over AXES] [--only methods|representations] [--mesh MESH] [--quick]",
    .run = run_chart,
    .description = "Draws the same scenes in every way, measures time and error, and writes charts and tables into a "
                   "folder: what is best for its time. Of a SCENE, each axis is an option that trades one for the "
                   "other, and the truth is the first SCENE in full detail, supersampled. A Gaussian "
                   "SCENE alone is charted by its profiles.",
    .examples = {{"try it", "conic chart --quick -o chart"},
                 {"what a scan's level of detail costs and loses",
                  "conic chart scan.cot -o chart --over error=1:2:4:8,budget"}},
};
