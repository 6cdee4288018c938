/* How far leaves reach from a node, in lanes of doubles: ADD_REACH and CHOOSE_RATIO are the functions' names. Leaves
 * are taken in batches of the same size whatever the lanes, so that all give the same. */
#include <math.h>
#include <string.h>

#include "core/lanes/lanes.h"
#include "lod/octree/octree_kernels.h"

#if defined(__AVX512F__)
enum { WIDE = 8 };
#elif defined(__AVX2__)
enum { WIDE = 4 };
#else
enum { WIDE = 2 };
#endif

typedef double wide __attribute__((vector_size(8 * WIDE)));
typedef int64_t wide_mask __attribute__((vector_size(8 * WIDE)));
typedef float narrow __attribute__((vector_size(4 * WIDE)));

enum { REACH_BATCH = 8 };

/* An outline is held by the polygon of 16 corners around it: eight, and eight opposite. */
enum { CORNERS = 8 };
static const double corners_x[CORNERS] = {
    1.0195911582083184,  0.9419794021690183,  0.7209598220069479, 0.3901806440322565, 0.0,
    -0.3901806440322565, -0.7209598220069479, -0.9419794021690183};
static const double corners_y[CORNERS] = {0.0,
                                          0.3901806440322565,
                                          0.7209598220069479,
                                          0.9419794021690183,
                                          1.0195911582083184,
                                          0.9419794021690183,
                                          0.7209598220069479,
                                          0.3901806440322565};

CONIC_INLINE int wide_any(wide_mask mask) {
#if defined(__AVX512F__)
  return _mm512_movepi64_mask((__m512i)mask) != 0;
#elif defined(__AVX2__)
  return _mm256_movemask_pd((__m256d)mask) != 0;
#elif defined(__SSE2__)
  return _mm_movemask_pd((__m128d)mask) != 0;
#else
  return (mask[0] | mask[1]) != 0;
#endif
}

CONIC_INLINE wide wide_sqrt(wide a) {
#if defined(__AVX512F__)
  return (wide)_mm512_sqrt_pd((__m512d)a);
#elif defined(__AVX2__)
  return (wide)_mm256_sqrt_pd((__m256d)a);
#elif defined(__SSE2__)
  return (wide)_mm_sqrt_pd((__m128d)a);
#else
  return (wide){sqrt(a[0]), sqrt(a[1])};
#endif
}

CONIC_INLINE wide wide_select(wide_mask mask, wide yes, wide no) {
  return (wide)((mask & (wide_mask)yes) | (~mask & (wide_mask)no));
}

CONIC_INLINE wide wide_absolute(wide a) {
  return (wide)((wide_mask)a & INT64_MAX);
}

CONIC_INLINE wide wide_max(wide a, wide b) {
  return wide_select(a > b, a, b);
}

CONIC_INLINE double wide_greatest(wide a) {
  double all[WIDE], greatest;
  memcpy(all, &a, sizeof all);
  greatest = all[0];
  for (int i = 1; i < WIDE; i++)
    greatest = all[i] > greatest ? all[i] : greatest;
  return greatest;
}

CONIC_INLINE wide wide_of(double value) {
  return value - (wide){0};
}

CONIC_INLINE wide load_wide(const float *from) {
  narrow value;
  memcpy(&value, from, sizeof value);
  return __builtin_convertvector(value, wide);
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
  for (int k = 0; k < CORNERS; k++) {
    wide a = cutoff * (corners_x[k] * ux + corners_y[k] * vx), b = cutoff * (corners_x[k] * uy + corners_y[k] * vy);
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
  static const int64_t places[REACH_BATCH] = {0, 1, 2, 3, 4, 5, 6, 7};
  const conic_leaf_reach before = *reach;
  for (size_t part = 0; part < n; part += WIDE) {
    wide_leaf leaf;
    wide_mask place;
    memcpy(&place, places + part, sizeof place);
    leaf.is_there = place < (int64_t)n - (wide_mask){0};
    for (int axis = 0; axis < 3; axis++) {
      leaf.p[axis] = load_wide(columns[axis] + part) - frame->position[axis];
      leaf.u[axis] = load_wide(columns[3 + axis] + part);
      leaf.v[axis] = load_wide(columns[6 + axis] + part);
    }
    add_outline(&leaf, cutoff, frame, &before, reach);
    add_radius(&leaf, cutoff, &before, reach);
    add_height(&leaf, cutoff, frame->n, &before, reach);
    add_normal(&leaf, frame->n, &before, reach);
  }
}

void ADD_REACH(const conic_splats *leaves, size_t begin, size_t end, double cutoff, const conic_node_frame *frame,
               conic_leaf_reach *reach) {
  float *const *const vectors[3] = {leaves->position, leaves->tangent_u, leaves->tangent_v};
  float last[9][REACH_BATCH];
  const float *columns[9];
  for (size_t first = begin; first < end; first += REACH_BATCH) {
    size_t n = end - first < REACH_BATCH ? end - first : REACH_BATCH;
    for (int k = 0; k < 9; k++) {
      columns[k] = vectors[k / 3][k % 3] + first;
      if (leaves->count - first < REACH_BATCH) { /* there is nothing to load behind the last */
        for (size_t i = 0; i < REACH_BATCH; i++)
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
  for (int k = 0; k < CORNERS; k += WIDE) {
    wide cx, cy;
    memcpy(&cx, corners_x + k, sizeof cx);
    memcpy(&cy, corners_y + k, sizeof cy);
    wide x = cutoff * (cx * flat[1][0] + cy * flat[2][0]), y = cutoff * (cx * flat[1][1] + cy * flat[2][1]);
    wide x_before = flat[0][0] - x, x_after = flat[0][0] + x, y_before = flat[0][1] - y, y_after = flat[0][1] + y;
    narrow squares[4] = {
        __builtin_convertvector(x_before * x_before, narrow), __builtin_convertvector(x_after * x_after, narrow),
        __builtin_convertvector(y_before * y_before, narrow), __builtin_convertvector(y_after * y_after, narrow)};
    memcpy(x2 + k, &squares[0], sizeof squares[0]);
    memcpy(x2 + CORNERS + k, &squares[1], sizeof squares[1]);
    memcpy(y2 + k, &squares[2], sizeof squares[2]);
    memcpy(y2 + CORNERS + k, &squares[3], sizeof squares[3]);
  }
}

double CHOOSE_RATIO(const conic_splats *leaves, size_t begin, size_t end, double cutoff, const double place[3],
                    const double u[3], const double v[3], const conic_ellipse *shape, double least_ratio) {
  enum { N_RATIOS = 9 };
  static const double factors[N_RATIOS] = {0.5, 0.59, 0.68, 0.77, 0.86, 1.0, 1.15, 1.3, 1.5};
  float x2[2 * CORNERS * CONIC_FEW_LEAVES], y2[2 * CORNERS * CONIC_FEW_LEAVES], best_area = HUGE_VALF;
  double best = shape->ratio, ratios[N_RATIOS];
  float across2[N_RATIOS];
  lanes greatest[N_RATIOS];
  size_t n = 2 * CORNERS * (end - begin);
  for (size_t i = begin; i < end; i++)
    place_corners(leaves, i, cutoff, place, u, v, shape->major, x2 + 2 * CORNERS * (i - begin),
                  y2 + 2 * CORNERS * (i - begin));
  for (int k = 0; k < N_RATIOS; k++) {
    double ratio = factors[k] * shape->ratio;
    ratios[k] = ratio > 1.0 ? 1.0 : ratio < least_ratio ? least_ratio : ratio;
    across2[k] = (float)(1.0 / (ratios[k] * ratios[k]));
    greatest[k] = lanes_of(0.0f);
  }
  for (size_t i = 0; i < n; i += CONIC_LANES)
    for (int k = 0; k < N_RATIOS; k++)
      greatest[k] = lanes_max(lanes_load(x2 + i) + lanes_load(y2 + i) * across2[k], greatest[k]);
  for (int k = 0; k < N_RATIOS; k++) {
    float area = greatest_of(greatest[k]) * (float)ratios[k];
    if (area < best_area) {
      best_area = area;
      best = ratios[k];
    }
  }
  return best;
}
