/* Comparisons for qsort and bsearch. */
#pragma once

/* Below, at or above zero, as a is below, at or above b. */
#define CONIC_ORDER(a, b) (((a) > (b)) - ((a) < (b)))

/* Defines a static comparison of structs by a member; and by one that decides where the first is the same. */
/* NOLINTBEGIN(bugprone-macro-parentheses): types and members, which stand bare */
#define CONIC_DEFINE_ORDER(function, type, member)                                                                     \
  static int function(const void *a, const void *b) {                                                                  \
    const type *first = a, *second = b;                                                                                \
    return CONIC_ORDER(first->member, second->member);                                                                 \
  }
#define CONIC_DEFINE_ORDER_BY_TWO(function, type, member, other)                                                       \
  static int function(const void *a, const void *b) {                                                                  \
    const type *first = a, *second = b;                                                                                \
    int order = CONIC_ORDER(first->member, second->member);                                                            \
    return order ? order : CONIC_ORDER(first->other, second->other);                                                   \
  }
/* NOLINTEND(bugprone-macro-parentheses) */
