#include "core/formats/las_write.h"

#include "core/base/byte_order.h"
#include "core/base/color.h"
#include "core/files/disk.h"
#include "core/files/file.h"
#include "core/files/las_layout.h"
#include "core/formats/las_fields.h"
#include "core/splats/point_fields.h"

enum { EXTRA = 192, MOST_RECORDS = 1 << 20 };
enum { GPS_IS_ADJUSTED = 1, IS_WELL_KNOWN_TEXT = 16 }; /* of the encoding */
enum { KEYS = 34735, TEXT = 34737, WELL_KNOWN_TEXT = 2112, EXTRA_BYTES = 4, RETURNS = 15 };
enum { AT_RETURN = 14, AT_COLOR = 30, POINT_BYTES = 30, COLOR_BYTES = 6 };

/* A value of the first batch, and where it goes. */
typedef struct las_column {
  char name[CONIC_LAS_NAME_ROOM];
  const char *prefix; /* of the name in the file */
  conic_las_field field;
  const double *values; /* in the current batch; null: it lacks them */
  int is_whole;         /* what the field cannot hold is an error */
} las_column;

struct conic_las_writer {
  conic_context *context;
  const char *path;
  conic_output *output;
  FILE *file;
  unsigned char header[CONIC_LAS_HEADER_1_4];
  unsigned char *records; /* the source's, about the coordinate system */
  size_t n_record_bytes;
  uint32_t n_records;
  int has_begun, has_source, has_colors, has_returns;
  double scale[3], offset[3], low[3], high[3];
  uint64_t count, by_return[RETURNS];
  size_t point_bytes, n_columns, n_extra;
  las_column columns[CONIC_MOST_POINT_VALUES];
};

/* --- the source's head --- */

static void put_letters(unsigned char *to, const char *letters) {
  while (*letters)
    *to++ = (unsigned char)*letters++;
}

/* Keeps the records about the coordinate system from a head of n bytes. */
static conic_status keep_records(conic_las_writer *w, const unsigned char *head, size_t n) {
  size_t at = conic_load_16(head + CONIC_LAS_HEADER_BYTES);
  w->records = conic_memory_allocate(w->context, n, 1);
  if (!w->records)
    return CONIC_ERROR_MEMORY;
  for (uint32_t i = conic_load_32(head + CONIC_LAS_N_RECORDS); i > 0 && at + CONIC_LAS_RECORD_HEAD <= n; i--) {
    const unsigned char *record = head + at;
    size_t n_bytes = CONIC_LAS_RECORD_HEAD + (size_t)conic_load_16(record + 20);
    unsigned number = conic_load_16(record + 18);
    if (n_bytes > n - at)
      break;
    if (conic_las_is_of_world(record) && ((number >= KEYS && number <= TEXT) || number == WELL_KNOWN_TEXT)) {
      memcpy(w->records + w->n_record_bytes, record, n_bytes);
      w->n_record_bytes += n_bytes;
      w->n_records++;
      if (number == WELL_KNOWN_TEXT)
        w->header[CONIC_LAS_ENCODING] |= IS_WELL_KNOWN_TEXT;
    }
    at += n_bytes;
  }
  return CONIC_OK;
}

static conic_status take_source_head(conic_las_writer *w, FILE *file) {
  unsigned char start[CONIC_LAS_HEADER_1_4] = {0};
  size_t n = fread(start, 1, sizeof start, file), n_head = conic_load_32(start + CONIC_LAS_POINTS);
  if (n < 227 || memcmp(start, "LASF", 4) != 0 || n_head < 227 || n_head > MOST_RECORDS)
    return CONIC_OK;
  w->has_source = 1;
  w->header[CONIC_LAS_ENCODING] = start[CONIC_LAS_ENCODING] & GPS_IS_ADJUSTED;
  for (int axis = 0; axis < 3; axis++) {
    w->scale[axis] = fabs(conic_load_double(start + CONIC_LAS_SCALE + 8 * (size_t)axis));
    w->offset[axis] = conic_load_double(start + CONIC_LAS_OFFSET + 8 * (size_t)axis);
    w->has_source &= w->scale[axis] > 0.0 && w->scale[axis] + fabs(w->offset[axis]) < 1e300;
  }
  unsigned char *head = fseeko(file, 0, SEEK_SET) == 0 ? conic_memory_allocate(w->context, n_head, 1) : NULL;
  if (!head)
    return CONIC_ERROR_MEMORY;
  conic_status status = keep_records(w, head, fread(head, 1, n_head, file));
  conic_memory_release(w->context, head);
  return status;
}

/* As the record of keys that a LAS would have. */
static conic_status put_reference(conic_las_writer *w, const conic_georeference *reference) {
  const size_t n = reference->n_keys * sizeof *reference->keys;
  if (!reference->epsg || w->n_records)
    return CONIC_OK;
  unsigned char *to = conic_memory_allocate_zeroed(w->context, CONIC_LAS_RECORD_HEAD + n, 1);
  if (!to)
    return CONIC_ERROR_MEMORY;
  conic_memory_release(w->context, w->records);
  put_letters(to + 2, "LASF_Projection");
  conic_store_bits(to + 18, 2, KEYS);
  conic_store_bits(to + 20, 2, n);
  for (size_t i = 0; i < reference->n_keys; i++)
    conic_store_bits(to + CONIC_LAS_RECORD_HEAD + 2 * i, 2, reference->keys[i]);
  w->records = to;
  w->n_record_bytes = CONIC_LAS_RECORD_HEAD + n;
  w->n_records = 1;
  return CONIC_OK;
}

conic_status conic_las_writer_open(conic_context *context, const char *path, const char *source,
                                   const conic_georeference *reference, conic_las_writer **writer) {
  *writer = NULL;
  if (strcmp(path, "-") == 0)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "a .las goes into a file, not to standard output");
  conic_las_writer *w = conic_memory_allocate_zeroed(context, 1, sizeof *w);
  if (!w)
    return CONIC_ERROR_MEMORY;
  w->context = context;
  w->path = path;
  FILE *file = source && conic_file_is_there(source) ? conic_disk_open_stream(source, "rb") : NULL;
  conic_status status = file ? take_source_head(w, file) : CONIC_OK;
  if (file)
    fclose(file);
  if (status == CONIC_OK)
    status = put_reference(w, reference);
  if (status == CONIC_OK)
    status = conic_output_open(context, path, &w->output);
  if (status != CONIC_OK)
    return conic_las_writer_end(w, status);
  w->file = conic_output_stream(w->output);
  *writer = w;
  return CONIC_OK;
}

/* --- the header --- */

/* The format's own field of a name, or of one that means the same, such as Intensity; null: it has none. */
static const conic_las_field *find_own_field(const conic_las_fields *fields, const char *name) {
  for (size_t i = 0; i < fields->n; i++)
    if (strcmp(fields->list[i].name, name) == 0)
      return &fields->list[i];
  for (size_t i = 0; i < fields->n; i++)
    if (conic_field_is(fields->list[i].name, name))
      return &fields->list[i];
  return NULL;
}

/* The most that a field of whole numbers holds; 0: its numbers are others. */
static double most_of_whole(const conic_las_field *field) {
  if (field->mask)
    return (double)field->mask;
  if (field->scale != 1.0 || (field->type != CONIC_PLY_UINT8 && field->type != CONIC_PLY_UINT16))
    return 0.0;
  return field->type == CONIC_PLY_UINT8 ? 255.0 : 65535.0;
}

static int is_whole_number(double value, double most) {
  return !(value - value == 0.0) || (value >= 0.0 && value <= most && value == floor(value));
}

static void add_extra_column(conic_las_writer *w, const char *prefix, const char *name, const char *type) {
  las_column *column = &w->columns[w->n_columns++];
  *column = (las_column){.prefix = prefix, .field = {.type = conic_ply_type_of(type), .scale = 1.0}};
  snprintf(column->name, sizeof column->name, "%s", name);
  column->field.at = w->point_bytes;
  w->point_bytes += conic_ply_type_bytes(column->field.type);
  w->n_extra++;
}

/* Numbers of other files that a field of whole numbers would spoil are also kept as they are. The field has them
 * rounded, or, where they lie between 0 and 1, of 65,535. */
static void choose_own_column(conic_las_writer *w, const conic_las_field *own, const conic_point_values *values,
                              size_t k) {
  las_column *column = &w->columns[w->n_columns++];
  const double most = w->has_source ? 0.0 : most_of_whole(own);
  double greatest = 0.0, least = 0.0;
  int is_whole = 1;
  for (size_t i = 0; i < values->count && most > 0.0; i++) {
    const double value = values->value[k][i];
    is_whole &= is_whole_number(value, most);
    greatest = value > greatest ? value : greatest;
    least = value < least ? value : least;
  }
  *column = (las_column){.prefix = "", .field = *own, .is_whole = most > 0.0 && is_whole};
  snprintf(column->name, sizeof column->name, "%s", values->field[k].name);
  w->has_returns |= strcmp(own->name, "return_number") == 0;
  if (is_whole)
    return;
  if (greatest <= 1.0 && least >= 0.0)
    column->field.scale = 1.0 / most;
  if (w->n_columns < CONIC_MOST_POINT_VALUES)
    add_extra_column(w, "exact_", values->field[k].name, "double");
}

/* Whether another value has the field: of its very name, or one before that means the same. */
static int is_taken(const conic_las_field *own, const conic_point_values *values, size_t k) {
  for (size_t i = 0; i < values->n; i++)
    if (i != k &&
        (strcmp(values->field[i].name, own->name) == 0 || (i < k && conic_field_is(values->field[i].name, own->name))))
      return strcmp(values->field[k].name, own->name) != 0;
  return 0;
}

static void choose_las_columns(conic_las_writer *w, const conic_point_values *values) {
  conic_las_fields fields;
  conic_las_fields_of_format(w->has_colors ? 7 : 6, &fields);
  for (size_t k = 0; values && k < values->n && w->n_columns < CONIC_MOST_POINT_VALUES; k++) {
    const char *name = values->field[k].name, *type = values->field[k].type;
    const conic_las_field *own = find_own_field(&fields, name);
    if (conic_field_is_of_splats(name))
      continue;
    if (own && !is_taken(own, values, k))
      choose_own_column(w, own, values, k);
    else
      add_extra_column(w, "", name, type ? type : "double");
  }
}

/* The record that describes the values beyond the format's. */
static void put_extra_record(conic_las_writer *w) {
  static const unsigned char numbers[] = {2, 1, 4, 3, 6,
                                          5, 9, 10}; /* numbers of the types, in the order of
                                                        conic_ply_type */
  unsigned char record[CONIC_LAS_RECORD_HEAD] = {0}, extra[EXTRA];
  put_letters(record + 2, "LASF_Spec");
  conic_store_bits(record + 18, 2, EXTRA_BYTES);
  conic_store_bits(record + 20, 2, EXTRA * w->n_extra);
  fwrite(record, 1, sizeof record, w->file);
  for (size_t k = 0; k < w->n_columns; k++) {
    const las_column *column = &w->columns[k];
    if (column->field.name[0]) /* a field of the format */
      continue;
    memset(extra, 0, sizeof extra);
    extra[2] = numbers[column->field.type];
    char name[CONIC_LAS_NAME_ROOM + 8];
    snprintf(name, sizeof name, "%s%s", column->prefix, column->name);
    for (size_t i = 0; i < 32 && name[i]; i++)
      extra[4 + i] = (unsigned char)name[i];
    fwrite(extra, 1, sizeof extra, w->file);
  }
}

static void settle_steps(conic_las_writer *w, const conic_splats *first) {
  int may_be_degrees = 1;
  for (int axis = 0; axis < 3 && !w->has_source; axis++) {
    double place = first ? first->origin[axis] + (double)first->position[axis][0] : 0.0;
    may_be_degrees &= axis == 2 || fabs(place) <= 180.0;
    w->offset[axis] = place - place == 0.0 ? floor(place) : 0.0;
  }
  for (int axis = 0; axis < 3 && !w->has_source; axis++)
    w->scale[axis] = may_be_degrees && axis < 2 ? 1e-7 : 1e-3;
}

static void put_las_header(conic_las_writer *w) {
  unsigned char *h = w->header;
  size_t n_extra_bytes = w->n_extra ? CONIC_LAS_RECORD_HEAD + EXTRA * w->n_extra : 0;
  put_letters(h, "LASF");
  h[CONIC_LAS_MAJOR] = 1;
  h[CONIC_LAS_MAJOR + 1] = 4;
  put_letters(h + CONIC_LAS_SYSTEM, "EXTRACTION");
  put_letters(h + CONIC_LAS_SOFTWARE, "conic");
  conic_store_bits(h + CONIC_LAS_HEADER_BYTES, 2, CONIC_LAS_HEADER_1_4);
  conic_store_32(h + CONIC_LAS_POINTS, (uint32_t)(CONIC_LAS_HEADER_1_4 + w->n_record_bytes + n_extra_bytes));
  conic_store_32(h + CONIC_LAS_N_RECORDS, w->n_records + (w->n_extra > 0));
  h[CONIC_LAS_FORMAT] = w->has_colors ? 7 : 6;
  conic_store_bits(h + CONIC_LAS_POINT_BYTES, 2, w->point_bytes);
  for (int axis = 0; axis < 3; axis++) {
    conic_store_double(h + CONIC_LAS_SCALE + 8 * (size_t)axis, w->scale[axis]);
    conic_store_double(h + CONIC_LAS_OFFSET + 8 * (size_t)axis, w->offset[axis]);
    conic_store_double(h + CONIC_LAS_BOUNDS + 16 * (size_t)axis, w->count ? w->high[axis] : 0.0);
    conic_store_double(h + CONIC_LAS_BOUNDS + 16 * (size_t)axis + 8, w->count ? w->low[axis] : 0.0);
  }
  conic_store_64(h + CONIC_LAS_N_POINTS, w->count);
  for (int i = 0; i < RETURNS; i++)
    conic_store_64(h + CONIC_LAS_BY_RETURN + 8 * (size_t)i, w->by_return[i]);
  fwrite(h, 1, CONIC_LAS_HEADER_1_4, w->file);
}

static void begin_las(conic_las_writer *w, const conic_splats *first) {
  w->has_begun = 1;
  w->has_colors = first && first->color[0];
  w->point_bytes = w->has_colors ? POINT_BYTES + COLOR_BYTES : POINT_BYTES;
  settle_steps(w, first);
  choose_las_columns(w, first ? first->values : NULL);
  put_las_header(w); /* once more, when all is known */
  if (w->n_record_bytes)
    fwrite(w->records, 1, w->n_record_bytes, w->file);
  if (w->n_extra)
    put_extra_record(w);
}

/* --- points --- */

/* Positions become steps. Returns whether the point can be written: it is finite. */
static conic_status put_place(conic_las_writer *w, const conic_splats *batch, size_t i, unsigned char *point,
                              int *is_there) {
  double place[3];
  *is_there = 1;
  for (int axis = 0; axis < 3; axis++) {
    place[axis] = batch->origin[axis] + (double)batch->position[axis][i];
    *is_there &= place[axis] - place[axis] == 0.0;
  }
  for (int axis = 0; axis < 3 && *is_there; axis++) {
    double steps = floor((place[axis] - w->offset[axis]) / w->scale[axis] + 0.5);
    if (!(fabs(steps) <= 2147483647.0))
      return conic_fail(w->context, CONIC_ERROR_UNSUPPORTED,
                        "%s: cannot write: %.17g is too far from %.17g for steps of %g", w->path, place[axis],
                        w->offset[axis], w->scale[axis]);
    conic_store_32(point + 4 * (size_t)axis, (uint32_t)(int32_t)steps);
    place[axis] = steps * w->scale[axis] + w->offset[axis]; /* as it will be read */
    w->low[axis] = w->count && w->low[axis] < place[axis] ? w->low[axis] : place[axis];
    w->high[axis] = w->count && w->high[axis] > place[axis] ? w->high[axis] : place[axis];
  }
  return CONIC_OK;
}

/* Puts a value into its bits or bytes, rounded to the nearest that they hold. */
static void put_las_value(const conic_las_field *field, double value, unsigned char *point) {
  if (field->mask) {
    double most = (double)field->mask;
    unsigned number = value > 0.0 ? (unsigned)(value < most ? value : most) : 0;
    point[field->at] = (unsigned char)(point[field->at] | number << field->shift);
    return;
  }
  conic_ply_store(field->type, (value - field->offset) / field->scale, point + field->at);
}

static void put_las_colors(const conic_splats *batch, size_t i, unsigned char *point) {
  for (int c = 0; c < 3; c++) {
    double code = 65535.0 * conic_srgb_encode((double)batch->color[c][i]);
    conic_store_bits(point + AT_COLOR + 2 * (size_t)c, 2,
                     (uint64_t)(code > 0.0 ? code < 65535.0 ? code + 0.5 : 65535.0 : 0.0));
  }
}

static conic_status put_las_point(conic_las_writer *w, const conic_splats *batch, size_t i, unsigned char *point) {
  int is_there;
  memset(point, 0, w->point_bytes);
  conic_status status = put_place(w, batch, i, point, &is_there);
  if (status != CONIC_OK || !is_there)
    return status;
  for (size_t k = 0; k < w->n_columns; k++) {
    const las_column *column = &w->columns[k];
    if (!column->values)
      continue;
    if (column->is_whole && !is_whole_number(column->values[i], most_of_whole(&column->field)))
      return conic_fail(w->context, CONIC_ERROR_UNSUPPORTED,
                        "%s: cannot write: %s is %.9g, and has no fractions in LAS", w->path, column->name,
                        column->values[i]);
    put_las_value(&column->field, column->values[i], point);
  }
  if (!w->has_returns)
    point[AT_RETURN] = 1 | 1 << 4; /* the only one */
  if (w->has_colors && batch->color[0])
    put_las_colors(batch, i, point);
  unsigned number = point[AT_RETURN] & 15u;
  if (number > 0)
    w->by_return[number - 1]++;
  w->count++;
  return fwrite(point, 1, w->point_bytes, w->file) == w->point_bytes
             ? CONIC_OK
             : conic_fail(w->context, CONIC_ERROR_IO, "%s: cannot write", w->path);
}

conic_status conic_las_writer_append(conic_las_writer *w, const conic_splats *batch) {
  const conic_point_values *values = batch->values;
  conic_status status = CONIC_OK;
  if (batch->count == 0)
    return CONIC_OK;
  if (!w->has_begun)
    begin_las(w, batch);
  for (size_t k = 0; k < w->n_columns; k++) {
    w->columns[k].values = NULL;
    for (size_t i = 0; values && i < values->n; i++)
      if (strcmp(values->field[i].name, w->columns[k].name) == 0)
        w->columns[k].values = values->value[i];
  }
  unsigned char *point = conic_memory_allocate(w->context, w->point_bytes, 1);
  if (!point)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < batch->count && status == CONIC_OK; i++)
    status = put_las_point(w, batch, i, point);
  conic_memory_release(w->context, point);
  return status;
}

conic_status conic_las_writer_end(conic_las_writer *w, conic_status status) {
  if (!w)
    return status;
  if (status == CONIC_OK && !w->has_begun)
    begin_las(w, NULL);
  if (status == CONIC_OK && fseeko(w->file, 0, SEEK_SET) == 0)
    put_las_header(w);
  status = conic_output_end(w->output, status);
  conic_memory_release_these(w->context, w->records, w);
  return status;
}
