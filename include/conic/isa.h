/* The instruction sets that the hot loops are written for; none changes a bit of any result. */
#ifndef CONIC_ISA_H
#define CONIC_ISA_H

#include "conic/status.h"

CONIC_BEGIN_C

/* On one machine, each set includes all sets before it. */
typedef enum conic_isa {
  CONIC_ISA_AUTO = 0,   /* the context's; for the context itself, the widest that this machine has */
  CONIC_ISA_SCALAR = 1, /* plain C, the reference of all others */
  CONIC_ISA_SSE2 = 2,
  CONIC_ISA_AVX2 = 3,
  CONIC_ISA_AVX512 = 4,
  CONIC_ISA_NEON = 5
} conic_isa;

#define CONIC_N_ISAS 6

/* "auto", "scalar", "sse2" …; null for a number that is no set. */
CONIC_API const char *conic_isa_name(conic_isa isa);

/* The widest that this machine has. */
CONIC_API conic_isa conic_isa_best(void);

CONIC_END_C
#endif
