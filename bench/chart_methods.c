/* Every method with every kernel on every scene: its time, its error against the exact kernel and against the surface.
 */
#include "bench/chart_methods.h"

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
_Static_assert((int)N_POINTS <= (int)CLI_MOST_METHOD_POINTS, "there is room for every point");

typedef struct method_job {
  cli_session *session;
  cli_method_chart *chart;
  conic_renderer *renderer;
} method_job;

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

static conic_status frame(const method_job *job, chart_view *view) {
  conic_framing framing;
  double low[3], high[3];
  conic_framing_init(&framing);
  framing.width = framing.height = job->chart->size;
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
static conic_status time_frames(const method_job *job, const chart_view *view, const conic_render_options *options,
                                conic_image *image, cli_chart_point *point) {
  conic_render_options measured = *options;
  measured.near_z = conic_default_near(&view->splats);
  conic_status status = conic_splats_length(job->session->context, &view->splats, &measured.splat_length);
  for (int i = 0; i <= job->chart->repeat && status == CONIC_OK; i++) {
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
static conic_status compare_oracle(const method_job *job, const chart_view *view, const conic_render_options *options,
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

static conic_status measure_point(method_job *job, const chart_view *view, const chart_kernel *kernel,
                                  conic_method method) {
  conic_context *context = job->session->context;
  cli_chart_point *point = &job->chart->points[job->chart->n_points];
  conic_image image;
  point->scene = view->scene;
  point->method = method;
  point->kernel = (conic_kernel){kernel->type, kernel->cutoff, 4.0f, kernel->cutoff, 5}; /* Confetti ends there, too */
  conic_render_options options = options_of(point);
  conic_status status =
      conic_image_allocate(context, job->chart->size, job->chart->size, 1u << CONIC_PLANE_RGBA, &image);
  if (status != CONIC_OK)
    return status;
  status = time_frames(job, view, &options, &image, point);
  if (status == CONIC_OK)
    status = compare_truth(context, view, &image, point);
  conic_image_release(context, &image);
  int edge = job->chart->is_quick && kernel->window > 6 ? 6 : kernel->window;
  int is_of_the_kernel = options.method != CONIC_METHOD_POINT && options.method != CONIC_METHOD_DISC;
  if (status == CONIC_OK && edge > 0 && is_of_the_kernel)
    status = compare_oracle(job, view, &options, edge, point);
  job->chart->n_points += status == CONIC_OK;
  return status;
}

static conic_status measure_kernel(method_job *job, chart_view *view, const chart_kernel *kernel) {
  conic_context *context = job->session->context;
  memset(&view->splats, 0, sizeof view->splats);
  conic_status status = make_splats(context, view->scene, kernel->cutoff, &view->splats);
  if (status == CONIC_OK)
    status = frame(job, view);
  if (status == CONIC_OK && !view->is_inside) {
    view->is_inside = calloc((size_t)job->chart->size, (size_t)job->chart->size);
    status = view->is_inside ? cli_chart_truth(context, view->scene, &view->camera, &view->truth, view->is_inside)
                             : CONIC_ERROR_MEMORY;
  }
  for (int method = 0; method < CONIC_N_METHODS && status == CONIC_OK; method++)
    status = measure_point(job, view, kernel, (conic_method)method);
  conic_splats_release(context, &view->splats);
  return status;
}

static conic_status measure_scene(method_job *job, const cli_chart_scene *scene) {
  chart_view view = {.scene = scene};
  conic_status status = CONIC_OK;
  for (int i = 0; i < N_KERNELS && status == CONIC_OK; i++)
    if (!job->chart->is_quick || i == 0 || kernels[i].window == 0)
      status = measure_kernel(job, &view, &kernels[i]);
  conic_image_release(job->session->context, &view.truth);
  free(view.is_inside);
  return status;
}

/* Which points no other of their scene beats in both time and error. */
static void find_fronts(cli_method_chart *chart) {
  for (int which = 0; which < 2; which++)
    for (int i = 0; i < chart->n_points; i++) {
      cli_chart_point *p = &chart->points[i];
      p->is_front[which] = cli_chart_error_of(p, which)->is_measured;
      for (int k = 0; k < chart->n_points && p->is_front[which]; k++) {
        const cli_chart_point *q = &chart->points[k];
        if (q != p && q->scene == p->scene && cli_chart_error_of(q, which)->is_measured && q->ms <= p->ms &&
            cli_chart_error_of(q, which)->rmse <= cli_chart_error_of(p, which)->rmse)
          p->is_front[which] = 0;
      }
    }
}

conic_status cli_method_chart_measure(cli_session *session, cli_method_chart *chart) {
  method_job job = {.session = session, .chart = chart};
  chart->size = chart->is_quick ? 96 : 640;
  chart->repeat = chart->is_quick ? 2 : 15;
  conic_status status = conic_renderer_create(session->context, &job.renderer);
  for (int i = 0; i < CLI_N_CHART_SCENES && status == CONIC_OK; i++)
    status = measure_scene(&job, &cli_chart_scenes[i]);
  conic_renderer_destroy(job.renderer);
  find_fronts(chart);
  return status;
}

static void write_method_table(FILE *to, const void *cookie) {
  const cli_method_chart *chart = cookie;
  fputs("scene,splats,width,height,method,kernel,cutoff,ms,msplats_per_s,fragments,oracle_max,oracle_rmse,oracle_psnr,"
        "oracle_flip,oracle_weight_max,oracle_front,scene_max,scene_rmse,scene_psnr,scene_flip,holes,largest_hole,"
        "scene_front\n",
        to);
  for (int i = 0; i < chart->n_points; i++) {
    const cli_chart_point *p = &chart->points[i];
    fprintf(to, "\"%s\",%zu,%d,%d,%s,%s,%g,%.4f,%.4f,%zu", p->scene->name, p->scene->n_splats, chart->size, chart->size,
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
}

conic_status cli_method_chart_write(const cli_session *session, const char *folder, const cli_method_chart *chart) {
  conic_status status = cli_chart_put(session, folder, "chart.csv", write_method_table, chart);
  return status == CONIC_OK ? cli_method_chart_draw(session, folder, chart) : status;
}

void cli_method_chart_print(const cli_method_chart *chart) {
  static const char *const against[] = {"the exact kernel", "the surface"};
  for (int which = 0; which < 2; which++) {
    printf("best for their time, against %s:\n", against[which]);
    for (int i = 0; i < chart->n_points; i++) {
      const cli_chart_point *p = &chart->points[i];
      if (p->is_front[which])
        printf("  %-26s %-8s %-8s %-4g %8.2f ms  rmse %.3g\n", p->scene->name, conic_method_name(p->method),
               conic_kernel_type_name(p->kernel.type), (double)p->kernel.cutoff, p->ms,
               cli_chart_error_of(p, which)->rmse);
    }
  }
}
