#include "core/formats/readers.h"

#include "core/files/number.h"
#include "core/scans/sight.h"
#include "core/splats/point_fields.h"

/* Lines before the points: columns, rows, the scanner's place, its three axes, and the rows of a matrix that multiplies
 * points from the right. */
enum { HEAD_LINES = 10, MOST_VALUES = 7 };

static const size_t values_in_head[HEAD_LINES] = {1, 1, 3, 3, 3, 3, 4, 4, 4, 4};

typedef struct ptx_reader {
  conic_input *input;
  conic_builder builder;
  double head[HEAD_LINES][4];
  size_t n_values; /* of a point: 4, or 7 with a colour; 0: not known yet */
} ptx_reader;

/* The numbers of a line, separated by blanks; MOST_VALUES + 1 where there are more, or a word is no number. */
static size_t split_numbers(const char *text, size_t length, double values[MOST_VALUES]) {
  size_t n = 0;
  for (const char *end = text + length; text < end;) {
    if (*text == ' ' || *text == '\t' || *text == '\r') {
      text++;
      continue;
    }
    double value;
    size_t used = conic_number_parse(text, (size_t)(end - text), &value);
    if (used == 0 || n == MOST_VALUES)
      return MOST_VALUES + 1;
    values[n++] = value;
    text += used;
  }
  return n;
}

int conic_ptx_is_likely(const char *bytes, size_t n) {
  const char *end = bytes + n;
  for (int i = 0; i < HEAD_LINES; i++) {
    double values[MOST_VALUES];
    const char *line_end = bytes < end ? memchr(bytes, '\n', (size_t)(end - bytes)) : NULL;
    if (!line_end || split_numbers(bytes, (size_t)(line_end - bytes), values) != values_in_head[i])
      return 0;
    bytes = line_end + 1;
  }
  return 1;
}

/* The next line that is not empty; *n is 0 where the file ends. */
static conic_status next_numbers(ptx_reader *reader, double values[MOST_VALUES], size_t *n, int *is_done) {
  conic_status status = CONIC_OK;
  *n = 0;
  while (status == CONIC_OK && *n == 0 && !*is_done) {
    const char *text;
    size_t length;
    status = conic_input_line(reader->input, &text, &length);
    if (status == CONIC_OK)
      *n = split_numbers(text, length, values);
    if (status == CONIC_OK && *n > MOST_VALUES)
      return conic_input_wrong(reader->input, "a value is not a number, or there are more than a PTX has");
    if (status == CONIC_OK && *n == 0)
      status = conic_input_next_line(reader->input, is_done);
  }
  return status;
}

/* *has_scan is 0 where the file ends without another scan. */
static conic_status read_head(ptx_reader *reader, int *has_scan, int *is_done) {
  for (int i = 0; i < HEAD_LINES; i++) {
    double values[MOST_VALUES];
    size_t n;
    conic_status status = next_numbers(reader, values, &n, is_done);
    if (status != CONIC_OK)
      return status;
    *has_scan = n > 0 || i > 0;
    if (!*has_scan)
      return CONIC_OK;
    if (n != values_in_head[i])
      return conic_input_wrong(reader->input, "a scan's head has other numbers here than a PTX has");
    for (size_t k = 0; k < n; k++) {
      if (!conic_is_finite(values[k]))
        return conic_input_wrong(reader->input, "a scan's head has a number that is not finite");
      reader->head[i][k] = values[k];
    }
    status = conic_input_next_line(reader->input, is_done);
    if (status != CONIC_OK)
      return status;
  }
  for (int i = 0; i < 2; i++)
    if (!(reader->head[i][0] >= 0.0 && reader->head[i][0] <= (double)CONIC_MAX_POINTS) ||
        reader->head[i][0] != floor(reader->head[i][0]))
      return conic_input_wrong(reader->input, "the columns or rows of a scan are no whole number");
  return CONIC_OK;
}

/* Whether a place of the grid holds no point: no light came back. */
static int is_empty_place(const double values[MOST_VALUES]) {
  return values[0] == 0.0 && values[1] == 0.0 && values[2] == 0.0;
}

static void store_values(ptx_reader *reader, const double values[MOST_VALUES]) {
  conic_splats *points = &reader->builder.model->points;
  double(*matrix)[4] = reader->head + 6, *scanner = reader->head[HEAD_LINES - 1], place[3], sight[3];
  for (int axis = 0; axis < 3; axis++)
    place[axis] =
        values[0] * matrix[0][axis] + values[1] * matrix[1][axis] + values[2] * matrix[2][axis] + scanner[axis];
  conic_builder_store_position(&reader->builder, place);
  conic_sight_find(scanner, place, sight);
  for (int axis = 0; axis < 3; axis++) {
    points->sight[axis][points->count] = (float)sight[axis];
    if (points->color[axis])
      points->color[axis][points->count] = reader->n_values == MOST_VALUES ? (float)values[4 + axis] : 255.0f;
  }
  for (size_t k = 0; k < conic_builder_columns(&reader->builder); k++)
    if (conic_builder_column_field(&reader->builder, k) >= 0) /* it is a field */
      *conic_builder_column(&reader->builder, k) = values[3];
  points->count++;
}

/* The file's first point tells whether there are colours. */
static conic_status take_layout(ptx_reader *reader, size_t n) {
  int is_first = reader->n_values == 0;
  if (n != 4 && n != MOST_VALUES)
    return conic_input_wrong(reader->input,
                             "a point has %zu values; x y z intensity, or x y z intensity r g b, are read", n);
  reader->n_values = n;
  return is_first && n == MOST_VALUES ? conic_builder_add_field(&reader->builder, CONIC_SPLATS_COLORS) : CONIC_OK;
}

static conic_status take_place(ptx_reader *reader, const double values[MOST_VALUES], size_t n) {
  conic_status status = n == reader->n_values ? CONIC_OK : take_layout(reader, n);
  if (status != CONIC_OK)
    return status;
  if (is_empty_place(values)) {
    reader->builder.model->n_unmeasured++;
    return CONIC_OK;
  }
  if (conic_builder_points(&reader->builder) >= CONIC_MAX_POINTS)
    return conic_input_wrong(reader->input, "too many points");
  status = conic_builder_reserve_points(&reader->builder, reader->builder.model->points.count + 1);
  if (status != CONIC_OK)
    return status;
  store_values(reader, values);
  return conic_builder_deliver(&reader->builder, 0);
}

static conic_status tell_cut(const ptx_reader *reader, uint64_t n_missing) {
  if (conic_builder_points(&reader->builder) == 0)
    return conic_input_wrong(reader->input, "the file ends before all places of a scan's grid");
  conic_log(reader->input->context, CONIC_LOG_WARNING,
            "%s: the file ends before the last %llu places of a scan's grid; what is before is read (line %llu)",
            reader->input->name, (unsigned long long)n_missing, (unsigned long long)reader->input->line);
  return CONIC_OK;
}

static conic_status read_places(ptx_reader *reader, int *is_done) {
  uint64_t n_places = (uint64_t)(reader->head[0][0] * reader->head[1][0]);
  conic_status status = CONIC_OK;
  double values[MOST_VALUES] = {0.0};
  for (uint64_t i = 0; i < n_places && status == CONIC_OK; i++) {
    size_t n;
    status = next_numbers(reader, values, &n, is_done);
    if (status == CONIC_OK && n == 0)
      return tell_cut(reader, n_places - i);
    if (status == CONIC_OK)
      status = take_place(reader, values, n);
    if (status == CONIC_OK)
      status = conic_input_next_line(reader->input, is_done);
  }
  return status;
}

static conic_status read_ptx_scans(ptx_reader *reader) {
  conic_status status = CONIC_OK;
  int has_scan = 1, is_done = 0;
  while (status == CONIC_OK && has_scan) {
    status = read_head(reader, &has_scan, &is_done);
    if (status == CONIC_OK && has_scan)
      status = read_places(reader, &is_done);
  }
  return status;
}

conic_status conic_ptx_read(conic_input *input, const conic_read_options *options, const conic_delivery *delivery,
                            conic_model *model) {
  ptx_reader reader = {.input = input};
  conic_status status = conic_builder_begin(input->context, model, CONIC_SPLATS_SIGHTS, delivery, &reader.builder);
  if (status == CONIC_OK)
    status = conic_fields_add(&reader.builder, "intensity", strlen("intensity"), "text");
  if (status == CONIC_OK)
    status = conic_fields_choose(&reader.builder, input->name, options);
  if (status == CONIC_OK)
    status = read_ptx_scans(&reader);
  if (status == CONIC_OK && !delivery)
    status = conic_raw_colors_decode(input->context, &model->points, 0, &model->colors_are);
  return status == CONIC_OK ? conic_builder_deliver(&reader.builder, 1) : status;
}
