/* What text with a point a line says before its first point, and what its first points tell. */
#ifndef CONIC_XYZ_HEADING_H
#define CONIC_XYZ_HEADING_H

#include "core/files/input.h"
#include "core/formats/text_columns.h"

typedef enum conic_xyz_names {
  CONIC_XYZ_UNNAMED,
  CONIC_XYZ_IN_COMMENT, /* a comment may be names of columns */
  CONIC_XYZ_IN_HEADER,
  CONIC_XYZ_BY_CALLER
} conic_xyz_names;

typedef struct conic_xyz_heading {
  int has_count; /* the file says how many points there are */
  uint64_t n_declared, count_line;
  conic_xyz_names names; /* where the columns' names are from; unnamed ones are all to be numbers */
  unsigned marks;        /* that part the names: of conic_text_mark */
  conic_text_columns columns;
  conic_text_dialect dialect;
} conic_xyz_heading;

/* Empty, or begins with #, % or //. */
int conic_xyz_is_comment(conic_text_word line);

/* Whether the line names columns, x, y and z among them; fills in the columns and the marks. */
int conic_xyz_names_columns(conic_text_word line, conic_xyz_heading *heading);

/* Reads up to the first point's line, which is not passed over, and finds the dialect and the columns; *has_points:
 * there is one. `columns` are the caller's, or null. Errors: ARGUMENT, INPUT, CANCELLED. */
conic_status conic_xyz_heading_read(conic_input *input, const char *columns, conic_xyz_heading *heading,
                                    int *has_points);

/* Logs what columns without names have been taken for. */
void conic_xyz_tell_columns(const conic_input *input, const conic_xyz_heading *heading);

/* A line's lone value is a number of points. Errors: INPUT. */
conic_status conic_xyz_take_count(const conic_input *input, conic_text_word word, conic_xyz_heading *heading);

/* The values of a line, as many as there are columns where only the last one is missing. */
size_t conic_xyz_split(const conic_xyz_heading *heading, conic_text_word line, conic_text_word *words);

#endif
