/* Composites samples one by one. */
#pragma once

#include "gaussians/draw/gaussian_footprint.h"
#include "judge/diagnosis_samples.h"

/* A Gaussian, set up, that may reach a sample. */
typedef struct conic_kept_gaussian {
  conic_gaussian_footprint footprint;
  conic_gaussian_ray ray;
  conic_gaussian_filter filter;
  conic_gaussian_sight sight;
  float normal[3];
  uint64_t key; /* of its order, then its index */
} conic_kept_gaussian;

/* A picture with a mistake, as its samples need it. */
typedef struct conic_planted_frame {
  const conic_planted *planted;
  const conic_gaussian_view *view;
  conic_gaussian_rules rules; /* of the pixels */
  conic_gaussian_shape shape;
  int samples; /* N × N a pixel */
  size_t n;
  const conic_kept_gaussian *const *kept; /* in compositing order */
  const uint16_t (*boxes)[2][2];
} conic_planted_frame;

typedef struct conic_planted_hit {
  float z, alpha;
  uint32_t kept;
} conic_planted_hit;

/* Room for all kept Gaussians. */
typedef struct conic_composite_scratch {
  uint32_t *listed;
  conic_planted_hit *hits;
} conic_composite_scratch;

/* The fine pixels of a sample, first and last in x and y; in a mirrored picture, those on the other side. */
void conic_planted_place(const conic_planted_frame *frame, const uint16_t place[2], int box[2][2]);

void conic_planted_composite(const conic_planted_frame *frame, const conic_diagnosis_samples *at,
                             const conic_sample_cell *cell, conic_composite_scratch *scratch, conic_channels *values);
