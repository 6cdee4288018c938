#include "core/base/base.h"
#include "core/image/view_arguments.h"
#include "raster/frame/raster_frame.h"

struct conic_prepared {
  conic_context *context;
  conic_camera camera;
  conic_render_options options;
  conic_whole_drawing drawing;
  conic_raster_frame frame;
  conic_render_statistics statistics; /* of all but pixels */
};

static conic_status set_up_picture(conic_prepared *p, conic_renderer *renderer, unsigned planes) {
  double start = conic_seconds_now();
  p->frame.renderer = renderer;
  p->frame.splats = p->drawing.splats;
  p->frame.part.window = (conic_window){0, p->camera.width, 0, p->camera.height};
  conic_status status = conic_raster_frame_take_passes(&p->frame, planes, &p->options);
  if (status == CONIC_OK)
    status = conic_raster_frame_begin(&p->frame, &p->drawing, &p->camera, &p->options);
  if (status == CONIC_OK)
    status = conic_raster_frame_set_up(&p->frame, planes, &p->statistics.ms);
  if (status != CONIC_OK)
    return status;
  conic_raster_frame_count(&p->frame, &p->statistics);
  p->statistics.ms.frame = 1e3 * (conic_seconds_now() - start);
  return CONIC_OK;
}

conic_status conic_prepare(conic_renderer *renderer, const conic_drawing *drawing, const conic_camera *camera,
                           const conic_render_options *options, unsigned planes, conic_prepared **prepared) {
  conic_context *context = renderer->context;
  *prepared = NULL;
  conic_status status = conic_renderer_check_parts(renderer);
  if (status != CONIC_OK)
    return status;
  conic_prepared *p = conic_memory_allocate_zeroed(context, 1, sizeof *p);
  if (!p)
    return CONIC_ERROR_MEMORY;
  p->context = context;
  p->camera = *camera;
  status = conic_view_arguments_take(context, "render", camera, options, &p->options);
  if (status == CONIC_OK)
    status = conic_whole_drawing_enter(context, "render", drawing, &p->drawing);
  if (status == CONIC_OK)
    status = set_up_picture(p, renderer, planes);
  if (status == CONIC_OK)
    *prepared = p;
  else
    conic_prepared_release(p);
  return status;
}

conic_status conic_prepared_draw(conic_prepared *p, const conic_window *window, conic_image *image,
                                 conic_render_statistics *statistics) {
  double start = conic_seconds_now();
  *statistics = p->statistics;
  memset(&p->statistics.ms, 0, sizeof p->statistics.ms); /* the first window's */
  p->frame.part.first_column = window->x_begin;
  p->frame.part.first_row = window->y_begin;
  conic_status status = conic_raster_frame_draw(&p->frame, window, image, statistics);
  statistics->ms.frame += 1e3 * (conic_seconds_now() - start);
  return status;
}

void conic_prepared_release(conic_prepared *p) {
  if (!p)
    return;
  conic_drawing_leave(p->context, &p->drawing.entered);
  conic_memory_release(p->context, p);
}
