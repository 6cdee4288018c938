#include "core/base/radix.h"
#include "core/base/vectors.h"
#include "gaussians/draw/view_rays.h"
#include "gaussians/scene/activation.h"
#include "gaussians/scene/gaussian_set.h"
#include "judge/planted_composite.h"

/* --- sets --- */

enum { CONIC_PLANTED_RUN = 256 };

typedef struct planted_run {
  float scale[3][CONIC_PLANTED_RUN], rotation[4][CONIC_PLANTED_RUN], opacity[CONIC_PLANTED_RUN];
  float sh[CONIC_PLANTED_RUN * CONIC_MOST_HARMONICS];
} planted_run;

static float planted_scale(conic_planted_reading reading, const conic_gaussians *from, int axis, size_t i) {
  float scale = from->scale[axis][i];
  switch (reading) {
  case CONIC_READING_RAW: /* only its square is visible */
    return fabsf(conic_gaussians_log_scale(from, axis, i));
  case CONIC_READING_TWICE:
    return conic_scale_of_log(scale);
  case CONIC_READING_LENGTH_SQUARED:
    for (int k = 0; k < 4; k++)
      scale =
          k == 0 ? from->rotation[0][i] * from->rotation[0][i] : scale + from->rotation[k][i] * from->rotation[k][i];
    return scale * from->scale[axis][i];
  case CONIC_READING_OWN:
  case CONIC_READING_RAW_LIMITED:
  case CONIC_READING_CONJUGATE:
    break;
  }
  return scale;
}

/* Which scale is read for an axis. Of two, there is one other order. */
static int axis_of_scale(const conic_planted *p, const conic_gaussians *from, int axis) {
  static const int orders[6][3] = {{0, 1, 2}, {1, 0, 2}, {0, 2, 1}, {2, 1, 0}, {1, 2, 0}, {2, 0, 1}};
  return orders[p->axes_order > 1 && !from->scale[2] ? 0 : p->axes_order][axis];
}

/* What quaternions are multiplied by from the left, so that the camera's rotation then does the turn. */
static void quaternion_of_turn(const conic_planted *p, double turn[4]) {
  const double(*rows)[4] = p->camera.cam_from_world;
  double q[4];
  conic_quaternion_of(rows, q);
  const double w = q[0], part = p->turn == CONIC_TURN_NONE ? 1.0 : 2.0 * w; /* q̄ q̄ = 2w² − 1, −2w v */
  turn[0] = p->turn == CONIC_TURN_NONE ? w : 2.0 * w * w - 1.0;
  for (int k = 0; k < 3; k++)
    turn[k + 1] = -part * q[k + 1];
  for (int k = 0; k < 4 && p->turn == CONIC_TURN_HALF; k++)
    turn[k] = k > 0 ? rows[2][k - 1] : 0.0;
}

static void plant_rotations(const conic_planted *p, const conic_gaussians *from, size_t first, conic_gaussians *to,
                            planted_run *room) {
  static const int order[][4] = {[CONIC_READING_OWN] = {0, 1, 2, 3},
                                 [CONIC_READING_RAW] = {3, 0, 1, 2},
                                 [CONIC_READING_TWICE] = {1, 2, 3, 0},
                                 [CONIC_READING_CONJUGATE] = {0, 1, 2, 3}};
  const double conjugated = p->rotation == CONIC_READING_CONJUGATE ? -1.0 : 1.0;
  double t[4] = {1.0, 0.0, 0.0, 0.0}, q[4];
  if (p->turn)
    quaternion_of_turn(p, t);
  for (size_t i = 0; i < to->count; i++) {
    for (int k = 0; k < 4; k++)
      q[k] = (k == 0 ? conjugated : 1.0) * (double)from->rotation[order[p->rotation][k]][first + i];
    room->rotation[0][i] = (float)(t[0] * q[0] - t[1] * q[1] - t[2] * q[2] - t[3] * q[3]);
    room->rotation[1][i] = (float)(t[0] * q[1] + t[1] * q[0] + t[2] * q[3] - t[3] * q[2]);
    room->rotation[2][i] = (float)(t[0] * q[2] - t[1] * q[3] + t[2] * q[0] + t[3] * q[1]);
    room->rotation[3][i] = (float)(t[0] * q[3] + t[1] * q[2] - t[2] * q[1] + t[3] * q[0]);
  }
  for (int k = 0; k < 4; k++)
    to->rotation[k] = room->rotation[k];
}

static float planted_opacity(conic_planted_reading reading, const conic_gaussians *from, size_t i) {
  float raw;
  switch (reading) {
  case CONIC_READING_RAW:
    return conic_gaussians_logit(from, i);
  case CONIC_READING_RAW_LIMITED:
    raw = conic_gaussians_logit(from, i);
    return raw > 0.0f ? (raw < 1.0f ? raw : 1.0f) : 0.0f;
  case CONIC_READING_TWICE:
    return conic_opacity_of_logit(from->opacity[i]);
  case CONIC_READING_OWN:
  case CONIC_READING_LENGTH_SQUARED:
  case CONIC_READING_CONJUGATE:
    break;
  }
  return from->opacity[i];
}

/* Where coefficient k of channel c is read from; there are n above degree 0. */
static size_t place_of_harmonic(conic_planted_reading reading, size_t n, size_t k, size_t c) {
  size_t raw = reading == CONIC_READING_RAW ? 3 * k + c : n * c + k;
  if (reading == CONIC_READING_RAW) /* of a file that has channel by channel */
    return 3 * (raw % n) + raw / n;
  return reading == CONIC_READING_TWICE ? raw : 3 * k + c;
}

/* A colour that is above this far below 0 has no limit there, if this is added before and taken away again. */
static const float any_color = 8.0f;

static void plant_harmonics(const conic_planted *p, const conic_gaussians *from, size_t first, conic_gaussians *to,
                            float *sh) {
  const size_t n_from = conic_harmonics_of_degree(from->sh_degree), n_to = conic_harmonics_of_degree(to->sh_degree);
  float room[CONIC_MOST_HARMONICS];
  for (size_t i = 0; i < to->count; i++) {
    const float *own = conic_gaussians_harmonics(from, first + i, room);
    for (size_t c = 0; c < 3; c++) {
      const float offset = p->color_offset + (p->takes_any_color ? any_color : 0.0f);
      sh[i * n_to + c] = own[c] + offset / 0.28209479f;
      for (size_t k = 0; 3 * k + 3 < n_to; k++) {
        const float value = own[3 + place_of_harmonic(p->harmonics, n_from / 3 - 1, k, c)];
        sh[i * n_to + 3 * (k + 1) + c] = p->harmonic_signs >> (k + 1) & 1 ? -value : value;
      }
    }
  }
  to->sh = sh;
  to->sh_half = NULL;
}

/* Gaussians first … first + n - 1 as their own set, which refers to the scene and to `room`. */
static conic_gaussians planted_read(const conic_planted *p, const conic_gaussians *from, size_t first, size_t n,
                                    planted_run *room) {
  const size_t n_harmonics = conic_harmonics_of_degree(from->sh_degree);
  conic_gaussians to = *from;
  to.count = n;
  for (int k = 0; k < 3; k++) {
    to.position[k] = from->position[k] + first;
    to.scale[k] = from->scale[k] ? from->scale[k] + first : NULL;
    if (!to.scale[k] || !(p->scale || p->axes_order || p->size != 1.0f))
      continue;
    for (size_t i = 0; i < n; i++)
      room->scale[k][i] = p->size * planted_scale(p->scale, from, axis_of_scale(p, from, k), first + i);
    to.scale[k] = room->scale[k];
  }
  for (int k = 0; k < 4; k++)
    to.rotation[k] = from->rotation[k] + first;
  if (p->rotation || p->turn)
    plant_rotations(p, from, first, &to, room);
  for (size_t i = 0; p->opacity && i < n; i++)
    room->opacity[i] = planted_opacity(p->opacity, from, first + i);
  to.opacity = p->opacity ? room->opacity : from->opacity + first;
  to.sh = from->sh ? from->sh + first * n_harmonics : NULL;
  to.sh_half = from->sh_half ? from->sh_half + first * n_harmonics : NULL;
  to.sh_degree = p->most_degree < from->sh_degree ? p->most_degree : from->sh_degree;
  if (from->sh_degree >= 0 && (p->harmonics || p->harmonic_signs || p->color_offset != 0.0f || p->takes_any_color ||
                               to.sh_degree < from->sh_degree))
    plant_harmonics(p, from, first, &to, room->sh);
  return to;
}

/* --- pictures --- */

enum { GRID_SHIFT = 4, RUN_TASKS = 64 };

/* Gaussians that a thread has set up, and that may reach a sample. */
typedef struct kept_room {
  conic_kept_gaussian *kept;
  size_t n, room;
  int is_full; /* memory ran out */
  planted_run *run;
} kept_room;

typedef struct planted_job {
  conic_camera camera; /* in the middle of the exposure */
  conic_context *context;
  const conic_gaussians *set;
  const conic_planted *planted;
  const conic_diagnosis_samples *at;
  conic_channels *values;
  conic_planted_frame frame;
  conic_gaussian_view view;
  conic_view_rays rays;
  uint32_t *grid; /* how many blocks of 16 × 16 above and to the left have samples */
  size_t grid_width, grid_height;
  kept_room *rooms;                 /* one for each thread */
  conic_composite_scratch *scratch; /* one for each thread */
} planted_job;

static conic_status make_sample_grid(planted_job *j) {
  const conic_camera *camera = &j->planted->camera;
  const conic_diagnosis_samples *s = j->at;
  j->grid_width = ((size_t)camera->width >> GRID_SHIFT) + 2;
  j->grid_height = ((size_t)camera->height >> GRID_SHIFT) + 2;
  const size_t w = j->grid_width;
  j->grid = conic_memory_allocate_zeroed(j->context, w * j->grid_height, sizeof *j->grid);
  if (!j->grid)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < s->n; i++) {
    int box[2][2];
    conic_planted_place(&j->frame, s->places[i], box);
    for (int y = box[0][1] >> GRID_SHIFT; y <= box[1][1] >> GRID_SHIFT; y++)
      for (int x = box[0][0] >> GRID_SHIFT; x <= box[1][0] >> GRID_SHIFT; x++)
        j->grid[((size_t)y + 1) * w + (size_t)x + 1] = 1;
  }
  for (size_t y = 1; y < j->grid_height; y++)
    for (size_t x = 1; x < w; x++)
      j->grid[y * w + x] += j->grid[(y - 1) * w + x] + j->grid[y * w + x - 1] - j->grid[(y - 1) * w + x - 1];
  return CONIC_OK;
}

static int meets_sample(const planted_job *j, const conic_gaussian_footprint *f) {
  const size_t w = j->grid_width;
  const size_t x0 = f->box[0][0] >> GRID_SHIFT, y0 = f->box[0][1] >> GRID_SHIFT;
  const size_t x1 = ((size_t)f->box[1][0] >> GRID_SHIFT) + 1, y1 = ((size_t)f->box[1][1] >> GRID_SHIFT) + 1;
  return j->grid[y1 * w + x1] + j->grid[y0 * w + x0] - j->grid[y0 * w + x1] - j->grid[y1 * w + x0] != 0;
}

/* Grows the box by a pixel on each side, without crossing a border of the covered tiles. */
static void grow_box(const conic_planted *p, conic_gaussian_footprint *f) {
  const int size[2] = {p->camera.width, p->camera.height}, tile = conic_profile_tile(&p->rules, &p->camera);
  const int is_tiled = p->rules.coverage != CONIC_COVERAGE_ALPHA;
  for (int axis = 0; axis < 2; axis++) {
    const int first = f->box[0][axis], last = f->box[1][axis];
    f->box[0][axis] = (uint16_t)(first - (is_tiled ? first % tile != 0 : first > 0));
    f->box[1][axis] = (uint16_t)(last + (last < size[axis] - 1 && !(is_tiled && (last + 1) % tile == 0)));
  }
}

static double depth_of_mean(const planted_job *j, const conic_gaussians *set, size_t i) {
  const double *row = j->planted->camera.cam_from_world[2];
  double z = row[3];
  for (int axis = 0; axis < 3; axis++)
    z += row[axis] * (set->origin[axis] + (double)set->position[axis][i]);
  return z;
}

static double distance_of_mean(const planted_job *j, const conic_gaussians *set, size_t i) {
  double from_eye[3];
  for (int axis = 0; axis < 3; axis++)
    from_eye[axis] = set->origin[axis] + (double)set->position[axis][i] - j->view.eye[axis];
  return conic_length(from_eye);
}

/* The least key is composited first. */
static uint64_t planted_key(const planted_job *j, const conic_gaussians *set, size_t i, float own) {
  const conic_planted *p = j->planted;
  float key = p->order == CONIC_ORDER_Z          ? (float)depth_of_mean(j, set, i)
              : p->order == CONIC_ORDER_DISTANCE ? (float)distance_of_mean(j, set, i)
              : p->order == CONIC_ORDER_FILE     ? 0.0f
                                                 : own;
  uint32_t bits = conic_bits_of_float(key);
  const uint32_t dropped = p->key_bits ? 1u << (23 - p->key_bits) : 0; /* rounded to the nearest */
  bits = dropped ? (bits + dropped / 2) & ~(dropped - 1) : bits;
  bits = bits & 0x80000000u ? ~bits : bits | 0x80000000u;
  return p->is_reversed ? (uint32_t)~bits : bits;
}

/* Scales the opacity so that the Gaussian's integral over the plane is the same for all. */
static void give_unit_volume(conic_gaussian_footprint *f) {
  float determinant = f->form[0] * f->form[2] - f->form[1] * f->form[1];
  f->opacity *= sqrtf(determinant) * 0.15915494f;
}

/* The colour along the direction in the camera's axes. */
static void color_in_camera(const planted_job *j, const conic_gaussians *set, size_t i, float color[3]) {
  double direction[3];
  for (int row = 0; row < 3; row++) {
    const double *turn = j->planted->camera.cam_from_world[row];
    direction[row] = 0.0;
    for (int axis = 0; axis < 3; axis++)
      direction[row] += turn[axis] * (set->origin[axis] + (double)set->position[axis][i] - j->view.eye[axis]);
  }
  conic_harmonic_color(set, i, j->planted->rules.has_plain_color, direction, color);
}

static void keep_one(planted_job *j, const conic_gaussians *run, size_t i, size_t first, kept_room *room) {
  const conic_planted *p = j->planted;
  float key;
  if (room->n == room->room && conic_memory_reserve(j->context, &room->kept, room->n, room->n + 1, &room->room,
                                                    sizeof *room->kept) != CONIC_OK) {
    room->is_full = 1;
    return;
  }
  conic_kept_gaussian *k = &room->kept[room->n];
  if (p->rules.shape == CONIC_SHAPE_RAY && p->least_z > 0.0 && depth_of_mean(j, run, i) < p->least_z)
    return;
  conic_gaussian_fate fate =
      conic_gaussian_set_up(&j->view, run, i, &k->footprint, &key, &k->ray, &k->filter, &k->sight, k->normal);
  if (fate == CONIC_GAUSSIAN_DRAWN && (p->shift_px[0] != 0.0f || p->shift_px[1] != 0.0f))
    grow_box(p, &k->footprint);
  if (fate == CONIC_GAUSSIAN_DRAWN && p->changes_cross)
    k->footprint.form[1] *= p->cross_factor;
  if (fate != CONIC_GAUSSIAN_DRAWN || !meets_sample(j, &k->footprint))
    return;
  if (p->has_unit_volume)
    give_unit_volume(&k->footprint);
  if (p->turns_directions)
    color_in_camera(j, run, i, k->footprint.color);
  for (int c = 0; c < 3; c++) {
    k->footprint.color[c] -= p->takes_any_color ? any_color : 0.0f;
    if (p->limits_color && k->footprint.color[c] > 1.0f)
      k->footprint.color[c] = 1.0f;
  }
  for (int c = 0; c < 3 && p->own_transfer; c++)
    k->footprint.color[c] = conic_planted_transferred(p->own_transfer, k->footprint.color[c]);
  const uint32_t index = (uint32_t)(first + i);
  k->key = planted_key(j, run, i, key) << 32 | (p->is_reversed ? ~index : index);
  room->n++;
}

static void keep_run(void *data, size_t i_run, int i_thread) {
  planted_job *j = data;
  kept_room *room = &j->rooms[i_thread];
  const size_t first = i_run * CONIC_PLANTED_RUN, left = j->set->count - first;
  const size_t n = left < CONIC_PLANTED_RUN ? left : CONIC_PLANTED_RUN;
  const conic_gaussians run = planted_read(j->planted, j->set, first, n, room->run);
  for (size_t i = 0; i < n && !room->is_full && (!j->planted->n_whole || first + i < j->planted->n_whole); i++)
    keep_one(j, &run, i, first, room);
}

static conic_status keep_all(planted_job *j) {
  const size_t threads = (size_t)conic_context_threads(j->context);
  j->rooms = conic_memory_allocate_zeroed(j->context, threads, sizeof *j->rooms);
  if (!j->rooms)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < threads; i++)
    if (!(j->rooms[i].run = conic_memory_allocate(j->context, 1, sizeof *j->rooms[i].run)))
      return CONIC_ERROR_MEMORY;
  conic_parallel_for(j->context, (j->set->count + CONIC_PLANTED_RUN - 1) / CONIC_PLANTED_RUN, keep_run, j);
  for (size_t i = 0; i < threads; i++) {
    if (j->rooms[i].is_full)
      return CONIC_ERROR_MEMORY;
    j->frame.n += j->rooms[i].n;
  }
  return CONIC_OK;
}

/* Sorts into compositing order, independent of the threads. */
static conic_status order_kept(planted_job *j) {
  const size_t n = j->frame.n;
  conic_radix_item *items = conic_memory_allocate(j->context, n, sizeof *items);
  conic_kept_gaussian **ordered = conic_memory_allocate(j->context, n, sizeof *ordered);
  uint16_t(*boxes)[2][2] = conic_memory_allocate(j->context, n, sizeof *boxes);
  j->frame.kept = (const conic_kept_gaussian *const *)ordered;
  j->frame.boxes = (const uint16_t(*)[2][2])boxes;
  conic_status status = items && ordered && boxes ? CONIC_OK : CONIC_ERROR_MEMORY;
  size_t at = 0;
  for (int i = 0; status == CONIC_OK && i < conic_context_threads(j->context); i++)
    for (size_t k = 0; k < j->rooms[i].n; k++) {
      ordered[at] = &j->rooms[i].kept[k];
      items[at] = (conic_radix_item){j->rooms[i].kept[k].key, (uint32_t)at};
      at++;
    }
  if (status == CONIC_OK)
    status = conic_radix_sort(j->context, items, n, 64);
  conic_kept_gaussian **unordered = conic_memory_allocate(j->context, n, sizeof *unordered);
  status = status == CONIC_OK && !unordered ? CONIC_ERROR_MEMORY : status;
  if (status == CONIC_OK) {
    memcpy(unordered, ordered, n * sizeof *ordered);
    for (size_t k = 0; k < n; k++) {
      ordered[k] = unordered[items[k].value];
      memcpy(boxes[k], ordered[k]->footprint.box, sizeof boxes[k]);
    }
  }
  conic_memory_release_these(j->context, unordered, items);
  return status;
}

static void composite_cell(void *data, size_t i_cell, int i_thread) {
  planted_job *j = data;
  conic_planted_composite(&j->frame, j->at, &j->at->cells[i_cell], &j->scratch[i_thread], j->values);
}

static conic_status composite_cells(planted_job *j) {
  const size_t threads = (size_t)conic_context_threads(j->context);
  j->scratch = conic_memory_allocate_zeroed(j->context, threads, sizeof *j->scratch);
  if (!j->scratch)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < threads; i++) {
    if (conic_memory_allocate_these(j->context, CONIC_ROOM(j->scratch[i].listed, j->frame.n),
                                    CONIC_ROOM(j->scratch[i].hits, j->frame.n)) != CONIC_OK)
      return CONIC_ERROR_MEMORY;
  }
  conic_parallel_for(j->context, j->at->n_cells, composite_cell, j);
  return CONIC_OK;
}

static void release_planted(planted_job *j) {
  for (int i = 0; i < conic_context_threads(j->context); i++) {
    if (j->rooms)
      conic_memory_release_these(j->context, j->rooms[i].kept, j->rooms[i].run);
    if (j->scratch)
      conic_memory_release_these(j->context, j->scratch[i].listed, j->scratch[i].hits);
  }
  conic_memory_release_these(j->context, j->rooms, j->scratch, j->grid, (void *)j->frame.kept, (void *)j->frame.boxes);
  conic_view_rays_release(j->context, &j->rays);
}

/* Sets up the view as conic_gaussians_render does. */
static void look(planted_job *j, int is_affine) {
  const conic_planted *p = j->planted;
  const double(*rows)[4] = p->camera.cam_from_world;
  j->view = (conic_gaussian_view){.rules = &p->rules,
                                  .camera = &j->camera,
                                  .center_px = {p->camera.cx, p->camera.cy},
                                  .prefilter = p->prefilter,
                                  .is_parallel = p->camera.kind == CONIC_CAMERA_ORTHOGRAPHIC,
                                  .rays = is_affine ? NULL : &j->rays};
  for (int axis = 0; axis < 3; axis++) {
    double eye = -(rows[0][axis] * rows[0][3] + rows[1][axis] * rows[1][3] + rows[2][axis] * rows[2][3]);
    eye = p->takes_translation ? rows[axis][3] : eye;
    j->view.eye[axis] = p->rules.has_float_eye ? (double)(float)eye : eye;
  }
  j->frame.view = &j->view;
  j->frame.rules = conic_gaussian_rules_of(&p->rules);
  j->frame.shape = !is_affine ? CONIC_SHAPE_SIGHT : p->prefilter > 0.0 ? CONIC_SHAPE_FILTERED : p->rules.shape;
}

conic_status conic_planted_gaussians_draw(conic_context *context, const conic_gaussians *gaussians,
                                          const conic_planted *planted, int samples, const conic_diagnosis_samples *at,
                                          conic_channels *values) {
  const conic_camera *camera = &planted->camera;
  const int is_affine = camera->kind == CONIC_CAMERA_ORTHOGRAPHIC ||
                        (camera->kind == CONIC_CAMERA_PERSPECTIVE && !camera->lens && !camera->shutter);
  planted_job j = {.context = context, .set = gaussians, .planted = planted, .at = at, .values = values};
  j.frame = (conic_planted_frame){.planted = planted, .samples = samples};
  conic_camera_shutter_middle(camera, &j.camera);
  look(&j, is_affine);
  if (camera->shutter)
    conic_camera_shutter_eye(camera, j.view.eye);
  conic_status status = is_affine ? CONIC_OK : conic_view_rays_make(context, &j.camera, &planted->rules, &j.rays);
  if (status == CONIC_OK)
    status = make_sample_grid(&j);
  if (status == CONIC_OK)
    status = keep_all(&j);
  if (status == CONIC_OK)
    status = order_kept(&j);
  if (status == CONIC_OK)
    status = composite_cells(&j);
  release_planted(&j);
  return status;
}
