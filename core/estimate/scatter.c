/* A slot's score says how little its neighbourhood is like a surface. The mean of the scores around it decides, so that
 * a leaf follows the leaves around it, and a sharp corner its faces. docs/notes/estimation.md has the measurements. */

#include "core/base/eigen.h"
#include "core/base/vectors.h"
#include "core/estimate/neighbourhood.h"

/* The scatter is the least eigenvalue of the covariance over the sum of the lesser two: 0 in a plane, 0.22 on a sharp
 * edge and in a cube's corner, about 0.4 where points fill a space or a stick, at most ½. It is taken of the
 * neighbours, where a bent surface has little, and of the neighbours' neighbours, where noisy surfaces and thin walls
 * have little. */
#define FULL_SCATTER 0.3
/* How little the neighbours' normals agree, 1 less the mean of |n · n'|: ½ for random ones. */
#define FULL_DISAGREEMENT 0.15
/* A score is the least of the three, relative to the full values; below LEAST_SCORE it counts as 0. */
#define LEAST_SCORE 0.25
#define GREATEST_SCORE 2.0
#define SCATTERED_SCORE 0.6
/* The neighbours make a line if the second eigenvalue is less than this part of the first: at most a seventh as wide as
 * long. Twice as many neighbours must make a line, too; else it is a scan line with others beside it. */
#define LINE_WIDTH2 0.02
/* How often scores are spread to the neighbours. */
#define N_MEANS 3

/* A dot's reach in spacings, which are the distances to the second neighbour; and the reach where too few points show a
 * surface: the corners of a cube are eight places, not a blob. */
#define DOT_REACH 0.65
#define LONE_REACH 0.12
enum { FEWEST_IN_SURFACE = 20 };

typedef struct scatter_work {
  conic_neighbourhood *neighbourhood;
  const float *from; /* a score each slot */
  float *to;
} scatter_work;

static int is_listed(const conic_neighbourhood *neighbourhood, size_t slot) {
  return (neighbourhood->flags[slot] & CONIC_SLOT_LISTED) != 0;
}

static double trace_of(const double matrix[6]) {
  return matrix[0] + matrix[3] + matrix[5];
}

/* By the sum of the products of two eigenvalues each, which the matrix gives without them. */
static int is_wire(const double m[6]) {
  double pairs = m[0] * m[3] - m[1] * m[1] + (m[0] * m[5] - m[2] * m[2]) + (m[3] * m[5] - m[4] * m[4]),
         trace = trace_of(m);
  return pairs < LINE_WIDTH2 * trace * trace;
}

/* A line by its neighbours. */
static int is_lone_line(const conic_neighbourhood *neighbourhood, size_t slot) {
  uint32_t slots[CONIC_MAX_NEIGHBOURS];
  double distances2[CONIC_MAX_NEIGHBOURS], matrix[6];
  size_t n = 2 * neighbourhood->n_neighbours;
  conic_covariance covariance = conic_covariance_about(neighbourhood, slot);
  n = conic_neighbours_nearest(&neighbourhood->tree, covariance.origin, (uint32_t)slot,
                               n < CONIC_MAX_NEIGHBOURS ? n : CONIC_MAX_NEIGHBOURS, HUGE_VAL, slots, distances2);
  conic_covariance_add(&covariance, neighbourhood, slots, n);
  conic_covariance_matrix(&covariance, matrix);
  return is_wire(matrix);
}

static double scatter_of(const double matrix[6]) {
  double values[3], vectors[3][3];
  conic_eigen3(matrix, values, vectors);
  return values[1] > 0.0 ? values[2] / (values[1] + values[2]) : 0.0;
}

/* Adds the neighbours' neighbours, as often as they occur. */
static void add_second_ring(const conic_neighbourhood *neighbourhood, size_t slot, conic_covariance *covariance) {
  const uint32_t *list = conic_neighbourhood_of(neighbourhood, slot);
  for (size_t i = 0; i < neighbourhood->n_neighbours; i++)
    if (is_listed(neighbourhood, list[i]))
      conic_covariance_add(covariance, neighbourhood, conic_neighbourhood_of(neighbourhood, list[i]),
                           neighbourhood->n_neighbours);
}

static double disagreement_of(const conic_neighbourhood *neighbourhood, size_t slot) {
  const uint32_t *list = conic_neighbourhood_of(neighbourhood, slot);
  const float *own = neighbourhood->normals[slot];
  double sum = 0.0;
  for (size_t i = 0; i < neighbourhood->n_neighbours; i++) {
    const float *other = neighbourhood->normals[list[i]];
    sum +=
        fabs((double)own[0] * (double)other[0] + (double)own[1] * (double)other[1] + (double)own[2] * (double)other[2]);
  }
  return 1.0 - sum / (double)neighbourhood->n_neighbours;
}

static double least(double a, double b) {
  return a < b ? a : b;
}

static double score_of(const conic_neighbourhood *neighbourhood, size_t slot) {
  double matrix[6];
  conic_covariance covariance = conic_covariance_about(neighbourhood, slot), wider = covariance;
  conic_covariance_add(&covariance, neighbourhood, conic_neighbourhood_of(neighbourhood, slot),
                       neighbourhood->n_neighbours);
  conic_covariance_matrix(&covariance, matrix);
  if (is_wire(matrix))
    return is_lone_line(neighbourhood, slot) ? GREATEST_SCORE : 0.0;
  double score = least(disagreement_of(neighbourhood, slot) / FULL_DISAGREEMENT, GREATEST_SCORE);
  if (score >= LEAST_SCORE)
    score = least(score, scatter_of(matrix) / FULL_SCATTER);
  if (!(score >= LEAST_SCORE))
    return 0.0;
  add_second_ring(neighbourhood, slot, &wider);
  conic_covariance_matrix(&wider, matrix);
  score = least(score, scatter_of(matrix) / FULL_SCATTER);
  return score >= LEAST_SCORE ? score : 0.0;
}

static void score_slots(void *data, size_t begin, size_t end) {
  const scatter_work *work = data;
  for (size_t slot = begin; slot < end; slot++)
    work->to[slot] = (float)(is_listed(work->neighbourhood, slot) ? score_of(work->neighbourhood, slot) : 0.0);
}

/* The mean over the slot and its LISTED neighbours. */
static void average_slots(void *data, size_t begin, size_t end) {
  const scatter_work *work = data;
  for (size_t slot = begin; slot < end; slot++) {
    const uint32_t *list = conic_neighbourhood_of(work->neighbourhood, slot);
    double sum = (double)work->from[slot], n = 1.0;
    for (size_t i = 0; is_listed(work->neighbourhood, slot) && i < work->neighbourhood->n_neighbours; i++)
      if (is_listed(work->neighbourhood, list[i])) {
        sum += (double)work->from[list[i]];
        n += 1.0;
      }
    work->to[slot] = (float)(sum / n);
  }
}

static conic_status find_with(conic_context *context, scatter_work *work, float *scores[2], double from, double to) {
  conic_neighbourhood *neighbourhood = work->neighbourhood;
  size_t n_slots = neighbourhood->tree.n_slots;
  work->to = scores[0];
  if (n_slots < FEWEST_IN_SURFACE) {
    for (size_t slot = 0; slot < n_slots; slot++)
      if (is_listed(neighbourhood, slot))
        neighbourhood->flags[slot] |= CONIC_SLOT_SCATTERED;
    return CONIC_OK;
  }
  const conic_team_column column = {work->to, sizeof *work->to};
  conic_status status = conic_slots_share(context, n_slots, score_slots, work, from, to, &column, 1);
  for (int i = 0; i < N_MEANS && status == CONIC_OK; i++) {
    work->from = scores[i % 2];
    work->to = scores[1 - i % 2];
    status = conic_slots_for(context, n_slots, average_slots, work, to, to);
  }
  for (size_t slot = 0; slot < n_slots && status == CONIC_OK; slot++)
    if ((double)work->to[slot] > SCATTERED_SCORE)
      neighbourhood->flags[slot] |= CONIC_SLOT_SCATTERED;
  return status;
}

conic_status conic_scatter_find(conic_context *context, conic_neighbourhood *neighbourhood, double from, double to) {
  size_t n_slots = neighbourhood->tree.n_slots;
  scatter_work work = {neighbourhood, NULL, NULL};
  float *scores[2];
  if (neighbourhood->n_neighbours == 0)
    return CONIC_OK;
  conic_status status =
      conic_memory_allocate_these(context, CONIC_ROOM(scores[0], n_slots), CONIC_ROOM(scores[1], n_slots));
  if (status == CONIC_OK)
    status = find_with(context, &work, scores, from, to);
  conic_memory_release_these(context, scores[0], scores[1]);
  return status;
}

/* --- the shape of a dot --- */

static double spacing_about(const conic_neighbourhood *neighbourhood, size_t slot) {
  const uint32_t *list = conic_neighbourhood_of(neighbourhood, slot);
  double position[3];
  conic_neighbourhood_position(neighbourhood, slot, position);
  return sqrt(conic_neighbours_distance2(&neighbourhood->tree, list[neighbourhood->n_neighbours > 1], position));
}

/* So few points must be visible where the picture shows all of them: their dots are at least a hundredth of their
 * extent. */
static double lone_reach(const conic_neighbourhood *neighbourhood, size_t slot, double spacing) {
  static const double least_part = 0.005;
  double position[3], farthest2 = 0.0;
  conic_neighbourhood_position(neighbourhood, slot, position);
  for (uint32_t other = 0; other < neighbourhood->tree.n_slots; other++) {
    double distance2 = conic_neighbours_distance2(&neighbourhood->tree, other, position);
    farthest2 = distance2 > farthest2 ? distance2 : farthest2;
  }
  double reach = LONE_REACH * spacing, least = least_part * sqrt(farthest2);
  return reach > least ? reach : least;
}

double conic_scatter_reach(const conic_neighbourhood *neighbourhood, size_t slot) {
  const uint32_t *list = conic_neighbourhood_of(neighbourhood, slot);
  double sorted[CONIC_MAX_NEIGHBOURS + 1];
  size_t n = 0;
  sorted[0] = 0.0;
  for (size_t i = 0; i <= neighbourhood->n_neighbours; i++) {
    size_t other = i ? list[i - 1] : slot, at = n;
    if (!is_listed(neighbourhood, other))
      continue;
    double value = spacing_about(neighbourhood, other);
    for (; at > 0 && sorted[at - 1] > value; at--)
      sorted[at] = sorted[at - 1];
    sorted[at] = value;
    n++;
  }
  return neighbourhood->tree.n_slots < FEWEST_IN_SURFACE ? lone_reach(neighbourhood, slot, sorted[n / 2])
                                                         : DOT_REACH * sorted[n / 2];
}

void conic_scatter_outside(const conic_neighbourhood *neighbourhood, size_t slot, double normal[3]) {
  conic_covariance wider = conic_covariance_about(neighbourhood, slot);
  add_second_ring(neighbourhood, slot, &wider);
  for (int axis = 0; axis < 3; axis++)
    normal[axis] = -wider.sum[axis];
  conic_normalize(normal);
}
