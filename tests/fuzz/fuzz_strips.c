/* Finished strips of a picture. Whatever a list of them says, those that count are the picture's, do not overlap, and
 * can be read; and read again they are the same. Checks are made right, as nobody guesses them. */
#include "tests/fuzz/fuzz.h"

#include "core/image/image_common.h"
#include "tests/fuzz/strips_example.h"

/* The picture as far as it is written: zeros. */
static const unsigned char part[STRIPS_EXAMPLE_PART];

static uint64_t check_of(const unsigned char *bytes, uint64_t room, uint64_t n) {
  return n <= room ? conic_hash_bytes(bytes, (size_t)n) : 0;
}

static void mend_checks(unsigned char *bytes, size_t n_bytes) {
  conic_strip_piece p;
  for (uint64_t at = STRIPS_EXAMPLE_HEAD; at + sizeof p <= n_bytes;) {
    unsigned char *following = bytes + at + sizeof p;
    uint64_t room = n_bytes - at - sizeof p;
    memcpy(&p, bytes + at, sizeof p);
    uint64_t n_before = p.place ? 0 : p.packed_bytes;
    p.checks[0] = p.place ? check_of(part, sizeof part, p.packed_bytes) : check_of(following, room, p.packed_bytes);
    p.checks[1] = n_before <= room ? check_of(following + n_before, room - n_before, p.pixel_bytes) : 0;
    p.check = conic_hash_bytes((const char *)&p + sizeof p.check, sizeof p - sizeof p.check);
    memcpy(bytes + at, &p, sizeof p);
    if (n_before > room || p.pixel_bytes > room - n_before)
      return;
    at += sizeof p + n_before + p.pixel_bytes;
  }
}

static void check_found_strips(const conic_strips_file *file) {
  unsigned char bytes[4096];
  int y = 0;
  for (size_t i = 0; i < file->n_found; i++) {
    const conic_strip_piece *p = &file->found[i].piece;
    FUZZ_CHECK(p->y >= y && p->y + p->n_rows <= p->y_end && p->y_end <= strips_example.height);
    FUZZ_CHECK(p->y == y || p->y == p->y_begin);
    y = p->y + p->n_rows;
    FUZZ_CHECK(conic_strips_file_get(file, &file->found[i], bytes) == CONIC_OK);
  }
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n_bytes) {
  conic_strips_file file, again;
  unsigned char *mended = malloc(n_bytes + 1);
  FUZZ_CHECK(mended);
  memcpy(mended, bytes, n_bytes);
  mend_checks(mended, n_bytes);
  fuzz_input written = fuzz_open(part, sizeof part), input = fuzz_open(mended, n_bytes);
  conic_status status =
      conic_strips_file_begin(input.context, input.path, written.path, STRIPS_EXAMPLE_KEY, &strips_example, 1, &file);
  if (status == CONIC_OK) {
    check_found_strips(&file);
    FUZZ_CHECK(conic_strips_file_begin(input.context, input.path, written.path, STRIPS_EXAMPLE_KEY, &strips_example, 1,
                                       &again) == CONIC_OK);
    FUZZ_CHECK(again.n_found == file.n_found);
    conic_strips_file_end(input.context, &again);
  }
  conic_strips_file_end(input.context, &file);
  close(written.descriptor);
  fuzz_close(&input, status, 0);
  free(mended);
  return 0;
}
