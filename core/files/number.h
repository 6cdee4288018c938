/* Decimal numbers to doubles and back, correctly rounded in any locale and with any C library. */
#pragma once

#include <stddef.h>

static inline int conic_is_digit(char c) {
  return c >= '0' && c <= '9';
}

/* Reads the number at the start of `text`, which has `length` bytes: sign, digits with an optional point, optional
 * exponent; or nan, inf, infinity in any case. Rounds to nearest, ties to even; too large a number gives infinity.
 * Returns how many bytes were read, 0 where there is no number. */
size_t conic_number_parse(const char *text, size_t length, double *value);

enum { CONIC_NUMBER_ROOM = 32 };

/* Prints the fewest digits that conic_number_parse reads back as `value`, with a terminating zero; returns the
 * length. */
size_t conic_number_print(char text[CONIC_NUMBER_ROOM], double value);

/* The same for a number that is rounded to float after reading. */
size_t conic_number_print_float(char text[CONIC_NUMBER_ROOM], float value);
