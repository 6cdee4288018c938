#include "lighting/light_work.h"

#include "core/image/image_common.h"

enum { NO_RECEIVER, RECEIVER, RECEIVER_AT_EDGE, MOST_EDGE_PX = 4 };

static size_t pixel_at(const conic_edge_spread *s, size_t x, size_t y) {
  return y * (size_t)s->image->width + x;
}

/* How much deeper a neighbour may be on the same surface, which is seen at an angle with this cosine. */
static float step_at(const conic_edge_spread *s, float cosine) {
  static const float steps = 4.0f;
  return steps * (s->epsilon + (float)s->receivers->spacing / cosine);
}

static float depth_of_step(const conic_edge_spread *s, size_t x, size_t y) {
  static const float least_cosine = 0.03f;
  const float *n = (const float *)s->image->planes[CONIC_PLANE_NORMAL] + 3 * pixel_at(s, x, y);
  float viewer[3];
  conic_pixel_viewer(&s->rays, x, y, viewer);
  float cosine = (n[0] * viewer[0] + n[1] * viewer[1]) + n[2] * viewer[2];
  return step_at(s, cosine > least_cosine ? cosine : least_cosine);
}

/* The pixels at most so many away as splats stick out, without those beyond the picture's edges. */
typedef struct pixel_range {
  size_t left, right, top, bottom; /* right and bottom are one past the last */
} pixel_range;

static pixel_range pixels_about(const conic_edge_spread *s, size_t x, size_t y) {
  size_t width = (size_t)s->image->width, height = (size_t)s->image->height, reach = s->edge_px;
  return (pixel_range){x > reach ? x - reach : 0, x + reach < width ? x + reach + 1 : width, y > reach ? y - reach : 0,
                       y + reach < height ? y + reach + 1 : height};
}

/* Whether no pixel is farther from `here` than the step. */
static int is_one_surface(const conic_edge_spread *s, const pixel_range *range, float here, float step) {
  const float *z = s->image->planes[CONIC_PLANE_Z];
  float least = s->samples > 1 ? here - step : 0.0f;
  for (size_t j = range->top; j < range->bottom; j++)
    for (size_t i = range->left; i < range->right; i++) {
      float there = z[pixel_at(s, i, j)];
      if (!(there > least) || there > here + step)
        return 0;
    }
  return 1;
}

/* Whether a pixel is at an edge, where it should not use its own light. Splats stick out where a surface turns away.
 * Those of the far side are then seen from behind: they take the visible side for their outer one, on which there is no
 * light. And several samples on two surfaces have a mean normal that is neither's. */
static int is_at_edge(const conic_edge_spread *s, size_t x, size_t y) {
  static const float greatest_cosine = 1.5f; /* the normals of receivers are at most √2 long */
  float here = ((const float *)s->image->planes[CONIC_PLANE_Z])[pixel_at(s, x, y)];
  pixel_range range = pixels_about(s, x, y);
  return !is_one_surface(s, &range, here, step_at(s, greatest_cosine)) &&
         !is_one_surface(s, &range, here, depth_of_step(s, x, y));
}

static void find_receivers_at_edges(void *data, size_t y) {
  const conic_edge_spread *s = data;
  for (size_t x = 0; x < (size_t)s->image->width; x++)
    if (s->kind[pixel_at(s, x, y)] == RECEIVER && is_at_edge(s, x, y))
      s->kind[pixel_at(s, x, y)] = RECEIVER_AT_EDGE;
}

static int has_receiver_about(const conic_edge_spread *s, size_t x, size_t y) {
  pixel_range range = pixels_about(s, x, y);
  for (size_t j = range.top; j < range.bottom; j++)
    for (size_t i = range.left; i < range.right; i++)
      if (s->kind[pixel_at(s, i, j)] != NO_RECEIVER)
        return 1;
  return 0;
}

static void find_alone(void *data, size_t y) {
  const conic_edge_spread *s = data;
  for (size_t x = 0; x < (size_t)s->image->width; x++)
    s->is_alone[pixel_at(s, x, y)] = s->kind[pixel_at(s, x, y)] == NO_RECEIVER && !has_receiver_about(s, x, y);
}

static void name_receivers(conic_edge_spread *s) {
  memset(s->kind, NO_RECEIVER, conic_image_pixels(s->image));
  for (size_t i = 0; i < s->receivers->count; i++)
    s->kind[s->receivers->pixel[i]] = RECEIVER;
}

/* The mean over the pixels around one that are of a kind, with depths from nearest to deepest; returns 0 where there
 * are none. */
static int mean_about(const conic_edge_spread *s, size_t x, size_t y, unsigned char kind, float nearest, float deepest,
                      float *mean) {
  const float *z = s->image->planes[CONIC_PLANE_Z];
  pixel_range range = pixels_about(s, x, y);
  float sum = 0.0f, n = 0.0f;
  for (size_t j = range.top; j < range.bottom; j++)
    for (size_t i = range.left; i < range.right; i++) {
      size_t pixel = pixel_at(s, i, j);
      if (s->kind[pixel] != kind || z[pixel] < nearest || z[pixel] > deepest)
        continue;
      sum += s->own[pixel];
      n += 1.0f;
    }
  *mean = sum / n;
  return n > 0.0f;
}

/* What a pixel gets that is neither a receiver, which gets its own value, nor alone: one at an edge the mean of its
 * surface's receivers around it; a pixel that is no receiver, but at the border of what is drawn, the mean of the
 * receivers around it. */
static float spread_at(const conic_edge_spread *s, size_t x, size_t y) {
  size_t pixel = pixel_at(s, x, y);
  float mean;
  if (s->kind[pixel] == RECEIVER_AT_EDGE) {
    float z = ((const float *)s->image->planes[CONIC_PLANE_Z])[pixel], step = depth_of_step(s, x, y);
    return mean_about(s, x, y, RECEIVER, z - step, z + step, &mean) ? mean : s->own[pixel];
  }
  return mean_about(s, x, y, RECEIVER, 0.0f, HUGE_VALF, &mean) ||
                 mean_about(s, x, y, RECEIVER_AT_EDGE, 0.0f, HUGE_VALF, &mean)
             ? mean
             : s->otherwise;
}

static void fill_row(void *data, size_t y) {
  const conic_edge_spread *s = data;
  size_t width = (size_t)s->image->width, first = pixel_at(s, 0, y);
  const unsigned char *kind = s->kind + first, *is_alone = s->is_alone + first;
  float *filled = s->filled + first;
  for (size_t x = 0; x < width; x++)
    filled[x] = kind[x] == RECEIVER ? s->own[first + x] : s->otherwise;
  for (size_t x = 0; x < width; x++)
    if (kind[x] != RECEIVER && !is_alone[x])
      filled[x] = spread_at(s, x, y);
}

void conic_edge_spread_fill(conic_edge_spread *s, const float *of_receivers, float otherwise) {
  for (size_t i = 0; i < s->receivers->count; i++)
    s->own[s->receivers->pixel[i]] = of_receivers[i];
  s->otherwise = otherwise;
  conic_parallel_for(s->context, (size_t)s->image->height, fill_row, s);
}

conic_status conic_edge_spread_init(conic_context *context, const conic_camera *camera, const conic_image *image,
                                    const conic_receivers *receivers, double epsilon, int samples,
                                    conic_edge_spread *s) {
  size_t n = conic_image_pixels(image);
  double edge = epsilon > 0.0 ? 0.5 * epsilon / receivers->spacing : 0.0;
  *s = (conic_edge_spread){.context = context,
                           .image = image,
                           .receivers = receivers,
                           .epsilon = (float)epsilon,
                           .samples = samples,
                           .edge_px = edge > 1.0 ? edge < MOST_EDGE_PX ? (size_t)edge : MOST_EDGE_PX : 1};
  conic_camera_rays_init(camera, &s->rays);
  s->own = conic_memory_allocate(context, n, sizeof *s->own);
  s->filled = conic_memory_allocate(context, n, sizeof *s->filled);
  s->kind = conic_memory_allocate(context, n, 2);
  if (!s->own || !s->filled || !s->kind)
    return CONIC_ERROR_MEMORY;
  s->is_alone = s->kind + n;
  name_receivers(s);
  if (s->epsilon > 0.0f || samples > 1)
    conic_parallel_for(context, (size_t)image->height, find_receivers_at_edges, s);
  conic_parallel_for(context, (size_t)image->height, find_alone, s);
  return CONIC_OK;
}

void conic_edge_spread_release(conic_edge_spread *s) {
  if (!s->context)
    return;
  conic_memory_release_these(s->context, s->kind, s->filled, s->own);
}
