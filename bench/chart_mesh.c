/* Every representation of a mesh at every size: its time, and its error against the mesh's own supersampled picture. */
#include "bench/chart_mesh.h"

#include <math.h>

#include "core/image/image_common.h"

/* Samples along an edge of a pixel of the true picture; the error that may be chosen from; and the timing in rounds,
 * so that what else goes on hits all representations alike. */
enum { SAMPLES = 4, ROUNDS = 3 };
static const double error_px = 1.0;

typedef struct mesh_job {
  conic_context *context;
  cli_mesh_chart *chart;
  conic_renderer *renderer;
  cli_chart_models models;
  int repeat, largest; /* frames a round, of the largest picture; its edge */
} mesh_job;

static conic_status frame(const mesh_job *job, int edge, double zoom, conic_camera *camera) {
  conic_framing framing;
  conic_framing_init(&framing);
  framing.width = framing.height = edge;
  framing.elevation_deg = 40.0;
  framing.zoom = zoom;
  return conic_source_frame(job->models.sources[CLI_CHART_TRIANGLES], &framing, camera);
}

/* Where a vertex is on the screen; 0 where it is not finite or not before the camera. */
static int project_vertex(const conic_triangles *mesh, const conic_camera *camera, uint32_t vertex, double at[2]) {
  double p[3];
  for (int row = 0; row < 3; row++) {
    const double *m = camera->cam_from_world[row];
    p[row] = m[3];
    for (int k = 0; k < 3; k++)
      p[row] += m[k] * (mesh->origin[k] + (double)mesh->position[k][vertex]);
  }
  at[0] = camera->fx * p[0] / p[2];
  at[1] = camera->fy * p[1] / p[2];
  return p[2] > 0.0 && isfinite(at[0]) && isfinite(at[1]);
}

/* The mean area of a triangle on the screen. */
static double mean_area_px(const conic_triangles *mesh, const conic_camera *camera) {
  double sum = 0.0;
  size_t n = 0;
  for (size_t i = 0; i < mesh->count; i++) {
    double at[3][2];
    int is_seen = 1;
    for (int k = 0; k < 3; k++)
      is_seen &= project_vertex(mesh, camera, mesh->corners[i][k], at[k]);
    if (!is_seen)
      continue;
    n++;
    sum += 0.5 * fabs((at[1][0] - at[0][0]) * (at[2][1] - at[0][1]) - (at[1][1] - at[0][1]) * (at[2][0] - at[0][0]));
  }
  return n ? sum / (double)n : 0.0;
}

/* Pictures as large as gives the pixels a triangle; past the largest, the camera zooms in. */
static conic_status choose_sizes(mesh_job *job) {
  static const double wanted[CLI_MAX_MESH_SIZES] = {100, 50, 20, 10, 5, 2, 1, 0.5, 0.2, 0.1};
  static const double wanted_quickly[] = {10, 1, 0.1};
  enum { REFERENCE = 1024 };
  conic_camera camera;
  conic_status status = frame(job, REFERENCE, 1.0, &camera);
  if (status != CONIC_OK)
    return status;
  double area = mean_area_px(job->models.mesh, &camera);
  job->chart->n_sizes = job->chart->is_quick ? 3 : CLI_MAX_MESH_SIZES;
  for (int i = 0; i < job->chart->n_sizes; i++) {
    cli_mesh_size *size = &job->chart->sizes[i];
    double pixels = job->chart->is_quick ? wanted_quickly[i] : wanted[i];
    double edge = area > 0.0 ? REFERENCE * sqrt(pixels / area) : 1.0;
    size->edge = edge < 8.0 ? 8 : edge > job->largest ? job->largest : (int)(edge + 0.5);
    size->zoom = edge > job->largest ? edge / job->largest : 1.0;
    double scale = size->zoom * (double)size->edge / REFERENCE;
    size->pixels_per_triangle = area * scale * scale;
  }
  return CONIC_OK;
}

static conic_render_options plain_options(void) {
  conic_render_options options;
  conic_render_options_init(&options);
  options.shading = CONIC_SHADE_LAMBERT;
  return options;
}

/* A frame, with the choice of what to draw in it; `point` keeps the fastest. */
static conic_status draw_picture(mesh_job *job, cli_chart_model model, const conic_camera *camera, conic_image *image,
                                 cli_mesh_point *point) {
  conic_render_options options = plain_options();
  conic_render_statistics statistics;
  conic_drawing drawing;
  double start = cli_seconds();
  conic_status status = cli_chart_models_choose(&job->models, model, camera, error_px, &options, &drawing);
  double lod_ms = 1e3 * (cli_seconds() - start);
  if (status == CONIC_OK)
    status = conic_render_drawing(job->context, job->renderer, &drawing, camera, &options, 1, image, &statistics);
  if (status != CONIC_OK)
    return status;
  double ms = lod_ms + statistics.ms.frame;
  if (ms < point->ms) {
    point->ms = ms;
    point->lod_ms = lod_ms;
  }
  point->primitives = (drawing.splats ? drawing.splats->count : 0) + (drawing.triangles ? drawing.triangles->count : 0);
  return CONIC_OK;
}

/* The error is over the pixels that the mesh touches, the same number for all; what is drawn beside them counts. */
static conic_status measure_picture(conic_context *context, const conic_image *truth, const conic_image *image,
                                    cli_mesh_size *size, cli_mesh_point *point) {
  const float *seen = truth->planes[CONIC_PLANE_RGBA], *drawn = image->planes[CONIC_PLANE_RGBA];
  size->covered = 0;
  for (size_t i = 0; i < conic_image_pixels(truth); i++) {
    size->covered += seen[4 * i + 3] > 0.0f;
    point->holes += seen[4 * i + 3] > 0.999f && drawn[4 * i + 3] == 0.0f;
  }
  return cli_chart_measure(context, truth, image, size->covered, &point->error);
}

static conic_status draw_truth(mesh_job *job, const conic_camera *camera, conic_image *truth) {
  conic_render_options options = plain_options();
  conic_drawing drawing;
  conic_status status =
      cli_chart_models_choose(&job->models, CLI_CHART_TRIANGLES, camera, error_px, &options, &drawing);
  return status == CONIC_OK
             ? conic_render_drawing(job->context, job->renderer, &drawing, camera, &options, SAMPLES, truth, NULL)
             : status;
}

/* The first frame of each round is left out of the times: the caches are then another model's. Small pictures, which
 * the rest of the machine disturbs most, are drawn more often. */
static conic_status time_models(mesh_job *job, const conic_camera *camera, conic_image *image, int i_size) {
  int repeat = job->repeat * job->largest / camera->width;
  conic_status status = CONIC_OK;
  for (int round = 0; round < ROUNDS; round++)
    for (int model = 0; model < CLI_N_CHART_MODELS; model++)
      for (int i = 0; i <= repeat && status == CONIC_OK; i++) {
        cli_mesh_point *point = &job->chart->points[model][i_size], warm = {.ms = HUGE_VAL};
        status = draw_picture(job, (cli_chart_model)model, camera, image, i ? point : &warm);
      }
  return status;
}

static conic_status measure_models(mesh_job *job, const conic_camera *camera, const conic_image *truth,
                                   conic_image *image, int i_size) {
  conic_status status = CONIC_OK;
  for (int model = 0; model < CLI_N_CHART_MODELS && status == CONIC_OK; model++) {
    cli_mesh_point *point = &job->chart->points[model][i_size];
    *point = (cli_mesh_point){.ms = HUGE_VAL};
    status = draw_picture(job, (cli_chart_model)model, camera, image, point);
    point->ms = HUGE_VAL; /* memory grew in this one */
    if (status == CONIC_OK)
      status = measure_picture(job->context, truth, image, &job->chart->sizes[i_size], point);
  }
  return status == CONIC_OK ? time_models(job, camera, image, i_size) : status;
}

static conic_status measure_size(mesh_job *job, int i_size) {
  const cli_mesh_size *size = &job->chart->sizes[i_size];
  conic_image truth = {0}, image = {0};
  conic_camera camera;
  conic_status status = frame(job, size->edge, size->zoom, &camera);
  if (status == CONIC_OK)
    status = conic_image_allocate(job->context, size->edge, size->edge, 1u << CONIC_PLANE_RGBA, &truth);
  if (status == CONIC_OK)
    status = conic_image_allocate(job->context, size->edge, size->edge, 1u << CONIC_PLANE_RGBA, &image);
  if (status == CONIC_OK)
    status = draw_truth(job, &camera, &truth);
  if (status == CONIC_OK)
    status = measure_models(job, &camera, &truth, &image, i_size);
  conic_image_release(job->context, &truth);
  conic_image_release(job->context, &image);
  return status;
}

/* Which no other of its size beats in both time and error. */
static void find_fronts(cli_mesh_chart *chart) {
  for (int i = 0; i < chart->n_sizes; i++)
    for (int a = 0; a < CLI_N_CHART_MODELS; a++) {
      cli_mesh_point *p = &chart->points[a][i];
      p->is_front = p->error.is_measured;
      for (int b = 0; b < CLI_N_CHART_MODELS; b++) {
        const cli_mesh_point *q = &chart->points[b][i];
        if (b != a && q->ms <= p->ms && q->error.rmse <= p->error.rmse)
          p->is_front = 0;
      }
    }
}

conic_status cli_mesh_chart_measure(cli_session *session, cli_mesh_chart *chart) {
  mesh_job job = {.context = session->context, .chart = chart};
  job.repeat = chart->is_quick ? 1 : 5;
  job.largest = chart->is_quick ? 160 : 1024;
  conic_status status = cli_chart_models_build(session, chart->path, chart->is_quick ? 32 : 200, &job.models);
  if (status == CONIC_OK) {
    chart->n_triangles = job.models.mesh->count;
    status = conic_renderer_create(job.context, &job.renderer);
  }
  if (status == CONIC_OK)
    status = choose_sizes(&job);
  for (int i = 0; i < chart->n_sizes && status == CONIC_OK; i++)
    status = measure_size(&job, i);
  if (status == CONIC_OK)
    find_fronts(chart);
  conic_renderer_destroy(job.renderer);
  cli_chart_models_release(&job.models);
  return status;
}
