/* The table of framing (raster/loops/raster_loops.h): bounds of outlines along directions. */
#pragma once

#include <stddef.h>

enum {
  CONIC_REACH_DIRECTIONS = 120,
  CONIC_REACH_BLOCK = 256, /* splats or triangles that are bounded together */
  CONIC_REACH_POINTS = 3 * CONIC_REACH_BLOCK
};

/* Some of a drawing's points: position and tangents, in columns. */
typedef struct conic_reach_points {
  float columns[9][CONIC_REACH_POINTS];
  size_t n; /* a multiple of CONIC_REACH_BLOCK, the last ones with positions that are not numbers */
} conic_reach_points;

/* What a bound along a direction is computed with, in floats: what they round is in `slack`, a part of what a point's
 * tangents measure. */
typedef struct conic_reach_direction {
  float along[3], slack;
} conic_reach_direction;

typedef struct conic_reach_limits {
  float center[3], low[3], high[3]; /* points beyond low and high from the centre count for nothing */
  float cutoff;
  size_t n;
  conic_reach_direction directions[2 * CONIC_REACH_DIRECTIONS];
} conic_reach_limits;

typedef struct conic_reach_loops {
  /* Writes how far the outlines reach from the centre at most along each direction, but for what rounds the centre:
   * infinity where no bound is found, and -infinity where there is no point. */
  void (*bound)(const conic_reach_points *points, const conic_reach_limits *limits, float *bounds);
} conic_reach_loops;
