#include "cli/scene/surfaces_drawn.h"

#include "source/surfaces_among.h"

conic_status cli_draw_surfaces(const cli_render_job *scene, const conic_camera *camera, unsigned planes,
                               cli_surfaces_drawn *drawn) {
  const conic_gaussians *gaussians = conic_source_gaussians(scene->source);
  conic_render_options render = scene->shot.render;
  memset(drawn, 0, sizeof *drawn);
  if (!conic_source_surfaces(scene->source))
    return CONIC_OK;
  conic_source_settle(scene->source, &render);
  drawn->surfaces = (conic_gaussian_surfaces){&drawn->image, gaussians->is_linear, (uint32_t)gaussians->count};
  drawn->given = &drawn->surfaces;
  return conic_source_draw_surfaces(scene->source, scene->renderer, camera, &render, &scene->shot.view, planes,
                                    &drawn->image);
}
