#include "tests/fuzz/fuzz.h"

/* Meshes in glTF, as text or binary. */
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n_bytes) {
  conic_model_kind kind;
  if (!conic_assimp_find_content("", (const char *)bytes, n_bytes, n_bytes, &kind) ||
      (kind != CONIC_MODEL_GLTF && kind != CONIC_MODEL_GLB))
    return -1;
  fuzz_triangles(bytes, n_bytes);
  return fuzz_model(bytes, n_bytes, kind);
}
