#include "source/moved_drawing.h"

#include "core/base/base.h"
#include "core/base/vectors.h"

enum { CHUNK = 4096 };

size_t conic_triangles_normals(const conic_triangles *triangles) {
  return !triangles->normal[0] ? 0 : triangles->normal_corners ? triangles->n_normals : triangles->n_vertices;
}

int conic_pose_is_at_rest(const conic_source_pose *pose) {
  conic_source_pose rest;
  conic_source_pose_init(&rest);
  return memcmp(rest.world_from_rest, pose->world_from_rest, sizeof rest.world_from_rest) == 0 && !pose->shapes[0] &&
         (!pose->shapes[1] || pose->part == 0.0);
}

/* --- room --- */

static conic_status own_arrays(conic_context *context, float *arrays[3], size_t n) {
  int is_complete = 1;
  for (int axis = 0; axis < 3; axis++) {
    arrays[axis] = conic_memory_allocate(context, n, sizeof(float));
    is_complete &= arrays[axis] != NULL;
  }
  return is_complete ? CONIC_OK : CONIC_ERROR_MEMORY;
}

static void release_arrays(conic_context *context, float *const arrays[3]) {
  for (int axis = 0; axis < 3; axis++)
    conic_memory_release(context, arrays[axis]);
}

conic_status conic_moved_begin(conic_context *context, const conic_drawing *rest, conic_splats *splats,
                               conic_triangles *triangles) {
  *splats = *rest->splats;
  *triangles = *rest->triangles;
  for (int axis = 0; axis < 3; axis++) {
    splats->position[axis] = splats->tangent_u[axis] = splats->tangent_v[axis] = NULL;
    triangles->position[axis] = triangles->normal[axis] = NULL;
  }
  conic_status status = own_arrays(context, splats->position, splats->count);
  if (status == CONIC_OK)
    status = own_arrays(context, splats->tangent_u, splats->count);
  if (status == CONIC_OK)
    status = own_arrays(context, splats->tangent_v, splats->count);
  if (status == CONIC_OK)
    status = own_arrays(context, triangles->position, triangles->n_vertices);
  if (status == CONIC_OK && rest->triangles->normal[0])
    status = own_arrays(context, triangles->normal, conic_triangles_normals(rest->triangles));
  return status;
}

static void swap_arrays(float *a[3], float *b[3]) {
  for (int axis = 0; axis < 3; axis++) {
    float *const kept = a[axis];
    a[axis] = b[axis];
    b[axis] = kept;
  }
}

void conic_moved_swap(conic_splats *rest, conic_triangles *rest_triangles, conic_splats *moved,
                      conic_triangles *moved_triangles) {
  swap_arrays(rest->position, moved->position);
  swap_arrays(rest->tangent_u, moved->tangent_u);
  swap_arrays(rest->tangent_v, moved->tangent_v);
  swap_arrays(rest_triangles->position, moved_triangles->position);
  if (rest_triangles->normal[0])
    swap_arrays(rest_triangles->normal, moved_triangles->normal);
}

void conic_moved_end(conic_context *context, conic_splats *splats, conic_triangles *triangles) {
  release_arrays(context, splats->position);
  release_arrays(context, splats->tangent_u);
  release_arrays(context, splats->tangent_v);
  release_arrays(context, triangles->position);
  release_arrays(context, triangles->normal);
}

int conic_moved_fits(const conic_drawing_range *range, const conic_drawing *shape) {
  return shape->splats->count == range->splats[1] - range->splats[0] &&
         shape->triangles->n_vertices == range->vertices[1] - range->vertices[0] &&
         conic_triangles_normals(shape->triangles) == range->normals[1] - range->normals[0];
}

/* --- moving --- */

/* One array to be moved: `from` at rest, `first` and `second` in the shapes, `to` the result. */
typedef struct moving {
  const conic_source_pose *pose;
  double normal_from_rest[3][3];
  const conic_splats *rest, *shapes[2]; /* splats; null shapes stand for `rest` */
  const conic_splats *to;
  const conic_triangles *rest_triangles, *triangle_shapes[2], *to_triangles;
  size_t begin, end; /* of the range */
} moving;

static void turn_vector(const double m[3][4], const double v[3], double turned[3]) {
  for (int row = 0; row < 3; row++)
    turned[row] = m[row][0] * v[0] + m[row][1] * v[1] + m[row][2] * v[2];
}

static void part_way(const double from[3], const double to[3], double part, double at[3]) {
  for (int axis = 0; axis < 3; axis++)
    at[axis] = from[axis] + (to[axis] - from[axis]) * part;
}

static void store_vector(float *const arrays[3], size_t i, const double v[3]) {
  for (int axis = 0; axis < 3; axis++)
    arrays[axis][i] = (float)v[axis];
}

static void load_place(const double origin[3], float *const arrays[3], size_t i, double v[3]) {
  conic_vector_at(arrays, i, v);
  for (int axis = 0; axis < 3; axis++)
    v[axis] += origin[axis];
}

static void put_moved_place(const moving *work, const double place[3], const double origin[3], float *const arrays[3],
                            size_t i) {
  double at[3];
  turn_vector(work->pose->world_from_rest, place, at);
  for (int axis = 0; axis < 3; axis++)
    at[axis] = at[axis] + work->pose->world_from_rest[axis][3] - origin[axis];
  store_vector(arrays, i, at);
}

/* Turns or mirrors the axes of an ellipse within it to where they are nearest to another ellipse's: estimated axes may
 * have any angle. The turn with the greatest sum of products of new and other axes is taken. */
static void meet_axes(const double u[3], const double v[3], double other_u[3], double other_v[3]) {
  double uu = conic_dot(u, other_u), uv = conic_dot(u, other_v), vu = conic_dot(v, other_u), vv = conic_dot(v, other_v);
  double turned[2] = {uu + vv, uv - vu}, mirrored[2] = {uu - vv, uv + vu};
  double square = turned[0] * turned[0] + turned[1] * turned[1];
  double other = mirrored[0] * mirrored[0] + mirrored[1] * mirrored[1];
  int is_mirrored = other > square;
  double length = sqrt(is_mirrored ? other : square);
  if (!(length > 0.0))
    return;
  double c = (is_mirrored ? mirrored[0] : turned[0]) / length, s = (is_mirrored ? mirrored[1] : turned[1]) / length;
  for (int axis = 0; axis < 3; axis++) {
    double a = other_u[axis], b = other_v[axis];
    other_u[axis] = c * a + s * b;
    other_v[axis] = is_mirrored ? s * a - c * b : c * b - s * a;
  }
}

static void move_splats(void *data, size_t i_chunk) {
  const moving *work = data;
  const conic_splats *from = work->shapes[0] ? work->shapes[0] : work->rest, *next = work->shapes[1];
  size_t shift = work->shapes[0] ? work->begin : 0, last = work->begin + (i_chunk + 1) * CHUNK;
  for (size_t i = work->begin + i_chunk * CHUNK; i < last && i < work->end; i++) {
    double place[3], u[3], v[3], turned[3];
    load_place(from->origin, from->position, i - shift, place);
    conic_vector_at(from->tangent_u, i - shift, u);
    conic_vector_at(from->tangent_v, i - shift, v);
    if (next) {
      double place_next[3], u_next[3], v_next[3];
      load_place(next->origin, next->position, i - work->begin, place_next);
      conic_vector_at(next->tangent_u, i - work->begin, u_next);
      conic_vector_at(next->tangent_v, i - work->begin, v_next);
      meet_axes(u, v, u_next, v_next);
      part_way(place, place_next, work->pose->part, place);
      part_way(u, u_next, work->pose->part, u);
      part_way(v, v_next, work->pose->part, v);
    }
    put_moved_place(work, place, work->to->origin, work->to->position, i);
    turn_vector(work->pose->world_from_rest, u, turned);
    store_vector(work->to->tangent_u, i, turned);
    turn_vector(work->pose->world_from_rest, v, turned);
    store_vector(work->to->tangent_v, i, turned);
  }
}

static void move_corners(void *data, size_t i_chunk) {
  const moving *work = data;
  const conic_triangles *next = work->triangle_shapes[1],
                        *from = work->triangle_shapes[0] ? work->triangle_shapes[0] : work->rest_triangles;
  size_t shift = work->triangle_shapes[0] ? work->begin : 0, last = work->begin + (i_chunk + 1) * CHUNK;
  for (size_t i = work->begin + i_chunk * CHUNK; i < last && i < work->end; i++) {
    double place[3], place_next[3];
    load_place(from->origin, from->position, i - shift, place);
    if (next) {
      load_place(next->origin, next->position, i - work->begin, place_next);
      part_way(place, place_next, work->pose->part, place);
    }
    put_moved_place(work, place, work->to_triangles->origin, work->to_triangles->position, i);
  }
}

/* Normals may have any length: only the direction of their mean counts. */
static void move_normals(void *data, size_t i_chunk) {
  const moving *work = data;
  const conic_triangles *next = work->triangle_shapes[1],
                        *from = work->triangle_shapes[0] ? work->triangle_shapes[0] : work->rest_triangles;
  size_t shift = work->triangle_shapes[0] ? work->begin : 0, last = work->begin + (i_chunk + 1) * CHUNK;
  for (size_t i = work->begin + i_chunk * CHUNK; i < last && i < work->end; i++) {
    double normal[3], normal_next[3], turned[3];
    conic_vector_at(from->normal, i - shift, normal);
    if (next) {
      conic_vector_at(next->normal, i - work->begin, normal_next);
      part_way(normal, normal_next, work->pose->part, normal);
    }
    for (int row = 0; row < 3; row++)
      turned[row] = conic_dot(work->normal_from_rest[row], normal);
    store_vector(work->to_triangles->normal, i, turned);
  }
}

static void run_over(conic_context *context, const size_t range[2], conic_task task, moving *work) {
  work->begin = range[0];
  work->end = range[1];
  conic_parallel_region(context, "move", (range[1] - range[0] + CHUNK - 1) / CHUNK, task, work);
}

static void copy_range(float *const to[3], float *const from[3], const size_t range[2]) {
  for (int axis = 0; axis < 3 && to[axis] && from[axis]; axis++)
    memcpy(to[axis] + range[0], from[axis] + range[0], (range[1] - range[0]) * sizeof(float));
}

void conic_moved_put(conic_context *context, const conic_drawing *rest, const conic_drawing_range *range,
                     const conic_source_pose *pose, const conic_splats *splats, const conic_triangles *triangles) {
  moving work = {
      .pose = pose, .rest = rest->splats, .to = splats, .rest_triangles = rest->triangles, .to_triangles = triangles};
  if (!pose) {
    copy_range(splats->position, rest->splats->position, range->splats);
    copy_range(splats->tangent_u, rest->splats->tangent_u, range->splats);
    copy_range(splats->tangent_v, rest->splats->tangent_v, range->splats);
    copy_range(triangles->position, rest->triangles->position, range->vertices);
    copy_range(triangles->normal, rest->triangles->normal, range->normals);
    return;
  }
  for (int i = 0; i < 2; i++)
    if (pose->shapes[i]) {
      const conic_drawing *shape = &conic_source_chosen(pose->shapes[i])->drawing;
      work.shapes[i] = shape->splats;
      work.triangle_shapes[i] = shape->triangles;
    }
  for (int row = 0; row < 3; row++) { /* the cofactors, which turn areas */
    const double *a = pose->world_from_rest[(row + 1) % 3], *b = pose->world_from_rest[(row + 2) % 3];
    conic_cross(a, b, work.normal_from_rest[row]);
  }
  run_over(context, range->splats, CONIC_TASK(move_splats), &work);
  run_over(context, range->vertices, CONIC_TASK(move_corners), &work);
  run_over(context, range->normals, CONIC_TASK(move_normals), &work);
}
