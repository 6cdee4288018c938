/* How far the method's weights are from the exact ones, counted. */
#pragma once

#include "oracle/oracle_pixel.h"

/* Errors of weights by size: sixteen bins to the octave. */
enum { ORACLE_N_BINS = 1024 };
typedef struct oracle_histogram {
  size_t bins[ORACLE_N_BINS];
  double greatest;
} oracle_histogram;

/* What a thread has counted. */
typedef struct oracle_weighing {
  oracle_histogram absolute, of_peak;
  double quadrature;
  size_t n_weights;
} oracle_weighing;

/* The splat's amplitude at its centre; 0 where it has none. */
double conic_oracle_peak(const oracle_view *view, const oracle_candidate *candidate, const oracle_exact *exact);

/* Gives a visible fragment the exact weight in place of the method's. */
void conic_oracle_weigh(const oracle_view *view, const oracle_exact *exact, double peak, double x, double y,
                        oracle_weighing *weighing, oracle_fragment *fragment);

void conic_oracle_add_weights(oracle_weighing *to, const oracle_weighing *from);
conic_weight_error conic_oracle_weight_error(const oracle_weighing *weighing);
