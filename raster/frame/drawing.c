#include "raster/frame/drawing.h"

#include "raster/loops/raster_loops.h"
#include "raster/view/method.h"

conic_status conic_whole_drawing_enter(conic_context *context, const char *who, const conic_drawing *drawing,
                                       conic_whole_drawing *whole) {
  conic_splats *splats = &whole->entered.splats;
  memset(whole, 0, sizeof *whole);
  conic_status status = conic_drawing_enter(context, who, drawing, &whole->entered);
  if (status != CONIC_OK)
    return status;
  whole->splats = splats;
  if (whole->entered.triangles.count)
    whole->triangles = &whole->entered.triangles;
  for (int axis = 0; axis < 3 && !splats->count && (whole->triangles || !drawing->splats); axis++)
    splats->position[axis] = splats->tangent_u[axis] = splats->tangent_v[axis] = &whole->nothing;
  return CONIC_OK;
}

/* Finds near_z and splat_length from the splats, where they are not given, so that several frames find them once. */
static conic_status scale_splats(conic_context *context, const conic_splats *splats, conic_render_options *options) {
  if (!(options->near_z > 0.0))
    options->near_z = conic_default_near(splats);
  if (!(options->splat_length > 0.0) && options->epsilon < 0.0)
    return conic_splats_length(context, splats, &options->splat_length);
  return CONIC_OK;
}

conic_status conic_whole_drawing_scale(conic_context *context, const conic_whole_drawing *drawing,
                                       conic_render_options *options) {
  const conic_drawing both = {.splats = drawing->splats, .triangles = drawing->triangles};
  if (!(options->near_z > 0.0) && drawing->triangles)
    options->near_z = conic_drawing_near(&both);
  return scale_splats(context, drawing->splats, options);
}

conic_status conic_whole_drawing_prepare(conic_context *context, const conic_whole_drawing *drawing,
                                         const conic_view *view, const conic_camera *camera, conic_isa isa,
                                         conic_triangle_frame *frame) {
  conic_raster_loops loops;
  conic_status status = conic_isa_choose(context, isa, &isa);
  if (status != CONIC_OK || !drawing->triangles)
    return status;
  conic_raster_loops_init(&loops, isa);
  conic_triangle_frame_begin(frame, context, drawing->triangles, view, camera);
  frame->first_id = (uint32_t)drawing->splats->count;
  conic_triangle_frame_tiles(frame, CONIC_GREATEST_TILE);
  return conic_triangle_frame_prepare(frame, &loops.triangles);
}

conic_status conic_whole_drawing_count(conic_context *context, const conic_whole_drawing *drawing,
                                       const conic_view *view, const conic_camera *camera, conic_isa isa,
                                       conic_render_statistics *statistics) {
  conic_triangle_frame frame;
  memset(&frame, 0, sizeof frame);
  conic_status status = conic_whole_drawing_prepare(context, drawing, view, camera, isa, &frame);
  statistics->triangles_culled = statistics->triangles_skipped = statistics->triangles_drawn = 0;
  if (status == CONIC_OK && drawing->triangles)
    conic_triangle_frame_count(&frame, statistics);
  conic_triangle_frame_release(context, &frame);
  return status;
}

void conic_chunk_add(const conic_chunk *chunk, conic_chunk *sum) {
  sum->n_culled += chunk->n_culled;
  sum->n_skipped += chunk->n_skipped;
  sum->n_drawn += chunk->n_drawn + chunk->n_elsewhere;
  sum->n_fallback += chunk->n_fallback;
  sum->n_rays += chunk->n_rays;
  sum->n_laplaces += chunk->n_laplaces;
}

void conic_chunks_count(const conic_chunk *chunks, size_t n_chunks, conic_method method,
                        conic_render_statistics *statistics) {
  conic_chunk sum = {.n_drawn = 0};
  for (size_t i = 0; i < n_chunks; i++)
    conic_chunk_add(&chunks[i], &sum);
  statistics->splats_culled = sum.n_culled;
  statistics->splats_skipped = sum.n_skipped;
  statistics->splats_drawn = sum.n_drawn;
  statistics->splats_fallback = sum.n_fallback;
  conic_method_count(method, sum.n_rays, statistics);
  statistics->splats_by_laplace = sum.n_laplaces;
}
