#include "core/estimate/covariance.h"

conic_covariance conic_covariance_about(const conic_neighbourhood *neighbourhood, size_t slot) {
  conic_covariance covariance = {.count = 1.0};
  conic_neighbourhood_position(neighbourhood, slot, covariance.origin);
  return covariance;
}

void conic_covariance_add(conic_covariance *covariance, const conic_neighbourhood *neighbourhood, const uint32_t *slots,
                          size_t n) {
  double *sum = covariance->sum, *products = covariance->products;
  for (size_t i = 0; i < n; i++) {
    double d[3];
    conic_neighbourhood_position(neighbourhood, slots[i], d);
    for (int axis = 0; axis < 3; axis++) {
      d[axis] -= covariance->origin[axis];
      sum[axis] += d[axis];
    }
    products[0] += d[0] * d[0];
    products[1] += d[0] * d[1];
    products[2] += d[0] * d[2];
    products[3] += d[1] * d[1];
    products[4] += d[1] * d[2];
    products[5] += d[2] * d[2];
  }
  covariance->count += (double)n;
}

void conic_covariance_matrix(const conic_covariance *covariance, double matrix[6]) {
  const double *sum = covariance->sum, *products = covariance->products;
  double share = 1.0 / covariance->count;
  matrix[0] = products[0] - sum[0] * sum[0] * share;
  matrix[1] = products[1] - sum[0] * sum[1] * share;
  matrix[2] = products[2] - sum[0] * sum[2] * share;
  matrix[3] = products[3] - sum[1] * sum[1] * share;
  matrix[4] = products[4] - sum[1] * sum[2] * share;
  matrix[5] = products[5] - sum[2] * sum[2] * share;
}
