/* Traces of jobs. What is read can be scheduled. */
#include "tests/fuzz/fuzz.h"

#include "bench/rank_schedule.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n_bytes) {
  cli_rank_trace trace;
  fuzz_input input = fuzz_open(bytes, n_bytes);
  conic_status status = cli_rank_trace_read(input.context, input.path, 0, &trace);
  FUZZ_CHECK((status == CONIC_OK) == (trace.n_units > 0));
  cli_rank_trace_release(input.context, &trace);
  fuzz_close(&input, status, 1);
  return 0;
}
