/* What the points of a LAS file have by name: the fields of their format, and the "extra bytes" that a record of the
 * file describes (LAS 1.4, table 24). */
#ifndef CONIC_LAS_FIELDS_H
#define CONIC_LAS_FIELDS_H

#include "core/files/input.h"
#include "core/formats/ply_source.h"

enum { CONIC_LAS_MOST_FIELDS = 64 };

/* Where a field stands in a point: a number, or some of its bits, times a scale and after an offset. */
typedef struct conic_las_field {
  char name[33];
  size_t at;
  conic_ply_type type;
  unsigned shift, mask; /* mask 0: all of it */
  double scale, offset;
} conic_las_field;

typedef struct conic_las_fields {
  size_t n;
  conic_las_field list[CONIC_LAS_MOST_FIELDS];
} conic_las_fields;

/* The fields of a point format, 0 to 10. */
void conic_las_fields_of_format(unsigned format, conic_las_fields *fields);

/* Reads on through variable-length records up to `end`, an offset in the file, and adds what they say of the bytes from
 * `first_extra` on of a point of `point_bytes`. Records that make no sense end the search and nothing else. Errors:
 * INPUT (reading failed), CANCELLED. */
conic_status conic_las_fields_read(conic_input *input, uint64_t n_records, uint64_t end, size_t first_extra,
                                   size_t point_bytes, conic_las_fields *fields);

/* The field of n points, the first of which begins at `bytes`. */
void conic_las_field_convert(const conic_las_field *field, const unsigned char *bytes, size_t point_bytes, size_t n,
                             double *values);

/* "uint8" …, as the field is stored. */
const char *conic_las_field_type(const conic_las_field *field);

#endif
