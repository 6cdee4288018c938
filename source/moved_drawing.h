/* Splats and triangles that are somewhere else, or of another shape, than as they were read. */
#ifndef CONIC_MOVED_DRAWING_H
#define CONIC_MOVED_DRAWING_H

#include "conic/source.h"

/* What of a drawing belongs to one input: from begin to before end. */
typedef struct conic_drawing_range {
  size_t splats[2], vertices[2], normals[2];
} conic_drawing_range;

/* How many normals there are, which lie at corners or at vertices. */
size_t conic_triangles_normals(const conic_triangles *triangles);

/* Makes `moved` the drawing at rest with places, axes and normals of its own, which are undefined. On failure, too, it
 * is ended by conic_moved_end. Errors: MEMORY. */
conic_status conic_moved_begin(conic_context *context, const conic_drawing *rest, conic_splats *splats,
                               conic_triangles *triangles);
void conic_moved_end(conic_context *context, conic_splats *splats, conic_triangles *triangles);

/* Whether a shape has as many splats, vertices and normals as a range has. */
int conic_moved_fits(const conic_drawing_range *range, const conic_drawing *shape);

/* Puts what a range has at rest where the pose says; a null pose leaves it. */
void conic_moved_put(conic_context *context, const conic_drawing *rest, const conic_drawing_range *range,
                     const conic_source_pose *pose, const conic_splats *splats, const conic_triangles *triangles);

#endif
