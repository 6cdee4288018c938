/* One picture of what a drawing holds, without samples. */
#ifndef CONIC_DRAWING_H
#define CONIC_DRAWING_H

#include "conic/triangles.h"
#include "core/splats/columns.h"
#include "raster/view/view.h"

/* A drawing whose parts are there: an absent or empty set of splats is an empty one with axes, absent triangles are
 * none. */
typedef struct conic_whole_drawing {
  const conic_splats *splats;
  const conic_triangles *triangles; /* null: none */
  conic_entered_drawing entered;
  float nothing;
} conic_whole_drawing;

/* Checks what a caller gave. `whole` must not move afterwards, and the caller leaves the drawing that
 * was entered, on failure too. Errors:
 * ARGUMENT, INPUT (conic_triangles_check), MEMORY. */
conic_status conic_whole_drawing_enter(conic_context *context, const char *who, const conic_drawing *drawing,
                                       conic_whole_drawing *whole);

/* conic_render of both. */
conic_status conic_render_whole(conic_renderer *renderer, const conic_whole_drawing *drawing,
                                const conic_camera *camera, const conic_render_options *options, conic_image *image,
                                conic_render_statistics *statistics);

/* conic_scene_scale of both. Errors: MEMORY. */
conic_status conic_whole_drawing_scale(conic_context *context, const conic_whole_drawing *drawing,
                                       conic_render_options *options);

/* What becomes of the triangles in a picture of the camera, without drawing it. Errors: MEMORY, ARGUMENT,
 * UNSUPPORTED. */
conic_status conic_whole_drawing_count(conic_context *context, const conic_whole_drawing *drawing,
                                       const conic_view *view, const conic_camera *camera, conic_isa isa,
                                       conic_render_statistics *statistics);

#endif
