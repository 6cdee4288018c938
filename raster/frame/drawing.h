/* One picture of what a drawing holds, without samples. */
#pragma once

#include "core/splats/columns.h"
#include "raster/triangles/triangle_frame.h"

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

/* Projects and sorts the drawing's triangles, if there are any, as a frame of the greatest tiles; `frame` is of zero
 * bytes, and the caller releases it, on failure too. Errors: MEMORY, ARGUMENT, UNSUPPORTED. */
conic_status conic_whole_drawing_prepare(conic_context *context, const conic_whole_drawing *drawing,
                                         const conic_view *view, const conic_camera *camera, conic_isa isa,
                                         conic_triangle_frame *frame);

/* What becomes of the triangles in a picture of the camera, without drawing it. Errors: MEMORY, ARGUMENT,
 * UNSUPPORTED. */
conic_status conic_whole_drawing_count(conic_context *context, const conic_whole_drawing *drawing,
                                       const conic_view *view, const conic_camera *camera, conic_isa isa,
                                       conic_render_statistics *statistics);

/* Adds what became of a chunk's splats. */
void conic_chunk_add(const conic_chunk *chunk, conic_chunk *sum);

/* Sets what became of the splats of all chunks. */
void conic_chunks_count(const conic_chunk *chunks, size_t n_chunks, conic_method method,
                        conic_render_statistics *statistics);
