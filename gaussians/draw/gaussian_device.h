/* What composites in the place of the processor's loops: another device. */
#pragma once

#include "gaussians/draw/gaussian_bins.h"
#include "gaussians/draw/gaussian_target.h"

/* All of a picture's lists. */
typedef struct conic_gaussian_composition {
  const conic_gaussian_rules *rules;
  size_t n, n_drawn; /* footprints, and those of them that are drawn */
  const conic_gaussian_footprint *footprints;
  const conic_gaussian_ray *rays; /* null: the shape has none */
  const float (*normals)[3];      /* null: not wanted */
  int wants;                      /* of conic_gaussian_list */
  const conic_gaussian_bins *bins;
  conic_gaussian_target target;
} conic_gaussian_composition;

struct conic_gaussian_device {
  int n_units; /* that compute */
  /* Fills the planes of the target. Errors: MEMORY, UNSUPPORTED, CANCELLED. */
  conic_status (*composite)(conic_gaussian_device *device, const conic_gaussian_composition *composition);
};
