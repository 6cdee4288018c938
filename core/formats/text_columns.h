/* The meaning of text columns: by names, which a header or the caller gives, else by their number and values. */
#pragma once

#include <stddef.h>

/* How a line of text separates its values, and writes decimals: with blanks, tabs, commas or semicolons, in quotes or
 * not, with points or commas. */

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

typedef enum conic_text_meaning {
  CONIC_TEXT_X = 0,
  CONIC_TEXT_RED = 3,
  CONIC_TEXT_NORMAL = 6,
  CONIC_TEXT_N_MEANINGS = 9,
  CONIC_TEXT_SCALAR = -1 /* anything else */
} conic_text_meaning;

/* Longer names are cut. Without names, so many columns are looked at. */
enum { CONIC_TEXT_MOST_COLUMNS = 200, CONIC_TEXT_NAME_ROOM = 40, CONIC_TEXT_MOST_GUESSED = 16 };

typedef struct conic_text_columns {
  size_t n;
  int has_colors, has_normals;
  int is_doubtful;                                          /* guessed, and could be something else */
  int meaning[CONIC_TEXT_MOST_COLUMNS];                     /* of conic_text_meaning; the three of a vector are
                                                               consecutive */
  char name[CONIC_TEXT_MOST_COLUMNS][CONIC_TEXT_NAME_ROOM]; /* as given; "-": no name */
} conic_text_columns;

/* Columns by their names; returns whether x, y and z are among them. */
int conic_text_columns_name(const conic_text_word *names, size_t n, conic_text_columns *columns);

/* Columns from "x,y,z,intensity,-,r,g,b", or the same with blanks for commas; returns null, or what is wrong. */
const char *conic_text_columns_parse(const char *list, conic_text_columns *columns);

/* Guesses columns of `n` values from their number and those of the first rows. */
void conic_text_columns_guess(const double (*rows)[CONIC_TEXT_MOST_GUESSED], size_t n_rows, size_t n,
                              conic_text_columns *columns);

/* The column of that name; -1: none. */
int conic_text_columns_find(const conic_text_columns *columns, const char *name);

/* "x y z - red green blue", as much as fits. */
void conic_text_columns_list(const conic_text_columns *columns, char *text, size_t room);
