/* The members of the sums of a run of samples. */
#pragma once

#include "accumulation/exact_sum.h"
#include "conic/accumulate.h"

struct conic_accumulation {
  conic_context *context;
  int width, height;
  unsigned planes;
  size_t n_channels;     /* of all planes, and one for the half */
  conic_exact_sum *sums; /* row after row, in a row pixel by pixel, in a pixel channel by channel */
  uint64_t first_sample, n_samples;
  uint64_t n_half; /* samples in the half */
  uint64_t key;
};

/* The place of a plane's first channel in a pixel's sums; the half's luminance is the last channel. */
size_t conic_accumulation_channel(unsigned planes, conic_plane plane);
