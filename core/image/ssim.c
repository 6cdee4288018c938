/* Structural similarity (Wang, Bovik, Sheikh, Simoncelli 2004) and squared differences of the sRGB-encoded colour, a
 * channel at a time, row by row in memory of a few rows. */
#include <string.h>

#include "core/base/memory.h"
#include "core/base/threads.h"
#include "core/image/compare.h"
#include "core/image/image_common.h"

enum { WINDOW = 11, N_MOMENTS = 5 };

/* The Gaussian of σ = 1.5 px at 0 … 10 px, of sum 1. */
static const double window_weight[WINDOW] = {0.00102838008447911,  0.007598758135239185, 0.03600077212843083,
                                             0.10936068950970002,  0.2130055377112537,   0.26601172486179436,
                                             0.2130055377112537,   0.10936068950970002,  0.03600077212843083,
                                             0.007598758135239185, 0.00102838008447911};

/* What one channel needs and gives. */
typedef struct channel_work {
  double *a, *b;    /* a row's encoded values */
  double *moments;  /* of a row, before filtering: a, b, a², b², ab, one array after the other */
  double *filtered; /* WINDOW rows of them, filtered across; row y is at y mod WINDOW */
  double *windows;  /* filtered down too */
  double sum_of_squares, ssim;
} channel_work;

typedef struct color_work {
  const conic_image *a, *b;
  size_t width, height, n_across; /* n_across windows stand side by side */
  channel_work channels[3];
} color_work;

static void encode_row(const color_work *work, int channel, size_t y) {
  const channel_work *buffers = &work->channels[channel];
  size_t first = y * work->width * 4 + (size_t)channel;
  const float *a = (const float *)work->a->planes[CONIC_PLANE_RGBA] + first;
  const float *b = (const float *)work->b->planes[CONIC_PLANE_RGBA] + first;
  for (size_t x = 0; x < work->width; x++) {
    buffers->a[x] = conic_screen_value(a[4 * x]);
    buffers->b[x] = conic_same_bits(a[4 * x], b[4 * x]) ? buffers->a[x] : conic_screen_value(b[4 * x]);
  }
}

static double row_sum_of_squares(const color_work *work, const channel_work *buffers) {
  double sum = 0.0;
  for (size_t x = 0; x < work->width; x++)
    sum += (buffers->a[x] - buffers->b[x]) * (buffers->a[x] - buffers->b[x]);
  return sum;
}

static void find_moments(const color_work *work, const channel_work *buffers) {
  size_t n = work->width;
  const double *a = buffers->a, *b = buffers->b;
  double *restrict moments = buffers->moments;
  for (size_t x = 0; x < n; x++) {
    moments[x] = a[x];
    moments[n + x] = b[x];
    moments[2 * n + x] = a[x] * a[x];
    moments[3 * n + x] = b[x] * b[x];
    moments[4 * n + x] = a[x] * b[x];
  }
}

static void filter_across(const color_work *work, const channel_work *buffers, size_t y) {
  double *row = buffers->filtered + y % WINDOW * N_MOMENTS * work->n_across;
  memset(row, 0, N_MOMENTS * work->n_across * sizeof *row);
  for (size_t m = 0; m < N_MOMENTS; m++)
    for (size_t k = 0; k < WINDOW; k++)
      conic_add_weighted(row + m * work->n_across, buffers->moments + m * work->width + k, window_weight[k],
                         work->n_across);
}

/* The windows whose last row is y. */
static void filter_down(const color_work *work, const channel_work *buffers, size_t y) {
  size_t n = N_MOMENTS * work->n_across;
  memset(buffers->windows, 0, n * sizeof *buffers->windows);
  for (size_t k = 0; k < WINDOW; k++)
    conic_add_weighted(buffers->windows, buffers->filtered + (y + 1 - WINDOW + k) % WINDOW * n, window_weight[k], n);
}

/* The index of one window from its means of a, b, a², b², ab. */
static double window_ssim(double a, double b, double aa, double bb, double ab) {
  const double c1 = 0.01 * 0.01, c2 = 0.03 * 0.03;
  double variance_a = aa - a * a, variance_b = bb - b * b, covariance = ab - a * b;
  return (2.0 * (a * b) + c1) * (2.0 * covariance + c2) / ((a * a + b * b + c1) * (variance_a + variance_b + c2));
}

static double row_ssim(const color_work *work, const channel_work *buffers) {
  size_t n = work->n_across;
  const double *means = buffers->windows;
  double sum = 0.0;
  for (size_t x = 0; x < n; x++)
    sum += window_ssim(means[x], means[n + x], means[2 * n + x], means[3 * n + x], means[4 * n + x]);
  return sum;
}

static void compare_channel(void *data, size_t i_item, int i_thread) {
  color_work *work = data;
  channel_work *buffers = &work->channels[i_item];
  double whole[N_MOMENTS] = {0}, sum = 0.0;
  (void)i_thread;
  for (size_t y = 0; y < work->height; y++) {
    encode_row(work, (int)i_item, y);
    buffers->sum_of_squares += row_sum_of_squares(work, buffers);
    find_moments(work, buffers);
    if (work->n_across == 0) { /* too small for a window */
      for (size_t i = 0; i < N_MOMENTS * work->width; i++)
        whole[i / work->width] += buffers->moments[i];
      continue;
    }
    filter_across(work, buffers, y);
    if (y + 1 < WINDOW)
      continue;
    filter_down(work, buffers, y);
    sum += row_ssim(work, buffers);
  }
  double n = (double)(work->width * work->height);
  buffers->ssim = work->n_across ? sum / (double)(work->n_across * (work->height + 1 - WINDOW))
                                 : window_ssim(whole[0] / n, whole[1] / n, whole[2] / n, whole[3] / n, whole[4] / n);
}

/* One block for the three channels; each has its rows in it. */
static double *allocate_rows(conic_context *context, color_work *work) {
  size_t n_row = work->width, n_windows = N_MOMENTS * work->n_across;
  size_t n = (2 + N_MOMENTS) * n_row + (WINDOW + 1) * n_windows;
  double *block = conic_memory_allocate(context, 3 * n, sizeof *block);
  for (size_t c = 0; block && c < 3; c++) {
    channel_work *buffers = &work->channels[c];
    buffers->a = block + c * n;
    buffers->b = buffers->a + n_row;
    buffers->moments = buffers->b + n_row;
    buffers->filtered = buffers->moments + N_MOMENTS * n_row;
    buffers->windows = buffers->filtered + WINDOW * n_windows;
  }
  return block;
}

conic_status conic_compare_color(conic_context *context, const conic_image *a, const conic_image *b,
                                 double *sum_of_squares, double *ssim) {
  color_work work = {.a = a, .b = b, .width = (size_t)a->width, .height = (size_t)a->height};
  if (work.width >= WINDOW && work.height >= WINDOW)
    work.n_across = work.width + 1 - WINDOW;
  double *block = allocate_rows(context, &work);
  if (!block)
    return CONIC_ERROR_MEMORY;
  conic_parallel_for(context, 3, compare_channel, &work);
  conic_memory_release(context, block);
  const channel_work *channels = work.channels;
  *sum_of_squares = channels[0].sum_of_squares + channels[1].sum_of_squares + channels[2].sum_of_squares;
  *ssim = (channels[0].ssim + channels[1].ssim + channels[2].ssim) / 3.0;
  return CONIC_OK;
}
