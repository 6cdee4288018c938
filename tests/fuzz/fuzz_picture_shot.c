/* Pictures that say how they were made, in an EXR, a PNG or a TIFF; and shots by themselves. */
#include "tests/fuzz/fuzz.h"

#include "core/base/memory.h"
#include "core/pictures/picture_shot.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n_bytes) {
  fuzz_input input = fuzz_open(bytes, n_bytes);
  char *text;
  size_t n_text;
  conic_status status = conic_picture_shot_text(input.context, input.path, &text, &n_text);
  if (status == CONIC_OK && text)
    FUZZ_CHECK(n_text > 0 && text[n_text] == '\0');
  conic_memory_release(input.context, text);
  fuzz_close(&input, status, 0);
  return 0;
}
