/* A plain renderer of surface splats, in the manner of PointShop: each disc's ellipse on the screen, what is visible by
 * a tolerance in depth, and blended weights, all in float. By docs/reference/picture.md, but for what reaches near or
 * is seen at a slant so close that its depth changes by a quarter: those are not drawn here. No code is the library's.
 */
#pragma once

#include "tests/judge/plain_floats.h"
#include "tests/judge/plain_scene.h"

typedef struct plain_surfels {
  size_t count;
  float *center, *axes[2]; /* 3 of each */
  float *color;            /* 3 of each, linear */
} plain_surfels;

typedef struct plain_surfel_settings {
  int is_affine;
  float cutoff, prefilter; /* standard deviations; px² */
  unsigned faults;
  float background[3];
  int is_opaque; /* there is a background */
  plain_floats floats;
} plain_surfel_settings;

/* A PLY of normals and radii, or of tangent axes. */
plain_surfels plain_surfels_read(const char *path, float cutoff, unsigned faults);
void plain_surfels_release(plain_surfels *surfels);

/* Returns how many surfels are not drawn for what they would need. */
size_t plain_surfels_draw(const plain_surfels *surfels, const plain_camera *camera,
                          const plain_surfel_settings *settings, plain_picture *picture);
