/* A measured guess at which way up a model stands. Files seldom say it, and half of the world has y up and half z. So
 * the guess is between these two, by what survey data, scans and parts have in common. The limits were found on some
 * sixty files whose up is known: with them no file is laid on its back. */
#include "source/upright.h"

#include "core/base/base.h"
#include "core/base/vectors.h"

static const struct {
  const char *name, *reason;
} bases[] = {[CONIC_UP_HABIT] = {"habit", "as most such files have it"},
             [CONIC_UP_KIND] = {"kind", "as the file or its kind says"},
             [CONIC_UP_FLAT] = {"flat", "as it lies flat"},
             [CONIC_UP_OPEN] = {"open", "as its surface is open below"},
             [CONIC_UP_BASE] = {"base", "as it stands on a flat base"},
             [CONIC_UP_FACING] = {"facing", "so that the drawing is seen from its front"}};

static int is_basis(conic_up_basis basis) {
  return (size_t)basis < sizeof bases / sizeof *bases;
}

const char *conic_up_basis_name(conic_up_basis basis) {
  return is_basis(basis) ? bases[basis].name : NULL;
}

const char *conic_up_basis_reason(conic_up_basis basis) {
  return is_basis(basis) ? bases[basis].reason : NULL;
}

/* The most splats and triangles to look at; fewer than the least tell nothing. */
enum { MOST_SAMPLES = 20000, LEAST_SAMPLES = 30 };

/* A flat model is lower than this part of both its ground extents. A mesh in a plane, which is thinner still, is a
 * drawing, to be looked at from its front; points in a plane are a floor. */
static const double flat_part = 0.33, planar_part = 1e-4;

/* An open surface is open below, where nobody looked or nothing is. The mean of its normals by area is at least this
 * long, and mostly vertical. */
static const double open_length = 0.2;

/* A base has this share of the area, at the lower end of a model that is at least this tall beside its other extent. */
static const double base_share = 0.03, base_ratio = 2.0, standing_part = 0.8, base_height = 0.03;

/* Patches of surface: their places, and their normals by area. */
typedef struct samples {
  size_t count;
  double (*place)[3], (*area)[3];
  double *sorted;
} samples;

static void add_patch(samples *s, const double place[3], const double area[3]) {
  for (int axis = 0; axis < 3; axis++)
    if (place[axis] - place[axis] != 0.0 || area[axis] - area[axis] != 0.0)
      return;
  for (int axis = 0; axis < 3; axis++) {
    s->place[s->count][axis] = place[axis];
    s->area[s->count][axis] = area[axis];
  }
  s->count++;
}

/* Takes samples of splats; of shared ones, from all processes. */
static void take_splat_samples(samples *s, const conic_splats_shares *shares, const conic_splats *splats) {
  double u[3], v[3], place[3], area[3];
  size_t stride = conic_shares_stride(shares, splats, MOST_SAMPLES), first = conic_shares_first(shares, stride);
  for (size_t i = first; splats->tangent_u[0] && i < splats->count; i += stride) {
    for (int axis = 0; axis < 3; axis++) {
      u[axis] = (double)splats->tangent_u[axis][i];
      v[axis] = (double)splats->tangent_v[axis][i];
      place[axis] = (double)splats->position[axis][i] + splats->origin[axis];
    }
    conic_cross(u, v, area);
    add_patch(s, place, area);
  }
  size_t n = 3 * s->count;
  conic_shares_gather(shares, s->place[0], n, s->place[0]);
  s->count = conic_shares_gather(shares, s->area[0], n, s->area[0]) / 3;
}

static void take_triangle_samples(samples *s, const conic_triangles *t) {
  double corner[3][3], side[2][3], place[3], area[3];
  for (size_t i = 0; i < t->count; i += 1 + t->count / MOST_SAMPLES) {
    for (int axis = 0; axis < 3; axis++) {
      for (int k = 0; k < 3; k++)
        corner[k][axis] = (double)t->position[axis][t->corners[i][k]];
      place[axis] = (corner[0][axis] + corner[1][axis] + corner[2][axis]) / 3.0 + t->origin[axis];
    }
    conic_subtract(corner[1], corner[0], side[0]);
    conic_subtract(corner[2], corner[0], side[1]);
    conic_cross(side[0], side[1], area);
    add_patch(s, place, area);
  }
}

/* The extent without the outermost hundredth on either side, which may be stray points. */
static void find_extent(const samples *s, double low[3], double high[3]) {
  for (int axis = 0; axis < 3; axis++) {
    for (size_t i = 0; i < s->count; i++)
      s->sorted[i] = s->place[i][axis];
    qsort(s->sorted, s->count, sizeof *s->sorted, conic_compare_doubles);
    low[axis] = s->sorted[s->count / 100];
    high[axis] = s->sorted[s->count - 1 - s->count / 100];
  }
}

static conic_up_basis look_at_box(const double minimum[3], const double maximum[3], int is_mesh) {
  double extent[3];
  conic_subtract(maximum, minimum, extent);
  double across = extent[0] < extent[1] ? extent[0] : extent[1];
  double around = extent[0] < extent[2] ? extent[0] : extent[2];
  if (is_mesh && extent[1] < planar_part * around)
    return CONIC_UP_FACING;
  if (is_mesh && extent[2] < planar_part * across)
    return CONIC_UP_HABIT;
  return extent[2] < flat_part * across ? CONIC_UP_FLAT : CONIC_UP_HABIT;
}

/* Whether the mean normal is vertical: +z and +y are the first two answers; 0: neither. */
static int opens_along(const double mean[3]) {
  int greatest = 0;
  for (int axis = 1; axis < 3; axis++)
    if (fabs(mean[axis]) > fabs(mean[greatest]))
      greatest = axis;
  return fabs(mean[greatest]) > open_length ? greatest : 0;
}

/* The share of the area that is flat at one end of an axis. */
static double share_at(const samples *s, int axis, double end, double height, double total) {
  double sum = 0.0;
  for (size_t i = 0; i < s->count; i++) {
    double area = conic_length(s->area[i]);
    if (fabs(s->place[i][axis] - end) < height && fabs(s->area[i][axis]) > 0.95 * area)
      sum += area;
  }
  return sum / total;
}

static conic_up_basis look_at_samples(const samples *s, int is_mesh) {
  double low[3], high[3], mean[3] = {0.0, 0.0, 0.0}, total = 0.0, greatest = 0.0;
  for (size_t i = 0; i < s->count; i++) {
    total += conic_length(s->area[i]);
    for (int axis = 0; axis < 3; axis++)
      mean[axis] += s->area[i][axis];
  }
  if (!(total > 0.0))
    return CONIC_UP_HABIT;
  find_extent(s, low, high);
  for (int axis = 0; axis < 3; axis++) {
    mean[axis] /= total;
    greatest = high[axis] - low[axis] > greatest ? high[axis] - low[axis] : greatest;
  }
  conic_up_basis flat = look_at_box(low, high, is_mesh);
  int open = flat == CONIC_UP_FACING || (is_mesh && high[2] - low[2] < planar_part * greatest) ? 0 : opens_along(mean);
  if (flat != CONIC_UP_HABIT)
    return open == 1 ? CONIC_UP_HABIT : flat;
  if (open)
    return open == 2 ? CONIC_UP_OPEN : CONIC_UP_HABIT;
  if (high[2] - low[2] < standing_part * (high[1] - low[1]))
    return CONIC_UP_HABIT;
  double height = base_height * greatest, base = share_at(s, 2, low[2], height, total);
  int is_base = base > base_share && base > base_ratio * share_at(s, 2, high[2], height, total) &&
                base > base_ratio * share_at(s, 1, low[1], height, total);
  return is_base ? CONIC_UP_BASE : CONIC_UP_HABIT;
}

conic_status conic_upright_look(conic_context *context, const conic_splats_shares *shares, const conic_drawing *drawing,
                                conic_up_basis *basis) {
  size_t most = 2 * (size_t)MOST_SAMPLES + 2;
  samples s = {.place = conic_memory_allocate(context, most, sizeof *s.place),
               .area = conic_memory_allocate(context, most, sizeof *s.area),
               .sorted = conic_memory_allocate(context, most, sizeof *s.sorted)};
  conic_status status = conic_team_agree(shares->team, s.place && s.area && s.sorted ? CONIC_OK : CONIC_ERROR_MEMORY);
  *basis = CONIC_UP_HABIT;
  if (status == CONIC_OK) {
    take_splat_samples(&s, shares, drawing->splats);
    take_triangle_samples(&s, drawing->triangles);
    *basis = s.count < LEAST_SAMPLES ? CONIC_UP_HABIT : look_at_samples(&s, drawing->triangles->count > 0);
  }
  conic_memory_release_these(context, s.place, s.area, s.sorted);
  return status;
}
