/* A pixel's samples in a deep image: from front to back, and so that laying them over each other gives the picture. */
#ifndef CONIC_DEEP_PIXEL_H
#define CONIC_DEEP_PIXEL_H

#include "core/pictures/image_exr_deep.h"

/* The samples stand in the order of the sums, each with its own colour (rgba without A), depth, id and weight. They
 * come out in the order of their depths, colours times alpha. Over each other they are `shaded`, or where that is null
 * the mean Σ w c / Σ w, with alpha 1. */
void conic_deep_pixel(conic_deep_sample *samples, size_t n, const float *shaded);

#endif
