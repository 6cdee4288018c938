/* Pictures that consist of views, pixel by pixel: the sides of a cube, and views from far away. */

#include "core/base/vectors.h"
#include "core/image/image_common.h"
#include "gathering/gather_views.h"

/* Copies a view to its place in the picture; depths grow by `deeper` where something is. */
static void put_view(const conic_gathering *g, const conic_image *view, size_t x, size_t y, double deeper) {
  for (int i = 0; i < CONIC_N_PLANES; i++) {
    const conic_plane plane = (conic_plane)i;
    if (!g->image->planes[i])
      continue;
    size_t n = (size_t)conic_plane_describe(plane)->n_channels, width = (size_t)view->width;
    for (size_t row = 0; row < (size_t)view->height; row++) {
      float *to = (float *)g->image->planes[i] + ((y + row) * (size_t)g->image->width + x) * n;
      memcpy(to, (const float *)view->planes[i] + row * width * n, width * n * sizeof *to);
      for (size_t k = 0; k < width && deeper != 0.0 && conic_gather_is_depth(plane); k++)
        to[k] = to[k] > 0.0f ? (float)((double)to[k] + deeper) : to[k];
    }
  }
}

/* All sides are seen from one eye. If it moves forward, the side widens so that the plane in focus stays. */
static conic_camera cube_side_camera(const conic_gather_options *o, int i_side) {
  const conic_camera *camera = &o->camera;
  conic_camera turned = conic_gather_side_camera(camera, conic_cube_sides[i_side], o->lens);
  turned.width = turned.height = camera->width;
  turned.cx = camera->cx;
  turned.cy = camera->cy;
  if (!(o->focus > 0.0))
    return turned;
  turned.cx += camera->fx * (conic_dot(conic_cube_sides[i_side][0], o->lens) / o->focus);
  turned.cy += camera->fy * (conic_dot(conic_cube_sides[i_side][1], o->lens) / o->focus);
  double nearer = 1.0 - conic_dot(conic_cube_sides[i_side][2], o->lens) / o->focus;
  turned.fx *= nearer;
  turned.fy *= nearer;
  return turned;
}

conic_status conic_gather_cube(const conic_gathering *g) {
  const conic_gather_options *o = g->options;
  conic_status status = CONIC_OK;
  for (int i = 0; i < CONIC_CUBE_SIDES && status == CONIC_OK; i++) {
    conic_image image = {0};
    const conic_gather_view view = {.camera = cube_side_camera(o, i), .near_z = o->near_z, .samples = o->samples};
    if (!(view.camera.fx > 0.0))
      return conic_fail(g->context, CONIC_ERROR_ARGUMENT, "gather: the lens reaches as far as the focus");
    status = conic_gather_draw(g, &view, &image);
    if (status == CONIC_OK)
      put_view(g, &image, 0, (size_t)i * (size_t)o->camera.width, 0.0);
    conic_image_release(g->context, &image);
  }
  return status;
}

/* --- from far away --- */

/* The depths of the box of all that is drawn. */
static void find_far_depths(const conic_gather_options *o, double depths[2]) {
  depths[0] = HUGE_VAL;
  depths[1] = -HUGE_VAL;
  for (int corner = 0; corner < 8; corner++) {
    double z = o->camera.cam_from_world[2][3];
    for (int axis = 0; axis < 3; axis++)
      z += o->camera.cam_from_world[2][axis] * (corner >> axis & 1 ? o->maximum : o->minimum)[axis];
    CONIC_WIDEN(depths[0], depths[1], z, z);
  }
}

/* The eye is so far away that rays through a view's corner differ from parallel ones by at most 1/2048 of the pixels to
 * the middle, over all depths; floats still tell depths apart by that. */
static double find_far_distance(const conic_gather_options *o, const double depths[2]) {
  const double across = o->edge / (o->camera.fx < o->camera.fy ? o->camera.fx : o->camera.fy);
  double by_depth = 2048.0 * 0.5 * (depths[1] - depths[0]), by_width = 256.0 * across;
  return by_depth > by_width ? by_depth : by_width;
}

/* A column or row of blocks: pixels from begin to before end. */
typedef struct far_block {
  int begin, end;
} far_block;

static far_block find_block(const conic_gather_options *o, int i, int axis, int n_pixels) {
  int begin = i * o->edge - (int)(o->shift[axis] * o->edge), end = begin + o->edge;
  return (far_block){begin > 0 ? begin : 0, end < n_pixels ? end : n_pixels};
}

static conic_status draw_block(const conic_gathering *g, far_block across, far_block down, double middle,
                               double distance) {
  const conic_gather_options *o = g->options;
  const conic_camera *camera = &o->camera;
  const double at_x = 0.5 * (across.begin + across.end), at_y = 0.5 * (down.begin + down.end),
               far_z = middle - distance;
  const double tilt[2] = {o->focus > 0.0 ? o->lens[0] / o->focus : 0.0, o->focus > 0.0 ? o->lens[1] / o->focus : 0.0};
  const double eye[3] = {(at_x - camera->cx) / camera->fx + (o->focus - far_z) * tilt[0],
                         (at_y - camera->cy) / camera->fy + (o->focus - far_z) * tilt[1], far_z};
  conic_image image = {0};
  conic_gather_view view = {.camera = conic_gather_side_camera(camera, conic_cube_sides[CONIC_CUBE_FORWARD], eye),
                            .near_z = fmax(o->near_z - far_z, 0.5 * distance),
                            .samples = o->samples};
  view.camera.width = across.end - across.begin;
  view.camera.height = down.end - down.begin;
  view.camera.fx = distance * camera->fx;
  view.camera.fy = distance * camera->fy;
  view.camera.cx = at_x - across.begin + view.camera.fx * tilt[0];
  view.camera.cy = at_y - down.begin + view.camera.fy * tilt[1];
  conic_status status = conic_gather_draw(g, &view, &image);
  if (status == CONIC_OK)
    put_view(g, &image, (size_t)across.begin, (size_t)down.begin, far_z);
  conic_image_release(g->context, &image);
  return status;
}

conic_status conic_gather_parallel(const conic_gathering *g) {
  const conic_gather_options *o = g->options;
  double depths[2];
  conic_status status = CONIC_OK;
  find_far_depths(o, depths);
  if (!(depths[1] - depths[0] < 1e20 && fabs(depths[0]) < 1e20) || o->lens[2] != 0.0 ||
      conic_image_planes(g->image) >> CONIC_PLANE_INVERSE_Z & 1)
    return conic_fail(g->context, CONIC_ERROR_ARGUMENT,
                      "gather: an orthographic camera wants the box of what it sees, a flat lens, and no inverseZ");
  double distance = find_far_distance(o, depths), middle = 0.5 * (depths[0] + depths[1]);
  far_block across, down = {0, 0};
  for (int i = 0; down.end < o->camera.height && status == CONIC_OK; i++) {
    down = find_block(o, i, 1, o->camera.height);
    across.end = down.end > down.begin ? 0 : o->camera.width;
    for (int k = 0; across.end < o->camera.width && status == CONIC_OK; k++) {
      across = find_block(o, k, 0, o->camera.width);
      if (across.end > across.begin)
        status = draw_block(g, across, down, middle, distance);
    }
  }
  return status;
}
