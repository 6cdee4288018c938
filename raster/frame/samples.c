/* Supersampling: the picture drawn N times as wide and as high, and every N × N of its pixels made one. */

#include "raster/frame/samples.h"
#include "core/image/image_common.h"
#include "core/image/view_arguments.h"
#include "raster/frame/statistics.h"

/* The fine picture is drawn in bands of about so many of its pixels, so that memory is bounded: 20 bytes a pixel for
 * colour and depth, 56 for all planes. The bands depend on nothing but the size, as the bits of a band's rows depend on
 * where it begins. */
#define BAND_PIXELS ((size_t)1 << 24)

/* Splats that a task counts. */
enum { COUNTED_TOGETHER = 1 << 14 };

typedef struct reduction {
  const conic_image *fine;
  conic_image *image;
  size_t first_column, first_row; /* of the image, where the fine picture begins */
  size_t samples;                 /* N */
} reduction;

/* The fine picture's pixel k of an image's pixel: its first is `corner`. */
static size_t fine_at(const reduction *r, size_t corner, size_t k) {
  return corner + k / r->samples * (size_t)r->fine->width + k % r->samples;
}

/* Of a row of the image's pixels. */
static inline void take_means(const reduction *r, conic_plane plane, size_t n_channels, size_t corner, size_t at) {
  size_t samples = r->samples, width = (size_t)r->fine->width / samples,
         row_floats = n_channels * (size_t)r->fine->width;
  const float *fine = (const float *)r->fine->planes[plane] + n_channels * corner;
  float *to = (float *)r->image->planes[plane] + n_channels * at;
  double n = (double)(samples * samples);
  for (size_t x = 0; x < width; x++, fine += n_channels * samples, to += n_channels) {
    double sum[4] = {0.0, 0.0, 0.0, 0.0}; /* of floats, so exact where all are the same */
    for (size_t y = 0; y < samples; y++)
      for (size_t k = 0; k < samples; k++)
        for (size_t c = 0; c < n_channels; c++)
          sum[c] += (double)fine[y * row_floats + k * n_channels + c];
    for (size_t c = 0; c < n_channels; c++)
      to[c] = (float)(sum[c] / n);
  }
}

/* Twice the distance from the pixel's centre, squared. */
static int off_center(const reduction *r, size_t k) {
  int n = (int)r->samples, x = 2 * (int)(k % r->samples) + 1 - n, y = 2 * (int)(k / r->samples) + 1 - n;
  return x * x + y * y;
}

/* The direction of the sum over the covered samples, whose normals are not zero; where they cancel, that of the covered
 * one nearest to the centre. */
static void take_normal(const reduction *r, size_t corner, size_t at) {
  const float *fine = r->fine->planes[CONIC_PLANE_NORMAL];
  float *to = (float *)r->image->planes[CONIC_PLANE_NORMAL] + 3 * at;
  const float *nearest = NULL;
  double sum[3] = {0.0, 0.0, 0.0};
  int nearest_distance = 0;
  for (size_t k = 0; k < r->samples * r->samples; k++) {
    const float *normal = fine + 3 * fine_at(r, corner, k);
    if (normal[0] == 0.0f && normal[1] == 0.0f && normal[2] == 0.0f)
      continue;
    if (!nearest || off_center(r, k) < nearest_distance) {
      nearest = normal;
      nearest_distance = off_center(r, k);
    }
    for (int axis = 0; axis < 3; axis++)
      sum[axis] += (double)normal[axis];
  }
  double length = sqrt((sum[0] * sum[0] + sum[1] * sum[1]) + sum[2] * sum[2]);
  for (int axis = 0; axis < 3; axis++)
    to[axis] = !nearest ? 0.0f : length > 0.0 ? (float)(sum[axis] / length) : nearest[axis];
}

static void take_greatest_count(const reduction *r, size_t corner, size_t at) {
  const uint32_t *fine = r->fine->planes[CONIC_PLANE_COUNT];
  uint32_t greatest = 0;
  for (size_t k = 0; k < r->samples * r->samples; k++)
    greatest = fine[fine_at(r, corner, k)] > greatest ? fine[fine_at(r, corner, k)] : greatest;
  ((uint32_t *)r->image->planes[CONIC_PLANE_COUNT])[at] = greatest;
}

/* Of the sample nearest to the centre; of four that are, the first. */
static void take_central(const reduction *r, conic_plane plane, size_t corner, size_t at) {
  size_t middle = (r->samples - 1) / 2;
  const uint32_t *fine = r->fine->planes[plane]; /* bits are copied, whatever they mean */
  memcpy((uint32_t *)r->image->planes[plane] + at, fine + fine_at(r, corner, middle * r->samples + middle),
         sizeof *fine);
}

static const conic_plane means[] = {CONIC_PLANE_WEIGHT, CONIC_PLANE_TRANSPARENCY, CONIC_PLANE_AO, CONIC_PLANE_SHADOW},
                         centrals[] = {CONIC_PLANE_Z,        CONIC_PLANE_ID,        CONIC_PLANE_CLUSTER,
                                       CONIC_PLANE_MEDIAN_Z, CONIC_PLANE_INVERSE_Z, CONIC_PLANE_LAST};

enum { N_MEANS = sizeof means / sizeof *means, N_CENTRALS = sizeof centrals / sizeof *centrals };

static void reduce_row(void *data, size_t i_row) {
  const reduction *r = data;
  void *const *planes = r->image->planes;
  size_t width = (size_t)r->fine->width / r->samples;
  size_t first_corner = i_row * (size_t)r->fine->width * r->samples;
  size_t first = (r->first_row + i_row) * (size_t)r->image->width + r->first_column;
  if (planes[CONIC_PLANE_RGBA])
    take_means(r, CONIC_PLANE_RGBA, 4, first_corner, first);
  if (planes[CONIC_PLANE_ALBEDO])
    take_means(r, CONIC_PLANE_ALBEDO, 3, first_corner, first);
  for (int i = 0; i < N_MEANS; i++)
    if (planes[means[i]] && r->fine->planes[means[i]])
      take_means(r, means[i], 1, first_corner, first);
  for (size_t x = 0; x < width; x++) {
    size_t corner = first_corner + x * r->samples, at = first + x;
    if (planes[CONIC_PLANE_NORMAL])
      take_normal(r, corner, at);
    if (planes[CONIC_PLANE_COUNT])
      take_greatest_count(r, corner, at);
    for (int i = 0; i < N_CENTRALS; i++)
      if (planes[centrals[i]] && r->fine->planes[centrals[i]])
        take_central(r, centrals[i], corner, at);
  }
}

unsigned conic_samples_planes(void) {
  unsigned planes = CONIC_DRAWN_PLANES;
  for (int i = 0; i < N_MEANS; i++)
    planes |= 1u << means[i];
  for (int i = 0; i < N_CENTRALS; i++)
    planes |= 1u << centrals[i];
  return planes;
}

conic_camera conic_samples_camera(const conic_camera *camera, int samples, int first_row, int n_rows) {
  conic_camera fine = *camera;
  double n = (double)samples;
  fine.width = samples * camera->width;
  fine.height = samples * n_rows;
  fine.fx = n * camera->fx;
  fine.fy = n * camera->fy;
  fine.cx = n * camera->cx;
  fine.cy = n * (camera->cy - (double)first_row);
  return fine;
}

/* What becomes of the splats in the whole fine picture, which no band sees. */
typedef struct census {
  const conic_splats *splats;
  const unsigned char *is_counted; /* null: all are */
  conic_view view;
  conic_chunk *chunks; /* a task */
} census;

static void count_splats(void *data, size_t i_item) {
  census *c = data;
  conic_footprint footprint;
  conic_box box;
  conic_projected_surface surface;
  conic_ray ray;
  conic_projected place = {.footprints = &footprint, .boxes = &box, .surfaces = &surface, .rays = &ray};
  conic_chunk *chunk = &c->chunks[i_item];
  size_t first = i_item * COUNTED_TOGETHER, n = c->splats->count - first;
  for (size_t i = 0; i < (n < COUNTED_TOGETHER ? n : COUNTED_TOGETHER); i++) {
    conic_chunk one = {.n_drawn = 0};
    if (c->is_counted && !c->is_counted[first + i])
      continue;
    conic_project_one(&c->view, c->splats, first + i, &place, &one);
    conic_chunk_add(&one, chunk);
  }
}

conic_status conic_samples_count(conic_context *context, const conic_splats *splats, const unsigned char *is_counted,
                                 const conic_camera *camera, const conic_render_options *options,
                                 conic_render_statistics *statistics) {
  census c = {.splats = splats, .is_counted = is_counted};
  size_t n_tasks = (splats->count + COUNTED_TOGETHER - 1) / COUNTED_TOGETHER;
  conic_status status =
      conic_view_init(context, splats, camera, options, options->near_z, options->splat_length, &c.view);
  if (status != CONIC_OK)
    return status;
  c.chunks = conic_memory_allocate_zeroed(context, n_tasks, sizeof *c.chunks);
  if (!c.chunks)
    return CONIC_ERROR_MEMORY;
  status = conic_parallel_told(context, "render", 1.0, 1.0, n_tasks, count_splats, &c);
  if (status == CONIC_OK)
    conic_chunks_count(c.chunks, n_tasks, options->method, statistics);
  conic_memory_release(context, c.chunks);
  return status;
}

static conic_status count_whole(conic_context *context, const conic_whole_drawing *drawing, const conic_camera *camera,
                                const conic_render_options *options, conic_render_statistics *s) {
  conic_view view;
  conic_status status = conic_samples_count(context, drawing->splats, NULL, camera, options, s);
  if (status == CONIC_OK)
    status = conic_view_init(context, drawing->splats, camera, options, options->near_z, options->splat_length, &view);
  return status == CONIC_OK ? conic_whole_drawing_count(context, drawing, &view, camera, options->isa, s) : status;
}

conic_status conic_samples_count_drawing(conic_context *context, const conic_drawing *drawing,
                                         const conic_camera *camera, const conic_render_options *options,
                                         conic_render_statistics *statistics) {
  conic_whole_drawing whole;
  conic_status status = conic_whole_drawing_enter(context, "render", drawing, &whole);
  if (status == CONIC_OK)
    status = count_whole(context, &whole, camera, options, statistics);
  conic_drawing_leave(context, &whole.entered);
  return status;
}

conic_status conic_samples_allocate(conic_context *context, int width, int height, unsigned planes, conic_image *fine) {
  memset(fine, 0, sizeof *fine);
  fine->width = width;
  fine->height = height;
  for (int i = 0; i < CONIC_N_PLANES; i++) {
    size_t pixel_bytes = 4 * (size_t)conic_plane_describe((conic_plane)i)->n_channels;
    if (!(planes >> i & 1))
      continue;
    fine->planes[i] = conic_memory_allocate(context, conic_image_pixels(fine), pixel_bytes);
    if (!fine->planes[i]) {
      conic_image_release(context, fine);
      return CONIC_ERROR_MEMORY;
    }
    conic_memory_advise_large_pages(fine->planes[i], conic_image_pixels(fine) * pixel_bytes);
  }
  return CONIC_OK;
}

/* One sample a pixel is drawn at once. */
int conic_samples_band_rows(const conic_camera *camera, int samples) {
  size_t n = BAND_PIXELS / ((size_t)camera->width * (size_t)samples * (size_t)samples);
  return n < 1 ? 1 : samples > 1 && n < (size_t)camera->height ? (int)n : camera->height;
}

/* What is done with each band. */
typedef struct band_taker {
  conic_samples_receiver *receive;
  void *cookie;
} band_taker;

/* Of `fine`, the first rows. */
static conic_status draw_band(conic_renderer *renderer, const conic_whole_drawing *drawing, const conic_camera *camera,
                              const conic_render_options *options, conic_image *fine, const band_taker *taker,
                              int first_row, conic_render_statistics *sum) {
  conic_render_statistics band;
  fine->height = camera->height;
  conic_status status = conic_render_whole(renderer, drawing, camera, options, fine, &band);
  if (status != CONIC_OK)
    return status;
  double start = conic_seconds_now();
  status = taker->receive(taker->cookie, fine, first_row);
  conic_statistics_add_pixels(&band, sum);
  sum->ms.resolve += 1e3 * (conic_seconds_now() - start);
  return status;
}

static conic_status draw_bands(conic_context *context, conic_renderer *renderer, const conic_whole_drawing *drawing,
                               const conic_camera *camera, const conic_render_options *options, int samples,
                               unsigned planes, const band_taker *taker, conic_render_statistics *sum) {
  conic_image fine_image;
  int rows = conic_samples_band_rows(camera, samples);
  conic_status status = conic_samples_allocate(context, samples * camera->width, samples * rows, planes, &fine_image);
  if (status != CONIC_OK)
    return status;
  for (int y = 0; y < camera->height && status == CONIC_OK; y += rows) {
    int n_rows = camera->height - y < rows ? camera->height - y : rows;
    conic_camera fine = conic_samples_camera(camera, samples, y, n_rows);
    status = draw_band(renderer, drawing, &fine, options, &fine_image, taker, y, sum);
  }
  conic_image_release(context, &fine_image);
  return status;
}

void conic_samples_reduce(conic_context *context, const conic_image *fine, int samples, int first_column, int first_row,
                          conic_image *image) {
  reduction r = {.fine = fine,
                 .image = image,
                 .first_column = (size_t)first_column,
                 .first_row = (size_t)first_row,
                 .samples = (size_t)samples};
  conic_parallel_for(context, (size_t)(fine->height / samples), reduce_row, &r);
}

/* What makes a picture of the bands. */
typedef struct reducer {
  conic_context *context;
  conic_image *image;
  int samples;
} reducer;

static conic_status reduce_band(void *cookie, conic_image *fine, int first_row) {
  const reducer *r = cookie;
  conic_samples_reduce(r->context, fine, r->samples, 0, first_row, r->image);
  return CONIC_OK;
}

static conic_status render_samples(conic_context *context, conic_renderer *renderer, const conic_whole_drawing *drawing,
                                   const conic_camera *camera, const conic_render_options *options, int samples,
                                   conic_image *image, conic_render_statistics *statistics) {
  conic_render_statistics sum;
  double start = conic_seconds_now();
  conic_render_options same = *options;
  reducer r = {context, image, samples};
  const band_taker taker = {reduce_band, &r};
  conic_status status = conic_whole_drawing_scale(context, drawing, &same);
  memset(&sum, 0, sizeof sum);
  if (status == CONIC_OK)
    status = draw_bands(context, renderer, drawing, camera, &same, samples,
                        conic_image_planes(image) & CONIC_DRAWN_PLANES, &taker, &sum);
  if (status == CONIC_OK && conic_samples_band_rows(camera, samples) < camera->height) {
    conic_camera whole = conic_samples_camera(camera, samples, 0, camera->height);
    status = count_whole(context, drawing, &whole, &same, &sum);
  }
  sum.ms.frame = 1e3 * (conic_seconds_now() - start);
  if (status == CONIC_OK && statistics)
    *statistics = sum;
  return status;
}

conic_status conic_render_bands(conic_context *context, conic_renderer *renderer, const conic_drawing *drawing,
                                const conic_camera *camera, const conic_render_options *given, int samples,
                                unsigned planes, conic_samples_receiver *receive, void *cookie) {
  conic_render_options options;
  conic_render_statistics sum;
  conic_whole_drawing whole;
  const band_taker taker = {receive, cookie};
  memset(&sum, 0, sizeof sum);
  conic_status status = conic_view_arguments_take(context, "render", camera, given, &options);
  if (status != CONIC_OK)
    return status;
  status = conic_whole_drawing_enter(context, "render", drawing, &whole);
  if (status == CONIC_OK)
    status = conic_whole_drawing_scale(context, &whole, &options);
  if (status == CONIC_OK)
    status = draw_bands(context, renderer, &whole, camera, &options, samples, planes, &taker, &sum);
  conic_drawing_leave(context, &whole.entered);
  return status;
}

/* What every drawing of a whole picture starts with. */
static conic_status render_checked(conic_context *context, conic_renderer *renderer, const conic_drawing *drawing,
                                   const conic_camera *camera, const conic_render_options *given, int samples,
                                   conic_image *image, conic_render_statistics *statistics) {
  conic_render_options options;
  conic_whole_drawing whole;
  conic_status status = conic_view_arguments_take(context, "render", camera, given, &options);
  if (status != CONIC_OK)
    return status;
  if (!image || !conic_is_zero(image->reserved, sizeof image->reserved))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "render: the image is null, or its reserved words are not zero");
  if (image->width != camera->width || image->height != camera->height)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "render: the image and the camera differ in size");
  if (samples < 1 || samples > CONIC_MAX_SAMPLES || camera->width > CONIC_IMAGE_MAX_SIZE / samples ||
      camera->height > CONIC_IMAGE_MAX_SIZE / samples)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "samples: 1 to %d, and that times the picture's size at most %d",
                      CONIC_MAX_SAMPLES, CONIC_IMAGE_MAX_SIZE);
  status = conic_whole_drawing_enter(context, "render", drawing, &whole);
  if (status == CONIC_OK)
    status = samples == 1 ? conic_render_whole(renderer, &whole, camera, &options, image, statistics)
                          : render_samples(context, renderer, &whole, camera, &options, samples, image, statistics);
  conic_drawing_leave(context, &whole.entered);
  return status;
}

conic_status conic_render_samples(conic_context *context, conic_renderer *renderer, const conic_splats *splats,
                                  const conic_camera *camera, const conic_render_options *options, int samples,
                                  conic_image *image, conic_render_statistics *statistics) {
  const conic_drawing alone = {.splats = splats};
  if (!splats)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "render: the splats are null");
  return render_checked(context, renderer, &alone, camera, options, samples, image, statistics);
}

conic_status conic_render_drawing(conic_context *context, conic_renderer *renderer, const conic_drawing *drawing,
                                  const conic_camera *camera, const conic_render_options *options, int samples,
                                  conic_image *image, conic_render_statistics *statistics) {
  return render_checked(context, renderer, drawing, camera, options, samples, image, statistics);
}
