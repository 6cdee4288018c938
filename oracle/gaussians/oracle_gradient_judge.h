/* What judging a gradient needs of the chain. */
#ifndef CONIC_ORACLE_GRADIENT_JUDGE_H
#define CONIC_ORACLE_GRADIENT_JUDGE_H

#include "oracle/gaussians/oracle_gradient_job.h"

/* Rows of J·V·R·S with all terms of one sign, and derivatives on the way. */
typedef struct row_sizes {
  double focal[2], slope[2], rows[2][3], by_rows[2][3], by_mean[3];
} row_sizes;

void conic_oracle_row_sizes(const oracle_gaussian_view *view, const oracle_gaussian *g, row_sizes *sizes);

/* The chain of an ellipse with every term of one sign; `sums` are none below 0. */
void conic_oracle_gradient_sizes(const oracle_gaussian_view *view, const conic_gaussians *gaussians, size_t i,
                                 const double *sums, oracle_parameters *to);

#endif
