/* The one table of what decides a picture: every member of a shot and of all within it. The key, the file, what two
 * shots differ in and the schema are made of it. Each member of each struct has a row: it is a field, or it is left out
 * for a reason that its row gives; a test holds that the rows cover the structs. */
#pragma once

#include "conic/shot_file.h"

typedef enum conic_shot_row_kind {
  CONIC_ROW_INT,
  CONIC_ROW_UINT32,
  CONIC_ROW_UINT64,
  CONIC_ROW_FLOAT,
  CONIC_ROW_DOUBLE,
  CONIC_ROW_TRUTH,   /* int, other than 0: true */
  CONIC_ROW_WORD,    /* int or uint32_t, by `word` */
  CONIC_ROW_PLANES,  /* unsigned: bits of planes, as a list of their names */
  CONIC_ROW_TEXT,    /* const char *, null: none */
  CONIC_ROW_HAS,     /* a pointer: whether it is null */
  CONIC_ROW_STRUCT,  /* of `of` */
  CONIC_ROW_POINTER, /* to one of `of`; null: the defaults */
  CONIC_ROW_LIST,    /* an array of `of`, of which as many count as the member at `length` says; is_apart: by pointer */
  /* No fields: */
  CONIC_ROW_LENGTH, /* of a list */
  CONIC_ROW_RESERVED,
  CONIC_ROW_LEFT_OUT /* `meaning` says why */
} conic_shot_row_kind;

typedef struct conic_shot_rows conic_shot_rows;

typedef struct conic_shot_row { /* NOLINT(clang-analyzer-optin.performance.Padding): what each row has comes first */
  conic_shot_row_kind kind;
  const char *name;
  size_t offset, bytes;
  const char *unit, *meaning;
  const char *(*word)(int i); /* null beyond the last */
  const conic_shot_rows *of;
  size_t length;    /* of a list: the offset of its length, */
  int length_is_64; /* which is a uint64_t, else an int */
  int is_apart;
  int columns;        /* a matrix has so many; 0: it is none */
  int is_said;        /* it stands in every file */
  double least, most; /* of numbers: a file that says others is none; both 0: it may be any */
  int is_no_key;      /* it is to be known where the picture is drawn again, and decides no bit */
} conic_shot_row;

struct conic_shot_rows {
  const char *name;
  size_t size;
  const conic_shot_row *rows;
  size_t n_rows;
  void (*set_standard)(void *value);       /* null: all zero */
  const char *(*fault)(const void *value); /* of shots/shot_faults.h; null: nothing can be wrong with it */
};

/* Of a conic_shot_file: the members of its shot, then `reading`, `map` and `writing`. */
extern const conic_shot_rows conic_shot_file_rows;
/* Every table, null after the last. */
extern const conic_shot_rows *const conic_all_shot_rows[];

/* Numbers, or other things, that a row has. */
size_t conic_row_count(const conic_shot_row *row);
/* How many members a list has. */
size_t conic_row_length(const conic_shot_row *row, const void *value);
/* What a row's struct, or each member of its list, is unless it is said; of no use for longer than to look at. */
enum { CONIC_STANDARD_ROOM = 2048 };
typedef union conic_standard {
  double aligned;
  unsigned char bytes[CONIC_STANDARD_ROOM];
} conic_standard;
void conic_rows_standard(const conic_shot_rows *rows, conic_standard *standard);
