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

/* The least and the greatest depth of a column of pixels; the least is below all numbers where one is none. */
typedef struct column_depths {
  float *least, *greatest;
} column_depths;

static void look_down_columns(const conic_edge_spread *s, size_t y, column_depths *columns) {
  const pixel_range range = pixels_about(s, 0, y);
  const size_t width = (size_t)s->image->width;
  for (size_t row = range.top; row < range.bottom; row++) {
    const float *z = (const float *)s->image->planes[CONIC_PLANE_Z] + pixel_at(s, 0, row);
    float *restrict least = columns->least, *restrict greatest = columns->greatest;
    const int is_first = row == range.top;
    for (size_t x = 0; x < width; x++) {
      float low = z[x] == z[x] ? z[x] : -HUGE_VALF, so_far = is_first ? HUGE_VALF : least[x];
      float high = z[x], so_high = is_first ? -HUGE_VALF : greatest[x];
      least[x] = low < so_far ? low : so_far;
      greatest[x] = high > so_high ? high : so_high;
    }
  }
}

/* Whether no pixel about it is farther than the step. */
static int is_one_surface(const conic_edge_spread *s, const pixel_range *range, const column_depths *columns,
                          float here, float step) {
  float least = s->samples > 1 ? here - step : 0.0f, deepest = here + step;
  int is_far = 0;
  for (size_t i = range->left; i < range->right; i++)
    is_far |= !(columns->least[i] > least) | (columns->greatest[i] > deepest);
  return !is_far;
}

/* Whether a pixel is at an edge, where it should not use its own light. Splats stick out where a surface turns away.
 * Those of the far side are then seen from behind: they take the visible side for their outer one, on which there is no
 * light. And several samples on two surfaces have a mean normal that is neither's. */
static int is_at_edge(const conic_edge_spread *s, const column_depths *columns, size_t x, size_t y) {
  static const float greatest_cosine = 1.5f; /* the normals of receivers are at most √2 long */
  float here = ((const float *)s->image->planes[CONIC_PLANE_Z])[pixel_at(s, x, y)];
  pixel_range range = pixels_about(s, x, y);
  return !is_one_surface(s, &range, columns, here, step_at(s, greatest_cosine)) &&
         !is_one_surface(s, &range, columns, here, depth_of_step(s, x, y));
}

static void find_receivers_at_edges(void *data, size_t y, int i_thread) {
  const conic_edge_spread *s = data;
  const size_t width = (size_t)s->image->width;
  float *room = s->columns + 2 * width * (size_t)i_thread;
  column_depths columns = {room, room + width};
  if (!memchr(s->kind + pixel_at(s, 0, y), RECEIVER, width))
    return;
  look_down_columns(s, y, &columns);
  for (size_t x = 0; x < width; x++)
    if (s->kind[pixel_at(s, x, y)] == RECEIVER && is_at_edge(s, &columns, x, y))
      s->kind[pixel_at(s, x, y)] = RECEIVER_AT_EDGE;
}

/* Pixels that are no receivers of their own, and have one about them or are at an edge. */
static void find_means(void *data, size_t y, int i_thread) {
  const conic_edge_spread *s = data;
  const size_t width = (size_t)s->image->width, reach = s->edge_px;
  const pixel_range range = pixels_about(s, 0, y);
  unsigned char *restrict columns = (unsigned char *)(s->columns + 2 * width * (size_t)i_thread);
  unsigned char *restrict takes_mean = s->takes_mean + pixel_at(s, 0, y);
  const unsigned char *kind = s->kind + pixel_at(s, 0, y);
  memset(columns, 0, width + 2 * reach); /* as many beside the picture */
  for (size_t row = range.top; row < range.bottom; row++)
    for (size_t x = 0; x < width; x++)
      columns[reach + x] |= s->kind[pixel_at(s, x, row)];
  memset(takes_mean, 0, width);
  for (size_t shift = 0; shift <= 2 * reach; shift++)
    for (size_t x = 0; x < width; x++)
      takes_mean[x] |= columns[shift + x];
  size_t begin = 0, end = width;
  for (; end > 0 && !takes_mean[end - 1]; end--)
    ;
  for (; begin < end && !takes_mean[begin]; begin++)
    ;
  s->ends[y][0] = (uint32_t)begin;
  s->ends[y][1] = (uint32_t)end;
  for (size_t x = 0; x < width; x++)
    takes_mean[x] = takes_mean[x] != 0 && kind[x] != RECEIVER;
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

/* What a pixel gets that takes a mean: one at an edge the mean of its
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
  const size_t first = pixel_at(s, s->ends[y][0], y), n = s->ends[y][1] - s->ends[y][0];
  const unsigned char *kind = s->kind + first, *takes_mean = s->takes_mean + first;
  const float *own = s->own + first, otherwise = s->otherwise;
  float *restrict filled = s->filled + first;
  for (size_t i = 0; i < n; i++) {
    float value = own[i];
    filled[i] = kind[i] == RECEIVER ? value : otherwise;
  }
  for (const unsigned char *next = takes_mean; (next = memchr(next, 1, n - (size_t)(next - takes_mean))); next++)
    filled[next - takes_mean] = spread_at(s, s->ends[y][0] + (size_t)(next - takes_mean), y);
}

static void fill_beside(void *data, size_t y) {
  const conic_edge_spread *s = data;
  float *filled = s->filled + pixel_at(s, 0, y);
  for (size_t x = 0; x < s->ends[y][0]; x++)
    filled[x] = s->otherwise;
  for (size_t x = s->ends[y][1]; x < (size_t)s->image->width; x++)
    filled[x] = s->otherwise;
}

typedef struct own_values {
  const conic_edge_spread *s;
  const float *of_receivers;
} own_values;

static void place_values(void *data, size_t i_item) {
  const own_values *work = data;
  const conic_receivers *receivers = work->s->receivers;
  size_t begin = i_item * CONIC_RECEIVED_TOGETHER, end = begin + CONIC_RECEIVED_TOGETHER;
  end = end < receivers->count ? end : receivers->count;
  for (size_t i = begin; i < end; i++)
    work->s->own[receivers->pixel[i]] = work->of_receivers[i];
}

void conic_edge_spread_fill(conic_edge_spread *s, const float *of_receivers, float otherwise) {
  const int is_as_before = s->otherwise == otherwise;
  const size_t n_items = (s->receivers->count + CONIC_RECEIVED_TOGETHER - 1) / CONIC_RECEIVED_TOGETHER;
  own_values work = {s, of_receivers};
  s->otherwise = otherwise;
  conic_parallel_for(s->context, n_items, place_values, &work);
  if (!is_as_before)
    conic_parallel_for(s->context, (size_t)s->image->height, fill_beside, s);
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
                           .otherwise = NAN,
                           .edge_px = edge > 1.0 ? edge < MOST_EDGE_PX ? (size_t)edge : MOST_EDGE_PX : 1};
  conic_camera_rays_init(camera, &s->rays);
  s->own = conic_memory_allocate(context, n, sizeof *s->own);
  s->filled = conic_memory_allocate(context, n, sizeof *s->filled);
  s->kind = conic_memory_allocate(context, n, 2);
  s->ends = conic_memory_allocate(context, (size_t)image->height, sizeof *s->ends);
  s->columns = conic_memory_allocate(context, (size_t)image->width + 2 * MOST_EDGE_PX,
                                     2 * (size_t)conic_context_threads(context) * sizeof *s->columns);
  if (!s->own || !s->filled || !s->kind || !s->ends || !s->columns)
    return CONIC_ERROR_MEMORY;
  s->takes_mean = s->kind + n;
  name_receivers(s);
  if (s->epsilon > 0.0f || samples > 1)
    conic_parallel_for(context, (size_t)image->height, find_receivers_at_edges, s);
  conic_parallel_for(context, (size_t)image->height, find_means, s);
  return CONIC_OK;
}

void conic_edge_spread_release(conic_edge_spread *s) {
  if (!s->context)
    return;
  conic_memory_release_these(s->context, s->columns, s->ends, s->kind, s->filled, s->own);
}
