/* A number that is rounded to float is a float, also where it goes on as a double, and whatever the compiler makes of
 * two such lines side by side: GCC 12 leaves the rounding out of pairs where it is let to pack them (CMakeLists.txt).
 */
#include "tests/support/check.h"

/* Out of the compiler's sight, one by one. */
static double rounded(double value) {
  volatile float as_float = (float)value;
  return (double)as_float;
}

static void divide_two(double values[2], double by) {
  for (int i = 0; i < 2; i++)
    values[i] = (double)(float)(values[i] / by);
}

static void divide_three(double values[3], double by) {
  for (int i = 0; i < 3; i++)
    values[i] = (double)(float)(values[i] / by);
}

static void keep_two(double *restrict values, float *restrict kept, double by) {
  for (int i = 0; i < 2; i++) {
    kept[i] = (float)(values[i] / by);
    values[i] = (double)kept[i] + 1.0;
  }
}

static void divide_many(double *values, int n, double by) {
  for (int i = 0; i < n; i++)
    values[i] = (double)(float)(values[i] / by);
}

int main(void) {
  void (*volatile two)(double *, double) = divide_two, (*volatile three)(double *, double) = divide_three;
  void (*volatile keep)(double *, float *, double) = keep_two;
  void (*volatile many)(double *, int, double) = divide_many;
  for (int run = 1; run < 50; run++) {
    double by = 3.0 + 0.25 * run, given[7], pair[2], triple[3], sums[2], all[7];
    float kept[2];
    for (int i = 0; i < 7; i++)
      given[i] = all[i] = 1.0 + 0.1 * i;
    memcpy(pair, given, sizeof pair);
    memcpy(triple, given, sizeof triple);
    memcpy(sums, given, sizeof sums);
    two(pair, by);
    three(triple, by);
    keep(sums, kept, by);
    many(all, 7, by);
    for (int i = 0; i < 7; i++) {
      double wanted = rounded(given[i] / by);
      CHECK(all[i] == wanted);
      CHECK(i >= 2 || (pair[i] == wanted && sums[i] == wanted + 1.0 && (double)kept[i] == wanted));
      CHECK(i >= 3 || triple[i] == wanted);
    }
  }
  return check_result();
}
