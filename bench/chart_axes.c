#include "bench/chart_axes.h"

#include "bench/bench.h"
#include "bench/chart_job.h"
#include "cli/commands/gaussian_commands.h"
#include "cli/opening_key.h"
#include "cli/render/fill_shot.h"
#include "cli/render/sample_options.h"
#include "core/image/image_common.h"

enum { MOST_FRAMES = 15 };

/* A way, ready to be drawn. Its source may be another way's. */
typedef struct axis_way {
  cli_render_job scene;
  int is_source_lent;
  double seconds[MOST_FRAMES];
  int n_frames;
} axis_way;

typedef struct axis_job {
  cli_session *session;
  cli_axis_chart *chart;
  cli_chart_way *ways;
  int n_ways;
  axis_way truth, *points; /* the first scene in full detail; of each way */
  conic_image truth_image, image;
  size_t n_covered;          /* pixels of the truth */
  cli_bench_machine machine; /* all 0: not measured */
} axis_job;

/* --- opening --- */

/* What was opened alike, or null. */
static conic_source *find_opened(axis_job *job, const axis_way *way) {
  char key[CONIC_SHA256_ROOM], other[CONIC_SHA256_ROOM];
  const cli_render_job *scene = &way->scene;
  cli_opening_key(scene->inputs, (size_t)scene->n_inputs, &scene->opening, scene->abilities, key);
  for (int i = -1; i < (job->points ? job->n_ways : 0); i++) {
    const cli_render_job *from = i < 0 ? &job->truth.scene : &job->points[i].scene;
    if (!from->source)
      continue;
    const cli_opened opened = cli_opened_with(&from->opening);
    cli_opening_key(from->inputs, (size_t)from->n_inputs, &from->opening, from->abilities, other);
    if (strcmp(key, other) == 0 && cli_is_opened_alike(from->source, &opened, &scene->opening))
      return from->source;
  }
  return NULL;
}

/* Reads a way's words, opens its scene, and fills in its shot. What was said of the scene once is not said again. */
static int open_way(axis_job *job, int i_scene, const cli_chart_way *words, axis_way *way) {
  const cli_chart_asked *asked = &job->chart->asked;
  const char *argv[asked->argc + CLI_MOST_WORDS];
  cli_render_job *scene = &way->scene;
  int n = cli_chart_words(asked, i_scene, words, argv);
  int exit_code = cli_chart_parse(job->session, n, (char **)argv, scene, NULL);
  if (exit_code == CLI_DONE)
    exit_code = cli_sample_check(job->session, scene);
  if (exit_code != CLI_DONE)
    return exit_code < 0 ? CLI_USAGE : exit_code;
  scene->source = find_opened(job, way);
  way->is_source_lent = scene->source != NULL;
  conic_status status = cli_scene_begin(job->session, scene);
  const int was_quiet = job->session->is_quiet;
  job->session->is_quiet |= way->is_source_lent;
  if (status == CONIC_OK)
    status = cli_scene_open(job->session, scene);
  if (status == CONIC_OK)
    status = cli_shot_fill(job->session, scene, cli_sample_frame(scene));
  if (status == CONIC_OK)
    status = cli_choose_exposure(scene);
  job->session->is_quiet = was_quiet;
  if (way != &job->truth) /* one camera for all */
    scene->shot.camera = job->truth.scene.shot.camera;
  scene->shot.render.skip_hidden = 1; /* as conic render does */
  return cli_exit_of(status);
}

static void close_way(cli_session *session, axis_way *way) {
  if (way->is_source_lent)
    way->scene.source = NULL;
  cli_scene_release(session, &way->scene);
  free(way->scene.inputs);
}

static void close_all(axis_job *job) {
  for (int pass = 0; pass < 2; pass++) /* those that borrow first */
    for (int i = 0; i < job->n_ways && job->points; i++)
      if (job->points[i].is_source_lent == !pass)
        close_way(job->session, &job->points[i]);
  close_way(job->session, &job->truth);
  free(job->points);
  free(job->ways);
}

/* --- planning --- */

static cli_chart_facts facts_of(const cli_render_job *scene) {
  const conic_source_scale *scale = conic_source_measure(scene->source);
  const int chooses = (scale->abilities & CONIC_SOURCE_CHOOSES) != 0;
  return (cli_chart_facts){.chooses = chooses,
                           .has_splats = scale->n_splats > 0 || scale->abilities & CONIC_SOURCE_STREAMS,
                           .has_faces = scale->n_triangles > 0 && !chooses,
                           .is_composited = cli_is_composited(scene),
                           .n_primitives = scale->n_splats + scale->n_triangles};
}

/* The first scene is open, for the truth; others are opened for a look. */
static int list_ways(axis_job *job) {
  int exit_code = CLI_DONE;
  for (int i = 0; i < job->chart->asked.n_scenes && exit_code == CLI_DONE; i++) {
    axis_way *look = i ? calloc(1, sizeof *look) : &job->truth;
    if (!look)
      return cli_error(CLI_RESOURCE, "chart: out of memory");
    if (i)
      exit_code = open_way(job, i, NULL, look);
    if (exit_code == CLI_DONE) {
      const cli_chart_facts facts = facts_of(&look->scene);
      exit_code = cli_chart_list_ways(&job->chart->asked, i, &facts, &job->ways, &job->n_ways);
    }
    if (i) {
      close_way(job->session, look);
      free(look);
    }
  }
  return exit_code;
}

/* Whether an option of the way decides the time alone. */
static int is_of_work(const cli_effects_job *effects, const cli_chart_way *way) {
  for (int i = 0; i < effects->n_given; i++)
    for (int k = 0; k < way->n_factors; k++) {
      const char *word = way->words[(size_t)k * 2];
      if (effects->given[i].acts.is_work && strcmp(word + strspn(word, "-"), effects->given[i].name) == 0)
        return 1;
    }
  return 0;
}

static int open_ways(axis_job *job) {
  cli_axis_chart *chart = job->chart;
  const cli_charts_beside *beside = &chart->asked.beside;
  int exit_code = CLI_DONE, n = job->n_ways;
  chart->points = calloc((size_t)(n + beside->n) + 1, sizeof *chart->points);
  job->points = calloc((size_t)n + 1, sizeof *job->points);
  if (!chart->points || !job->points)
    return cli_error(CLI_RESOURCE, "chart: out of memory");
  chart->n_points = n + beside->n;
  for (int i = 0; i < n && exit_code == CLI_DONE; i++) {
    chart->points[i].way = job->ways[i];
    exit_code = open_way(job, job->ways[i].i_scene, &job->ways[i], &job->points[i]);
    chart->points[i].is_of_work = is_of_work(&job->points[i].scene.effects, &job->ways[i]);
  }
  for (int i = 0; i < beside->n; i++) {
    cli_chart_way *way = &chart->points[n + i].way;
    chart->points[n + i].is_of_work = 1;
    snprintf(way->axis, sizeof way->axis, "beside");
    snprintf(way->value, sizeof way->value, "%s", beside->pictures[i].name);
  }
  return exit_code;
}

/* --- measuring --- */

static conic_status draw_way(axis_way *way, conic_image *image, conic_shot_outcome *outcome) {
  cli_render_job *scene = &way->scene;
  conic_status status =
      scene->opening.gaussians ? conic_source_composite_by(scene->source, scene->opening.gaussians) : CONIC_OK;
  return status == CONIC_OK ? conic_shot_draw(scene->source, scene->renderer, &scene->shot, image, outcome) : status;
}

static int draw_the_truth(axis_job *job) {
  conic_context *context = job->session->context;
  const conic_camera *camera = &job->truth.scene.shot.camera;
  cli_axis_chart *chart = job->chart;
  chart->size[0] = camera->width;
  chart->size[1] = camera->height;
  conic_status status =
      conic_image_allocate(context, camera->width, camera->height, 1u << CONIC_PLANE_RGBA, &job->truth_image);
  if (status == CONIC_OK)
    status = conic_image_allocate(context, camera->width, camera->height, 1u << CONIC_PLANE_RGBA, &job->image);
  if (status == CONIC_OK)
    status = draw_way(&job->truth, &job->truth_image, NULL);
  const float *rgba = job->truth_image.planes[CONIC_PLANE_RGBA];
  for (size_t i = 0; status == CONIC_OK && i < conic_image_pixels(&job->truth_image); i++)
    job->n_covered += rgba[4 * i + 3] > 0.0f;
  if (status == CONIC_OK && job->n_covered == 0)
    return cli_error(CLI_INPUT, "%s: nothing of it is in the picture", chart->asked.scenes[0]);
  return cli_exit_of(status);
}

static conic_status compare_point(axis_job *job, cli_axis_point *point) {
  const float *seen = job->truth_image.planes[CONIC_PLANE_RGBA], *drawn = job->image.planes[CONIC_PLANE_RGBA];
  for (size_t i = 0; i < conic_image_pixels(&job->truth_image); i++)
    point->holes += seen[4 * i + 3] > 0.999f && drawn[4 * i + 3] == 0.0f;
  point->hash = conic_image_hash(&job->image, CONIC_PLANE_RGBA);
  return cli_chart_measure(job->session->context, &job->truth_image, &job->image, job->n_covered, &point->error);
}

/* Of columns of floats, those that there are, n values each. */
static uint64_t bytes_of_columns(size_t n, const float *const *columns, int n_columns) {
  uint64_t bytes = 0;
  for (int i = 0; i < n_columns; i++)
    bytes += columns[i] ? n * sizeof(float) : 0;
  return bytes;
}

static uint64_t bytes_of(const conic_drawing *drawing) {
  uint64_t bytes = 0;
  const conic_splats *s = drawing->splats;
  const conic_triangles *t = drawing->triangles;
  if (s) {
    const float *const columns[] = {s->position[0],  s->position[1],  s->position[2],  s->tangent_u[0], s->tangent_u[1],
                                    s->tangent_u[2], s->tangent_v[0], s->tangent_v[1], s->tangent_v[2], s->color[0],
                                    s->color[1],     s->color[2],     s->opacity};
    bytes += bytes_of_columns(s->count, columns, (int)(sizeof columns / sizeof columns[0]));
  }
  if (t) {
    const float *const columns[] = {t->position[0], t->position[1], t->position[2], t->color[0],
                                    t->color[1],    t->color[2],    t->alpha};
    bytes += bytes_of_columns(t->n_vertices, columns, (int)(sizeof columns / sizeof columns[0]));
    bytes += bytes_of_columns(t->normal_corners ? t->n_normals : t->n_vertices, (const float *const *)t->normal, 3);
    bytes += (t->normal_corners ? 2 : 1) * t->count * sizeof *t->corners;
  }
  return bytes;
}

/* Of splats alone; nothing is known of triangles and of means. */
static double floor_of(const axis_job *job, const axis_way *way, const conic_shot_outcome *outcome) {
  const conic_render_statistics *s = &outcome->statistics;
  cli_bench_work work[CLI_BENCH_N_STAGES];
  double ms = 0.0;
  if (!job->machine.threads || s->triangles_in || outcome->samples.end_sample || !s->fragments)
    return 0.0;
  cli_bench_work_of(s, NULL, &job->image, way->scene.shot.render.passes, work);
  for (int i = 0; i < CLI_BENCH_N_STAGES; i++)
    ms += cli_bench_floor_ms(&work[i], &job->machine);
  return ms;
}

/* A frame that brings memory and caches, then timed ones, of which the fastest counts. */
static conic_status time_point(axis_job *job, int i, int repeat) {
  cli_axis_point *point = &job->chart->points[i];
  axis_way *way = &job->points[i];
  conic_shot_outcome outcome;
  conic_status status = CONIC_OK;
  double floor_ms = 0.0;
  const int skips_hidden = way->scene.shot.render.skip_hidden;
  for (int k = 0; k <= repeat && status == CONIC_OK; k++) {
    double start = cli_seconds();
    way->scene.shot.render.skip_hidden = k ? skips_hidden : 0; /* fragments are counted once */
    status = draw_way(way, &job->image, &outcome);
    if (status == CONIC_OK && k == 0)
      floor_ms = floor_of(job, way, &outcome);
    if (k && way->n_frames < MOST_FRAMES)
      way->seconds[way->n_frames++] = cli_seconds() - start;
  }
  if (status != CONIC_OK || point->error.is_measured)
    return status;
  const conic_source_choice *choice = conic_source_chosen(way->scene.source);
  point->floor_ms = floor_ms;
  point->lod_ms = outcome.statistics.ms.lod;
  point->splats = outcome.statistics.splats_in;
  point->triangles = outcome.statistics.triangles_in;
  point->bytes = bytes_of(&choice->drawing);
  point->stated_px = choice->error_px;
  return compare_point(job, point);
}

static void settle_times(const axis_job *job) {
  for (int i = 0; i < job->n_ways; i++) {
    axis_way *way = &job->points[i];
    cli_axis_point *point = &job->chart->points[i];
    qsort(way->seconds, (size_t)way->n_frames, sizeof way->seconds[0], conic_compare_doubles);
    point->ms = 1e3 * way->seconds[0];
    point->spread = way->seconds[way->n_frames / 4] / way->seconds[0] - 1.0;
  }
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
    status = compare_point(job, point);
  conic_image_release(context, &job->image);
  job->image = drawn;
  return status;
}

/* In rounds, so that what else the machine does hits all alike. */
static conic_status measure_points(axis_job *job) {
  int n_rounds = job->chart->asked.is_quick ? 1 : 3, repeat = job->chart->asked.is_quick ? 1 : 4;
  const cli_charts_beside *beside = &job->chart->asked.beside;
  conic_status status = CONIC_OK;
  if (!job->chart->asked.is_quick)
    status = cli_bench_machine_measure(job->session, &job->machine);
  for (int round = 0; round < n_rounds && status == CONIC_OK; round++)
    for (int i = 0; i < job->n_ways && status == CONIC_OK; i++)
      status = time_point(job, i, repeat);
  if (status == CONIC_OK)
    settle_times(job);
  for (int i = 0; i < beside->n && status == CONIC_OK; i++)
    status = measure_beside(job, &job->chart->points[job->n_ways + i], &beside->pictures[i]);
  return status;
}

/* --- what is best --- */

double cli_axis_cost(const cli_axis_point *point, cli_chart_cost cost) {
  return cost == CLI_COST_TIME         ? point->ms
         : cost == CLI_COST_PRIMITIVES ? (double)(point->splats + point->triangles)
                                       : (double)point->bytes;
}

/* Whether two points are the same picture of the same things: their times then differ by chance, unless the way is one
 * that changes no picture. */
static int is_repeated(const cli_axis_point *p, const cli_axis_point *earlier) {
  return !p->is_of_work && p->hash == earlier->hash && p->splats == earlier->splats &&
         p->triangles == earlier->triangles;
}

/* Whether q is nearer than p and no dearer, or as near and cheaper. Times that noise may have made are none. */
static int beats(const cli_axis_point *q, const cli_axis_point *p, cli_chart_cost cost) {
  double noise = cost == CLI_COST_TIME ? fmax(0.02, fmax(p->spread, q->spread)) : 0.0;
  double own = cli_axis_cost(p, cost), other = cli_axis_cost(q, cost);
  if (q->error.rmse < p->error.rmse)
    return other <= own * (1.0 + noise);
  return q->error.rmse == p->error.rmse && other * (1.0 + noise) < own;
}

static void mark_best(cli_axis_chart *chart) {
  for (int cost = 0; cost < CLI_N_CHART_COSTS; cost++)
    for (int i = 0; i < chart->n_points; i++) {
      cli_axis_point *p = &chart->points[i];
      int is_best = p->error.is_measured && cli_axis_cost(p, (cli_chart_cost)cost) > 0.0;
      for (int k = 0; k < chart->n_points && is_best; k++) {
        const cli_axis_point *q = &chart->points[k];
        int is_rival = k != i && q->error.is_measured && cli_axis_cost(q, (cli_chart_cost)cost) > 0.0;
        is_best = !is_rival || !((k < i && is_repeated(p, q)) || beats(q, p, (cli_chart_cost)cost));
      }
      p->is_best[cost] = is_best;
    }
}

const cli_axis_point *cli_axis_in_time(const cli_axis_chart *chart) {
  const cli_axis_point *nearest = NULL;
  for (int i = 0; i < chart->n_points; i++) {
    const cli_axis_point *p = &chart->points[i];
    if (p->way.n_factors && p->error.is_measured && p->ms <= 1e3 * chart->most_seconds &&
        (!nearest || p->error.rmse < nearest->error.rmse))
      nearest = p;
  }
  return nearest;
}

int cli_axis_count_of(const cli_axis_chart *chart, const char *axis) {
  int n = 0;
  for (int i = 0; i < chart->n_points; i++)
    n += strcmp(chart->points[i].way.axis, axis) == 0;
  return n;
}

int cli_axis_chart_measure(cli_session *session, cli_axis_chart *chart) {
  axis_job job = {.session = session, .chart = chart};
  if (chart->asked.n_scenes > CLI_MOST_CHART_SCENES)
    return cli_usage("chart: more than %d scenes", (int)CLI_MOST_CHART_SCENES);
  int exit_code = open_way(&job, 0, NULL, &job.truth);
  job.truth.scene.shot.view.samples = chart->truth_samples;
  if (exit_code == CLI_DONE)
    exit_code = list_ways(&job);
  if (exit_code == CLI_DONE)
    exit_code = open_ways(&job);
  if (exit_code == CLI_DONE)
    exit_code = draw_the_truth(&job);
  if (exit_code == CLI_DONE)
    exit_code = cli_exit_of(measure_points(&job));
  mark_best(chart);
  conic_image_release(session->context, &job.truth_image);
  conic_image_release(session->context, &job.image);
  close_all(&job);
  return exit_code;
}
