/* Numbers from bytes and to bytes, whatever the machine's order is. */
#include "core/base/byte_order.h"
#include "tests/support/check.h"

int main(void) {
  const unsigned char bytes[9] = {0x81, 0x02, 0x03, 0x04, 0x05, 0x06, 0x07, 0x88, 0x99};
  const unsigned char one[8] = {0, 0, 0x80, 0x3f}, two[8] = {0, 0, 0, 0, 0, 0, 0, 0x40};
  unsigned char made[9];
  CHECK(conic_load_16(bytes) == 0x0281 && conic_load_32(bytes + 1) == 0x05040302);
  CHECK(conic_load_64(bytes) == UINT64_C(0x8807060504030281));
  CHECK(conic_load_big_16(bytes) == 0x8102 && conic_load_big_32(bytes) == 0x81020304);
  CHECK(conic_load_big_64(bytes + 1) == UINT64_C(0x0203040506078899));
  CHECK(conic_load_float(one) == 1.0f && conic_load_double(two) == 2.0);
  for (size_t n = 0; n <= 8; n++) {
    uint64_t wanted = n < 8 ? conic_load_64(bytes) & ((UINT64_C(1) << 8 * n) - 1) : conic_load_64(bytes);
    CHECK(conic_load_bits(bytes, n) == wanted);
    memset(made, 0x55, sizeof made);
    conic_store_bits(made, n, conic_load_64(bytes));
    CHECK(memcmp(made, bytes, n) == 0 && made[n] == 0x55);
  }
  conic_store_float(made, 1.0f);
  CHECK(memcmp(made, one, 4) == 0);
  conic_store_double(made, 2.0);
  CHECK(memcmp(made, two, 8) == 0);
  conic_store_big_64(made, UINT64_C(0x8102030405060788));
  CHECK(memcmp(made, bytes, 8) == 0);
  uint32_t words[2] = {0x04030281, 0x88070605};
  conic_turn_words(words, 2, 4);
  CHECK(memcmp(words, bytes, 8) == 0);
  return check_result();
}
