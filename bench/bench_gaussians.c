/* Scenes of Gaussians on the bench: a profile takes the place of a method. docs/reference/performance.md says which
 * stage is which. */

#include "bench/bench.h"
#include "gaussians/draw/gaussian_footprint.h"
#include "gaussians/scene/gaussian_set.h"
#include "gaussians/scene/made_gaussians.h"

int cli_bench_is_gaussian_file(const char *path) {
  conic_context *context; /* which says nothing: whether it is one is no more than a question */
  conic_context_options quiet;
  conic_context_options_init(&quiet);
  quiet.threads = 1;
  if (conic_context_create(&quiet, &context) != CONIC_OK)
    return 0;
  int is_one = conic_gaussians_is_file(context, path);
  conic_context_destroy(context);
  return is_one;
}

/* By the source's outline of the scene. */
conic_status cli_bench_gaussians_frame(conic_context *context, const char *path, int width, int height,
                                       conic_camera *camera) {
  conic_gaussian_options gaussian_options;
  conic_source_options options;
  conic_source *source;
  conic_framing framing;
  conic_gaussian_options_init(&gaussian_options);
  conic_source_options_init(&options);
  options.gaussians = &gaussian_options;
  conic_framing_init(&framing);
  framing.width = width;
  framing.height = height;
  conic_status status = conic_source_open(context, &path, 1, &options, &source);
  if (status != CONIC_OK)
    return status;
  status = conic_source_frame(source, &framing, camera);
  conic_source_close(source);
  return status;
}

conic_status cli_bench_gaussians_read(cli_session *session, const char *path, const cli_bench_look *look,
                                      cli_bench_scene *scene) {
  conic_context *context = session->context;
  scene->is_gaussian = scene->has_camera = 1;
  conic_status status = look->camera_path
                            ? cli_bench_camera_read(session, look->camera_path, look->view, &scene->camera)
                            : cli_bench_gaussians_frame(context, path, 1024, 1024, &scene->camera);
  return status == CONIC_OK ? conic_gaussians_read(context, path, NULL, &scene->gaussians) : status;
}

conic_status cli_bench_gaussians_make(cli_session *session, size_t count, cli_bench_scene *scene) {
  scene->is_gaussian = 1;
  return conic_gaussians_make(session->context, count, 3, 0, &scene->gaussians);
}

void cli_bench_gaussians_release(cli_session *session, cli_bench_scene *scene) {
  if (scene->is_gaussian)
    conic_gaussians_release(session->context, &scene->gaussians);
  free(scene->composited.rgb);
  free(scene->composited.transparency);
  memset(&scene->composited, 0, sizeof scene->composited);
  scene->is_gaussian = 0;
}

/* Where frames are composited into, kept from frame to frame. */
static conic_status keep_room(cli_bench_scene *scene, int width, int height) {
  conic_gaussian_planes *planes = &scene->composited;
  if (planes->width == width && planes->height == height)
    return CONIC_OK;
  size_t n = (size_t)width * (size_t)height;
  free(planes->rgb);
  free(planes->transparency);
  *planes = (conic_gaussian_planes){.width = width, .height = height};
  planes->rgb = malloc(n * 3 * sizeof(float));
  planes->transparency = malloc(n * sizeof(float));
  if (planes->rgb && planes->transparency)
    return CONIC_OK;
  planes->width = 0;
  return CONIC_ERROR_MEMORY;
}

static void tell_frame(const conic_gaussian_statistics *s, double ms, conic_render_statistics *statistics) {
  memset(statistics, 0, sizeof *statistics);
  statistics->fragments = s->pairs;
  statistics->splats_in = s->gaussians_in;
  statistics->splats_drawn = s->gaussians_drawn;
  statistics->splats_culled = s->gaussians_culled;
  statistics->splats_skipped = s->gaussians_skipped;
  statistics->isa = conic_isa_name(s->isa);
  statistics->ms.setup = 1e3 * s->seconds_setup;
  statistics->ms.visibility = 1e3 * s->seconds_sort;
  statistics->ms.bin = 1e3 * s->seconds_bin;
  statistics->ms.accumulate = 1e3 * s->seconds_composite;
  statistics->ms.frame = ms;
}

conic_status cli_bench_gaussians_draw(conic_context *context, cli_bench_scene *scene, const conic_camera *camera,
                                      const cli_bench_line *line, const conic_image *image,
                                      conic_render_statistics *statistics) {
  conic_gaussian_options options;
  conic_gaussian_statistics drawn;
  conic_gaussian_options_init(&options);
  options.profile = (conic_gaussian_profile)(line->i_method - CLI_BENCH_N_METHODS);
  options.isa = line->isa;
  conic_status status = keep_room(scene, camera->width, camera->height);
  if (status != CONIC_OK)
    return status;
  conic_gaussian_planes planes = scene->composited;
  planes.z = image->planes[CONIC_PLANE_Z];
  planes.count = image->planes[CONIC_PLANE_COUNT];
  planes.id = image->planes[CONIC_PLANE_ID];
  double start = cli_seconds();
  status = conic_gaussians_render(context, &scene->gaussians, camera, &options, &planes, &drawn);
  if (status == CONIC_OK)
    tell_frame(&drawn, 1e3 * (cli_seconds() - start), statistics);
  return status;
}

void cli_bench_gaussians_show(const cli_bench_scene *scene, conic_image *image, conic_render_statistics *statistics) {
  const conic_gaussian_planes *from = &scene->composited;
  const size_t n = (size_t)from->width * (size_t)from->height;
  static const unsigned filled =
      1u << CONIC_PLANE_RGBA | 1u << CONIC_PLANE_Z | 1u << CONIC_PLANE_COUNT | 1u << CONIC_PLANE_ID;
  float *rgba = image->planes[CONIC_PLANE_RGBA];
  statistics->pixels_covered = 0;
  for (size_t i = 0; i < n; i++) {
    for (size_t c = 0; c < 3; c++)
      rgba[4 * i + c] = from->rgb[3 * i + c];
    rgba[4 * i + 3] = 1.0f - from->transparency[i];
    statistics->pixels_covered += from->transparency[i] < 1.0f;
  }
  for (int plane = 0; plane < CONIC_N_PLANES; plane++) /* what Gaussians do not have */
    if (image->planes[plane] && !(filled >> plane & 1))
      memset(image->planes[plane], 0, n * 4 * (size_t)conic_plane_describe((conic_plane)plane)->n_channels);
}

/* Operations of docs/reference/gaussians.md's formulas, one a sign; one in double counts as two. */
enum {
  GAUSSIAN_MOVE = 2 * 18,   /* the mean into camera space, and the comparisons that cull */
  GAUSSIAN_SHAPE = 2 * 160, /* the rotation's matrix, J·V·R·S, the form and its inverse, the box */
  HARMONIC = 7,             /* a harmonic, and its part of three channels */
  PAIR = 34,                /* Δ, q, e^(−q/2), α, T′, w and three sums */
  RAY_PAIR = 66,            /* g, c and e, q and z in place of Δ and q */
  FINISH_PIXEL = 6          /* the background */
};

void cli_bench_gaussians_work(const cli_bench_scene *scene, cli_bench_line *line) {
  const conic_render_statistics *s = &line->statistics;
  const double floats = 4.0, n = (double)s->splats_in, drawn = (double)s->splats_drawn;
  const double harmonics = (double)conic_harmonics_of_degree(scene->gaussians.sh_degree);
  const int is_ray = line->i_method - CLI_BENCH_N_METHODS == CONIC_PROFILE_EXACT;
  const double record = sizeof(conic_gaussian_footprint) + (is_ray ? sizeof(conic_gaussian_ray) : 0.0);
  const double pixels = (double)line->width * (double)line->height, pairs = (double)s->fragments;
  memset(line->work, 0, sizeof line->work);
  line->work[0] = (cli_bench_work){floats * (11.0 * n + harmonics * drawn), record * drawn,
                                   GAUSSIAN_MOVE * n + (GAUSSIAN_SHAPE + HARMONIC * harmonics / 3.0) * drawn};
  line->work[1] = (cli_bench_work){record * drawn, floats * drawn, 8.0 * drawn};     /* bins */
  line->work[2] = (cli_bench_work){2.0 * floats * drawn, 2.0 * floats * drawn, 0.0}; /* sort */
  line->work[3] = (cli_bench_work){record * drawn, 4.0 * floats * pixels,
                                   (is_ray ? RAY_PAIR : PAIR) * pairs + FINISH_PIXEL * pixels}; /* composite */
}
