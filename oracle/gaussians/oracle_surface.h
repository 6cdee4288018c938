/* A surface behind Gaussians at a sample (docs/reference/together.md). What it looks like is given. */
#pragma once

#include "conic/gaussian_judge.h"

typedef struct oracle_surface {
  double color[3], color_off[3]; /* as Gaussians have theirs; how far off floats may have it */
  double z, normal[3];
  uint32_t id;
} oracle_surface;

/* Whether the pictures of surfaces are of that size, and have all that a picture of these planes needs of them. */
int conic_oracle_surfaces_fit(const conic_gaussian_surfaces *surfaces, int width, int height, unsigned planes);

/* That of sample (x, y) of the pictures of surfaces; returns 0 where there is none. */
int conic_oracle_surface_at(const conic_gaussian_surfaces *surfaces, int x, int y, oracle_surface *surface);
