/* Where inputs stand, as --place and shots have it. What is taken turns and scales evenly; a part of it is taken, too.
 */
#include "tests/fuzz/fuzz.h"

#include "source/input_places.h"

enum { N_INPUTS = 3 };

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n_bytes) {
  static const int is_kept[N_INPUTS] = {1, 0, 1};
  conic_place places[N_INPUTS];
  char text[4096], *part;
  if (n_bytes >= sizeof text)
    return -1;
  memcpy(text, bytes, n_bytes);
  text[n_bytes] = '\0';
  fuzz_input input = fuzz_open(bytes, 0);
  conic_status status = conic_places_read(input.context, text, N_INPUTS, places);
  FUZZ_CHECK(status == CONIC_OK || status == CONIC_ERROR_ARGUMENT);
  for (int i = 0; i < N_INPUTS && status == CONIC_OK; i++)
    FUZZ_CHECK(places[i].scale > 0.0 && places[i].scale < 1e21);
  int n_messages = fuzz_n_messages;
  FUZZ_CHECK(conic_places_part(input.context, text, is_kept, N_INPUTS, &part) == CONIC_OK);
  if (status == CONIC_OK)
    FUZZ_CHECK(conic_places_read(input.context, part, 2, places) == CONIC_OK);
  conic_memory_release(input.context, part);
  fuzz_n_messages = n_messages;
  fuzz_end(&input, status);
  return 0;
}
