/* A skin: the triangles that splats make with their neighbours, wherever these lie as a surface does. */
#ifndef CONIC_SKIN_H
#define CONIC_SKIN_H

#include "conic/splats.h"

typedef struct conic_skin {
  size_t n_triangles;
  uint32_t (*corners)[3]; /* splats, counter-clockwise as their normals see them */
  uint8_t *is_inner;      /* of each splat: triangles close all around it, so that it is not needed any more */
  float (*normal)[3];     /* of each splat: what the picture shows where it lies, unit or zero, */
  float (*color)[3];      /* and the colour, linear; zero where it has no plane */
  float *lift;            /* how far along that normal the mean of the planes about it lies */
} conic_skin;

/* Finds the triangles of a set that has tangent axes and no strides. The middle of each one's circle lies within the
 * ellipses of its corners, at the cutoff and a tenth, so that none spans what the splats leave open; no edge has more
 * than two. Dots, and splats that are not finite or span no plane, have none; nor have pieces of few splats. The result
 * depends on the set alone, never on the threads. On success the caller releases *skin; on failure it is empty. Errors:
 * ARGUMENT (over 2³² - 2 splats), MEMORY, CANCELLED. */
conic_status conic_skin_find(conic_context *context, const conic_splats *splats, double cutoff, conic_skin *skin);
void conic_skin_release(conic_context *context, conic_skin *skin);

#endif
