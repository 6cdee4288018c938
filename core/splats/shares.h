/* Each process of a team has a part of one set of splats. These functions find what holds of the whole set, to the bits
 * that a single process finds. */
#pragma once

#include "conic/splats.h"
#include "core/base/team.h"

/* The parts follow each other in the order of the processes. */
typedef struct conic_splats_shares {
  const conic_team *team; /* null: this process has all, */
  uint64_t first, count;  /* else its first splat's place among all, and their number */
} conic_splats_shares;

/* The next functions are collective where there is a team. They cannot fail then, so processes agree beforehand on
 * whether one has failed. */

/* Makes each value the greatest of all processes'; of equal ones, the first process's. */
void conic_shares_take_greatest(const conic_splats_shares *shares, double *values, size_t n);

/* Makes each count the sum of all processes'. */
void conic_shares_take_sums(const conic_splats_shares *shares, uint64_t *counts, size_t n);

/* Puts the n values of each process side by side, in their order, into `all`, which may be the same and has room for
 * them; returns their number. */
size_t conic_shares_gather(const conic_splats_shares *shares, const double *values, size_t n, double *all);

/* conic_splats_bounds of all. */
size_t conic_shares_bounds(const conic_splats_shares *shares, const conic_splats *splats, double minimum[3],
                           double maximum[3]);

/* conic_splats_length of all; this process's splats have axes. Errors: MEMORY, CANCELLED. */
conic_status conic_shares_length(conic_context *context, const conic_splats_shares *shares, const conic_splats *splats,
                                 double *length);

/* About `most` samples are taken of all splats: how far apart they lie, and which of this process's is the first. */
static inline size_t conic_shares_stride(const conic_splats_shares *shares, const conic_splats *splats, size_t most) {
  return 1 + (shares->team ? (size_t)shares->count : splats->count) / most;
}
static inline size_t conic_shares_first(const conic_splats_shares *shares, size_t stride) {
  return shares->team ? (stride - (size_t)(shares->first % stride)) % stride : 0;
}
