/* Bounds of outlines along directions (raster/view/reach_loops.h), in loops that compilers turn into lanes. Included
 * by the tables of loops, plain C among them. */
#include <float.h>
#include <math.h>

#include "raster/view/reach_loops.h"

/* The points of a block, from the centre. */
typedef struct reach_block {
  float from[3][CONIC_REACH_BLOCK], size[CONIC_REACH_BLOCK]; /* the size: what tangents measure together */
  float most[CONIC_REACH_BLOCK];                             /* infinity, or -infinity for what counts for nothing */
  float reached[CONIC_REACH_BLOCK];
} reach_block;

static void see_block(const conic_reach_points *points, size_t first, const conic_reach_limits *limits,
                      reach_block *block) {
  for (size_t i = 0; i < CONIC_REACH_BLOCK; i++) {
    block->most[i] = INFINITY;
    block->size[i] = 0.0f;
  }
  for (int axis = 0; axis < 3; axis++) {
    const float *position = points->columns[axis] + first, *u = points->columns[3 + axis] + first;
    const float *v = points->columns[6 + axis] + first;
    float center = limits->center[axis], low = limits->low[axis], high = limits->high[axis];
    for (size_t i = 0; i < CONIC_REACH_BLOCK; i++) {
      float from = position[i] - center;
      int is_within = (from >= low) & (from <= high);
      block->from[axis][i] = is_within ? from : 0.0f;
      block->most[i] = is_within ? block->most[i] : -INFINITY;
      block->size[i] += fabsf(u[i]) + fabsf(v[i]);
    }
  }
}

static float reach_of_block(const conic_reach_points *points, size_t first, const conic_reach_direction *direction,
                            float cutoff, reach_block *block) {
  const float(*columns)[CONIC_REACH_POINTS] = points->columns;
  float x = direction->along[0], y = direction->along[1], z = direction->along[2], slack = direction->slack;
  for (size_t i = 0; i < CONIC_REACH_BLOCK; i++) {
    size_t k = first + i;
    float along = x * block->from[0][i] + y * block->from[1][i] + z * block->from[2][i];
    float along_u = x * columns[3][k] + y * columns[4][k] + z * columns[5][k];
    float along_v = x * columns[6][k] + y * columns[7][k] + z * columns[8][k];
    float outline = cutoff * sqrtf(along_u * along_u + along_v * along_v);
    float reached = along + outline + slack * block->size[i];
    reached = reached <= FLT_MAX ? reached : INFINITY; /* what is not a number, too */
    block->reached[i] = reached < block->most[i] ? reached : block->most[i];
  }
  for (size_t half = CONIC_REACH_BLOCK / 2; half > 0; half /= 2)
    for (size_t i = 0; i < half; i++) {
      float other = block->reached[half + i];
      block->reached[i] = block->reached[i] > other ? block->reached[i] : other;
    }
  return block->reached[0];
}

static void bound_reach(const conic_reach_points *points, const conic_reach_limits *limits, float *bounds) {
  reach_block block;
  for (size_t i = 0; i < limits->n; i++)
    bounds[i] = -INFINITY;
  for (size_t first = 0; first < points->n; first += CONIC_REACH_BLOCK) {
    see_block(points, first, limits, &block);
    for (size_t i = 0; i < limits->n; i++) {
      float reached = reach_of_block(points, first, &limits->directions[i], limits->cutoff, &block);
      bounds[i] = bounds[i] > reached ? bounds[i] : reached;
    }
  }
}
