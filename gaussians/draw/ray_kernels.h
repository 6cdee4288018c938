/* What CONIC_SHAPE_RAY is under a filter, and for cameras whose rays are not affine on the screen. */
#ifndef CONIC_RAY_KERNELS_H
#define CONIC_RAY_KERNELS_H

#include "gaussians/draw/gaussian_tile.h"

typedef struct conic_ray_kernels {
  void (*composite_filtered)(const conic_gaussian_list *list, conic_gaussian_tile *tile);
  void (*composite_seen)(const conic_gaussian_list *list, conic_gaussian_tile *tile);
} conic_ray_kernels;

CONIC_DECLARE_KERNELS(conic_ray_kernels);

#endif
