/* The samples of a picture, for who makes of them something else than their mean. */
#ifndef CONIC_SAMPLES_H
#define CONIC_SAMPLES_H

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

#endif
