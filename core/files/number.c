#include "core/files/number.h"

#include "core/base/base.h"

/* The powers of ten that a double holds exactly. */
static const double exact_powers[23] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                        1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

/* A decimal number as found: value = 0.d₁d₂d₃… × 10^magnitude. Its digits begin at `digits`, the first one not zero,
 * and stand before and after the point. */
typedef struct decimal {
  const char *digits, *end;
  int64_t magnitude;
  uint64_t leading; /* the first 19 digits as an integer */
  int64_t n_digits;
} decimal;

/* A natural number, least significant word first. There is room for 800 digits shifted by 4100 bits. */
enum { MAX_WORDS = 256, MAX_DIGITS = 800 };

typedef struct natural {
  uint32_t words[MAX_WORDS];
  int n;
} natural;

static void multiply_add(natural *number, uint32_t factor, uint32_t addend) {
  uint64_t carry = addend;
  for (int i = 0; i < number->n; i++) {
    carry += (uint64_t)number->words[i] * factor;
    number->words[i] = (uint32_t)carry;
    carry >>= 32;
  }
  if (carry)
    number->words[number->n++] = (uint32_t)carry;
}

/* Returns whether there was a remainder. */
static int divide(natural *number, uint32_t divisor) {
  uint64_t rest = 0;
  for (int i = number->n - 1; i >= 0; i--) {
    rest = rest << 32 | number->words[i];
    number->words[i] = (uint32_t)(rest / divisor);
    rest %= divisor;
  }
  while (number->n > 0 && !number->words[number->n - 1])
    number->n--;
  return rest != 0;
}

/* The number's most significant 64 bits, with the highest set; *n_below: how many bits are below them (negative for a
 * number of fewer than 64 bits); *has_rest: one of those is set. */
static uint64_t leading_bits(const natural *number, int *n_below, int *has_rest) {
  uint64_t bits = 0;
  int taken = 0, i_word = number->n - 1, shift = 0;
  while (!(number->words[i_word] << shift & 0x80000000u))
    shift++;
  for (; taken < 64 && i_word >= 0; i_word--) {
    uint64_t word = number->words[i_word];
    int room = 64 - taken, width = taken == 0 ? 32 - shift : 32;
    if (room >= width)
      bits |= word << (room - width);
    else {
      bits |= word >> (width - room);
      *has_rest |= (word << (64 - (width - room))) != 0;
    }
    taken += width;
  }
  for (; i_word >= 0; i_word--)
    *has_rest |= number->words[i_word] != 0;
  *n_below = 32 * number->n - shift - 64;
  return bits;
}

static double power_of_two(int exponent) {
  uint64_t bits = exponent >= -1022 ? (uint64_t)(exponent + 1023) << 52 : UINT64_C(1) << (exponent + 1074);
  return conic_double_of_bits(bits);
}

static double infinity(void) {
  return power_of_two(1023) * 2.0;
}

/* (bits + a little, if has_rest) × 2^exponent, rounded to the 53 bits of a double, or fewer for a subnormal one. */
static double round_to_double(uint64_t bits, int exponent, int has_rest) {
  int dropped = exponent + 11 < -1074 ? -1074 - exponent : 11;
  if (dropped > 64)
    return 0.0;
  uint64_t kept = dropped == 64 ? 0 : bits >> dropped;
  uint64_t rest = bits << (64 - dropped), half = UINT64_C(1) << 63;
  if (dropped == 64)
    rest = bits;
  if (rest > half || (rest == half && (has_rest || (kept & 1))))
    kept++;
  if (exponent + dropped > 971)
    return infinity();
  return (double)kept * power_of_two(exponent + dropped);
}

static natural natural_of_digits(const decimal *source, int64_t *n_digits) {
  natural number = {.n = 0};
  *n_digits = 0;
  for (const char *c = source->digits; c < source->end; c++) {
    if (*c == '.')
      continue;
    if (*n_digits == MAX_DIGITS) { /* later digits can only break a tie */
      if (*c == '0')
        continue;
      multiply_add(&number, 10, 1);
      ++*n_digits;
      break;
    }
    multiply_add(&number, 10, (uint32_t)(*c - '0'));
    ++*n_digits;
  }
  return number;
}

/* Exact for any number of digits: a quotient of natural numbers, rounded once. */
static double convert_exactly(const decimal *source) {
  int64_t n_digits;
  int n_below, has_rest = 0, n_shifted_words = 0;
  if (source->magnitude > 310)
    return infinity();
  if (source->magnitude < -330)
    return 0.0;
  natural number = natural_of_digits(source, &n_digits);
  int exponent10 = (int)(source->magnitude - n_digits);
  for (; exponent10 >= 9; exponent10 -= 9)
    multiply_add(&number, 1000000000u, 0);
  for (; exponent10 > 0; exponent10--)
    multiply_add(&number, 10, 0);
  if (exponent10 < 0) { /* 3.33 bits for each power of ten, and 70 to spare for the quotient */
    n_shifted_words = (-exponent10 * 10 / 3 + 70) / 32 + 1;
    memmove(number.words + n_shifted_words, number.words, (size_t)number.n * sizeof *number.words);
    memset(number.words, 0, (size_t)n_shifted_words * sizeof *number.words);
    number.n += n_shifted_words;
  }
  for (; exponent10 <= -9; exponent10 += 9)
    has_rest |= divide(&number, 1000000000u);
  for (; exponent10 < 0; exponent10++)
    has_rest |= divide(&number, 10);
  uint64_t bits = leading_bits(&number, &n_below, &has_rest);
  return round_to_double(bits, n_below - 32 * n_shifted_words, has_rest);
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

/* How many bytes of `text` are the word, in any case; 0 for another word. `word` is in lower case. */
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

/* Past what Visual C++ writes behind the point of "1." for what is no number: #INF, #IND, #QNAN, #SNAN, and digits. */
static const char *parse_hash(const char *c, const char *end, double *value) {
  static const char *const names[] = {"inf", "ind", "qnan", "snan"};
  for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
    const size_t n = match_word(c + 1, (size_t)(end - c - 1), names[i]);
    if (!n)
      continue;
    *value = i ? infinity() - infinity() : infinity();
    for (c += 1 + n; c < end && conic_is_digit(*c);)
      c++;
    return c;
  }
  return c;
}

/* The exponent after the digits, limited so that sums with it cannot overflow. Returns past it. */
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
  if (c == end || !conic_is_digit(*c))
    return text;
  for (; c < end && conic_is_digit(*c); c++)
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
    if (!conic_is_digit(*c))
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
    if (after < end && *after == '#' && after > c + 1 && after[-1] == '.')
      after = parse_hash(after, end, value);
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

/* `n` digits, the first worth 10^exponent, as text: without an exponent if that is short. */
static size_t lay_out_digits(char *text, int is_negative, const char *digits, int n, int exponent) {
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

/* `value` to `precision` significant digits. The C library's decimal point may be any character; only digits are
 * kept. */
static size_t print_digits(char text[CONIC_NUMBER_ROOM], double value, int precision) {
  char scientific[64], digits[24];
  int n = 0, exponent = 0, is_negative = 0;
  snprintf(scientific, sizeof scientific, "%.*e", precision - 1, value < 0.0 ? -value : value);
  const char *c = scientific;
  for (; *c && *c != 'e'; c++)
    if (conic_is_digit(*c))
      digits[n++] = *c;
  for (; *c; c++) {
    is_negative |= *c == '-';
    if (conic_is_digit(*c))
      exponent = exponent * 10 + (*c - '0');
  }
  return lay_out_digits(text, value < 0.0, digits, n, is_negative ? -exponent : exponent);
}

/* Zero, infinity and NaN, which have no leading digit; 0 for other numbers. */
static size_t print_special(char text[CONIC_NUMBER_ROOM], double value) {
  uint64_t bits = conic_bits_of_double(value);
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

/* Floats of ordinary size, by exact integers in double. A candidate that reads back as `value` is right, however it was
 * found. */
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
    return lay_out_digits(text, value < 0.0f, digits, n, exponent + n - precision);
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
