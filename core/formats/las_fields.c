#include "core/formats/las_fields.h"

#include "core/base/byte_order.h"
#include "core/laz/laz.h"

enum { RECORD_HEADER_BYTES = 54, DESCRIPTION_BYTES = 192, WAVE_BYTES = 29 };
enum { EXTRA_BYTES_RECORD = 4, PACKING_RECORD = 22204 };

static void add_las_field(conic_las_fields *fields, const char *name, size_t at, conic_ply_type type, unsigned shift,
                          unsigned mask) {
  if (fields->n == CONIC_LAS_MOST_FIELDS)
    return;
  conic_las_field *field = &fields->list[fields->n++];
  *field = (conic_las_field){.at = at, .type = type, .shift = shift, .mask = mask, .scale = 1.0};
  for (size_t i = 0; i + 1 < sizeof field->name && name[i]; i++)
    field->name[i] = name[i];
}

static void add_flag(conic_las_fields *fields, const char *name, size_t at, unsigned bit) {
  add_las_field(fields, name, at, CONIC_PLY_UINT8, bit, 1);
}

/* Adds the byte of flags, and the other bits in the byte of the class or of the returns. */
static void add_flags(conic_las_fields *fields, int is_new) {
  size_t at = is_new ? 15 : 14, at_class = 15;
  unsigned bit = is_new ? 0 : 5;
  add_flag(fields, "scan_direction_flag", at, 6);
  add_flag(fields, "edge_of_flight_line", at, 7);
  add_flag(fields, "synthetic", at_class, bit);
  add_flag(fields, "key_point", at_class, bit + 1);
  add_flag(fields, "withheld", at_class, bit + 2);
  if (!is_new)
    return;
  add_flag(fields, "overlap", at_class, 3);
  add_las_field(fields, "scanner_channel", 15, CONIC_PLY_UINT8, 4, 3);
}

/* Where each format has the fields that not all formats have; 0: it lacks them. */
static const struct {
  unsigned char gps_time, colors, nir, wave;
} places[] = {{0, 0, 0, 0},  {20, 0, 0, 0},  {0, 20, 0, 0},   {20, 28, 0, 0}, {20, 0, 0, 28},  {20, 28, 0, 34},
              {22, 0, 0, 0}, {22, 30, 0, 0}, {22, 30, 36, 0}, {22, 0, 0, 30}, {22, 30, 36, 38}};

static void add_wave(conic_las_fields *fields, size_t at) {
  static const char *const axes[] = {"x_t", "y_t", "z_t"};
  add_las_field(fields, "wavepacket_index", at, CONIC_PLY_UINT8, 0, 0);
  add_las_field(fields, "wavepacket_offset", at + 1, CONIC_PLY_DOUBLE, 0, 0);
  fields->list[fields->n - 1].integer_64 = CONIC_LAS_UNSIGNED_64;
  add_las_field(fields, "wavepacket_size", at + 9, CONIC_PLY_UINT32, 0, 0);
  add_las_field(fields, "return_point_wave_location", at + 13, CONIC_PLY_FLOAT, 0, 0);
  for (size_t i = 0; i < 3; i++)
    add_las_field(fields, axes[i], at + 17 + 4 * i, CONIC_PLY_FLOAT, 0, 0);
}

void conic_las_fields_of_format(unsigned format, conic_las_fields *fields) {
  static const char *const channels[] = {"red", "green", "blue"};
  int is_new = format >= 6;
  fields->n = fields->n_packing = 0;
  add_las_field(fields, "intensity", 12, CONIC_PLY_UINT16, 0, 0);
  add_las_field(fields, "return_number", 14, CONIC_PLY_UINT8, 0, is_new ? 15 : 7);
  add_las_field(fields, "number_of_returns", 14, CONIC_PLY_UINT8, is_new ? 4 : 3, is_new ? 15 : 7);
  add_las_field(fields, "classification", is_new ? 16 : 15, CONIC_PLY_UINT8, 0, is_new ? 0 : 31);
  add_las_field(fields, "scan_angle", is_new ? 18 : 16, is_new ? CONIC_PLY_INT16 : CONIC_PLY_INT8, 0, 0);
  if (is_new)
    fields->list[fields->n - 1].scale = 0.006;
  add_las_field(fields, "user_data", 17, CONIC_PLY_UINT8, 0, 0);
  add_las_field(fields, "point_source_id", is_new ? 20 : 18, CONIC_PLY_UINT16, 0, 0);
  if (places[format].gps_time)
    add_las_field(fields, "gps_time", places[format].gps_time, CONIC_PLY_DOUBLE, 0, 0);
  for (size_t i = 0; i < 3 && places[format].colors; i++)
    add_las_field(fields, channels[i], places[format].colors + 2 * i, CONIC_PLY_UINT16, 0, 0);
  if (places[format].nir)
    add_las_field(fields, "nir", places[format].nir, CONIC_PLY_UINT16, 0, 0);
  add_flags(fields, is_new);
  if (places[format].wave)
    add_wave(fields, places[format].wave);
}

/* How an extra byte's type is stored: from 11 on, two or three numbers of one type; 0 has no description. */
typedef struct extra_kind {
  conic_ply_type type;
  conic_las_integer_64 integer_64;
  size_t n_bytes, n; /* bytes of a number, and how many numbers; 0: no value */
} extra_kind;

static extra_kind find_extra_kind(unsigned number, unsigned options) {
  static const conic_ply_type types[] = {CONIC_PLY_UINT8,  CONIC_PLY_INT8,  CONIC_PLY_UINT16, CONIC_PLY_INT16,
                                         CONIC_PLY_UINT32, CONIC_PLY_INT32, CONIC_PLY_DOUBLE, CONIC_PLY_DOUBLE,
                                         CONIC_PLY_FLOAT,  CONIC_PLY_DOUBLE};
  if (number == 0 || number > 30)
    return (extra_kind){CONIC_PLY_UINT8, CONIC_LAS_NO_64, options, 0};
  unsigned i = (number - 1) % 10;
  return (extra_kind){types[i],
                      i == 6   ? CONIC_LAS_UNSIGNED_64
                      : i == 7 ? CONIC_LAS_SIGNED_64
                               : CONIC_LAS_NO_64,
                      conic_ply_type_bytes(types[i]), (number - 1) / 10 + 1};
}

/* A name as it can be shown, with a number where there are several: "name", "name[1]". */
static void copy_extra_name(const unsigned char *bytes, int i_of_some, char name[CONIC_LAS_NAME_ROOM]) {
  size_t n = 0;
  for (; n < 32 && bytes[n]; n++)
    name[n] = (char)(bytes[n] < 0x20 || bytes[n] >= 0x7f ? '?' : bytes[n]);
  if (n > 0 && i_of_some >= 0) {
    name[n++] = '[';
    name[n++] = (char)('0' + i_of_some);
    name[n++] = ']';
  }
  name[n] = 0;
}

/* Reads one description; returns where the next one's bytes begin. Each of several numbers has its own scale and
 * offset. */
static size_t describe_extra(const unsigned char *bytes, size_t at, size_t point_bytes, conic_las_fields *fields) {
  unsigned options = bytes[3];
  extra_kind kind = find_extra_kind(bytes[2], options);
  size_t end = at + kind.n_bytes * (kind.n ? kind.n : 1);
  for (size_t i = 0; i < kind.n && end <= point_bytes; i++) {
    char name[CONIC_LAS_NAME_ROOM];
    copy_extra_name(bytes + 4, kind.n > 1 ? (int)i : -1, name);
    if (!name[0] || fields->n == CONIC_LAS_MOST_FIELDS)
      break;
    add_las_field(fields, name, at + i * kind.n_bytes, kind.type, 0, 0);
    conic_las_field *field = &fields->list[fields->n - 1];
    field->integer_64 = kind.integer_64;
    field->scale = options & 8 ? conic_load_double(bytes + 112 + 8 * i) : 1.0;
    field->offset = options & 16 ? conic_load_double(bytes + 136 + 8 * i) : 0.0;
  }
  return end;
}

static conic_status read_extra(conic_input *input, size_t n, size_t first_extra, size_t point_bytes,
                               conic_las_fields *fields, uint64_t *n_used) {
  size_t at = first_extra;
  for (size_t i = 0; i < n; i++) {
    conic_status status = conic_input_fill(input, DESCRIPTION_BYTES);
    if (status != CONIC_OK || conic_input_available(input) < DESCRIPTION_BYTES)
      return status;
    at = describe_extra(conic_input_bytes(input), at, point_bytes, fields);
    input->next += DESCRIPTION_BYTES;
    *n_used += DESCRIPTION_BYTES;
  }
  return CONIC_OK;
}

static conic_status read_packing(conic_input *input, uint64_t n_bytes, conic_las_fields *fields) {
  size_t n = n_bytes < CONIC_LAS_PACKING_BYTES ? (size_t)n_bytes : CONIC_LAS_PACKING_BYTES;
  conic_status status = conic_input_fill(input, n);
  if (status != CONIC_OK)
    return status;
  n = n < conic_input_available(input) ? n : conic_input_available(input);
  memcpy(fields->packing, conic_input_bytes(input), n);
  fields->n_packing = n;
  return CONIC_OK;
}

static int is_record_of(const unsigned char *record, const char *user, unsigned number) {
  return strncmp((const char *)record + 2, user, 16) == 0 && conic_load_bits(record + 18, 2) == number;
}

conic_status conic_las_fields_read(conic_input *input, uint64_t n_records, uint64_t end, size_t first_extra,
                                   size_t point_bytes, conic_las_fields *fields) {
  size_t n_fields = fields->n;
  for (uint64_t i = 0; i < n_records; i++) {
    uint64_t left = end - conic_input_offset(input), n_used = 0, skipped;
    conic_status status = left >= RECORD_HEADER_BYTES ? conic_input_fill(input, RECORD_HEADER_BYTES) : CONIC_OK;
    const unsigned char *record = conic_input_bytes(input);
    if (status != CONIC_OK || left < RECORD_HEADER_BYTES || conic_input_available(input) < RECORD_HEADER_BYTES)
      return status;
    uint64_t n_bytes = conic_load_bits(record + 20, 2);
    int is_extra = is_record_of(record, "LASF_Spec", EXTRA_BYTES_RECORD) && fields->n == n_fields;
    int is_packing = is_record_of(record, "laszip encoded", PACKING_RECORD);
    if (n_bytes > left - RECORD_HEADER_BYTES)
      return CONIC_OK;
    input->next += RECORD_HEADER_BYTES;
    if (is_extra)
      status = read_extra(input, (size_t)n_bytes / DESCRIPTION_BYTES, first_extra, point_bytes, fields, &n_used);
    else if (is_packing)
      status = read_packing(input, n_bytes, fields);
    if (status == CONIC_OK)
      status = conic_input_skip(input, n_bytes - n_used, &skipped);
    if (status != CONIC_OK || skipped < n_bytes - n_used)
      return status;
  }
  return CONIC_OK;
}

static void convert_64(const conic_las_field *field, const unsigned char *bytes, size_t point_bytes, size_t n,
                       double *values) {
  for (size_t i = 0; i < n; i++) {
    uint64_t bits = conic_load_bits(bytes + field->at + i * point_bytes, sizeof bits);
    values[i] = field->integer_64 == CONIC_LAS_SIGNED_64 ? (double)(int64_t)bits : (double)bits;
  }
}

void conic_las_field_convert(const conic_las_field *field, const unsigned char *bytes, size_t point_bytes, size_t n,
                             double *values) {
  if (field->integer_64)
    convert_64(field, bytes, point_bytes, n, values);
  else
    conic_ply_convert(bytes + field->at, point_bytes, n, field->type, CONIC_PLY_LITTLE_ENDIAN, values);
  for (size_t i = 0; i < n && field->mask; i++)
    values[i] = (double)((unsigned)values[i] >> field->shift & field->mask);
  for (size_t i = 0; i < n && (field->scale != 1.0 || field->offset != 0.0); i++)
    values[i] = values[i] * field->scale + field->offset;
}

const char *conic_las_field_type(const conic_las_field *field) {
  int is_scaled = field->scale != 1.0 || field->offset != 0.0;
  return conic_ply_type_name(is_scaled ? CONIC_PLY_DOUBLE : field->type);
}

unsigned conic_las_field_layer(unsigned format, const conic_las_field *field) {
  static const struct {
    size_t end;
    unsigned layer;
  } layers[] = {{14, CONIC_LAZ_INTENSITY},    {15, 0}, /* returns are in the first layer */
                {16, CONIC_LAZ_FLAGS},        {17, CONIC_LAZ_CLASSIFICATION},
                {18, CONIC_LAZ_USER_DATA},    {20, CONIC_LAZ_SCAN_ANGLE},
                {22, CONIC_LAZ_POINT_SOURCE}, {30, CONIC_LAZ_GPS_TIME}};
  size_t i = 0, n = sizeof layers / sizeof *layers;
  while (i < n && field->at >= layers[i].end)
    i++;
  if (i < n)
    return layers[i].layer;
  size_t colors = places[format].colors, nir = places[format].nir, wave = places[format].wave;
  return colors && field->at < colors + 6        ? CONIC_LAZ_COLORS
         : nir && field->at < nir + 2            ? CONIC_LAZ_NIR
         : wave && field->at < wave + WAVE_BYTES ? CONIC_LAZ_WAVE_PACKET
                                                 : CONIC_LAZ_EXTRA;
}
