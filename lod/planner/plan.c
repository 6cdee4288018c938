#include "lod/planner/plan.h"

#include "core/base/base.h"
#include "core/base/radix.h"

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

/* The least error for which there are few enough; the items have the openings' numbers, by falling errors. */
static double find_least(const conic_plan_opening *openings, const conic_radix_item *items, size_t n, uint64_t n_first,
                         uint64_t budget) {
  int64_t count = (int64_t)n_first;
  double least_px = HUGE_VAL, before_px = HUGE_VAL;
  for (size_t i = 0; i < n; i++) { /* before all that have this error give way, so many are chosen: */
    const conic_plan_opening *opening = &openings[items[i].value];
    if ((i == 0 || opening->px < before_px) && count <= (int64_t)budget)
      least_px = opening->px;
    before_px = opening->px;
    count += opening->change;
  }
  return count <= (int64_t)budget ? 0.0 : least_px;
}

conic_status conic_plan_fit_tree(conic_context *context, const conic_plan_tree *tree, uint64_t budget,
                                 double *error_px) {
  conic_plan_opening *openings = conic_memory_allocate(context, tree->n_nodes, sizeof *openings);
  uint64_t n_first;
  if (!openings)
    return CONIC_ERROR_MEMORY;
  size_t n = open_enough(tree, budget, openings, &n_first);
  conic_radix_item *items = conic_memory_allocate(context, n, sizeof *items);
  for (size_t i = 0; items && i < n; i++) /* errors order like their bits, as none is negative */
    items[i] = (conic_radix_item){~conic_bits_of_double(openings[i].px), (uint32_t)i};
  conic_status status = items ? conic_radix_sort(context, items, n, 64) : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK)
    *error_px = find_least(openings, items, n, n_first, budget);
  conic_memory_release_these(context, openings, items);
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
