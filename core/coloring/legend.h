/* What the colours of a picture mean, drawn: a bar with numbers, or the classes by name. */
#ifndef CONIC_LEGEND_H
#define CONIC_LEGEND_H

#include "conic/coloring.h"
#include "conic/image.h"

/* Draws it over the lower right corner of the image's rgba, as large as suits the picture; what does not fit is cut
 * off. */
void conic_legend_draw(const conic_coloring *coloring, conic_image *image);

/* A picture of the legend alone, which the caller releases. Errors: MEMORY. */
conic_status conic_legend_make(conic_context *context, const conic_coloring *coloring, conic_image *image);

/* The same of colours with names, linear, under a title. Errors: MEMORY. */
conic_status conic_legend_make_list(conic_context *context, const char *title, const char *const *names,
                                    const float (*colors)[3], int n, conic_image *image);

#endif
