#include "lighting/receivers.h"

#include <string.h>

#include "core/base/memory.h"
#include "core/base/threads.h"
#include "core/base/vectors.h"

/* The receivers in one row of a picture. */
typedef struct receiver_row {
  size_t first, count;
  double low[3], high[3], spacing; /* spacing: the sum */
} receiver_row;

typedef struct receiver_rows {
  const conic_camera *camera;
  conic_camera_rays rays;
  double offset; /* from the pixel's centre to the sample whose depth Z is */
  const float *z, *normal;
  receiver_row *rows;
  conic_receivers *to;
} receiver_rows;

static int is_receiver(const receiver_rows *r, size_t pixel) {
  const float *n = r->normal + 3 * pixel;
  float length_squared = (n[0] * n[0] + n[1] * n[1]) + n[2] * n[2];
  return r->z[pixel] > 0.0f && r->z[pixel] < 1e30f && length_squared > 0.5f && length_squared < 2.0f;
}

enum { PLACED_TOGETHER = 128 };

/* A run of a row's pixels. */
typedef struct placed_run {
  size_t first, n;
  double world[3][PLACED_TOGETHER];
  unsigned char is_there[PLACED_TOGETHER]; /* the pixel is a receiver, and has a place */
} placed_run;

/* conic_pixel_place of a pinhole, in lanes. */
static void place_through_pinhole(const receiver_rows *r, size_t y, placed_run *run) {
  const conic_camera camera = *r->camera;
  const double(*m)[4] = camera.cam_from_world, left = (double)run->first, offset = r->offset;
  const double down = ((double)y + 0.5 + offset - camera.cy) / camera.fy;
  const float *z = r->z + y * (size_t)camera.width + run->first;
  placed_run *restrict to = run;
  for (int i = 0; i < (int)run->n; i++) {
    double depth = (double)z[i], right = ((left + (double)i) + 0.5 + offset - camera.cx) / camera.fx;
    double x = depth * right - m[0][3], along = depth * down - m[1][3], forward = depth - m[2][3];
    for (int axis = 0; axis < 3; axis++)
      to->world[axis][i] = ((0.0 + m[0][axis] * x) + m[1][axis] * along) + m[2][axis] * forward;
  }
}

static void place_run(const receiver_rows *r, size_t y, size_t first, placed_run *run) {
  const size_t width = (size_t)r->camera->width, row = y * width;
  run->first = first;
  run->n = width - first < PLACED_TOGETHER ? width - first : PLACED_TOGETHER;
  int any = 0;
  for (size_t i = 0; i < run->n; i++)
    any |= run->is_there[i] = (unsigned char)is_receiver(r, row + first + i);
  if (any && r->rays.is_pinhole)
    place_through_pinhole(r, y, run);
  for (size_t i = 0; i < run->n && !r->rays.is_pinhole; i++) {
    double world[3], x_px = (double)(first + i) + 0.5 + r->offset, y_px = (double)y + 0.5 + r->offset;
    run->is_there[i] =
        run->is_there[i] && conic_pixel_place(&r->rays, x_px, y_px, (double)r->z[row + first + i], world);
    for (int axis = 0; axis < 3 && run->is_there[i]; axis++)
      run->world[axis][i] = world[axis];
  }
}

static void count_receivers(void *data, size_t y) {
  const receiver_rows *r = data;
  receiver_row row = {.low = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, .high = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}};
  size_t width = (size_t)r->camera->width;
  int is_parallel = r->camera->kind == CONIC_CAMERA_ORTHOGRAPHIC;
  placed_run run;
  for (size_t first = 0; first < width; first += run.n) {
    place_run(r, y, first, &run);
    for (size_t i = 0; i < run.n; i++) {
      if (!run.is_there[i])
        continue;
      row.count++;
      row.spacing += is_parallel ? 1.0 : (double)r->z[y * width + first + i];
      conic_widen_box(row.low, row.high, (const double[3]){run.world[0][i], run.world[1][i], run.world[2][i]});
    }
  }
  r->rows[y] = row;
}

static void take_receivers(void *data, size_t y) {
  const receiver_rows *r = data;
  conic_receivers *to = r->to;
  size_t width = (size_t)r->camera->width, place = r->rows[y].first;
  placed_run run;
  for (size_t first = 0; first < width && r->rows[y].count > 0; first += run.n) {
    place_run(r, y, first, &run);
    for (size_t i = 0; i < run.n; i++) {
      size_t pixel = y * width + first + i;
      if (!run.is_there[i])
        continue;
      for (int axis = 0; axis < 3; axis++) {
        to->position[axis][place] = (float)(run.world[axis][i] - to->origin[axis]);
        to->normal[axis][place] = r->normal[3 * pixel + (size_t)axis];
      }
      to->pixel[place++] = (uint32_t)pixel;
    }
  }
}

static conic_status make_room_for_receivers(conic_context *context, int has_pixels, conic_receivers *r) {
  size_t padded = (r->count + 15) / 16 * 16;
  r->block = conic_memory_allocate(context, padded, (6 + (size_t)has_pixels) * sizeof *r->block);
  if (!r->block)
    return CONIC_ERROR_MEMORY;
  for (size_t axis = 0; axis < 3; axis++) {
    r->position[axis] = r->block + axis * padded;
    r->normal[axis] = r->block + (3 + axis) * padded;
  }
  r->pixel = has_pixels ? (uint32_t *)(r->block + 6 * padded) : NULL;
  return CONIC_OK;
}

static void set_receivers_box(const double low[3], const double high[3], conic_receivers *r) {
  for (int axis = 0; axis < 3; axis++) {
    r->origin[axis] = r->count ? 0.5 * low[axis] + 0.5 * high[axis] : 0.0;
    r->half[axis] = r->count ? 0.5 * (high[axis] - low[axis]) : 0.0;
  }
}

/* Adds up the rows. */
static void plan_receivers(receiver_rows *r) {
  receiver_row all = {.low = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, .high = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}};
  for (int y = 0; y < r->camera->height; y++) {
    receiver_row *row = &r->rows[y];
    row->first = all.count;
    all.count += row->count;
    all.spacing += row->spacing;
    for (int axis = 0; axis < 3; axis++)
      CONIC_WIDEN(all.low[axis], all.high[axis], row->low[axis], row->high[axis]);
  }
  r->to->count = all.count;
  r->to->spacing = all.count ? all.spacing / (double)all.count / sqrt(r->camera->fx * r->camera->fy) : 0.0;
  set_receivers_box(all.low, all.high, r->to);
}

conic_status conic_receivers_of_image(conic_context *context, const conic_camera *camera, int samples,
                                      const conic_image *image, conic_receivers *receivers) {
  memset(receivers, 0, sizeof *receivers);
  receiver_rows work = {.camera = camera,
                        .offset = conic_depth_offset(samples),
                        .z = image->planes[CONIC_PLANE_Z],
                        .normal = image->planes[CONIC_PLANE_NORMAL],
                        .to = receivers};
  conic_camera_rays_init(camera, &work.rays);
  work.rows = conic_memory_allocate(context, (size_t)image->height, sizeof *work.rows);
  if (!work.rows)
    return CONIC_ERROR_MEMORY;
  conic_parallel_for(context, (size_t)image->height, count_receivers, &work);
  plan_receivers(&work);
  conic_status status = make_room_for_receivers(context, 1, receivers);
  if (status == CONIC_OK)
    conic_parallel_for(context, (size_t)image->height, take_receivers, &work);
  conic_memory_release(context, work.rows);
  return status;
}

/* The splat's unit normal; returns 0 where it has none. */
static int splat_normal(const conic_splats *s, size_t i, double normal[3]) {
  double u[3], v[3];
  conic_vector_at(s->tangent_u, i, u);
  conic_vector_at(s->tangent_v, i, v);
  if (s->dot && s->dot[i] != 0.0f)
    return 0;
  conic_cross(u, v, normal);
  return conic_normalize(normal);
}

conic_status conic_receivers_of_splats(conic_context *context, const conic_splats *splats, double spacing,
                                       conic_receivers *receivers) {
  double low[3], high[3], normal[3];
  memset(receivers, 0, sizeof *receivers);
  receivers->count = splats->count;
  receivers->spacing = spacing;
  conic_splats_bounds(splats, low, high);
  set_receivers_box(low, high, receivers);
  conic_status status = make_room_for_receivers(context, 0, receivers);
  for (size_t i = 0; i < splats->count && status == CONIC_OK; i++) {
    int has_normal = splat_normal(splats, i, normal), is_there = 1;
    for (int axis = 0; axis < 3; axis++)
      is_there &= isfinite(splats->position[axis][i]);
    for (int axis = 0; axis < 3; axis++) {
      double place = (double)splats->position[axis][i] + splats->origin[axis] - receivers->origin[axis];
      receivers->position[axis][i] = is_there ? (float)place : 0.0f;
      receivers->normal[axis][i] = has_normal ? (float)normal[axis] : 0.0f;
    }
  }
  return status;
}

void conic_receivers_release(conic_context *context, conic_receivers *receivers) {
  conic_memory_release(context, receivers->block);
  memset(receivers, 0, sizeof *receivers);
}

int conic_pixel_place(const conic_camera_rays *rays, double x_px, double y_px, double z, double world[3]) {
  const double(*m)[4] = rays->camera->cam_from_world;
  double origin[3], direction[3];
  if (!conic_camera_ray(rays, x_px, y_px, origin, direction))
    return 0;
  for (int axis = 0; axis < 3; axis++) {
    world[axis] = 0.0;
    for (int row = 0; row < 3; row++)
      world[axis] += m[row][axis] * (origin[row] + z * direction[row] - m[row][3]);
  }
  return 1;
}

void conic_pixel_viewer(const conic_camera_rays *rays, size_t x, size_t y, float viewer[3]) {
  const double(*m)[4] = rays->camera->cam_from_world;
  double origin[3], direction[3], world[3];
  if (!conic_camera_ray(rays, (double)x + 0.5, (double)y + 0.5, origin, direction))
    direction[0] = direction[1] = direction[2] = 0.0;
  for (int axis = 0; axis < 3; axis++)
    world[axis] = -((m[0][axis] * direction[0] + m[1][axis] * direction[1]) + m[2][axis] * direction[2]);
  conic_normalize(world);
  for (int axis = 0; axis < 3; axis++)
    viewer[axis] = (float)world[axis];
}
