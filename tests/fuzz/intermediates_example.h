/* The view of five Gaussians whose intermediate results are seeds. */
#pragma once

#include "tests/support/gaussian_fixture.h"

static const conic_camera intermediates_camera = {.width = 20,
                                                  .height = 18,
                                                  .fx = 20,
                                                  .fy = 20,
                                                  .cx = 10,
                                                  .cy = 9,
                                                  .cam_from_world = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 3}}};

static inline conic_gaussians intermediates_example(conic_context *context, conic_gaussian_options *options) {
  conic_gaussian_options_init(options);
  options->profile = CONIC_PROFILE_GSPLAT_1_6;
  return gaussians_random(context, 5, 1, 0);
}
