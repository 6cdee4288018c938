/* Numbers by the nearest of a few: 256 for numbers of one kind, 65536 for the harmonics of a Gaussian together. */
#pragma once

#include "gaussians/scene/gaussian_set.h"

enum { CONIC_CODES = 256, CONIC_MOST_CENTROIDS = 65536 };

/* One of many numbers; NaN is left out. */
typedef float conic_number_at(const void *numbers, size_t i);

/* 256 ascending values: all that there are, where these are fewer; else such that the sum of squared errors is small.
 */
conic_status conic_codebook_make(conic_context *context, const void *numbers, conic_number_at *number_at, size_t n,
                                 float codebook[CONIC_CODES]);
/* The nearest; of a NaN, the first. */
unsigned char conic_codebook_find(const float codebook[CONIC_CODES], float value);

/* Sorts vectors, each the harmonics of a Gaussian above degree 0, into up to 65536 groups. The group with the greatest
 * sum of squares is split, again and again, at its mean along the direction in which it is widest. labels[i] is the
 * group of vector i, and centroids[group × n_numbers] its mean; the caller releases it. Errors: MEMORY, CANCELLED. */
conic_status conic_palette_make(conic_context *context, const conic_gaussians *gaussians, size_t n_numbers,
                                uint32_t *labels, float **centroids, size_t *n_centroids);
