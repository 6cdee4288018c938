#include "oracle/oracle_weights.h"

static void count_error(oracle_histogram *h, double error) {
  uint64_t bits;
  double scaled = error * 0x1p-960; /* so that 2⁻⁶³ is the least that has a bin of its own */
  memcpy(&bits, &scaled, sizeof bits);
  size_t bin = error > 0x1p-62 ? (size_t)(bits >> 48) : 0;
  h->bins[bin < ORACLE_N_BINS ? bin : ORACLE_N_BINS - 1]++;
  h->greatest = oracle_max(h->greatest, error);
}

/* The upper end of the bin that the percentile falls into. */
static double percentile(const oracle_histogram *h, double share) {
  size_t total = 0, sum = 0;
  for (int i = 0; i < ORACLE_N_BINS; i++)
    total += h->bins[i];
  for (int i = 0; i < ORACLE_N_BINS; i++) {
    sum += h->bins[i];
    if ((double)sum >= share * (double)total) {
      uint64_t bits = (uint64_t)(i + 1) << 48;
      double value;
      memcpy(&value, &bits, sizeof value);
      return i ? oracle_min(value * 0x1p960, h->greatest) : 0.0;
    }
  }
  return 0.0;
}

double conic_oracle_peak(const oracle_view *view, const oracle_candidate *candidate, const oracle_exact *exact) {
  double values[ORACLE_N_VALUES];
  if (!candidate->is_drawn)
    return 0.0;
  if (candidate->shape.formula != ORACLE_RAY && candidate->shape.formula != ORACLE_LAPLACE)
    return candidate->shape.amplitude;
  if (!exact->is_center_in_front)
    return 0.0;
  conic_oracle_evaluate(view, &candidate->shape, exact->center_px[0], exact->center_px[1], values);
  return values[ORACLE_WEIGHT];
}

void conic_oracle_weigh(const oracle_view *view, const oracle_exact *exact, double peak, double x, double y,
                        oracle_weighing *weighing, oracle_fragment *fragment) {
  double change, weight = conic_oracle_exact_weight(view, exact, x, y, &change);
  double error = fabs(fragment->values[ORACLE_WEIGHT] - weight);
  count_error(&weighing->absolute, error);
  if (peak > 0.0)
    count_error(&weighing->of_peak, error / peak);
  weighing->quadrature = oracle_max(weighing->quadrature, change);
  weighing->n_weights++;
  fragment->weight = oracle_max(weight * fragment->candidate->splat->opacity, 0x1p-60);
}

static void add_histogram(oracle_histogram *to, const oracle_histogram *from) {
  for (int i = 0; i < ORACLE_N_BINS; i++)
    to->bins[i] += from->bins[i];
  to->greatest = oracle_max(to->greatest, from->greatest);
}

void conic_oracle_add_weights(oracle_weighing *to, const oracle_weighing *from) {
  add_histogram(&to->absolute, &from->absolute);
  add_histogram(&to->of_peak, &from->of_peak);
  to->quadrature = oracle_max(to->quadrature, from->quadrature);
  to->n_weights += from->n_weights;
}

conic_weight_error conic_oracle_weight_error(const oracle_weighing *weighing) {
  const oracle_histogram *absolute = &weighing->absolute, *of_peak = &weighing->of_peak;
  conic_weight_error error = {.max_abs = absolute->greatest,
                              .p999 = percentile(absolute, 0.999),
                              .max_of_peak = of_peak->greatest,
                              .p999_of_peak = percentile(of_peak, 0.999),
                              .quadrature = weighing->quadrature,
                              .n_weights = weighing->n_weights};
  return error;
}
