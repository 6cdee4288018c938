/* Automatic exposure: as bright as a picture can be while few of its pixels are nearly white. */
#include "conic/image.h"
#include "core/base/color.h"

/* In eighths of a stop. */
enum { DARKEST = -128, BRIGHTEST = 128, N_STEPS = BRIGHTEST - DARKEST + 1, STEPS_A_STOP = 8 };

/* Nearly white: 2^(-3/8), which sRGB shows as 227 of 255; one covered pixel in so many may be nearly white. */
enum { WHITE_STEPS = -3, ONE_IN = 20 };

/* The first step at which a pixel becomes nearly white; N_STEPS: none. */
static int whitening_step(const float limits[N_STEPS], double luminance, double alpha) {
  int low = 0, high = N_STEPS;
  while (low < high) {
    int middle = (low + high) / 2;
    if (luminance > (double)limits[middle] * alpha)
      high = middle;
    else
      low = middle + 1;
  }
  return low;
}

double conic_image_exposure(const conic_image *image) {
  const float *pixel = image->planes[CONIC_PLANE_RGBA];
  size_t n_pixels = (size_t)image->width * (size_t)image->height, counts[N_STEPS + 1] = {0}, n_covered = 0, n_white = 0;
  float limits[N_STEPS];
  for (int i = 0; i < N_STEPS; i++)
    limits[i] = conic_exposure_factor((double)(WHITE_STEPS - (DARKEST + i)) / STEPS_A_STOP);
  for (size_t i = 0; pixel && i < n_pixels; i++, pixel += 4) {
    double luminance = 0.2126 * (double)pixel[0] + 0.7152 * (double)pixel[1] + 0.0722 * (double)pixel[2];
    if (!(pixel[3] >= 0.5f))
      continue;
    n_covered++;
    counts[whitening_step(limits, luminance, (double)pixel[3])]++;
  }
  int i = 0;
  while (i < N_STEPS && (n_white + counts[i]) * ONE_IN <= n_covered)
    n_white += counts[i++];
  return i == 0 ? (double)DARKEST / STEPS_A_STOP : i == N_STEPS ? 0.0 : (double)(DARKEST + i - 1) / STEPS_A_STOP;
}
