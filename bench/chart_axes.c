#include "bench/chart_axes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bench/bench.h"
#include "cli/arguments.h"
#include "core/base/message.h"
#include "core/image/image_common.h"

enum { N_REPRESENTATIONS = 3 };

/* What an axis needs of a scene. */
typedef enum axis_need { OF_SPLATS, OF_ALL, OF_CHOICES, OF_FACES, ONLY_ASKED } axis_need;

/* How one frame is drawn. */
typedef struct axis_setting {
  conic_render_options render;
  conic_source_view view;
  conic_representation as;
  const char *device; /* null: the processor */
} axis_setting;

typedef struct chart_axis {
  const char *name, *values; /* by default; null: halves of all */
  axis_need need;
  int (*set)(const char *value, axis_setting *setting); /* 0: not understood */
} chart_axis;

static int set_method(const char *value, axis_setting *setting) {
  for (int i = 0; i < CONIC_N_METHODS; i++)
    if (strcmp(value, conic_method_name((conic_method)i)) == 0) {
      setting->render.method = (conic_method)i;
      return 1;
    }
  return 0;
}

static int set_kernel(const char *value, axis_setting *setting) {
  const float cutoff = setting->render.kernel.cutoff;
  for (int i = 0; conic_kernel_type_name((conic_kernel_type)i); i++)
    if (strcmp(value, conic_kernel_type_name((conic_kernel_type)i)) == 0) {
      setting->render.kernel = (conic_kernel){(conic_kernel_type)i, cutoff, 4.0f, cutoff, 5}; /* Confetti ends there */
      return 1;
    }
  return 0;
}

static int set_prefilter(const char *value, axis_setting *setting) {
  double number;
  int is_one = cli_parse_number(value, &number) && number >= 0.0 && number <= 100.0;
  setting->render.prefilter = is_one ? (float)number : 0.0f;
  return is_one;
}

static int set_samples(const char *value, axis_setting *setting) {
  unsigned long long n;
  int is_one = cli_parse_count(value, &n) && n >= 1 && n <= CONIC_MAX_SAMPLES;
  setting->view.samples = is_one ? (int)n : 1;
  return is_one;
}

static int set_passes(const char *value, axis_setting *setting) {
  setting->render.passes = value[0] == '1' ? 1 : 3;
  return strcmp(value, "1") == 0 || strcmp(value, "3") == 0;
}

static int set_error(const char *value, axis_setting *setting) {
  return cli_parse_number(value, &setting->view.error_px) && setting->view.error_px >= 0.0;
}

static int set_budget(const char *value, axis_setting *setting) {
  unsigned long long n;
  int is_one = cli_parse_count(value, &n) && n >= 1;
  setting->view.budget = is_one ? n : 0;
  return is_one;
}

static const char *const representations[N_REPRESENTATIONS] = {"points", "mesh", "hybrid"};

static int set_representation(const char *value, axis_setting *setting) {
  for (int i = 0; i < N_REPRESENTATIONS; i++)
    if (strcmp(value, representations[i]) == 0) {
      setting->as = (conic_representation)i;
      return 1;
    }
  return 0;
}

static int set_isa(const char *value, axis_setting *setting) {
  for (int i = 0; i < CONIC_N_ISAS; i++)
    if (strcmp(value, conic_isa_name((conic_isa)i)) == 0) {
      setting->render.isa = (conic_isa)i;
      return 1;
    }
  return 0;
}

static int set_device(const char *value, axis_setting *setting) {
  setting->device = strcmp(value, "cpu") == 0 ? NULL : value;
  return 1;
}

static const chart_axis axes[CLI_N_CHART_AXES] = {
    {"method", "conic:ray:affine:point:disc:auto", OF_SPLATS, set_method},
    {"kernel", "gauss:hat:box:confetti", OF_SPLATS, set_kernel},
    {"prefilter", "0:0.25:0.5:1:2", OF_SPLATS, set_prefilter},
    {"samples", "1:2:3:4", OF_ALL, set_samples},
    {"passes", "1:3", ONLY_ASKED, set_passes},
    {"error", "0.5:1:2:4:8:16", OF_CHOICES, set_error},
    {"budget", NULL, OF_CHOICES, set_budget},
    {"as", "mesh:points:hybrid", OF_FACES, set_representation},
    {"isa", "auto:scalar", ONLY_ASKED, set_isa},
    {"device", "cpu:opencl", ONLY_ASKED, set_device},
};

const char *cli_chart_axis_name(int i_axis) {
  return i_axis >= 0 && i_axis < CLI_N_CHART_AXES ? axes[i_axis].name : "beside";
}

int cli_chart_parse_beside(const char *text, void *beside) {
  cli_charts_beside *all = beside;
  cli_chart_beside *next = &all->pictures[all->n];
  char number[32];
  size_t name = strcspn(text, "="), digits = text[name] ? strcspn(text + name + 1, ":") : 0;
  const char *path = text + name + 1 + digits;
  if (all->n == CLI_MOST_BESIDE || name == 0 || name >= sizeof next->name || digits == 0 || digits >= sizeof number ||
      path[0] != ':' || !path[1])
    return 0;
  snprintf(next->name, sizeof next->name, "%.*s", (int)name, text);
  snprintf(number, sizeof number, "%.*s", (int)digits, text + name + 1);
  next->path = path + 1;
  all->n += cli_parse_number(number, &next->ms) && next->ms > 0.0;
  return next->ms > 0.0;
}

/* An axis that was asked for. */
typedef struct asked_axis {
  int i_axis;
  char values[160]; /* empty: the default ones */
} asked_axis;

typedef struct axis_job {
  cli_session *session;
  cli_axis_chart *chart;
  asked_axis asked[CLI_N_CHART_AXES];
  int n_asked;
  conic_source *sources[CLI_MOST_CHART_SCENES][N_REPRESENTATIONS + 1]; /* the last: as each file fits */
  conic_camera camera;
  conic_image truth, image;
  size_t n_covered; /* pixels of the truth */
  axis_setting plain;
  axis_setting *settings; /* of the points */
  conic_renderer *renderer;
} axis_job;

static int find_named_axis(const char *name, size_t length) {
  for (int i = 0; i < CLI_N_CHART_AXES; i++)
    if (strlen(axes[i].name) == length && strncmp(axes[i].name, name, length) == 0)
      return i;
  return -1;
}

static int understand_axes(axis_job *job) {
  for (const char *at = job->chart->over; at && *at; at += *at == ',') {
    size_t length = strcspn(at, ","), name = strcspn(at, "=,");
    int i_axis = find_named_axis(at, name);
    asked_axis *asked = &job->asked[job->n_asked];
    if (i_axis < 0)
      return cli_usage("chart: --over %.*s: there is no such axis; see conic help chart", (int)name, at);
    if (job->n_asked == CLI_N_CHART_AXES)
      return cli_usage("chart: --over %s: too many axes", job->chart->over);
    size_t n = length > name ? length - name - 1 : 0;
    if (n >= sizeof asked->values)
      return cli_usage("chart: --over %s: too many values", axes[i_axis].name);
    asked->i_axis = i_axis;
    memcpy(asked->values, at + name + (n > 0), n);
    asked->values[n] = 0;
    job->n_asked++;
    at += length;
  }
  return CLI_DONE;
}

/* --- sources --- */

static conic_status open_chart_scene(axis_job *job, int i_scene, conic_representation as, conic_source **source) {
  int column = as == CONIC_AS_AUTO ? N_REPRESENTATIONS : (int)as;
  conic_source **kept = &job->sources[i_scene][column];
  conic_source_options options;
  conic_source_options_init(&options);
  options.as = as;
  options.is_smooth = as == CONIC_AS_MESH || as == CONIC_AS_HYBRID;
  conic_status status =
      *kept ? CONIC_OK : conic_source_open(job->session->context, &job->chart->paths[i_scene], 1, &options, kept);
  *source = *kept;
  return status;
}

static void close_chart_scenes(axis_job *job) {
  for (int i = 0; i < CLI_MOST_CHART_SCENES; i++)
    for (int k = 0; k <= N_REPRESENTATIONS; k++)
      conic_source_close(job->sources[i][k]);
}

static conic_status find_chart_camera(axis_job *job, conic_source *source) {
  conic_framing framing;
  double near_z;
  if (job->chart->camera_path) {
    conic_status status = cli_bench_camera_read(job->session, job->chart->camera_path, job->chart->view, &job->camera);
    if (status == CONIC_OK)
      cli_bench_camera_resize(&job->camera, job->chart->size[0], job->chart->size[1]);
    return status;
  }
  conic_status status = conic_source_stand(source);
  conic_framing_init(&framing);
  framing.width = job->chart->size[0];
  framing.height = job->chart->size[1];
  memcpy(framing.up, conic_source_measure(source)->up, sizeof framing.up);
  return status == CONIC_OK
             ? conic_source_fit(source, &framing, job->plain.render.kernel.cutoff, 1, &job->camera, &near_z)
             : status;
}

/* --- points --- */

static int axis_fits(const chart_axis *axis, const conic_source_scale *scale) {
  int chooses = (scale->abilities & CONIC_SOURCE_CHOOSES) != 0;
  int streams = (scale->abilities & CONIC_SOURCE_STREAMS) != 0;
  return axis->need == OF_ALL || (axis->need == OF_SPLATS && (scale->n_splats > 0 || streams)) ||
         (axis->need == OF_CHOICES && chooses) || (axis->need == OF_FACES && scale->n_triangles > 0 && !chooses);
}

static int append_axis_point(axis_job *job, int i_scene, int i_axis, const char *value) {
  cli_axis_chart *chart = job->chart;
  size_t n = (size_t)chart->n_points + 1;
  cli_axis_point *points = realloc(chart->points, n * sizeof *points);
  chart->points = points ? points : chart->points;
  axis_setting *settings = realloc(job->settings, n * sizeof *settings);
  job->settings = settings ? settings : job->settings;
  if (!points || !settings)
    return cli_error(CLI_RESOURCE, "chart: out of memory");
  cli_axis_point *point = &points[chart->n_points];
  *point = (cli_axis_point){.i_scene = i_scene, .i_axis = i_axis, .ms = HUGE_VAL};
  snprintf(point->value, sizeof point->value, "%s", value);
  settings[chart->n_points] = job->plain;
  if (i_axis < CLI_N_CHART_AXES &&
      (strlen(value) >= sizeof point->value || !axes[i_axis].set(point->value, &settings[chart->n_points])))
    return cli_usage("chart: --over %s: %s is no value of it", axes[i_axis].name, value);
  chart->n_points++;
  return CLI_DONE;
}

/* A half, a quarter … of what there is. */
static int append_halves(axis_job *job, int i_scene, int i_axis, const conic_source_scale *scale) {
  uint64_t n = scale->n_splats + scale->n_triangles;
  int exit_code = CLI_DONE;
  for (int i = 1; i <= 5 && n >> i && exit_code == CLI_DONE; i++) {
    char value[24];
    snprintf(value, sizeof value, "%llu", (unsigned long long)(n >> i));
    exit_code = append_axis_point(job, i_scene, i_axis, value);
  }
  return exit_code;
}

static int append_values(axis_job *job, int i_scene, int i_axis, const char *values) {
  int exit_code = CLI_DONE;
  for (const char *at = values; *at && exit_code == CLI_DONE; at += *at == ':') {
    char value[64];
    size_t length = strcspn(at, ":");
    snprintf(value, sizeof value, "%.*s", (int)length, at);
    exit_code = append_axis_point(job, i_scene, i_axis, value);
    at += length;
  }
  return exit_code;
}

static int append_axis(axis_job *job, int i_scene, const asked_axis *asked, const conic_source_scale *scale) {
  const char *values = asked->values[0] ? asked->values : axes[asked->i_axis].values;
  return values ? append_values(job, i_scene, asked->i_axis, values)
                : append_halves(job, i_scene, asked->i_axis, scale);
}

/* Of one scene all axes that fit, unless some were asked for; of several what chooses by its error, and else samples.
 */
static int plan_chart_scene(axis_job *job, int i_scene, const conic_source_scale *scale) {
  int exit_code = CLI_DONE, chooses = (scale->abilities & CONIC_SOURCE_CHOOSES) != 0;
  const char *alone = job->chart->n_paths > 1 ? chooses ? "error" : "samples" : NULL;
  for (int i = 0; i < job->n_asked && exit_code == CLI_DONE; i++)
    exit_code = append_axis(job, i_scene, &job->asked[i], scale);
  for (int i = 0; i < CLI_N_CHART_AXES && !job->n_asked && exit_code == CLI_DONE; i++) {
    const asked_axis asked = {.i_axis = i};
    if (alone ? strcmp(alone, axes[i].name) == 0 : axis_fits(&axes[i], scale))
      exit_code = append_axis(job, i_scene, &asked, scale);
  }
  return exit_code;
}

static int plan_axes(axis_job *job) {
  int exit_code = CLI_DONE;
  for (int i = 0; i < job->chart->n_paths && exit_code == CLI_DONE; i++) {
    conic_source *source;
    exit_code = cli_exit_of(open_chart_scene(job, i, CONIC_AS_AUTO, &source));
    if (exit_code == CLI_DONE && i == 0)
      exit_code = cli_exit_of(find_chart_camera(job, source));
    if (exit_code == CLI_DONE)
      exit_code = plan_chart_scene(job, i, conic_source_measure(source));
  }
  for (int i = 0; i < job->chart->beside.n && exit_code == CLI_DONE; i++)
    exit_code = append_axis_point(job, 0, CLI_N_CHART_AXES, job->chart->beside.pictures[i].name);
  return exit_code;
}

/* --- measuring --- */

static conic_status draw_setting(axis_job *job, int i_scene, const axis_setting *setting, conic_renderer *renderer,
                                 conic_image *image, conic_render_statistics *statistics) {
  conic_source *source;
  conic_render_options render = setting->render;
  conic_status status = open_chart_scene(job, i_scene, setting->as, &source);
  if (status != CONIC_OK)
    return status;
  conic_source_settle(source, &render);
  return conic_source_draw(source, renderer, &job->camera, &render, &setting->view, image, statistics);
}

static conic_status draw_the_truth(axis_job *job) {
  conic_render_statistics statistics;
  axis_setting setting = job->plain;
  setting.view.samples = job->chart->truth_samples;
  conic_status status = draw_setting(job, 0, &setting, job->renderer, &job->truth, &statistics);
  const float *rgba = job->truth.planes[CONIC_PLANE_RGBA];
  for (size_t i = 0; i < conic_image_pixels(&job->truth) && status == CONIC_OK; i++)
    job->n_covered += rgba[4 * i + 3] > 0.0f;
  return status;
}

static conic_status compare_axis_point(axis_job *job, cli_axis_point *point) {
  const float *seen = job->truth.planes[CONIC_PLANE_RGBA], *drawn = job->image.planes[CONIC_PLANE_RGBA];
  for (size_t i = 0; i < conic_image_pixels(&job->truth); i++)
    point->holes += seen[4 * i + 3] > 0.999f && drawn[4 * i + 3] == 0.0f;
  return cli_chart_measure(job->session->context, &job->truth, &job->image, job->n_covered, &point->error);
}

/* A frame that brings memory and caches, then timed ones, of which the fastest counts. */
static conic_status measure_axis_point(axis_job *job, int i, int repeat) {
  cli_axis_point *point = &job->chart->points[i];
  const axis_setting *setting = &job->settings[i];
  cli_device device = {.name = setting->device};
  conic_renderer *other = NULL;
  conic_status status = setting->device ? cli_device_open(job->session, &device, &other) : CONIC_OK;
  for (int k = 0; k <= repeat && status == CONIC_OK; k++) {
    double start = cli_seconds();
    status = draw_setting(job, point->i_scene, setting, other ? other : job->renderer, &job->image, &point->statistics);
    double ms = 1e3 * (cli_seconds() - start);
    if (k && ms < point->ms)
      point->ms = ms;
  }
  if (status == CONIC_OK && !point->error.is_measured)
    status = compare_axis_point(job, point);
  conic_renderer_destroy(other);
  return status;
}

/* Pictures of others are read, not drawn. */
static conic_status measure_beside(axis_job *job, cli_axis_point *point, const cli_chart_beside *beside) {
  conic_context *context = job->session->context;
  conic_image drawn = job->image;
  conic_status status = conic_image_read(context, beside->path, &job->image);
  if (status != CONIC_OK) {
    job->image = drawn;
    return status;
  }
  point->ms = beside->ms;
  if (!job->image.planes[CONIC_PLANE_RGBA] || job->image.width != drawn.width || job->image.height != drawn.height)
    status = conic_fail(context, CONIC_ERROR_INPUT, "%s: is no colour picture of %d x %d pixels", beside->path,
                        drawn.width, drawn.height);
  else
    status = compare_axis_point(job, point);
  conic_image_release(context, &job->image);
  job->image = drawn;
  return status;
}

static conic_status measure_all_beside(axis_job *job) {
  const cli_charts_beside *beside = &job->chart->beside;
  conic_status status = CONIC_OK;
  for (int i = 0; i < beside->n && status == CONIC_OK; i++)
    status = measure_beside(job, &job->chart->points[job->chart->n_points - beside->n + i], &beside->pictures[i]);
  return status;
}

/* In rounds, so that what else the machine does hits all alike. */
static conic_status measure_axis_points(axis_job *job) {
  int n_rounds = job->chart->is_quick ? 1 : 3, repeat = job->chart->is_quick ? 1 : 4;
  conic_status status = CONIC_OK;
  for (int round = 0; round < n_rounds; round++)
    for (int i = 0; i < job->chart->n_points - job->chart->beside.n && status == CONIC_OK; i++)
      status = measure_axis_point(job, i, repeat);
  return status == CONIC_OK ? measure_all_beside(job) : status;
}

static conic_status allocate_pictures(axis_job *job) {
  conic_context *context = job->session->context;
  const int width = job->camera.width, height = job->camera.height;
  conic_status status = conic_image_allocate(context, width, height, 1u << CONIC_PLANE_RGBA, &job->truth);
  if (status == CONIC_OK)
    status = conic_image_allocate(context, width, height, 1u << CONIC_PLANE_RGBA, &job->image);
  return status == CONIC_OK ? conic_renderer_create(context, &job->renderer) : status;
}

static void mark_best(cli_axis_chart *chart) {
  for (int i = 0; i < chart->n_points; i++) {
    cli_axis_point *p = &chart->points[i];
    p->is_front = p->error.is_measured;
    for (int k = 0; k < chart->n_points && p->is_front; k++) {
      const cli_axis_point *q = &chart->points[k];
      p->is_front = q == p || q->ms > p->ms || q->error.rmse > p->error.rmse ||
                    (q->ms == p->ms && q->error.rmse == p->error.rmse);
    }
  }
}

int cli_axis_chart_measure(cli_session *session, cli_axis_chart *chart) {
  axis_job job = {.session = session, .chart = chart, .plain = {.as = CONIC_AS_AUTO}};
  conic_render_options_init(&job.plain.render);
  job.plain.render.shading = chart->shading;
  conic_source_view_init(&job.plain.view);
  if (chart->n_paths > CLI_MOST_CHART_SCENES)
    return cli_usage("chart: more than %d scenes", (int)CLI_MOST_CHART_SCENES);
  int exit_code = understand_axes(&job);
  if (exit_code == CLI_DONE)
    exit_code = plan_axes(&job);
  if (exit_code == CLI_DONE) {
    conic_status status = allocate_pictures(&job);
    if (status == CONIC_OK)
      status = draw_the_truth(&job);
    if (status == CONIC_OK && job.n_covered == 0)
      exit_code = cli_error(CLI_INPUT, "%s: nothing of it is in the picture", chart->paths[0]);
    else
      exit_code = cli_exit_of(status == CONIC_OK ? measure_axis_points(&job) : status);
  }
  mark_best(chart);
  conic_renderer_destroy(job.renderer);
  conic_image_release(session->context, &job.truth);
  conic_image_release(session->context, &job.image);
  close_chart_scenes(&job);
  free(job.settings);
  return exit_code;
}
