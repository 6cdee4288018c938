/* Compositing with bounds, following decisions that are in doubt both ways. */
#ifndef CONIC_ORACLE_FORKS_H
#define CONIC_ORACLE_FORKS_H

#include "oracle/gaussians/oracle_uncertain.h"

/* What a path through the decisions has composited. */
typedef struct oracle_step {
  const oracle_meeting *meeting;
  double weight[2];
  int is_sure, may_be_before; /* that it is composited; that the step before it comes after it */
} oracle_step;

/* Composites the meetings that may cover the pixel, which stand in the order of the double run, and notes at each what
 * is in doubt. `steps` has room for as many. */
void conic_oracle_composite(const oracle_doubting *d, oracle_meeting *meetings, size_t n, const float background[3],
                            oracle_step *steps, conic_gaussian_bound *bound);

#endif
