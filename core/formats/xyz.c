#include "core/formats/xyz.h"

#include <string.h>

#include "core/files/number.h"
#include "core/formats/raw_colors.h"
#include "core/splats/builder.h"

enum { MAX_VALUES = 9, BLOCK = 256 };

typedef struct xyz_reader {
  conic_input *input;
  conic_builder builder;
  int has_count; /* the file says how many points there are */
  uint64_t n_declared, count_line;
  int n_values;      /* a line; 0: none has been read */
  int color, normal; /* the first of three values; 0: there are none */
  int is_origin_set;
  double block[BLOCK][MAX_VALUES];
} xyz_reader;

static int is_comment(const char *word, size_t length) {
  return length == 0 || word[0] == '#' || (length >= 2 && word[0] == '/' && word[1] == '/');
}

/* The values of a line, none where it is empty or a comment; one more than there is room for is wrong. */
static conic_status read_values(xyz_reader *reader, double *values, int *n) {
  for (*n = 0;; ++*n) {
    const char *word;
    size_t length;
    double value;
    conic_status status = conic_input_word(reader->input, &word, &length);
    if (status != CONIC_OK)
      return status;
    if (length == 0 || (*n == 0 && is_comment(word, length)))
      return CONIC_OK;
    if (conic_number_parse(word, length, &value) != length)
      return conic_input_wrong(reader->input, "a value is not a number");
    if (*n == MAX_VALUES)
      return conic_input_wrong(reader->input, "a line has more than 9 values");
    values[*n] = value;
  }
}

/* The first line's lone value. A point takes at least 6 bytes, "0 0 0" and a line's end, which the last may lack. */
static conic_status take_count(xyz_reader *reader, double value) {
  uint64_t remaining = conic_input_remaining_bytes(reader->input);
  if (!(value >= 0.0 && value <= (double)CONIC_MAX_POINTS) || value != (double)(uint64_t)value)
    return conic_input_wrong(reader->input, "the number of points is no whole number in range");
  reader->has_count = 1;
  reader->n_declared = (uint64_t)value;
  reader->count_line = reader->input->line;
  if (remaining < UINT64_MAX && reader->n_declared > (remaining + 1) / 6)
    return conic_input_wrong(reader->input, "the file is too short for the %llu points that it declares",
                             (unsigned long long)reader->n_declared);
  return CONIC_OK;
}

static conic_status check_row(xyz_reader *reader, int n) {
  if (reader->n_values && n != reader->n_values)
    return conic_input_wrong(reader->input, "a line has %d values, those before it have %d", n, reader->n_values);
  if (n < 3 || n == 5 || n == 8)
    return conic_input_wrong(reader->input, "a line has %d values; 3, 4, 6, 7 or 9 are understood", n);
  reader->n_values = n;
  return CONIC_OK;
}

/* Up to BLOCK points into the reader's block. */
static conic_status read_block(xyz_reader *reader, size_t *n_rows, int *is_done) {
  conic_status status = CONIC_OK;
  for (*n_rows = 0; *n_rows < BLOCK && !*is_done && status == CONIC_OK;) {
    int n;
    status = read_values(reader, reader->block[*n_rows], &n);
    if (status == CONIC_OK && n == 1 && !reader->n_values && !reader->has_count)
      status = take_count(reader, reader->block[*n_rows][0]);
    else if (status == CONIC_OK && n > 0) {
      status = check_row(reader, n);
      ++*n_rows;
    }
    if (status == CONIC_OK)
      status = conic_input_next_line(reader->input, is_done);
  }
  return status;
}

static int looks_like_normals(const xyz_reader *reader, int first, size_t n_rows) {
  int n_unit = 0, n_other = 0;
  for (size_t i = 0; i < n_rows; i++) {
    const double *v = reader->block[i] + first;
    double length2 = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    if (v[0] < 0.0 || v[1] < 0.0 || v[2] < 0.0)
      return 1;
    n_unit += length2 > 0.95 * 0.95 && length2 < 1.05 * 1.05;
    n_other += length2 >= 1.05 * 1.05 || (length2 > 0.0 && length2 <= 0.95 * 0.95);
  }
  return n_unit > 0 && n_other == 0;
}

static conic_status choose_columns(xyz_reader *reader, size_t n_rows) {
  conic_status status = CONIC_OK;
  if (reader->n_values == 7)
    reader->color = 4;
  else if (reader->n_values == 6 && looks_like_normals(reader, 3, n_rows))
    reader->normal = 3;
  else if (reader->n_values == 6)
    reader->color = 3;
  else if (reader->n_values == 9) {
    int is_first = looks_like_normals(reader, 3, n_rows) && !looks_like_normals(reader, 6, n_rows);
    reader->normal = is_first ? 3 : 6;
    reader->color = is_first ? 6 : 3;
  }
  if (reader->color)
    status = conic_builder_add_field(&reader->builder, CONIC_SPLATS_COLORS);
  if (status == CONIC_OK && reader->normal)
    status = conic_builder_add_field(&reader->builder, CONIC_SPLATS_NORMALS);
  return status;
}

static void find_origin(xyz_reader *reader, size_t n_rows) {
  for (size_t i = 0; i < n_rows && !reader->is_origin_set; i++) {
    const double *p = reader->block[i];
    if (!(p[0] - p[0] == 0.0 && p[1] - p[1] == 0.0 && p[2] - p[2] == 0.0))
      continue;
    memcpy(reader->builder.model->points.origin, p, 3 * sizeof *p);
    reader->is_origin_set = 1;
  }
}

static void store_row(const xyz_reader *reader, const double *values, size_t i, conic_splats *points) {
  for (int axis = 0; axis < 3; axis++) {
    points->position[axis][i] = (float)(values[axis] - points->origin[axis]);
    if (reader->color)
      points->color[axis][i] = (float)values[reader->color + axis];
    if (reader->normal)
      points->normal[axis][i] = (float)values[reader->normal + axis];
  }
}

static conic_status append_block(xyz_reader *reader, size_t n_rows) {
  conic_splats *points = &reader->builder.model->points;
  conic_status status = CONIC_OK;
  if (conic_builder_points(&reader->builder) + n_rows > CONIC_MAX_POINTS)
    return conic_input_wrong(reader->input, "too many points");
  if (conic_builder_points(&reader->builder) == 0)
    status = choose_columns(reader, n_rows);
  if (status == CONIC_OK)
    status = conic_builder_reserve_points(&reader->builder, points->count + n_rows);
  if (status != CONIC_OK)
    return status;
  find_origin(reader, n_rows);
  for (size_t i = 0; i < n_rows; i++)
    store_row(reader, reader->block[i], points->count + i, points);
  points->count += n_rows;
  return conic_builder_deliver(&reader->builder, 0);
}

static conic_status check_count(const xyz_reader *reader) {
  uint64_t count = conic_builder_points(&reader->builder);
  if (reader->has_count && count != reader->n_declared)
    return conic_input_wrong(reader->input, "%llu points, where line %llu declares %llu", (unsigned long long)count,
                             (unsigned long long)reader->count_line, (unsigned long long)reader->n_declared);
  if (count == 0 && !reader->has_count)
    return conic_input_wrong(reader->input, "the file ends without a point");
  return CONIC_OK;
}

conic_status conic_xyz_read(conic_input *input, const conic_delivery *delivery, conic_model *model) {
  xyz_reader reader = {.input = input};
  int is_done = 0;
  input->has_commas = 1;
  conic_status status = conic_builder_begin(input->context, model, 0, delivery, &reader.builder);
  while (status == CONIC_OK && !is_done) {
    size_t n_rows;
    status = read_block(&reader, &n_rows, &is_done);
    if (status == CONIC_OK && n_rows > 0)
      status = append_block(&reader, n_rows);
  }
  if (status == CONIC_OK)
    status = check_count(&reader);
  if (status == CONIC_OK && !delivery)
    status = conic_raw_colors_decode(input->context, &model->points, 1);
  return status == CONIC_OK ? conic_builder_deliver(&reader.builder, 1) : status;
}

static int is_separator(char c) {
  return c == ' ' || c == '\t' || c == ',' || c == '\r';
}

int conic_xyz_is_likely(const char *bytes, size_t n) {
  const char *c = bytes, *end = bytes + n;
  int n_values = 0;
  while (c < end) {
    double value;
    const char *line_end = memchr(c, '\n', (size_t)(end - c));
    line_end = line_end ? line_end : end;
    while (c < line_end && is_separator(*c))
      c++;
    if (c == line_end && n_values > 0)
      return 1;
    if (n_values == 0 && is_comment(c, (size_t)(line_end - c))) {
      c = line_end + (line_end < end);
      continue;
    }
    size_t length = conic_number_parse(c, (size_t)(line_end - c), &value);
    if (length == 0 || (c + length < line_end && !is_separator(c[length])))
      return 0;
    c += length;
    n_values++;
  }
  return n_values > 0;
}
