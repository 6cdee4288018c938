#include "core/base/vectors.h"
#include "core/image/image_common.h"
#include "core/image/view_arguments.h"
#include "gathering/gather_views.h"

CONIC_DEFINE_OPTIONS(conic_gather_options, .samples = 1, .fineness = 2.0, .edge = 256)

int conic_gather_is_depth(conic_plane plane) {
  return plane == CONIC_PLANE_Z || plane == CONIC_PLANE_MEDIAN_Z || plane == CONIC_PLANE_INVERSE_Z;
}

conic_camera conic_gather_side_camera(const conic_camera *camera, const double side[3][3], const double eye[3]) {
  conic_camera turned = {.fx = camera->fx, .fy = camera->fy};
  for (int row = 0; row < 3; row++)
    for (int column = 0; column < 4; column++) {
      double from[3];
      for (int i = 0; i < 3; i++)
        from[i] = camera->cam_from_world[i][column] - (column == 3 ? eye[i] : 0.0);
      turned.cam_from_world[row][column] = conic_dot(side[row], from);
    }
  return turned;
}

conic_status conic_gather_draw(const conic_gathering *g, const conic_gather_view *view, conic_image *image) {
  unsigned planes = conic_image_planes(g->image) | g->options->view_planes;
  conic_status status = conic_image_allocate(g->context, view->camera.width, view->camera.height, planes, image);
  if (status == CONIC_OK)
    status = g->options->draw(g->options->cookie, view, image);
  return status;
}

static const char *find_gather_fault(const conic_gather_options *o, const conic_image *image) {
  const conic_camera *camera = &o->camera;
  if (!o->draw || !image || image->width != camera->width || image->height != camera->height)
    return "nothing draws, or the image is not of the camera's size";
  if (o->samples < 1 || o->samples > 16 || camera->width > CONIC_IMAGE_MAX_SIZE / o->samples ||
      camera->height > CONIC_IMAGE_MAX_SIZE / o->samples)
    return "samples are 1 to 16, and that times the picture's size at most 65535";
  if (!(o->fineness >= 1.0 && o->fineness <= 16.0) || !(o->near_z >= 0.0 && o->near_z < 1e30))
    return "the fineness is 1 to 16, and the nearest depth not below 0";
  if (o->edge < 32 || o->edge > 4096)
    return "the edge of views is 32 to 4096";
  for (int i = 0; i < 2; i++)
    if (!(o->shift[i] >= 0.0 && o->shift[i] <= 1.0))
      return "the views' shift is 0 to 1";
  int is_moved = o->lens[0] != 0.0 || o->lens[1] != 0.0 || o->lens[2] != 0.0;
  for (int i = 0; i < 3; i++)
    if (!(fabs(o->lens[i]) < 1e30))
      return "the place on the lens is out of range";
  return is_moved && !(o->focus > 0.0 && o->focus < 1e30) ? "the focus is to be in front of the camera" : NULL;
}

conic_status conic_gather(conic_context *context, const conic_gather_options *given, conic_image *image) {
  conic_gather_options options;
  conic_gather_options_init(&options);
  if (!conic_options_take(&options, given))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "gather: the options were not initialised");
  conic_status status = conic_view_camera_check(context, "gather", &options.camera);
  const char *fault = status == CONIC_OK ? find_gather_fault(&options, image) : NULL;
  if (fault)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "gather: %s", fault);
  if (status == CONIC_OK && options.camera.kind != CONIC_CAMERA_CUBE)
    status = conic_view_ray_check(context, "gather", &options.camera);
  if (status != CONIC_OK)
    return status;
  const conic_gathering g = {context, &options, image};
  return options.camera.kind == CONIC_CAMERA_CUBE           ? conic_gather_cube(&g)
         : options.camera.kind == CONIC_CAMERA_ORTHOGRAPHIC ? conic_gather_parallel(&g)
                                                            : conic_gather_central(&g);
}
