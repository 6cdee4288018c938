/* conic_render_transparent's picture of one sample a pixel, window by window. */
#pragma once

#include "conic/transparency.h"
#include "raster/view/part.h"

typedef struct conic_transparent_windows conic_transparent_windows;

/* As conic_prepare. On success the caller ends *windows. Errors: as there, and as conic_render_transparent. */
conic_status conic_transparent_windows_begin(conic_context *context, conic_renderer *renderer,
                                             const conic_drawing *drawing, const conic_camera *camera,
                                             const conic_render_options *given, conic_transparency how, double chance,
                                             unsigned planes, conic_transparent_windows **windows);

/* As conic_prepared_draw. Errors: as there. */
conic_status conic_transparent_windows_draw(conic_transparent_windows *windows, const conic_window *window,
                                            conic_image *image, conic_render_statistics *statistics);

/* Null is allowed. */
void conic_transparent_windows_end(conic_transparent_windows *windows);
