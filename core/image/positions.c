/* The world position of what a pixel shows, from its depth and the camera. */
#include "conic/image.h"
#include "core/base/base.h"
#include "core/image/camera_rays.h"

typedef struct positions {
  const conic_camera *camera;
  conic_camera_rays rays;
  double offset; /* from the pixel's centre to the sample whose depth Z is */
  const float *z;
  float *to;
} positions;

void conic_camera_unproject(const conic_camera_rays *rays, double x_px, double y_px, double z, double place[3]) {
  const conic_camera *camera = rays->camera;
  double there[3] = {z * ((x_px - camera->cx) / camera->fx), z * ((y_px - camera->cy) / camera->fy), z};
  if (!rays->is_pinhole) {
    double origin[3], direction[3];
    conic_camera_ray(rays, x_px, y_px, origin, direction);
    for (int axis = 0; axis < 3; axis++)
      there[axis] = origin[axis] + z * direction[axis];
  }
  for (int axis = 0; axis < 3; axis++) {
    place[axis] = 0.0;
    for (int row = 0; row < 3; row++)
      place[axis] += camera->cam_from_world[row][axis] * (there[row] - camera->cam_from_world[row][3]);
  }
}

static void locate_row(void *data, size_t y) {
  const positions *work = data;
  size_t width = (size_t)work->camera->width;
  for (size_t x = 0; x < width; x++) {
    const double z = (double)work->z[y * width + x];
    double place[3];
    conic_camera_unproject(&work->rays, (double)x + 0.5 + work->offset, (double)y + 0.5 + work->offset, z, place);
    for (int axis = 0; axis < 3; axis++)
      work->to[3 * (y * width + x) + (size_t)axis] = z > 0.0 ? (float)place[axis] : 0.0f;
  }
}

conic_status conic_image_locate(conic_context *context, const conic_camera *camera, int samples, conic_image *image) {
  if (!camera || !image || !image->planes[CONIC_PLANE_POSITION])
    return CONIC_OK;
  if (!image->planes[CONIC_PLANE_Z] || image->width != camera->width || image->height != camera->height || samples < 1)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "image: places come of the plane Z and its camera");
  positions work = {.camera = camera, .z = image->planes[CONIC_PLANE_Z], .to = image->planes[CONIC_PLANE_POSITION]};
  conic_camera_rays_init(camera, &work.rays);
  work.offset = conic_depth_offset(samples);
  conic_parallel_for(context, (size_t)image->height, locate_row, &work);
  return CONIC_OK;
}
