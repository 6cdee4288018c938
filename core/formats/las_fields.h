/* The values that a LAS file's points have by name: the fields of their format, and the "extra bytes" that a record of
 * the file describes (LAS 1.4, table 24); and the record of how they are packed. */
#pragma once

#include "core/formats/ply_source.h"

enum { CONIC_LAS_MOST_FIELDS = 128, CONIC_LAS_NAME_ROOM = 40, CONIC_LAS_PACKING_BYTES = 70 };

typedef enum conic_las_integer_64 { CONIC_LAS_NO_64, CONIC_LAS_UNSIGNED_64, CONIC_LAS_SIGNED_64 } conic_las_integer_64;

/* A field of a point: a number, or some of its bits, times a scale plus an offset. */
typedef struct conic_las_field {
  char name[CONIC_LAS_NAME_ROOM];
  size_t at;
  conic_ply_type type;
  conic_las_integer_64 integer_64; /* or one of 64 bits, which may lose its last digits as a double */
  unsigned shift, mask;            /* mask 0: all of it */
  double scale, offset;
} conic_las_field;

typedef struct conic_las_fields {
  size_t n;
  conic_las_field list[CONIC_LAS_MOST_FIELDS];
  unsigned char packing[CONIC_LAS_PACKING_BYTES]; /* LASzip's record: core/laz/laz.h */
  size_t n_packing;                               /* 0: there is none */
} conic_las_fields;

/* The fields of a point format, 0 to 10. */
void conic_las_fields_of_format(unsigned format, conic_las_fields *fields);

/* Reads variable-length records up to `end`, an offset in the file, and adds the fields that they describe in the bytes
 * from `first_extra` on of a point of `point_bytes`. Records without meaning end the search and nothing else. Errors:
 * INPUT (reading failed), CANCELLED. */
conic_status conic_las_fields_read(conic_input *input, uint64_t n_records, uint64_t end, size_t first_extra,
                                   size_t point_bytes, conic_las_fields *fields);

/* The field of n points, the first of which begins at `bytes`. */
void conic_las_field_convert(const conic_las_field *field, const unsigned char *bytes, size_t point_bytes, size_t n,
                             double *values);

/* "uint8" …, as the field is stored; "double" for a scaled field. */
const char *conic_las_field_type(const conic_las_field *field);

/* The layer that has to be unpacked for a field, in formats 6 to 10: a bit of core/laz/laz.h. */
unsigned conic_las_field_layer(unsigned format, const conic_las_field *field);
