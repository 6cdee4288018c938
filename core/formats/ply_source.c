#include "core/formats/ply_source.h"

#include "core/base/byte_order.h"
#include "core/files/number.h"

conic_status conic_ply_wrong(const conic_ply_source *source, const char *what) {
  const conic_input *input = source->input;
  if (source->format == CONIC_PLY_TEXT)
    return conic_fail(input->context, CONIC_ERROR_INPUT, "%s: %s %llu: %s (line %llu)", input->name,
                      source->element->name, (unsigned long long)source->i_row, what, (unsigned long long)input->line);
  return conic_fail(input->context, CONIC_ERROR_INPUT, "%s: %s %llu: %s (at byte %llu)", input->name,
                    source->element->name, (unsigned long long)source->i_row, what,
                    (unsigned long long)conic_input_offset(input));
}

conic_status conic_ply_truncated(conic_ply_source *source) {
  source->is_cut = 1;
  return CONIC_ERROR_INPUT;
}

conic_status conic_ply_tell_cut(const conic_ply_source *source, int is_usable) {
  const conic_input *input = source->input;
  const int is_text = source->format == CONIC_PLY_TEXT;
  const char *const format = "%s: the file ends within %s %llu of %llu%s (%s %llu)";
  const char *const name = source->element->name, *const place = is_text ? "line" : "at byte";
  const uint64_t at = is_text ? input->line : conic_input_offset(input);
  if (!is_usable)
    return conic_fail(input->context, CONIC_ERROR_INPUT, format, input->name, name, (unsigned long long)source->i_row,
                      (unsigned long long)source->element->count, "", place, (unsigned long long)at);
  conic_log(input->context, CONIC_LOG_WARNING, format, input->name, name, (unsigned long long)source->i_row,
            (unsigned long long)source->element->count, "; what is before is read", place, (unsigned long long)at);
  return CONIC_OK;
}

/* The fewest bytes of a row: in ascii, a digit and a blank for each value. */
static uint64_t least_row_bytes(const conic_ply_source *source, const conic_ply_element *element) {
  return source->format == CONIC_PLY_TEXT ? 2 * (uint64_t)element->n_properties : (uint64_t)element->least_row_bytes;
}

uint64_t conic_ply_begin_element(conic_ply_source *source, const conic_ply_element *element) {
  uint64_t row_bytes = least_row_bytes(source, element), remaining = conic_input_remaining_bytes(source->input);
  source->element = element;
  source->i_row = 0;
  remaining += source->format == CONIC_PLY_TEXT && remaining < UINT64_MAX; /* the last line may lack its end */
  return row_bytes ? remaining / row_bytes : UINT64_MAX;
}

conic_status conic_ply_begin_whole(conic_ply_source *source, const conic_ply_element *element) {
  const conic_input *input = source->input;
  if (conic_ply_begin_element(source, element) >= element->count)
    return CONIC_OK;
  return conic_fail(input->context, CONIC_ERROR_INPUT,
                    "%s: the file is too short for the %llu rows of '%s' that line %llu declares (at byte %llu)",
                    input->name, (unsigned long long)element->count, element->name, (unsigned long long)element->line,
                    (unsigned long long)conic_input_offset(input));
}

/* Past empty lines, to the next word. */
conic_status conic_ply_begin_row(conic_ply_source *source) {
  conic_input *input = source->input;
  int is_done = 0;
  while (source->format == CONIC_PLY_TEXT) {
    const char *word;
    size_t length;
    conic_status status = conic_input_word(input, &word, &length);
    if (status != CONIC_OK)
      return status;
    if (length > 0) {
      input->next -= length; /* it is read again as the row's first value */
      break;
    }
    status = conic_input_next_line(input, &is_done);
    if (status != CONIC_OK)
      return status;
    if (is_done)
      return conic_ply_truncated(source);
  }
  return CONIC_OK;
}

conic_status conic_ply_end_row(conic_ply_source *source) {
  if (source->format == CONIC_PLY_TEXT) {
    const char *word;
    size_t length;
    int is_done;
    conic_status status = conic_input_word(source->input, &word, &length);
    if (status == CONIC_OK && length > 0)
      status = conic_ply_wrong(source, "the line has more values than the header declares");
    if (status == CONIC_OK)
      status = conic_input_next_line(source->input, &is_done);
    if (status != CONIC_OK)
      return status;
  }
  source->i_row++;
  return CONIC_OK;
}

static conic_status read_text(conic_ply_source *source, conic_ply_type type, double *value) {
  const char *word;
  size_t length;
  double least, largest;
  conic_status status = conic_input_word(source->input, &word, &length);
  if (status != CONIC_OK)
    return status;
  if (length == 0 && source->input->is_at_end && conic_input_available(source->input) == 0)
    return conic_ply_truncated(source);
  if (length == 0)
    return conic_ply_wrong(source, "the line has fewer values than the header declares");
  if (conic_number_parse(word, length, value) != length)
    return conic_ply_wrong(source, "a value is not a number");
  if (!conic_ply_type_is_integer(type))
    return CONIC_OK;
  conic_ply_type_range(type, &least, &largest);
  if (!(*value >= least && *value <= largest) || *value != (double)(int64_t)*value)
    return conic_ply_wrong(source, "a value is not an integer within its type's range");
  return CONIC_OK;
}

conic_status conic_ply_read_value(conic_ply_source *source, conic_ply_type type, double *value) {
  conic_input *input = source->input;
  size_t n_bytes = conic_ply_type_bytes(type);
  if (source->format == CONIC_PLY_TEXT)
    return read_text(source, type, value);
  if (conic_input_available(input) < n_bytes) {
    conic_status status = conic_input_fill(input, n_bytes);
    if (status != CONIC_OK)
      return status;
    if (conic_input_available(input) < n_bytes)
      return conic_ply_truncated(source);
  }
  conic_ply_convert(conic_input_bytes(input), n_bytes, 1, type, source->format, value);
  input->next += n_bytes;
  return CONIC_OK;
}

conic_status conic_ply_read_list_length(conic_ply_source *source, const conic_ply_property *property,
                                        uint64_t *length) {
  double value = 0.0;
  conic_status status = conic_ply_read_value(source, property->count_type, &value);
  if (status != CONIC_OK)
    return status;
  if (value < 0.0)
    return conic_ply_wrong(source, "a list has a negative length");
  *length = (uint64_t)value;
  int is_text = source->format == CONIC_PLY_TEXT;
  uint64_t item_bytes = is_text ? 2 : conic_ply_type_bytes(property->type);
  uint64_t remaining = conic_input_remaining_bytes(source->input);
  remaining += is_text && remaining < UINT64_MAX; /* the last line may lack its end */
  enum { SHORT = 256 };                           /* no polygon has more corners */
  if (*length > remaining / item_bytes)
    return *length <= SHORT ? conic_ply_truncated(source)
                            : conic_ply_wrong(source, "a list runs past the end of the file");
  return CONIC_OK;
}

conic_status conic_ply_skip_values(conic_ply_source *source, conic_ply_type type, uint64_t count) {
  if (source->format != CONIC_PLY_TEXT) {
    uint64_t n_bytes = count * conic_ply_type_bytes(type), skipped;
    conic_status status = conic_input_skip(source->input, n_bytes, &skipped);
    return status == CONIC_OK && skipped < n_bytes ? conic_ply_truncated(source) : status;
  }
  for (uint64_t i = 0; i < count; i++) {
    double value;
    conic_status status = read_text(source, type, &value);
    if (status != CONIC_OK)
      return status;
  }
  return CONIC_OK;
}

/* Each property's value goes to row i_row of its column; `columns` null, or a column null: it is passed over. */
static conic_status read_row(conic_ply_source *source, const conic_ply_property *properties, double *const *columns,
                             size_t i_row) {
  conic_status status = conic_ply_begin_row(source);
  for (size_t i = 0; status == CONIC_OK && i < source->element->n_properties; i++) {
    uint64_t count = 1;
    if (columns && columns[i]) {
      status = conic_ply_read_value(source, properties[i].type, &columns[i][i_row]);
      continue;
    }
    if (properties[i].is_list)
      status = conic_ply_read_list_length(source, &properties[i], &count);
    if (status == CONIC_OK)
      status = conic_ply_skip_values(source, properties[i].type, count);
  }
  return status == CONIC_OK ? conic_ply_end_row(source) : status;
}

conic_status conic_ply_skip_element(conic_ply_source *source, const conic_ply_header *header) {
  const conic_ply_element *element = source->element;
  conic_status status = CONIC_OK;
  if (element->n_properties == 0)
    return CONIC_OK;
  for (uint64_t i = 0; status == CONIC_OK && i < element->count; i++)
    status = read_row(source, header->properties + element->first_property, NULL, 0);
  return status;
}

static uint16_t load_16(const unsigned char *p, int is_big) {
  return is_big ? conic_load_big_16(p) : conic_load_16(p);
}

static uint32_t load_32(const unsigned char *p, int is_big) {
  return is_big ? conic_load_big_32(p) : conic_load_32(p);
}

static uint64_t load_64(const unsigned char *p, int is_big) {
  return is_big ? conic_load_big_64(p) : conic_load_64(p);
}

static void convert_floats(const unsigned char *bytes, size_t stride, size_t n, int is_big, double *values) {
  for (size_t i = 0; i < n; i++)
    values[i] = (double)conic_float_of_bits(load_32(bytes + i * stride, is_big));
}

static void convert_integers(const unsigned char *bytes, size_t stride, size_t n, conic_ply_type type, int is_big,
                             double *values) {
  for (size_t i = 0; i < n; i++, bytes += stride)
    switch (type) {
    case CONIC_PLY_INT8:
      values[i] = (double)(bytes[0] - (bytes[0] & 0x80) * 2);
      break;
    case CONIC_PLY_INT16:
      values[i] = (double)(load_16(bytes, is_big) - (load_16(bytes, is_big) & 0x8000) * 2);
      break;
    case CONIC_PLY_UINT16:
      values[i] = (double)load_16(bytes, is_big);
      break;
    case CONIC_PLY_INT32:
      values[i] = (double)((int64_t)load_32(bytes, is_big) - (int64_t)(load_32(bytes, is_big) & 0x80000000u) * 2);
      break;
    case CONIC_PLY_UINT32:
      values[i] = (double)load_32(bytes, is_big);
      break;
    case CONIC_PLY_UINT8:
    case CONIC_PLY_FLOAT: /* not an integer */
    case CONIC_PLY_DOUBLE:
      values[i] = (double)bytes[0];
      break;
    }
}

void conic_ply_convert(const unsigned char *bytes, size_t stride, size_t n, conic_ply_type type,
                       conic_ply_format format, double *values) {
  int is_big = format == CONIC_PLY_BIG_ENDIAN;
  if (type == CONIC_PLY_FLOAT && is_big)
    convert_floats(bytes, stride, n, 1, values);
  else if (type == CONIC_PLY_FLOAT)
    convert_floats(bytes, stride, n, 0, values);
  else if (type == CONIC_PLY_DOUBLE) {
    for (size_t i = 0; i < n; i++)
      values[i] = conic_double_of_bits(load_64(bytes + i * stride, is_big));
  } else
    convert_integers(bytes, stride, n, type, is_big, values);
}

int conic_ply_is_plain(conic_ply_format format, const conic_ply_element *element) {
  return format != CONIC_PLY_TEXT && !element->has_lists && element->least_row_bytes <= CONIC_INPUT_WINDOW;
}

void conic_ply_convert_rows(const conic_ply_source *source, const conic_ply_property *properties, const int *columns,
                            int n_columns, const unsigned char *bytes, size_t n, size_t stride, double *values) {
  for (int k = 0; k < n_columns; k++)
    if (columns[k] >= 0)
      conic_ply_convert(bytes + properties[columns[k]].row_offset, source->element->least_row_bytes, n,
                        properties[columns[k]].type, source->format, values + (size_t)k * stride);
}

/* Straight from the window. */
static conic_status read_plain_rows(conic_ply_source *source, const conic_ply_property *properties, const int *columns,
                                    int n_columns, size_t stride, size_t *n, double *values) {
  conic_input *input = source->input;
  size_t row_bytes = source->element->least_row_bytes;
  conic_status status = conic_input_fill(input, row_bytes);
  size_t n_there = conic_input_available(input) / row_bytes;
  if (status != CONIC_OK)
    return status;
  if (n_there == 0)
    return conic_ply_truncated(source);
  *n = n_there < *n ? n_there : *n;
  conic_ply_convert_rows(source, properties, columns, n_columns, conic_input_bytes(input), *n, stride, values);
  input->next += *n * row_bytes;
  source->i_row += *n;
  return CONIC_OK;
}

conic_status conic_ply_read_rows(conic_ply_source *source, const conic_ply_property *properties, const int *columns,
                                 int n_columns, size_t stride, size_t *n, double *values) {
  const conic_ply_element *element = source->element;
  *n = *n < stride ? *n : stride;
  if (conic_ply_is_plain(source->format, element))
    return read_plain_rows(source, properties, columns, n_columns, stride, n, values);
  double **of_properties =
      conic_memory_allocate_zeroed(source->input->context, element->n_properties, sizeof *of_properties);
  conic_status status = of_properties ? CONIC_OK : CONIC_ERROR_MEMORY;
  for (int k = 0; status == CONIC_OK && k < n_columns; k++)
    if (columns[k] >= 0)
      of_properties[columns[k]] = values + (size_t)k * stride;
  for (size_t i = 0; status == CONIC_OK && i < *n; i++)
    status = read_row(source, properties, of_properties, i);
  conic_memory_release(source->input->context, of_properties);
  return status;
}
