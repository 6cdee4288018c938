#include "core/formats/pcd_header.h"

#include <strings.h>

#include "core/files/number.h"
#include "core/splats/builder.h"

typedef struct header_reader {
  conic_input *input;
  conic_pcd_header *header;
  size_t n_sizes, n_types, n_counts;
  int has_points;
} header_reader;

enum { MOST_ROW_BYTES = CONIC_INPUT_WINDOW / 4 };

/* Reads the rest of a line word by word, each with its number; *n is how many there were. */
typedef conic_status word_reader(header_reader *reader, size_t i, const char *word, size_t length);

static conic_status read_words(header_reader *reader, word_reader *read, size_t *n) {
  for (*n = 0;; ++*n) {
    const char *word;
    size_t length;
    conic_status status = conic_input_word(reader->input, &word, &length);
    if (status != CONIC_OK || length == 0)
      return status;
    if (*n == CONIC_TEXT_MOST_COLUMNS)
      return conic_input_wrong(reader->input, "more than %d fields", CONIC_TEXT_MOST_COLUMNS);
    status = read(reader, *n, word, length);
    if (status != CONIC_OK)
      return status;
  }
}

static int parse_whole(const char *word, size_t length, double largest, uint64_t *whole) {
  double value;
  if (conic_number_parse(word, length, &value) != length || !(value >= 0.0 && value <= largest) ||
      value != (double)(uint64_t)value)
    return 0;
  *whole = (uint64_t)value;
  return 1;
}

static conic_status read_size(header_reader *reader, size_t i, const char *word, size_t length) {
  uint64_t size;
  if (!parse_whole(word, length, 8, &size) || (size != 1 && size != 2 && size != 4 && size != 8))
    return conic_input_wrong(reader->input, "a size is neither 1, 2, 4 nor 8");
  reader->header->fields[i].n_bytes = (size_t)size;
  return CONIC_OK;
}

static conic_status read_type(header_reader *reader, size_t i, const char *word, size_t length) {
  if (length != 1 || (word[0] != 'F' && word[0] != 'I' && word[0] != 'U'))
    return conic_input_wrong(reader->input, "a type is neither F, I nor U");
  reader->header->fields[i].letter = word[0];
  return CONIC_OK;
}

static conic_status read_count(header_reader *reader, size_t i, const char *word, size_t length) {
  uint64_t count;
  if (!parse_whole(word, length, MOST_ROW_BYTES, &count))
    return conic_input_wrong(reader->input, "a count is no whole number in range");
  reader->header->fields[i].count = (size_t)count;
  return CONIC_OK;
}

/* All names are needed at once: they are in the input's window, one after the other in the line. */
static conic_status read_names(header_reader *reader) {
  conic_text_word line, names[CONIC_TEXT_MOST_COLUMNS + 1];
  conic_text_dialect blanks;
  int is_open;
  conic_status status = conic_input_line(reader->input, &line.text, &line.length);
  if (status != CONIC_OK)
    return status;
  conic_text_dialect_begin(CONIC_TEXT_BLANKS, &blanks);
  size_t n = conic_text_split(&blanks, line, names, CONIC_TEXT_MOST_COLUMNS + 1, &is_open);
  if (n > CONIC_TEXT_MOST_COLUMNS)
    return conic_input_wrong(reader->input, "more than %d fields", CONIC_TEXT_MOST_COLUMNS);
  if (!conic_text_columns_name(names, n, &reader->header->names))
    return conic_input_wrong(reader->input, "the points lack x, y or z");
  return CONIC_OK;
}

static conic_status read_whole(header_reader *reader, uint64_t *whole) {
  const char *word;
  size_t length;
  conic_status status = conic_input_word(reader->input, &word, &length);
  if (status == CONIC_OK && !parse_whole(word, length, 0x1p53, whole))
    status = conic_input_wrong(reader->input, "a number of points is no whole number in range");
  return status;
}

/* x y z and a quaternion w x y z. */
static conic_status read_viewpoint_value(header_reader *reader, size_t i, const char *word, size_t length) {
  double value;
  if (conic_number_parse(word, length, &value) != length)
    return conic_input_wrong(reader->input, "a value of the viewpoint is not a number");
  reader->header->has_viewpoint |= i < 7 && value != (i == 3 ? 1.0 : 0.0);
  return CONIC_OK;
}

/* In any case: some writers have it all lower, or the data's kind upper. */
static int is_keyword(const char *word, size_t length, const char *keyword) {
  return length == strlen(keyword) && strncasecmp(word, keyword, length) == 0;
}

static conic_status read_data(header_reader *reader) {
  static const char *const words[] = {"ascii", "binary", "binary_compressed"};
  const char *word;
  size_t length;
  conic_status status = conic_input_word(reader->input, &word, &length);
  for (int i = 0; i < 3 && status == CONIC_OK; i++)
    if (is_keyword(word, length, words[i]))
      reader->header->data = (conic_pcd_data)(CONIC_PCD_ASCII + i);
  return status == CONIC_OK && reader->header->data == CONIC_PCD_NONE
             ? conic_input_wrong(reader->input, "the data are neither ascii, binary nor binary_compressed")
             : status;
}

static conic_status read_header_line(header_reader *reader, const char *word, size_t length) {
  conic_pcd_header *header = reader->header;
  size_t n;
  if (length == 0 || word[0] == '#' || is_keyword(word, length, "VERSION"))
    return CONIC_OK;
  if (is_keyword(word, length, "FIELDS") || is_keyword(word, length, "COLUMNS"))
    return read_names(reader);
  if (is_keyword(word, length, "SIZE"))
    return read_words(reader, read_size, &reader->n_sizes);
  if (is_keyword(word, length, "TYPE"))
    return read_words(reader, read_type, &reader->n_types);
  if (is_keyword(word, length, "COUNT"))
    return read_words(reader, read_count, &reader->n_counts);
  if (is_keyword(word, length, "WIDTH"))
    return read_whole(reader, &header->width);
  if (is_keyword(word, length, "HEIGHT"))
    return read_whole(reader, &header->height);
  if (is_keyword(word, length, "VIEWPOINT"))
    return read_words(reader, read_viewpoint_value, &n);
  if (is_keyword(word, length, "DATA"))
    return read_data(reader);
  if (!is_keyword(word, length, "POINTS"))
    return conic_input_wrong(reader->input, "a line of the header begins with no word that is known");
  reader->has_points = 1;
  return read_whole(reader, &header->n_points);
}

static void find_type(conic_pcd_field *field) {
  static const conic_ply_type types[3][3] = {{CONIC_PLY_INT8, CONIC_PLY_INT16, CONIC_PLY_INT32},
                                             {CONIC_PLY_UINT8, CONIC_PLY_UINT16, CONIC_PLY_UINT32}};
  if (field->letter == 'F')
    field->type = field->n_bytes == 8 ? CONIC_PLY_DOUBLE : CONIC_PLY_FLOAT;
  else
    field->type = types[field->letter == 'U'][field->n_bytes == 4 ? 2 : field->n_bytes == 2];
  field->is_known = field->n_bytes == conic_ply_type_bytes(field->type) && field->count == 1;
}

static int is_packed(const conic_pcd_header *header, size_t i) {
  const conic_pcd_field *field = &header->fields[i];
  const char *name = header->names.name[i];
  return (strcmp(name, "rgb") == 0 || strcmp(name, "rgba") == 0) && field->n_bytes == 4 && field->is_known;
}

/* Finds where the fields begin, and whether the known ones can be read. */
static conic_status lay_out(header_reader *reader) {
  conic_pcd_header *header = reader->header;
  header->i_packed = -1;
  for (size_t i = 0; i < header->names.n; i++) {
    conic_pcd_field *field = &header->fields[i];
    if (reader->n_counts == 0)
      field->count = 1;
    find_type(field);
    if (header->names.meaning[i] >= 0 && !field->is_known)
      return conic_input_wrong(reader->input, "the field %s has a type that is not read", header->names.name[i]);
    if (is_packed(header, i) && !header->names.has_colors)
      header->i_packed = (int)i;
    field->row_offset = header->row_bytes;
    field->i_value = header->row_values;
    header->row_bytes += field->n_bytes * field->count;
    header->row_values += field->count;
    if (header->row_bytes > MOST_ROW_BYTES)
      return conic_input_wrong(reader->input, "a point has more than %d bytes", MOST_ROW_BYTES);
  }
  return CONIC_OK;
}

static conic_status check_header(header_reader *reader) {
  conic_pcd_header *header = reader->header;
  size_t n = header->names.n;
  if (n == 0)
    return conic_input_wrong(reader->input, "the header has no line FIELDS");
  if (reader->n_sizes != n || reader->n_types != n || (reader->n_counts && reader->n_counts != n))
    return conic_input_wrong(reader->input, "there are %zu fields, but %zu sizes, %zu types and %zu counts", n,
                             reader->n_sizes, reader->n_types, reader->n_counts);
  if (header->width > CONIC_MAX_POINTS || header->height > CONIC_MAX_POINTS)
    return conic_input_wrong(reader->input, "too many points");
  if (!reader->has_points)
    header->n_points = header->width * header->height;
  if (header->n_points > CONIC_MAX_POINTS)
    return conic_input_wrong(reader->input, "too many points");
  return lay_out(reader);
}

conic_status conic_pcd_header_read(conic_input *input, conic_pcd_header *header) {
  header_reader reader = {.input = input, .header = header};
  conic_status status = CONIC_OK;
  memset(header, 0, sizeof *header);
  for (int is_done = 0; status == CONIC_OK && header->data == CONIC_PCD_NONE;) {
    const char *word;
    size_t length;
    status = conic_input_word(input, &word, &length);
    if (status == CONIC_OK)
      status = read_header_line(&reader, word, length);
    if (status == CONIC_OK && header->data != CONIC_PCD_NONE)
      status = check_header(&reader);
    if (status == CONIC_OK)
      status = conic_input_next_line(input, &is_done);
    if (status == CONIC_OK && is_done && header->data == CONIC_PCD_NONE)
      return conic_input_wrong(input, "the file ends within the header");
  }
  return status;
}
