#include "conic/version.h"
#include "core/base/byte_order.h"
#include "core/base/color.h"
#include "core/base/vectors.h"
#include "core/files/file.h"
#include "core/files/number.h"
#include "core/formats/ply_header.h"
#include "core/splats/columns.h"
#include "core/splats/point_fields.h"

/* Rows that are laid out together, and the most values and bytes of one. */
enum {
  BLOCK = 256,
  MAX_VALUES = 25,
  MAX_BINARY_BYTES = 3 * 8 + 19 * 4 + 3,
  MAX_TEXT_BYTES = MAX_VALUES * CONIC_NUMBER_ROOM
};

struct conic_splats_writer {
  conic_context *context;
  conic_output *output;
  char *path; /* for messages */
  conic_write_options options;
  size_t count, written;
  size_t next_clip; /* of the current batch */
  unsigned fields;
  int has_header, has_double_positions, has_byte_colors;
  float srgb[256], thresholds[255];
  char *rows;      /* BLOCK of them */
  size_t n_values; /* named values of the first batch */
  conic_model_field values[CONIC_MOST_POINT_VALUES];
  conic_ply_type value_types[CONIC_MOST_POINT_VALUES];
  const double *columns[CONIC_MOST_POINT_VALUES]; /* of the current batch; null: it lacks them */
};

/* Where the next value of a row goes. */
typedef struct row_cursor {
  char *next;
  conic_ply_encoding encoding;
} row_cursor;

CONIC_DEFINE_OPTIONS(conic_write_options, .cutoff = 1.5f)

static conic_status check_write_options(conic_context *context, const char *path, const conic_write_options *options,
                                        unsigned fields) {
  int is_cutoff_usable = options->cutoff > 0.0f && options->cutoff - options->cutoff == 0.0f;
  if ((options->encoding != CONIC_PLY_BINARY && options->encoding != CONIC_PLY_ASCII) ||
      (options->circles && !is_cutoff_usable))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "%s: the writer's options have no meaning", path);
  if (options->circles && !(fields & CONIC_SPLATS_TANGENTS))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "%s: points without axes cannot be written as circles", path);
  return CONIC_OK;
}

conic_status conic_splats_writer_open(conic_context *context, const char *path, size_t count, unsigned fields,
                                      const conic_write_options *options, conic_splats_writer **writer) {
  conic_write_options settings;
  *writer = NULL;
  conic_write_options_init(&settings);
  if (options && !conic_options_take(&settings, options))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "%s: the writer's options were not initialised", path);
  conic_status status = check_write_options(context, path, &settings, fields);
  if (status != CONIC_OK)
    return status;
  conic_splats_writer *made = conic_memory_allocate_zeroed(context, 1, sizeof *made);
  if (!made)
    return CONIC_ERROR_MEMORY;
  made->context = context;
  made->options = settings;
  made->count = count;
  made->fields = fields;
  if (fields & CONIC_SPLATS_CLIPS) /* lines are in units of the axes, which circles do not keep */
    made->options.circles = 0;
  conic_srgb_decode_table(made->srgb);
  conic_srgb_thresholds(made->thresholds);
  size_t row_bytes = settings.encoding == CONIC_PLY_ASCII ? MAX_TEXT_BYTES : MAX_BINARY_BYTES;
  made->rows = conic_memory_allocate(context, BLOCK, row_bytes);
  made->path = conic_memory_copy_text(context, path);
  status = made->rows && made->path ? conic_output_open(context, path, &made->output) : CONIC_ERROR_MEMORY;
  if (status != CONIC_OK) {
    conic_splats_writer_abandon(made);
    return status;
  }
  *writer = made;
  return CONIC_OK;
}

void conic_splats_writer_abandon(conic_splats_writer *writer) {
  if (!writer)
    return;
  conic_output_abandon(writer->output);
  conic_memory_release_these(writer->context, writer->rows, writer->path, writer);
}

/* Whether every colour is exactly that of an 8-bit sRGB code. */
static int are_byte_colors(const conic_splats_writer *writer, const conic_splats *batch) {
  for (int channel = 0; channel < 3; channel++)
    for (size_t i = 0; i < batch->count; i++) {
      float value = batch->color[channel][i];
      if (writer->srgb[conic_srgb_code(writer->thresholds, value)] != value)
        return 0;
    }
  return 1;
}

static void print_properties(FILE *to, const char *type, const char *names) {
  for (const char *c = names; *c;) {
    size_t n = strcspn(c, " ");
    fprintf(to, "property %s %.*s\n", type, (int)n, c);
    c += n + (c[n] == ' ');
  }
}

/* Joins a name's words, because blanks separate those of a header. */
static void print_value(FILE *to, const char *type, const char *name) {
  fprintf(to, "property %s ", type);
  for (const char *c = name; *c; c++)
    fputc((unsigned char)*c > ' ' ? *c : '_', to);
  fputc('\n', to);
}

static void print_header(const conic_splats_writer *writer) {
  FILE *to = conic_output_stream(writer->output);
  int has_axes = (writer->fields & CONIC_SPLATS_TANGENTS) != 0;
  fprintf(to, "ply\nformat %s 1.0\ncomment conic %s\n",
          writer->options.encoding == CONIC_PLY_ASCII ? "ascii" : "binary_little_endian", conic_version());
  if (writer->options.epsg)
    fprintf(to, "comment crs EPSG:%u\n", writer->options.epsg);
  fprintf(to, "element vertex %zu\n", writer->count);
  print_properties(to, writer->has_double_positions ? "double" : "float", "x y z");
  if (has_axes && writer->options.circles)
    print_properties(to, "float", "nx ny nz radius");
  else if (has_axes)
    print_properties(to, "float", "tu_x tu_y tu_z tv_x tv_y tv_z");
  else if (writer->fields & CONIC_SPLATS_NORMALS)
    print_properties(to, "float", "nx ny nz");
  if (writer->fields & CONIC_SPLATS_COLORS)
    print_properties(to, writer->has_byte_colors ? "uchar" : "float", "red green blue");
  if (writer->fields & CONIC_SPLATS_OPACITIES)
    print_properties(to, "float", "opacity");
  if (writer->fields & CONIC_SPLATS_DOTS)
    print_properties(to, "uchar", "dot");
  for (size_t k = 0; k < writer->n_values; k++)
    print_value(to, conic_ply_type_word(writer->value_types[k]), writer->values[k].name);
  if (writer->fields & CONIC_SPLATS_CLIPS)
    fprintf(to, "property list uchar float clip_and\nproperty list uchar float clip_or\n");
  fprintf(to, "end_header\n");
}

/* Finds the values to write, and makes room for them in a row. */
static conic_status begin_values(conic_splats_writer *writer, const conic_point_values *values) {
  int is_text = writer->options.encoding == CONIC_PLY_ASCII;
  for (size_t k = 0; values && k < values->n; k++) {
    const conic_model_field *field = &values->field[k];
    if (conic_field_is_of_splats(field->name))
      continue;
    writer->value_types[writer->n_values] = conic_ply_type_of(field->type ? field->type : "double");
    writer->values[writer->n_values++] = *field;
  }
  if (writer->n_values == 0)
    return CONIC_OK;
  size_t row_bytes = is_text ? MAX_TEXT_BYTES + writer->n_values * CONIC_NUMBER_ROOM
                             : MAX_BINARY_BYTES + writer->n_values * sizeof(double);
  conic_memory_release(writer->context, writer->rows);
  writer->rows = conic_memory_allocate(writer->context, BLOCK, row_bytes);
  return writer->rows ? CONIC_OK : CONIC_ERROR_MEMORY;
}

/* Finds the values of a batch. */
static void find_columns(conic_splats_writer *writer, const conic_point_values *values) {
  for (size_t k = 0; k < writer->n_values; k++) {
    writer->columns[k] = NULL;
    for (size_t i = 0; values && i < values->n && !writer->columns[k]; i++)
      if (strcmp(values->field[i].name, writer->values[k].name) == 0)
        writer->columns[k] = values->value[i];
  }
}

/* The first batch, which may be missing, decides how positions and colours are stored. */
static void begin_rows(conic_splats_writer *writer, const conic_splats *first) {
  writer->has_double_positions = writer->options.double_positions != 0;
  for (int axis = 0; first && axis < 3; axis++)
    writer->has_double_positions |= first->origin[axis] != 0.0;
  if (writer->fields & CONIC_SPLATS_COLORS)
    writer->has_byte_colors = !first || are_byte_colors(writer, first);
  print_header(writer);
  writer->has_header = 1;
}

static void put_text_end(row_cursor *row, size_t length) {
  row->next += length;
  *row->next++ = ' ';
}

static void put_float(row_cursor *row, float value) {
  if (row->encoding == CONIC_PLY_ASCII) {
    put_text_end(row, conic_number_print_float(row->next, value));
    return;
  }
  conic_store_float(row->next, value);
  row->next += sizeof value;
}

static void put_double(row_cursor *row, double value) {
  if (row->encoding == CONIC_PLY_ASCII) {
    put_text_end(row, conic_number_print(row->next, value));
    return;
  }
  conic_store_double(row->next, value);
  row->next += sizeof value;
}

static void put_byte(row_cursor *row, uint8_t value) {
  if (row->encoding == CONIC_PLY_ASCII)
    put_text_end(row, conic_number_print_float(row->next, (float)value));
  else
    *row->next++ = (char)value;
}

static void put_vector(row_cursor *row, float *const vector[3], size_t i) {
  for (int axis = 0; axis < 3; axis++)
    put_float(row, vector[axis][i]);
}

/* The unit normal t_u × t_v, and the outline's radius. Zero axes give zeros, NaN gives NaN: both are repaired when they
 * are read. */
static void put_circle(row_cursor *row, const conic_splats *batch, size_t i, float cutoff) {
  double u[3], v[3], normal[3];
  conic_vector_at(batch->tangent_u, i, u);
  conic_vector_at(batch->tangent_v, i, v);
  conic_cross(u, v, normal);
  double length = conic_length(normal);
  for (int axis = 0; axis < 3; axis++)
    put_float(row, (float)(length > 0.0 ? normal[axis] / length : normal[axis]));
  put_float(row, (float)(conic_length(u) * (double)cutoff));
}

static void put_value(row_cursor *row, conic_ply_type type, double value) {
  if (row->encoding == CONIC_PLY_ASCII && type == CONIC_PLY_FLOAT)
    put_float(row, (float)value);
  else if (row->encoding == CONIC_PLY_ASCII)
    put_double(row, conic_ply_nearest(type, value));
  else {
    conic_ply_store(type, value, row->next);
    row->next += conic_ply_type_bytes(type);
  }
}

/* The two lists of splat i's clip lines; at least one is empty. */
static void put_clip(conic_splats_writer *writer, row_cursor *row, const conic_splats *batch, size_t i) {
  const conic_clip *clip = NULL;
  while (writer->next_clip < batch->n_clips && batch->clips[writer->next_clip].splat < i)
    writer->next_clip++;
  if (writer->next_clip < batch->n_clips && batch->clips[writer->next_clip].splat == i)
    clip = &batch->clips[writer->next_clip];
  for (int operation = CONIC_CLIP_AND; operation <= CONIC_CLIP_OR; operation++) {
    int n_lines = clip && (int)clip->operation == operation ? clip->n_lines : 0;
    n_lines = n_lines < 2 ? n_lines : 2;
    put_byte(row, (uint8_t)(3 * n_lines));
    for (int k = 0; k < 3 * n_lines; k++)
      put_float(row, clip->lines[k / 3][k % 3]);
  }
}

static void put_row(conic_splats_writer *writer, row_cursor *row, const conic_splats *batch, size_t i) {
  for (int axis = 0; axis < 3; axis++) {
    double position = (double)batch->position[axis][i];
    if (batch->origin[axis] != 0.0) /* adding 0 would turn -0 into 0 */
      position += batch->origin[axis];
    if (writer->has_double_positions)
      put_double(row, position);
    else
      put_float(row, (float)position);
  }
  if ((writer->fields & CONIC_SPLATS_TANGENTS) && writer->options.circles)
    put_circle(row, batch, i, writer->options.cutoff);
  else if (writer->fields & CONIC_SPLATS_TANGENTS) {
    put_vector(row, batch->tangent_u, i);
    put_vector(row, batch->tangent_v, i);
  } else if (writer->fields & CONIC_SPLATS_NORMALS)
    put_vector(row, batch->normal, i);
  for (int channel = 0; channel < 3 && (writer->fields & CONIC_SPLATS_COLORS); channel++) {
    float value = batch->color[channel][i];
    if (writer->has_byte_colors)
      put_byte(row, conic_srgb_code(writer->thresholds, value));
    else
      put_float(row, value);
  }
  if (writer->fields & CONIC_SPLATS_OPACITIES)
    put_float(row, batch->opacity[i]);
  if (writer->fields & CONIC_SPLATS_DOTS)
    put_byte(row, batch->dot[i] != 0.0f);
  for (size_t k = 0; k < writer->n_values; k++)
    put_value(row, writer->value_types[k], writer->columns[k] ? writer->columns[k][i] : (double)NAN);
  if (writer->fields & CONIC_SPLATS_CLIPS)
    put_clip(writer, row, batch, i);
  if (row->encoding == CONIC_PLY_ASCII)
    row->next[-1] = '\n';
}

static conic_status append_rows(conic_splats_writer *writer, const conic_splats *batch) {
  FILE *to = conic_output_stream(writer->output);
  if (batch->count > writer->count - writer->written)
    return conic_fail(writer->context, CONIC_ERROR_ARGUMENT, "%s: more splats than the %zu announced", writer->path,
                      writer->count);
  if (writer->fields & ~conic_splats_fields(batch))
    return conic_fail(writer->context, CONIC_ERROR_ARGUMENT, "%s: a batch lacks arrays that were announced",
                      writer->path);
  if (!writer->has_header && batch->count > 0) {
    if (begin_values(writer, batch->values) != CONIC_OK)
      return CONIC_ERROR_MEMORY;
    begin_rows(writer, batch);
  }
  find_columns(writer, batch->values);
  writer->next_clip = 0;
  for (size_t first = 0; first < batch->count; first += BLOCK) {
    size_t n = batch->count - first < BLOCK ? batch->count - first : BLOCK;
    row_cursor row = {.next = writer->rows, .encoding = writer->options.encoding};
    for (size_t i = 0; i < n; i++)
      put_row(writer, &row, batch, first + i);
    size_t n_bytes = (size_t)(row.next - writer->rows);
    if (fwrite(writer->rows, 1, n_bytes, to) != n_bytes)
      return conic_fail(writer->context, CONIC_ERROR_IO, "%s: cannot write: %s", writer->path, strerror(errno));
  }
  writer->written += batch->count;
  return CONIC_OK;
}

conic_status conic_splats_writer_append(conic_splats_writer *writer, const conic_splats *batch) {
  conic_splats close;
  float *block;
  conic_status status = conic_splats_enter(writer->context, writer->path, batch, &close, &block);
  if (status == CONIC_OK)
    status = append_rows(writer, &close);
  conic_memory_release(writer->context, block);
  return status;
}

conic_status conic_splats_writer_finish(conic_splats_writer *writer) {
  conic_status status = CONIC_OK;
  if (writer->written < writer->count)
    status = conic_fail(writer->context, CONIC_ERROR_ARGUMENT, "%s: %zu splats were announced, but %zu written",
                        writer->path, writer->count, writer->written);
  else if (!writer->has_header)
    begin_rows(writer, NULL);
  status = conic_output_end(writer->output, status);
  writer->output = NULL;
  conic_splats_writer_abandon(writer);
  return status;
}

conic_status conic_splats_write(conic_context *context, const char *path, const conic_splats *splats,
                                const conic_write_options *options) {
  conic_splats_writer *writer;
  conic_status status = conic_splats_check(context, path, splats);
  if (status == CONIC_OK)
    status = conic_splats_writer_open(context, path, splats->count, conic_splats_fields(splats), options, &writer);
  if (status != CONIC_OK)
    return status;
  status = conic_splats_writer_append(writer, splats);
  if (status != CONIC_OK) {
    conic_splats_writer_abandon(writer);
    return status;
  }
  return conic_splats_writer_finish(writer);
}
