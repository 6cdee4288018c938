#include "core/image/viewpoint.h"

#include <string.h>

/* The plane through the eye and a side of the picture: points with a·x + b·z ≥ 0 are inside. */
static void set_side(double side[3], int axis, double a, double b) {
  double length = sqrt(a * a + b * b);
  side[0] = side[1] = 0.0;
  side[axis] = a / length;
  side[2] = b / length;
}

void conic_viewpoint_init(conic_viewpoint *from, const conic_camera *camera, const double origin[3], double margin_px) {
  for (int row = 0; row < 3; row++) {
    const double *m = camera->cam_from_world[row];
    from->translation[row] = conic_dot(m, origin) + m[3];
    memcpy(from->rotation[row], m, sizeof from->rotation[row]);
  }
  for (int axis = 0; axis < 3; axis++)
    from->eye[axis] =
        -(from->rotation[0][axis] * from->translation[0] + from->rotation[1][axis] * from->translation[1] +
          from->rotation[2][axis] * from->translation[2]);
  set_side(from->side[0], 0, camera->fx, camera->cx + margin_px);
  set_side(from->side[1], 0, -camera->fx, (double)camera->width + margin_px - camera->cx);
  set_side(from->side[2], 1, camera->fy, camera->cy + margin_px);
  set_side(from->side[3], 1, -camera->fy, (double)camera->height + margin_px - camera->cy);
}
