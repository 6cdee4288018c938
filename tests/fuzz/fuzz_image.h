/* The pictures' targets: PFM is ours, EXR and PNG the libraries' with our layout around them. What is neither would
 * only fuzz other people's decoders and is left out. */
#pragma once

#include "tests/fuzz/fuzz.h"

/* A sky whose picture has light in it has light in every direction that it gives. */
static inline void fuzz_sky(conic_context *context, const conic_image *image) {
  const double up[3] = {0.0, 0.0, 1.0};
  double direction[3], light[3];
  conic_sky *sky;
  conic_status status = conic_sky_create(context, image, up, &sky);
  FUZZ_CHECK((status == CONIC_OK) == (sky != NULL) && (status == CONIC_OK || status == CONIC_ERROR_INPUT));
  for (uint64_t i = 0; i < 64 && sky; i++) {
    conic_sky_direction(sky, i, direction, light);
    double square = direction[0] * direction[0] + direction[1] * direction[1] + direction[2] * direction[2];
    FUZZ_CHECK(square > 0.999 && square < 1.001 && light[0] >= 0.0 && light[1] >= 0.0 && light[2] >= 0.0);
    FUZZ_CHECK(light[0] + light[1] + light[2] > 0.0 && light[0] + light[1] + light[2] < 1e14);
  }
  conic_sky_destroy(sky);
}

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
    int n_messages = fuzz_n_messages;
    fuzz_sky(input.context, &image);
    fuzz_n_messages = n_messages;
    conic_image_release(input.context, &image);
  }
  fuzz_close(&input, status, 1);
  return 0;
}
