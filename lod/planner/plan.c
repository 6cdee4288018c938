#include "lod/planner/plan.h"

#include <math.h>

#include "core/base/real.h"

/* Halves the errors, which order like their bits as none is negative. */
int conic_plan_fit(const conic_plan *plan, uint64_t budget, double low_px, double *error_px) {
  double reached_px = HUGE_VAL, last_px = HUGE_VAL;
  if (plan->choose(plan->data, HUGE_VAL, budget, &reached_px) > budget)
    return 0;
  uint64_t low = conic_bits_of_double(low_px), high = conic_bits_of_double(reached_px);
  while (high > low && high - low > 1) {
    uint64_t middle = low + (high - low) / 2;
    reached_px = last_px = conic_double_of_bits(middle);
    if (plan->choose(plan->data, last_px, budget, &reached_px) > budget)
      low = middle;
    else /* what was chosen may be better than what was asked for */
      high = reached_px < last_px ? conic_bits_of_double(reached_px) : middle;
  }
  *error_px = reached_px = conic_double_of_bits(high);
  return last_px == *error_px || plan->choose(plan->data, *error_px, budget, &reached_px) <= budget;
}
