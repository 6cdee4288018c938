/* Surfaces behind Gaussians: docs/reference/together.md has the formulas. */
#pragma once

#include "conic/gaussian_render.h"

/* A channel of a surface of alpha A, which is multiplied by that, as Gaussians have colours: display values, unless
 * they are linear. A is above 0. */
float conic_surface_shown(float premultiplied, float A, int is_linear);

/* Planes that surfaces have and Gaussians do not, as bits. */
#define CONIC_SURFACES_PLANES                                                                                          \
  (1u << CONIC_PLANE_ALBEDO | 1u << CONIC_PLANE_WEIGHT | 1u << CONIC_PLANE_AO | 1u << CONIC_PLANE_SHADOW)

/* Puts surfaces, which have a plane for each that `planes` has, behind the Gaussians that were composited before them
 * over black: they get what is left of the light. `first_id` is that of the surfaces' ids 0; null `background`: none.
 * Of CONIC_SURFACES_PLANES, those that there are become the picture's where they are. */
void conic_surfaces_join(conic_context *context, conic_image *surfaces, const float background[3], int is_linear,
                         uint32_t first_id, conic_gaussian_planes *planes);
