/* SHA-256 of texts whose sums are known, whatever the pieces that they come in. */
#include "core/files/sha256.h"
#include "tests/support/check.h"

static void check_text(const char *text, size_t n_piece, const char *expected) {
  char found[CONIC_SHA256_ROOM];
  conic_sha256 sum;
  size_t n = strlen(text);
  conic_sha256_begin(&sum);
  for (size_t at = 0; at < n; at += n_piece)
    conic_sha256_add(&sum, text + at, n - at < n_piece ? n - at : n_piece);
  conic_sha256_end(&sum, found);
  CHECK(strcmp(found, expected) == 0);
}

/* A processor's own instructions, which take many bytes at a time, and plain C, which takes few. */
static void check_long(void) {
  static unsigned char bytes[100000];
  uint32_t random = 1;
  for (size_t i = 0; i < sizeof bytes; i++) {
    random = random * 1664525u + 1013904223u;
    bytes[i] = (unsigned char)(random >> 24);
  }
  for (size_t n = 4090; n < sizeof bytes; n += 7919) {
    conic_sha256 whole, pieces, begun;
    char first[CONIC_SHA256_ROOM], second[CONIC_SHA256_ROOM], third[CONIC_SHA256_ROOM];
    conic_sha256_begin(&begun);
    conic_sha256_add(&begun, bytes, n % 64 + 1);
    conic_sha256_add(&begun, bytes + n % 64 + 1, n - n % 64 - 1);
    conic_sha256_begin(&whole);
    conic_sha256_begin(&pieces);
    conic_sha256_add(&whole, bytes, n);
    for (size_t at = 0; at < n; at += 1000)
      conic_sha256_add(&pieces, bytes + at, n - at < 1000 ? n - at : 1000);
    conic_sha256_end(&whole, first);
    conic_sha256_end(&pieces, second);
    conic_sha256_end(&begun, third);
    CHECK(strcmp(first, second) == 0 && strcmp(first, third) == 0);
  }
}

int main(void) {
  static const char two_blocks[] = "abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq";
  for (size_t n_piece = 1; n_piece < 70; n_piece += 3) {
    check_text("", n_piece, "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
    check_text("abc", n_piece, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    check_text(two_blocks, n_piece, "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  }
  for (size_t n_piece = 1; n_piece < 70; n_piece += 7) /* the padding fills a block of its own */
    check_text("aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa", n_piece,
               "ffe054fe7ae0cb6dc65c3af9b61d5209f439851db43d0ba5997337df154668eb");
  check_long();
  return check_result();
}
