#include "raster/frame/drawing.h"

#include <string.h>

#include "raster/kernels/raster_kernels.h"
#include "raster/triangles/triangle_frame.h"
#include "raster/view/scene_scale.h"

void conic_whole_drawing_of(const conic_drawing *drawing, conic_whole_drawing *whole) {
  memset(whole, 0, sizeof *whole);
  whole->splats = drawing->splats;
  if (drawing->triangles && drawing->triangles->count)
    whole->triangles = drawing->triangles;
  if (whole->splats && (whole->splats->count || !whole->triangles))
    return;
  for (int axis = 0; axis < 3; axis++)
    whole->none.position[axis] = whole->none.tangent_u[axis] = whole->none.tangent_v[axis] = &whole->nothing;
  whole->splats = &whole->none;
}

conic_status conic_whole_drawing_scale(conic_context *context, const conic_whole_drawing *drawing,
                                       conic_render_options *options) {
  const conic_drawing both = {drawing->splats, drawing->triangles};
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
