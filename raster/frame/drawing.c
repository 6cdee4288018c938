#include "raster/frame/drawing.h"

#include <string.h>

#include "raster/kernels/raster_kernels.h"
#include "raster/triangles/triangle_frame.h"
#include "raster/view/scene_scale.h"

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

conic_status conic_whole_drawing_scale(conic_context *context, const conic_whole_drawing *drawing,
                                       conic_render_options *options) {
  const conic_drawing both = {.splats = drawing->splats, .triangles = drawing->triangles};
  if (!(options->near_z > 0.0) && drawing->triangles)
    options->near_z = conic_drawing_near(&both);
  return conic_scene_scale(context, drawing->splats, options);
}

conic_status conic_whole_drawing_count(conic_context *context, const conic_whole_drawing *drawing,
                                       const conic_view *view, const conic_camera *camera, conic_isa isa,
                                       conic_render_statistics *statistics) {
  conic_triangle_frame frame;
  conic_raster_kernels kernels;
  conic_status status = conic_isa_choose(context, isa, &isa);
  if (status != CONIC_OK || !drawing->triangles)
    return status;
  conic_raster_kernels_init(&kernels, isa);
  memset(&frame, 0, sizeof frame);
  conic_triangle_frame_begin(&frame, context, drawing->triangles, view, camera);
  conic_triangle_frame_tiles(&frame, CONIC_GREATEST_TILE);
  status = conic_triangle_frame_prepare(&frame, &kernels.triangles);
  statistics->triangles_culled = statistics->triangles_skipped = statistics->triangles_drawn = 0;
  if (status == CONIC_OK)
    conic_triangle_frame_count(&frame, statistics);
  conic_triangle_frame_release(context, &frame);
  return status;
}
