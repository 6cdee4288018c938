#include "surface/patches/patches_view.h"

#include <math.h>

void conic_patches_view_init(conic_patches_view *view, const conic_camera *camera, const conic_render_options *render,
                             const double origin[3], double default_near, double step_px) {
  double growth_px = (double)render->kernel.cutoff * sqrt((double)render->prefilter) + 2.0; /* the filter widens
                                                                                               outlines by that */
  conic_viewpoint_init(&view->from, camera, origin, growth_px);
  view->near_z = render->near_z > 0.0 ? render->near_z : 0.999 * default_near;
  view->focal_px = camera->fx > camera->fy ? camera->fx : camera->fy;
  view->step_px = step_px;
  view->cull_back = render->cull_back;
}
