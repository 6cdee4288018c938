/* How a line of text separates its values, and writes decimals: with blanks, tabs, commas or semicolons, in quotes or
 * not, with points or commas. */
#ifndef CONIC_TEXT_DIALECT_H
#define CONIC_TEXT_DIALECT_H

#include <stddef.h>

typedef struct conic_text_word {
  const char *text;
  size_t length;
} conic_text_word;

/* Semicolons always separate values. */
typedef enum conic_text_mark {
  CONIC_TEXT_BLANKS = 1,         /* so do blanks, any number of them at once */
  CONIC_TEXT_COMMAS = 2,         /* so do commas, between which a value may be missing */
  CONIC_TEXT_TABS = 4,           /* tabs work as commas, not as blanks */
  CONIC_TEXT_DECIMAL_COMMAS = 8, /* numbers have a comma as their point */
} conic_text_mark;

typedef struct conic_text_dialect {
  unsigned marks;          /* of conic_text_mark */
  unsigned char kind[256]; /* the kind of every byte */
} conic_text_dialect;

void conic_text_dialect_begin(unsigned marks, conic_text_dialect *dialect);

/* The values of a line, without their quotes, at most `room`; returns how many. A missing value at the very end does
 * not count: then *is_open is set. */
size_t conic_text_split(const conic_text_dialect *dialect, conic_text_word line, conic_text_word *words, size_t room,
                        int *is_open);

/* Whether the word is a number; a missing value counts as NaN. */
int conic_text_number(const conic_text_dialect *dialect, conic_text_word word, double *value);

/* Whether all values are numbers, with any separators. */
int conic_text_is_numbers(conic_text_word line);

/* Finds the dialect of these rows, whose other marks are known; returns null, or why it is not certain. */
const char *conic_text_dialect_find(const conic_text_word *rows, size_t n_rows, unsigned marks,
                                    conic_text_dialect *dialect);

#endif
