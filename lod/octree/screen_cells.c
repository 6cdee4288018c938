#include "lod/octree/screen_cells.h"

#include "core/base/radix.h"
#include "core/image/viewpoint.h"
#include "lod/octree/octree_loops.h"

/* A cell is so many times as wide as the error: with more, few cells keep it. One that does not is halved along each
 * axis, so many times at most. */
static const double cell_width = 1.3;
enum { N_HALVINGS = 2 };

/* Keys, from the top: whether a splat stays as it is (and then its index); the octave of its depth; whether it faces
 * away; and its cell, as a Morton code. */
enum { AXIS_BITS = 19, SIDE_SHIFT = 3 * AXIS_BITS, OCTAVE_SHIFT = SIDE_SHIFT + 1, OCTAVE_MASK = 31 };
#define STAYS (UINT64_C(1) << 63)
#define IS_CULLED UINT64_MAX

enum { ITEMS_A_TASK = 4096 };

typedef struct cells_job {
  const conic_splats *from;
  conic_viewpoint view;
  double near_z, focal_px, error_px, cutoff, cells_a_px; /* of the finest cells */
  const conic_splats *sorted;
  conic_radix_item *items;
  size_t n;
  uint32_t *clip_of;
  uint8_t *is_drawn; /* of each of the sorted splats: 1 as it was, 2 for several, 0: another stands for it */
  conic_octree_loops loops;
  conic_disc_samples samples;
} cells_job;

/* --- keys --- */

static uint64_t cell_of(const cells_job *job, const double p[3]) {
  const uint64_t bits = conic_bits_of_double(p[2]), mantissa = (UINT64_C(1) << 52) - 1;
  const double depth = conic_double_of_bits((bits & mantissa) | UINT64_C(1023) << 52); /* from 1 to 2 in its octave */
  const double scale = job->focal_px * job->cells_a_px, most = (double)((1 << AXIS_BITS) - 1);
  const double middle = 0.5 * (double)(1 << AXIS_BITS);
  const double at[3] = {p[0] / p[2] * scale + middle, p[1] / p[2] * scale + middle, (depth - 1.0) * scale};
  uint64_t code = (bits >> 52 & OCTAVE_MASK) << OCTAVE_SHIFT;
  for (int axis = 0; axis < 3; axis++) {
    double clamped = at[axis] > 0.0 ? at[axis] < most ? at[axis] : most : 0.0;
    code |= conic_spread_bits((uint64_t)clamped) << axis;
  }
  return code;
}

static uint64_t key_of(const cells_job *job, size_t i) {
  const conic_splats *from = job->from;
  double place[3], p[3], u[3], v[3], normal[3], toward[3];
  conic_vector_at(from->position, i, place);
  conic_vector_at(from->tangent_u, i, u);
  conic_vector_at(from->tangent_v, i, v);
  conic_viewpoint_move(&job->view, place, p);
  conic_cross(u, v, normal);
  double uu = conic_dot(u, u), vv = conic_dot(v, v), reach = job->cutoff * sqrt(uu > vv ? uu : vv);
  if (conic_viewpoint_misses(&job->view, p, reach))
    return IS_CULLED;
  /* NaN fails this. */
  if (!(p[2] - reach > job->near_z && conic_dot(normal, normal) > 0.0))
    return STAYS | i;
  conic_subtract(place, job->view.eye, toward);
  return cell_of(job, p) | (uint64_t)(conic_dot(normal, toward) > 0.0) << SIDE_SHIFT;
}

static void key_task(void *data, size_t i_task) {
  cells_job *job = data;
  size_t end = (i_task + 1) * ITEMS_A_TASK;
  for (size_t i = i_task * ITEMS_A_TASK; i < end && i < job->from->count; i++)
    job->items[i] = (conic_radix_item){key_of(job, i), (uint32_t)i};
}

/* The number of each splat's clip lines, or CONIC_NO_CLIP; null where there are none. */
static conic_status number_clips(conic_context *context, cells_job *job) {
  const conic_splats *from = job->from;
  if (!from->n_clips)
    return CONIC_OK;
  job->clip_of = conic_memory_allocate(context, from->count, sizeof *job->clip_of);
  if (!job->clip_of)
    return CONIC_ERROR_MEMORY;
  memset(job->clip_of, 0xFF, from->count * sizeof *job->clip_of);
  for (size_t i = 0; i < from->n_clips; i++)
    job->clip_of[from->clips[i].splat] = (uint32_t)i;
  return CONIC_OK;
}

static const conic_clip *clip_at(const cells_job *job, size_t i) {
  uint32_t clip = job->clip_of ? job->clip_of[job->items[i].value] : CONIC_NO_CLIP;
  return clip == CONIC_NO_CLIP ? NULL : &job->from->clips[clip];
}

/* --- joining --- */

/* Where the splats' ellipse lies: as an octree's node does (lod/octree/octree_fit.c). */
static void find_frame(const cells_job *job, size_t begin, size_t end, const conic_moments *sum,
                       conic_node_frame *frame) {
  double u[3], v[3];
  conic_moments_facing(sum, frame->n);
  conic_normalize(frame->n);
  conic_tangent_basis(frame->n, u, v);
  conic_ellipse shape = conic_moments_shape(sum, u, v);
  if (end - begin <= CONIC_FEW_LEAVES)
    shape.ratio =
        job->loops.choose_ratio(job->sorted, begin, end, job->cutoff, sum->mean, u, v, &shape, CONIC_LEAST_NODE_RATIO);
  memcpy(frame->position, sum->mean, sizeof frame->position);
  frame->ratio = shape.ratio;
  for (int axis = 0; axis < 3; axis++) {
    frame->u[axis] = shape.major[0] * u[axis] + shape.major[1] * v[axis];
    frame->v[axis] = shape.major[0] * v[axis] - shape.major[1] * u[axis];
  }
}

/* Whether all places of the disc within `gap` of one are as near as that to splat i, which reaches out as far as its
 * shorter axis in every direction of its plane. What clip lines leave of it may be at its other end. */
static int is_near(const cells_job *job, size_t i, const double at[3], const double n[3], double gap, double distance) {
  double place[3], apart[3], u[3], v[3], normal[3], tilt[3];
  conic_vector_at(job->sorted->position, i, place);
  conic_vector_at(job->sorted->tangent_u, i, u);
  conic_vector_at(job->sorted->tangent_v, i, v);
  conic_subtract(at, place, apart);
  conic_cross(u, v, normal);
  conic_cross(normal, n, tilt);
  double uu = conic_dot(u, u), vv = conic_dot(v, v), length2 = conic_dot(normal, normal),
         along = conic_dot(apart, normal);
  double flat2 = conic_dot(apart, apart) - along * along / length2;
  double high = (fabs(along) + gap * conic_length(tilt)) / sqrt(length2);
  double flat = sqrt(flat2 > 0.0 ? flat2 : 0.0) + gap - job->cutoff * sqrt(uu < vv ? uu : vv);
  double left = distance - (clip_at(job, i) ? 2.0 * job->cutoff * sqrt(uu > vv ? uu : vv) : 0.0);
  return left > 0.0 && high * high + (flat > 0.0 ? flat * flat : 0.0) <= left * left;
}

/* Whether no place of the disc is farther than that from the splats. */
static int is_covered(const cells_job *job, size_t begin, size_t end, const conic_node_frame *frame, double reach,
                      double distance) {
  size_t near = begin;
  for (int k = 0; k < CONIC_DISC_SAMPLES; k++) {
    const double x = reach * (double)job->samples.x[k], y = reach * frame->ratio * (double)job->samples.y[k];
    double at[3];
    size_t n_left = end - begin;
    for (int axis = 0; axis < 3; axis++)
      at[axis] = frame->position[axis] + x * frame->u[axis] + y * frame->v[axis];
    for (; n_left > 0 && !is_near(job, near, at, frame->n, CONIC_DISC_GAP * reach, distance); n_left--)
      near = near + 1 < end ? near + 1 : begin; /* the one before is often near the next place, too */
    if (n_left == 0)
      return 0;
  }
  return 1;
}

static void put_joined(const cells_job *job, size_t i, const conic_moments *sum, const conic_node_frame *frame,
                       double major) {
  const conic_splats *to = job->sorted;
  for (int axis = 0; axis < 3; axis++) {
    to->position[axis][i] = (float)frame->position[axis];
    to->tangent_u[axis][i] = (float)(frame->u[axis] * major);
    to->tangent_v[axis][i] = (float)(frame->v[axis] * major * frame->ratio);
    if (to->color[axis])
      to->color[axis][i] = (float)(sum->weight > 0.0 ? sum->color[axis] / sum->weight : 0.0);
  }
  to->opacity[i] = (float)(sum->weight / (major * major * frame->ratio));
}

/* Whether one splat, which is put in the place of the first, can stand for all. */
static int join_range(const cells_job *job, size_t begin, size_t end) {
  const double hair = 1.0 + 1e-6; /* the axes become floats */
  conic_moments sum = {0}, one;
  conic_node_frame frame;
  conic_leaf_reach reach = {.cosine = 1.0};
  double p[3];
  for (size_t i = begin; i < end; i++) {
    conic_moments_of_splat(job->sorted, i, &one);
    conic_moments_merge(&sum, &one);
  }
  find_frame(job, begin, end, &sum, &frame);
  job->loops.add_reach(job->sorted, begin, end, job->cutoff, &frame, &reach);
  double major = reach.reach * hair, radius = (reach.radius > major ? reach.radius : major) * hair;
  conic_viewpoint_move(&job->view, frame.position, p);
  double allowed = conic_viewpoint_length_of(p, radius, job->near_z, job->focal_px, job->error_px);
  if (!(reach.height * hair <= allowed) || !is_covered(job, begin, end, &frame, major, allowed)) /* NaN, too */
    return 0;
  put_joined(job, begin, &sum, &frame, major / job->cutoff);
  return 1;
}

/* The splats of a cell of one level, or of its parts. */
static void join_cell(const cells_job *job, size_t begin, size_t end, int level) {
  int is_joined = end - begin > 1 && level >= 0 && join_range(job, begin, end);
  memset(job->is_drawn + begin, level < 0 || end - begin == 1, end - begin);
  if (is_joined)
    job->is_drawn[begin] = 2;
  if (is_joined || level < 0 || end - begin == 1)
    return;
  for (size_t first = begin, i = begin + 1; i <= end; i++)
    if (i == end || level == 0 || (job->items[i].key ^ job->items[first].key) >> 3 * (level - 1)) {
      join_cell(job, first, i, level - 1);
      first = i;
    }
}

static int is_first_of_cell(const cells_job *job, size_t i) {
  const uint64_t key = job->items[i].key;
  return i == 0 || key & STAYS || (key ^ job->items[i - 1].key) >> 3 * N_HALVINGS;
}

/* The first splat from i on with which a cell begins; `end` where none does before it. */
static size_t next_cell(const cells_job *job, size_t i, size_t end) {
  while (i < end && !is_first_of_cell(job, i))
    i++;
  return i;
}

/* The cells that begin among so many splats. Loops load whole batches, and behind these splats others are written. */
static void join_task(void *data, size_t i_task) {
  cells_job job = *(const cells_job *)data;
  conic_splats own = *job.sorted;
  size_t begin = i_task * ITEMS_A_TASK, last = job.n - begin < ITEMS_A_TASK ? job.n : begin + ITEMS_A_TASK, end;
  size_t i = next_cell(&job, begin, last);
  own.count = i < last ? next_cell(&job, last, job.n) : i;
  job.sorted = &own;
  for (; i < own.count; i = end) {
    end = next_cell(&job, i + 1, own.count);
    join_cell(&job, i, end, N_HALVINGS);
  }
}

/* --- all --- */

enum { N_ARRAYS = 13 };

static void list_arrays(const conic_splats *s, float *arrays[N_ARRAYS]) {
  for (int axis = 0; axis < 3; axis++) {
    arrays[axis] = s->position[axis];
    arrays[3 + axis] = s->tangent_u[axis];
    arrays[6 + axis] = s->tangent_v[axis];
    arrays[9 + axis] = s->color[axis];
  }
  arrays[12] = s->opacity;
}

static void gather_task(void *data, size_t i_task) {
  const cells_job *job = data;
  size_t begin = i_task * ITEMS_A_TASK, end = begin + ITEMS_A_TASK < job->n ? begin + ITEMS_A_TASK : job->n;
  float *to[N_ARRAYS], *from[N_ARRAYS];
  list_arrays(job->sorted, to);
  list_arrays(job->from, from);
  for (int k = 0; k < N_ARRAYS; k++)
    for (size_t i = begin; i < end && to[k]; i++)
      to[k][i] = from[k] ? from[k][job->items[i].value] : 1.0f; /* an opacity */
}

/* What is drawn, and opacities; there is room for clip lines. */
static conic_status gather(conic_context *context, cells_job *job, conic_screen_cells *cells) {
  const unsigned fields = CONIC_SPLATS_TANGENTS | CONIC_SPLATS_COLORS | CONIC_SPLATS_OPACITIES | CONIC_SPLATS_CLIPS;
  conic_status status = conic_splats_allocate(
      context, job->n, fields & (conic_splats_fields(job->from) | CONIC_SPLATS_OPACITIES), &cells->splats);
  if (status != CONIC_OK)
    return status;
  memcpy(cells->splats.origin, job->from->origin, sizeof cells->splats.origin);
  job->sorted = &cells->splats;
  conic_parallel_for(context, (job->n + ITEMS_A_TASK - 1) / ITEMS_A_TASK, gather_task, job);
  return CONIC_OK;
}

/* The splats that are drawn move up; those with clip lines have theirs. */
static void close_up(const cells_job *job, conic_screen_cells *cells) {
  conic_splats *s = &cells->splats;
  float *arrays[N_ARRAYS];
  size_t n = 0;
  list_arrays(s, arrays);
  for (size_t i = 0; i < job->n; i++) {
    if (!job->is_drawn[i])
      continue;
    for (int k = 0; k < N_ARRAYS; k++)
      if (arrays[k])
        arrays[k][n] = arrays[k][i];
    const conic_clip *clip = job->is_drawn[i] == 1 ? clip_at(job, i) : NULL;
    if (clip) {
      s->clips[s->n_clips] = *clip;
      s->clips[s->n_clips++].splat = (uint32_t)n;
    }
    cells->n_joined += job->is_drawn[i] == 2;
    cells->ids[n++] = job->items[i].value;
  }
  s->count = n;
}

conic_status conic_screen_cells_find(conic_context *context, const conic_splats *splats, const conic_camera *camera,
                                     const conic_render_options *render, double error_px, conic_screen_cells *cells) {
  const size_t n = splats->count;
  const double margin_px = (double)render->kernel.cutoff * sqrt((double)render->prefilter) + 1.0;
  cells_job job = {.from = splats,
                   .near_z = render->near_z,
                   .focal_px = camera->fx > camera->fy ? camera->fx : camera->fy,
                   .error_px = error_px,
                   .cutoff = (double)render->kernel.cutoff,
                   .cells_a_px = (double)(1 << N_HALVINGS) / (cell_width * error_px)};
  conic_isa isa;
  memset(cells, 0, sizeof *cells);
  conic_viewpoint_init(&job.view, camera, splats->origin, margin_px);
  conic_status status = conic_isa_choose(context, render->isa, &isa);
  if (status == CONIC_OK)
    status = conic_memory_allocate_these(context, CONIC_ROOM(job.items, n), CONIC_ROOM(job.is_drawn, n),
                                         CONIC_ROOM(cells->ids, n));
  if (status == CONIC_OK)
    status = number_clips(context, &job);
  if (status == CONIC_OK) {
    conic_octree_loops_init(&job.loops, isa);
    conic_disc_samples_init(&job.samples);
    conic_parallel_for(context, (n + ITEMS_A_TASK - 1) / ITEMS_A_TASK, key_task, &job);
    for (size_t i = 0; i < job.from->count; i++)
      if (job.items[i].key != IS_CULLED)
        job.items[job.n++] = job.items[i];
    cells->n_culled = n - job.n;
    status = conic_radix_sort(context, job.items, job.n, 64);
  }
  if (status == CONIC_OK)
    status = gather(context, &job, cells);
  if (status == CONIC_OK) {
    conic_parallel_for(context, (job.n + ITEMS_A_TASK - 1) / ITEMS_A_TASK, join_task, &job);
    close_up(&job, cells);
  }
  conic_memory_release_these(context, job.items, job.is_drawn, job.clip_of);
  return status;
}

void conic_screen_cells_release(conic_context *context, conic_screen_cells *cells) {
  conic_splats_release(context, &cells->splats);
  conic_memory_release(context, cells->ids);
  memset(cells, 0, sizeof *cells);
}
