/* Cameras that a drawing just fits: how far its outline reaches along the planes through the eye and the picture's
 * sides says where the eye has to be. */
#include "raster/framing/drawing_frame.h"

#include "core/base/base.h"
#include "core/base/vectors.h"
#include "core/image/framing.h"
#include "core/splats/columns.h"
#include "core/splats/near.h"
#include "core/splats/splats_gather.h"
#include "raster/framing/outline_reach.h"

enum {
  N_SIDES = 5, /* right, left, bottom and top of a picture, and what is nearest */
  MOST_TURNS =
      CONIC_REACH_DIRECTIONS / N_SIDES /* pictures of a turntable that are looked at: neighbours differ little */
};

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

static void find_stand(const conic_outline_reach *r, const double tangents[2], size_t n_turns, double least_gap,
                       stand *found) {
  double farthest[N_SIDES];
  for (int side = 0; side < N_SIDES; side++) {
    farthest[side] = r->farthest[side];
    for (size_t turn = 1; turn < n_turns; turn++)
      if (r->farthest[turn * N_SIDES + (size_t)side] > farthest[side])
        farthest[side] = r->farthest[turn * N_SIDES + (size_t)side];
  }
  found->distance = farthest[4] + least_gap;
  for (int axis = 0; axis < 2; axis++) {
    double plus = farthest[(size_t)axis * 2], minus = farthest[(size_t)axis * 2 + 1];
    /* What turns about the centre keeps it in the middle. */
    if (axis == 0 && n_turns > 1)
      plus = minus = plus > minus ? plus : minus;
    found->beside[axis] = 0.5 * (plus - minus);
    found->spans[axis] = plus + minus;
    if (found->spans[axis] > 2.0 * tangents[axis] * found->distance)
      found->distance = found->spans[axis] / (2.0 * tangents[axis]);
  }
}

static void set_turns(const conic_framing *framing, size_t n_turns, const double tangents[2], double (*directions)[3]) {
  for (size_t turn = 0; turn < n_turns; turn++) {
    conic_framing turned = *framing;
    double rows[3][3];
    turned.azimuth_deg += 360.0 * (double)turn / (double)n_turns;
    conic_framing_rotation(&turned, rows);
    set_sides(rows, tangents, directions + turn * N_SIDES);
  }
}

/* The side that does not decide is narrowed until it touches as well: only then the outline is in the middle. */
static conic_status find_eye(conic_context *context, const conic_splats_shares *shares, const conic_framing *framing,
                             size_t n_turns, double least_gap, conic_outline_reach *r, stand *found) {
  int n_rounds = n_turns > 1 ? 2 : 6; /* of many pictures none is met exactly */
  double part = CONIC_FRAMING_PART, greatest = 0.0;
  const double widest[2] = {part * conic_framing_tangent(framing, framing->width),
                            part * conic_framing_tangent(framing, framing->height)};
  double tangents[2] = {widest[0], widest[1]};
  set_turns(framing, n_turns, widest, r->wide);
  set_turns(framing, n_turns, (const double[2]){0.0, 0.0}, r->narrow);
  conic_status status = conic_team_agree(shares->team, conic_reach_open(context, r));
  for (int round = 0; status == CONIC_OK && round < n_rounds; round++) {
    set_turns(framing, n_turns, tangents, r->directions);
    for (size_t i = 0; i < r->n; i++) {
      size_t side = i % N_SIDES;
      r->parts[i] = side == 4 ? 1.0 : tangents[side / 2] / widest[side / 2];
    }
    status = conic_team_agree(shares->team, conic_reach_measure(context, r));
    if (status != CONIC_OK)
      break;
    conic_shares_take_greatest(shares, r->farthest, r->n);
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
  conic_reach_close(context, r);
  return status;
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
static size_t find_shared_bounds(conic_context *context, const conic_splats_shares *shares,
                                 const conic_drawing *drawing, double low[3], double high[3]) {
  return shares->team ? conic_shares_bounds(shares, drawing->splats, low, high)
                      : conic_drawing_bounds_by(context, drawing, low, high);
}

static conic_status frame_entered(conic_context *context, const conic_splats_shares *shares,
                                  const conic_drawing *drawing, float cutoff, const conic_framing *framing,
                                  size_t n_turns, conic_camera *camera, double *near_z) {
  double low[3], high[3], diagonal[3], rows[3][3];
  stand found;
  conic_outline_reach r = {.drawing = drawing, .cutoff = (double)cutoff, .n = n_turns * N_SIDES};
  size_t n_finite = find_shared_bounds(context, shares, drawing, low, high);
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
  status = find_eye(context, shares, framing, n_turns, size > 0.0 ? 0.05 * size : 1.0, &r, &found);
  if (status == CONIC_OK) {
    const double at[3] = {-found.beside[0], -found.beside[1], found.distance};
    conic_framing_rotation(framing, rows);
    conic_framing_camera(framing, rows, r.center, at, camera);
    *near_z = size > 0.0 ? 1e-4 * size : 1e-4;
  }
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
