/* conic chart: every method and kernel on every scene, every representation of a mesh, every profile of a Gaussian
 * scene, or any scene along its options: its error over its time. */
#include "bench/chart.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bench/bench.h"
#include "bench/chart_axes.h"
#include "bench/chart_gaussians.h"
#include "bench/chart_mesh.h"
#include "cli/arguments.h"
#include "cli/command.h"
#include "cli/json_write.h"
#include "cli/outputs.h"
#include "core/files/disk.h"
#include "core/files/file.h"
#include "core/image/image_common.h"

/* A kernel of the chart. */
typedef struct chart_kernel {
  conic_kernel_type type;
  float cutoff;
  int window; /* edge of the oracle's window in pixels; 0: its integrals take too long */
} chart_kernel;

/* Kernels with edges are a hundred times slower to integrate, the box a thousand. */
static const chart_kernel kernels[] = {{CONIC_KERNEL_GAUSS, 1.5f, 32}, {CONIC_KERNEL_GAUSS, 2.0f, 32},
                                       {CONIC_KERNEL_GAUSS, 3.0f, 32}, {CONIC_KERNEL_HAT, 1.5f, 10},
                                       {CONIC_KERNEL_HAT, 3.0f, 10},   {CONIC_KERNEL_CONFETTI, 1.5f, 10},
                                       {CONIC_KERNEL_BOX, 1.5f, 0},    {CONIC_KERNEL_CONFETTI, 3.0f, 10}};

enum { N_KERNELS = sizeof kernels / sizeof kernels[0] };
enum { N_POINTS = N_KERNELS * CONIC_N_METHODS * CLI_N_CHART_SCENES };

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
  conic_renderer *renderer;
  int size, repeat; /* of the pictures, and frames that are timed */
  cli_chart_point points[N_POINTS];
  int n_points;
} chart_job;

/* A scene as one kernel draws it. */
typedef struct chart_view {
  const cli_chart_scene *scene;
  conic_splats splats;
  conic_camera camera;
  conic_image truth;
  unsigned char *is_inside;
} chart_view;

static conic_status make_splats(conic_context *context, const cli_chart_scene *scene, float cutoff, conic_splats *to) {
  conic_scene_options options;
  conic_scene *made;
  conic_scene_options_init(&options);
  options.type = scene->type;
  options.count = scene->n_splats;
  options.cutoff = cutoff;
  conic_status status =
      conic_splats_allocate(context, scene->n_splats, CONIC_SPLATS_TANGENTS | CONIC_SPLATS_COLORS, to);
  if (status == CONIC_OK)
    status = conic_scene_create(context, &options, &made);
  if (status != CONIC_OK)
    return status;
  status = conic_scene_sample(made, 0, scene->n_splats, to);
  conic_scene_destroy(made);
  return status;
}

static conic_status frame(const chart_job *job, chart_view *view) {
  conic_framing framing;
  double low[3], high[3];
  conic_framing_init(&framing);
  framing.width = framing.height = job->size;
  framing.azimuth_deg = view->scene->azimuth_deg;
  framing.elevation_deg = view->scene->elevation_deg;
  framing.zoom = view->scene->zoom;
  conic_splats_bounds(&view->splats, low, high);
  return conic_camera_frame(job->session->context, &framing, low, high, &view->camera);
}

static conic_render_options options_of(const cli_chart_point *point) {
  conic_render_options options;
  conic_render_options_init(&options);
  options.method = point->method;
  options.kernel = point->kernel;
  options.shading = CONIC_SHADE_NONE;
  return options;
}

/* The fastest of the frames after the first, which others on the machine have disturbed the least. */
static conic_status time_frames(const chart_job *job, const chart_view *view, const conic_render_options *options,
                                conic_image *image, cli_chart_point *point) {
  conic_render_options measured = *options;
  measured.near_z = conic_default_near(&view->splats);
  conic_status status = conic_splats_length(job->session->context, &view->splats, &measured.splat_length);
  for (int i = 0; i <= job->repeat && status == CONIC_OK; i++) {
    conic_render_statistics s;
    status = conic_render(job->renderer, &view->splats, &view->camera, &measured, image, &s);
    if (status != CONIC_OK)
      break;
    if (i == 1 || (i > 1 && s.ms.frame < point->ms))
      point->ms = s.ms.frame;
    point->fragments = (size_t)s.fragments;
  }
  return status;
}

/* Clears the pixels of both that are outside; returns how many are left. */
static size_t clear_outside(conic_image *a, conic_image *b, const unsigned char *is_inside) {
  float *a_pixel = a->planes[CONIC_PLANE_RGBA], *b_pixel = b->planes[CONIC_PLANE_RGBA];
  size_t n = conic_image_pixels(a), n_inside = 0;
  for (size_t i = 0; i < n; i++) {
    n_inside += is_inside[i];
    for (size_t c = 4 * i; c < 4 * i + 4 && !is_inside[i]; c++)
      a_pixel[c] = b_pixel[c] = 0.0f;
  }
  return n_inside;
}

static conic_status copy_color(conic_context *context, const conic_image *from, conic_image *to) {
  conic_status status = conic_image_allocate(context, from->width, from->height, 1u << CONIC_PLANE_RGBA, to);
  if (status == CONIC_OK)
    memcpy(to->planes[CONIC_PLANE_RGBA], from->planes[CONIC_PLANE_RGBA],
           (size_t)from->width * (size_t)from->height * 4 * sizeof(float));
  return status;
}

/* Against the surface; holes are looked for wherever it is seen from inside its outline. */
static conic_status compare_truth(conic_context *context, const chart_view *view, conic_image *image,
                                  cli_chart_point *point) {
  conic_difference difference;
  conic_image truth;
  const float *seen = view->truth.planes[CONIC_PLANE_RGBA], *drawn = image->planes[CONIC_PLANE_RGBA];
  conic_status status = conic_image_compare(context, &view->truth, image, &difference);
  if (status == CONIC_OK)
    status = copy_color(context, &view->truth, &truth);
  if (status != CONIC_OK)
    return status;
  point->largest_hole = difference.largest_hole;
  for (size_t i = 0; i < (size_t)image->width * (size_t)image->height; i++)
    point->holes += seen[4 * i + 3] > 0.0f && drawn[4 * i + 3] == 0.0f;
  size_t n_inside = clear_outside(&truth, image, view->is_inside);
  status = cli_chart_measure(context, &truth, image, n_inside, &point->truth);
  conic_image_release(context, &truth);
  return status;
}

/* A window of the picture, to the right of its middle. */
static conic_camera window_of(const conic_camera *camera, int edge) {
  conic_camera window = *camera;
  window.width = window.height = edge;
  int left = camera->width * 3 / 4 - edge / 2, top = camera->height / 2 - edge / 2;
  window.cx -= (double)left;
  window.cy -= (double)top;
  return window;
}

static conic_status compare_reference(conic_context *context, const conic_reference *reference, conic_image *image,
                                      cli_chart_point *point) {
  conic_image exact;
  conic_status status = conic_image_allocate(context, image->width, image->height, 1u << CONIC_PLANE_RGBA, &exact);
  if (status != CONIC_OK)
    return status;
  for (size_t i = 0; i < (size_t)image->width * (size_t)image->height * 4; i++)
    ((float *)exact.planes[CONIC_PLANE_RGBA])[i] = (float)reference->planes[CONIC_PLANE_RGBA][i];
  status = cli_chart_measure(context, &exact, image, conic_image_pixels(image), &point->oracle);
  point->weight_max = reference->weight_error.max_abs;
  conic_image_release(context, &exact);
  return status;
}

/* Against the exact kernel, in a window: the oracle is slow. */
static conic_status compare_oracle(const chart_job *job, const chart_view *view, const conic_render_options *options,
                                   int edge, cli_chart_point *point) {
  conic_context *context = job->session->context;
  conic_camera window = window_of(&view->camera, edge);
  conic_reference reference;
  conic_image image;
  conic_status status = conic_image_allocate(context, edge, edge, 1u << CONIC_PLANE_RGBA, &image);
  if (status != CONIC_OK)
    return status;
  status = conic_render(job->renderer, &view->splats, &window, options, &image, NULL);
  if (status == CONIC_OK)
    status = conic_oracle_render(context, &view->splats, &window, options, CONIC_ORACLE_EXACT, &reference);
  if (status == CONIC_OK) {
    status = compare_reference(context, &reference, &image, point);
    conic_reference_release(context, &reference);
  }
  conic_image_release(context, &image);
  return status;
}

static conic_status measure_point(chart_job *job, const chart_view *view, const chart_kernel *kernel,
                                  conic_method method) {
  conic_context *context = job->session->context;
  cli_chart_point *point = &job->points[job->n_points];
  conic_image image;
  point->scene = view->scene;
  point->method = method;
  point->kernel = (conic_kernel){kernel->type, kernel->cutoff, 4.0f, kernel->cutoff, 5}; /* Confetti ends there, too */
  conic_render_options options = options_of(point);
  conic_status status = conic_image_allocate(context, job->size, job->size, 1u << CONIC_PLANE_RGBA, &image);
  if (status != CONIC_OK)
    return status;
  status = time_frames(job, view, &options, &image, point);
  if (status == CONIC_OK)
    status = compare_truth(context, view, &image, point);
  conic_image_release(context, &image);
  int edge = job->is_quick && kernel->window > 6 ? 6 : kernel->window;
  int is_of_the_kernel = options.method != CONIC_METHOD_POINT && options.method != CONIC_METHOD_DISC;
  if (status == CONIC_OK && edge > 0 && is_of_the_kernel)
    status = compare_oracle(job, view, &options, edge, point);
  job->n_points += status == CONIC_OK;
  return status;
}

static conic_status measure_kernel(chart_job *job, chart_view *view, const chart_kernel *kernel) {
  conic_context *context = job->session->context;
  memset(&view->splats, 0, sizeof view->splats);
  conic_status status = make_splats(context, view->scene, kernel->cutoff, &view->splats);
  if (status == CONIC_OK)
    status = frame(job, view);
  if (status == CONIC_OK && !view->is_inside) {
    view->is_inside = calloc((size_t)job->size, (size_t)job->size);
    status = view->is_inside ? cli_chart_truth(context, view->scene, &view->camera, &view->truth, view->is_inside)
                             : CONIC_ERROR_MEMORY;
  }
  for (int method = 0; method < CONIC_N_METHODS && status == CONIC_OK; method++)
    status = measure_point(job, view, kernel, (conic_method)method);
  conic_splats_release(context, &view->splats);
  return status;
}

static conic_status measure_scene(chart_job *job, const cli_chart_scene *scene) {
  chart_view view = {.scene = scene};
  conic_status status = CONIC_OK;
  for (int i = 0; i < N_KERNELS && status == CONIC_OK; i++)
    if (!job->is_quick || i == 0 || kernels[i].window == 0)
      status = measure_kernel(job, &view, &kernels[i]);
  conic_image_release(job->session->context, &view.truth);
  free(view.is_inside);
  return status;
}

/* Which points no other of their scene beats in both time and error. */
static void find_fronts(chart_job *job) {
  for (int which = 0; which < 2; which++)
    for (int i = 0; i < job->n_points; i++) {
      cli_chart_point *p = &job->points[i];
      p->is_front[which] = cli_chart_error_of(p, which)->is_measured;
      for (int k = 0; k < job->n_points && p->is_front[which]; k++) {
        const cli_chart_point *q = &job->points[k];
        if (q != p && q->scene == p->scene && cli_chart_error_of(q, which)->is_measured && q->ms <= p->ms &&
            cli_chart_error_of(q, which)->rmse <= cli_chart_error_of(p, which)->rmse)
          p->is_front[which] = 0;
      }
    }
}

static conic_status write_table(const chart_job *job) {
  conic_output *output;
  conic_status status = cli_chart_open(job->session, job->folder, "chart.csv", &output);
  if (status != CONIC_OK)
    return status;
  FILE *to = conic_output_stream(output);
  fputs("scene,splats,width,height,method,kernel,cutoff,ms,msplats_per_s,fragments,oracle_max,oracle_rmse,oracle_psnr,"
        "oracle_flip,oracle_weight_max,oracle_front,scene_max,scene_rmse,scene_psnr,scene_flip,holes,largest_hole,"
        "scene_front\n",
        to);
  for (int i = 0; i < job->n_points; i++) {
    const cli_chart_point *p = &job->points[i];
    fprintf(to, "\"%s\",%zu,%d,%d,%s,%s,%g,%.4f,%.4f,%zu", p->scene->name, p->scene->n_splats, job->size, job->size,
            conic_method_name(p->method), conic_kernel_type_name(p->kernel.type), (double)p->kernel.cutoff, p->ms,
            p->ms > 0.0 ? (double)p->scene->n_splats / p->ms * 1e-3 : 0.0, p->fragments);
    cli_chart_write_error(to, &p->oracle);
    if (p->oracle.is_measured)
      fprintf(to, ",%.6g", p->weight_max);
    else
      fputs(",", to);
    fprintf(to, ",%d", p->is_front[0]);
    cli_chart_write_error(to, &p->truth);
    fprintf(to, ",%zu,%zu,%d\n", p->holes, p->largest_hole, p->is_front[1]);
  }
  return conic_output_commit(output);
}

static void print_fronts(const chart_job *job) {
  static const char *const against[] = {"the exact kernel", "the surface"};
  for (int which = 0; which < 2; which++) {
    printf("best for their time, against %s:\n", against[which]);
    for (int i = 0; i < job->n_points; i++) {
      const cli_chart_point *p = &job->points[i];
      if (p->is_front[which])
        printf("  %-26s %-8s %-8s %-4g %8.2f ms  rmse %.3g\n", p->scene->name, conic_method_name(p->method),
               conic_kernel_type_name(p->kernel.type), (double)p->kernel.cutoff, p->ms,
               cli_chart_error_of(p, which)->rmse);
    }
  }
}

static conic_status measure_all(chart_job *job) {
  conic_status status = CONIC_OK;
  if (job->only != ONLY_METHODS)
    status = cli_mesh_chart_measure(job->session, &job->mesh);
  if (status != CONIC_OK || job->only == ONLY_REPRESENTATIONS)
    return status;
  status = conic_renderer_create(job->session->context, &job->renderer);
  for (int i = 0; i < CLI_N_CHART_SCENES && status == CONIC_OK; i++)
    status = measure_scene(job, &cli_chart_scenes[i]);
  conic_renderer_destroy(job->renderer);
  find_fronts(job);
  return status;
}

static conic_status write_tables(const chart_job *job) {
  conic_status status = CONIC_OK;
  if (job->only != ONLY_METHODS)
    status = cli_mesh_chart_write(job->session, job->folder, &job->mesh);
  return status == CONIC_OK && job->only != ONLY_REPRESENTATIONS ? write_table(job) : status;
}

static conic_status draw_charts(const chart_job *job) {
  conic_status status = CONIC_OK;
  if (job->only != ONLY_METHODS)
    status = cli_mesh_chart_draw(job->session, job->folder, &job->mesh);
  if (status == CONIC_OK && job->only != ONLY_REPRESENTATIONS)
    status = cli_chart_draw(job->session, job->folder, job->points, job->n_points);
  return status;
}

static int is_told(const cli_session *session) {
  return !session->is_quiet && (!session->json_path || strcmp(session->json_path, "-") != 0);
}

static int write_all(const chart_job *job) {
  conic_status status = write_tables(job);
  if (status == CONIC_OK)
    status = draw_charts(job);
  if (status != CONIC_OK || !is_told(job->session))
    return cli_exit_of(status);
  if (job->only != ONLY_REPRESENTATIONS)
    print_fronts(job);
  if (job->only != ONLY_METHODS)
    cli_mesh_chart_print(&job->mesh);
  return CLI_DONE;
}

static int write_statistics(const chart_job *job, double seconds) {
  int exit_code = CLI_DONE;
  cli_json_file *file;
  cli_json *json = cli_json_open(job->session, &file, &exit_code);
  if (!json)
    return exit_code;
  const int n_named = job->gaussians.path ? 1 : job->scenes.n_paths;
  cli_json_count(json, "scenes", (uint64_t)(n_named ? n_named : CLI_N_CHART_SCENES));
  cli_json_count(json, "methods", n_named ? 0 : CONIC_N_METHODS);
  cli_json_count(json, "points", (uint64_t)(job->n_points + job->scenes.n_points));
  cli_json_count(json, "representation_points", (uint64_t)job->mesh.n_sizes * CLI_N_CHART_MODELS);
  if (job->gaussians.path)
    cli_gaussian_chart_report(json, &job->gaussians);
  cli_json_number(json, "seconds", seconds);
  cli_json_count(json, "threads", (uint64_t)conic_context_threads(job->session->context));
  cli_json_count(json, "peak_rss_bytes", cli_peak_rss_bytes());
  return cli_json_finish(file);
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
  if (is_told(job->session))
    cli_gaussian_chart_print(&job->gaussians);
  return CLI_DONE;
}

static int chart_scenes(chart_job *job) {
  int exit_code = cli_axis_chart_measure(job->session, &job->scenes);
  if (exit_code == CLI_DONE)
    exit_code = cli_exit_of(cli_axis_chart_write(job->session, job->folder, &job->scenes));
  if (exit_code == CLI_DONE && is_told(job->session))
    cli_axis_chart_print(&job->scenes);
  return exit_code;
}

static int chart_methods(chart_job *job) {
  conic_status status = measure_all(job);
  return status == CONIC_OK ? write_all(job) : cli_exit_of(status);
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
    job->gaussians.size[i] = job->gaussians.size[i] ? job->gaussians.size[i] : job->size;
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
       "each perhaps with =VALUE:VALUE... [what fits]"},
      {"beside", CLI_PARSED, &job->scenes.beside, "NAME=MS:PICTURE",
       "another program's picture of the first SCENE, and the milliseconds that it took; may be given again",
       .parse = cli_chart_parse_beside, .may_repeat = 1},
      {"shade", CLI_CHOICE, &shading, "MODEL", "of a SCENE: none, lambert, phong [phong]", .choices = shading_words},
      {"truth", CLI_INT, &job->scenes.truth_samples, "N",
       "samples along a pixel's edge in the picture that a SCENE's are compared with [8]", 1, CONIC_MAX_SAMPLES},
      {"camera", CLI_TEXT, &job->gaussians.camera_path, "FILE", "of a SCENE [framed as by conic render]"},
      {"view", CLI_TEXT, &job->gaussians.view, "VIEW", "which of its cameras: a name or an index"},
      {"size", CLI_SIZE, job->gaussians.size, "WxH", "of a SCENE's pictures [640x640]", 1, 65535},
      {"pixels", CLI_INT, &job->gaussians.most_pixels, "N",
       "of a Gaussian SCENE: where to find the truth, which is slow, at most [1000]", 1, 1 << 24},
  };
  int exit_code =
      cli_parse(session, options, sizeof options / sizeof options[0], argc, argv, positional, &n_positional);
  if (exit_code == CLI_DONE && n_positional && (job->only >= 0 || job->mesh.path))
    exit_code = cli_usage("chart: of a scene there is one chart, without --only and --mesh");
  else if (exit_code == CLI_DONE && !n_positional && job->scenes.over)
    exit_code = cli_usage("chart: --over is for scenes; name one");
  else if (exit_code == CLI_DONE && !job->folder)
    exit_code = cli_usage("chart: no folder; give one with -o DIR");
  else if (exit_code == CLI_DONE)
    exit_code = cli_check_outputs(session, NULL, 0);
  job->size = job->is_quick ? 96 : 640;
  job->repeat = job->is_quick ? 2 : 15;
  job->mesh.is_quick = job->gaussians.is_quick = job->is_quick;
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
