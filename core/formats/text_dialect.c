#include "core/formats/text_columns.h"

#include "core/base/base.h"
#include "core/files/number.h"

enum { INK, BLANK, PARTING, MOST_VALUES = 256 };

void conic_text_dialect_begin(unsigned marks, conic_text_dialect *dialect) {
  memset(dialect, 0, sizeof *dialect);
  dialect->marks = marks;
  for (const char *c = " \t\r\v\f"; *c; c++)
    dialect->kind[(unsigned char)*c] = BLANK;
  dialect->kind[';'] = PARTING;
  if (marks & CONIC_TEXT_COMMAS)
    dialect->kind[','] = PARTING;
  if (marks & CONIC_TEXT_TABS)
    dialect->kind['\t'] = PARTING;
}

/* Finds the word that begins at `c`; returns past it. */
static const char *take_word(const conic_text_dialect *dialect, const char *c, const char *end, conic_text_word *word) {
  if (*c == '"') {
    const char *quote = memchr(c + 1, '"', (size_t)(end - c - 1));
    const char *stop = quote ? quote : end;
    *word = (conic_text_word){c + 1, (size_t)(stop - c - 1)};
    c = quote ? quote + 1 : end;
    while (c < end && dialect->kind[(unsigned char)*c] == INK)
      c++;
    return c;
  }
  const char *first = c;
  int last = dialect->marks & CONIC_TEXT_BLANKS ? INK : BLANK; /* characters up to this kind are part of a word */
  while (c < end && dialect->kind[(unsigned char)*c] <= last)
    c++;
  const char *stop = c;
  while (stop > first && dialect->kind[(unsigned char)stop[-1]] == BLANK)
    stop--;
  *word = (conic_text_word){first, (size_t)(stop - first)};
  return c;
}

size_t conic_text_split(const conic_text_dialect *dialect, conic_text_word line, conic_text_word *words, size_t room,
                        int *is_open) {
  const char *c = line.text, *end = c + line.length;
  size_t n = 0;
  for (*is_open = 0; n < room; n++) {
    while (c < end && dialect->kind[(unsigned char)*c] == BLANK)
      c++;
    if (c == end)
      break;
    words[n] = (conic_text_word){c, 0};
    if (dialect->kind[(unsigned char)*c] == INK)
      c = take_word(dialect, c, end, &words[n]);
    while (c < end && dialect->kind[(unsigned char)*c] == BLANK)
      c++;
    *is_open = c < end && dialect->kind[(unsigned char)*c] == PARTING;
    c += *is_open;
  }
  return n;
}

int conic_text_number(const conic_text_dialect *dialect, conic_text_word word, double *value) {
  char text[64];
  *value = (double)NAN;
  if (word.length == 0)
    return 1;
  if (!(dialect->marks & CONIC_TEXT_DECIMAL_COMMAS))
    return conic_number_parse(word.text, word.length, value) == word.length;
  if (word.length > sizeof text)
    return 0;
  memcpy(text, word.text, word.length);
  char *comma = memchr(text, ',', word.length);
  if (comma)
    *comma = '.';
  return conic_number_parse(text, word.length, value) == word.length;
}

int conic_text_is_numbers(conic_text_word line) {
  conic_text_dialect any;
  conic_text_word words[MOST_VALUES];
  double value;
  int is_open;
  conic_text_dialect_begin(CONIC_TEXT_BLANKS | CONIC_TEXT_COMMAS, &any);
  any.kind['"'] = BLANK;
  size_t n = conic_text_split(&any, line, words, MOST_VALUES, &is_open);
  for (size_t i = 0; i < n; i++)
    if (!conic_text_number(&any, words[i], &value))
      return 0;
  return n > 0;
}

/* --- commas --- */

/* What some rows tell about their commas. */
typedef struct comma_census {
  size_t least_words;                 /* the fewest words of a row if commas do not separate them */
  size_t most_inner;                  /* the most commas between digits in a word */
  int has_commas, has_points;         /* anywhere */
  int has_edges;                      /* there are commas that are not between digits */
  int is_all_inner, is_all_thousands; /* every word has a comma between digits; three digits follow each such comma */
  int is_quoted;                      /* quoted numbers have commas */
  int is_padded;                      /* if commas separate, every second value may have a needless leading 0 */
} comma_census;

/* Exactly three digits. */
static int is_thousand(const char *c, const char *end) {
  return end - c >= 3 && conic_is_digit(c[0]) && conic_is_digit(c[1]) && conic_is_digit(c[2]) &&
         (end - c == 3 || !conic_is_digit(c[3]));
}

static void count_word(conic_text_word word, comma_census *census) {
  const char *end = word.text + word.length;
  size_t n_inner = 0;
  for (const char *c = word.text; c < end; c++) {
    census->has_points |= *c == '.';
    if (*c != ',')
      continue;
    int is_inner = c > word.text && c + 1 < end && conic_is_digit(c[-1]) && conic_is_digit(c[1]);
    n_inner += (size_t)is_inner;
    census->has_edges |= !is_inner;
    census->is_all_thousands &= !is_inner || is_thousand(c + 1, end);
  }
  census->is_all_inner &= n_inner > 0;
  census->most_inner = n_inner > census->most_inner ? n_inner : census->most_inner;
}

static int is_number_in_quotes(const char *c, const char *end) {
  int n_digits = 0;
  for (; c < end && (conic_is_digit(*c) || strchr("+-., eE", *c)); c++)
    n_digits += conic_is_digit(*c);
  return c == end && n_digits > 0;
}

/* In a row with quotes, only the quoted words count. */
static void count_quoted(conic_text_word row, comma_census *census) {
  const char *end = row.text + row.length, *c = memchr(row.text, '"', row.length);
  while (c) {
    const char *first = c + 1, *stop = memchr(first, '"', (size_t)(end - first));
    if (!stop)
      return;
    conic_text_word word = {first, (size_t)(stop - first)};
    if (is_number_in_quotes(first, stop)) {
      census->is_quoted |= memchr(first, ',', word.length) != NULL;
      count_word(word, census);
    }
    c = memchr(stop + 1, '"', (size_t)(end - stop - 1));
  }
}

/* Whether leading zeros come only in every second of six or more values that commas separate: then the pairs look like
 * numbers with a decimal comma. */
static int is_padded(conic_text_word row) {
  conic_text_dialect commas;
  conic_text_word words[MOST_VALUES];
  int is_open, answer = 0;
  conic_text_dialect_begin(CONIC_TEXT_COMMAS, &commas);
  size_t n = conic_text_split(&commas, row, words, MOST_VALUES, &is_open);
  for (size_t i = 0; i < n; i++) {
    int has_zero = words[i].length > 1 && words[i].text[0] == '0' && conic_is_digit(words[i].text[1]);
    if (has_zero && i % 2 == 0)
      return 0;
    answer |= has_zero;
  }
  return answer && n >= 6 && n % 2 == 0;
}

static void count_row(conic_text_word row, comma_census *census) {
  conic_text_dialect without;
  conic_text_word words[MOST_VALUES];
  int is_open;
  census->has_commas |= memchr(row.text, ',', row.length) != NULL;
  if (memchr(row.text, '"', row.length)) {
    count_quoted(row, census);
    return;
  }
  conic_text_dialect_begin(CONIC_TEXT_BLANKS, &without);
  size_t n = conic_text_split(&without, row, words, MOST_VALUES, &is_open);
  census->least_words = n < census->least_words ? n : census->least_words;
  for (size_t i = 0; i < n; i++)
    count_word(words[i], census);
  census->is_padded |= is_padded(row);
}

#define REMEDY ": write decimals with a point, and no other marks in a number"

const char *conic_text_dialect_find(const conic_text_word *rows, size_t n_rows, unsigned marks,
                                    conic_text_dialect *dialect) {
  comma_census census = {.least_words = (size_t)-1, .is_all_inner = 1, .is_all_thousands = 1};
  for (size_t i = 0; i < n_rows; i++)
    count_row(rows[i], &census);
  int is_parted = census.least_words >= 3 && census.most_inner > 0; /* blanks alone separate the values, which have
                                                                       commas */
  conic_text_dialect_begin(marks | CONIC_TEXT_COMMAS, dialect);
  if (!census.has_commas)
    return NULL;
  if (census.has_points &&
      ((is_parted && !census.has_edges && (census.is_all_thousands || census.most_inner == 1)) || census.is_quoted))
    return "its numbers have both commas and points, which part thousands or decimals" REMEDY;
  if (is_parted && !census.has_points && census.has_edges && census.is_all_inner)
    return "its commas are decimal ones or part columns, which cannot be told" REMEDY;
  if (!is_parted && !census.has_points && !census.is_quoted && census.is_padded)
    return "its commas look like decimal ones, which part columns, too" REMEDY;
  if (census.is_quoted || (is_parted && census.most_inner == 1 && !census.has_points && !census.has_edges))
    conic_text_dialect_begin((marks & ~(unsigned)CONIC_TEXT_COMMAS) | CONIC_TEXT_DECIMAL_COMMAS |
                                 (census.is_quoted ? (unsigned)CONIC_TEXT_COMMAS : 0u),
                             dialect);
  return NULL;
}
