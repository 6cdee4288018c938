#include "shots/motion_plane.h"

#include "accumulation/motion_file.h"
#include "core/base/vectors.h"
#include "core/image/camera_rays.h"
#include "source/source_kind.h"
#include "source/surfaces_among.h"

enum { N_MOMENTS = 2 }; /* a frame later, and a frame before */

typedef double affine[3][4];

typedef struct following {
  const conic_shot_work *work;
  conic_camera_rays rays;
  conic_camera cameras[N_MOMENTS];
  affine (*moves)[1 + N_MOMENTS]; /* of each input: from now to rest, and from there to then; null: they rest */
  size_t n_inputs;
  double offset;
  const conic_image *image;
} following;

/* The camera so many frames from the shot's own. */
static conic_status camera_then(const conic_shot_work *work, double frames, conic_camera *camera) {
  conic_shot shot = *work->shot;
  shot.is_shutter_open = 1;
  shot.shutter[0] = shot.shutter[1] = frames;
  return conic_shot_camera(work->context, &shot, 0.5, camera);
}

/* The moment of the picture, in frames from the shot's own. */
static double moment_of(const conic_shot *shot) {
  return shot->is_shutter_open ? 0.5 * (shot->shutter[0] + shot->shutter[1]) : 0.0;
}

/* A window's camera has another middle than those of the way. */
static conic_status find_cameras(following *f, const conic_camera *camera) {
  double now = moment_of(f->work->shot);
  conic_camera own;
  conic_status status = camera_then(f->work, now, &own);
  for (int i = 0; i < N_MOMENTS && status == CONIC_OK; i++) {
    status = camera_then(f->work, now + (i ? -1.0 : 1.0), &f->cameras[i]);
    f->cameras[i].cx += camera->cx - own.cx;
    f->cameras[i].cy += camera->cy - own.cy;
  }
  return status;
}

/* By the cross products of the rows; the determinant of a pose is above 0. */
static void invert(const affine m, affine inverse) {
  double columns[3][3];
  for (int i = 0; i < 3; i++)
    conic_cross(m[(i + 1) % 3], m[(i + 2) % 3], columns[i]);
  double determinant = conic_dot(m[0], columns[0]);
  for (int row = 0; row < 3; row++) {
    inverse[row][3] = 0.0;
    for (int column = 0; column < 3; column++) {
      inverse[row][column] = columns[column][row] / determinant;
      inverse[row][3] -= inverse[row][column] * m[column][3];
    }
  }
}

/* The ways back to rest, and on from there to the other moments. */
static conic_status find_moves(following *f) {
  static const double frames[] = {0.0, 1.0, -1.0};
  const conic_shot *shot = f->work->shot;
  const conic_source_pose *poses;
  size_t n = 0;
  conic_status status = conic_motion_find(shot->motion, shot->frame, &poses, &n);
  if (status == CONIC_OK && !(f->moves = conic_memory_allocate(f->work->context, n, sizeof *f->moves)))
    status = CONIC_ERROR_MEMORY;
  f->n_inputs = n;
  for (int i = 0; i <= N_MOMENTS && status == CONIC_OK; i++) {
    status = conic_motion_find(shot->motion, shot->frame + moment_of(shot) + frames[i], &poses, &n);
    for (size_t k = 0; k < n && status == CONIC_OK; k++)
      if (poses[k].shapes[0] || poses[k].shapes[1])
        status = conic_fail(f->work->context, CONIC_ERROR_UNSUPPORTED,
                            "the plane motion is of inputs that matrices move, not of shapes that change");
      else if (i == 0)
        invert(poses[k].world_from_rest, f->moves[k][0]);
      else
        memcpy(f->moves[k][i], poses[k].world_from_rest, sizeof f->moves[k][i]);
  }
  return status;
}

static void apply(const affine m, const double from[3], double to[3]) {
  for (int row = 0; row < 3; row++)
    to[row] = conic_dot(m[row], from) + m[row][3];
}

/* Where a world's point is in a picture of a camera without a lens. */
static int project(const conic_camera *camera, const double place[3], double at[2]) {
  double seen[3];
  apply(camera->cam_from_world, place, seen);
  double depth = camera->kind == CONIC_CAMERA_ORTHOGRAPHIC ? 1.0 : seen[2];
  at[0] = camera->fx * (seen[0] / depth) + camera->cx;
  at[1] = camera->fy * (seen[1] / depth) + camera->cy;
  return seen[2] > 0.0;
}

static void follow_row(void *data, size_t y) {
  const following *f = data;
  const conic_image *image = f->image;
  const float *z = image->planes[CONIC_PLANE_Z];
  const uint32_t *id = image->planes[CONIC_PLANE_ID];
  float *motion = image->planes[CONIC_PLANE_MOTION];
  for (size_t i = y * (size_t)image->width, end = i + (size_t)image->width; i < end; i++) {
    const double here[2] = {(double)(i % (size_t)image->width) + 0.5 + f->offset, (double)y + 0.5 + f->offset};
    double now[3], then[3], rest[3], at[2];
    memset(motion + 4 * i, 0, 4 * sizeof *motion);
    if (!(z[i] > 0.0f))
      continue;
    conic_camera_unproject(&f->rays, here[0], here[1], (double)z[i], now);
    size_t input = f->moves ? conic_source_input_of(f->work->source, id[i]) : 0;
    for (int k = 0; k < N_MOMENTS; k++) {
      memcpy(then, now, sizeof then);
      if (f->moves && input < f->n_inputs) {
        apply((const double(*)[4])f->moves[input][0], now, rest);
        apply((const double(*)[4])f->moves[input][k + 1], rest, then);
      }
      for (int axis = 0; project(&f->cameras[k], then, at) && axis < 2; axis++)
        motion[4 * i + (size_t)(2 * k + axis)] = (float)(at[axis] - here[axis]);
    }
  }
}

conic_status conic_motion_plane_find(const conic_shot_work *work, const conic_camera *camera, int samples,
                                     const conic_image *image) {
  following f = {.work = work, .offset = conic_depth_offset(samples), .image = image};
  if (!image->planes[CONIC_PLANE_MOTION])
    return CONIC_OK;
  conic_camera_rays_init(camera, &f.rays);
  conic_status status = find_cameras(&f, camera);
  if (status == CONIC_OK && work->shot->motion)
    status = find_moves(&f);
  if (status == CONIC_OK)
    conic_parallel_for(work->context, (size_t)image->height, follow_row, &f);
  conic_memory_release(work->context, f.moves);
  return status;
}
