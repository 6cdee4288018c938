/* One line of a benchmark: frames drawn, timed, and compared with what plain C draws. */

#include "bench/bench.h"
#include "cli/shell.h"
#include "core/image/image_common.h"

const cli_bench_method cli_bench_methods[CLI_BENCH_N_METHODS] = {
    {"conic", CONIC_METHOD_CONIC, 3},  {"ray", CONIC_METHOD_RAY, 3},   {"affine", CONIC_METHOD_AFFINE, 3},
    {"point", CONIC_METHOD_POINT, 3},  {"disc", CONIC_METHOD_DISC, 3}, {"auto", CONIC_METHOD_AUTO, 3},
    {"nearest", CONIC_METHOD_CONIC, 1}};

/* The value that a share of the sorted ones is below, straight between neighbours. */
static double quantile(const double *sorted, size_t n, double share) {
  double place = share * (double)(n - 1);
  size_t below = (size_t)place;
  double rest = place - (double)below;
  return below + 1 < n ? sorted[below] + rest * (sorted[below + 1] - sorted[below]) : sorted[below];
}

double cli_bench_median(double *values, size_t n, double quartiles[2]) {
  qsort(values, n, sizeof *values, conic_compare_doubles);
  if (quartiles) {
    quartiles[0] = quantile(values, n, 0.25);
    quartiles[1] = quantile(values, n, 0.75);
  }
  return quantile(values, n, 0.5);
}

int cli_bench_difference(const conic_image *a, const conic_image *b) {
  for (int plane = 0; plane < CONIC_N_PLANES; plane++)
    if (a->planes[plane] && b->planes[plane] &&
        (a->width != b->width || a->height != b->height ||
         memcmp(a->planes[plane], b->planes[plane], conic_image_plane_bytes(a, plane)) != 0))
      return plane;
  return -1;
}

/* So that a plane that nobody draws does not pass for the one that was drawn before. */
static void spoil(conic_image *image) {
  for (int plane = 0; plane < CONIC_N_PLANES; plane++)
    if (image->planes[plane])
      memset(image->planes[plane], 0x5a, conic_image_plane_bytes(image, plane));
}

static void note_difference(const conic_image *reference, const conic_image *drawn, cli_bench_line *line) {
  int plane = cli_bench_difference(reference, drawn);
  if (line->i_wrong_plane < 0)
    line->i_wrong_plane = plane;
}

static conic_render_options options_of_frame(const cli_bench_scene *scene, const cli_bench_line *line) {
  conic_render_options options;
  conic_render_options_init(&options);
  if (scene->is_gaussian)
    return options;
  options.method = cli_bench_methods[line->i_method].method;
  options.passes = cli_bench_methods[line->i_method].passes;
  options.cull_back = scene->cull_back;
  options.isa = line->isa;
  conic_source_settle(scene->source, &options);
  return options;
}

/* The image with some of its planes only; they stay the image's own. */
static conic_image with_planes(const conic_image *image, unsigned planes) {
  conic_image part = *image;
  for (int plane = 0; plane < CONIC_N_PLANES; plane++)
    if (!(planes & 1u << plane))
      part.planes[plane] = NULL;
  return part;
}

/* What a line's frames are drawn with, and the times that they took. */
typedef struct bench {
  conic_context *context;
  cli_bench_scene *scene;
  const cli_bench_line *line;
  conic_renderer *renderer;
  conic_camera camera;
  conic_render_options options;
  conic_image timed; /* the planes that are drawn while the clock runs */
  cli_bench_counters counters;
  size_t n;
  double *ms[CLI_BENCH_N_STAGES + 1], *lod, *cpu, *cycles, *instructions, *sorted; /* of each warm frame */
} bench;

static conic_status draw_chosen(cli_bench_scene *scene, const cli_bench_line *line, conic_renderer *renderer,
                                const conic_camera *camera, const conic_render_options *options, conic_image *image,
                                conic_render_statistics *statistics) {
  conic_source_view view;
  conic_source_view_init(&view);
  view.error_px = line->error_px;
  return conic_source_draw(scene->source, renderer, camera, options, &view, image, statistics);
}

static conic_status draw_one(const bench *b, const conic_camera *camera, conic_image *image,
                             conic_render_statistics *statistics) {
  if (b->scene->is_gaussian)
    return cli_bench_gaussians_draw(b->context, b->scene, camera, b->line, image, statistics);
  if (b->line->chooses)
    return draw_chosen(b->scene, b->line, b->renderer, camera, &b->options, image, statistics);
  return conic_render(b->renderer, b->scene->splats, camera, &b->options, image, statistics);
}

static conic_status draw_timed(bench *b, const conic_camera *camera, conic_render_statistics *statistics) {
  double cycles = cli_bench_counter_read(b->counters.cycles), cpu = cli_shell_cpu_seconds();
  double instructions = cli_bench_counter_read(b->counters.instructions);
  if (b->line->trace)
    cli_bench_trace_begin(b->line->trace);
  conic_status status = draw_one(b, camera, &b->timed, statistics);
  if (b->line->trace)
    cli_bench_trace_end(b->line->trace);
  b->instructions[b->n] = cli_bench_counter_read(b->counters.instructions) - instructions;
  b->cycles[b->n] = cli_bench_counter_read(b->counters.cycles) - cycles;
  b->cpu[b->n] = 1e3 * (cli_shell_cpu_seconds() - cpu);
  if (status == CONIC_OK && b->scene->is_gaussian)
    cli_bench_gaussians_show(b->scene, &b->timed, statistics);
  return status;
}

/* By ranks, which holds whatever the times are like: the median of n is within √n of the middle with 95 %. */
static double interval_of(const bench *b) {
  size_t n = b->n, reach = (size_t)ceil(0.98 * sqrt((double)n));
  if (n < 2 * reach + 1)
    return 1.0;
  memcpy(b->sorted, b->ms[CLI_BENCH_N_STAGES], n * sizeof *b->sorted);
  double median = cli_bench_median(b->sorted, n, NULL);
  return 0.5 * (b->sorted[n / 2 + reach] - b->sorted[(n - 1) / 2 - reach]) / median;
}

static int is_enough(const bench *b, const cli_bench_patience *patience, double seconds) {
  const size_t most = (size_t)patience->most, times = (size_t)patience->times;
  if (b->n < most && (b->n < (size_t)patience->least || seconds < patience->seconds))
    return 0;
  return b->n >= times * most || seconds >= (double)times * patience->seconds ||
         (b->n % 4 == 0 && interval_of(b) <= CLI_BENCH_SURE);
}

static conic_status draw_warm(bench *b, const cli_bench_patience *patience, conic_render_statistics *statistics) {
  double start = cli_seconds();
  while (!is_enough(b, patience, cli_seconds() - start)) {
    conic_camera camera = b->camera;
    if (b->line->n_turns)
      cli_bench_scene_turn(b->scene, (double)b->n / (double)b->line->n_turns, &camera);
    conic_status status = draw_timed(b, &camera, statistics);
    if (status != CONIC_OK)
      return status;
    b->lod[b->n] = statistics->ms.lod;
    for (int i = 0; i < CLI_BENCH_N_STAGES; i++)
      b->ms[i][b->n] = cli_bench_stage_ms(&statistics->ms, i);
    b->ms[CLI_BENCH_N_STAGES][b->n++] = statistics->ms.frame;
  }
  return CONIC_OK;
}

static double mean(const double *values, size_t n) {
  double sum = 0.0;
  for (size_t i = 0; i < n; i++)
    sum += values[i];
  return sum / (double)n;
}

/* Of a turntable the mean, since its frames are not alike. Sorts the values. */
static double middle_of(const bench *b, double *values, double quartiles[2]) {
  double median = cli_bench_median(values, b->n, quartiles);
  return b->line->n_turns ? mean(values, b->n) : median;
}

static void take_middles(bench *b, cli_bench_line *line) {
  conic_render_milliseconds *ms = &line->statistics.ms;
  double *stages[CLI_BENCH_N_STAGES] = {&ms->setup, &ms->bin, &ms->visibility, &ms->accumulate, &ms->resolve};
  for (int i = 0; i < CLI_BENCH_N_STAGES; i++)
    *stages[i] = middle_of(b, b->ms[i], NULL);
  ms->frame = middle_of(b, b->ms[CLI_BENCH_N_STAGES], line->quartile_ms);
  ms->lod = middle_of(b, b->lod, NULL);
  line->cpu_ms = middle_of(b, b->cpu, NULL);
  line->cycles = middle_of(b, b->cycles, NULL);
  line->instructions = middle_of(b, b->instructions, NULL);
  line->n_frames = (int)b->n;
  line->interval = b->line->n_turns ? 1.0 : interval_of(b);
}

/* The pictures of the first and of the last timed frame, where that is of the same view, are compared, and one with all
 * planes; nothing is compared between the warm ones, which would take the caches from them. */
static conic_status draw_frames(bench *b, const cli_bench_patience *patience, cli_bench_pictures *pictures,
                                cli_bench_line *line) {
  spoil(&pictures->drawn);
  conic_status status = draw_timed(b, &b->camera, &line->statistics);
  if (status != CONIC_OK)
    return status;
  const uint64_t n_fragments = line->statistics.fragments; /* counted once: what is hidden needs no look otherwise */
  b->options.skip_hidden = 1;
  line->first_ms = line->statistics.ms.frame;
  note_difference(&pictures->reference, &b->timed, line);
  spoil(&pictures->drawn);
  status = draw_warm(b, patience, &line->statistics);
  if (status != CONIC_OK)
    return status;
  if (!line->n_turns)
    note_difference(&pictures->reference, &b->timed, line);
  take_middles(b, line);
  line->statistics.fragments = n_fragments;
  conic_render_statistics statistics;
  status = draw_one(b, &b->camera, &pictures->drawn, &statistics);
  if (status == CONIC_OK && b->scene->is_gaussian)
    cli_bench_gaussians_show(b->scene, &pictures->drawn, &statistics);
  note_difference(&pictures->reference, &pictures->drawn, line);
  return status;
}

/* The same by plain C. */
static conic_status refer_to_gaussians(conic_context *context, cli_bench_scene *scene, const conic_camera *camera,
                                       const cli_bench_line *line, conic_image *reference) {
  cli_bench_line plain = *line;
  conic_render_statistics statistics;
  plain.isa = CONIC_ISA_SCALAR;
  conic_status status = cli_bench_gaussians_draw(context, scene, camera, &plain, reference, &statistics);
  if (status == CONIC_OK)
    cli_bench_gaussians_show(scene, reference, &statistics);
  return status;
}

conic_status cli_bench_refer(cli_session *session, cli_bench_scene *scene, const cli_bench_line *line,
                             conic_image *reference) {
  conic_renderer *renderer = NULL;
  conic_camera camera;
  conic_render_options options = options_of_frame(scene, line);
  options.isa = CONIC_ISA_SCALAR;
  conic_status status = cli_bench_scene_camera(scene, line->width, line->height, &camera);
  if (status == CONIC_OK && scene->is_gaussian)
    return refer_to_gaussians(session->context, scene, &camera, line, reference);
  if (status == CONIC_OK)
    status = conic_renderer_create(session->context, &renderer);
  if (status == CONIC_OK)
    status = line->chooses ? draw_chosen(scene, line, renderer, &camera, &options, reference, NULL)
                           : conic_render(renderer, scene->splats, &camera, &options, reference, NULL);
  conic_renderer_destroy(renderer);
  return status;
}

conic_status cli_bench_measure(cli_session *worker, cli_bench_scene *scene, const cli_bench_patience *patience,
                               const cli_bench_counters *counters, cli_bench_pictures *pictures, cli_bench_line *line) {
  size_t most = (size_t)patience->most * (size_t)patience->times + 1;
  bench b = {.context = worker->context,
             .scene = scene,
             .line = line,
             .counters = counters ? *counters : (cli_bench_counters){-1, -1},
             .options = options_of_frame(scene, line)};
  line->i_wrong_plane = -1;
  b.timed = with_planes(&pictures->drawn, pictures->timed_planes);
  double *all = calloc(most * (CLI_BENCH_N_STAGES + 6), sizeof *all), *next = all;
  if (!all)
    return CONIC_ERROR_MEMORY;
  double **const series[] = {&b.lod, &b.cpu, &b.cycles, &b.instructions, &b.sorted};
  for (size_t i = 0; i < sizeof series / sizeof *series; i++, next += most)
    *series[i] = next;
  for (size_t i = 0; i <= CLI_BENCH_N_STAGES; i++, next += most)
    b.ms[i] = next;
  conic_status status = cli_bench_scene_camera(scene, line->width, line->height, &b.camera);
  if (status == CONIC_OK)
    status = line->device ? cli_device_open(worker, line->device, &b.renderer)
                          : conic_renderer_create(worker->context, &b.renderer);
  if (status == CONIC_OK)
    status = draw_frames(&b, patience, pictures, line);
  if (status == CONIC_OK) {
    if (scene->is_gaussian)
      cli_bench_gaussians_work(scene, line);
    else
      cli_bench_work_of(&line->statistics, scene->splats, &b.timed, b.options.passes, line->work);
    for (int plane = 0; plane < CONIC_N_PLANES; plane++)
      line->hash[plane] = conic_image_hash(&pictures->drawn, (conic_plane)plane);
  }
  conic_renderer_destroy(b.renderer);
  free(all);
  return status;
}
