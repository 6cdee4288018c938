#include "surface/kernels/surface_kernels.h"

#include "core/lanes/processor.h"

#if defined(__x86_64__)

const conic_surface_kernels *conic_surface_kernels_of(conic_isa isa) {
  switch (isa) {
  case CONIC_ISA_AUTO:
    return conic_has_avx512() ? &conic_surface_kernels_avx512
           : conic_has_avx2() ? &conic_surface_kernels_avx2
                              : &conic_surface_kernels_sse2;
  case CONIC_ISA_SCALAR:
    return &conic_surface_kernels_scalar;
  case CONIC_ISA_SSE2:
    return &conic_surface_kernels_sse2;
  case CONIC_ISA_AVX2:
    return conic_has_avx2() ? &conic_surface_kernels_avx2 : NULL;
  case CONIC_ISA_AVX512:
    return conic_has_avx512() ? &conic_surface_kernels_avx512 : NULL;
  default:
    return NULL;
  }
}

#else

const conic_surface_kernels *conic_surface_kernels_of(conic_isa isa) {
#if defined(__aarch64__)
  if (isa == CONIC_ISA_AUTO || isa == CONIC_ISA_NEON)
    return &conic_surface_kernels_neon;
#endif
  return isa == CONIC_ISA_AUTO || isa == CONIC_ISA_SCALAR ? &conic_surface_kernels_scalar : NULL;
}

#endif
