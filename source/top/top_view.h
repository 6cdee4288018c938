/* A source seen from straight above by a parallel projection, north up: an orthophoto, drawn in blocks.
 *
 * Pixels are squares of the ground, counted from the world's origin: column c is x from c·pixel to (c+1)·pixel, row r
 * is y from -r·pixel down to -(r+1)·pixel. Blocks are squares of pixels, counted the same way. A block depends on the
 * source, the pixel and the options alone. So two pictures have the same bits wherever they show the same ground. */
#pragma once

#include "conic/source.h"
#include "core/pictures/georeference.h"

enum { CONIC_TOP_BLOCK = 256 }; /* the edge of a block in pixels */

typedef struct conic_top_view conic_top_view;

/* The coordinate system of an open source, if its file states one; the caller releases it. Errors: MEMORY. */
conic_status conic_source_georeference(const conic_source *source, conic_georeference *reference);

typedef struct conic_top_options {
  double pixel;                       /* world units */
  double heights[2];                  /* only splats with their centre between these are drawn; infinite: no bound */
  const conic_render_options *render; /* lights and later members count as in other pictures, in the world */
  int samples;                        /* N × N a pixel */
  double error_px;                    /* for sources with levels; 0: full detail */
} conic_top_options;

/* Opens the view. On success the caller owns *top, which must not outlive source and renderer. Errors: ARGUMENT,
 * UNSUPPORTED (the source hands nothing over), MEMORY. */
conic_status conic_top_view_open(conic_source *source, conic_renderer *renderer, const conic_top_options *options,
                                 conic_top_view **top);
/* Null is allowed. */
void conic_top_view_close(conic_top_view *top);

/* Draws a block into the planes rgba and Z of an image of a block's size. Z becomes the height in world units, NaN
 * where nothing is. Counts are added to *sum; a splat in several blocks counts in each. Errors: as
 * conic_source_draw. */
conic_status conic_top_view_draw(conic_top_view *top, int64_t column, int64_t row, conic_image *image,
                                 conic_render_statistics *sum);
