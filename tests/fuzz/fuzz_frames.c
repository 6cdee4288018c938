/* Lists of finished frames. What is read can be written, and read again to the same. */
#include <string.h>

#include "cli/render/frames_file.h"
#include "tests/fuzz/fuzz.h"

enum { N_FRAMES = 16 };
static const char key[] = "0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef";
static const char written[] = "written.frames";

static size_t count_files(const cli_frames_file *frames) {
  size_t n = 0;
  for (int i = 0; i < frames->n_frames; i++) {
    cli_finished_file file;
    size_t at = frames->begins[i];
    while (at != SIZE_MAX && cli_frames_file_next(frames, &at, &file)) {
      FUZZ_CHECK(file.n_name > 0 && file.name + file.n_name <= frames->text + frames->n_bytes);
      n++;
    }
  }
  return n;
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n_bytes) {
  cli_frames_file frames, again;
  fuzz_input input = fuzz_open(bytes, n_bytes);
  conic_status status = cli_frames_file_read(input.context, input.path, key, N_FRAMES, &frames);
  if (status == CONIC_OK) {
    FUZZ_CHECK(cli_frames_file_write(input.context, written, key, &frames) == CONIC_OK);
    FUZZ_CHECK(cli_frames_file_read(input.context, written, key, N_FRAMES, &again) == CONIC_OK);
    FUZZ_CHECK(count_files(&again) == count_files(&frames));
    cli_frames_file_release(input.context, &again);
  }
  cli_frames_file_release(input.context, &frames);
  fuzz_close(&input, status, 1);
  return 0;
}
