/* One picture of what a drawing holds, without samples. */
#ifndef CONIC_DRAWING_H
#define CONIC_DRAWING_H

#include "conic/triangles.h"
#include "raster/view/view.h"

/* A drawing whose parts are there: an absent or empty set of splats is an empty one with axes, absent triangles are
 * none. */
typedef struct conic_whole_drawing {
  const conic_splats *splats;
  const conic_triangles *triangles; /* null: none */
  conic_splats none;
  float nothing;
} conic_whole_drawing;

/* `whole` must not move afterwards. */
void conic_whole_drawing_of(const conic_drawing *drawing, conic_whole_drawing *whole);

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
