/* Structural similarity (Wang, Bovik, Sheikh, Simoncelli 2004) and squared differences of the colour as a screen shows
 * it, channel by channel, in memory for a few rows. */

#include "core/image/compare.h"
#include "core/image/image_common.h"

enum { WINDOW = 11, RADIUS = WINDOW / 2, N_MOMENTS = 5 };

/* The Gaussian of σ = 1.5 px at 0 … 10 px, of sum 1. */
static const double window_weight[WINDOW] = {0.00102838008447911,  0.007598758135239185, 0.03600077212843083,
                                             0.10936068950970002,  0.2130055377112537,   0.26601172486179436,
                                             0.2130055377112537,   0.10936068950970002,  0.03600077212843083,
                                             0.007598758135239185, 0.00102838008447911};

/* Buffers and results of one channel. */
typedef struct channel_work {
  double *a, *b;    /* a row's encoded values */
  double *moments;  /* of a row, before filtering: a, b, a², b², ab, one array after the other, with zeros between */
  double *filtered; /* WINDOW rows of moments, filtered across; row y is at y mod WINDOW */
  double *windows;  /* filtered down too: the moments about each pixel */
  conic_color_difference found;
} channel_work;

typedef struct color_work {
  const conic_image *a, *b;
  size_t width, height;
  int is_window; /* the picture is smaller than a window, and is one window with equal weights */
  int is_display;
  channel_work channels[3];
} color_work;

static void encode_row(const color_work *work, int channel, size_t y) {
  const channel_work *buffers = &work->channels[channel];
  size_t first = y * work->width * 4 + (size_t)channel;
  const float *a = (const float *)work->a->planes[CONIC_PLANE_RGBA] + first;
  const float *b = (const float *)work->b->planes[CONIC_PLANE_RGBA] + first;
  for (size_t x = 0; x < work->width; x++) {
    buffers->a[x] = conic_screen_value(a[4 * x], work->is_display);
    buffers->b[x] =
        conic_same_bits(a[4 * x], b[4 * x]) ? buffers->a[x] : conic_screen_value(b[4 * x], work->is_display);
  }
}

static double row_sum_of_squares(const color_work *work, const channel_work *buffers) {
  double sum = 0.0;
  for (size_t x = 0; x < work->width; x++)
    sum += (buffers->a[x] - buffers->b[x]) * (buffers->a[x] - buffers->b[x]);
  return sum;
}

static size_t padded_width(const color_work *work) {
  return work->width + (size_t)2 * RADIUS;
}

static void find_moments(const color_work *work, const channel_work *buffers) {
  size_t stride = padded_width(work);
  const double *a = buffers->a, *b = buffers->b;
  double *restrict moments = buffers->moments + RADIUS;
  for (size_t x = 0; x < work->width; x++) {
    moments[x] = a[x];
    moments[stride + x] = b[x];
    moments[2 * stride + x] = a[x] * a[x];
    moments[3 * stride + x] = b[x] * b[x];
    moments[4 * stride + x] = a[x] * b[x];
  }
}

static void filter_across(const color_work *work, const channel_work *buffers, size_t y) {
  size_t n = work->width;
  double *row = buffers->filtered + y % WINDOW * N_MOMENTS * n;
  memset(row, 0, N_MOMENTS * n * sizeof *row);
  for (size_t m = 0; m < N_MOMENTS; m++)
    for (size_t k = 0; k < WINDOW; k++)
      conic_add_weighted(row + m * n, buffers->moments + m * padded_width(work) + k, window_weight[k], n);
}

/* Fills the windows about the pixels of row y. */
static void filter_down(const color_work *work, const channel_work *buffers, size_t y) {
  size_t n = N_MOMENTS * work->width;
  memset(buffers->windows, 0, n * sizeof *buffers->windows);
  for (size_t k = 0; k < WINDOW; k++)
    if (y + k >= RADIUS && y + k - RADIUS < work->height)
      conic_add_weighted(buffers->windows, buffers->filtered + (y + k - RADIUS) % WINDOW * n, window_weight[k], n);
}

/* The index of one window from its means of a, b, a², b², ab. */
static double window_ssim(double a, double b, double aa, double bb, double ab) {
  const double c1 = 0.01 * 0.01, c2 = 0.03 * 0.03;
  double variance_a = aa - a * a, variance_b = bb - b * b, covariance = ab - a * b;
  return (2.0 * (a * b) + c1) * (2.0 * covariance + c2) / ((a * a + b * b + c1) * (variance_a + variance_b + c2));
}

/* Adds a row of windows: those that lie wholly inside to ssim, and all of them to ssim_padded. */
static void add_row_ssim(const color_work *work, channel_work *buffers, size_t y) {
  size_t n = work->width;
  const double *means = buffers->windows;
  double inside = 0.0, all = 0.0;
  for (size_t x = 0; x < n; x++) {
    double ssim = window_ssim(means[x], means[n + x], means[2 * n + x], means[3 * n + x], means[4 * n + x]);
    all += ssim;
    if (x >= RADIUS && x + RADIUS < n)
      inside += ssim;
  }
  buffers->found.ssim_padded += all;
  if (y >= RADIUS && y + RADIUS < work->height)
    buffers->found.ssim += inside;
}

static void add_moments(const color_work *work, const channel_work *buffers, double sums[N_MOMENTS]) {
  for (size_t m = 0; m < N_MOMENTS; m++)
    for (size_t x = 0; x < work->width; x++)
      sums[m] += buffers->moments[m * padded_width(work) + RADIUS + x];
}

static void compare_channel(void *data, size_t i_item) {
  color_work *work = data;
  channel_work *buffers = &work->channels[i_item];
  double whole[N_MOMENTS] = {0}, n = (double)(work->width * work->height);
  for (size_t y = 0; y < work->height + RADIUS; y++) {
    if (y < work->height) {
      encode_row(work, (int)i_item, y);
      buffers->found.sum_of_squares += row_sum_of_squares(work, buffers);
      find_moments(work, buffers);
      if (work->is_window)
        add_moments(work, buffers, whole);
      filter_across(work, buffers, y);
    }
    if (y < RADIUS)
      continue;
    filter_down(work, buffers, y - RADIUS);
    add_row_ssim(work, buffers, y - RADIUS);
  }
  buffers->found.ssim_padded /= n;
  if (work->is_window)
    buffers->found.ssim = window_ssim(whole[0] / n, whole[1] / n, whole[2] / n, whole[3] / n, whole[4] / n);
  else
    buffers->found.ssim /= (double)((work->width + 1 - WINDOW) * (work->height + 1 - WINDOW));
}

/* Allocates one block for the rows of all three channels. */
static double *allocate_rows(conic_context *context, color_work *work) {
  size_t n_windows = N_MOMENTS * work->width;
  size_t n = 2 * work->width + N_MOMENTS * padded_width(work) + (WINDOW + 1) * n_windows;
  double *block = conic_memory_allocate_zeroed(context, 3 * n, sizeof *block);
  for (size_t c = 0; block && c < 3; c++) {
    channel_work *buffers = &work->channels[c];
    buffers->a = block + c * n;
    buffers->b = buffers->a + work->width;
    buffers->moments = buffers->b + work->width;
    buffers->filtered = buffers->moments + N_MOMENTS * padded_width(work);
    buffers->windows = buffers->filtered + WINDOW * n_windows;
  }
  return block;
}

conic_status conic_compare_color(conic_context *context, const conic_image *a, const conic_image *b,
                                 conic_color_difference *difference) {
  color_work work = {.a = a, .b = b, .width = (size_t)a->width, .height = (size_t)a->height};
  work.is_window = work.width < WINDOW || work.height < WINDOW;
  work.is_display = a->is_display != 0;
  double *block = allocate_rows(context, &work);
  if (!block)
    return CONIC_ERROR_MEMORY;
  conic_parallel_for(context, 3, compare_channel, &work);
  conic_memory_release(context, block);
  memset(difference, 0, sizeof *difference);
  for (int c = 0; c < 3; c++) {
    difference->sum_of_squares += work.channels[c].found.sum_of_squares;
    difference->ssim += work.channels[c].found.ssim;
    difference->ssim_padded += work.channels[c].found.ssim_padded;
  }
  difference->ssim /= 3.0;
  difference->ssim_padded /= 3.0;
  return CONIC_OK;
}
