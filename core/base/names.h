/* The names of an enumeration's values. */
#ifndef CONIC_NAMES_H
#define CONIC_NAMES_H

#include <stddef.h>

/* Defines const char *FUNCTION(TYPE value): its name of n, in the order of the values; null beyond them. */
/* NOLINTBEGIN(bugprone-macro-parentheses): types and names, which stand bare */
#define CONIC_DEFINE_NAMES(function, type, n, ...)                                                                     \
  const char *function(type value) {                                                                                   \
    static const char *const names[n] = {__VA_ARGS__};                                                                 \
    return (unsigned)value < (n) ? names[value] : NULL;                                                                \
  }
/* NOLINTEND(bugprone-macro-parentheses) */

#endif
