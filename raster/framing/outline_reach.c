/* The reach of an outline is convex in the direction: so points that are bounded along the wide and the narrow
 * direction are bounded between, too. Blocks whose bound is below what some other block reaches need no look, which
 * leaves few. What is looked at is measured in doubles, in order: bounds change no bit. */
#include "raster/framing/outline_reach.h"

#include "core/base/base.h"
#include "core/base/vectors.h"
#include "core/splats/clip.h"
#include "raster/loops/raster_loops.h"

enum { BLOCKS_TOGETHER = 128 };

/* --- bounds --- */

/* Bounds of splats or of triangles, which lie about an origin. */
typedef struct outline_bounds {
  conic_reach_limits limits; /* in units by which squares neither overflow nor underflow */
  double unit;
  double shifts[2 * CONIC_REACH_DIRECTIONS]; /* what limits leave out of the centre, and what floats round */
} outline_bounds;

typedef struct bounds_job {
  const conic_outline_reach *r;
  conic_raster_loops loops;
  outline_bounds of_splats, of_triangles;
} bounds_job;

/* Twice what a bound's few operations round, as a part of what is added up. */
static const double rounded = 2e-6;

static void bound_along(const double direction[3], const double reach[3], const double rest[3], outline_bounds *b,
                        size_t i) {
  double cutoff = (double)b->limits.cutoff, greatest = 0.0, shift = 1e-18 * b->unit * (1.0 + cutoff);
  conic_reach_direction *bound = &b->limits.directions[i];
  for (int axis = 0; axis < 3; axis++) {
    bound->along[axis] = (float)(direction[axis] / b->unit);
    shift += rounded * fabs(direction[axis]) * reach[axis] - direction[axis] * rest[axis];
    greatest = fmax(greatest, fabs(direction[axis]));
  }
  bound->slack = (float)(rounded * cutoff * greatest / b->unit);
  b->shifts[i] = shift;
}

static void set_limits(const conic_outline_reach *r, const double origin[3], outline_bounds *b) {
  double offset[3], reach[3], rest[3], greatest = 0.0;
  b->limits.cutoff = (float)r->cutoff;
  b->limits.n = 2 * r->n;
  conic_subtract(origin, r->center, offset);
  for (int axis = 0; axis < 3; axis++) {
    b->limits.center[axis] = (float)-offset[axis];
    rest[axis] = -offset[axis] - (double)b->limits.center[axis];
    reach[axis] = fmax(-r->low[axis], r->high[axis]) + fabs(rest[axis]) + 1e-9 * fabs(offset[axis]);
    b->limits.low[axis] = (float)(r->low[axis] + rest[axis] - rounded * reach[axis]);
    b->limits.high[axis] = (float)(r->high[axis] + rest[axis] + rounded * reach[axis]);
    greatest = fmax(greatest, reach[axis]);
  }
  b->unit = 1.0;
  while (b->unit < greatest && b->unit < 0x1p100)
    b->unit *= 2.0;
  while (b->unit > greatest && b->unit > 0x1p-100)
    b->unit *= 0.5;
  for (size_t i = 0; i < r->n; i++) {
    bound_along(r->wide[i], reach, rest, b, i);
    bound_along(r->narrow[i], reach, rest, b, r->n + i);
  }
}

/* Points beyond the last have no place. */
static void end_points(conic_reach_points *points, size_t n, size_t room) {
  points->n = room;
  for (size_t i = n; i < room; i++)
    points->columns[0][i] = NAN;
}

static void take_splats(const conic_splats *s, size_t first, size_t end, conic_reach_points *points) {
  float *const *const columns[3] = {s->position, s->tangent_u, s->tangent_v};
  for (int column = 0; column < 9; column++)
    if (columns[column / 3][0])
      memcpy(points->columns[column], columns[column / 3][column % 3] + first, (end - first) * sizeof(float));
    else
      memset(points->columns[column], 0, CONIC_REACH_BLOCK * sizeof(float));
  end_points(points, end - first, CONIC_REACH_BLOCK);
}

static void take_triangles(const conic_triangles *t, size_t first, size_t end, conic_reach_points *points) {
  size_t n = 0;
  memset(points->columns[3], 0, 6 * sizeof points->columns[3]);
  for (size_t i = first; i < end; i++)
    for (int corner = 0; corner < 3; corner++, n++)
      for (int axis = 0; axis < 3; axis++)
        points->columns[axis][n] = t->position[axis][t->corners[i][corner]];
  end_points(points, n, CONIC_REACH_POINTS);
}

/* Which splats or triangles a block has. */
static int block_range(const conic_outline_reach *r, size_t block, size_t *first, size_t *end) {
  int is_splats = block < r->n_splat_blocks;
  size_t count = is_splats ? r->drawing->splats->count : r->drawing->triangles->count;
  *first = (is_splats ? block : block - r->n_splat_blocks) * CONIC_REACH_BLOCK;
  *end = count - *first < CONIC_REACH_BLOCK ? count : *first + CONIC_REACH_BLOCK;
  return is_splats;
}

static size_t end_of_task(const conic_outline_reach *r, size_t i_item) {
  size_t end = (i_item + 1) * BLOCKS_TOGETHER;
  return end < r->n_blocks ? end : r->n_blocks;
}

static void bound_blocks(void *data, size_t i_item) {
  const bounds_job *job = data;
  const conic_outline_reach *r = job->r;
  conic_reach_points points = {.n = 0};
  for (size_t block = i_item * BLOCKS_TOGETHER; block < end_of_task(r, i_item); block++) {
    size_t first, end;
    int is_splats = block_range(r, block, &first, &end);
    const outline_bounds *b = is_splats ? &job->of_splats : &job->of_triangles;
    float *bounds = r->bounds + block * b->limits.n;
    if (is_splats)
      take_splats(r->drawing->splats, first, end, &points);
    else
      take_triangles(r->drawing->triangles, first, end, &points);
    job->loops.reach.bound(&points, &b->limits, bounds);
    for (size_t i = 0; i < b->limits.n; i++)
      bounds[i] = (float)((double)bounds[i] * b->unit + b->shifts[i]);
  }
}

static size_t blocks_for(size_t count) {
  return (count + CONIC_REACH_BLOCK - 1) / CONIC_REACH_BLOCK;
}

conic_status conic_reach_open(conic_context *context, conic_outline_reach *r) {
  bounds_job job = {.r = r};
  conic_isa isa;
  r->n_splat_blocks = blocks_for(r->drawing->splats->count);
  r->n_blocks = r->n_splat_blocks + blocks_for(r->drawing->triangles->count);
  r->n_tasks = (r->n_blocks + BLOCKS_TOGETHER - 1) / BLOCKS_TOGETHER;
  conic_status status = conic_memory_allocate_these(context, CONIC_ROOM(r->bounds, r->n_blocks * 2 * r->n),
                                                    CONIC_ROOM(r->task_farthest, r->n_tasks * r->n));
  if (status == CONIC_OK)
    status = conic_isa_choose(context, CONIC_ISA_AUTO, &isa);
  if (status != CONIC_OK)
    return status;
  conic_raster_loops_init(&job.loops, isa);
  set_limits(r, r->drawing->splats->origin, &job.of_splats);
  set_limits(r, r->drawing->triangles->origin, &job.of_triangles);
  return conic_parallel_told(context, "frame", 0.0, 1.0, r->n_tasks, bound_blocks, &job);
}

void conic_reach_close(conic_context *context, conic_outline_reach *r) {
  conic_memory_release_these(context, r->bounds, r->task_farthest);
}

/* --- exact looks --- */

/* Along some of the directions. */
typedef struct reach_look {
  const conic_outline_reach *r;
  size_t n, wanted[CONIC_REACH_DIRECTIONS];
  double *farthest; /* of all directions */
} reach_look;

static void reach_of_point(const reach_look *l, const double from_center[3], const double u[3], const double v[3]) {
  for (int axis = 0; axis < 3; axis++)
    if (!(from_center[axis] >= l->r->low[axis] && from_center[axis] <= l->r->high[axis]))
      return;
  for (size_t k = 0; k < l->n; k++) {
    const double *direction = l->r->directions[l->wanted[k]];
    double along = conic_dot(direction, from_center), *farthest = &l->farthest[l->wanted[k]];
    if (u) {
      double along_u = conic_dot(direction, u), along_v = conic_dot(direction, v);
      double outline = l->r->cutoff * sqrt(along_u * along_u + along_v * along_v);
      along += outline - outline == 0.0 ? outline : 0.0;
    }
    if (along > *farthest)
      *farthest = along;
  }
}

static void take_at(float *const columns[3], size_t i, const double from[3], double to[3]) {
  for (int axis = 0; axis < 3; axis++)
    to[axis] = (double)columns[axis][i] + from[axis];
}

/* Of a splat with clip lines most is cut away, and its centre is where they meet: on the outline, if anything is. */
static void look_at_splats(const reach_look *l, size_t first, size_t end) {
  static const double zero[3] = {0.0, 0.0, 0.0};
  const conic_splats *s = l->r->drawing->splats;
  double offset[3], place[3], u[3] = {0.0, 0.0, 0.0}, v[3] = {0.0, 0.0, 0.0};
  size_t i_clip = conic_clip_find(s, first);
  conic_subtract(s->origin, l->r->center, offset);
  for (size_t i = first; i < end; i++) {
    int is_clipped = i_clip < s->n_clips && s->clips[i_clip].splat == i;
    i_clip += (size_t)is_clipped;
    take_at(s->position, i, offset, place);
    if (s->tangent_u[0] && !is_clipped) {
      take_at(s->tangent_u, i, zero, u);
      take_at(s->tangent_v, i, zero, v);
    }
    reach_of_point(l, place, s->tangent_u[0] && !is_clipped ? u : NULL, v);
  }
}

static void look_at_triangles(const reach_look *l, size_t first, size_t end) {
  const conic_triangles *t = l->r->drawing->triangles;
  double offset[3], place[3];
  conic_subtract(t->origin, l->r->center, offset);
  for (size_t i = first; i < end; i++)
    for (int corner = 0; corner < 3; corner++) {
      take_at(t->position, t->corners[i][corner], offset, place);
      reach_of_point(l, place, NULL, NULL);
    }
}

static void look_at_block(const reach_look *l, size_t block) {
  size_t first, end;
  (block_range(l->r, block, &first, &end) ? look_at_splats : look_at_triangles)(l, first, end);
}

/* How far a block reaches at most. */
static double bound_of(const conic_outline_reach *r, size_t block, size_t i) {
  const float *bounds = r->bounds + block * 2 * r->n;
  double wide = (double)bounds[i], narrow = (double)bounds[r->n + i];
  return r->parts[i] < 1.0 && wide > -HUGE_VAL ? r->parts[i] * wide + (1.0 - r->parts[i]) * narrow : wide;
}

/* How far some block reaches along each direction: the one that may be the farthest. */
static void look_ahead(conic_outline_reach *r) {
  double greatest[CONIC_REACH_DIRECTIONS] = {0.0};
  size_t blocks[CONIC_REACH_DIRECTIONS] = {0};
  for (size_t i = 0; i < r->n; i++)
    greatest[i] = r->farthest[i] = -HUGE_VAL;
  for (size_t block = 0; block < r->n_blocks; block++)
    for (size_t i = 0; i < r->n; i++) {
      double bound = bound_of(r, block, i);
      blocks[i] = bound > greatest[i] ? block : blocks[i];
      greatest[i] = bound > greatest[i] ? bound : greatest[i];
    }
  for (size_t i = 0; i < r->n; i++)
    if (greatest[i] > -HUGE_VAL)
      look_at_block(&(reach_look){.r = r, .n = 1, .wanted = {i}, .farthest = r->farthest}, blocks[i]);
}

static void look_at_blocks(void *data, size_t i_item) {
  const conic_outline_reach *r = data;
  reach_look l = {.r = r, .farthest = r->task_farthest + i_item * r->n};
  for (size_t i = 0; i < r->n; i++)
    l.farthest[i] = -HUGE_VAL;
  for (size_t block = i_item * BLOCKS_TOGETHER; block < end_of_task(r, i_item); block++) {
    l.n = 0;
    for (size_t i = 0; i < r->n; i++) {
      double bound = bound_of(r, block, i);
      if (bound > -HUGE_VAL && bound >= r->farthest[i])
        l.wanted[l.n++] = i;
    }
    if (l.n > 0)
      look_at_block(&l, block);
  }
}

conic_status conic_reach_measure(conic_context *context, conic_outline_reach *r) {
  look_ahead(r);
  conic_status status = conic_parallel_told(context, "frame", 0.0, 1.0, r->n_tasks, look_at_blocks, r);
  for (size_t i = 0; i < r->n; i++) { /* in order: of equal ones, the first */
    r->farthest[i] = -HUGE_VAL;
    for (size_t task = 0; task < r->n_tasks; task++)
      if (r->task_farthest[task * r->n + i] > r->farthest[i])
        r->farthest[i] = r->task_farthest[task * r->n + i];
  }
  return status;
}
