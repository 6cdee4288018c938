/* Parts of a frame: some of its rows, or only how deep it hides. Both are of the whole picture's own arithmetic, bit
 * for bit. */
#ifndef RASTER_PART_H
#define RASTER_PART_H

#include "conic/render.h"

/* Draws the rows y_begin … y_end - 1 of the picture that conic_render would draw, and leaves the others alone: for
 * pictures of more splats than memory holds, of which each band of rows is given those that may meet it, in their
 * order. Both ends are multiples of options->tile, or the picture's. Of `statistics`, fragments and pixels are the
 * rows', all else the splats'. near_z and, with an automatic ε, splat_length have to be given in the options, for no
 * band knows the scene. Errors: as conic_render; UNSUPPORTED on another device than the processor. */
conic_status conic_render_rows(conic_renderer *renderer, const conic_splats *splats, const conic_camera *camera,
                               const conic_render_options *options, int y_begin, int y_end, conic_image *image,
                               conic_render_statistics *statistics);

/* Raises hiding[y·width + x] to the inverse depth that the splats hide all beyond of at that pixel: the greatest
 * s_k·min(iz_k, iz_plane,k) of docs/picture.md. No splat whose iz and iz_plane stay below it there is visible in a
 * picture that these splats are part of, nor hides, nor is the nearest. Errors: as conic_render_rows. */
conic_status conic_render_hiding(conic_renderer *renderer, const conic_splats *splats, const conic_camera *camera,
                                 const conic_render_options *options, float *hiding);

#endif
