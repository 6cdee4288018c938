/* Gaussian scenes for tests. */
#pragma once

#include "gaussians/scene/gaussian_set.h"
#include "tests/support/files.h"
#include "tests/support/random_numbers.h"

/* Gaussians within 2 of the origin, of scales that every format holds. */
static inline conic_gaussians gaussians_random(conic_context *context, size_t n, int sh_degree, unsigned fields) {
  conic_gaussians made;
  uint64_t state = n + 100 * (uint64_t)sh_degree;
  if (conic_gaussians_allocate(context, n, sh_degree, fields, &made) != CONIC_OK)
    exit(1);
  for (size_t i = 0; i < n; i++) {
    double length = 0.0, q[4];
    for (int k = 0; k < 4; k++) {
      q[k] = 2.0 * random_unit(&state) - 1.0;
      length += q[k] * q[k];
    }
    for (int k = 0; k < 4; k++)
      made.rotation[k][i] = (float)(q[k] / sqrt(length));
    for (int k = 0; k < 3; k++) {
      made.position[k][i] = (float)(4.0 * random_unit(&state) - 2.0);
      if (made.scale[k])
        made.scale[k][i] = (float)(0.01 + 0.2 * random_unit(&state));
    }
    made.opacity[i] = (float)(0.05 + 0.9 * random_unit(&state));
    for (size_t k = 0; k < conic_harmonics_of_degree(sh_degree); k++)
      conic_gaussians_put_harmonic(&made, i, k, (float)((k < 3 ? 1.0 : 0.6) * (2.0 * random_unit(&state) - 1.0)));
  }
  return made;
}

/* Whether this build has what files of a kind need. */
static inline int gaussians_have(conic_gaussian_kind kind) {
  const char *needed = kind == CONIC_GAUSSIANS_SPZ ? "zstd" : kind == CONIC_GAUSSIANS_SOG ? "libwebp" : NULL;
  for (int i = 0; needed && conic_feature_at(i); i++)
    if (strcmp(conic_feature_at(i)->name, needed) == 0)
      return conic_feature_at(i)->available;
  return 1;
}
