#include "gaussians/draw/view_rays.h"

#include "core/base/base.h"
#include "core/base/vectors.h"
#include "core/image/camera_rays.h"

/* How much wider cones are taken than they are, as a cosine: more than the roundings. */
static const double slack_of_cosine = 1e-9;

/* A slope up to which a perspective camera's Gaussians are set up about their own ray. */
static const double greatest_reference_slope = 1000.0;

typedef struct ray_job {
  conic_camera_rays camera_rays;
  conic_view_rays *rays;
  int is_solid;
} ray_job;

/* The cone about the sum of the directions, all of unit length. */
static void enclose(const double (*directions)[3], size_t n, conic_view_cone *cone) {
  double sum[3] = {0.0, 0.0, 0.0};
  memset(cone, 0, sizeof *cone);
  cone->is_empty = n == 0;
  for (size_t i = 0; i < n; i++)
    for (int axis = 0; axis < 3; axis++)
      sum[axis] += directions[i][axis];
  cone->cosine = conic_normalize(sum) ? 1.0 : -1.0;
  memcpy(cone->axis, sum, sizeof sum);
  for (size_t i = 0; i < n; i++) {
    double cosine = conic_dot(directions[i], sum);
    cone->cosine = cosine < cone->cosine ? cosine : cone->cosine;
  }
  cone->cosine = cone->cosine > -1.0 ? cone->cosine : -1.0;
  cone->sine = sqrt(1.0 - cone->cosine * cone->cosine);
}

void conic_view_rays_turn(const conic_view_rays *rays, double share, double direction[3], double origin[3]) {
  double turn[3][3], moved[3], own[3] = {direction[0], direction[1], direction[2]};
  conic_camera_shutter_pose(&rays->shutter, share, turn, moved);
  for (int i = 0; i < 3; i++) {
    direction[i] = turn[0][i] * own[0] + turn[1][i] * own[1] + turn[2][i] * own[2];
    origin[i] = -(turn[0][i] * moved[0] + turn[1][i] * moved[1] + turn[2][i] * moved[2]);
  }
}

/* Origins are known of rolling shutters alone. */
static int find_ray(const ray_job *j, int column, int row, double origin[3], double direction[3]) {
  const conic_view_rays *rays = j->rays;
  const double place[2] = {column + 0.5, row + 0.5};
  origin[0] = origin[1] = origin[2] = 0.0;
  if (!j->is_solid)
    return conic_camera_ray(&j->camera_rays, place[0], place[1], origin, direction);
  const int is_there = conic_view_lens_ray(&rays->lens, place[0], place[1], direction);
  if (rays->shutter.way)
    conic_view_rays_turn(rays, conic_camera_shutter_share(&rays->shutter, place), direction, origin);
  return is_there;
}

static int show_at(const conic_view_rays *rays, const double at[3], double share, double margin, double place[2]) {
  const double size[2] = {rays->camera->width, rays->camera->height};
  double turn[3][3], own[3];
  memcpy(own, at, sizeof own);
  if (rays->shutter.way) {
    conic_camera_shutter_pose(&rays->shutter, share, turn, own);
    for (int i = 0; i < 3; i++)
      own[i] += conic_dot(turn[i], at);
  }
  int is_in = conic_view_lens_show(&rays->lens, own, place);
  for (int axis = 0; axis < 2; axis++)
    is_in &= place[axis] >= -margin * size[axis] && place[axis] < size[axis] + margin * size[axis];
  return is_in;
}

int conic_view_rays_show(const conic_view_rays *rays, const double at[3], double margin, double place[2],
                         double *share) {
  enum { ROUNDS = 10 };
  double last[2];
  *share = -0.5;
  int is_in = show_at(rays, at, *share, margin, place);
  if (!rays->shutter.way)
    return is_in;
  const int is_in_last = show_at(rays, at, 0.5, margin, last);
  if (!is_in)
    memcpy(place, last, sizeof last);
  is_in |= is_in_last;
  for (int round = 0; round < ROUNDS && (is_in || round > 0); round++) {
    *share = conic_camera_shutter_share(&rays->shutter, place);
    is_in = show_at(rays, at, *share, margin, place);
  }
  return is_in;
}

static void find_tile_rays(void *data, size_t i_tile) {
  ray_job *j = data;
  conic_sight_rays *to = &j->rays->tiles[i_tile];
  const conic_camera *camera = j->rays->camera;
  int x = (int)(i_tile % (size_t)j->rays->n_tiles[0]) * CONIC_GAUSSIAN_TILE;
  int y = (int)(i_tile / (size_t)j->rays->n_tiles[0]) * CONIC_GAUSSIAN_TILE;
  double directions[CONIC_GAUSSIAN_TILE_PIXELS][3], origin[3], direction[3];
  size_t n = 0;
  for (size_t at = 0; at < CONIC_GAUSSIAN_TILE_PIXELS; at++) {
    int column = x + conic_gaussian_column(at), row = y + conic_gaussian_row(at);
    int is_there = column < camera->width && row < camera->height && find_ray(j, column, row, origin, direction);
    for (int axis = 0; axis < 3; axis++) {
      to->high[axis][at] = is_there ? (float)direction[axis] : NAN;
      to->low[axis][at] = is_there ? (float)(direction[axis] - (double)to->high[axis][at]) : NAN;
      to->origin_high[axis][at] = is_there ? (float)origin[axis] : 0.0f;
      to->origin_low[axis][at] = is_there ? (float)(origin[axis] - (double)to->origin_high[axis][at]) : 0.0f;
    }
    if (is_there) {
      conic_normalize(direction);
      memcpy(directions[n++], direction, sizeof direction);
    }
  }
  enclose((const double(*)[3])directions, n, &j->rays->cones[i_tile]);
}

/* The cone of tiles: about their axes, wide enough for theirs. */
static void find_block_cones(conic_view_rays *rays) {
  for (int i_block = 0; i_block < rays->n_blocks[0] * rays->n_blocks[1]; i_block++) {
    double axes[CONIC_RAY_BLOCK * CONIC_RAY_BLOCK][3];
    const conic_view_cone *widest = NULL;
    size_t n = 0;
    for (int k = 0; k < CONIC_RAY_BLOCK * CONIC_RAY_BLOCK; k++) {
      int x = i_block % rays->n_blocks[0] * CONIC_RAY_BLOCK + k % CONIC_RAY_BLOCK;
      int y = i_block / rays->n_blocks[0] * CONIC_RAY_BLOCK + k / CONIC_RAY_BLOCK;
      const conic_view_cone *cone = &rays->cones[(size_t)y * (size_t)rays->n_tiles[0] + (size_t)x];
      if (x >= rays->n_tiles[0] || y >= rays->n_tiles[1] || cone->is_empty)
        continue;
      widest = !widest || cone->cosine < widest->cosine ? cone : widest;
      memcpy(axes[n++], cone->axis, sizeof cone->axis);
    }
    conic_view_cone *block = &rays->blocks[i_block];
    enclose((const double(*)[3])axes, n, block);
    if (!widest)
      continue;
    double sine = block->sine * widest->cosine + block->cosine * widest->sine;
    double cosine = block->cosine * widest->cosine - block->sine * widest->sine;
    block->cosine = sine > 0.0 ? cosine : -1.0; /* of half a turn or more: all */
    block->sine = sine > 0.0 ? sine : 0.0;
  }
}

conic_status conic_view_rays_make(conic_context *context, const conic_camera *camera, const conic_profile_row *rules,
                                  conic_view_rays *rays) {
  ray_job j = {.rays = rays, .is_solid = rules->shape == CONIC_SHAPE_SOLID};
  const int size[2] = {camera->width, camera->height};
  rays->camera = camera;
  for (int axis = 0; axis < 2; axis++) {
    rays->n_tiles[axis] = (size[axis] + CONIC_GAUSSIAN_TILE - 1) / CONIC_GAUSSIAN_TILE;
    rays->n_blocks[axis] = (rays->n_tiles[axis] + CONIC_RAY_BLOCK - 1) / CONIC_RAY_BLOCK;
  }
  size_t n = (size_t)rays->n_tiles[0] * (size_t)rays->n_tiles[1];
  if (conic_memory_allocate_these(context, CONIC_ROOM(rays->tiles, n), CONIC_ROOM(rays->cones, n),
                                  CONIC_ROOM(rays->blocks, (size_t)rays->n_blocks[0] * (size_t)rays->n_blocks[1])) !=
      CONIC_OK)
    return CONIC_ERROR_MEMORY;
  conic_camera_rays_init(camera, &j.camera_rays);
  if (j.is_solid) {
    conic_view_lens_init(camera, &rays->lens);
    conic_camera_shutter_init(camera, &rays->shutter);
  }
  conic_parallel_for(context, n, find_tile_rays, &j);
  find_block_cones(rays);
  return CONIC_OK;
}

void conic_view_rays_release(conic_context *context, conic_view_rays *rays) {
  conic_memory_release_these(context, rays->tiles, rays->cones, rays->blocks);
  memset(rays, 0, sizeof *rays);
}

/* Whether the angle between the axes is at most the sum of both cones' angles. */
static int may_meet(const conic_view_cone *a, const conic_view_cone *b) {
  if (a->is_empty || a->sine * b->cosine + a->cosine * b->sine <= 0.0)
    return !a->is_empty;
  return conic_dot(a->axis, b->axis) >= a->cosine * b->cosine - a->sine * b->sine - slack_of_cosine;
}

static void look_into_block(const conic_view_rays *rays, const conic_view_cone *ball, int block_x, int block_y,
                            int first[2], int last[2]) {
  for (int y = block_y * CONIC_RAY_BLOCK; y < (block_y + 1) * CONIC_RAY_BLOCK && y < rays->n_tiles[1]; y++)
    for (int x = block_x * CONIC_RAY_BLOCK; x < (block_x + 1) * CONIC_RAY_BLOCK && x < rays->n_tiles[0]; x++) {
      int is_within = x >= first[0] && x <= last[0] && y >= first[1] && y <= last[1];
      if (is_within || !may_meet(&rays->cones[(size_t)y * (size_t)rays->n_tiles[0] + (size_t)x], ball))
        continue;
      first[0] = x < first[0] ? x : first[0];
      first[1] = y < first[1] ? y : first[1];
      last[0] = x > last[0] ? x : last[0];
      last[1] = y > last[1] ? y : last[1];
    }
}

int conic_view_rays_box(const conic_view_rays *rays, const double center[3], double radius, uint16_t box[2][2]) {
  const int size[2] = {rays->camera->width, rays->camera->height};
  double distance = conic_length(center), sine = radius / distance;
  int first[2] = {rays->n_tiles[0], rays->n_tiles[1]}, last[2] = {-1, -1};
  conic_view_cone ball = {.cosine = -1.0}; /* all, where the eye is in the ball */
  if (distance > radius) {
    for (int axis = 0; axis < 3; axis++)
      ball.axis[axis] = center[axis] / distance;
    ball.sine = sine;
    ball.cosine = sqrt((1.0 - sine) * (1.0 + sine));
  }
  for (int y = 0; y < rays->n_blocks[1]; y++)
    for (int x = 0; x < rays->n_blocks[0]; x++)
      if (may_meet(&rays->blocks[(size_t)y * (size_t)rays->n_blocks[0] + (size_t)x], &ball))
        look_into_block(rays, &ball, x, y, first, last);
  for (int axis = 0; axis < 2; axis++) {
    int end = (last[axis] + 1) * CONIC_GAUSSIAN_TILE;
    if (last[axis] < 0)
      return 0;
    box[0][axis] = (uint16_t)(first[axis] * CONIC_GAUSSIAN_TILE);
    box[1][axis] = (uint16_t)((end < size[axis] ? end : size[axis]) - 1);
  }
  return 1;
}

void conic_view_rays_towards(const conic_camera *camera, const double place[3], double direction[3]) {
  int is_perspective = camera->kind == CONIC_CAMERA_PERSPECTIVE;
  double length = is_perspective ? place[2] : conic_length(place);
  for (int axis = 0; axis < 3; axis++)
    direction[axis] = axis == 2 ? 1.0 : 0.0;
  if (!(length > 0.0) || (is_perspective && (fabs(place[0]) > greatest_reference_slope * length ||
                                             fabs(place[1]) > greatest_reference_slope * length)))
    return;
  for (int axis = 0; axis < 3; axis++)
    direction[axis] = place[axis] / length;
}
