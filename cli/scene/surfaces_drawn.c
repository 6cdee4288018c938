#include "cli/scene/surfaces_drawn.h"

#include "source/surfaces_among.h"

conic_status cli_draw_surfaces(cli_session *session, const cli_render_job *scene, const conic_camera *camera,
                               unsigned planes, cli_surfaces_drawn *drawn) {
  conic_source *source = conic_source_surfaces(scene->source);
  const conic_gaussians *gaussians = conic_source_gaussians(scene->source);
  conic_render_options render = scene->shot.render;
  memset(drawn, 0, sizeof *drawn);
  if (!source)
    return CONIC_OK;
  conic_source_settle(scene->source, &render);
  const conic_surfaces_look look = conic_surfaces_look_of(camera, &render, &scene->shot.view, planes);
  drawn->surfaces = (conic_gaussian_surfaces){&drawn->image, gaussians->is_linear, (uint32_t)gaussians->count};
  drawn->given = &drawn->surfaces;
  conic_status status =
      conic_image_allocate(session->context, look.camera.width, look.camera.height, look.planes, &drawn->image);
  return status == CONIC_OK
             ? conic_source_draw(source, scene->renderer, &look.camera, &look.render, &look.view, &drawn->image, NULL)
             : status;
}
