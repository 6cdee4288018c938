/* The text before the first of one-line points, and what the first points tell. */
#ifndef CONIC_XYZ_HEADING_H
#define CONIC_XYZ_HEADING_H

#include "core/files/input.h"
#include "core/formats/text_columns.h"

typedef enum conic_xyz_names {
  CONIC_XYZ_UNNAMED,
  CONIC_XYZ_IN_COMMENT, /* a comment that may name columns */
  CONIC_XYZ_IN_HEADER,
  CONIC_XYZ_BY_CALLER
} conic_xyz_names;

typedef struct conic_xyz_heading {
  int has_count; /* the file tells its number of points */
  uint64_t n_declared, count_line;
  conic_xyz_names names; /* where the columns' names come from; all unnamed ones must be numbers */
  unsigned marks;        /* separators of the names: of conic_text_mark */
  conic_text_columns columns;
  conic_text_dialect dialect;
} conic_xyz_heading;

/* Whether the line is empty, or begins with #, % or //. */
int conic_xyz_is_comment(conic_text_word line);

/* Whether the line names columns, x, y and z among them; fills in the columns and the marks. */
int conic_xyz_names_columns(conic_text_word line, conic_xyz_heading *heading);

/* Reads up to the first point's line, which is not taken, and finds the dialect and the columns. *has_points: there is
 * a point. `columns` are the caller's, or null. Errors: ARGUMENT, INPUT, CANCELLED. */
conic_status conic_xyz_heading_read(conic_input *input, const char *columns, conic_xyz_heading *heading,
                                    int *has_points);

/* Logs the meanings that unnamed columns were given. */
void conic_xyz_tell_columns(const conic_input *input, const conic_xyz_heading *heading);

/* Takes the only value of a line as a number of points. Errors: INPUT. */
conic_status conic_xyz_take_count(const conic_input *input, conic_text_word word, conic_xyz_heading *heading);

/* The values of a line; a missing last value counts, where it makes as many as there are columns. */
size_t conic_xyz_split(const conic_xyz_heading *heading, conic_text_word line, conic_text_word *words);

#endif
