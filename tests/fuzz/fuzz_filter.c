/* Expressions that choose points. What is parsed gives an answer for any values. */
#include "tests/fuzz/fuzz.h"

#include "core/splats/point_filter.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n_bytes) {
  const double values[CONIC_FILTER_MOST_NAMES] = {0.0, 1.0, -1.0, 2.5};
  fuzz_input input = fuzz_open(bytes, n_bytes);
  conic_filter *filter;
  char *text = malloc(n_bytes + 1);
  FUZZ_CHECK(text);
  memcpy(text, bytes, n_bytes);
  text[n_bytes] = 0;
  conic_status status = conic_filter_parse(input.context, text, &filter);
  FUZZ_CHECK((status == CONIC_OK) == (filter != NULL) && (status == CONIC_OK || status == CONIC_ERROR_ARGUMENT));
  if (filter) {
    FUZZ_CHECK(conic_filter_names(filter) > 0);
    conic_filter_passes(filter, values);
  }
  conic_filter_destroy(input.context, filter);
  free(text);
  fuzz_end(&input, status);
  return 0;
}
