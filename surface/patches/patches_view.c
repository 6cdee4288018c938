#include "surface/patches/patches_view.h"

#include <math.h>

/* What lies wholly past this line of pixels is out of sight; `axis` 0 for columns, 1 for rows. */
static void set_patches_side(double side[3], int axis, double focal_px, double from_center_px, double sign) {
  double inverse = 1.0 / sqrt(focal_px * focal_px + from_center_px * from_center_px);
  side[0] = side[1] = 0.0;
  side[axis] = sign * focal_px * inverse;
  side[2] = -sign * from_center_px * inverse;
}

void conic_patches_view_init(conic_patches_view *view, const conic_camera *camera, const conic_render_options *render,
                             const double origin[3], double default_near, double step_px) {
  double growth_px = (double)render->kernel.cutoff * sqrt((double)render->prefilter) + 2.0; /* what the filter adds */
  for (int i = 0; i < 3; i++) {
    const double *row = camera->cam_from_world[i];
    for (int j = 0; j < 3; j++)
      view->rotation[i][j] = row[j];
    view->translation[i] = ((row[0] * origin[0] + row[1] * origin[1]) + row[2] * origin[2]) + row[3];
  }
  set_patches_side(view->sides[0], 0, camera->fx, -growth_px - camera->cx, 1.0);
  set_patches_side(view->sides[1], 0, camera->fx, camera->width + growth_px - camera->cx, -1.0);
  set_patches_side(view->sides[2], 1, camera->fy, -growth_px - camera->cy, 1.0);
  set_patches_side(view->sides[3], 1, camera->fy, camera->height + growth_px - camera->cy, -1.0);
  view->near_z = render->near_z > 0.0 ? render->near_z : 0.999 * default_near;
  view->focal_px = camera->fx > camera->fy ? camera->fx : camera->fy;
  view->step_px = step_px;
  view->cull_back = render->cull_back;
}
