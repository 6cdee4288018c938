/* Every slot of every family of loops against plain C, bit for bit: on friendly and on hostile input, with guard
 * bands around all that a slot may write.
 *
 *   cross FOLDER [SEED]      the seed is printed, and repeats a run
 *   cross FOLDER --bench     what `conic bench --kernels` prints */
#include "bench/loops/cross_all.h"
#include "tests/support/check.h"

int main(int argc, char **argv) {
  int is_bench = argc > 2 && strcmp(argv[2], "--bench") == 0;
  check_failures =
      cli_cross_all(argc > 2 && !is_bench ? strtoull(argv[2], NULL, 10) : CONIC_CROSS_SEED, is_bench ? 7 : 0);
  return check_result();
}
