#include "raster/kernels/tile_kernels.h"

#include <stddef.h>

#include "core/lanes/processor.h"

const char *conic_isa_name(conic_isa isa) {
  static const char *const names[CONIC_N_ISAS] = {"auto", "scalar", "sse2", "avx2", "avx512", "neon"};
  return (unsigned)isa < CONIC_N_ISAS ? names[isa] : NULL;
}

#if defined(__x86_64__)

conic_isa conic_isa_best(void) {
  return conic_has_avx512() ? CONIC_ISA_AVX512 : conic_has_avx2() ? CONIC_ISA_AVX2 : CONIC_ISA_SSE2;
}

const conic_tile_kernels *conic_tile_kernels_of(conic_isa isa) {
  switch (isa == CONIC_ISA_AUTO ? conic_isa_best() : isa) {
  case CONIC_ISA_SCALAR:
    return &conic_tile_kernels_scalar;
  case CONIC_ISA_SSE2:
    return &conic_tile_kernels_sse2;
  case CONIC_ISA_AVX2:
    return conic_has_avx2() ? &conic_tile_kernels_avx2 : NULL;
  case CONIC_ISA_AVX512:
    return conic_has_avx512() ? &conic_tile_kernels_avx512 : NULL;
  default:
    return NULL;
  }
}

#else

conic_isa conic_isa_best(void) {
#if defined(__aarch64__)
  return CONIC_ISA_NEON;
#else
  return CONIC_ISA_SCALAR;
#endif
}

const conic_tile_kernels *conic_tile_kernels_of(conic_isa isa) {
  if (isa == CONIC_ISA_AUTO)
    isa = conic_isa_best();
#if defined(__aarch64__)
  if (isa == CONIC_ISA_NEON)
    return &conic_tile_kernels_neon;
#endif
  return isa == CONIC_ISA_SCALAR ? &conic_tile_kernels_scalar : NULL;
}

#endif
