#include "core/splats/shares.h"

#include "core/base/base.h"

void conic_shares_take_greatest(const conic_splats_shares *shares, double *values, size_t n) {
  const conic_team *team = shares->team;
  size_t sizes[CONIC_MOST_IN_TEAM];
  if (!team)
    return;
  const double *all = team->collect(team->data, values, n * sizeof *values, sizes);
  memcpy(values, all, n * sizeof *values);
  for (size_t k = 1; k < (size_t)team->count; k++)
    for (size_t i = 0; i < n; i++)
      values[i] = all[k * n + i] > values[i] ? all[k * n + i] : values[i];
  team->release(team->data, (void *)all);
}

void conic_shares_take_sums(const conic_splats_shares *shares, uint64_t *counts, size_t n) {
  const conic_team *team = shares->team;
  size_t sizes[CONIC_MOST_IN_TEAM];
  if (!team)
    return;
  const uint64_t *all = team->collect(team->data, counts, n * sizeof *counts, sizes);
  memset(counts, 0, n * sizeof *counts);
  for (size_t k = 0; k < (size_t)team->count; k++)
    for (size_t i = 0; i < n; i++)
      counts[i] += all[k * n + i];
  team->release(team->data, (void *)all);
}

size_t conic_shares_gather(const conic_splats_shares *shares, const double *values, size_t n, double *all) {
  if (shares->team)
    return conic_team_collect(shares->team, values, n * sizeof *values, all) / sizeof *all;
  memmove(all, values, n * sizeof *values);
  return n;
}

/* The least values are the greatest of the negated ones. A process without a finite centre takes no part. */
size_t conic_shares_bounds(const conic_splats_shares *shares, const conic_splats *splats, double minimum[3],
                           double maximum[3]) {
  uint64_t n = conic_splats_bounds(splats, minimum, maximum);
  double ends[6];
  if (!shares->team)
    return (size_t)n;
  for (int axis = 0; axis < 3; axis++) {
    ends[axis] = n ? -minimum[axis] : -HUGE_VAL;
    ends[3 + axis] = n ? maximum[axis] : -HUGE_VAL;
  }
  conic_shares_take_greatest(shares, ends, 6);
  conic_shares_take_sums(shares, &n, 1);
  for (int axis = 0; axis < 3; axis++) {
    minimum[axis] = n ? -ends[axis] : 0.0;
    maximum[axis] = n ? ends[3 + axis] : 0.0;
  }
  return (size_t)n;
}
