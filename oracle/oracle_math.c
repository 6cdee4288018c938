#include "oracle/oracle_math.h"

/* eˣ = 2ᵏ·eʳ with |r| ≤ ½ ln 2, and eʳ by its series. */
double conic_oracle_exp(double x) {
  if (!(x > -700.0))
    return x * 0.0 == 0.0 || x < 0.0 ? 0.0 : x;
  if (x > 709.0)
    return INFINITY;
  double k = floor(x * 1.4426950408889634074 + 0.5);
  double r = (x - k * 0x1.62e42fefa0000p-1) - k * 0x1.cf79abc9e3b39p-40;
  static const double one_over[] = {0.0,        1.0,        1.0 / 2.0,  1.0 / 3.0,  1.0 / 4.0,
                                    1.0 / 5.0,  1.0 / 6.0,  1.0 / 7.0,  1.0 / 8.0,  1.0 / 9.0,
                                    1.0 / 10.0, 1.0 / 11.0, 1.0 / 12.0, 1.0 / 13.0, 1.0 / 14.0};
  double sum = 1.0;
  for (int n = 14; n > 0; n--)
    sum = 1.0 + (sum * r) * one_over[n];
  uint64_t bits = (uint64_t)((int64_t)k + 1023) << 52;
  double power;
  memcpy(&power, &bits, sizeof power);
  return sum * power;
}

/* x = m·2ᵏ with m within √½ … √2, and ln m = 2·artanh((m − 1)/(m + 1)) by its series. */
double conic_oracle_log(double x) {
  int k;
  double m = frexp(x, &k);
  if (m < 0.70710678118654752440) {
    m *= 2.0;
    k--;
  }
  double t = (m - 1.0) / (m + 1.0), square = t * t, sum = 0.0;
  for (int n = 25; n > 0; n -= 2)
    sum = sum * square + 1.0 / n;
  return k * 0.69314718055994530942 + 2.0 * t * sum;
}

int conic_oracle_invert(const double matrix[3][3], double inverse[3][3]) {
  double rows[3][6];
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      rows[i][j] = matrix[i][j];
      rows[i][3 + j] = i == j;
    }
  for (int column = 0; column < 3; column++) {
    int pivot = column;
    for (int i = column + 1; i < 3; i++)
      if (fabs(rows[i][column]) > fabs(rows[pivot][column]))
        pivot = i;
    if (!(fabs(rows[pivot][column]) > 0.0))
      return 0;
    for (int j = 0; j < 6; j++) {
      double swapped = rows[pivot][j];
      rows[pivot][j] = rows[column][j];
      rows[column][j] = swapped;
    }
    double scale = 1.0 / rows[column][column];
    for (int j = 0; j < 6; j++)
      rows[column][j] *= scale;
    for (int i = 0; i < 3; i++)
      if (i != column) {
        double factor = rows[i][column];
        for (int j = 0; j < 6; j++)
          rows[i][j] -= factor * rows[column][j];
      }
  }
  for (int i = 0; i < 3; i++)
    memcpy(inverse[i], rows[i] + 3, sizeof inverse[i]);
  return 1;
}

/* Hoare's selection. */
double conic_oracle_select(double *values, size_t n, size_t rank) {
  ptrdiff_t low = 0, high = (ptrdiff_t)n - 1, wanted = (ptrdiff_t)rank;
  while (low < high) {
    double pivot = values[low + (high - low) / 2];
    ptrdiff_t i = low, j = high;
    while (i <= j) {
      while (values[i] < pivot)
        i++;
      while (values[j] > pivot)
        j--;
      if (i <= j) {
        double swapped = values[i];
        values[i++] = values[j];
        values[j--] = swapped;
      }
    }
    if (wanted <= j)
      high = j;
    else if (wanted >= i)
      low = i;
    else
      break;
  }
  return values[rank];
}
