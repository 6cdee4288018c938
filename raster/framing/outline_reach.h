/* How far the outline of a drawing reaches along some directions, which are turned a little and measured again. */
#pragma once

#include "conic/triangles.h"
#include "raster/view/reach_loops.h"

/* A drawing's points within a box reach along n directions from its centre. Each direction is between two that stay: a
 * part of the wide one and the rest of the narrow one. */
typedef struct conic_outline_reach {
  const conic_drawing *drawing; /* with splats and triangles */
  double cutoff, center[3];
  double low[3], high[3]; /* from the center */
  size_t n;
  double wide[CONIC_REACH_DIRECTIONS][3], narrow[CONIC_REACH_DIRECTIONS][3];
  double directions[CONIC_REACH_DIRECTIONS][3], parts[CONIC_REACH_DIRECTIONS]; /* conic_reach_measure takes these, */
  double farthest[CONIC_REACH_DIRECTIONS]; /* and writes what the outline reaches; -HUGE_VAL: there is none */
  size_t n_splat_blocks, n_blocks, n_tasks;
  float *bounds;         /* a block has n wide and n narrow ones */
  double *task_farthest; /* a task has n */
} conic_outline_reach;

/* Bounds all blocks. Errors: MEMORY, CANCELLED; the caller calls conic_reach_close whatever comes back. */
conic_status conic_reach_open(conic_context *context, conic_outline_reach *r);
/* Errors: CANCELLED. */
conic_status conic_reach_measure(conic_context *context, conic_outline_reach *r);
void conic_reach_close(conic_context *context, conic_outline_reach *r);
