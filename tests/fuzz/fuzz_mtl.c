#include "tests/fuzz/fuzz.h"

#include "core/base/memory.h"
#include "core/formats/material_file.h"

/* A file of the materials that have these names. */
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n_bytes) {
  static const char *const names[] = {"", "red", "plain"};
  fuzz_input input = fuzz_open(bytes, n_bytes);
  conic_material materials[3];
  conic_texts texts;
  memset(materials, 0, sizeof materials);
  memset(&texts, 0, sizeof texts);
  for (int i = 0; i < 3; i++)
    FUZZ_CHECK(conic_texts_add(input.context, &texts, names[i], strlen(names[i])) == CONIC_OK);
  conic_status status = conic_material_file_read(input.context, input.path, &texts, materials);
  for (int i = 0; i < 3; i++) {
    FUZZ_CHECK(materials[i].color[0] >= 0.0f && materials[i].color[0] <= 1e6f);
    conic_texture_destroy(materials[i].texture);
  }
  conic_memory_release(input.context, texts.bytes);
  fuzz_close(&input, status, 1);
  return 0;
}
