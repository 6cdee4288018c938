#include "cli/scene/surfaces_drawn.h"

#include "source/surfaces_among.h"

conic_status cli_draw_surfaces(cli_session *session, const cli_render_job *scene, const conic_camera *camera,
                               unsigned planes, conic_image *surfaces) {
  conic_source *source = conic_source_surfaces(scene->source);
  conic_render_options render = scene->shot.render;
  memset(surfaces, 0, sizeof *surfaces);
  if (!source)
    return CONIC_OK;
  conic_source_settle(scene->source, &render);
  const conic_surfaces_look look = conic_surfaces_look_of(camera, &render, &scene->shot.view, planes);
  conic_status status =
      conic_image_allocate(session->context, look.camera.width, look.camera.height, look.planes, surfaces);
  return status == CONIC_OK
             ? conic_source_draw(source, scene->renderer, &look.camera, &look.render, &look.view, surfaces, NULL)
             : status;
}
