/* What the library does with splat sets besides the public functions. */
#pragma once

#include "conic/splats.h"
#include "conic/triangles.h"

/* A new set whose splat i is splat sources[i] of `from`; without clip lines. On failure *gathered is empty.
 * Errors: MEMORY. */
conic_status conic_splats_gather(conic_context *context, const conic_splats *from, const uint32_t *sources,
                                 size_t count, conic_splats *gathered);

/* Moves the splats into arrays for `capacity` of them, no fewer than there are, with the optional arrays of `fields`. A
 * new array holds what its absence meant. Clip lines have no array a splat, and stay. On failure all is as it was.
 * Errors: MEMORY. */
conic_status conic_splats_resize(conic_context *context, conic_splats *splats, size_t capacity, unsigned fields);

/* The bounds of the finite ones of n points, those of `indices` or, where that is null, the first; returns how many are
 * finite. Without one the bounds are 0. */
size_t conic_points_bounds(float *const position[3], size_t stride, const double origin[3], const uint32_t *indices,
                           size_t n, double minimum[3], double maximum[3]);

/* The same as without _by, on the context's threads; not within a region. Null: the calling one does it. */
size_t conic_splats_bounds_by(conic_context *context, const conic_splats *splats, double minimum[3], double maximum[3]);
size_t conic_drawing_bounds_by(conic_context *context, const conic_drawing *drawing, double minimum[3],
                               double maximum[3]);
