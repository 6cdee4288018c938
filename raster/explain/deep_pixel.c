#include "raster/explain/deep_pixel.h"

#include <stdlib.h>

static int compare_depths(const void *a, const void *b) {
  const conic_deep_sample *first = a, *second = b;
  if (first->depth != second->depth)
    return first->depth < second->depth ? -1 : 1;
  return (first->id > second->id) - (first->id < second->id);
}

/* Shading is of the pixel, not of its splats: what it makes of the mean colour it makes of each. Where the mean is
 * black, nothing but a highlight is seen, which all have alike. */
static void shade(conic_deep_sample *samples, size_t n, const float shaded[3]) {
  double sum = 0.0;
  for (size_t i = 0; i < n; i++)
    sum += (double)samples[i].weight;
  for (int c = 0; c < 3; c++) {
    double mean = 0.0;
    for (size_t i = 0; i < n; i++)
      mean += (double)samples[i].weight / sum * (double)samples[i].rgba[c];
    for (size_t i = 0; i < n; i++)
      samples[i].rgba[c] = mean > 0.0 ? (float)((double)samples[i].rgba[c] * ((double)shaded[c] / mean)) : shaded[c];
  }
}

/* A sample lets through what those behind it are of the rest, so that each is seen with its share of the weights. */
static void cover_from(conic_deep_sample *samples, size_t n) {
  double behind = 0.0;
  for (size_t i = n; i-- > 0;) {
    conic_deep_sample *sample = &samples[i];
    behind += (double)sample->weight;
    double alpha = (double)sample->weight / behind;
    for (int c = 0; c < 3; c++)
      sample->rgba[c] = (float)((double)sample->rgba[c] * alpha);
    sample->rgba[3] = (float)alpha;
  }
}

void conic_deep_pixel(conic_deep_sample *samples, size_t n, const float *shaded) {
  if (n > 0 && shaded)
    shade(samples, n, shaded);
  if (n > 1)
    qsort(samples, n, sizeof *samples, compare_depths);
  cover_from(samples, n);
}
