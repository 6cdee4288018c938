/* Which instruction sets loops are written for, and which of them this build and this machine have: the one place that
 * knows.
 *
 * A family of loops is a table, a struct of functions. It has one text in plain C and one in lanes
 * (core/lanes/lanes.h), which is compiled once for each instruction set. FAMILY_init fills a table with plain C; then
 * each allowed instruction set, the narrowest first, overwrites the slots that it has. */
#ifndef CONIC_INSTRUCTION_SETS_H
#define CONIC_INSTRUCTION_SETS_H

#include "conic/context.h"

/* DO for each instruction set of this build besides plain C, the narrowest first: with the family, the set's name in
 * capitals, and in lower case. */
#if defined(__x86_64__)
#define CONIC_FOR_ISAS(DO, family) DO(family, SSE2, sse2) DO(family, AVX2, avx2) DO(family, AVX512, avx512)
#elif defined(__aarch64__)
#define CONIC_FOR_ISAS(DO, family) DO(family, NEON, neon)
#else
#define CONIC_FOR_ISAS(DO, family)
#endif

/* Whether this build and this machine have it; CONIC_ISA_AUTO is always there. */
int conic_isa_is_here(conic_isa isa);

/* Finds the set that `asked` stands for: CONIC_ISA_AUTO means the context's choice, and if that is AUTO, too, the best.
 * Errors: UNSUPPORTED where it is not here; *chosen is then plain C. */
conic_status conic_isa_choose(conic_context *context, conic_isa asked, conic_isa *chosen);

/* NOLINTBEGIN(bugprone-macro-parentheses): types and names, which stand bare */
#define CONIC_DECLARE_LOOPS_OF(family, NAME, name) void family##_##name(family *loops);
#define CONIC_OVERWRITE_LOOPS(family, NAME, name)                                                                      \
  if (isa >= CONIC_ISA_##NAME)                                                                                         \
    family##_##name(loops);

/* Declares the functions that fill the tables of a family (a type), and FAMILY_init, which fills one for an instruction
 * set that is here; CONIC_ISA_AUTO is the best. */
#define CONIC_DECLARE_LOOPS(family)                                                                                    \
  void family##_scalar(family *loops);                                                                                 \
  CONIC_FOR_ISAS(CONIC_DECLARE_LOOPS_OF, family)                                                                       \
  void family##_init(family *loops, conic_isa isa)

#define CONIC_DEFINE_LOOPS(family)                                                                                     \
  void family##_init(family *loops, conic_isa isa) {                                                                   \
    isa = isa == CONIC_ISA_AUTO ? conic_isa_best() : isa;                                                              \
    family##_scalar(loops);                                                                                            \
    CONIC_FOR_ISAS(CONIC_OVERWRITE_LOOPS, family)                                                                      \
  }

/* Begins the function that fills a table, in a file that is compiled for one instruction set. */
#define CONIC_FILL_LOOPS_BY(family, name) void family##_##name(family *loops)
/* NOLINTEND(bugprone-macro-parentheses) */
#if defined(__AVX512F__)
#define CONIC_FILL_LOOPS(family) CONIC_FILL_LOOPS_BY(family, avx512)
#elif defined(__AVX2__)
#define CONIC_FILL_LOOPS(family) CONIC_FILL_LOOPS_BY(family, avx2)
#elif defined(__aarch64__)
#define CONIC_FILL_LOOPS(family) CONIC_FILL_LOOPS_BY(family, neon)
#else
#define CONIC_FILL_LOOPS(family) CONIC_FILL_LOOPS_BY(family, sse2)
#endif

#endif
