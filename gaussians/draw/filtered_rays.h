/* Rays under a filter: what CONIC_SHAPE_RAY is where there is one. */
#ifndef CONIC_FILTERED_RAYS_H
#define CONIC_FILTERED_RAYS_H

#include "gaussians/draw/gaussian_tile.h"

typedef struct conic_filtered_kernels {
  void (*composite)(const conic_gaussian_list *list, conic_gaussian_tile *tile);
} conic_filtered_kernels;

CONIC_DECLARE_KERNELS(conic_filtered_kernels);

#endif
