/* How the values of a line of text are parted, and how its decimals are written: by blanks, tabs, commas or semicolons,
 * in quotes or not, with points or commas. */
#ifndef CONIC_TEXT_DIALECT_H
#define CONIC_TEXT_DIALECT_H

#include <stddef.h>

typedef struct conic_text_word {
  const char *text;
  size_t length;
} conic_text_word;

/* Semicolons always part values. */
typedef enum conic_text_mark {
  CONIC_TEXT_BLANKS = 1,         /* so do blanks, any number of which is one */
  CONIC_TEXT_COMMAS = 2,         /* so do commas, between which a value may be missing */
  CONIC_TEXT_TABS = 4,           /* tabs do as commas do, not as blanks do */
  CONIC_TEXT_DECIMAL_COMMAS = 8, /* numbers have a comma for a point */
} conic_text_mark;

typedef struct conic_text_dialect {
  unsigned marks;          /* of conic_text_mark */
  unsigned char kind[256]; /* of every byte */
} conic_text_dialect;

void conic_text_dialect_begin(unsigned marks, conic_text_dialect *dialect);

/* The values of a line, without their quotes, but no more than `room`; returns how many. One that is missing at the
 * very end does not count: then *is_open. */
size_t conic_text_split(const conic_text_dialect *dialect, conic_text_word line, conic_text_word *words, size_t room,
                        int *is_open);

/* Whether it is a number; one that is missing is not a number, which is one. */
int conic_text_number(const conic_text_dialect *dialect, conic_text_word word, double *value);

/* Whether all values are numbers, wherever they are parted. */
int conic_text_is_numbers(conic_text_word line);

/* The dialect of these rows, whose other marks are known; returns null, or why it cannot be told for sure. */
const char *conic_text_dialect_find(const conic_text_word *rows, size_t n_rows, unsigned marks,
                                    conic_text_dialect *dialect);

#endif
