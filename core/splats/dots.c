/* Dots: splats that face whoever looks. */

#include "core/base/base.h"
#include "core/base/vectors.h"
#include "core/splats/columns.h"
#include "core/splats/ellipse.h"

/* A normal leans at most so far from the viewer, as a cosine: the dot then is twice as long in depth as on the screen.
 */
#define LEAST_COSINE 0.5

enum { CHUNK = 4096 };

typedef struct facing_work {
  const conic_splats *splats;
  double eye[3]; /* from the set's origin */
  float *const *tangent_u, *const *tangent_v;
} facing_work;

size_t conic_splats_count_dots(const conic_splats *splats) {
  size_t n = 0;
  for (size_t i = 0; splats->dot && i < splats->count; i++)
    n += conic_column_at(splats->dot, splats->strides.dot, i) != 0.0f;
  return n;
}

/* Turns the normal to the side of `back`, the unit vector towards the viewer, and no farther from it than the greatest
 * lean. */
static void settle_normal(const double back[3], double normal[3]) {
  double cosine = conic_dot(normal, back), sign = cosine < 0.0 ? -1.0 : 1.0, across[3];
  for (int axis = 0; axis < 3; axis++)
    normal[axis] *= sign;
  cosine *= sign;
  if (cosine >= LEAST_COSINE)
    return;
  for (int axis = 0; axis < 3; axis++)
    across[axis] = normal[axis] - cosine * back[axis];
  conic_normalize(across);
  double sine = sqrt(1.0 - LEAST_COSINE * LEAST_COSINE);
  for (int axis = 0; axis < 3; axis++)
    normal[axis] = LEAST_COSINE * back[axis] + sine * across[axis];
}

/* The disc across the line of sight, whose radius is `sigma`, moved along that line into the plane of the normal: u is
 * in both planes, and v is as much longer as the normal leans. */
static void lean_disc(const double back[3], const double normal[3], double sigma, double u[3], double v[3]) {
  double rise;
  conic_cross(normal, back, u);
  if (conic_length(u) > 1e-6) {
    conic_normalize(u);
    conic_cross(back, u, v);
  } else
    conic_tangent_basis(back, u, v);
  rise = conic_dot(v, normal) / conic_dot(back, normal);
  for (int axis = 0; axis < 3; axis++) {
    u[axis] *= sigma;
    v[axis] = sigma * (v[axis] - rise * back[axis]);
  }
}

static void face_dot(const facing_work *work, size_t i) {
  const conic_splats *splats = work->splats;
  double u[3], v[3], normal[3], back[3];
  conic_columns_at(splats->tangent_u, splats->strides.tangent_u, i, u);
  conic_columns_at(splats->tangent_v, splats->strides.tangent_v, i, v);
  conic_columns_at(splats->position, splats->strides.position, i, back);
  for (int axis = 0; axis < 3; axis++)
    back[axis] = work->eye[axis] - back[axis];
  double a = conic_length(u), b = conic_length(v);
  conic_cross(u, v, normal);
  if (conic_normalize(normal) && conic_normalize(back)) {
    settle_normal(back, normal);
    lean_disc(back, normal, a > b ? a : b, u, v);
  }
  for (int axis = 0; axis < 3; axis++) {
    work->tangent_u[axis][i] = (float)u[axis];
    work->tangent_v[axis][i] = (float)v[axis];
  }
}

static void face_chunk(void *data, size_t i_item) {
  const facing_work *work = data;
  const conic_splats *splats = work->splats;
  size_t begin = i_item * CHUNK, end = begin + CHUNK < splats->count ? begin + CHUNK : splats->count;
  for (size_t i = begin; i < end; i++)
    if (conic_column_at(splats->dot, splats->strides.dot, i) != 0.0f)
      face_dot(work, i);
}

conic_status conic_splats_face(conic_context *context, const conic_splats *splats, const conic_camera *camera,
                               float *const tangent_u[3], float *const tangent_v[3]) {
  facing_work work = {.splats = splats, .tangent_u = tangent_u, .tangent_v = tangent_v};
  conic_status status = conic_splats_check(context, "face", splats);
  for (int axis = 0; axis < 3 && status == CONIC_OK; axis++)
    if (!camera || !splats->tangent_u[0] || !tangent_u[axis] || !tangent_v[axis])
      status = conic_fail(context, CONIC_ERROR_ARGUMENT, "face: no camera, or no tangent axes");
  if (status != CONIC_OK || !splats->dot)
    return status;
  for (int axis = 0; axis < 3; axis++) {
    work.eye[axis] = -splats->origin[axis];
    for (int row = 0; row < 3; row++)
      work.eye[axis] -= camera->cam_from_world[row][axis] * camera->cam_from_world[row][3];
  }
  conic_parallel_for(context, (splats->count + CHUNK - 1) / CHUNK, face_chunk, &work);
  return CONIC_OK;
}
