/* Splats and triangles in another place, or of another shape, than they were read in. */
#pragma once

#include "conic/source.h"

/* The part of a drawing that belongs to one input: from begin to before end. */
typedef struct conic_drawing_range {
  size_t splats[2], vertices[2], normals[2];
} conic_drawing_range;

/* Whether a pose leaves its input as the file has it. */
int conic_pose_is_at_rest(const conic_source_pose *pose);

/* How many normals there are, at corners or at vertices. */
size_t conic_triangles_normals(const conic_triangles *triangles);

/* Makes `moved` the drawing at rest with its own places, axes and normals, which are undefined. The caller ends it with
 * conic_moved_end, on failure, too. Errors: MEMORY. */
conic_status conic_moved_begin(conic_context *context, const conic_drawing *rest, conic_splats *splats,
                               conic_triangles *triangles);
/* Exchanges the arrays that the two have for themselves. */
void conic_moved_swap(conic_splats *rest, conic_triangles *rest_triangles, conic_splats *moved,
                      conic_triangles *moved_triangles);
void conic_moved_end(conic_context *context, conic_splats *splats, conic_triangles *triangles);

/* Whether a shape has as many splats, vertices and normals as a range has. */
int conic_moved_fits(const conic_drawing_range *range, const conic_drawing *shape);

/* Moves a range of the drawing at rest as the pose says; a null pose leaves it at rest. */
void conic_moved_put(conic_context *context, const conic_drawing *rest, const conic_drawing_range *range,
                     const conic_source_pose *pose, const conic_splats *splats, const conic_triangles *triangles);
