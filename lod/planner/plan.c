#include "lod/planner/plan.h"

#include "core/base/base.h"

/* Sorts by falling errors, which order like their bits as none is negative, and keeps the order of equals. `other` has
 * room for as many. The result is in `openings`. */
static void sort_openings(conic_plan_opening *openings, conic_plan_opening *other, size_t n) {
  enum { DIGIT_BITS = 11, N_DIGITS = 1 << DIGIT_BITS };
  for (int shift = 0; shift < 64 && n > 0; shift += DIGIT_BITS) {
    size_t places[N_DIGITS] = {0}, place = 0;
    for (size_t i = 0; i < n; i++)
      places[conic_bits_of_double(openings[i].px) >> shift & (N_DIGITS - 1)]++;
    if (places[conic_bits_of_double(openings[0].px) >> shift & (N_DIGITS - 1)] == n)
      continue;
    for (int digit = N_DIGITS - 1; digit >= 0; digit--) {
      size_t count = places[digit];
      places[digit] = place;
      place += count;
    }
    for (size_t i = 0; i < n; i++)
      other[places[conic_bits_of_double(openings[i].px) >> shift & (N_DIGITS - 1)]++] = openings[i];
    memcpy(openings, other, n * sizeof *openings);
  }
}

/* Lists more than the budget has room for, but not all of a large tree: what gives way at half the error is some four
 * times as much, until little is left. */
static size_t open_enough(const conic_plan_tree *tree, uint64_t budget, conic_plan_opening *openings,
                          uint64_t *n_first) {
  const double most_px = 4096.0, least_px = 1e-3;
  int64_t before = 0;
  for (double low_px = most_px;;) {
    size_t n = tree->open(tree->data, low_px, openings, n_first);
    int64_t count = (int64_t)*n_first;
    for (size_t i = 0; i < n; i++)
      count += openings[i].change;
    if (count - count / 8 > (int64_t)budget || !(low_px > 0.0))
      return n;
    int is_last = low_px < least_px || (count / 8 > (int64_t)*n_first && count - before < before / 2);
    low_px = is_last ? 0.0 : 0.5 * low_px;
    before = count;
  }
}

conic_status conic_plan_fit_tree(conic_context *context, const conic_plan_tree *tree, uint64_t budget,
                                 double *error_px) {
  conic_plan_opening *openings = conic_memory_allocate(context, tree->n_nodes, sizeof *openings);
  conic_plan_opening *other = conic_memory_allocate(context, tree->n_nodes, sizeof *other);
  uint64_t n_first;
  if (openings && other) {
    size_t n = open_enough(tree, budget, openings, &n_first);
    int64_t count = (int64_t)n_first;
    sort_openings(openings, other, n);
    *error_px = HUGE_VAL;
    for (size_t i = 0; i < n; i++) { /* before all that have this error give way, so many are chosen: */
      if ((i == 0 || openings[i].px < openings[i - 1].px) && count <= (int64_t)budget)
        *error_px = openings[i].px;
      count += openings[i].change;
    }
    if (count <= (int64_t)budget)
      *error_px = 0.0;
  }
  conic_status status = openings && other ? CONIC_OK : CONIC_ERROR_MEMORY;
  conic_memory_release_these(context, openings, other);
  return status;
}

int conic_plan_fit(conic_plan_choose *choose, void *data, uint64_t budget, double low_px, double *error_px) {
  double reached_px = HUGE_VAL;
  if (choose(data, HUGE_VAL, &reached_px) > budget)
    return 0;
  uint64_t low = conic_bits_of_double(low_px), high = conic_bits_of_double(reached_px);
  while (high > low && high - low > 1) {
    uint64_t middle = low + (high - low) / 2;
    double middle_px = reached_px = conic_double_of_bits(middle);
    if (choose(data, middle_px, &reached_px) > budget)
      low = middle;
    else /* what was chosen may be better than what was asked for */
      high = reached_px < middle_px ? conic_bits_of_double(reached_px) : middle;
  }
  *error_px = conic_double_of_bits(high);
  return 1;
}
