/* A measured guess at which way up a model stands. Files seldom say it, and half of the world has y up and half z. So
 * the guess is between these two, by what survey data, scans and parts have in common. y stays where the shape is not
 * sure. The limits were found on a hundred files whose up is known: with them none is laid on its back. */
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
             [CONIC_UP_FACING] = {"facing", "so that the drawing is seen from its front"},
             [CONIC_UP_EVEN] = {"even", "as it is the same on both sides of y, and not of z"}};

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
enum { MOST_SAMPLES = 20000, LEAST_SAMPLES = 30, ENOUGH_PARTS = 5000, CELLS = 30 };

/* A flat model is lower than this part of both its ground extents. A mesh in a plane, which is thinner still, is a
 * drawing, to be looked at from its front; points in a plane are a floor. */
static const double flat_part = 0.33, planar_part = 1e-4;

/* An open surface is open below, where nobody looked or nothing is. The mean of its normals by area is at least this
 * long, and mostly vertical. */
static const double open_length = 0.2;

/* A base has this share of the area, at the lower end of a model that is at least this tall beside its other extent. */
static const double base_share = 0.03, base_ratio = 2.0, standing_part = 0.8, base_height = 0.03;

/* Mirrored in the middle of an extent, less than this share of the area meets nothing where sides are alike, and more
 * than the second, and several times what is so along another axis, where they are not. */
static const double alike = 0.02, uneven_share = 0.08, uneven_ratio = 2.5;

/* Shares of the area of what lies that face along the axis, roughly and exactly. And what is longer along z than this
 * many times its width lies along it. */
static const double facing_share = 0.5, exact_share = 0.25, lying_ratio = 1.7;

/* Patches of surface: their places, and their normals by area. */
typedef struct samples {
  size_t count;
  double (*place)[3], (*area)[3];
  double *sorted;
} samples;

/* What is told of it: the extent without strays, the mean of the normals by area, and, by axis, the share of the area
 * that has nothing opposite to it, mirrored in the middle. */
typedef struct shape {
  double low[3], high[3], extent[3], greatest, mean[3], uneven[3], total;
  double raised[3]; /* the mean of the normals with all of them turned to +z */
} shape;

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

/* Patches of a triangle, all of one size: its k² parts. */
static void add_parts(samples *s, const double corner[3][3], const double area[3], int k) {
  double place[3], part[3];
  for (int axis = 0; axis < 3; axis++)
    part[axis] = area[axis] / (double)(k * k);
  for (int i = 0; i < k; i++)
    for (int j = 0; i + j < k; j++)
      for (int flip = 0; flip < 2 && i + j + flip < k; flip++) {
        double u = (3.0 * i + 1.0 + flip) / (3.0 * k), v = (3.0 * j + 1.0 + flip) / (3.0 * k);
        for (int axis = 0; axis < 3; axis++)
          place[axis] = (1.0 - u - v) * corner[0][axis] + u * corner[1][axis] + v * corner[2][axis];
        add_patch(s, place, part);
      }
}

static void find_corners(const conic_triangles *t, size_t i, double corner[3][3], double area[3]) {
  double side[2][3];
  for (int k = 0; k < 3; k++)
    for (int axis = 0; axis < 3; axis++)
      corner[k][axis] = (double)t->position[axis][t->corners[i][k]] + t->origin[axis];
  conic_subtract(corner[1], corner[0], side[0]);
  conic_subtract(corner[2], corner[0], side[1]);
  conic_cross(side[0], side[1], area);
}

/* Large triangles give several, so that a few make a surface, too. */
static void take_triangle_samples(samples *s, const conic_triangles *t) {
  double corner[3][3], area[3], total = 0.0;
  const size_t stride = 1 + t->count / MOST_SAMPLES;
  for (size_t i = 0; i < t->count; i += stride) {
    find_corners(t, i, corner, area);
    double length = conic_length(area);
    total += length - length == 0.0 ? length : 0.0;
  }
  for (size_t i = 0; i < t->count; i += stride) {
    find_corners(t, i, corner, area);
    double parts = total > 0.0 ? conic_length(area) / total * ENOUGH_PARTS : 1.0;
    add_parts(s, corner, area, parts >= 4.0 && parts <= ENOUGH_PARTS ? (int)sqrt(parts) : 1);
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

static double smaller(double a, double b) {
  return a < b ? a : b;
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
static double share_at(const samples *s, const shape *m, int axis, double end) {
  double sum = 0.0, height = base_height * m->greatest;
  for (size_t i = 0; i < s->count; i++) {
    double area = conic_length(s->area[i]);
    if (fabs(s->place[i][axis] - end) < height && fabs(s->area[i][axis]) > 0.95 * area)
      sum += area;
  }
  return sum / m->total;
}

/* Which cells of a box around all have patches. */
typedef struct presence {
  double middle[3], cell;
  unsigned char has[CELLS][CELLS][CELLS];
} presence;

static void find_cell(const presence *of, const double place[3], int at[3]) {
  for (int axis = 0; axis < 3; axis++) {
    double cell = (place[axis] - of->middle[axis]) / of->cell + 0.5 * CELLS;
    at[axis] = cell < 1.0 ? 1 : cell < CELLS - 2 ? (int)cell : CELLS - 2;
  }
}

static int is_near(const presence *of, const int at[3]) {
  for (int i = at[0] - 1; i <= at[0] + 1; i++)
    for (int j = at[1] - 1; j <= at[1] + 1; j++)
      for (int k = at[2] - 1; k <= at[2] + 1; k++)
        if (of->has[i][j][k])
          return 1;
  return 0;
}

static void find_unevenness(const samples *s, shape *m, presence *of) {
  int at[3];
  memset(of->has, 0, sizeof of->has);
  of->cell = m->greatest / (CELLS - 6);
  for (int axis = 0; axis < 3; axis++)
    of->middle[axis] = 0.5 * (m->low[axis] + m->high[axis]);
  for (size_t i = 0; i < s->count; i++) {
    find_cell(of, s->place[i], at);
    of->has[at[0]][at[1]][at[2]] = 1;
  }
  for (size_t i = 0; i < s->count; i++)
    for (int axis = 0; axis < 3; axis++) {
      double place[3] = {s->place[i][0], s->place[i][1], s->place[i][2]};
      place[axis] = 2.0 * of->middle[axis] - place[axis];
      find_cell(of, place, at);
      m->uneven[axis] += is_near(of, at) ? 0.0 : conic_length(s->area[i]) / m->total;
    }
}

static int measure_shape(const samples *s, presence *of, shape *m) {
  memset(m, 0, sizeof *m);
  for (size_t i = 0; i < s->count; i++) {
    m->total += conic_length(s->area[i]);
    for (int axis = 0; axis < 3; axis++) {
      m->mean[axis] += s->area[i][axis];
      m->raised[axis] += s->area[i][2] < 0.0 ? -s->area[i][axis] : s->area[i][axis];
    }
  }
  find_extent(s, m->low, m->high);
  conic_subtract(m->high, m->low, m->extent);
  for (int axis = 0; axis < 3; axis++) {
    m->mean[axis] /= m->total;
    m->raised[axis] /= m->total;
    m->greatest = m->extent[axis] > m->greatest ? m->extent[axis] : m->greatest;
  }
  if (!(m->total > 0.0) || !(m->greatest > 0.0))
    return 0;
  find_unevenness(s, m, of);
  return 1;
}

/* Whether it is flat along an axis, and most of a mesh faces along it, or much of it exactly. A figure with its arms
 * out is as flat, and round. */
static int is_lying(const samples *s, const shape *m, int axis, int is_mesh) {
  double facing = 0.0, exact = 0.0;
  if (!(m->extent[axis] < flat_part * smaller(m->extent[0], m->extent[3 - axis])))
    return 0;
  for (size_t i = 0; i < s->count; i++) {
    double area = conic_length(s->area[i]), along = fabs(s->area[i][axis]);
    facing += along > 0.8 * area ? area : 0.0;
    exact += along > 0.97 * area ? area : 0.0;
  }
  return !is_mesh || facing > facing_share * m->total || exact > exact_share * m->total;
}

/* Whether more of it lacks its mirror image along z than along y; and it is rather tall than deep, as what stands is,
 * and not long, as what lies is. */
static int is_even(const shape *m, int is_base) {
  int is_long = !is_base && m->extent[2] > lying_ratio * m->extent[0] && m->extent[2] > lying_ratio * m->extent[1];
  double tall = sqrt(smaller(m->extent[2] / m->extent[1], 1e3));
  return !is_long && m->uneven[2] > uneven_share && (m->uneven[2] + 0.01) * tall > uneven_ratio * (m->uneven[1] + 0.01);
}

static conic_up_basis judge_shape(const samples *s, const shape *m, int is_mesh) {
  if (is_mesh && m->extent[1] < planar_part * smaller(m->extent[0], m->extent[2]))
    return CONIC_UP_FACING;
  int open = opens_along(m->mean);
  int is_half = is_mesh && m->uneven[0] < alike && m->uneven[1] >= alike; /* as a face, which is open behind */
  if ((is_mesh && m->extent[2] < planar_part * m->greatest) || open == 1 || (open && is_half) ||
      is_lying(s, m, 1, is_mesh))
    return CONIC_UP_HABIT;
  if (is_lying(s, m, 2, is_mesh))
    return CONIC_UP_FLAT;
  if (open)
    return CONIC_UP_OPEN;
  double base = share_at(s, m, 2, m->low[2]);
  int is_base = base > base_share && base > base_ratio * share_at(s, m, 2, m->high[2]);
  if (is_even(m, is_base))
    return CONIC_UP_EVEN;
  is_base = is_base && base > base_ratio * share_at(s, m, 1, m->low[1]);
  return is_base && m->extent[2] > standing_part * m->extent[1] && m->uneven[1] < uneven_share + 4.0 * m->uneven[2]
             ? CONIC_UP_BASE
             : CONIC_UP_HABIT;
}

conic_status conic_upright_look(conic_context *context, const conic_splats_shares *shares, const conic_drawing *drawing,
                                conic_up_basis *basis, double fronts[2][3]) {
  size_t most = 3 * (size_t)MOST_SAMPLES + 2;
  samples s = {.place = conic_memory_allocate(context, most, sizeof *s.place),
               .area = conic_memory_allocate(context, most, sizeof *s.area),
               .sorted = conic_memory_allocate(context, most, sizeof *s.sorted)};
  presence *cells = conic_memory_allocate(context, 1, sizeof *cells);
  shape found;
  conic_status status =
      conic_team_agree(shares->team, s.place && s.area && s.sorted && cells ? CONIC_OK : CONIC_ERROR_MEMORY);
  *basis = CONIC_UP_HABIT;
  memset(fronts, 0, 2 * sizeof *fronts);
  if (status == CONIC_OK) {
    take_splat_samples(&s, shares, drawing->splats);
    int are_enough = s.count + drawing->triangles->count >= LEAST_SAMPLES;
    take_triangle_samples(&s, drawing->triangles);
    if (are_enough && s.count && measure_shape(&s, cells, &found)) {
      *basis = judge_shape(&s, &found, drawing->triangles->count > 0);
      memcpy(fronts[0], found.mean, sizeof found.mean);
      memcpy(fronts[1], found.raised, sizeof found.raised);
    }
  }
  conic_memory_release_these(context, s.place, s.area, s.sorted, cells);
  return status;
}
