/* Fewer splats for one picture, without an octree: those that lie in one cell of a grid of the screen are joined to
 * one, where that keeps the error. */
#pragma once

#include "conic/render.h"
#include "conic/splats.h"

typedef struct conic_screen_cells {
  conic_splats splats;
  uint32_t *ids;   /* of each: its index in the set; of one that stands for several, that of one of them */
  size_t n_joined; /* that stand for several */
  size_t n_culled; /* out of sight */
} conic_screen_cells;

/* Joins the splats, which have tangent axes and no strides. Nothing of what is drawn is farther from the set's discs
 * than error_px on the screen, and nothing of these in sight is farther from what is drawn; lengths count in every
 * direction, as those of an octree's nodes do. A splat that reaches the near distance stays as it is. The result
 * depends on no thread. The caller releases it, on failure too. Errors: MEMORY, UNSUPPORTED (the options' instruction
 * set is not here). */
conic_status conic_screen_cells_find(conic_context *context, const conic_splats *splats, const conic_camera *camera,
                                     const conic_render_options *render, double error_px, conic_screen_cells *cells);
void conic_screen_cells_release(conic_context *context, conic_screen_cells *cells);
