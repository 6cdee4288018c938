#include "tests/fuzz/fuzz.h"

#include "core/assimp/assimp_kinds.h"

/* Files of any kind of Assimp's, which reads them in a process that may break down. */
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n_bytes) {
  conic_model_kind kind;
  if (!conic_assimp_find_content("", (const char *)bytes, n_bytes, n_bytes, &kind))
    return -1;
  fuzz_triangles(bytes, n_bytes);
  return fuzz_model(bytes, n_bytes, kind);
}
