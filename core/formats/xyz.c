#include "core/formats/xyz.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/base/message.h"
#include "core/formats/xyz_heading.h"
#include "core/splats/point_fields.h"
#include "core/splats/raw_colors.h"

typedef struct xyz_reader {
  conic_input *input;
  conic_builder builder;
  conic_xyz_heading heading;
  int is_origin_set;
  unsigned char is_asked[CONIC_TEXT_MOST_COLUMNS]; /* columns that are read */
  uint64_t n_odd, odd_line; /* lines with another number of values than the header has, and the first of them */
} xyz_reader;

static void find_origin(xyz_reader *reader, const double *p) {
  if (reader->is_origin_set || !(p[0] - p[0] == 0.0 && p[1] - p[1] == 0.0 && p[2] - p[2] == 0.0))
    return;
  memcpy(reader->builder.model->points.origin, p, 3 * sizeof *p);
  reader->is_origin_set = 1;
}

static conic_status append_point(xyz_reader *reader, const double values[CONIC_TEXT_N_MEANINGS],
                                 const double numbers[CONIC_TEXT_MOST_COLUMNS]) {
  conic_splats *points = &reader->builder.model->points;
  if (conic_builder_points(&reader->builder) >= CONIC_MAX_POINTS)
    return conic_input_wrong(reader->input, "too many points");
  conic_status status = conic_builder_reserve_points(&reader->builder, points->count + 1);
  if (status != CONIC_OK)
    return status;
  find_origin(reader, values);
  for (int axis = 0; axis < 3; axis++) {
    points->position[axis][points->count] = (float)(values[axis] - points->origin[axis]);
    if (points->color[axis])
      points->color[axis][points->count] = (float)values[CONIC_TEXT_RED + axis];
    if (points->normal[axis])
      points->normal[axis][points->count] = (float)values[CONIC_TEXT_NORMAL + axis];
  }
  for (size_t k = 0; k < conic_builder_columns(&reader->builder); k++) {
    int field = conic_builder_column_field(&reader->builder, k);
    if (field >= 0)
      *conic_builder_column(&reader->builder, k) = numbers[field];
  }
  points->count++;
  return conic_builder_deliver(&reader->builder, 0);
}

/* A file may hold several clouds, each after its number of points. */
static int is_next_count(const xyz_reader *reader, size_t n) {
  return n == 1 && reader->heading.has_count && conic_builder_points(&reader->builder) == reader->heading.n_declared;
}

static conic_status take_odd_line(xyz_reader *reader, size_t n) {
  size_t n_columns = reader->heading.columns.n;
  if (reader->heading.names != CONIC_XYZ_IN_HEADER)
    return conic_input_wrong(reader->input, "a line has %zu values, those before it have %zu", n, n_columns);
  if (reader->n_odd++ == 0)
    reader->odd_line = reader->input->line;
  return CONIC_OK;
}

/* Named columns without a meaning may hold anything. */
static conic_status read_row(xyz_reader *reader, conic_text_word line) {
  const conic_text_columns *columns = &reader->heading.columns;
  conic_text_word words[CONIC_TEXT_MOST_COLUMNS];
  double values[CONIC_TEXT_N_MEANINGS] = {0.0}, numbers[CONIC_TEXT_MOST_COLUMNS];
  size_t n = conic_xyz_split(&reader->heading, line, words);
  if (is_next_count(reader, n))
    return conic_xyz_take_count(reader->input, words[0], &reader->heading);
  if (n != columns->n)
    return take_odd_line(reader, n);
  for (size_t i = 0; i < n; i++) {
    int meaning = columns->meaning[i];
    double value;
    int may_be_anything = meaning < 0 && reader->heading.names != CONIC_XYZ_UNNAMED;
    numbers[i] = NAN;
    if (may_be_anything && !reader->is_asked[i])
      continue;
    if (!conic_text_number(&reader->heading.dialect, words[i], &value)) {
      if (may_be_anything)
        continue;
      return conic_input_wrong(reader->input, "a value is not a number");
    }
    if (meaning >= 0)
      values[meaning] = value;
    numbers[i] = value;
  }
  return append_point(reader, values, numbers);
}

/* Every column is a field; one without a name is called by its number, from 1. */
static conic_status choose_field(xyz_reader *reader, const conic_read_options *options) {
  const conic_text_columns *columns = &reader->heading.columns;
  conic_status status = CONIC_OK;
  for (size_t i = 0; i < columns->n && status == CONIC_OK; i++) {
    char number[24];
    const char *name = columns->name[i];
    snprintf(number, sizeof number, "%zu", i + 1);
    if (strcmp(name, "-") == 0)
      name = number;
    status = conic_fields_add(&reader->builder, name, strlen(name), "text");
  }
  if (status == CONIC_OK)
    status = conic_fields_choose(&reader->builder, reader->input->name, options);
  for (size_t k = 0; k < conic_builder_columns(&reader->builder); k++)
    if (conic_builder_column_field(&reader->builder, k) >= 0)
      reader->is_asked[conic_builder_column_field(&reader->builder, k)] = 1;
  return status;
}

static conic_status read_rows(xyz_reader *reader) {
  conic_status status = CONIC_OK;
  if (reader->heading.columns.has_colors)
    status = conic_builder_add_field(&reader->builder, CONIC_SPLATS_COLORS);
  if (status == CONIC_OK && reader->heading.columns.has_normals)
    status = conic_builder_add_field(&reader->builder, CONIC_SPLATS_NORMALS);
  for (int is_done = 0; status == CONIC_OK && !is_done;) {
    conic_text_word line;
    status = conic_input_line(reader->input, &line.text, &line.length);
    if (status == CONIC_OK && !conic_xyz_is_comment(line))
      status = read_row(reader, line);
    if (status == CONIC_OK)
      status = conic_input_next_line(reader->input, &is_done);
  }
  return status;
}

static conic_status check_counts(const xyz_reader *reader, int is_again) {
  const conic_xyz_heading *heading = &reader->heading;
  conic_context *context = reader->input->context;
  uint64_t count = conic_builder_points(&reader->builder);
  if (count == 0 && !(heading->has_count && heading->n_declared == 0))
    return conic_input_wrong(reader->input, "the file ends without a point");
  if (reader->n_odd > count)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: most lines have other values than the header's %zu (line %llu)",
                      reader->input->name, heading->columns.n, (unsigned long long)reader->odd_line);
  if (reader->n_odd && !is_again)
    conic_log(context, CONIC_LOG_WARNING,
              "%s: passed over: %llu lines with other values than the header's %zu "
              "(the first is line %llu)",
              reader->input->name, (unsigned long long)reader->n_odd, heading->columns.n,
              (unsigned long long)reader->odd_line);
  if (heading->has_count && count != heading->n_declared && !is_again)
    conic_log(context, CONIC_LOG_WARNING, "%s: line %llu declares %llu points; the %llu that are there are read",
              reader->input->name, (unsigned long long)heading->count_line, (unsigned long long)heading->n_declared,
              (unsigned long long)count);
  return CONIC_OK;
}

conic_status conic_xyz_read(conic_input *input, const conic_read_options *options, const conic_delivery *delivery,
                            conic_model *model) {
  xyz_reader reader = {.input = input};
  int has_points, is_again = delivery && delivery->is_again;
  conic_status status = conic_builder_begin(input->context, model, 0, delivery, &reader.builder);
  if (status == CONIC_OK)
    status = conic_xyz_heading_read(input, options->columns, &reader.heading, &has_points);
  if (status == CONIC_OK && has_points && !is_again)
    conic_xyz_tell_columns(input, &reader.heading);
  if (status == CONIC_OK && has_points)
    status = choose_field(&reader, options);
  if (status == CONIC_OK && has_points)
    status = read_rows(&reader);
  if (status == CONIC_OK)
    status = check_counts(&reader, is_again);
  if (status == CONIC_OK && !delivery)
    status = conic_raw_colors_decode(input->context, &model->points, 1);
  return status == CONIC_OK ? conic_builder_deliver(&reader.builder, 1) : status;
}

int conic_xyz_is_likely(const char *bytes, size_t n) {
  conic_xyz_heading heading;
  int has_names = 0;
  for (const char *c = bytes, *end = bytes + n; c < end;) {
    const char *line_end = memchr(c, '\n', (size_t)(end - c));
    conic_text_word line = {c, (size_t)((line_end ? line_end : end) - c)};
    if (!conic_xyz_is_comment(line)) {
      if (has_names || conic_text_is_numbers(line))
        return conic_text_is_numbers(line);
      if (!conic_xyz_names_columns(line, &heading))
        return 0;
      has_names = 1;
    }
    c = line_end ? line_end + 1 : end;
  }
  return 0;
}
