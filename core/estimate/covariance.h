/* The spread of points about a slot: their covariance, summed about the slot itself, where the numbers are small. */
#ifndef CONIC_COVARIANCE_H
#define CONIC_COVARIANCE_H

#include "core/estimate/neighbourhood.h"

typedef struct conic_covariance {
  double origin[3]; /* the slot's position; it adds only to the sums' number */
  double count, sum[3], products[6];
} conic_covariance;

conic_covariance conic_covariance_about(const conic_neighbourhood *neighbourhood, size_t slot);

/* Adds n slots. */
void conic_covariance_add(conic_covariance *covariance, const conic_neighbourhood *neighbourhood, const uint32_t *slots,
                          size_t n);

/* The matrix {xx, xy, xz, yy, yz, zz} about the mean, times the number of points. */
void conic_covariance_matrix(const conic_covariance *covariance, double matrix[6]);

#endif
