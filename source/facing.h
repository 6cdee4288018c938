/* Splats that are drawn whole, with their dots turned to each picture's camera. */
#pragma once

#include "conic/splats.h"

typedef struct conic_facing {
  size_t n_dots;
  conic_splats splats; /* those of the owner, with tangent axes of their own; empty where there is no dot */
} conic_facing;

/* The splats stay the caller's and have to outlive it. After an error it still has to be ended. Errors: MEMORY. */
conic_status conic_facing_begin(conic_context *context, const conic_splats *splats, conic_facing *facing);

/* Where there are dots, points *drawn, the splats in their present places, to the same with the dots turned. Errors: as
 * conic_splats_face. */
conic_status conic_facing_turn(conic_context *context, conic_facing *facing, const conic_camera *camera,
                               const conic_splats **drawn);

void conic_facing_end(conic_context *context, conic_facing *facing);
