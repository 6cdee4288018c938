#include "core/formats/readers.h"

#include "core/formats/file_kinds.h"
#include "core/formats/text_columns.h"
#include "core/splats/point_fields.h"

/* --- the heading --- */

typedef enum xyz_names {
  XYZ_UNNAMED,
  XYZ_IN_COMMENT, /* a comment that may name columns */
  XYZ_IN_HEADER,
  XYZ_BY_CALLER
} xyz_names;

typedef struct xyz_heading {
  int has_count; /* the file tells its number of points */
  uint64_t n_declared, count_line;
  xyz_names names; /* where the columns' names come from; all unnamed ones must be numbers */
  unsigned marks;  /* separators of the names: of conic_text_mark */
  conic_text_columns columns;
  conic_text_dialect dialect;
} xyz_heading;

enum { N_STUDIED = 256 };

/* The lines of the first points. */
typedef struct studied_rows {
  conic_text_word lines[N_STUDIED];
  size_t n;
} studied_rows;

static conic_text_word trim(conic_text_word line) {
  while (line.length && strchr(" \t\r\v\f", line.text[0]) && line.text[0])
    line = (conic_text_word){line.text + 1, line.length - 1};
  while (line.length && strchr(" \t\r\v\f", line.text[line.length - 1]) && line.text[line.length - 1])
    line.length--;
  return line;
}

/* Whether the line is empty, or begins with #, % or //. */
static int xyz_is_comment(conic_text_word line) {
  line = trim(line);
  return line.length == 0 || line.text[0] == '#' || line.text[0] == '%' ||
         (line.length >= 2 && line.text[0] == '/' && line.text[1] == '/');
}

/* Whether the line names columns, x, y and z among them; fills in the columns and the marks. */
static int xyz_names_columns(conic_text_word line, xyz_heading *heading) {
  conic_text_dialect dialect;
  conic_text_columns columns;
  conic_text_word names[CONIC_TEXT_MOST_COLUMNS];
  int is_open;
  line = trim(line);
  while (line.length && strchr("#/%", line.text[0]) && line.text[0])
    line = (conic_text_word){line.text + 1, line.length - 1};
  int is_parted = memchr(line.text, ',', line.length) || memchr(line.text, ';', line.length);
  int is_tabbed = !is_parted && memchr(trim(line).text, '\t', trim(line).length) != NULL;
  unsigned marks = is_parted ? 0u : is_tabbed ? (unsigned)CONIC_TEXT_TABS : (unsigned)CONIC_TEXT_BLANKS;
  conic_text_dialect_begin(marks | CONIC_TEXT_COMMAS, &dialect);
  size_t n = conic_text_split(&dialect, line, names, CONIC_TEXT_MOST_COLUMNS, &is_open);
  if (!conic_text_columns_name(names, n, &columns))
    return 0;
  heading->columns = columns;
  heading->marks = marks;
  return 1;
}

static int is_text(conic_text_word line) {
  for (size_t i = 0; i < line.length; i++)
    if ((unsigned char)line.text[i] < 0x20 && !strchr("\t\r\v\f", line.text[i]))
      return 0;
  return 1;
}

/* Takes the only value of a line as a number of points. Errors: INPUT. */
static conic_status xyz_take_count(const conic_input *input, conic_text_word word, xyz_heading *heading) {
  conic_text_dialect dialect;
  double value;
  conic_text_dialect_begin(CONIC_TEXT_BLANKS, &dialect);
  if (!conic_text_number(&dialect, word, &value) || !(value >= 0.0 && value <= (double)CONIC_MAX_POINTS) ||
      value != (double)(uint64_t)value)
    return conic_input_wrong(input, "the number of points is no whole number in range");
  if (!heading->has_count)
    heading->count_line = input->line;
  heading->has_count = 1;
  heading->n_declared += (uint64_t)value;
  return CONIC_OK;
}

/* Two counts are columns and rows; no other kind begins so. */
static conic_status take_first_count(const conic_input *input, conic_text_word word, xyz_heading *heading) {
  if (heading->has_count)
    return conic_input_wrong(input, "two counts begin a PTX scan, but the head of one does not go on after them");
  return xyz_take_count(input, word, heading);
}

/* Whether the caller's columns x, y and z are numbers here; else the line is a header, which the caller's columns
 * replace. */
static int has_callers_position(conic_text_word line, const conic_text_columns *columns) {
  conic_text_dialect any;
  conic_text_word words[CONIC_TEXT_MOST_COLUMNS];
  double value;
  int is_open, n_numbers = 0;
  conic_text_dialect_begin(CONIC_TEXT_BLANKS | CONIC_TEXT_COMMAS, &any);
  size_t n = conic_text_split(&any, line, words, CONIC_TEXT_MOST_COLUMNS, &is_open);
  for (size_t i = 0; i < n && i < columns->n; i++)
    n_numbers += columns->meaning[i] >= 0 && columns->meaning[i] < CONIC_TEXT_RED && words[i].length > 0 &&
                 conic_text_number(&any, words[i], &value);
  return n_numbers == 3;
}

/* Takes a line before the first point; *is_point if it is that point. */
static conic_status take_line(const conic_input *input, conic_text_word line, xyz_heading *heading, int *is_point) {
  conic_text_dialect any;
  conic_text_word words[2];
  int is_open;
  if (memchr(trim(line).text, '\r', trim(line).length))
    return conic_input_wrong(input, "lines end with a carriage return alone: write them with a line feed");
  if (xyz_is_comment(line)) {
    if (heading->names <= XYZ_IN_COMMENT && xyz_names_columns(line, heading))
      heading->names = XYZ_IN_COMMENT;
    return CONIC_OK;
  }
  conic_text_dialect_begin(CONIC_TEXT_BLANKS | CONIC_TEXT_COMMAS, &any);
  int is_numbers = conic_text_is_numbers(line);
  if (is_numbers && conic_text_split(&any, line, words, 2, &is_open) == 1)
    return take_first_count(input, words[0], heading);
  *is_point = is_numbers || heading->names == XYZ_IN_HEADER;
  if (heading->names == XYZ_BY_CALLER)
    *is_point = is_numbers || has_callers_position(line, &heading->columns);
  if (*is_point || heading->names == XYZ_BY_CALLER)
    return CONIC_OK;
  if (!is_text(line))
    return conic_input_wrong(input, "this is no text, nor any other kind that is known; %s", conic_readable_kinds);
  if (!xyz_names_columns(line, heading))
    return conic_input_wrong(input,
                             "neither numbers nor names of columns, as x, y and z are (--columns gives names); "
                             "%s",
                             conic_readable_kinds);
  heading->names = XYZ_IN_HEADER;
  return CONIC_OK;
}

/* Takes the lines from here on that are wholly in the window, without comments and counts. */
static void study(const conic_input *input, studied_rows *rows) {
  const char *c = (const char *)conic_input_bytes(input), *end = c + conic_input_available(input);
  for (rows->n = 0; rows->n < N_STUDIED && c < end;) {
    const char *line_end = memchr(c, '\n', (size_t)(end - c));
    if (!line_end && !input->is_at_end)
      break;
    conic_text_word line = {c, (size_t)((line_end ? line_end : end) - c)};
    if (!xyz_is_comment(line))
      rows->lines[rows->n++] = line;
    c = line_end ? line_end + 1 : end;
  }
}

/* The values of a line; a missing last value counts, where it makes as many as there are columns. */
static size_t xyz_split(const xyz_heading *heading, conic_text_word line, conic_text_word *words) {
  int is_open;
  size_t n = conic_text_split(&heading->dialect, line, words, CONIC_TEXT_MOST_COLUMNS, &is_open);
  if (is_open && n + 1 == heading->columns.n)
    words[n++] = (conic_text_word){line.text + line.length, 0};
  return n;
}

static conic_status find_dialect(const conic_input *input, const studied_rows *rows, xyz_heading *heading) {
  conic_text_word words[CONIC_TEXT_MOST_COLUMNS];
  unsigned marks = heading->names == XYZ_IN_HEADER ? heading->marks : (unsigned)CONIC_TEXT_BLANKS;
  const char *why = conic_text_dialect_find(rows->lines, rows->n, marks, &heading->dialect);
  /* blanks may separate the values although the header has other marks */
  if (!why && !(marks & CONIC_TEXT_BLANKS) && rows->n && xyz_split(heading, rows->lines[0], words) == 1)
    why = conic_text_dialect_find(rows->lines, rows->n, CONIC_TEXT_BLANKS, &heading->dialect);
  return why ? conic_input_wrong(input, "%s", why) : CONIC_OK;
}

/* Names in a comment count if there are as many as values, or if they are fewer and say more than "x y z", which needs
 * no saying. */
static int holds_comment(const conic_text_columns *columns, size_t n) {
  int is_plain = columns->n >= 3 && columns->meaning[0] == 0 && columns->meaning[1] == 1 && columns->meaning[2] == 2;
  return columns->n == n || (columns->n < n && !is_plain);
}

static void guess(const studied_rows *rows, size_t n, xyz_heading *heading) {
  double values[N_STUDIED][CONIC_TEXT_MOST_GUESSED];
  conic_text_word words[CONIC_TEXT_MOST_COLUMNS];
  size_t n_rows = 0;
  memset(values, 0, sizeof values);
  heading->columns.n = n;
  for (size_t i = 0; i < rows->n; i++) {
    if (xyz_split(heading, rows->lines[i], words) != n)
      continue;
    for (size_t k = 0; k < n && k < CONIC_TEXT_MOST_GUESSED; k++)
      conic_text_number(&heading->dialect, words[k], &values[n_rows][k]);
    n_rows++;
  }
  conic_text_columns_guess((const double(*)[CONIC_TEXT_MOST_GUESSED])values, n_rows, n, &heading->columns);
  heading->names = XYZ_UNNAMED;
}

/* Logs the meanings that unnamed columns were given. */
static void xyz_tell_columns(const conic_input *input, const xyz_heading *heading) {
  char list[256] = "";
  conic_text_columns_list(&heading->columns, list, sizeof list);
  if (heading->names == XYZ_UNNAMED && heading->columns.n > 3)
    conic_log(input->context, heading->columns.is_doubtful ? CONIC_LOG_WARNING : CONIC_LOG_INFO,
              "%s: the columns are taken for %s; --columns says otherwise", input->name, list);
}

static conic_status find_named_columns(const conic_input *input, const studied_rows *rows, xyz_heading *heading) {
  conic_text_word words[CONIC_TEXT_MOST_COLUMNS];
  conic_text_columns *columns = &heading->columns;
  size_t n = 0, n_named = heading->names == XYZ_UNNAMED ? 0 : columns->n;
  int is_named = 0;
  for (size_t i = rows->n; i-- > 0;) { /* back to the first line */
    n = xyz_split(heading, rows->lines[i], words);
    is_named |= n == n_named;
  }
  if (heading->names == XYZ_IN_HEADER && !is_named)
    return conic_input_wrong(input, "a line has %zu values, where the header names %zu columns", n, n_named);
  if (heading->names == XYZ_BY_CALLER && n < n_named)
    return conic_input_wrong(input, "a line has %zu values, where --columns names %zu", n, n_named);
  if (n < 3)
    return conic_input_wrong(input, "a line has %zu values; a point has 3 or more", n);
  if (heading->names == XYZ_UNNAMED || (heading->names == XYZ_IN_COMMENT && !holds_comment(columns, n)))
    guess(rows, n, heading);
  for (; heading->names != XYZ_IN_HEADER && columns->n < n; columns->n++) {
    columns->meaning[columns->n] = CONIC_TEXT_SCALAR;
    memcpy(columns->name[columns->n], "-", 2);
  }
  return CONIC_OK;
}

/* Reads up to the first point's line, which is not taken, and finds the dialect and the columns. *has_points: there is
 * a point. `columns` are the caller's, or null. Errors: ARGUMENT, INPUT, CANCELLED. */
static conic_status xyz_heading_read(conic_input *input, const char *columns, xyz_heading *heading, int *has_points) {
  studied_rows rows;
  int is_done = 0;
  memset(heading, 0, sizeof *heading);
  *has_points = 0;
  const char *why = columns ? conic_text_columns_parse(columns, &heading->columns) : NULL;
  conic_status status =
      why ? conic_fail(input->context, CONIC_ERROR_ARGUMENT, "%s: the columns '%s': %s", input->name, columns, why)
          : CONIC_OK;
  heading->names = columns ? XYZ_BY_CALLER : XYZ_UNNAMED;
  while (status == CONIC_OK && !is_done) {
    conic_text_word line;
    status = conic_input_line(input, &line.text, &line.length);
    if (status == CONIC_OK)
      status = take_line(input, line, heading, has_points);
    if (status != CONIC_OK || *has_points)
      break;
    status = conic_input_next_line(input, &is_done);
  }
  if (status != CONIC_OK || !*has_points)
    return status;
  study(input, &rows);
  status = find_dialect(input, &rows, heading);
  return status == CONIC_OK ? find_named_columns(input, &rows, heading) : status;
}

/* --- points --- */

typedef struct xyz_reader {
  conic_input *input;
  conic_builder builder;
  xyz_heading heading;
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
  if (reader->heading.names != XYZ_IN_HEADER)
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
  size_t n = xyz_split(&reader->heading, line, words);
  if (is_next_count(reader, n))
    return xyz_take_count(reader->input, words[0], &reader->heading);
  if (n != columns->n)
    return take_odd_line(reader, n);
  for (size_t i = 0; i < n; i++) {
    int meaning = columns->meaning[i];
    double value;
    int may_be_anything = meaning < 0 && reader->heading.names != XYZ_UNNAMED;
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
    if (status == CONIC_OK && !xyz_is_comment(line))
      status = read_row(reader, line);
    if (status == CONIC_OK)
      status = conic_input_next_line(reader->input, &is_done);
  }
  return status;
}

static conic_status check_counts(const xyz_reader *reader, int is_again) {
  const xyz_heading *heading = &reader->heading;
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
    status = xyz_heading_read(input, options->columns, &reader.heading, &has_points);
  if (status == CONIC_OK && has_points && !is_again)
    xyz_tell_columns(input, &reader.heading);
  if (status == CONIC_OK && has_points)
    status = choose_field(&reader, options);
  if (status == CONIC_OK && has_points)
    status = read_rows(&reader);
  if (status == CONIC_OK)
    status = check_counts(&reader, is_again);
  if (status == CONIC_OK && !delivery)
    status = conic_raw_colors_decode(input->context, &model->points, conic_raw_kind_of(options->colors_are),
                                     &model->colors_are);
  return status == CONIC_OK ? conic_builder_deliver(&reader.builder, 1) : status;
}

int conic_xyz_is_likely(const char *bytes, size_t n) {
  xyz_heading heading;
  int has_names = 0;
  for (const char *c = bytes, *end = bytes + n; c < end;) {
    const char *line_end = memchr(c, '\n', (size_t)(end - c));
    conic_text_word line = {c, (size_t)((line_end ? line_end : end) - c)};
    if (!xyz_is_comment(line)) {
      if (has_names || conic_text_is_numbers(line))
        return conic_text_is_numbers(line);
      if (!xyz_names_columns(line, &heading))
        return 0;
      has_names = 1;
    }
    c = line_end ? line_end + 1 : end;
  }
  return 0;
}
