/* Gaussian scenes for tests. */
#pragma once

#include "core/base/byte_order.h"
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

enum { KSPLAT_ROOM = 8192 };

/* Three Gaussians of degree 1 and one of degree 0 as .ksplat: sections of two and one buckets, and an empty one. Row i
 * has the mean (i, 2, -0.5), scales 0.5, 0.25, 2, a rotation about x, the colours 0, 51, 255, the opacity 0.4 and
 * harmonics k / 8 - 0.5; returns the length. */
static inline size_t gaussians_put_ksplat(int level, unsigned char bytes[KSPLAT_ROOM]) {
  static const float shape[7] = {0.5f, 0.25f, 2.0f, 0.0f, -1.0f, 0.0f, 0.0f};
  static const struct {
    uint32_t count, most, n_full, n_partial, degree;
  } sections[3] = {{3, 4, 1, 1, 1}, {0, 2, 0, 0, 0}, {1, 1, 0, 1, 0}};
  const size_t width = level ? 2 : 4, harmonic_width = 4 >> level;
  size_t n = 4096 + 3 * 1024, row = 0;
  memset(bytes, 0, KSPLAT_ROOM);
  bytes[1] = 1;
  conic_store_32(bytes + 4, 3);
  conic_store_32(bytes + 16, 4);
  conic_store_bits(bytes + 20, 2, (uint64_t)level);
  conic_store_float(bytes + 36, -2.0f);
  conic_store_float(bytes + 40, 2.0f);
  for (size_t i = 0; i < 3; i++) {
    unsigned char *header = bytes + 4096 + 1024 * i;
    const uint32_t n_buckets = sections[i].n_full + sections[i].n_partial, n_sh = sections[i].degree ? 9 : 0;
    const uint32_t numbers[10] = {sections[i].count,  sections[i].most,     2, n_buckets, 0, 12, 1000, 0,
                                  sections[i].n_full, sections[i].n_partial};
    for (size_t k = 0; k < 10; k++)
      conic_store_32(header + 4 * k, numbers[k]);
    conic_store_float(header + 16, 4.0f);
    conic_store_32(header + 40, sections[i].degree);
    for (uint32_t k = 0; k < sections[i].n_partial; k++, n += 4)
      conic_store_32(bytes + n, 1);
    for (uint32_t k = 0; k < n_buckets; k++, n += 12)
      conic_store_float(bytes + n, (float)(2 * (row / 2) + 2 * k)); /* their middles are 0, 2 and 2 */
    for (uint32_t r = 0; r < sections[i].most; r++) {
      const double mean[3] = {(double)(row + r), 2.0, -0.5}, middle[3] = {i == 2 ? 2.0 : 2.0 * (r / 2), 0.0, 0.0};
      for (size_t k = 0; k < 3; k++, n += width)
        if (level)
          conic_store_bits(bytes + n, 2, (uint64_t)((mean[k] - middle[k]) * 500.0 + 1000.0));
        else
          conic_store_float(bytes + n, (float)mean[k]);
      for (size_t k = 0; k < 7; k++, n += width)
        if (level)
          conic_store_bits(bytes + n, 2, conic_half_of_float(shape[k]));
        else
          conic_store_float(bytes + n, shape[k]);
      memcpy(bytes + n, "\0\63\377\146", 4);
      n += 4;
      for (uint32_t k = 0; k < n_sh; k++, n += harmonic_width)
        if (level == 0)
          conic_store_float(bytes + n, (float)k / 8.0f - 0.5f);
        else if (level == 1)
          conic_store_bits(bytes + n, 2, conic_half_of_float((float)k / 8.0f - 0.5f));
        else
          bytes[n] = (unsigned char)(((double)k / 8.0 + 1.5) / 4.0 * 255.0 + 0.5);
    }
    row += sections[i].count;
  }
  return n;
}

/* Whether this build has what files of a kind need. */
static inline int gaussians_have(conic_gaussian_kind kind) {
  const char *needed = kind == CONIC_GAUSSIANS_SPZ ? "zstd" : kind == CONIC_GAUSSIANS_SOG ? "libwebp" : NULL;
  for (int i = 0; needed && conic_feature_at(i); i++)
    if (strcmp(conic_feature_at(i)->name, needed) == 0)
      return conic_feature_at(i)->available;
  return 1;
}

static inline conic_gaussians gaussians_read_again(conic_context *context, const char *path, int keeps_source) {
  conic_gaussians scene;
  conic_gaussians_read_options options;
  conic_gaussians_read_options_init(&options);
  options.keeps_source = keeps_source;
  CHECK_OK(conic_gaussians_read(context, path, &options, &scene));
  CHECK(unlink(path) == 0);
  return scene;
}
