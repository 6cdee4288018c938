/* Loans: sets in a program's memory get a name, which functions take in the place of a file's name. So arrays can be
 * drawn as a source, judged, or built upon, as files can. */
#ifndef CONIC_LOAN_H
#define CONIC_LOAN_H

#include "conic/context.h"

CONIC_BEGIN_C

/* From now on `name` stands for `what`. The name is copied. The context reads `what` and never changes it; it must
 * exist until it is taken back. The name begins with the kind of set:
 *   memory:splats:     a conic_splats, which conic_model_read and conic_model_stream take; strides are allowed
 *   memory:triangles:  a conic_triangles of one normal and one texture coordinate a vertex, and without materials;
 *                      taken by the same functions; no strides
 *   memory:gaussians:  a conic_gaussians, which conic_gaussians_read takes
 *   memory:image:      a conic_image, which conic_image_read takes
 *   memory:camera:     a conic_camera, which conic_cameras_read takes
 * Readers copy the sets. Drawing a source of a single set of splats or Gaussians does not copy arrays that lie side by
 * side. Errors: ARGUMENT (another name, or a set that is not whole), MEMORY. */
CONIC_API conic_status conic_lend(conic_context *context, const char *name, const void *what);

/* Takes back everything that was lent. Sources opened from it must be closed before. */
CONIC_API void conic_take_back_loans(conic_context *context);

CONIC_END_C
#endif
