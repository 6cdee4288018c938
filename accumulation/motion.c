#include "conic/motion.h"

#include "accumulation/motion_file.h"
#include "conic/accumulate.h"
#include "core/base/vectors.h"
#include "core/files/file.h"

struct conic_motion {
  conic_context *context;
  conic_motion_keys keys;
  conic_source **shapes; /* of each key; null: the key is a pose */
  size_t n_inputs;
  conic_source_pose *poses; /* of each input, at the latest moment */
};

/* --- reading --- */

static conic_status open_shape(conic_motion *motion, const char *path, size_t i, const conic_source_options *options) {
  char name[2 * CONIC_MOTION_NAME_ROOM];
  const char *file = motion->keys.keys[i].file, *names[1] = {name};
  size_t n_folder = file[0] == '/' ? 0 : (size_t)(conic_file_name(path) - path);
  if (n_folder >= CONIC_MOTION_NAME_ROOM)
    return conic_fail(motion->context, CONIC_ERROR_INPUT, "%s: the name of its folder is too long", path);
  snprintf(name, sizeof name, "%.*s%s", (int)n_folder, path, file);
  return conic_source_open(motion->context, names, 1, options, &motion->shapes[i]);
}

static conic_status fill_motion(conic_motion *motion, const char *path, const conic_source_options *options) {
  conic_context *context = motion->context;
  conic_status status = conic_motion_keys_read(context, path, &motion->keys);
  if (status != CONIC_OK)
    return status;
  motion->poses = conic_memory_allocate_zeroed(context, motion->n_inputs, sizeof *motion->poses);
  motion->shapes = conic_memory_allocate_zeroed(context, motion->keys.count, sizeof(conic_source *));
  if (!motion->poses || !motion->shapes)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < motion->keys.count && status == CONIC_OK; i++) {
    const conic_motion_key *key = &motion->keys.keys[i];
    if (key->input >= 0 && (size_t)key->input >= motion->n_inputs)
      status = conic_fail(context, CONIC_ERROR_INPUT, "%s: there is no input %d: the last is %zu", path, key->input,
                          motion->n_inputs - 1);
    else if (key->file)
      status = open_shape(motion, path, i, options);
  }
  return status;
}

conic_status conic_motion_read(conic_context *context, const char *path, size_t n_inputs,
                               const conic_source_options *options, conic_motion **made) {
  *made = NULL;
  if (n_inputs == 0)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "motion: there is no input that moves");
  conic_motion *motion = conic_memory_allocate_zeroed(context, 1, sizeof *motion);
  if (!motion)
    return CONIC_ERROR_MEMORY;
  motion->context = context;
  motion->n_inputs = n_inputs;
  conic_status status = fill_motion(motion, path, options);
  if (status == CONIC_OK)
    *made = motion;
  else
    conic_motion_destroy(motion);
  return status;
}

void conic_motion_destroy(conic_motion *motion) {
  if (!motion)
    return;
  for (size_t i = 0; motion->shapes && i < motion->keys.count; i++)
    conic_source_close(motion->shapes[i]);
  conic_memory_release_these(motion->context, motion->shapes, motion->poses);
  conic_motion_keys_release(motion->context, &motion->keys);
  conic_memory_release(motion->context, motion);
}

/* --- moving --- */

/* The keys before and after a moment; null: none. */
typedef struct two_keys {
  const conic_motion_key *before, *after;
  double part;
} two_keys;

/* Finds keys among an input's poses, or its shapes; `input` may be CONIC_MOTION_ALL. */
static two_keys find_keys(const conic_motion *motion, int input, int is_shape, double frame) {
  two_keys found = {NULL, NULL, 0.0};
  for (size_t i = 0; i < motion->keys.count; i++) {
    const conic_motion_key *key = &motion->keys.keys[i];
    if (key->input != input || (key->file != NULL) != is_shape)
      continue;
    if (key->frame <= frame)
      found.before = key;
    else if (!found.after)
      found.after = key;
  }
  if (found.before && found.after)
    found.part = (frame - found.before->frame) / (found.after->frame - found.before->frame);
  return found;
}

/* Whether the matrix only turns and shifts. */
static int is_rigid(const double m[3][4]) {
  double across[3];
  int is_good = 1;
  for (int a = 0; a < 3; a++)
    for (int b = 0; b <= a; b++)
      is_good &= fabs(conic_dot(m[a], m[b]) - (a == b ? 1.0 : 0.0)) < 1e-6;
  conic_cross(m[0], m[1], across);
  return is_good && conic_dot(across, m[2]) > 0.0;
}

/* The inverse of a rigid matrix: a place in the world becomes a camera, and a camera a place. */
static void invert_rigid(const double m[3][4], double inverse[3][4]) {
  for (int row = 0; row < 3; row++) {
    for (int column = 0; column < 3; column++)
      inverse[row][column] = m[column][row];
    inverse[row][3] = -(m[0][row] * m[0][3] + m[1][row] * m[1][3] + m[2][row] * m[2][3]);
  }
}

static conic_status matrix_between(conic_context *context, const two_keys *keys, double matrix[3][4]) {
  const conic_motion_key *only = !keys->after || keys->part == 0.0 ? keys->before : NULL;
  if (!keys->before)
    only = keys->after;
  if (only || memcmp(keys->before->matrix, keys->after->matrix, sizeof keys->after->matrix) == 0) { /* the matrix stays,
                                                                                                       to the bit */
    memcpy(matrix, only ? only->matrix : keys->before->matrix, sizeof keys->before->matrix);
    return CONIC_OK;
  }
  if (is_rigid(keys->before->matrix) && is_rigid(keys->after->matrix)) {
    conic_camera from = {.width = 1, .height = 1}, to = from, between;
    invert_rigid(keys->before->matrix, from.cam_from_world);
    invert_rigid(keys->after->matrix, to.cam_from_world);
    conic_status status = conic_camera_between(context, &from, &to, keys->part, &between);
    if (status == CONIC_OK)
      invert_rigid(between.cam_from_world, matrix);
    return status;
  }
  for (int row = 0; row < 3; row++)
    for (int column = 0; column < 4; column++)
      matrix[row][column] = keys->before->matrix[row][column] +
                            (keys->after->matrix[row][column] - keys->before->matrix[row][column]) * keys->part;
  return CONIC_OK;
}

/* A shape at a moment; null: the input's own. */
typedef struct shape_key {
  double frame;
  conic_source *shape;
  int is_there;
} shape_key;

static void consider_shape(double frame, conic_source *shape, double moment, shape_key *before, shape_key *after) {
  if (frame <= moment && (!before->is_there || frame >= before->frame))
    *before = (shape_key){frame, shape, 1};
  if (frame > moment && (!after->is_there || frame <= after->frame))
    *after = (shape_key){frame, shape, 1};
}

/* An input's shape at frame 0 is its own file, unless a key has another shape there. */
static void find_shapes(const conic_motion *motion, int input, double moment, conic_source_pose *pose) {
  shape_key before = {.is_there = 0}, after = {.is_there = 0};
  consider_shape(0.0, NULL, moment, &before, &after);
  for (size_t i = 0; i < motion->keys.count; i++)
    if (motion->keys.keys[i].input == input && motion->shapes[i])
      consider_shape(motion->keys.keys[i].frame, motion->shapes[i], moment, &before, &after);
  if (!before.is_there || !after.is_there) {
    pose->shapes[0] = before.is_there ? before.shape : after.shape;
    return;
  }
  double part = (moment - before.frame) / (after.frame - before.frame);
  int is_to_own = after.shape == NULL; /* only the first shape can be the input's own: goes the same way, from the other
                                          end */
  pose->shapes[0] = is_to_own ? after.shape : before.shape;
  pose->shapes[1] = is_to_own ? before.shape : after.shape;
  pose->part = is_to_own ? 1.0 - part : part;
}

/* Adds the motion of all inputs after an input's own. */
static void follow_all(const double all[3][4], double matrix[3][4]) {
  double own[3][4];
  memcpy(own, matrix, sizeof own);
  for (int row = 0; row < 3; row++)
    for (int column = 0; column < 4; column++)
      matrix[row][column] = all[row][0] * own[0][column] + all[row][1] * own[1][column] + all[row][2] * own[2][column] +
                            (column == 3 ? all[row][3] : 0.0);
}

conic_status conic_motion_find(conic_motion *motion, double frame, const conic_source_pose **poses, size_t *n) {
  const two_keys of_all = find_keys(motion, CONIC_MOTION_ALL, 0, frame);
  conic_status status = CONIC_OK;
  for (size_t i = 0; i < motion->n_inputs && status == CONIC_OK; i++) {
    conic_source_pose *pose = &motion->poses[i];
    double all[3][4];
    conic_source_pose_init(pose);
    const two_keys own = find_keys(motion, (int)i, 0, frame);
    if (own.before || own.after)
      status = matrix_between(motion->context, &own, pose->world_from_rest);
    if (status == CONIC_OK && (of_all.before || of_all.after))
      status = matrix_between(motion->context, &of_all, all);
    if (status == CONIC_OK && (of_all.before || of_all.after)) {
      if (own.before || own.after)
        follow_all((const double(*)[4])all, pose->world_from_rest);
      else
        memcpy(pose->world_from_rest, all, sizeof all);
    }
    find_shapes(motion, (int)i, frame, pose);
  }
  *poses = motion->poses;
  *n = motion->n_inputs;
  return status;
}

conic_status conic_motion_apply(conic_motion *motion, conic_source *source, double frame) {
  const conic_source_pose *poses;
  size_t n;
  conic_status status = conic_motion_find(motion, frame, &poses, &n);
  return status == CONIC_OK ? conic_source_move(source, poses, n) : status;
}
