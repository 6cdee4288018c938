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

/* For cameras other than pinholes. */
static void locate_on_ray(const positions *work, double x_px, double y_px, double z, double there[3]) {
  double origin[3], direction[3];
  conic_camera_ray(&work->rays, x_px, y_px, origin, direction);
  for (int axis = 0; axis < 3; axis++)
    there[axis] = origin[axis] + z * direction[axis];
}

static void locate_row(void *data, size_t y) {
  const positions *work = data;
  const conic_camera *camera = work->camera;
  size_t width = (size_t)camera->width;
  for (size_t x = 0; x < width; x++) {
    const double z = (double)work->z[y * width + x];
    double there[3] = {z * (((double)x + 0.5 + work->offset - camera->cx) / camera->fx),
                       z * (((double)y + 0.5 + work->offset - camera->cy) / camera->fy), z};
    if (camera->kind || camera->lens)
      locate_on_ray(work, (double)x + 0.5 + work->offset, (double)y + 0.5 + work->offset, z, there);
    for (int axis = 0; axis < 3; axis++) {
      double sum = 0.0;
      for (int row = 0; row < 3; row++)
        sum += camera->cam_from_world[row][axis] * (there[row] - camera->cam_from_world[row][3]);
      work->to[3 * (y * width + x) + (size_t)axis] = z > 0.0 ? (float)sum : 0.0f;
    }
  }
}

conic_status conic_image_locate(conic_context *context, const conic_camera *camera, int samples, conic_image *image) {
  if (!camera || !image || !image->planes[CONIC_PLANE_POSITION])
    return CONIC_OK;
  if (!image->planes[CONIC_PLANE_Z] || image->width != camera->width || image->height != camera->height || samples < 1)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "image: places come of the plane Z and its camera");
  positions work = {.camera = camera, .z = image->planes[CONIC_PLANE_Z], .to = image->planes[CONIC_PLANE_POSITION]};
  conic_camera_rays_init(camera, &work.rays);
  work.offset = samples % 2 ? 0.0 : -0.5 / samples;
  conic_parallel_for(context, (size_t)image->height, locate_row, &work);
  return CONIC_OK;
}
