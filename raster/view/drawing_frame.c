/* Cameras that a drawing just fits: how far its outline reaches along the planes through the eye and the picture's
 * sides says where the eye has to be. */
#include "raster/view/drawing_frame.h"

#include "core/base/base.h"
#include "core/base/vectors.h"
#include "core/image/framing.h"
#include "core/splats/columns.h"
#include "core/splats/near.h"

enum {
  MEASURED_TOGETHER = 1 << 15, /* points */
  MOST_TURNS = 24,             /* pictures of a turntable that are looked at: neighbours differ little */
  N_SIDES = 5                  /* right, left, bottom and top of a picture, and what is nearest */
};

/* How far points within a box reach along `n` directions from `center`. */
typedef struct reach {
  const conic_drawing *drawing;
  const conic_splats_shares *shares; /* of its splats */
  double cutoff, center[3];
  double low[3], high[3]; /* from the center */
  size_t n, n_splat_tasks;
  double (*directions)[3];
  double *farthest; /* a task has n */
} reach;

static void reach_of_point(const reach *r, const double from_center[3], const double u[3], const double v[3],
                           double *farthest) {
  for (int axis = 0; axis < 3; axis++)
    if (!(from_center[axis] >= r->low[axis] && from_center[axis] <= r->high[axis]))
      return;
  for (size_t i = 0; i < r->n; i++) {
    const double *direction = r->directions[i];
    double along = conic_dot(direction, from_center);
    if (u) {
      double along_u = conic_dot(direction, u), along_v = conic_dot(direction, v);
      double outline = r->cutoff * sqrt(along_u * along_u + along_v * along_v);
      along += outline - outline == 0.0 ? outline : 0.0;
    }
    if (along > farthest[i])
      farthest[i] = along;
  }
}

static void take_at(float *const columns[3], size_t i, const double from[3], double to[3]) {
  for (int axis = 0; axis < 3; axis++)
    to[axis] = (double)columns[axis][i] + from[axis];
}

/* Of a splat with clip lines most is cut away, and its centre is where they meet: on the outline, if anything is. */
static void reach_of_splats(const reach *r, size_t first, size_t end, double *farthest) {
  static const double zero[3] = {0.0, 0.0, 0.0};
  const conic_splats *s = r->drawing->splats;
  double offset[3], place[3], u[3] = {0.0, 0.0, 0.0}, v[3] = {0.0, 0.0, 0.0};
  size_t i_clip = 0;
  conic_subtract(s->origin, r->center, offset);
  while (i_clip < s->n_clips && s->clips[i_clip].splat < first)
    i_clip++;
  for (size_t i = first; i < end; i++) {
    int is_clipped = i_clip < s->n_clips && s->clips[i_clip].splat == i;
    i_clip += (size_t)is_clipped;
    take_at(s->position, i, offset, place);
    if (s->tangent_u[0] && !is_clipped) {
      take_at(s->tangent_u, i, zero, u);
      take_at(s->tangent_v, i, zero, v);
    }
    reach_of_point(r, place, s->tangent_u[0] && !is_clipped ? u : NULL, v, farthest);
  }
}

static void reach_of_triangles(const reach *r, size_t first, size_t end, double *farthest) {
  const conic_triangles *t = r->drawing->triangles;
  double offset[3], place[3];
  conic_subtract(t->origin, r->center, offset);
  for (size_t i = first; i < end; i++)
    for (int corner = 0; corner < 3; corner++) {
      take_at(t->position, t->corners[i][corner], offset, place);
      reach_of_point(r, place, NULL, NULL, farthest);
    }
}

static void measure_reach_of_task(void *data, size_t i_item) {
  const reach *r = data;
  int is_splats = i_item < r->n_splat_tasks;
  size_t count = is_splats ? r->drawing->splats->count : r->drawing->triangles->count;
  size_t first = (is_splats ? i_item : i_item - r->n_splat_tasks) * MEASURED_TOGETHER;
  size_t end = count - first < MEASURED_TOGETHER ? count : first + MEASURED_TOGETHER;
  double *farthest = r->farthest + i_item * r->n;
  for (size_t i = 0; i < r->n; i++)
    farthest[i] = -HUGE_VAL;
  (is_splats ? reach_of_splats : reach_of_triangles)(r, first, end, farthest);
}

static size_t tasks_for(size_t count) {
  return (count + MEASURED_TOGETHER - 1) / MEASURED_TOGETHER;
}

static conic_status measure_own_reach(conic_context *context, size_t n_tasks, reach *r) {
  conic_memory_release(context, r->farthest);
  r->farthest = conic_memory_allocate(context, (n_tasks ? n_tasks : 1) * r->n, sizeof *r->farthest);
  if (!r->farthest)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < r->n; i++) /* of nothing */
    r->farthest[i] = -HUGE_VAL;
  return conic_parallel_told(context, "frame", 0.0, 1.0, n_tasks, measure_reach_of_task, r);
}

/* The farthest of all, into the first task's place. */
static conic_status measure_reach(conic_context *context, reach *r) {
  r->n_splat_tasks = tasks_for(r->drawing->splats->count);
  size_t n_tasks = r->n_splat_tasks + tasks_for(r->drawing->triangles->count);
  conic_status status = conic_team_agree(r->shares->team, measure_own_reach(context, n_tasks, r));
  if (status != CONIC_OK)
    return status;
  for (size_t task = 1; task < n_tasks; task++)
    for (size_t i = 0; i < r->n; i++)
      if (r->farthest[task * r->n + i] > r->farthest[i])
        r->farthest[i] = r->farthest[task * r->n + i];
  conic_shares_take_greatest(r->shares, r->farthest, r->n);
  return CONIC_OK;
}

/* A point (x, y, z) of camera axes about the centre, seen from z = -d, is left of the side of tangent t where
 * x - t·z ≤ t·d; and so on. */
static void set_sides(double rows[3][3], const double tangents[2], double sides[N_SIDES][3]) {
  for (int i = 0; i < 3; i++) {
    for (int side = 0; side < 4; side++)
      sides[side][i] = (side % 2 ? -1.0 : 1.0) * rows[side / 2][i] - tangents[side / 2] * rows[2][i];
    sides[4][i] = -rows[2][i];
  }
}

/* What is sought: the eye, so far from the centre and so far beside it, in camera axes. */
typedef struct stand {
  double distance, beside[2];
  double spans[2]; /* twice the distance from which the sides alone would be filled, times their tangents */
} stand;

static void find_stand(const reach *r, const double tangents[2], size_t n_turns, double least_gap, stand *found) {
  double farthest[N_SIDES];
  for (int side = 0; side < N_SIDES; side++) {
    farthest[side] = r->farthest[side];
    for (size_t turn = 1; turn < n_turns; turn++)
      if (r->farthest[turn * N_SIDES + (size_t)side] > farthest[side])
        farthest[side] = r->farthest[turn * N_SIDES + (size_t)side];
  }
  found->distance = farthest[4] + least_gap;
  for (int axis = 0; axis < 2; axis++) {
    double plus = farthest[2 * axis], minus = farthest[2 * axis + 1];
    /* What turns about the centre keeps it in the middle. */
    if (axis == 0 && n_turns > 1)
      plus = minus = plus > minus ? plus : minus;
    found->beside[axis] = 0.5 * (plus - minus);
    found->spans[axis] = plus + minus;
    if (found->spans[axis] > 2.0 * tangents[axis] * found->distance)
      found->distance = found->spans[axis] / (2.0 * tangents[axis]);
  }
}

static void set_turns(const conic_framing *framing, size_t n_turns, const double tangents[2], reach *r) {
  for (size_t turn = 0; turn < n_turns; turn++) {
    conic_framing turned = *framing;
    double rows[3][3];
    turned.azimuth_deg += 360.0 * (double)turn / (double)n_turns;
    conic_framing_rotation(&turned, rows);
    set_sides(rows, tangents, r->directions + turn * N_SIDES);
  }
}

/* The side that does not decide is narrowed until it touches as well: only then the outline is in the middle. */
static conic_status find_eye(conic_context *context, const conic_framing *framing, size_t n_turns, double least_gap,
                             reach *r, stand *found) {
  enum { N_ROUNDS = 6 };
  double part = CONIC_FRAMING_PART, greatest = 0.0;
  double tangents[2] = {part * conic_framing_tangent(framing, framing->width),
                        part * conic_framing_tangent(framing, framing->height)};
  for (int round = 0; round < (n_turns > 1 ? 2 : N_ROUNDS); round++) { /* of many pictures none is met exactly */
    set_turns(framing, n_turns, tangents, r);
    conic_status status = measure_reach(context, r);
    if (status != CONIC_OK)
      return status;
    find_stand(r, tangents, n_turns, least_gap, found);
    if (found->distance > greatest)
      greatest = found->distance;
    found->distance = greatest;
    for (int axis = 0; axis < 2; axis++) {
      double touched = found->spans[axis] / (2.0 * greatest);
      if (touched > 0.0 && touched < tangents[axis])
        tangents[axis] = touched;
    }
  }
  return CONIC_OK;
}

/* --- strays --- */

enum { MOST_PLACES = 20000 };

/* Some of a component of all places, in order; returns how many. */
static size_t sort_places(const conic_splats_shares *shares, const conic_drawing *drawing, int axis, double *sorted) {
  const conic_splats *s = drawing->splats;
  const conic_triangles *t = drawing->triangles;
  size_t n = 0, stride = conic_shares_stride(shares, s, MOST_PLACES);
  for (size_t i = conic_shares_first(shares, stride); i < s->count; i += stride)
    sorted[n++] = (double)s->position[axis][i] + s->origin[axis];
  n = conic_shares_gather(shares, sorted, n, sorted);
  stride = 1 + t->count / MOST_PLACES;
  for (size_t i = 0; i < t->count; i += stride)
    sorted[n++] = (double)t->position[axis][t->corners[i][0]] + t->origin[axis];
  size_t n_finite = 0;
  for (size_t i = 0; i < n; i++)
    if (sorted[i] - sorted[i] == 0.0)
      sorted[n_finite++] = sorted[i];
  qsort(sorted, n_finite, sizeof *sorted, conic_compare_doubles);
  return n_finite;
}

/* Fewer than one in a hundred on either side, farther out than four times what the others span, are strays: a point
 * that a scanner threw to the origin would else be all there is to see. */
static conic_status leave_out_strays(conic_context *context, const conic_splats_shares *shares,
                                     const conic_drawing *drawing, double low[3], double high[3]) {
  static const double stray_spans = 4.0;
  double *sorted = conic_memory_allocate(context, 2 * (size_t)MOST_PLACES + 2, sizeof *sorted);
  conic_status status = conic_team_agree(shares->team, sorted ? CONIC_OK : CONIC_ERROR_MEMORY);
  if (status != CONIC_OK) {
    conic_memory_release(context, sorted);
    return status;
  }
  for (int axis = 0; axis < 3; axis++) {
    size_t n = sort_places(shares, drawing, axis, sorted), n_out = n / 100;
    if (n_out == 0)
      continue;
    double first = sorted[n_out], last = sorted[n - 1 - n_out], most = stray_spans * (last - first);
    low[axis] = first - most > low[axis] && most > 0.0 ? first : low[axis];
    high[axis] = last + most < high[axis] && most > 0.0 ? last : high[axis];
  }
  conic_memory_release(context, sorted);
  return CONIC_OK;
}

/* conic_drawing_bounds of what all processes have. */
static size_t find_shared_bounds(const conic_splats_shares *shares, const conic_drawing *drawing, double low[3],
                                 double high[3]) {
  return shares->team ? conic_shares_bounds(shares, drawing->splats, low, high)
                      : conic_drawing_bounds(drawing, low, high);
}

static conic_status frame_entered(conic_context *context, const conic_splats_shares *shares,
                                  const conic_drawing *drawing, float cutoff, const conic_framing *framing,
                                  size_t n_turns, conic_camera *camera, double *near_z) {
  double low[3], high[3], diagonal[3], rows[3][3];
  stand found;
  reach r = {.drawing = drawing, .shares = shares, .cutoff = (double)cutoff, .n = n_turns * N_SIDES};
  size_t n_finite = find_shared_bounds(shares, drawing, low, high);
  *near_z = conic_near_of_box(low, high);
  if (n_finite == 0)
    return conic_camera_frame(context, framing, low, high, camera);
  conic_status status = leave_out_strays(context, shares, drawing, low, high);
  if (status != CONIC_OK)
    return status;
  conic_subtract(high, low, diagonal);
  for (int i = 0; i < 3; i++) {
    double margin = 1e-9 * diagonal[i]; /* of rounding: what is on the box's border is in it */
    r.center[i] = 0.5 * low[i] + 0.5 * high[i];
    r.low[i] = low[i] - r.center[i] - margin;
    r.high[i] = high[i] - r.center[i] + margin;
  }
  double size = conic_length(diagonal);
  r.directions = conic_memory_allocate(context, r.n, sizeof *r.directions);
  status = conic_team_agree(shares->team, r.directions ? CONIC_OK : CONIC_ERROR_MEMORY);
  if (status == CONIC_OK)
    status = find_eye(context, framing, n_turns, size > 0.0 ? 0.05 * size : 1.0, &r, &found);
  if (status == CONIC_OK) {
    const double at[3] = {-found.beside[0], -found.beside[1], found.distance};
    conic_framing_rotation(framing, rows);
    conic_framing_camera(framing, rows, r.center, at, camera);
    *near_z = size > 0.0 ? 1e-4 * size : 1e-4;
  }
  conic_memory_release(context, r.directions);
  conic_memory_release(context, r.farthest);
  return status;
}

conic_status conic_drawing_frame_shared(conic_context *context, const conic_splats_shares *shares,
                                        const conic_drawing *drawing, float cutoff, const conic_framing *given,
                                        int n_turns, conic_camera *camera, double *near_z) {
  conic_framing framing;
  conic_entered_drawing entered;
  double unused;
  if (!camera || n_turns < 1)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "frame: no camera, or no picture");
  conic_status status = conic_framing_take(context, given, &framing);
  if (status != CONIC_OK)
    return status;
  status = conic_team_agree(shares->team, conic_drawing_enter(context, "frame", drawing, &entered));
  if (status == CONIC_OK) {
    const conic_drawing close = {&entered.splats, &entered.triangles};
    size_t n_seen = n_turns < MOST_TURNS ? (size_t)n_turns : MOST_TURNS;
    status = frame_entered(context, shares, &close, cutoff, &framing, n_seen, camera, near_z ? near_z : &unused);
  }
  conic_drawing_leave(context, &entered);
  return status;
}

conic_status conic_drawing_frame(conic_context *context, const conic_drawing *drawing, float cutoff,
                                 const conic_framing *framing, int n_turns, conic_camera *camera, double *near_z) {
  static const conic_splats_shares alone = {.team = NULL};
  return conic_drawing_frame_shared(context, &alone, drawing, cutoff, framing, n_turns, camera, near_z);
}
