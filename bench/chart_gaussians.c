#include "bench/chart_gaussians.h"

#include "bench/bench.h"
#include "core/splats/gaussian_profile.h"

const char *const cli_truth_names[CLI_N_TRUTHS] = {"overlap", "volume"};

static const conic_gaussian_question questions[CLI_N_TRUTHS] = {CONIC_GAUSSIAN_OVERLAP, CONIC_GAUSSIAN_VOLUME};

typedef struct gaussian_chart_job {
  cli_session *session;
  conic_context *context; /* the session's */
  cli_gaussian_chart *chart;
  conic_gaussians gaussians;
  conic_camera camera, sparse; /* the second sees the centre of every step-th pixel of the first */
  conic_gaussian_reference truths[CLI_N_TRUTHS];
  float *rgb;
} gaussian_chart_job;

/* Of an odd step, the middle of so many pixels is the centre of one. */
static void thin_out(gaussian_chart_job *job) {
  cli_gaussian_chart *chart = job->chart;
  const conic_camera *all = &job->camera;
  int step = 1;
  while (((long)all->width / step) * (all->height / step) > chart->most_pixels && all->width > step + 2 &&
         all->height > step + 2)
    step += 2;
  conic_camera *sparse = &job->sparse;
  *sparse = *all;
  sparse->width /= step;
  sparse->height /= step;
  sparse->fx /= step;
  sparse->fy /= step;
  sparse->cx /= step;
  sparse->cy /= step;
  chart->step = step;
  chart->n_pixels = sparse->width * sparse->height;
}

static conic_status open_chart(gaussian_chart_job *job) {
  cli_gaussian_chart *chart = job->chart;
  if (!conic_gaussians_is_file(job->context, chart->path))
    return conic_fail(job->context, CONIC_ERROR_INPUT, "%s: is no Gaussian scene, and nothing else is charted",
                      chart->path);
  conic_status status =
      chart->camera_path
          ? cli_bench_camera_read(job->session, chart->camera_path, chart->view, &job->camera)
          : cli_bench_gaussians_frame(job->context, chart->path, chart->size[0], chart->size[1], &job->camera);
  if (status == CONIC_OK)
    status = conic_gaussians_read(job->context, chart->path, NULL, &job->gaussians);
  if (status != CONIC_OK)
    return status;
  thin_out(job);
  chart->n_gaussians = job->gaussians.count;
  chart->n_truths = job->gaussians.scale[2] ? 2 : 1;
  size_t n = (size_t)job->camera.width * (size_t)job->camera.height;
  job->rgb = malloc(n * 3 * sizeof *job->rgb);
  return job->rgb ? CONIC_OK : CONIC_ERROR_MEMORY;
}

static conic_status find_truths(gaussian_chart_job *job) {
  conic_status status = CONIC_OK;
  for (int i = 0; i < CLI_N_TRUTHS && i < job->chart->n_truths && status == CONIC_OK; i++) {
    status =
        conic_gaussian_oracle_render(job->context, &job->gaussians, &job->sparse, NULL, questions[i], &job->truths[i]);
    job->chart->quadrature[i] = job->truths[i].quadrature;
  }
  return status;
}

static double seconds_of(const conic_gaussian_statistics *s) {
  return s->seconds_setup + s->seconds_sort + s->seconds_bin + s->seconds_composite;
}

/* The fastest of the frames after the first, which others on the machine have disturbed the least. */
static conic_status time_profile(const gaussian_chart_job *job, const conic_gaussian_options *options,
                                 cli_profile_point *point) {
  conic_gaussian_planes planes = {.width = job->camera.width, .height = job->camera.height, .rgb = job->rgb};
  conic_status status = CONIC_OK;
  for (int i = 0; i <= (job->chart->is_quick ? 1 : 7) && status == CONIC_OK; i++) {
    conic_gaussian_statistics s;
    status = conic_gaussians_render(job->context, &job->gaussians, &job->camera, options, &planes, &s);
    if (status == CONIC_OK && (i <= 1 || 1e3 * seconds_of(&s) < point->ms)) {
      point->statistics = s;
      point->ms = 1e3 * seconds_of(&s);
    }
  }
  return status;
}

static void compare_truth(const gaussian_chart_job *job, const conic_gaussian_reference *truth,
                          cli_profile_error *error) {
  const size_t step = (size_t)job->chart->step, width = (size_t)job->camera.width;
  const size_t across = (size_t)job->sparse.width, n = across * (size_t)job->sparse.height;
  double squares = 0.0;
  for (size_t i = 0; i < n; i++) {
    size_t pixel = (i / across * step + step / 2) * width + i % across * step + step / 2;
    for (size_t c = 0; c < 3; c++) {
      double off = fabs((double)job->rgb[3 * pixel + c] - truth->rgb[3 * i + c]);
      error->max = off > error->max ? off : error->max;
      squares += off * off;
    }
  }
  error->rmse = sqrt(squares / (3.0 * (double)n));
  error->psnr = -20.0 * log10(error->rmse);
}

static conic_status measure_profile(gaussian_chart_job *job, conic_gaussian_profile profile) {
  cli_profile_point *point = &job->chart->points[job->chart->n_points++];
  conic_gaussian_options options;
  conic_gaussian_options_init(&options);
  options.profile = point->profile = profile;
  conic_status status = time_profile(job, &options, point);
  for (int i = 0; i < job->chart->n_truths && status == CONIC_OK; i++)
    compare_truth(job, &job->truths[i], &point->errors[i]);
  return status;
}

/* Which take two axes of three. */
static int is_of_discs(conic_gaussian_profile profile) {
  return conic_profile_row_of(profile)->shape == CONIC_SHAPE_DISC;
}

static void find_profile_fronts(cli_gaussian_chart *chart) {
  for (int truth = 0; truth < chart->n_truths; truth++)
    for (int i = 0; i < chart->n_points; i++) {
      cli_profile_point *p = &chart->points[i];
      p->errors[truth].is_front = 1;
      for (int k = 0; k < chart->n_points; k++) {
        const cli_profile_point *q = &chart->points[k];
        if (k != i && q->ms <= p->ms && q->errors[truth].rmse <= p->errors[truth].rmse)
          p->errors[truth].is_front = 0;
      }
    }
}

conic_status cli_gaussian_chart_measure(cli_session *session, cli_gaussian_chart *chart) {
  gaussian_chart_job job = {.session = session, .context = session->context, .chart = chart};
  conic_status status = open_chart(&job);
  if (status == CONIC_OK)
    status = find_truths(&job);
  for (int i = 0; i < CONIC_N_GAUSSIAN_PROFILES && status == CONIC_OK; i++)
    if (chart->n_truths == 1 || !is_of_discs((conic_gaussian_profile)i))
      status = measure_profile(&job, (conic_gaussian_profile)i);
  if (status == CONIC_OK)
    find_profile_fronts(chart);
  for (int i = 0; i < CLI_N_TRUTHS; i++)
    conic_gaussian_reference_release(session->context, &job.truths[i]);
  conic_gaussians_release(session->context, &job.gaussians);
  free(job.rgb);
  return status;
}
