/* Manifests of conformance suites. Whatever is read leads to files within the suite. */
#include "tests/fuzz/fuzz.h"

#include "cli/judge/suite_manifest.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n_bytes) {
  suite_manifest manifest;
  fuzz_input input = fuzz_open(bytes, n_bytes);
  conic_status status = cli_suite_read_manifest(input.context, input.path, &manifest);
  FUZZ_CHECK((status == CONIC_OK) == (manifest.n_cases > 0));
  for (size_t i = 0; i < manifest.n_cases; i++) {
    const suite_entry *one = &manifest.cases[i];
    FUZZ_CHECK(one->npy[0] && one->npy[0] != '/' && !strstr(one->npy, "/.") && !strchr(one->name, '/'));
    FUZZ_CHECK(one->level > 0 && one->width > 0 && one->height > 0 && one->bytes > 0);
  }
  cli_suite_release_manifest(input.context, &manifest);
  fuzz_close(&input, status, 1);
  return 0;
}
