#include "core/formats/las_fields.h"

#include <string.h>

#include "core/files/file_fields.h"

enum { RECORD_HEADER_BYTES = 54, DESCRIPTION_BYTES = 192, EXTRA_BYTES_RECORD = 4 };

static void add_las_field(conic_las_fields *fields, const char *name, size_t at, conic_ply_type type, unsigned shift,
                          unsigned mask) {
  if (fields->n == CONIC_LAS_MOST_FIELDS)
    return;
  conic_las_field *field = &fields->list[fields->n++];
  *field = (conic_las_field){.at = at, .type = type, .shift = shift, .mask = mask, .scale = 1.0};
  for (size_t i = 0; i + 1 < sizeof field->name && name[i]; i++)
    field->name[i] = name[i];
}

void conic_las_fields_of_format(unsigned format, conic_las_fields *fields) {
  static const unsigned char gps_time_at[] = {0, 20, 0, 20, 20, 20, 22, 22, 22, 22, 22};
  int is_new = format >= 6;
  fields->n = 0;
  add_las_field(fields, "intensity", 12, CONIC_PLY_UINT16, 0, 0);
  add_las_field(fields, "return_number", 14, CONIC_PLY_UINT8, 0, is_new ? 15 : 7);
  add_las_field(fields, "number_of_returns", 14, CONIC_PLY_UINT8, is_new ? 4 : 3, is_new ? 15 : 7);
  add_las_field(fields, "classification", is_new ? 16 : 15, CONIC_PLY_UINT8, 0, is_new ? 0 : 31);
  add_las_field(fields, "scan_angle", is_new ? 18 : 16, is_new ? CONIC_PLY_INT16 : CONIC_PLY_INT8, 0, 0);
  if (is_new)
    fields->list[fields->n - 1].scale = 0.006;
  add_las_field(fields, "user_data", 17, CONIC_PLY_UINT8, 0, 0);
  add_las_field(fields, "point_source_id", is_new ? 20 : 18, CONIC_PLY_UINT16, 0, 0);
  if (gps_time_at[format])
    add_las_field(fields, "gps_time", gps_time_at[format], CONIC_PLY_DOUBLE, 0, 0);
  if (format == 8 || format == 10)
    add_las_field(fields, "nir", 36, CONIC_PLY_UINT16, 0, 0);
}

/* The types of extra bytes by their numbers; those of 64 bits and those that are not described take room only. */
static size_t extra_type(unsigned number, unsigned options, conic_ply_type *type, int *is_known) {
  static const conic_ply_type types[] = {CONIC_PLY_UINT8, CONIC_PLY_UINT8,  CONIC_PLY_INT8,  CONIC_PLY_UINT16,
                                         CONIC_PLY_INT16, CONIC_PLY_UINT32, CONIC_PLY_INT32, CONIC_PLY_UINT8,
                                         CONIC_PLY_UINT8, CONIC_PLY_FLOAT,  CONIC_PLY_DOUBLE};
  unsigned kind = number <= 10 ? number : number <= 30 ? (number - 1) % 10 + 1 : 0; /* 11 to 30: two or three of one */
  *type = types[kind];
  *is_known = number >= 1 && number <= 10 && kind != 7 && kind != 8;
  if (number == 0 || number > 30)
    return options;
  return (kind == 7 || kind == 8 ? 8 : conic_ply_type_bytes(*type)) * ((number - 1) / 10 + 1);
}

static double double_at(const unsigned char *bytes) {
  double value;
  memcpy(&value, bytes, sizeof value);
  return value;
}

/* One description; where the next one's bytes begin. */
static size_t describe_extra(const unsigned char *bytes, size_t at, size_t point_bytes, conic_las_fields *fields) {
  char name[33] = {0};
  conic_ply_type type;
  int is_known;
  unsigned options = bytes[3];
  size_t n_bytes = extra_type(bytes[2], options, &type, &is_known);
  memcpy(name, bytes + 4, 32);
  for (size_t i = 0; name[i]; i++)
    if ((unsigned char)name[i] < 0x20 || (unsigned char)name[i] >= 0x7f)
      name[i] = '?';
  if (is_known && name[0] && at + n_bytes <= point_bytes && fields->n < CONIC_LAS_MOST_FIELDS) {
    add_las_field(fields, name, at, type, 0, 0);
    conic_las_field *field = &fields->list[fields->n - 1];
    field->scale = options & 8 ? double_at(bytes + 112) : 1.0;
    field->offset = options & 16 ? double_at(bytes + 136) : 0.0;
  }
  return at + n_bytes;
}

static conic_status read_extra(conic_input *input, size_t n, size_t first_extra, size_t point_bytes,
                               conic_las_fields *fields) {
  size_t at = first_extra;
  for (size_t i = 0; i < n; i++) {
    conic_status status = conic_input_fill(input, DESCRIPTION_BYTES);
    if (status != CONIC_OK || conic_input_available(input) < DESCRIPTION_BYTES)
      return status;
    at = describe_extra(conic_input_bytes(input), at, point_bytes, fields);
    input->next += DESCRIPTION_BYTES;
  }
  return CONIC_OK;
}

conic_status conic_las_fields_read(conic_input *input, uint64_t n_records, uint64_t end, size_t first_extra,
                                   size_t point_bytes, conic_las_fields *fields) {
  for (uint64_t i = 0; i < n_records; i++) {
    uint64_t left = end - conic_input_offset(input), skipped;
    conic_status status = left >= RECORD_HEADER_BYTES ? conic_input_fill(input, RECORD_HEADER_BYTES) : CONIC_OK;
    const unsigned char *record = conic_input_bytes(input);
    if (status != CONIC_OK || left < RECORD_HEADER_BYTES || conic_input_available(input) < RECORD_HEADER_BYTES)
      return status;
    uint64_t n_bytes = conic_file_get(record + 20, 2);
    int is_extra = memcmp(record + 2, "LASF_Spec", 10) == 0 && conic_file_get(record + 18, 2) == EXTRA_BYTES_RECORD;
    if (n_bytes > left - RECORD_HEADER_BYTES)
      return CONIC_OK;
    input->next += RECORD_HEADER_BYTES;
    if (is_extra)
      return read_extra(input, (size_t)n_bytes / DESCRIPTION_BYTES, first_extra, point_bytes, fields);
    status = conic_input_skip(input, n_bytes, &skipped);
    if (status != CONIC_OK || skipped < n_bytes)
      return status;
  }
  return CONIC_OK;
}

void conic_las_field_convert(const conic_las_field *field, const unsigned char *bytes, size_t point_bytes, size_t n,
                             double *values) {
  conic_ply_convert(bytes + field->at, point_bytes, n, field->type, CONIC_PLY_LITTLE_ENDIAN, values);
  for (size_t i = 0; i < n && field->mask; i++)
    values[i] = (double)((unsigned)values[i] >> field->shift & field->mask);
  for (size_t i = 0; i < n; i++)
    values[i] = values[i] * field->scale + field->offset;
}

const char *conic_las_field_type(const conic_las_field *field) {
  return conic_ply_type_name(field->type);
}
