/* Motion: where the inputs of a source are at any moment, and which shape they have. docs/reference/accumulation.md
 * defines the file. */
#ifndef CONIC_MOTION_H
#define CONIC_MOTION_H

#include "conic/source.h"

CONIC_BEGIN_C

typedef struct conic_motion conic_motion;

/* Reads a file of keys for a source of `n_inputs` files. Opens the files that it names, relative to its folder, with
 * these options (null: the defaults). On success the caller owns *motion, which must not outlive the context. Errors:
 * INPUT, MEMORY, and those of conic_source_open. */
CONIC_API conic_status conic_motion_read(conic_context *context, const char *path, size_t n_inputs,
                                         const conic_source_options *options, conic_motion **motion);
/* Null is allowed. */
CONIC_API void conic_motion_destroy(conic_motion *motion);

/* Puts a source's inputs where they are at a moment, in frames. Between two poses without scale, an input moves as a
 * camera does (conic_camera_between): its origin on a straight line. Between other poses, each number of the matrix
 * changes linearly. Before the first key and after the last, nothing moves. Errors: as conic_source_move; ARGUMENT
 * (conic_camera_between's). */
CONIC_API conic_status conic_motion_apply(conic_motion *motion, conic_source *source, double frame);

CONIC_END_C
#endif
