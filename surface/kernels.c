#include "surface/kernels.h"

#if defined(__x86_64__)

static int has_avx512(void) {
  return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
         __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512dq");
}

const conic_surface_kernels *conic_surface_kernels_of(conic_isa isa) {
  switch (isa) {
  case CONIC_ISA_AUTO:
    return has_avx512()                     ? &conic_surface_kernels_avx512
           : __builtin_cpu_supports("avx2") ? &conic_surface_kernels_avx2
                                            : &conic_surface_kernels_sse2;
  case CONIC_ISA_SCALAR:
    return &conic_surface_kernels_scalar;
  case CONIC_ISA_SSE2:
    return &conic_surface_kernels_sse2;
  case CONIC_ISA_AVX2:
    return __builtin_cpu_supports("avx2") ? &conic_surface_kernels_avx2 : NULL;
  case CONIC_ISA_AVX512:
    return has_avx512() ? &conic_surface_kernels_avx512 : NULL;
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
