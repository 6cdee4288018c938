#include "lod/layers/format/layers_groups.h"

#include "core/base/base.h"
#include "core/base/eigen.h"
#include "core/base/vectors.h"
#include "lod/layers/format/layers_axes.h"
#include "lod/layers/format/layers_key.h"

/* Sums are of whole numbers, and so do not depend on the order of the members. */
static void measure_group(const conic_layers_grouping *g, conic_layers_group *group) {
  uint32_t low[3] = {UINT32_MAX, UINT32_MAX, UINT32_MAX};
  uint64_t sum[3] = {0, 0, 0}, squares[3] = {0, 0, 0}, n = group->end - group->begin;
  double most = -1.0;
  for (uint32_t i = group->begin; i < group->end; i++)
    for (int axis = 0; axis < 3; axis++)
      low[axis] = g->steps[g->order[i]][axis] < low[axis] ? g->steps[g->order[i]][axis] : low[axis];
  for (uint32_t i = group->begin; i < group->end; i++)
    for (int axis = 0; axis < 3; axis++) {
      uint64_t along = g->steps[g->order[i]][axis] - low[axis];
      sum[axis] += along;
      squares[axis] += along * along;
    }
  group->spread = 0.0;
  for (int axis = 0; axis < 3; axis++) {
    double spread = (double)squares[axis] - (double)sum[axis] * (double)sum[axis] / (double)n;
    group->spread += spread;
    if (!(spread > most))
      continue;
    most = spread;
    group->axis = axis;
    group->limit = sum[axis] + n * low[axis];
  }
}

conic_status conic_layers_grouping_reserve(conic_context *context, conic_layers_grouping *g, size_t n) {
  if (n <= g->room)
    return CONIC_OK;
  conic_layers_grouping_release(context, g);
  conic_status status = conic_memory_allocate_these(context, CONIC_ROOM(g->steps, n), CONIC_ROOM(g->order, n),
                                                    CONIC_ROOM(g->spare, n), CONIC_ROOM(g->groups, n));
  g->room = status == CONIC_OK ? n : 0;
  return status;
}

conic_status conic_layers_group_all(conic_context *context, conic_layers_grouping *g, const uint64_t *keys, size_t n) {
  conic_status status = conic_layers_grouping_reserve(context, g, n);
  if (status != CONIC_OK)
    return status;
  for (uint32_t i = 0; i < n; i++) {
    g->order[i] = i;
    for (int axis = 0; axis < 3; axis++)
      g->steps[i][axis] = conic_layers_step(keys[i], axis);
  }
  g->n = n;
  g->n_groups = n > 0;
  if (n > 0) {
    g->groups[0] = (conic_layers_group){.begin = 0, .end = (uint32_t)n};
    measure_group(g, &g->groups[0]);
  }
  return CONIC_OK;
}

void conic_layers_grouping_release(conic_context *context, conic_layers_grouping *g) {
  conic_memory_release_these(context, g->steps, g->order, g->spare, g->groups);
  *g = (conic_layers_grouping){.n = 0};
}

static int goes_before(const conic_layers_grouping *g, const conic_layers_group *a, const conic_layers_group *b) {
  return a->spread > b->spread || (a->spread == b->spread && g->order[a->begin] < g->order[b->begin]);
}

/* Puts a group where the heap has a place that is free, or moves it farther down. */
static void sink_group(conic_layers_grouping *g, size_t at, conic_layers_group group) {
  for (size_t child = 2 * at + 1; child < g->n_groups; child = 2 * at + 1) {
    if (child + 1 < g->n_groups && goes_before(g, &g->groups[child + 1], &g->groups[child]))
      child++;
    if (!goes_before(g, &g->groups[child], &group))
      break;
    g->groups[at] = g->groups[child];
    at = child;
  }
  g->groups[at] = group;
}

static void raise_group(conic_layers_grouping *g, conic_layers_group group) {
  size_t at = g->n_groups++;
  for (; at > 0 && goes_before(g, &group, &g->groups[(at - 1) / 2]); at = (at - 1) / 2)
    g->groups[at] = g->groups[(at - 1) / 2];
  g->groups[at] = group;
}

void conic_layers_part_groups(conic_layers_grouping *g, size_t n_groups) {
  while (g->n_groups > 0 && g->n_groups < n_groups && g->groups[0].spread > 0.0) {
    conic_layers_group group = g->groups[0], first = group, second = group;
    uint64_t n = group.end - group.begin;
    uint32_t at = group.begin, n_second = 0;
    for (uint32_t i = group.begin; i < group.end; i++)
      if (n * g->steps[g->order[i]][group.axis] <= group.limit)
        g->order[at++] = g->order[i];
      else
        g->spare[n_second++] = g->order[i];
    memcpy(g->order + at, g->spare, n_second * sizeof *g->spare);
    first.end = second.begin = at;
    measure_group(g, &first);
    measure_group(g, &second);
    sink_group(g, 0, first);
    raise_group(g, second);
  }
}

static int compare_groups(const void *a, const void *b) {
  const conic_layers_group *first = a, *second = b;
  return (first->limit > second->limit) - (first->limit < second->limit);
}

void conic_layers_sort_groups(conic_layers_grouping *g) {
  for (size_t i = 0; i < g->n_groups; i++)
    g->groups[i].limit = g->order[g->groups[i].begin];
  qsort(g->groups, g->n_groups, sizeof *g->groups, compare_groups);
}

/* Means are weighed by area. Normals without a side, and those that would cancel, count as if they were on the side of
 * the first. */
static void find_mean(const conic_layers_disc *members, const uint32_t *list, size_t n, int turns, double center[3],
                      double normal[3], double *weight) {
  const conic_layers_disc *first = &members[list[0]];
  double way[3] = {0.0, 0.0, 0.0};
  memset(normal, 0, 3 * sizeof *normal);
  *weight = 0.0;
  for (size_t i = 0; i < n; i++) {
    const conic_layers_disc *m = &members[list[i]];
    double w = (double)m->radius * (double)m->radius + 1e-30, along = 0.0;
    for (int axis = 0; axis < 3; axis++)
      along += (double)m->normal[axis] * (double)first->normal[axis];
    *weight += w;
    for (int axis = 0; axis < 3; axis++) {
      way[axis] += w * ((double)m->center[axis] - (double)first->center[axis]);
      normal[axis] += (turns && along < 0.0 ? -w : w) * (double)m->normal[axis];
    }
  }
  for (int axis = 0; axis < 3; axis++)
    center[axis] = (double)first->center[axis] + way[axis] / *weight;
}

/* A member on the plane of an ellipse that has these unit axes. */
static void flatten(const conic_layers_disc *ellipse, const conic_layers_disc *member, const float u[3],
                    const float v[3], double *x, double *y) {
  *x = *y = 0.0;
  for (int axis = 0; axis < 3; axis++) {
    double way = (double)member->center[axis] - (double)ellipse->center[axis];
    *x += way * (double)u[axis];
    *y += way * (double)v[axis];
  }
}

/* How much larger the ellipse of these half axes has to be to hold a disc: its 16 corners, of which the farthest is in
 * the quarter of the disc's middle. */
static double scale_for(double x, double y, double radius, const double half[2]) {
  static const double corners[5][2] = {
      {1.0, 0.0}, {0.92387953, 0.38268343}, {0.70710678, 0.70710678}, {0.38268343, 0.92387953}, {0.0, 1.0}};
  double most2 = 0.0;
  for (int i = 0; i < 5; i++) {
    double a = (fabs(x) + radius * corners[i][0]) / half[0], b = (fabs(y) + radius * corners[i][1]) / half[1];
    most2 = a * a + b * b > most2 ? a * a + b * b : most2;
  }
  return most2;
}

static void turn_axes(const double major[2], float u[3], float v[3]) {
  for (int axis = 0; axis < 3; axis++) {
    double along = major[0] * (double)u[axis] + major[1] * (double)v[axis];
    v[axis] = (float)(major[0] * (double)v[axis] - major[1] * (double)u[axis]);
    u[axis] = (float)along;
  }
}

/* The major half axis of the ellipse of this ratio that holds all members. */
static double reach_of(const conic_layers_disc *members, const uint32_t *list, size_t n, const float u[3],
                       const float v[3], double ratio, const conic_layers_disc *ellipse) {
  const double half[2] = {1.0, ratio};
  double most2 = 0.0, x, y;
  for (size_t i = 0; i < n; i++) {
    flatten(ellipse, &members[list[i]], u, v, &x, &y);
    double scale2 = scale_for(x, y, (double)members[list[i]].radius, half);
    most2 = scale2 > most2 ? scale2 : most2;
  }
  return sqrt(most2);
}

/* Of few members, the covariance tells little of the ratio: the one near it is taken whose ellipse is the smallest. */
static void choose_ratio(const conic_layers_disc *members, const uint32_t *list, size_t n, const float u[3],
                         const float v[3], double ratio, conic_layers_disc *ellipse) {
  static const double factors[] = {1.0, 0.9, 1.1, 0.8, 1.2, 0.65, 1.4};
  double least = HUGE_VAL;
  for (size_t i = 0; i < (n <= 16 ? sizeof factors / sizeof *factors : 1); i++) {
    double tried = factors[i] * ratio < 1.0 ? factors[i] * ratio : 1.0;
    double reach = reach_of(members, list, n, u, v, tried, ellipse);
    if (!(reach * reach * tried < least))
      continue;
    least = reach * reach * tried;
    ellipse->longer = (float)reach;
    ellipse->radius = (float)(reach * tried);
  }
}

static void fit_axes(const conic_layers_disc *members, const uint32_t *list, size_t n, double weight,
                     conic_layers_disc *ellipse) {
  double xx = 0.0, xy = 0.0, yy = 0.0, x, y, values[2], major[2];
  float u[3], v[3];
  conic_layers_frame(ellipse->normal, u, v);
  for (size_t i = 0; i < n; i++) {
    double r = (double)members[list[i]].radius, w = r * r + 1e-30;
    flatten(ellipse, &members[list[i]], u, v, &x, &y);
    xx += w * (x * x + 0.25 * r * r);
    xy += w * x * y;
    yy += w * (y * y + 0.25 * r * r);
  }
  conic_eigen2(xx / weight, xy / weight, yy / weight, values, major);
  turn_axes(major, u, v);
  double ratio = values[1] > 0.01 * values[0] ? sqrt(values[1] / values[0]) : values[0] > 0.0 ? 0.1 : 1.0;
  choose_ratio(members, list, n, u, v, ratio, ellipse);
  memcpy(ellipse->major, u, sizeof u);
}

void conic_layers_fit_group(const conic_layers_grouping *g, const conic_layers_group *group,
                            const conic_layers_disc *members, int is_unoriented, conic_layers_disc *ellipse) {
  const uint32_t *list = g->order + group->begin;
  size_t n = group->end - group->begin;
  double center[3], normal[3], weight, length;
  *ellipse = members[list[0]];
  if (n == 1)
    return;
  find_mean(members, list, n, is_unoriented, center, normal, &weight);
  if (conic_length(normal) < 0.1 * weight)
    find_mean(members, list, n, 1, center, normal, &weight);
  length = conic_length(normal);
  for (int axis = 0; axis < 3; axis++) {
    ellipse->center[axis] = (float)center[axis];
    ellipse->normal[axis] = length > 0.0 ? (float)(normal[axis] / length) : ellipse->normal[axis];
  }
  fit_axes(members, list, n, weight, ellipse);
}

void conic_layers_disc_axes(const conic_layers_disc *disc, float u[3], float v[3]) {
  const float *n = disc->normal, *m = disc->major;
  if (!(disc->longer > disc->radius)) {
    conic_layers_frame(n, u, v);
    return;
  }
  for (int axis = 0; axis < 3; axis++) {
    int next = (axis + 1) % 3, last = (axis + 2) % 3;
    u[axis] = m[axis];
    v[axis] = n[next] * m[last] - n[last] * m[next];
  }
}
