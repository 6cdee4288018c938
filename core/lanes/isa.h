/* Which instructions this processor has, of those that files are compiled for (CMakeLists.txt). */
#ifndef CONIC_PROCESSOR_H
#define CONIC_PROCESSOR_H

#if defined(__x86_64__)

static inline int conic_has_avx512(void) {
  return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
         __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512dq");
}

static inline int conic_has_avx2(void) {
  return __builtin_cpu_supports("avx2");
}

#endif

#endif
