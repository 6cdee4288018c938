/* Options structs across versions. Each begins with a size_t: its size where it was compiled. A later version adds
 * members at the end, never in padding, so that the size says which members exist. */
#pragma once

#include <stddef.h>

/* Sets the caller's struct of `size` bytes to the defaults `own`; members that only the caller knows become zero. */
void conic_options_give(void *theirs, size_t size, const void *own);

/* Defines TYPE_init_sized, which sets a struct of options to these defaults; all else is zero. */
/* NOLINTBEGIN(bugprone-macro-parentheses): types, which stand bare */
#define CONIC_DEFINE_OPTIONS(type, ...)                                                                                \
  void type##_init_sized(type *options, size_t size) {                                                                 \
    static const type own = {.size = sizeof own, __VA_ARGS__};                                                         \
    conic_options_give(options, size, &own);                                                                           \
  }
/* The same without any: all is zero. */
#define CONIC_DEFINE_ZERO_OPTIONS(type)                                                                                \
  void type##_init_sized(type *options, size_t size) {                                                                 \
    static const type own = {.size = sizeof own};                                                                      \
    conic_options_give(options, size, &own);                                                                           \
  }
/* NOLINTEND(bugprone-macro-parentheses) */

/* Replaces the defaults `own` by the caller's values; members that the caller's struct lacks stay. Returns 0 and
 * changes nothing for null, a wrong size (below a size_t's, no multiple of it, above 4096: not initialised), or a
 * member that only the caller knows and that is not zero: it asks for something that this version cannot do. */
int conic_options_take(void *own, const void *theirs);

/* Whether bytes are all zero, as reserved words must be. */
int conic_is_zero(const void *bytes, size_t n);
