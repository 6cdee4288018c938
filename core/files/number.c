#include "core/files/number.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The powers of ten that a double holds exactly. */
static const double exact_powers[23] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                        1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

/* A decimal number as it was found: the digits from `digits` on, of which the first is not zero, stand before and after
 * the point; value = 0.d₁d₂d₃… × 10^magnitude. */
typedef struct decimal {
  const char *digits, *end;
  int64_t magnitude;
  uint64_t leading; /* the first 19 digits as an integer */
  int64_t n_digits;
} decimal;

/* More digits than these can only break a tie. */
enum { MAX_DIGITS = 800 };

static double infinity(void) {
  return 0x1p1023 * 2.0;
}

/* Exact for any number of digits: the C library rounds once, and reads whole numbers with an exponent the same in every
 * locale. */
static double convert_exactly(const decimal *source) {
  char text[MAX_DIGITS + 32];
  int n = 0;
  if (source->magnitude > 310)
    return infinity();
  if (source->magnitude < -330)
    return 0.0;
  for (const char *c = source->digits; c < source->end && n <= MAX_DIGITS; c++)
    if (*c != '.' && n < MAX_DIGITS)
      text[n++] = *c;
    else if (*c != '.' && *c != '0')
      text[n++] = '1';
  snprintf(text + n, 16, "e%d", (int)source->magnitude - n);
  return strtod(text, NULL);
}

static double convert(const decimal *source) {
  if (source->n_digits == 0)
    return 0.0;
  int64_t exponent10 = source->magnitude - source->n_digits;
  if (source->n_digits <= 19 && source->leading <= UINT64_C(1) << 53 && exponent10 >= -22 && exponent10 <= 22) {
    double exact = (double)source->leading;
    return exponent10 < 0 ? exact / exact_powers[-exponent10] : exact * exact_powers[exponent10];
  }
  return convert_exactly(source);
}

static int is_digit(char c) {
  return c >= '0' && c <= '9';
}

/* How much of `text` is the word, in any case; 0 where it is another. `word` is in lower case. */
static size_t match_word(const char *text, size_t length, const char *word) {
  size_t n = strlen(word);
  if (length < n)
    return 0;
  for (size_t i = 0; i < n; i++)
    if ((text[i] | 0x20) != word[i])
      return 0;
  return n;
}

static size_t parse_named(const char *text, size_t length, double *value) {
  size_t n = match_word(text, length, "infinity");
  if (!n)
    n = match_word(text, length, "inf");
  if (n) {
    *value = infinity();
    return n;
  }
  n = match_word(text, length, "nan");
  if (!n)
    return 0;
  *value = infinity() - infinity();
  if (n < length && text[n] == '(') { /* nan(ind) */
    const char *close = memchr(text + n, ')', length - n);
    n = close ? (size_t)(close - text) + 1 : n;
  }
  return n;
}

/* The exponent after the digits, bounded so that sums with it cannot overflow. Returns past it. */
static const char *parse_exponent(const char *text, const char *end, int64_t *exponent) {
  const char *c = text;
  int is_negative;
  *exponent = 0;
  if (c == end || (*c | 0x20) != 'e')
    return text;
  c++;
  is_negative = c < end && *c == '-';
  if (c < end && (*c == '-' || *c == '+'))
    c++;
  if (c == end || !is_digit(*c))
    return text;
  for (; c < end && is_digit(*c); c++)
    if (*exponent < INT64_C(1) << 50)
      *exponent = *exponent * 10 + (*c - '0');
  if (is_negative)
    *exponent = -*exponent;
  return c;
}

/* Collects digits and point; returns past them, or null where there is no digit. */
static const char *parse_digits(const char *text, const char *end, decimal *found) {
  const char *c = text;
  int has_point = 0, has_digit = 0;
  memset(found, 0, sizeof *found);
  for (; c < end; c++) {
    if (*c == '.' && !has_point) {
      has_point = 1;
      continue;
    }
    if (!is_digit(*c))
      break;
    has_digit = 1;
    if (!found->digits) {
      if (*c == '0') { /* a leading zero counts only behind the point */
        found->magnitude -= has_point;
        continue;
      }
      found->digits = c;
    }
    found->magnitude += !has_point;
    if (found->n_digits++ < 19)
      found->leading = found->leading * 10 + (uint64_t)(*c - '0');
  }
  found->end = c;
  return has_digit ? c : NULL;
}

size_t conic_number_parse(const char *text, size_t length, double *value) {
  const char *c = text, *end = text + length;
  decimal found;
  int64_t exponent;
  int is_negative = c < end && *c == '-';
  if (c < end && (*c == '-' || *c == '+'))
    c++;
  const char *after = parse_digits(c, end, &found);
  if (after) {
    after = parse_exponent(after, end, &exponent);
    found.magnitude += exponent;
    *value = convert(&found);
  } else {
    size_t n = parse_named(c, (size_t)(end - c), value);
    if (!n)
      return 0;
    after = c + n;
  }
  if (is_negative)
    *value = -*value;
  return (size_t)(after - text);
}

/* `n` digits, the first worth 10^exponent, as text: plainly where that is short, else with an exponent. */
static size_t lay_out(char *text, int is_negative, const char *digits, int n, int exponent) {
  char *c = text;
  while (n > 1 && digits[n - 1] == '0')
    n--;
  if (is_negative)
    *c++ = '-';
  int is_plain = exponent >= -5 && exponent < 16;
  int point = is_plain ? exponent : 0; /* the index of the digit that the point follows */
  if (point < 0) {
    *c++ = '0';
    *c++ = '.';
    for (int i = -1; i > point; i--)
      *c++ = '0';
  }
  for (int i = 0; i < n || i <= point; i++) {
    char digit = '0';
    if (i < n)
      digit = digits[i];
    *c++ = digit;
    if (i == point && i + 1 < n)
      *c++ = '.';
  }
  *c = 0;
  if (!is_plain)
    c += snprintf(c, 8, "e%d", exponent);
  return (size_t)(c - text);
}

/* `value` to `precision` significant digits. The C library's decimal point may be any; all that is no digit is left
 * out. */
static size_t print_digits(char text[CONIC_NUMBER_ROOM], double value, int precision) {
  char scientific[64], digits[24];
  int n = 0, exponent = 0, is_negative = 0;
  snprintf(scientific, sizeof scientific, "%.*e", precision - 1, value < 0.0 ? -value : value);
  const char *c = scientific;
  for (; *c && *c != 'e'; c++)
    if (is_digit(*c))
      digits[n++] = *c;
  for (; *c; c++) {
    is_negative |= *c == '-';
    if (is_digit(*c))
      exponent = exponent * 10 + (*c - '0');
  }
  return lay_out(text, value < 0.0, digits, n, is_negative ? -exponent : exponent);
}

/* Zero, infinity and NaN, which have no leading digit; 0 for other numbers. */
static size_t print_special(char text[CONIC_NUMBER_ROOM], double value) {
  uint64_t bits;
  memcpy(&bits, &value, sizeof bits);
  int is_negative = bits >> 63 != 0;
  const char *name = value != value ? "nan" : value == 0.0 ? (is_negative ? "-0" : "0") : is_negative ? "-inf" : "inf";
  if (value == value && value != 0.0 && value - value == 0.0)
    return 0;
  memcpy(text, name, strlen(name) + 1);
  return strlen(name);
}

size_t conic_number_print(char text[CONIC_NUMBER_ROOM], double value) {
  double again;
  size_t n = print_special(text, value);
  for (int precision = 15; n == 0 && precision < 18; precision++) {
    n = print_digits(text, value, precision);
    if (precision < 17 && (conic_number_parse(text, n, &again) != n || again != value))
      n = 0;
  }
  return n;
}

/* Floats of everyday size by exact integers in double: a candidate that reads back is right, however it was found. */
static size_t print_float_fast(char text[CONIC_NUMBER_ROOM], float value) {
  double size = value < 0.0f ? -(double)value : (double)value;
  char digits[12];
  int exponent = 0;
  if (!(size >= 1e-9 && size < 1e9))
    return 0;
  while (exponent < 8 && size >= exact_powers[exponent + 1])
    exponent++;
  while (exponent > -9 && size < (exponent > 0 ? exact_powers[exponent] : 1.0 / exact_powers[-exponent]))
    exponent--;
  for (int precision = 6; precision <= 9; precision++) {
    int scale = precision - 1 - exponent; /* -3 to 17 */
    double scaled = scale < 0 ? size / exact_powers[-scale] : size * exact_powers[scale];
    uint32_t number = (uint32_t)(scaled + 0.5);
    double again = scale < 0 ? (double)number * exact_powers[-scale] : (double)number / exact_powers[scale];
    if ((float)again != (float)size)
      continue;
    int n = snprintf(digits, sizeof digits, "%u", number); /* one digit more where rounding carried */
    return lay_out(text, value < 0.0f, digits, n, exponent + n - precision);
  }
  return 0;
}

size_t conic_number_print_float(char text[CONIC_NUMBER_ROOM], float value) {
  double again = 0.0;
  size_t n = print_special(text, (double)value);
  if (n == 0)
    n = print_float_fast(text, value);
  for (int precision = 6; n == 0 && precision < 10; precision++) {
    n = print_digits(text, (double)value, precision);
    if (precision < 9 && (conic_number_parse(text, n, &again) != n || (float)again != value))
      n = 0;
  }
  return n;
}
