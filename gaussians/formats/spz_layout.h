/* How .spz, versions 1 to 4, lies in a file. */
#pragma once

#include "gaussians/formats/gaussian_formats.h"

enum {
  CONIC_SPZ_GZIP_HEADER = 16,
  CONIC_SPZ_HEADER = 32,
  CONIC_SPZ_STREAMS = 6, /* means, opacities, colours, scales, rotations, harmonics */
  CONIC_SPZ_ANTIALIASED = 1,
  CONIC_SPZ_HAS_EXTENSIONS = 2
};

/* Bytes a Gaussian of each stream. */
typedef struct conic_spz_layout {
  size_t bytes[CONIC_SPZ_STREAMS], all_bytes;
} conic_spz_layout;

static inline conic_spz_layout conic_spz_find_layout(uint32_t version, int sh_degree) {
  conic_spz_layout layout = {
      {version == 1 ? 6 : 9, 1, 3, 3, version < 3 ? 3 : 4, conic_harmonics_of_degree(sh_degree) - 3}, 0};
  for (int i = 0; i < CONIC_SPZ_STREAMS; i++)
    layout.all_bytes += layout.bytes[i];
  return layout;
}
