/* What judging a gradient needs of the chain. */
#ifndef CONIC_ORACLE_GRADIENT_JUDGE_H
#define CONIC_ORACLE_GRADIENT_JUDGE_H

#include "oracle/gaussians/oracle_gradient_job.h"

/* The chain of an ellipse with every term of one sign; `sums` are none below 0. */
void conic_oracle_gradient_sizes(const oracle_gaussian_view *view, const conic_gaussians *gaussians, size_t i,
                                 const double *sums, oracle_parameters *to);

#endif
