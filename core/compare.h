/* The parts of a comparison; docs/diff.md has the definitions. */
#ifndef CORE_COMPARE_H
#define CORE_COMPARE_H

#include <stddef.h>

#include "conic/image.h"

/* Sum of the squared differences and mean structural similarity of R, G, B. Both images have rgba and one size. Errors:
 * MEMORY. */
conic_status conic_compare_color(conic_context *context, const conic_image *a, const conic_image *b,
                                 double *sum_of_squares, double *ssim);

/* Pixels of the largest 4-connected set covered in `a` and not in `b`. Errors: MEMORY. */
conic_status conic_largest_hole(conic_context *context, const conic_image *a, const conic_image *b, size_t *n_pixels);

#endif
