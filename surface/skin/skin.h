/* A skin: triangles that splats make with their neighbours, wherever they lie as a surface does. */
#pragma once

#include "conic/splats.h"

typedef struct conic_skin {
  size_t n_triangles;
  uint32_t (*corners)[3]; /* splats, counter-clockwise seen from their normals' side */
  uint8_t *is_inner;      /* of each splat: triangles close all around it, so that it is not needed any more */
  float (*normal)[3];     /* of each splat: the normal that the picture shows there, unit or zero … */
  float (*color)[3];      /* … and the colour, linear; zero where it has no plane */
  float *lift;            /* of each splat: how far along that normal the mean of the surrounding planes is */
} conic_skin;

/* Finds the triangles of a set that has tangent axes and no strides. The middle of each triangle's circle lies within
 * its corners' ellipses, enlarged to 1.1 times the cutoff, so that no triangle spans a gap between splats. No edge has
 * more than two triangles. Dots, splats that are not finite or span no plane, and pieces of few splats have no
 * triangles. The result depends on the set alone, not on the threads. On success the caller releases *skin; on failure
 * it is empty. Errors: ARGUMENT (over 2³² - 2 splats), MEMORY, CANCELLED. */
conic_status conic_skin_find(conic_context *context, const conic_splats *splats, double cutoff, conic_skin *skin);
void conic_skin_release(conic_context *context, conic_skin *skin);
