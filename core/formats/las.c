#include "core/formats/readers.h"

#include "core/base/byte_order.h"
#include "core/files/las_layout.h"
#include "core/formats/las_fields.h"
#include "core/laz/laz.h"
#include "core/splats/point_fields.h"

enum { BLOCK = 256 };

/* The fewest bytes of a point, and where its colour is in them; 0: no colour. Formats 4, 5, 9 and 10 have their
 * waveforms last. */
static const struct {
  int n_bytes, color;
} formats[] = {{20, 0}, {28, 0}, {26, 20}, {34, 28}, {57, 0}, {63, 28}, {30, 0}, {36, 30}, {38, 30}, {59, 0}, {67, 30}};

enum { N_FORMATS = sizeof formats / sizeof *formats };

typedef struct las_reader {
  conic_input *input;
  int is_again; /* the file is read once more; its faults are logged already */
  unsigned char header[CONIC_LAS_HEADER_1_4];
  unsigned format;
  int is_packed; /* LAZ */
  size_t point_bytes;
  uint64_t n_points, points_offset;
  uint64_t begin, end; /* the points that are read */
  int has_first;
  int color; /* as in `formats` */
  double scale[3], offset[3];
  double first[3]; /* the first point's integers */
  conic_builder builder;
  double block[3][BLOCK];
  conic_las_fields fields;
} las_reader;

static conic_status wrong_las(const las_reader *reader, const char *what, uint64_t at) {
  return conic_fail(reader->input->context, CONIC_ERROR_INPUT, "%s: %s (at byte %llu)", reader->input->name, what,
                    (unsigned long long)at);
}

static uint64_t unsigned_at(const las_reader *reader, int at, size_t n_bytes) {
  return conic_load_bits(reader->header + at, n_bytes);
}

static void warn(const las_reader *reader, const char *what) {
  if (!reader->is_again)
    conic_log(reader->input->context, CONIC_LOG_WARNING, "%s: %s", reader->input->name, what);
}

/* Copies the bytes of the public header. Fields of its version that a writer left out count as 0. */
static conic_status read_las_header(las_reader *reader) {
  conic_status status = conic_input_fill(reader->input, CONIC_LAS_HEADER_1_4);
  size_t available = conic_input_available(reader->input);
  if (status != CONIC_OK)
    return status;
  memset(reader->header, 0, sizeof reader->header);
  memcpy(reader->header, conic_input_bytes(reader->input),
         available < CONIC_LAS_HEADER_1_4 ? available : CONIC_LAS_HEADER_1_4);
  if (available < CONIC_LAS_LEAST_HEADER)
    return wrong_las(reader, "the file ends within the header", available);
  unsigned major = reader->header[CONIC_LAS_MAJOR], minor = reader->header[CONIC_LAS_MINOR];
  if (major != 1 || minor > 5)
    return conic_fail(reader->input->context, CONIC_ERROR_INPUT,
                      "%s: version %u.%u of LAS; 1.0 to 1.5 are read (at byte %d)", reader->input->name, major, minor,
                      CONIC_LAS_MAJOR);
  uint64_t n_bytes = unsigned_at(reader, CONIC_LAS_HEADER_BYTES, 2);
  if (n_bytes < CONIC_LAS_LEAST_HEADER)
    return wrong_las(reader, "the header is shorter than any version's", CONIC_LAS_HEADER_BYTES);
  if (n_bytes < CONIC_LAS_HEADER_1_4)
    memset(reader->header + n_bytes, 0, CONIC_LAS_HEADER_1_4 - (size_t)n_bytes);
  return CONIC_OK;
}

static conic_status check_format(las_reader *reader) {
  unsigned format = reader->header[CONIC_LAS_FORMAT] & 0x3fu;
  reader->is_packed = (reader->header[CONIC_LAS_FORMAT] & 0xC0u) != 0;
  reader->format = format;
  reader->point_bytes = (size_t)unsigned_at(reader, CONIC_LAS_POINT_BYTES, 2);
  if (format >= N_FORMATS)
    return conic_fail(reader->input->context, CONIC_ERROR_INPUT, "%s: point format %u; 0 to 10 are read (at byte %d)",
                      reader->input->name, format, CONIC_LAS_FORMAT);
  if (reader->point_bytes < (size_t)formats[format].n_bytes)
    return wrong_las(reader, "a point is shorter than its format", CONIC_LAS_POINT_BYTES);
  reader->color = formats[format].color;
  return CONIC_OK;
}

static conic_status read_scale(las_reader *reader) {
  for (int axis = 0; axis < 3; axis++) {
    int at_scale = CONIC_LAS_SCALE + 8 * axis, at_offset = CONIC_LAS_OFFSET + 8 * axis;
    reader->scale[axis] = conic_load_double(reader->header + at_scale);
    reader->offset[axis] = conic_load_double(reader->header + at_offset);
    if (!(reader->scale[axis] - reader->scale[axis] == 0.0) || reader->scale[axis] == 0.0)
      return wrong_las(reader, "a scale is zero or not finite", (uint64_t)at_scale);
    if (!(reader->offset[axis] - reader->offset[axis] == 0.0))
      return wrong_las(reader, "an offset is not finite", (uint64_t)at_offset);
    double farthest = fabs(reader->scale[axis]) * 0x1p31 + fabs(reader->offset[axis]);
    if (!(farthest - farthest == 0.0))
      return wrong_las(reader, "a scale is too large", (uint64_t)at_scale);
  }
  return CONIC_OK;
}

/* Finds how many points there are, by the file's size. The header is right where waveforms or records may follow the
 * points. Where neither do, further whole points were not counted, as by a writer that was stopped. */
static void count_points(las_reader *reader, uint64_t remaining) {
  uint64_t declared = reader->n_points, n_bytes = remaining - reader->points_offset;
  uint64_t present = n_bytes / reader->point_bytes;
  int is_all_points = n_bytes % reader->point_bytes == 0 && !unsigned_at(reader, CONIC_LAS_WAVEFORMS, 8) &&
                      !unsigned_at(reader, CONIC_LAS_LATE_RECORDS, 8);
  if (declared > present || is_all_points)
    reader->n_points = present;
  if (reader->n_points != declared && !reader->is_again)
    conic_log(reader->input->context, CONIC_LOG_WARNING,
              "%s: the header counts %llu points; the %llu that are there are "
              "read",
              reader->input->name, (unsigned long long)declared, (unsigned long long)reader->n_points);
}

/* Checks every size in the header against the others and the file. Since 1.4 the number of points has 64 bits; where a
 * writer left it 0, the older field counts. */
static conic_status check_sizes(las_reader *reader) {
  uint64_t header_bytes = unsigned_at(reader, CONIC_LAS_HEADER_BYTES, 2),
           n_records = unsigned_at(reader, CONIC_LAS_N_RECORDS, 4);
  uint64_t remaining = conic_input_remaining_bytes(reader->input);
  int has_64 = reader->header[CONIC_LAS_MINOR] >= 4 && unsigned_at(reader, CONIC_LAS_N_POINTS, 8) > 0;
  int count_at = has_64 ? CONIC_LAS_N_POINTS : CONIC_LAS_N_POINTS_32;
  reader->points_offset = unsigned_at(reader, CONIC_LAS_POINTS, 4);
  reader->n_points = unsigned_at(reader, count_at, has_64 ? 8 : 4);
  if (reader->points_offset < header_bytes)
    return wrong_las(reader, "the points begin within the header", CONIC_LAS_POINTS);
  if (reader->points_offset > remaining)
    return wrong_las(reader, "the points begin past the end of the file", CONIC_LAS_POINTS);
  if (n_records > (reader->points_offset - header_bytes) / CONIC_LAS_RECORD_HEAD)
    warn(reader, "more variable-length records are declared than fit before the points; they are passed over");
  if (reader->input->has_size && !reader->is_packed)
    count_points(reader, remaining);
  if (reader->n_points > CONIC_MAX_POINTS)
    return wrong_las(reader, "too many points", (uint64_t)count_at);
  if (reader->input->has_size && !reader->is_packed && reader->n_points == 0 &&
      unsigned_at(reader, count_at, has_64 ? 8 : 4) > 0)
    return wrong_las(reader, "the file ends within the first point", reader->points_offset);
  return CONIC_OK;
}

static conic_status skip_to(las_reader *reader, uint64_t offset) {
  uint64_t left = offset - conic_input_offset(reader->input), skipped;
  conic_status status = conic_input_skip(reader->input, left, &skipped);
  return status == CONIC_OK && skipped < left
             ? wrong_las(reader, "the file ends before its points", offset - left + skipped)
             : status;
}

/* Skips the header and its records, which name fields. */
static conic_status skip_to_points(las_reader *reader, const conic_read_options *options) {
  unsigned format = reader->format;
  uint64_t n_records = unsigned_at(reader, CONIC_LAS_N_RECORDS, 4);
  conic_las_fields *fields = &reader->fields;
  conic_las_fields_of_format(format, fields);
  conic_status status = skip_to(reader, unsigned_at(reader, CONIC_LAS_HEADER_BYTES, 2));
  if (status == CONIC_OK)
    status = conic_las_fields_read(reader->input, n_records, reader->points_offset, (size_t)formats[format].n_bytes,
                                   reader->point_bytes, fields);
  if (status == CONIC_OK)
    status = skip_to(reader, reader->points_offset);
  for (size_t i = 0; status == CONIC_OK && i < fields->n; i++)
    status = conic_fields_add(&reader->builder, fields->list[i].name, strlen(fields->list[i].name),
                              conic_las_field_type(&fields->list[i]));
  return status == CONIC_OK ? conic_fields_choose(&reader->builder, reader->input->name, options) : status;
}

/* Three integers of each of n points, as doubles, into the reader's block. */
static void convert(las_reader *reader, const unsigned char *records, size_t step, conic_ply_type type, size_t n) {
  for (size_t i = 0; i < 3; i++)
    conic_ply_convert(records + i * step, reader->point_bytes, n, type, CONIC_PLY_LITTLE_ENDIAN, reader->block[i]);
}

/* The file's first point is the origin, whichever points are read. */
static void take_first(las_reader *reader, const unsigned char *record) {
  double *origin = reader->builder.model->points.origin;
  convert(reader, record, 4, CONIC_PLY_INT32, 1);
  for (int axis = 0; axis < 3; axis++) {
    reader->first[axis] = reader->block[axis][0];
    origin[axis] = reader->block[axis][0] * reader->scale[axis] + reader->offset[axis];
  }
  reader->has_first = 1;
}

static conic_status take_first_packed(void *reader, const unsigned char *records, size_t n) {
  take_first(reader, records);
  (void)n;
  return CONIC_OK;
}

/* Differences of the integers are exact, and rounded once. */
static void store_records(las_reader *reader, const unsigned char *records, size_t n) {
  conic_splats *points = &reader->builder.model->points;
  if (!reader->has_first)
    take_first(reader, records);
  convert(reader, records, 4, CONIC_PLY_INT32, n);
  for (int axis = 0; axis < 3; axis++)
    for (size_t i = 0; i < n; i++)
      points->position[axis][points->count + i] =
          (float)((reader->block[axis][i] - reader->first[axis]) * reader->scale[axis]);
  if (reader->color)
    convert(reader, records + reader->color, 2, CONIC_PLY_UINT16, n);
  for (int channel = 0; channel < 3 && reader->color; channel++)
    for (size_t i = 0; i < n; i++)
      points->color[channel][points->count + i] = (float)reader->block[channel][i];
  for (size_t k = 0; k < conic_builder_columns(&reader->builder); k++) {
    int field = conic_builder_column_field(&reader->builder, k);
    if (field >= 0)
      conic_las_field_convert(&reader->fields.list[field], records, reader->point_bytes, n,
                              conic_builder_column(&reader->builder, k));
  }
  points->count += n;
}

/* Adds records, one block at a time. */
static conic_status take_las_records(void *cookie, const unsigned char *records, size_t n) {
  las_reader *reader = cookie;
  conic_status status = CONIC_OK;
  while (n > 0 && status == CONIC_OK) {
    size_t n_now = n < BLOCK ? n : BLOCK;
    status = conic_builder_reserve_points(&reader->builder, reader->builder.model->points.count + n_now);
    if (status == CONIC_OK) {
      store_records(reader, records, n_now);
      status = conic_builder_deliver(&reader->builder, 0);
    }
    records += n_now * reader->point_bytes;
    n -= n_now;
  }
  return status;
}

/* To the first point to be read; the first of the file gives the origin. */
static conic_status begin_plain_las(las_reader *reader) {
  uint64_t left = reader->begin * reader->point_bytes, skipped;
  if (reader->begin == 0 || reader->begin >= reader->end)
    return CONIC_OK;
  conic_status status = conic_input_fill(reader->input, reader->point_bytes);
  if (status == CONIC_OK && conic_input_available(reader->input) >= reader->point_bytes)
    take_first(reader, conic_input_bytes(reader->input));
  return status == CONIC_OK ? conic_input_skip(reader->input, left, &skipped) : status;
}

static conic_status read_plain_las(las_reader *reader) {
  conic_input *input = reader->input;
  uint64_t n_points = reader->begin < reader->end ? reader->end - reader->begin : 0;
  conic_status status = begin_plain_las(reader);
  while (status == CONIC_OK && conic_builder_points(&reader->builder) < n_points) {
    uint64_t left = n_points - conic_builder_points(&reader->builder);
    status = conic_input_fill(input, reader->point_bytes);
    size_t n = conic_input_available(input) / reader->point_bytes;
    if (status != CONIC_OK)
      break;
    if (n == 0) { /* nobody could tell before where the input is a pipe */
      if (!reader->is_again)
        conic_log(input->context, CONIC_LOG_WARNING,
                  "%s: the file ends before all of its points: %llu of %llu are left out", input->name,
                  (unsigned long long)left, (unsigned long long)reader->n_points);
      break;
    }
    n = n < left ? n : (size_t)left;
    status = take_las_records(reader, conic_input_bytes(input), n);
    input->next += n * reader->point_bytes;
  }
  return status;
}

/* Unpacks only the layers with wanted fields. */
static conic_status read_packed_las(las_reader *reader) {
  const conic_las_fields *fields = &reader->fields;
  conic_input *input = reader->input;
  conic_laz_format packing;
  unsigned wanted = CONIC_LAZ_Z | CONIC_LAZ_COLORS;
  if (fields->n_packing == 0)
    return wrong_las(reader, "the points are compressed, and no record says how", CONIC_LAS_FORMAT);
  for (size_t k = 0; k < conic_builder_columns(&reader->builder); k++) {
    int field = conic_builder_column_field(&reader->builder, k);
    wanted |= field >= 0 ? conic_las_field_layer(reader->format, &fields->list[field]) : 0;
  }
  conic_status status = conic_laz_format_read(input->context, input->name, fields->packing, fields->n_packing,
                                              reader->format, reader->point_bytes, &packing);
  if (status == CONIC_OK && reader->begin > 0)
    status = conic_laz_read(input, &packing, reader->n_points, 0, 1, CONIC_LAZ_Z, 1, take_first_packed, reader);
  return status == CONIC_OK ? conic_laz_read(input, &packing, reader->n_points, reader->begin, reader->end, wanted,
                                             reader->is_again, take_las_records, reader)
                            : status;
}

/* Takes room for all points at once, where the file's size confirms their number. A packed file may be far smaller:
 * then room grows with the points. */
static conic_status read_points(las_reader *reader) {
  conic_builder *builder = &reader->builder;
  uint64_t n_sure = reader->is_packed ? reader->input->size_bytes / 2 : reader->n_points;
  conic_status status = CONIC_OK;
  if (reader->input->has_size && !builder->delivery)
    status =
        conic_builder_reserve_points_exactly(builder, (size_t)(reader->n_points < n_sure ? reader->n_points : n_sure));
  if (status == CONIC_OK)
    status = reader->is_packed ? read_packed_las(reader) : read_plain_las(reader);
  return status;
}

static conic_status read_las_head(las_reader *reader) {
  conic_status status = read_las_header(reader);
  if (status == CONIC_OK)
    status = check_format(reader);
  if (status == CONIC_OK)
    status = read_scale(reader);
  return status == CONIC_OK ? check_sizes(reader) : status;
}

conic_status conic_las_look(conic_input *input, conic_model_shape *shape) {
  las_reader reader = {.input = input, .is_again = 1};
  conic_status status = read_las_head(&reader);
  *shape =
      (conic_model_shape){.can_part = 1, .is_raw = 1, .needs_survey = reader.color != 0, .n_points = reader.n_points};
  return status;
}

conic_status conic_las_read(conic_input *input, const conic_read_options *options, const conic_delivery *delivery,
                            conic_model *model) {
  las_reader reader = {.input = input, .is_again = delivery && delivery->is_again};
  conic_status status = read_las_head(&reader);
  reader.begin = delivery && delivery->range ? delivery->range->first : 0;
  reader.end =
      delivery && delivery->range && delivery->range->end < reader.n_points ? delivery->range->end : reader.n_points;
  if (status == CONIC_OK)
    status =
        conic_builder_begin(input->context, model, reader.color ? CONIC_SPLATS_COLORS : 0u, delivery, &reader.builder);
  if (status == CONIC_OK)
    status = skip_to_points(&reader, options);
  if (status == CONIC_OK)
    status = read_points(&reader);
  if (status == CONIC_OK && !delivery)
    status = conic_raw_colors_decode(input->context, &model->points, 0, &model->colors_are);
  return status == CONIC_OK ? conic_builder_deliver(&reader.builder, 1) : status;
}
