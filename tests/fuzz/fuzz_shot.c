/* The text of shots, and pictures that carry one. What is read is written, and read again, as the same. */
#include "tests/fuzz/fuzz.h"

static void count_difference(void *cookie, const char *field, const char *a, const char *b) {
  (void)field;
  (void)a;
  (void)b;
  ++*(int *)cookie;
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n_bytes) {
  fuzz_input input = fuzz_open(bytes, n_bytes);
  conic_shot_file *file, *again;
  char *text, key[CONIC_SHOT_KEY_ROOM], second[CONIC_SHOT_KEY_ROOM];
  int n = 0;
  conic_status status = conic_shot_file_read(input.context, input.path, &file);
  FUZZ_CHECK((status == CONIC_OK) == (file != NULL));
  if (file) {
    FUZZ_CHECK(conic_shot_file_print(input.context, file, CONIC_SHOT_WHOLE, &text) == CONIC_OK);
    FUZZ_CHECK(conic_shot_file_parse(input.context, "again", text, strlen(text), &again) == CONIC_OK);
    FUZZ_CHECK(conic_shot_file_compare(input.context, file, again, count_difference, &n) == CONIC_OK && n == 0);
    FUZZ_CHECK(conic_shot_file_key(input.context, file, key) == CONIC_OK);
    FUZZ_CHECK(conic_shot_file_key(input.context, again, second) == CONIC_OK && strcmp(key, second) == 0);
    conic_shot_text_release(input.context, text);
    conic_shot_file_destroy(input.context, again);
  }
  conic_shot_file_destroy(input.context, file);
  fuzz_close(&input, status, 0);
  return 0;
}
