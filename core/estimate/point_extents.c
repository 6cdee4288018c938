/* Ellipses of points without faces, around the part of the tangent plane that is nearer to the point than to its
 * neighbours. Such cells leave no gap, however unevenly a scanner sampled; they are cut off at a radius, so that they
 * close no hole. */

#include "core/base/vectors.h"
#include "core/estimate/estimate.h"
#include "core/estimate/voronoi_cell.h"
#include "core/splats/ellipse.h"

/* The cell's radius in local spacings; times CONIC_OUTLINE_COVER, it is half the width of the gaps that close. */
#define CELL_RADIUS 1.5
/* The ellipse around a cell reaches no farther than this many of the cell's radii: with a long cell's ratio it would
 * point far out of the cell. */
#define GREATEST_REACH 1.1
/* A neighbour is on the same surface if its direction is less than 60° off the tangent plane, and the normals differ by
 * at most 107°. */
#define GREATEST_SLOPE 0.866
#define LEAST_COSINE (-0.3)
/* The most that a spacing may exceed the median of the neighbours', as a factor. */
#define GREATEST_GROWTH 1.35
/* A point is isolated if its nearest neighbour is farther than this many times the median of the neighbours' spacings;
 * its outline is then half such a spacing. */
#define ISOLATION 4.0
#define ISOLATED_OUTLINE 0.5
/* Without any neighbour only the unit gives a scale: pictures frame such a point as a sphere of radius 1. */
#define LONE_OUTLINE 0.01
/* The farther the neighbours are off the tangent plane, as a part of their distances, the less is there a surface to
 * close: an outline reaches no farther than ROUGHNESS over that part, in the reach of a cell of the median spacing;
 * this one at least. */
#define ROUGHNESS 0.35
#define LEAST_REACH 1.2
/* Where dots are looked for, an outline reaches no farther than so many times the median of the neighbours': a few
 * points that might be a surface among dots, which are smaller, are no blobs. */
#define GREATEST_EXCESS 2.0
/* A dot, which has no surface to close, and anything where most points are dots, is no larger than so many usual dots.
 */
#define GREATEST_DOT 3.0
/* The median is found of so many. */
enum { MEDIAN_SAMPLES = 20000 };
/* The density comes from the nearest few neighbours on the surface, and from all. */
#define NEAREST_FEW 8

#define PI 3.14159265358979323846

/* A slot as the origin of its tangent plane. */
typedef struct tangent_origin {
  const conic_neighbourhood *neighbourhood;
  const uint32_t *list;
  double position[3], normal[3];
} tangent_origin;

static tangent_origin place_at(const conic_neighbourhood *neighbourhood, size_t slot) {
  tangent_origin p = {neighbourhood, conic_neighbourhood_of(neighbourhood, slot), {0.0}, {0.0}};
  conic_neighbourhood_position(neighbourhood, slot, p.position);
  for (int axis = 0; axis < 3; axis++)
    p.normal[axis] = (double)neighbourhood->normals[slot][axis];
  return p;
}

/* The neighbours as the origin sees them: the vectors to them, and whether they are on the same surface. */
typedef struct neighbour_views {
  double d[3][CONIC_MAX_NEIGHBOURS], normal[3][CONIC_MAX_NEIGHBOURS];
  double distances2[CONIC_MAX_NEIGHBOURS], heights[CONIC_MAX_NEIGHBOURS];
  int64_t are_same[CONIC_MAX_NEIGHBOURS];
} neighbour_views;

static void view_neighbours(const tangent_origin *p, neighbour_views *views) {
  const conic_neighbourhood *neighbourhood = p->neighbourhood;
  const size_t n = neighbourhood->n_neighbours;
  const tangent_origin own = *p;
  neighbour_views *restrict v = views;
  for (size_t i = 0; i < n; i++)
    for (int axis = 0; axis < 3; axis++) {
      v->d[axis][i] = (double)neighbourhood->tree.position[axis][own.list[i]];
      v->normal[axis][i] = (double)neighbourhood->normals[own.list[i]][axis];
    }
  for (size_t i = 0; i < n; i++) {
    double x = v->d[0][i] - own.position[0], y = v->d[1][i] - own.position[1], z = v->d[2][i] - own.position[2];
    double distance2 = x * x + y * y + z * z;
    double height = own.normal[0] * x + own.normal[1] * y + own.normal[2] * z;
    double cosine = own.normal[0] * v->normal[0][i] + own.normal[1] * v->normal[1][i] + own.normal[2] * v->normal[2][i];
    v->d[0][i] = x;
    v->d[1][i] = y;
    v->d[2][i] = z;
    v->distances2[i] = distance2;
    v->heights[i] = height;
    v->are_same[i] = (cosine >= LEAST_COSINE) & (height * height <= GREATEST_SLOPE * GREATEST_SLOPE * distance2);
  }
}

/* The side of a square with the area of one sample: n samples lie in a disc that reaches to the n-th neighbour. The
 * denser estimate counts, from the nearest few or from all: a cluster's edge must not make it sparse. */
static double spacing_of(const conic_neighbourhood *neighbourhood, size_t slot) {
  tangent_origin p = place_at(neighbourhood, slot);
  neighbour_views views;
  double few = HUGE_VAL, all = HUGE_VAL;
  size_t n = 0;
  view_neighbours(&p, &views);
  for (size_t i = 0; i < neighbourhood->n_neighbours; i++)
    if (views.are_same[i]) {
      n++;
      all = views.distances2[i] / (double)n;
      few = n <= NEAREST_FEW ? all : few;
    }
  if (n == 0)
    all = views.distances2[0];
  return sqrt(PI * (few < all ? few : all));
}

typedef struct spacing_work {
  const conic_neighbourhood *neighbourhood;
  double *spacings;
} spacing_work;

static void space_slots(void *data, size_t begin, size_t end) {
  const spacing_work *work = data;
  for (size_t slot = begin; slot < end; slot++)
    if (work->neighbourhood->flags[slot] & CONIC_SLOT_LISTED && work->neighbourhood->n_neighbours)
      work->spacings[slot] = spacing_of(work->neighbourhood, slot);
}

conic_status conic_estimate_spacings(conic_context *context, const conic_neighbourhood *neighbourhood,
                                     /* NOLINTNEXTLINE(readability-non-const-parameter): threads write to it */
                                     double *spacings) {
  spacing_work work = {neighbourhood, spacings};
  const conic_team_column column = {spacings, sizeof *spacings};
  return conic_slots_share(context, neighbourhood->tree.n_slots, space_slots, &work, 0.6, 0.7, &column, 1);
}

/* The upper median of what is not below 0, in whole blocks that end with zeros: the greatest with so few below. Each is
 * compared with each, as sorting would branch on what cannot be foreseen. */
enum { BLOCK = 8 };
typedef double value_pair __attribute__((vector_size(16)));
typedef int64_t pair_mask __attribute__((vector_size(16)));
static double upper_median(const double *values, size_t n) {
  const double half = (double)(n / 2);
  const value_pair one = {1.0, 1.0};
  value_pair median = {0.0, 0.0};
  for (size_t begin = 0; begin < n; begin += BLOCK) {
    value_pair own[BLOCK / 2], n_below[BLOCK / 2] = {{0.0}};
    memcpy(own, values + begin, sizeof own);
    for (size_t j = 0; j < n; j++)
      for (int part = 0; part < BLOCK / 2; part++)
        n_below[part] += (value_pair)((values[j] < own[part]) & (pair_mask)one);
    for (int part = 0; part < BLOCK / 2; part++) {
      value_pair low = (value_pair)((n_below[part] <= half) & (pair_mask)own[part]);
      pair_mask is_more = low > median;
      median = (value_pair)((is_more & (pair_mask)low) | (~is_more & (pair_mask)median));
    }
  }
  return median[0] > median[1] ? median[0] : median[1];
}

/* The upper median of the neighbours' spacings. */
static double median_spacing(const tangent_origin *p, const double *spacings) {
  double values[CONIC_MAX_NEIGHBOURS + BLOCK] = {0.0};
  size_t n = p->neighbourhood->n_neighbours;
  for (size_t i = 0; i < n; i++)
    values[i] = spacings[p->list[i]];
  return upper_median(values, n);
}

/* Cuts the cell by the neighbours on the same surface. They are turned into the tangent plane, at their true distance:
 * where the surface bends away, a projection would shorten the distance and the cell. */
static void cut_cell(const neighbour_views *views, size_t n, const double u[3], const double v[3], double radius,
                     conic_voronoi_cell *cell) {
  conic_voronoi_cell_begin(cell, radius);
  for (size_t i = 0; i < n && 0.25 * views->distances2[i] < cell->greatest2; i++) {
    if (!views->are_same[i])
      continue;
    double x = views->d[0][i] * u[0] + views->d[1][i] * u[1] + views->d[2][i] * u[2];
    double y = views->d[0][i] * v[0] + views->d[1][i] * v[1] + views->d[2][i] * v[2];
    double stretch = sqrt(views->distances2[i] / (x * x + y * y));
    conic_voronoi_cell_cut(cell, x * stretch, y * stretch);
  }
}

/* Whether the cell is open on two opposite sides: then the width of the surface is unknown, as on a cable. */
static int is_open_across(const conic_voronoi_cell *cell, double radius) {
  if (cell->greatest2 < 0.89 * radius * radius) /* no product of two corners is greater */
    return 0;
  for (int i = 0; i < cell->n_corners; i++)
    for (int j = 0; j < i; j++)
      if (cell->corners[i][0] * cell->corners[j][0] + cell->corners[i][1] * cell->corners[j][1] <
          -0.9 * radius * radius)
        return 1;
  return 0;
}

static conic_ellipse circle(double radius) {
  conic_ellipse ellipse = {{1.0, 0.0}, 1.0, radius};
  return ellipse;
}

/* Confetti's ellipse (§4.3): around all neighbours, seen along the normal, on any surface. */
static conic_ellipse bound_neighbours(const neighbour_views *views, size_t n, const double u[3], const double v[3]) {
  double points[CONIC_MAX_NEIGHBOURS][2];
  for (size_t i = 0; i < n; i++) {
    const double d[3] = {views->d[0][i], views->d[1][i], views->d[2][i]};
    points[i][0] = conic_dot(d, u);
    points[i][1] = conic_dot(d, v);
  }
  return conic_ellipse_bound((const double(*)[2])points, (int)n, CONIC_OUTLINE_RATIO);
}

/* The outline at a place, and the point's state that follows. */
static conic_point_state outline(const tangent_origin *p, size_t slot, const double *spacings,
                                 const neighbour_views *views, const double u[3], const double v[3],
                                 conic_ellipse *ellipse) {
  conic_voronoi_cell cell;
  const size_t n = p->neighbourhood->n_neighbours;
  *ellipse = circle(LONE_OUTLINE);
  if (n == 0)
    return CONIC_POINT_ISOLATED;
  double median = median_spacing(p, spacings);
  *ellipse = circle(ISOLATED_OUTLINE * median);
  if (views->distances2[0] > ISOLATION * ISOLATION * median * median)
    return CONIC_POINT_ISOLATED;
  double own = spacings[slot], greatest = GREATEST_GROWTH * median;
  double radius = CELL_RADIUS * (own < greatest ? own : greatest);
  cut_cell(views, n, u, v, radius, &cell);
  if (is_open_across(&cell, radius)) {
    double next = CELL_RADIUS * sqrt(views->distances2[n > 1]);
    radius = next < radius ? next : radius;
    cut_cell(views, n, u, v, radius, &cell);
  }
  *ellipse = conic_ellipse_bound((const double(*)[2])cell.corners, cell.n_corners, CONIC_OUTLINE_RATIO);
  conic_ellipse_retract(ellipse, (const double(*)[2])cell.corners, cell.n_corners, GREATEST_REACH * radius);
  conic_ellipse_overlap(ellipse, conic_voronoi_cell_area(&cell), CONIC_OUTLINE_COVER, CONIC_OUTLINE_BLEND,
                        CONIC_OUTLINE_COVER * radius);
  return CONIC_POINT_SPREAD;
}

/* Where there is no surface: a small round outline. Its normal is the file's, else points outwards. */
static void make_dot(conic_estimate *estimate, tangent_origin *p, size_t point, size_t slot, int has_normal,
                     conic_ellipse *ellipse) {
  *ellipse = circle(conic_scatter_reach(p->neighbourhood, slot));
  estimate->dot[point] = 1.0f;
  double outside[3];
  if (has_normal)
    return;
  conic_scatter_outside(p->neighbourhood, slot, outside);
  if (conic_dot(outside, outside) > 0.0)
    memcpy(p->normal, outside, sizeof outside);
}

/* How far the neighbours are off the tangent plane, as a part of their distances, by the roots of mean squares. */
static double roughness(const neighbour_views *views, size_t n) {
  double heights2 = 0.0, distances2 = 0.0;
  for (size_t i = 0; i < n; i++) {
    heights2 += views->heights[i] * views->heights[i];
    distances2 += views->distances2[i];
  }
  return sqrt(heights2 / distances2);
}

/* The reach as far as its roughness allows. */
static double bounded_reach(double rough, double reach, double usual) {
  double most = usual * (rough * LEAST_REACH < ROUGHNESS ? ROUGHNESS / rough : LEAST_REACH);
  return reach < most ? reach : most;
}

typedef struct spread_work {
  conic_estimate *estimate;
  const conic_neighbourhood *neighbourhood;
  double *spacings;
  double *lengths;    /* the longer axis of each slot's outline, -1 without one */
  double usual_reach; /* of a cell of the median spacing */
  double usual_dot;   /* the longer axis of most dots … */
  int are_dots;       /* … which most points are */
} spread_work;

static void spread_point(const spread_work *work, size_t point, size_t slot) {
  conic_estimate *estimate = work->estimate;
  float *const *given = estimate->model->points.normal;
  tangent_origin p = place_at(work->neighbourhood, slot);
  const size_t n = work->neighbourhood->n_neighbours;
  neighbour_views views;
  double own[3], u[3], v[3];
  float tangent_u[3], tangent_v[3];
  conic_ellipse ellipse;
  int has_normal = given[0] && conic_unit_vector(given, point, own);
  for (int axis = 0; axis < 3 && has_normal; axis++)
    p.normal[axis] = own[axis];
  conic_tangent_basis(p.normal, u, v);
  view_neighbours(&p, &views);
  conic_point_state state = outline(&p, slot, work->spacings, &views, u, v, &ellipse);
  if (estimate->rule == CONIC_ELLIPSE_BOUNDING && state == CONIC_POINT_SPREAD)
    ellipse = bound_neighbours(&views, n, u, v);
  if (estimate->dot && state == CONIC_POINT_SPREAD && ellipse.reach > LEAST_REACH * work->usual_reach)
    ellipse.reach = bounded_reach(roughness(&views, n), ellipse.reach, work->usual_reach);
  if (estimate->dot && state == CONIC_POINT_ISOLATED)
    estimate->dot[point] = 1.0f;
  else if (estimate->dot && work->neighbourhood->flags[slot] & CONIC_SLOT_SCATTERED) {
    make_dot(estimate, &p, point, slot, has_normal, &ellipse);
    conic_tangent_basis(p.normal, u, v);
  }
  if (!conic_ellipse_axes(&ellipse, u, v, estimate->cutoff, tangent_u, tangent_v))
    state = CONIC_POINT_FAILED;
  for (int axis = 0; axis < 3; axis++) {
    estimate->tangent_u[axis][point] = tangent_u[axis];
    estimate->tangent_v[axis][point] = tangent_v[axis];
  }
  estimate->states[point] = (uint8_t)state;
}

static void spread_slots(void *data, size_t begin, size_t end) {
  const spread_work *work = data;
  for (size_t slot = begin; slot < end; slot++) {
    size_t point = work->neighbourhood->tree.point_of_slot[slot];
    if (work->estimate->states[point] == CONIC_POINT_RAW)
      spread_point(work, point, slot);
  }
}

/* Points at the place of an earlier one: each by its own normal. */
static void spread_duplicates(void *data, size_t begin, size_t end) {
  const spread_work *work = data;
  for (size_t point = begin; point < end; point++)
    if (work->estimate->states[point] == CONIC_POINT_RAW)
      spread_point(work, point, work->neighbourhood->tree.slot_of_point[point]);
}

static int is_spread(const conic_estimate *estimate, size_t point) {
  return estimate->states[point] == CONIC_POINT_SPREAD || estimate->states[point] == CONIC_POINT_ISOLATED;
}

static double longer_axis(const conic_estimate *estimate, size_t point) {
  double u[3], v[3];
  conic_vector_at(estimate->tangent_u, point, u);
  conic_vector_at(estimate->tangent_v, point, v);
  double u2 = conic_dot(u, u), v2 = conic_dot(v, v);
  return sqrt(u2 > v2 ? u2 : v2);
}

static double spacing_at(const spread_work *work, size_t slot) {
  return work->neighbourhood->flags[slot] & CONIC_SLOT_LISTED ? work->spacings[slot] : 0.0;
}

static double dot_at(const spread_work *work, size_t slot) {
  size_t point = work->neighbourhood->tree.point_of_slot[slot];
  return is_spread(work->estimate, point) && work->estimate->dot[point] != 0.0f ? longer_axis(work->estimate, point)
                                                                                : 0.0;
}

/* The upper median of what some slots have that is above 0; without any, all there is. And the part that has some. */
static conic_status find_median(conic_context *context, const spread_work *work,
                                double (*value_at)(const spread_work *work, size_t slot), double *median,
                                double *part) {
  size_t n_slots = work->neighbourhood->tree.n_slots, stride = 1 + n_slots / MEDIAN_SAMPLES, n = 0;
  double *sorted = conic_memory_allocate(context, (size_t)2 * MEDIAN_SAMPLES, sizeof *sorted);
  if (!sorted)
    return CONIC_ERROR_MEMORY;
  for (size_t slot = 0; slot < n_slots; slot += stride)
    if ((sorted[n] = value_at(work, slot)) > 0.0)
      n++;
  qsort(sorted, n, sizeof *sorted, conic_compare_doubles);
  *median = n ? sorted[n / 2] : HUGE_VAL;
  *part = (double)n * (double)stride / (double)n_slots;
  conic_memory_release(context, sorted);
  return CONIC_OK;
}

static void measure_slots(void *data, size_t begin, size_t end) {
  const spread_work *work = data;
  for (size_t slot = begin; slot < end; slot++) {
    size_t point = work->neighbourhood->tree.point_of_slot[slot];
    work->lengths[slot] = is_spread(work->estimate, point) ? longer_axis(work->estimate, point) : -1.0;
  }
}

/* The part of its size to which the neighbours' sizes cut a slot's outline: 1 for most, of which counting is enough to
 * know that they do not exceed the upper median so far. */
static double part_left(const spread_work *work, size_t slot) {
  const conic_neighbourhood *neighbourhood = work->neighbourhood;
  const uint32_t *list = conic_neighbourhood_of(neighbourhood, slot);
  double lengths[CONIC_MAX_NEIGHBOURS + BLOCK], own = work->lengths[slot], most = HUGE_VAL;
  size_t n = 0, n_exceeded = 0;
  for (size_t i = 0; i < neighbourhood->n_neighbours; i++) {
    double length = work->lengths[list[i]];
    n += length >= 0.0;
    n_exceeded += (length >= 0.0) & (GREATEST_EXCESS * length < own);
  }
  if (n_exceeded > n / 2) {
    n = 0;
    for (size_t i = 0; i < neighbourhood->n_neighbours; i++)
      if (work->lengths[list[i]] >= 0.0)
        lengths[n++] = work->lengths[list[i]];
    for (size_t i = 0; i < BLOCK; i++)
      lengths[n + i] = 0.0;
    most = GREATEST_EXCESS * upper_median(lengths, n);
  }
  int is_dot = work->are_dots || work->estimate->dot[neighbourhood->tree.point_of_slot[slot]] != 0.0f;
  if (is_dot && most > GREATEST_DOT * work->usual_dot)
    most = GREATEST_DOT * work->usual_dot;
  return own > most ? most / own : 1.0;
}

static void compare_slots(void *data, size_t begin, size_t end) {
  const spread_work *work = data;
  for (size_t slot = begin; slot < end; slot++)
    work->spacings[slot] = work->lengths[slot] >= 0.0 ? part_left(work, slot) : 1.0;
}

static void cut_points(void *data, size_t begin, size_t end) {
  const spread_work *work = data;
  const conic_estimate *estimate = work->estimate;
  for (size_t point = begin; point < end; point++)
    if (is_spread(estimate, point)) {
      float part = (float)work->spacings[work->neighbourhood->tree.slot_of_point[point]];
      for (int axis = 0; axis < 3 && part < 1.0f; axis++) {
        estimate->tangent_u[axis][point] *= part;
        estimate->tangent_v[axis][point] *= part;
      }
    }
}

/* Bounds the outlines by their neighbours'; the spacings are used up. */
static conic_status bound_by_neighbours(conic_context *context, spread_work *work) {
  const conic_neighbours *tree = &work->neighbourhood->tree;
  const conic_team_column column = {work->spacings, sizeof *work->spacings};
  double part = 0.0;
  conic_status status = find_median(context, work, dot_at, &work->usual_dot, &part);
  work->are_dots = part > 0.5;
  work->lengths = conic_memory_allocate(context, tree->n_slots, sizeof *work->lengths);
  if (status == CONIC_OK)
    status =
        work->lengths ? conic_slots_for(context, tree->n_slots, measure_slots, work, 1.0, 1.0) : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK)
    status = conic_slots_share(context, tree->n_slots, compare_slots, work, 1.0, 1.0, &column, 1);
  conic_memory_release(context, work->lengths);
  return status == CONIC_OK ? conic_slots_for(context, tree->n_points, cut_points, work, 1.0, 1.0) : status;
}

conic_status conic_estimate_from_neighbours(conic_context *context, conic_estimate *estimate,
                                            /* NOLINTNEXTLINE(readability-non-const-parameter): threads write to it */
                                            const conic_neighbourhood *neighbourhood, double *spacings) {
  spread_work work = {estimate, neighbourhood, spacings, NULL, HUGE_VAL, HUGE_VAL, 0};
  double part;
  if (estimate->dot) {
    conic_status found = find_median(context, &work, spacing_at, &work.usual_reach, &part);
    work.usual_reach *= CELL_RADIUS;
    if (found != CONIC_OK)
      return found;
  }
  const uint32_t *points = neighbourhood->tree.point_of_slot;
  conic_team_column columns[8] = {{estimate->states, sizeof *estimate->states, points},
                                  {estimate->dot, sizeof(float), points}};
  for (int axis = 0; axis < 3; axis++) {
    columns[2 + axis] = (conic_team_column){estimate->tangent_u[axis], sizeof(float), points};
    columns[5 + axis] = (conic_team_column){estimate->tangent_v[axis], sizeof(float), points};
  }
  conic_status status =
      conic_slots_share(context, neighbourhood->tree.n_slots, spread_slots, &work, 0.7, 0.98, columns, 8);
  if (status == CONIC_OK && neighbourhood->tree.n_duplicates)
    status = conic_slots_for(context, neighbourhood->tree.n_points, spread_duplicates, &work, 0.98, 1.0);
  return status == CONIC_OK && estimate->dot ? bound_by_neighbours(context, &work) : status;
}
