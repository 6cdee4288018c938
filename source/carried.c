#include "source/carried.h"

#include "core/base/vectors.h"
#include "core/image/view_arguments.h"

/* --- poses --- */

static const char *find_carry_fault(const conic_source_pose *poses, size_t n_poses) {
  for (size_t i = 0; i < n_poses; i++)
    if (poses[i].shapes[0] || poses[i].shapes[1])
      return "it keeps its shape: splats, points and meshes that are read whole change theirs";
    else if (memcmp(poses[i].world_from_rest, poses[0].world_from_rest, sizeof poses[0].world_from_rest) != 0)
      return "all of it moves as one: splats, points and meshes that are read whole move by themselves";
  return conic_rotation_fault((const double(*)[4])poses[0].world_from_rest)
             ? "it turns and shifts alone: splats, points and meshes that are read whole grow and shear"
             : NULL;
}

/* The box around the moved corners of the box at rest. */
static void carry_box(conic_source *source) {
  const conic_source_scale *scale = &source->scale;
  for (int row = 0; row < 3; row++) {
    const double *m = source->world_from_rest[row];
    double low = m[3], high = m[3];
    for (int axis = 0; axis < 3; axis++) {
      int is_turned = m[axis] < 0.0;
      low += m[axis] * (is_turned ? scale->maximum : scale->minimum)[axis];
      high += m[axis] * (is_turned ? scale->minimum : scale->maximum)[axis];
    }
    source->moved_minimum[row] = low;
    source->moved_maximum[row] = high;
  }
}

conic_status conic_carried_move(conic_source *source, const conic_source_pose *poses, size_t n_poses) {
  conic_source_pose rest;
  conic_source_pose_init(&rest);
  const char *fault = poses && n_poses ? find_carry_fault(poses, n_poses) : NULL;
  if (fault)
    return conic_fail(source->context, CONIC_ERROR_UNSUPPORTED, "%s: %s", source->name, fault);
  const conic_source_pose *pose = poses && n_poses ? poses : &rest;
  source->is_moved = memcmp(pose->world_from_rest, rest.world_from_rest, sizeof rest.world_from_rest) != 0;
  memcpy(source->world_from_rest, pose->world_from_rest, sizeof source->world_from_rest);
  carry_box(source);
  return CONIC_OK;
}

/* --- looking --- */

static void turn_to_rest(const conic_source *source, double direction[3]) {
  const double of_world[3] = {direction[0], direction[1], direction[2]};
  for (int axis = 0; axis < 3; axis++)
    direction[axis] = source->world_from_rest[0][axis] * of_world[0] + source->world_from_rest[1][axis] * of_world[1] +
                      source->world_from_rest[2][axis] * of_world[2];
}

void conic_carried_look(const conic_source *source, const conic_camera *camera, const conic_render_options *render,
                        conic_camera *rest_camera, conic_render_options *rest_render) {
  const conic_camera own = *camera;
  const double(*m)[4] = (const double(*)[4])source->world_from_rest;
  *rest_camera = own;
  *rest_render = *render;
  for (int row = 0; row < 3; row++)
    for (int column = 0; column < 4; column++) {
      const double *from = own.cam_from_world[row];
      rest_camera->cam_from_world[row][column] =
          from[0] * m[0][column] + from[1] * m[1][column] + from[2] * m[2][column] + (column == 3 ? from[3] : 0.0);
    }
  turn_to_rest(source, rest_render->light);
  turn_to_rest(source, rest_render->lighting.up);
  for (int i = 0; i < rest_render->lighting.n_lights && i < CONIC_MAX_LIGHTS; i++)
    if (rest_render->lighting.lights[i].frame == CONIC_LIGHT_WORLD)
      turn_to_rest(source, rest_render->lighting.lights[i].direction);
}

typedef struct turn_work {
  const conic_source *source;
  conic_image *image;
} turn_work;

static void turn_row(void *data, size_t y) {
  const turn_work *work = data;
  size_t width = (size_t)work->image->width;
  float *normal = (float *)work->image->planes[CONIC_PLANE_NORMAL] + 3 * width * y;
  for (size_t x = 0; x < width; x++, normal += 3) {
    const double n[3] = {(double)normal[0], (double)normal[1], (double)normal[2]};
    for (int row = 0; row < 3; row++)
      normal[row] = (float)conic_dot(work->source->world_from_rest[row], n);
  }
}

void conic_carried_turn(const conic_source *source, conic_image *image) {
  turn_work work = {source, image};
  if (image->planes[CONIC_PLANE_NORMAL])
    conic_parallel_for(source->context, (size_t)image->height, turn_row, &work);
}
