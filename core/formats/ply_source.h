/* The values after a PLY file's header, one at a time, in any encoding. */
#pragma once

#include "core/formats/ply_header.h"

typedef struct conic_ply_source {
  conic_input *input;
  conic_ply_format format;
  const conic_ply_element *element; /* the current one, for messages */
  uint64_t i_row;
  int is_cut; /* the file ends within the row: nothing was said of it, and INPUT returned */
} conic_ply_source;

/* Begins the element. Returns the most rows that the rest of the file can hold. */
uint64_t conic_ply_begin_element(conic_ply_source *source, const conic_ply_element *element);

/* The same for readers that need all of its rows: refuses more than there can be. Errors: INPUT. */
conic_status conic_ply_begin_whole(conic_ply_source *source, const conic_ply_element *element);

/* Called before and after every row. An ascii row is one line. Errors: INPUT, CANCELLED. */
conic_status conic_ply_begin_row(conic_ply_source *source);
conic_status conic_ply_end_row(conic_ply_source *source);

/* The next value as a double, which holds every type exactly. Errors: INPUT, CANCELLED. */
conic_status conic_ply_read_value(conic_ply_source *source, conic_ply_type type, double *value);

/* The next list's length; refuses lengths that the rest of the file cannot hold, of short ones as where the file ends
 * within the row. Errors: INPUT, CANCELLED. */
conic_status conic_ply_read_list_length(conic_ply_source *source, const conic_ply_property *property, uint64_t *length);

/* Passes over `count` values. Errors: INPUT, CANCELLED. */
conic_status conic_ply_skip_values(conic_ply_source *source, conic_ply_type type, uint64_t count);

/* Passes over a whole element. Errors: INPUT, CANCELLED. */
conic_status conic_ply_skip_element(conic_ply_source *source, const conic_ply_header *header);

/* Whether the number of a row tells its place: rows are binary, and of one size. */
int conic_ply_is_plain(conic_ply_format format, const conic_ply_element *element);

/* Reads the next *n rows of the element, whose properties these are, or as many as are there at once: *n becomes their
 * number. Column k is of the property columns[k], which is no list and stands in one column alone; below 0: it stays as
 * it is. Its values, at most `stride`, begin at values[k × stride]. Errors: INPUT, MEMORY, CANCELLED. */
conic_status conic_ply_read_rows(conic_ply_source *source, const conic_ply_property *properties, const int *columns,
                                 int n_columns, size_t stride, size_t *n, double *values);

/* The same of n rows, plain ones, which have been read. */
void conic_ply_convert_rows(const conic_ply_source *source, const conic_ply_property *properties, const int *columns,
                            int n_columns, const unsigned char *bytes, size_t n, size_t stride, double *values);

/* Values of one type, `stride` bytes apart, as doubles. */
void conic_ply_convert(const unsigned char *bytes, size_t stride, size_t n, conic_ply_type type,
                       conic_ply_format format, double *values);

/* "FILE: what is wrong (line N)", or "(at byte N)" in a binary file. */
conic_status conic_ply_wrong(const conic_ply_source *source, const char *what);
/* The file ends too early. */
conic_status conic_ply_truncated(conic_ply_source *source);

/* Says where the file is cut: as a warning where what is before is of use, which is OK, else as an error. */
conic_status conic_ply_tell_cut(const conic_ply_source *source, int is_usable);
