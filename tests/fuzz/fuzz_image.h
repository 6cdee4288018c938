/* The pictures' targets: PFM is ours, EXR and PNG the libraries' with our layout around them. What is neither would
 * only fuzz other people's decoders and is left out. */
#ifndef CONIC_FUZZ_IMAGE_H
#define CONIC_FUZZ_IMAGE_H

#include "tests/fuzz/fuzz.h"

static inline int fuzz_image(const uint8_t *bytes, size_t n_bytes, const char *magic, size_t n_magic) {
  conic_image image;
  if (n_bytes < n_magic || memcmp(bytes, magic, n_magic) != 0)
    return -1;
  fuzz_input input = fuzz_open(bytes, n_bytes);
  conic_status status = conic_image_read(input.context, input.path, &image);
  if (status == CONIC_OK) {
    FUZZ_CHECK(image.width >= 1 && image.height >= 1);
    for (int plane = 0; plane < CONIC_N_PLANES; plane++)
      conic_image_hash(&image, (conic_plane)plane); /* looks at every sample */
    conic_image_release(input.context, &image);
  }
  fuzz_close(&input, status, 1);
  return 0;
}

#endif
