/* What is put aside comes back as it went in, held in memory, in a file, or first the one and then the other. */
#include "core/files/spool.h"

#include "tests/support/files.h"
#include "tests/support/random_numbers.h"

enum { N_BYTES = 3 * CONIC_SPOOL_SLAB + 12345 };

/* Reads pieces of any length from anywhere. */
static void check_bytes(const conic_spool *spool, const unsigned char *bytes, unsigned char *found, size_t n) {
  uint64_t state = 3;
  CHECK(conic_spool_bytes(spool) == n);
  for (int i = 0; i < 20; i++) {
    size_t begin = i ? (size_t)(random_unit(&state) * (double)n) : 0;
    size_t end = i ? begin + (size_t)(random_unit(&state) * (double)(n - begin)) : n;
    CHECK_OK(conic_spool_read(spool, begin, found, end - begin));
    CHECK(memcmp(found, bytes + begin, end - begin) == 0);
  }
}

/* In pieces of up to `most` bytes, of which `memory_bytes` may be held. */
static void test_pieces(conic_context *context, const unsigned char *bytes, size_t most, size_t memory_bytes) {
  const char *path = files_path("beside");
  unsigned char *found = malloc(N_BYTES);
  conic_spool spool;
  uint64_t state = 4;
  if (!found)
    exit(1);
  conic_spool_begin(context, path, memory_bytes, &spool);
  for (size_t at = 0; at < N_BYTES;) {
    size_t n = (size_t)(random_unit(&state) * (double)most), left = N_BYTES - at;
    n = n < left ? n : left;
    CHECK_OK(conic_spool_append(&spool, bytes + at, n));
    at += n;
  }
  CHECK((spool.file.descriptor < 0) == (memory_bytes >= N_BYTES));
  check_bytes(&spool, bytes, found, N_BYTES);
  conic_spool_end(&spool);
  free(found);
}

int main(void) {
  conic_context *context = files_context();
  unsigned char *bytes = malloc(N_BYTES);
  uint64_t state = 2;
  if (!bytes)
    return 1;
  for (size_t i = 0; i < N_BYTES; i++)
    bytes[i] = (unsigned char)(256.0 * random_unit(&state));
  for (size_t memory_bytes = 0; memory_bytes <= 2 * N_BYTES; memory_bytes += N_BYTES / 2) {
    test_pieces(context, bytes, 1 << 16, memory_bytes);
    test_pieces(context, bytes, N_BYTES, memory_bytes);
  }
  free(bytes);
  files_end(context);
  return check_result();
}
