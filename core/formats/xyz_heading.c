#include "core/formats/xyz_heading.h"

#include <string.h>

#include "core/base/message.h"
#include "core/formats/file_kinds.h"
#include "core/splats/builder.h"

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

int conic_xyz_is_comment(conic_text_word line) {
  line = trim(line);
  return line.length == 0 || line.text[0] == '#' || line.text[0] == '%' ||
         (line.length >= 2 && line.text[0] == '/' && line.text[1] == '/');
}

int conic_xyz_names_columns(conic_text_word line, conic_xyz_heading *heading) {
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

conic_status conic_xyz_take_count(const conic_input *input, conic_text_word word, conic_xyz_heading *heading) {
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
static conic_status take_first_count(const conic_input *input, conic_text_word word, conic_xyz_heading *heading) {
  if (heading->has_count)
    return conic_input_wrong(input, "two counts begin a PTX scan, but the head of one does not go on after them");
  return conic_xyz_take_count(input, word, heading);
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
static conic_status take_line(const conic_input *input, conic_text_word line, conic_xyz_heading *heading,
                              int *is_point) {
  conic_text_dialect any;
  conic_text_word words[2];
  int is_open;
  if (memchr(trim(line).text, '\r', trim(line).length))
    return conic_input_wrong(input, "lines end with a carriage return alone: write them with a line feed");
  if (conic_xyz_is_comment(line)) {
    if (heading->names <= CONIC_XYZ_IN_COMMENT && conic_xyz_names_columns(line, heading))
      heading->names = CONIC_XYZ_IN_COMMENT;
    return CONIC_OK;
  }
  conic_text_dialect_begin(CONIC_TEXT_BLANKS | CONIC_TEXT_COMMAS, &any);
  int is_numbers = conic_text_is_numbers(line);
  if (is_numbers && conic_text_split(&any, line, words, 2, &is_open) == 1)
    return take_first_count(input, words[0], heading);
  *is_point = is_numbers || heading->names == CONIC_XYZ_IN_HEADER;
  if (heading->names == CONIC_XYZ_BY_CALLER)
    *is_point = is_numbers || has_callers_position(line, &heading->columns);
  if (*is_point || heading->names == CONIC_XYZ_BY_CALLER)
    return CONIC_OK;
  if (!is_text(line))
    return conic_input_wrong(input, "this is no text, nor any other kind that is known; %s", conic_readable_kinds);
  if (!conic_xyz_names_columns(line, heading))
    return conic_input_wrong(input,
                             "neither numbers nor names of columns, as x, y and z are (--columns gives names); "
                             "%s",
                             conic_readable_kinds);
  heading->names = CONIC_XYZ_IN_HEADER;
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
    if (!conic_xyz_is_comment(line))
      rows->lines[rows->n++] = line;
    c = line_end ? line_end + 1 : end;
  }
}

size_t conic_xyz_split(const conic_xyz_heading *heading, conic_text_word line, conic_text_word *words) {
  int is_open;
  size_t n = conic_text_split(&heading->dialect, line, words, CONIC_TEXT_MOST_COLUMNS, &is_open);
  if (is_open && n + 1 == heading->columns.n)
    words[n++] = (conic_text_word){line.text + line.length, 0};
  return n;
}

static conic_status find_dialect(const conic_input *input, const studied_rows *rows, conic_xyz_heading *heading) {
  conic_text_word words[CONIC_TEXT_MOST_COLUMNS];
  unsigned marks = heading->names == CONIC_XYZ_IN_HEADER ? heading->marks : (unsigned)CONIC_TEXT_BLANKS;
  const char *why = conic_text_dialect_find(rows->lines, rows->n, marks, &heading->dialect);
  /* blanks may separate the values although the header has other marks */
  if (!why && !(marks & CONIC_TEXT_BLANKS) && rows->n && conic_xyz_split(heading, rows->lines[0], words) == 1)
    why = conic_text_dialect_find(rows->lines, rows->n, CONIC_TEXT_BLANKS, &heading->dialect);
  return why ? conic_input_wrong(input, "%s", why) : CONIC_OK;
}

/* Names in a comment count if there are as many as values, or if they are fewer and say more than "x y z", which needs
 * no saying. */
static int holds_comment(const conic_text_columns *columns, size_t n) {
  int is_plain = columns->n >= 3 && columns->meaning[0] == 0 && columns->meaning[1] == 1 && columns->meaning[2] == 2;
  return columns->n == n || (columns->n < n && !is_plain);
}

static void guess(const studied_rows *rows, size_t n, conic_xyz_heading *heading) {
  double values[N_STUDIED][CONIC_TEXT_MOST_GUESSED];
  conic_text_word words[CONIC_TEXT_MOST_COLUMNS];
  size_t n_rows = 0;
  memset(values, 0, sizeof values);
  heading->columns.n = n;
  for (size_t i = 0; i < rows->n; i++) {
    if (conic_xyz_split(heading, rows->lines[i], words) != n)
      continue;
    for (size_t k = 0; k < n && k < CONIC_TEXT_MOST_GUESSED; k++)
      conic_text_number(&heading->dialect, words[k], &values[n_rows][k]);
    n_rows++;
  }
  conic_text_columns_guess((const double(*)[CONIC_TEXT_MOST_GUESSED])values, n_rows, n, &heading->columns);
  heading->names = CONIC_XYZ_UNNAMED;
}

void conic_xyz_tell_columns(const conic_input *input, const conic_xyz_heading *heading) {
  char list[256] = "";
  conic_text_columns_list(&heading->columns, list, sizeof list);
  if (heading->names == CONIC_XYZ_UNNAMED && heading->columns.n > 3)
    conic_log(input->context, CONIC_LOG_INFO, "%s: the columns are taken for %s; --columns says otherwise", input->name,
              list);
}

static conic_status find_named_columns(const conic_input *input, const studied_rows *rows, conic_xyz_heading *heading) {
  conic_text_word words[CONIC_TEXT_MOST_COLUMNS];
  conic_text_columns *columns = &heading->columns;
  size_t n = 0, n_named = heading->names == CONIC_XYZ_UNNAMED ? 0 : columns->n;
  int is_named = 0;
  for (size_t i = rows->n; i-- > 0;) { /* back to the first line */
    n = conic_xyz_split(heading, rows->lines[i], words);
    is_named |= n == n_named;
  }
  if (heading->names == CONIC_XYZ_IN_HEADER && !is_named)
    return conic_input_wrong(input, "a line has %zu values, where the header names %zu columns", n, n_named);
  if (heading->names == CONIC_XYZ_BY_CALLER && n < n_named)
    return conic_input_wrong(input, "a line has %zu values, where --columns names %zu", n, n_named);
  if (n < 3)
    return conic_input_wrong(input, "a line has %zu values; a point has 3 or more", n);
  if (heading->names == CONIC_XYZ_UNNAMED || (heading->names == CONIC_XYZ_IN_COMMENT && !holds_comment(columns, n)))
    guess(rows, n, heading);
  for (; heading->names != CONIC_XYZ_IN_HEADER && columns->n < n; columns->n++) {
    columns->meaning[columns->n] = CONIC_TEXT_SCALAR;
    memcpy(columns->name[columns->n], "-", 2);
  }
  return CONIC_OK;
}

conic_status conic_xyz_heading_read(conic_input *input, const char *columns, conic_xyz_heading *heading,
                                    int *has_points) {
  studied_rows rows;
  int is_done = 0;
  memset(heading, 0, sizeof *heading);
  *has_points = 0;
  const char *why = columns ? conic_text_columns_parse(columns, &heading->columns) : NULL;
  conic_status status =
      why ? conic_fail(input->context, CONIC_ERROR_ARGUMENT, "%s: the columns '%s': %s", input->name, columns, why)
          : CONIC_OK;
  heading->names = columns ? CONIC_XYZ_BY_CALLER : CONIC_XYZ_UNNAMED;
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
