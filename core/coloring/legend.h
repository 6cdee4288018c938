/* The legend: draws what a picture's colours mean, as a bar with numbers, or as classes by name. */
#pragma once

#include "conic/coloring.h"

/* Draws the legend over the lower right corner of the image's rgba, in a size that suits the picture; what does not fit
 * is cut off. `length` is the unit of heights and coordinates; "": not known. */
void conic_legend_draw(const conic_coloring *coloring, const char *length, conic_image *image);

/* A picture of the legend alone, which the caller releases. Errors: MEMORY. */
conic_status conic_legend_make(conic_context *context, const conic_coloring *coloring, const char *length,
                               conic_image *image);

/* A legend of named linear colours, under a title, which the caller releases. Errors: MEMORY. */
conic_status conic_legend_make_list(conic_context *context, const char *title, const char *const *names,
                                    const float (*colors)[3], int n, conic_image *image);
