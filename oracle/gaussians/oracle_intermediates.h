/* A Gaussian before it is composited: what floats may have of it, and which tiles list it. */
#pragma once

#include "conic/gaussian_intermediates.h"
#include "oracle/gaussians/oracle_cells.h"

/* A number in double, and the least and the greatest that floats may make of it. */
typedef struct oracle_range {
  double v, low, high;
} oracle_range;

typedef struct oracle_projected {
  oracle_uncertain g;
  int is_shown, may_be_shown, may_be_left_out; /* by the projection: in double; for floats */
  oracle_range radius[2];                      /* whole pixels */
  oracle_range first[2], behind[2];            /* tiles */
} oracle_projected;

void conic_oracle_project(const oracle_doubting *d, size_t i, oracle_projected *p);

/* Whether a tile lists it: in double; whether it may; and whether it has to, since something of it is seen there. */
int conic_oracle_lists(const oracle_doubting *d, const oracle_projected *p, int is_by_ellipse, int x, int y);
int conic_oracle_may_list(const oracle_projected *p, int x, int y);
int conic_oracle_has_to_list(const oracle_doubting *d, const oracle_projected *p, int x, int y);

/* The range of a row's number in one of the arrays. */
oracle_range conic_oracle_intermediate(const oracle_projected *p, conic_intermediate kind, int column);
int conic_oracle_intermediate_columns(const conic_profile_row *rules, conic_intermediate kind); /* 0: it has none */
