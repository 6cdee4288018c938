/* The sequence that places samples: its nets, and its numbers. */
#include "accumulation/sequence.h"
#include "tests/support/check.h"

enum { MOST_LOG = 10, MOST_SAMPLES = 1 << MOST_LOG };

/* Whether of the 2^log samples from `start` on each box of one corner 2^-halvings[d] long in dimension d has as many.
 */
static int is_even(uint64_t start, int log, const int *dimensions, const int *halvings, int n_dimensions) {
  int counts[MOST_SAMPLES] = {0}, n_halvings = 0;
  for (int d = 0; d < n_dimensions; d++) {
    n_halvings += halvings[d];
  }
  for (int i = 0; i < 1 << log; i++) {
    int box = 0;
    for (int d = 0; d < n_dimensions; d++) {
      int n_slices = 1 << halvings[d];
      box = box * n_slices + (int)(conic_sequence_at(start + (uint64_t)i, dimensions[d]) * n_slices);
    }
    counts[box]++;
  }
  for (int box = 0; box < 1 << n_halvings; box++) {
    if (counts[box] != 1 << (log - n_halvings)) {
      return 0;
    }
  }
  return 1;
}

/* Whether all such boxes of 2^-(log - spared) are even. */
static int is_net(uint64_t start, int log, const int *dimensions, int n_dimensions, int spared) {
  int halvings[4] = {0};
  for (int code = 0; code < 1 << (4 * (n_dimensions - 1)); code++) {
    int rest = log - spared;
    for (int d = 1; d < n_dimensions; d++) {
      halvings[d] = code >> (4 * (d - 1)) & 15;
      rest -= halvings[d];
    }
    halvings[0] = rest;
    if (rest >= 0 && !is_even(start, log, dimensions, halvings, n_dimensions)) {
      return 0;
    }
  }
  return 1;
}

/* Blocks of 2^log samples are such nets, at each size up to the largest, wherever they lie. */
static void check_nets(const int *dimensions, int n_dimensions, int largest, int spared) {
  for (int log = spared; log <= largest; log++) {
    for (uint64_t block = 0; block < 5; block++) {
      CHECK(is_net(block << log, log, dimensions, n_dimensions, spared));
    }
  }
}

static void check_stratified(void) {
  for (int d = 0; d < CONIC_N_SEQUENCE_DIMENSIONS; d++) {
    check_nets(&d, 1, MOST_LOG, 0);
  }
  check_nets((const int[]){CONIC_SEQUENCE_PIXEL, CONIC_SEQUENCE_PIXEL + 1}, 2, MOST_LOG, 0);
  check_nets((const int[]){CONIC_SEQUENCE_LENS, CONIC_SEQUENCE_LENS + 1}, 2, MOST_LOG, 2);
  check_nets((const int[]){CONIC_SEQUENCE_DIRECTION, CONIC_SEQUENCE_DIRECTION + 1}, 2, MOST_LOG, 2);
  check_nets((const int[]){8, 9}, 2, MOST_LOG, 2);
  check_nets((const int[]){10, 11}, 2, MOST_LOG, 2);
  check_nets((const int[]){0, 1, 2}, 3, 8, 1);    /* a pixel through a lens, cut by one line */
  check_nets((const int[]){0, 1, 4}, 3, 8, 2);    /* a pixel in time */
  check_nets((const int[]){0, 1, 2, 3}, 4, 8, 3); /* a pixel through a lens */
}

/* A scramble moves the whole sequence: its first sample is at no corner, and samples beyond 2³² are others. */
static void check_numbers(void) {
  static const uint32_t known[CONIC_N_SEQUENCE_DIMENSIONS] = {
      1993166683, 362120511,  1219068286, 1703367089, 444296909,  218001083, 3440288519, 2577926851,
      1320530306, 2391072722, 3621760552, 1308977999, 3306130959, 710633860, 3937069983, 1102610066};
  for (int d = 0; d < CONIC_N_SEQUENCE_DIMENSIONS; d++) {
    CHECK_NEAR(conic_sequence_at(12345, d), known[d] * 0x1p-32, 0.0);
    CHECK(conic_sequence_at(0, d) > 0.0);
    CHECK(conic_sequence_at(UINT64_C(1) << 32, d) != conic_sequence_at(0, d));
  }
}

/* The area under a slanted edge: what an edge through a pixel is. */
static double error_of_edge(uint64_t n_samples) {
  double worst = 0.0;
  for (int place = 0; place < 16; place++) {
    double slope = 0.3 + 0.02 * place, offset = 0.05 + 0.02 * place, sum = 0.0;
    for (uint64_t i = 0; i < n_samples; i++) {
      sum += conic_sequence_at(i, 1) < offset + slope * conic_sequence_at(i, 0);
    }
    worst = fmax(worst, fabs(sum / (double)n_samples - (offset + slope / 2)));
  }
  return worst;
}

int main(void) {
  check_stratified();
  check_numbers();
  CHECK(error_of_edge(1024) <= 0.004);
  return check_result();
}
