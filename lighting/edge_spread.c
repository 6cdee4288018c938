#include "lighting/light_work.h"

#include "core/image/image_common.h"

enum { NO_RECEIVER, RECEIVER, RECEIVER_AT_EDGE };

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

/* Counts and marks the pixels that are no receivers of their own, and have one about them or are at an edge. */
static void find_means(void *data, size_t y, int i_thread) {
  const conic_edge_spread *s = data;
  const size_t width = (size_t)s->image->width, reach = s->edge_px;
  const pixel_range range = pixels_about(s, 0, y);
  unsigned char *restrict columns = (unsigned char *)(s->columns + 2 * width * (size_t)i_thread);
  unsigned char *restrict takes_mean = s->takes_mean + pixel_at(s, 0, y);
  const unsigned char *kind = s->kind + pixel_at(s, 0, y);
  uint32_t n = 0;
  memset(columns, 0, width + 2 * reach); /* as many beside the picture */
  for (size_t row = range.top; row < range.bottom; row++)
    for (size_t x = 0; x < width; x++)
      columns[reach + x] |= s->kind[pixel_at(s, x, row)];
  memset(takes_mean, 0, width);
  for (size_t shift = 0; shift <= 2 * reach; shift++)
    for (size_t x = 0; x < width; x++)
      takes_mean[x] |= columns[shift + x];
  for (size_t x = 0; x < width; x++) {
    takes_mean[x] = takes_mean[x] != 0 && kind[x] != RECEIVER;
    n += takes_mean[x];
  }
  s->means_before[y + 1] = n;
}

/* Takes the pixels about one that are of a kind, with depths from nearest to deepest; returns 0 where there are none.
 */
static int take_about(const conic_edge_spread *s, size_t x, size_t y, unsigned char kind, float nearest, float deepest,
                      conic_spread_mean *mean) {
  const float *z = s->image->planes[CONIC_PLANE_Z];
  const pixel_range range = pixels_about(s, x, y);
  const size_t reach = s->edge_px;
  for (size_t j = range.top; j < range.bottom; j++)
    for (size_t i = range.left; i < range.right; i++) {
      size_t pixel = pixel_at(s, i, j), bit = (j + reach - y) * (2 * reach + 1) + (i + reach - x);
      uint64_t is_taken = s->kind[pixel] == kind && !(z[pixel] < nearest || z[pixel] > deepest);
      mean->about[bit / 64] |= is_taken << bit % 64;
    }
  return (mean->about[0] | mean->about[1]) != 0;
}

/* A pixel at an edge gets the mean of its surface's receivers around it; a pixel that is no receiver, but at the border
 * of what is drawn, the mean of the receivers around it. */
static void list_means(void *data, size_t y) {
  const conic_edge_spread *s = data;
  conic_spread_mean *mean = s->means + s->means_before[y];
  for (size_t x = 0, pixel = pixel_at(s, 0, y); x < (size_t)s->image->width; x++, pixel++) {
    if (!s->takes_mean[pixel])
      continue;
    *mean = (conic_spread_mean){.pixel = (uint32_t)pixel};
    if (s->kind[pixel] == RECEIVER_AT_EDGE) {
      float z = ((const float *)s->image->planes[CONIC_PLANE_Z])[pixel], step = depth_of_step(s, x, y);
      take_about(s, x, y, RECEIVER, z - step, z + step, mean);
    } else if (!take_about(s, x, y, RECEIVER, 0.0f, HUGE_VALF, mean))
      take_about(s, x, y, RECEIVER_AT_EDGE, 0.0f, HUGE_VALF, mean);
    mean++;
  }
}

static void name_receivers(conic_edge_spread *s) {
  memset(s->kind, NO_RECEIVER, conic_image_pixels(s->image));
  for (size_t i = 0; i < s->receivers->count; i++)
    s->kind[s->receivers->pixel[i]] = RECEIVER;
}

enum { SPREAD_TOGETHER = 1024 };

static size_t end_of_means(const conic_edge_spread *s, size_t i_item) {
  const size_t n = s->means_before[s->image->height], end = (i_item + 1) * SPREAD_TOGETHER;
  return end < n ? end : n;
}

static void find_values(void *data, size_t i_item) {
  const conic_edge_spread *s = data;
  for (size_t i = i_item * SPREAD_TOGETHER; i < end_of_means(s, i_item); i++) {
    conic_spread_mean *mean = &s->means[i];
    const float *own = s->filled + mean->pixel;
    float sum = 0.0f, n = 0.0f;
    for (int word = 0; word < 2; word++)
      for (uint64_t left = mean->about[word]; left; left &= left - 1) {
        sum += own[s->offsets[64 * word + __builtin_ctzll(left)]];
        n += 1.0f;
      }
    mean->value = n > 0.0f ? sum / n : *own;
  }
}

static void place_means(void *data, size_t i_item) {
  const conic_edge_spread *s = data;
  for (size_t i = i_item * SPREAD_TOGETHER; i < end_of_means(s, i_item); i++)
    s->filled[s->means[i].pixel] = s->means[i].value;
}

static void fill_others(void *data, size_t y) {
  const conic_edge_spread *s = data;
  const unsigned char *kind = s->kind + pixel_at(s, 0, y);
  float *restrict filled = s->filled + pixel_at(s, 0, y);
  for (size_t x = 0; x < (size_t)s->image->width; x++)
    filled[x] = kind[x] == NO_RECEIVER ? s->otherwise : filled[x];
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
    work->s->filled[receivers->pixel[i]] = work->of_receivers[i];
}

void conic_edge_spread_fill(conic_edge_spread *s, const float *of_receivers, float otherwise) {
  const int is_as_before = s->otherwise == otherwise;
  const size_t n_items = (s->receivers->count + CONIC_RECEIVED_TOGETHER - 1) / CONIC_RECEIVED_TOGETHER,
               n_means = (s->means_before[s->image->height] + SPREAD_TOGETHER - 1) / SPREAD_TOGETHER;
  own_values work = {s, of_receivers};
  s->otherwise = otherwise;
  if (!is_as_before)
    conic_parallel_for(s->context, (size_t)s->image->height, fill_others, s);
  conic_parallel_for(s->context, n_items, place_values, &work);
  conic_parallel_for(s->context, n_means, find_values, s);
  conic_parallel_for(s->context, n_means, place_means, s);
}

conic_status conic_edge_spread_init(conic_context *context, const conic_camera *camera, const conic_image *image,
                                    const conic_receivers *receivers, double epsilon, int samples,
                                    conic_edge_spread *s) {
  const size_t n = conic_image_pixels(image), width = (size_t)image->width, height = (size_t)image->height;
  double edge = epsilon > 0.0 ? 0.5 * epsilon / receivers->spacing : 0.0;
  *s = (conic_edge_spread){.context = context,
                           .image = image,
                           .receivers = receivers,
                           .epsilon = (float)epsilon,
                           .samples = samples,
                           .otherwise = NAN,
                           .edge_px =
                               edge > 1.0 ? edge < CONIC_MOST_SPREAD_PX ? (size_t)edge : CONIC_MOST_SPREAD_PX : 1};
  conic_camera_rays_init(camera, &s->rays);
  if (conic_memory_allocate_these(context, CONIC_ROOM(s->filled, n), CONIC_ROOM(s->kind, 2 * n),
                                  CONIC_ROOM(s->means_before, height + 1),
                                  CONIC_ROOM(s->columns, (width + (size_t)2 * CONIC_MOST_SPREAD_PX) * 2 *
                                                             (size_t)conic_context_threads(context))) != CONIC_OK)
    return CONIC_ERROR_MEMORY;
  s->takes_mean = s->kind + n;
  name_receivers(s);
  if (s->epsilon > 0.0f || samples > 1)
    conic_parallel_for(context, height, find_receivers_at_edges, s);
  s->means_before[0] = 0;
  conic_parallel_for(context, height, find_means, s);
  for (size_t y = 0; y < height; y++)
    s->means_before[y + 1] += s->means_before[y];
  s->means = conic_memory_allocate(context, s->means_before[height], sizeof *s->means);
  if (!s->means)
    return CONIC_ERROR_MEMORY;
  for (int bit = 0, edge_px = (int)s->edge_px, across = 2 * edge_px + 1; bit < across * across; bit++)
    s->offsets[bit] = (bit / across - edge_px) * (ptrdiff_t)width + (bit % across - edge_px);
  conic_parallel_for(context, height, list_means, s);
  return CONIC_OK;
}

void conic_edge_spread_release(conic_edge_spread *s) {
  if (!s->context)
    return;
  conic_memory_release_these(s->context, s->means, s->columns, s->means_before, s->kind, s->filled);
}
