#include "core/lanes/instruction_sets.h"

#include "core/base/base.h"
#include "core/base/context_struct.h"

CONIC_DEFINE_NAMES(conic_isa_name, conic_isa, CONIC_N_ISAS, "auto", "scalar", "sse2", "avx2", "avx512", "neon")

conic_isa conic_isa_best(void) {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw") &&
      __builtin_cpu_supports("avx512dq"))
    return CONIC_ISA_AVX512;
  return __builtin_cpu_supports("avx2") ? CONIC_ISA_AVX2 : CONIC_ISA_SSE2;
#elif defined(__aarch64__)
  return CONIC_ISA_NEON;
#else
  return CONIC_ISA_SCALAR;
#endif
}

#define CONIC_IS_THIS(family, NAME, name) || isa == CONIC_ISA_##NAME

int conic_isa_is_here(conic_isa isa) {
  int is_built = isa == CONIC_ISA_AUTO || isa == CONIC_ISA_SCALAR CONIC_FOR_ISAS(CONIC_IS_THIS, );
  return is_built && isa <= conic_isa_best();
}

conic_status conic_isa_choose(conic_context *context, conic_isa asked, conic_isa *chosen) {
  conic_isa meant = asked == CONIC_ISA_AUTO ? context->options.isa : asked;
  *chosen = meant == CONIC_ISA_AUTO ? conic_isa_best() : meant;
  if (conic_isa_is_here(meant))
    return CONIC_OK;
  *chosen = CONIC_ISA_SCALAR;
  return conic_fail(context, CONIC_ERROR_UNSUPPORTED, "this machine or build has no %s",
                    conic_isa_name(meant) ? conic_isa_name(meant) : "such instruction set");
}
