/* Headers of web servers, a line each. A range that is taken lies within the file. */
#include "tests/fuzz/fuzz.h"

#include "lod/ranges/http_response.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n_bytes) {
  conic_http_response response = {0};
  int goes_on = 1;
  for (size_t at = 0, n; at < n_bytes && goes_on; at += n) {
    const uint8_t *end = memchr(bytes + at, '\n', n_bytes - at);
    n = end ? (size_t)(end - bytes) + 1 - at : n_bytes - at;
    char *line = malloc(n); /* no byte more, and no zero */
    FUZZ_CHECK(line);
    memcpy(line, bytes + at, n);
    goes_on = conic_http_header(&response, line, n);
    free(line);
  }
  FUZZ_CHECK(response.status >= 0 && response.status < 1000 && strlen(response.tag) < sizeof response.tag);
  FUZZ_CHECK(!response.has_range || (response.first <= response.last && response.last < response.size));
  return 0;
}
