#include "cli/scene/surfaces_drawn.h"

#include "raster/frame/samples.h"
#include "source/surfaces_among.h"

conic_status cli_draw_surfaces(cli_session *session, const cli_render_job *scene, const conic_camera *camera,
                               unsigned planes, conic_image *surfaces) {
  conic_source *source = conic_source_surfaces(scene->source);
  const conic_camera fine = conic_samples_camera(camera, scene->shot.view.samples, 0, camera->height);
  const unsigned ids = 1u << CONIC_PLANE_ID | 1u << CONIC_PLANE_LAST;
  conic_render_options render = scene->shot.render;
  conic_source_view view = scene->shot.view;
  memset(surfaces, 0, sizeof *surfaces);
  if (!source)
    return CONIC_OK;
  conic_source_settle(scene->source, &render);
  render.has_background = 0;
  view.samples = 1;
  conic_status status =
      conic_image_allocate(session->context, fine.width, fine.height,
                           1u << CONIC_PLANE_RGBA | 1u << CONIC_PLANE_Z | (planes & 1u << CONIC_PLANE_NORMAL) |
                               (planes & ids ? 1u << CONIC_PLANE_ID : 0),
                           surfaces);
  return status == CONIC_OK ? conic_source_draw(source, scene->renderer, &fine, &render, &view, surfaces, NULL)
                            : status;
}
