/* How far leaves reach from a node, in lanes of doubles. Leaves are taken in batches of the same size whatever the
 * lanes, so that all give the same. */
#include <math.h>
#include <string.h>

#include "core/lanes/lanes_double.h"
#include "lod/octree/octree_loops.h"
#include "lod/octree/outline_corners.h"

CONIC_INLINE double wide_greatest(wide a) {
  double all[CONIC_WIDE_LANES], greatest;
  memcpy(all, &a, sizeof all);
  greatest = all[0];
  for (int i = 1; i < CONIC_WIDE_LANES; i++)
    greatest = all[i] > greatest ? all[i] : greatest;
  return greatest;
}

CONIC_INLINE wide dot_wide(const wide a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

CONIC_INLINE wide product_wide(const wide a[3], const wide b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Leaves in a node's frame. */
typedef struct wide_leaf {
  wide p[3], u[3], v[3]; /* from the node's position */
  wide_mask is_there;
} wide_leaf;

/* Whether (a + b)² ≤ (1 + 1/8) a² + (1 + 8) b² is no more than c². */
CONIC_INLINE wide_mask is_within(wide a2, wide b2, double c) {
  return a2 * 1.125 + b2 * 9.0 <= wide_of(c * c);
}

/* In the plane, stretched so that the node's ellipse is a circle: how far the outlines are from the middle. */
CONIC_INLINE void add_outline(const wide_leaf *leaf, double cutoff, const conic_node_frame *frame,
                              const conic_leaf_reach *before, conic_leaf_reach *reach) {
  const double across = 1.0 / frame->ratio;
  wide x = dot_wide(leaf->p, frame->u), y = dot_wide(leaf->p, frame->v) * across;
  wide ux = dot_wide(leaf->u, frame->u), uy = dot_wide(leaf->u, frame->v) * across;
  wide vx = dot_wide(leaf->v, frame->u), vy = dot_wide(leaf->v, frame->v) * across;
  wide square = x * x + y * y, greatest2 = {0};
  wide square_out = cutoff * cutoff * (ux * ux + uy * uy + vx * vx + vy * vy);
  wide_mask may_widen = leaf->is_there & ~is_within(square, square_out, before->reach);
  if (!wide_any(may_widen))
    return;
  for (int k = 0; k < CONIC_OUTLINE_CORNERS; k++) {
    wide a = cutoff * (conic_corners_x[k] * ux + conic_corners_y[k] * vx),
         b = cutoff * (conic_corners_x[k] * uy + conic_corners_y[k] * vy);
    greatest2 = wide_max(square + (a * a + b * b) + 2.0 * wide_absolute(a * x + b * y), greatest2);
  }
  double greatest = sqrt(wide_greatest(wide_select(may_widen, greatest2, (wide){0})));
  reach->reach = greatest > reach->reach ? greatest : reach->reach;
}

CONIC_INLINE void add_radius(const wide_leaf *leaf, double cutoff, const conic_leaf_reach *before,
                             conic_leaf_reach *reach) {
  wide square = product_wide(leaf->p, leaf->p), uu = product_wide(leaf->u, leaf->u);
  wide vv = product_wide(leaf->v, leaf->v), uv = product_wide(leaf->u, leaf->v);
  wide_mask may_widen = leaf->is_there & ~is_within(square, cutoff * cutoff * (uu + vv), before->radius);
  if (!wide_any(may_widen))
    return;
  wide longest2 = 0.5 * (uu + vv + wide_sqrt((uu - vv) * (uu - vv) + 4.0 * uv * uv));
  wide radius = wide_sqrt(square) + cutoff * wide_sqrt(longest2);
  double greatest = wide_greatest(wide_select(may_widen, radius, (wide){0}));
  reach->radius = greatest > reach->radius ? greatest : reach->radius;
}

CONIC_INLINE void add_height(const wide_leaf *leaf, double cutoff, const double n[3], const conic_leaf_reach *before,
                             conic_leaf_reach *reach) {
  wide z = dot_wide(leaf->p, n), uz = dot_wide(leaf->u, n), vz = dot_wide(leaf->v, n);
  wide square = cutoff * cutoff * (uz * uz + vz * vz);
  wide_mask may_widen = leaf->is_there & ~is_within(z * z, square, before->height);
  if (!wide_any(may_widen))
    return;
  wide height = wide_absolute(z) + wide_sqrt(square);
  double greatest = wide_greatest(wide_select(may_widen, height, (wide){0}));
  reach->height = greatest > reach->height ? greatest : reach->height;
}

CONIC_INLINE void add_normal(const wide_leaf *leaf, const double n[3], const conic_leaf_reach *before,
                             conic_leaf_reach *reach) {
  const wide *u = leaf->u, *v = leaf->v;
  const wide normal[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
  wide along = dot_wide(normal, n), square = product_wide(normal, normal);
  wide_mask is_in = (along > 0.0) & (along * along > square * (before->cosine * fabs(before->cosine)));
  wide_mask may_widen = leaf->is_there & ~is_in;
  if (!wide_any(may_widen))
    return;
  double least = -wide_greatest(wide_select(may_widen, -along / wide_sqrt(square), wide_of(-1.0)));
  reach->cosine = least < reach->cosine ? least : reach->cosine;
}

/* A batch of n leaves, or of the first of as many as one has. */
CONIC_INLINE void add_batch(const float *const columns[9], size_t n, double cutoff, const conic_node_frame *frame,
                            conic_leaf_reach *reach) {
  static const int64_t places[CONIC_REACH_BATCH] = {0, 1, 2, 3, 4, 5, 6, 7};
  const conic_leaf_reach before = *reach;
  for (size_t part = 0; part < n; part += CONIC_WIDE_LANES) {
    wide_leaf leaf;
    wide_mask place;
    memcpy(&place, places + part, sizeof place);
    leaf.is_there = place < (int64_t)n - (wide_mask){0};
    for (int axis = 0; axis < 3; axis++) {
      leaf.p[axis] = wide_load_floats(columns[axis] + part) - frame->position[axis];
      leaf.u[axis] = wide_load_floats(columns[3 + axis] + part);
      leaf.v[axis] = wide_load_floats(columns[6 + axis] + part);
    }
    add_outline(&leaf, cutoff, frame, &before, reach);
    add_radius(&leaf, cutoff, &before, reach);
    add_height(&leaf, cutoff, frame->n, &before, reach);
    add_normal(&leaf, frame->n, &before, reach);
  }
}

static void add_reach(const conic_splats *leaves, size_t begin, size_t end, double cutoff,
                      const conic_node_frame *frame, conic_leaf_reach *reach) {
  float *const *const vectors[3] = {leaves->position, leaves->tangent_u, leaves->tangent_v};
  float last[9][CONIC_REACH_BATCH];
  const float *columns[9];
  for (size_t first = begin; first < end; first += CONIC_REACH_BATCH) {
    size_t n = end - first < CONIC_REACH_BATCH ? end - first : CONIC_REACH_BATCH;
    for (int k = 0; k < 9; k++) {
      columns[k] = vectors[k / 3][k % 3] + first;
      if (leaves->count - first < CONIC_REACH_BATCH) { /* there is nothing to load behind the last */
        for (size_t i = 0; i < CONIC_REACH_BATCH; i++)
          last[k][i] = columns[k][i < n ? i : n - 1];
        columns[k] = last[k];
      }
    }
    add_batch(columns, n, cutoff, frame, reach);
  }
}

/* The squares of where the corners of leaf i's outline lie along and across the direction `major` in u, v. */
CONIC_INLINE void place_corners(const conic_splats *leaves, size_t i, double cutoff, const double place[3],
                                const double u[3], const double v[3], const double major[2], float *x2, float *y2) {
  double flat[3][2];
  for (int part = 0; part < 3; part++) {
    double along_u = 0.0, along_v = 0.0;
    for (int axis = 0; axis < 3; axis++) {
      double value = part == 0   ? (double)leaves->position[axis][i] - place[axis]
                     : part == 1 ? (double)leaves->tangent_u[axis][i]
                                 : (double)leaves->tangent_v[axis][i];
      along_u += value * u[axis];
      along_v += value * v[axis];
    }
    flat[part][0] = major[0] * along_u + major[1] * along_v;
    flat[part][1] = major[0] * along_v - major[1] * along_u;
  }
  for (int k = 0; k < CONIC_OUTLINE_CORNERS; k += CONIC_WIDE_LANES) {
    wide cx, cy;
    memcpy(&cx, conic_corners_x + k, sizeof cx);
    memcpy(&cy, conic_corners_y + k, sizeof cy);
    wide x = cutoff * (cx * flat[1][0] + cy * flat[2][0]), y = cutoff * (cx * flat[1][1] + cy * flat[2][1]);
    wide x_before = flat[0][0] - x, x_after = flat[0][0] + x, y_before = flat[0][1] - y, y_after = flat[0][1] + y;
    wide_floats squares[4] = {__builtin_convertvector(x_before * x_before, wide_floats),
                              __builtin_convertvector(x_after * x_after, wide_floats),
                              __builtin_convertvector(y_before * y_before, wide_floats),
                              __builtin_convertvector(y_after * y_after, wide_floats)};
    memcpy(x2 + k, &squares[0], sizeof squares[0]);
    memcpy(x2 + CONIC_OUTLINE_CORNERS + k, &squares[1], sizeof squares[1]);
    memcpy(y2 + k, &squares[2], sizeof squares[2]);
    memcpy(y2 + CONIC_OUTLINE_CORNERS + k, &squares[3], sizeof squares[3]);
  }
}

static double choose_ratio(const conic_splats *leaves, size_t begin, size_t end, double cutoff, const double place[3],
                           const double u[3], const double v[3], const conic_ellipse *shape, double least_ratio) {
  float x2[2 * CONIC_OUTLINE_CORNERS * CONIC_FEW_LEAVES], y2[2 * CONIC_OUTLINE_CORNERS * CONIC_FEW_LEAVES],
      best_area = HUGE_VALF;
  double best = shape->ratio, ratios[CONIC_N_RATIOS];
  float across2[CONIC_N_RATIOS];
  lanes greatest[CONIC_N_RATIOS];
  size_t n = 2 * CONIC_OUTLINE_CORNERS * (end - begin);
  for (size_t i = begin; i < end; i++)
    place_corners(leaves, i, cutoff, place, u, v, shape->major, x2 + 2 * CONIC_OUTLINE_CORNERS * (i - begin),
                  y2 + 2 * CONIC_OUTLINE_CORNERS * (i - begin));
  for (int k = 0; k < CONIC_N_RATIOS; k++) {
    double ratio = conic_ratio_factors[k] * shape->ratio;
    ratios[k] = ratio > 1.0 ? 1.0 : ratio < least_ratio ? least_ratio : ratio;
    across2[k] = (float)(1.0 / (ratios[k] * ratios[k]));
    greatest[k] = lanes_of(0.0f);
  }
  for (size_t i = 0; i < n; i += CONIC_LANES)
    for (int k = 0; k < CONIC_N_RATIOS; k++)
      greatest[k] = lanes_max(lanes_load(x2 + i) + lanes_load(y2 + i) * across2[k], greatest[k]);
  for (int k = 0; k < CONIC_N_RATIOS; k++) {
    float area = greatest_of(greatest[k]) * (float)ratios[k];
    if (area < best_area) {
      best_area = area;
      best = ratios[k];
    }
  }
  return best;
}
