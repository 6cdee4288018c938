/* Lists of what is finished. What is read can be written, and read again to the same. */
#include "tests/fuzz/fuzz.h"

#include "core/files/finished.h"

static const char key[] = "0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef";
static const char written[] = "written.frames";

static size_t count_files(const conic_finished *list) {
  conic_finished_part part;
  uint64_t numbers[2];
  size_t n = 0;
  for (size_t at = 0; conic_finished_next(list, &at, &part); n++) {
    conic_finished_file file;
    FUZZ_CHECK(part.words + part.n_words < list->text + list->n_bytes);
    conic_finished_numbers(&part, "frame", numbers, 2);
    for (size_t file_at = part.files_at; conic_finished_next_file(list, &file_at, &file); n++)
      FUZZ_CHECK(file.n_name > 0 && file.name + file.n_name <= list->text + list->n_bytes);
  }
  return n;
}

static void write_all(const conic_finished *list) {
  conic_finished_part part;
  FILE *stream = fopen(written, "wb");
  FUZZ_CHECK(stream != NULL);
  conic_finished_write_head(stream, "frames", key);
  for (size_t at = 0; conic_finished_next(list, &at, &part);)
    conic_finished_write_part(stream, list, &part);
  FUZZ_CHECK(fclose(stream) == 0);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n_bytes) {
  conic_finished list, again;
  fuzz_input input = fuzz_open(bytes, n_bytes);
  conic_status status = conic_finished_read(input.context, input.path, "frames", key, &list);
  if (status == CONIC_OK) {
    write_all(&list);
    FUZZ_CHECK(conic_finished_read(input.context, written, "frames", key, &again) == CONIC_OK);
    FUZZ_CHECK(count_files(&again) == count_files(&list));
    conic_finished_release(input.context, &again);
    remove(written);
  }
  conic_finished_release(input.context, &list);
  fuzz_close(&input, status, 1);
  return 0;
}
