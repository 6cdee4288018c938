/* The samples of a picture, for who makes of them something else than their mean. */
#pragma once

#include "raster/frame/drawing.h"

/* Takes a band of the fine picture, which is the caller's only during the call; `first_row` is the picture's where it
 * begins. An answer other than CONIC_OK ends the drawing with it. */
typedef conic_status conic_samples_receiver(void *cookie, conic_image *fine, int first_row);

/* Draws samples × samples samples a pixel, in the same bands and to the same bits as conic_render_drawing, and hands
 * them over from the top. Other planes than the drawn ones are undefined. `samples` fit the picture's size. Errors: as
 * there, and the receiver's. */
conic_status conic_render_bands(conic_context *context, conic_renderer *renderer, const conic_drawing *drawing,
                                const conic_camera *camera, const conic_render_options *given, int samples,
                                unsigned planes, conic_samples_receiver *receive, void *cookie);

/* For who draws the fine picture in parts. The bits of a band's rows depend on where it begins: so many of the
 * picture's rows are a band, and this camera sees `n_rows` of them. */
int conic_samples_band_rows(const conic_camera *camera, int samples);
conic_camera conic_samples_camera(const conic_camera *camera, int samples, int first_row, int n_rows);

/* The planes of which samples can become a pixel, as bits. */
unsigned conic_samples_planes(void);

/* Makes the image's pixels, from those on, of the samples that `fine` has: of those planes. */
void conic_samples_reduce(conic_context *context, const conic_image *fine, int samples, int first_column, int first_row,
                          conic_image *image);

/* Counts what a picture would make of the splats, without drawing it. Only splats whose `is_counted` is not 0 are
 * counted (null: all are). near_z and splat_length are given. Errors: MEMORY, CANCELLED. */
conic_status conic_samples_count(conic_context *context, const conic_splats *splats, const unsigned char *is_counted,
                                 const conic_camera *camera, const conic_render_options *options,
                                 conic_render_statistics *statistics);

/* The same of a drawing. Errors: as conic_render_drawing. */
conic_status conic_samples_count_drawing(conic_context *context, const conic_drawing *drawing,
                                         const conic_camera *camera, const conic_render_options *options,
                                         conic_render_statistics *statistics);

/* The planes of a fine picture, which the renderer fills whole: unlike conic_image_allocate's they are not cleared, for
 * at this size that is a large part of a frame. Errors: MEMORY. */
conic_status conic_samples_allocate(conic_context *context, int width, int height, unsigned planes, conic_image *fine);
