#include "core/formats/readers.h"

#include "core/base/byte_order.h"
#include "core/files/lzf.h"
#include "core/files/number.h"
#include "core/formats/pcd_header.h"
#include "core/splats/point_fields.h"

enum { BLOCK = 256, PACKED = CONIC_TEXT_N_MEANINGS, VALUES, N_SLOTS = VALUES + CONIC_MOST_POINT_VALUES };

typedef struct pcd_reader {
  conic_input *input;
  conic_builder builder;
  conic_pcd_header header;
  int field_of[N_SLOTS]; /* by meaning; the packed colour; requested values; -1: none */
  int n_slots;
  int has_origin, is_origin_set;
  int is_again;
  uint64_t n_rows; /* that have been read */
  double block[N_SLOTS][BLOCK];
} pcd_reader;

/* Chooses the fields to read, and finds whether positions may need more digits than a float's. */
static conic_status choose_fields(pcd_reader *reader) {
  const conic_pcd_header *header = &reader->header;
  conic_status status = CONIC_OK;
  for (int slot = 0; slot < N_SLOTS; slot++)
    reader->field_of[slot] = slot == PACKED ? header->i_packed : -1;
  for (size_t i = 0; i < header->names.n; i++)
    if (header->names.meaning[i] >= 0)
      reader->field_of[header->names.meaning[i]] = (int)i;
  reader->has_origin = header->data == CONIC_PCD_ASCII;
  for (int axis = 0; axis < 3; axis++) {
    conic_ply_type type = header->fields[reader->field_of[axis]].type;
    reader->has_origin |= type == CONIC_PLY_DOUBLE || type == CONIC_PLY_INT32 || type == CONIC_PLY_UINT32;
  }
  if (header->names.has_colors || header->i_packed >= 0)
    status = conic_builder_add_field(&reader->builder, CONIC_SPLATS_COLORS);
  if (status == CONIC_OK && header->names.has_normals)
    status = conic_builder_add_field(&reader->builder, CONIC_SPLATS_NORMALS);
  return status;
}

/* Lists every field of one number, without the padding, which has no name. */
static conic_status choose_values(pcd_reader *reader, const conic_read_options *options) {
  const conic_pcd_header *header = &reader->header;
  size_t listed[CONIC_TEXT_MOST_COLUMNS], n = 0;
  conic_status status = CONIC_OK;
  for (size_t i = 0; status == CONIC_OK && i < header->names.n; i++) {
    const char *name = header->names.name[i];
    if (!header->fields[i].is_known || strcmp(name, "_") == 0)
      continue;
    listed[n++] = i;
    status = conic_fields_add(&reader->builder, name, strlen(name), conic_ply_type_name(header->fields[i].type));
  }
  if (status == CONIC_OK)
    status = conic_fields_choose(&reader->builder, reader->input->name, options);
  reader->n_slots = VALUES + (int)conic_builder_columns(&reader->builder);
  for (int slot = VALUES; status == CONIC_OK && slot < reader->n_slots; slot++) {
    int field = conic_builder_column_field(&reader->builder, (size_t)(slot - VALUES));
    reader->field_of[slot] = field >= 0 ? (int)listed[field] : -1;
  }
  return status;
}

/* The bytes of packed colours, as codes of 16 bits, so that they are not taken for fractions. */
static void unpack_colors(const pcd_reader *reader, size_t n, conic_splats *points) {
  for (size_t i = 0; i < n; i++) {
    uint32_t bits = (uint32_t)reader->block[PACKED][i];
    for (unsigned channel = 0; channel < 3; channel++)
      points->color[channel][points->count + i] = (float)((bits >> (16 - 8 * channel) & 255u) * 257u);
  }
}

static void find_origin(pcd_reader *reader, size_t n) {
  double *origin = reader->builder.model->points.origin;
  for (size_t i = 0; i < n && reader->has_origin && !reader->is_origin_set; i++) {
    int is_finite = 1;
    for (int axis = 0; axis < 3; axis++)
      is_finite &= reader->block[axis][i] - reader->block[axis][i] == 0.0;
    for (int axis = 0; axis < 3 && is_finite; axis++)
      origin[axis] = reader->block[axis][i];
    reader->is_origin_set = is_finite;
  }
}

/* Closes the block's gaps where a camera or a scanner saw nothing, as NaN says; returns how many points are left. */
static size_t drop_unmeasured(pcd_reader *reader, size_t n) {
  size_t kept = 0;
  for (size_t i = 0; i < n; i++) {
    if (reader->block[0][i] != reader->block[0][i] && reader->block[1][i] != reader->block[1][i] &&
        reader->block[2][i] != reader->block[2][i])
      continue;
    for (int slot = 0; slot < reader->n_slots && kept < i; slot++)
      reader->block[slot][kept] = reader->block[slot][i];
    kept++;
  }
  reader->builder.model->n_unmeasured += n - kept;
  return kept;
}

/* Appends the block's first n points. */
static conic_status append_rows(pcd_reader *reader, size_t n) {
  conic_splats *points = &reader->builder.model->points;
  reader->n_rows += n;
  n = drop_unmeasured(reader, n);
  if (conic_builder_points(&reader->builder) + n > CONIC_MAX_POINTS)
    return conic_input_wrong(reader->input, "too many points");
  conic_status status = conic_builder_reserve_points(&reader->builder, points->count + n);
  if (status != CONIC_OK)
    return status;
  find_origin(reader, n);
  for (int axis = 0; axis < 3; axis++)
    for (size_t i = 0; i < n; i++) {
      points->position[axis][points->count + i] = (float)(reader->block[axis][i] - points->origin[axis]);
      if (reader->header.names.has_colors)
        points->color[axis][points->count + i] = (float)reader->block[CONIC_TEXT_RED + axis][i];
      if (reader->header.names.has_normals)
        points->normal[axis][points->count + i] = (float)reader->block[CONIC_TEXT_NORMAL + axis][i];
    }
  for (int slot = VALUES; slot < reader->n_slots; slot++)
    if (reader->field_of[slot] >= 0)
      memcpy(conic_builder_column(&reader->builder, (size_t)(slot - VALUES)), reader->block[slot],
             n * sizeof **reader->block);
  if (reader->header.i_packed >= 0)
    unpack_colors(reader, n, points);
  points->count += n;
  return conic_builder_deliver(&reader->builder, 0);
}

/* --- ascii --- */

/* A packed colour is a float's bits, or an integer. */
static double packed_bits(const conic_pcd_field *field, double value) {
  float as_float = (float)value;
  uint32_t bits = 0;
  if (field->letter == 'F')
    memcpy(&bits, &as_float, sizeof bits);
  else if (value >= -0x1p31 && value < 0x1p32)
    bits = (uint32_t)(int64_t)value;
  return (double)bits;
}

static conic_status read_text_row(pcd_reader *reader, conic_text_word line, size_t i_row) {
  const conic_pcd_header *header = &reader->header;
  conic_text_word words[N_SLOTS];
  const char *c = line.text, *end = c + line.length;
  size_t n = 0;
  memset(words, 0, sizeof words);
  for (; c < end; n++) {
    const char *first = c;
    while (c < end && !strchr(" \t\r", *c))
      c++;
    for (int slot = 0; slot < reader->n_slots; slot++)
      if (reader->field_of[slot] >= 0 && header->fields[reader->field_of[slot]].i_value == n)
        words[slot] = (conic_text_word){first, (size_t)(c - first)};
    while (c < end && strchr(" \t\r", *c))
      c++;
  }
  if (n != header->row_values)
    return conic_input_wrong(reader->input, "a point has %zu values, where the header tells of %zu", n,
                             header->row_values);
  for (int slot = 0; slot < reader->n_slots; slot++) {
    double *value = &reader->block[slot][i_row];
    if (reader->field_of[slot] < 0)
      continue;
    int is_number = conic_number_parse(words[slot].text, words[slot].length, value) == words[slot].length;
    if (slot >= VALUES && !is_number)
      *value = (double)NAN; /* only a requested value may be missing */
    else if (!is_number)
      return conic_input_wrong(reader->input, "a value is not a number");
    if (slot == PACKED)
      *value = packed_bits(&header->fields[reader->field_of[slot]], *value);
  }
  return CONIC_OK;
}

static conic_status read_text_rows(pcd_reader *reader) {
  conic_status status = CONIC_OK;
  size_t n = 0;
  for (int is_done = 0; status == CONIC_OK && !is_done;) {
    conic_text_word line;
    status = conic_input_line(reader->input, &line.text, &line.length);
    while (line.length && status == CONIC_OK && strchr(" \t\r", line.text[0]) && line.text[0])
      line = (conic_text_word){line.text + 1, line.length - 1};
    if (status == CONIC_OK && line.length > 0)
      status = read_text_row(reader, line, n++);
    if (status == CONIC_OK)
      status = conic_input_next_line(reader->input, &is_done);
    if (status == CONIC_OK && (n == BLOCK || (is_done && n))) {
      status = append_rows(reader, n);
      n = 0;
    }
  }
  return status;
}

/* --- binary --- */

/* Converts n points into the block. Their rows begin at `bytes`. If `n_all` is not 0, each field's values for all n_all
 * points are together, and the points begin at `first`. */
static void convert_points(pcd_reader *reader, const unsigned char *bytes, size_t n_all, size_t first, size_t n) {
  for (int slot = 0; slot < reader->n_slots; slot++) {
    if (reader->field_of[slot] < 0)
      continue;
    const conic_pcd_field *field = &reader->header.fields[reader->field_of[slot]];
    size_t stride = n_all ? field->n_bytes : reader->header.row_bytes;
    conic_ply_convert(bytes + field->row_offset * (n_all ? n_all : 1) + first * stride, stride, n,
                      slot == PACKED ? CONIC_PLY_UINT32 : field->type, CONIC_PLY_LITTLE_ENDIAN, reader->block[slot]);
  }
}

static conic_status read_binary_rows(pcd_reader *reader) {
  conic_input *input = reader->input;
  size_t row_bytes = reader->header.row_bytes;
  conic_status status = CONIC_OK;
  while (status == CONIC_OK && reader->n_rows < reader->header.n_points) {
    uint64_t left = reader->header.n_points - reader->n_rows;
    status = conic_input_fill(input, row_bytes);
    size_t n = conic_input_available(input) / row_bytes;
    if (status != CONIC_OK || n == 0)
      break;
    n = n < BLOCK ? n : BLOCK;
    n = n < left ? n : (size_t)left;
    convert_points(reader, conic_input_bytes(input), 0, 0, n);
    status = append_rows(reader, n);
    input->next += n * row_bytes;
  }
  return status;
}

static conic_status wrong_bytes(const pcd_reader *reader, const char *what) {
  return conic_fail(reader->input->context, CONIC_ERROR_INPUT, "%s: %s (at byte %llu)", reader->input->name, what,
                    (unsigned long long)conic_input_offset(reader->input));
}

/* All x, then all y … */
static conic_status append_unpacked(pcd_reader *reader, const unsigned char *bytes, size_t n_points) {
  conic_status status = CONIC_OK;
  for (size_t first = 0; status == CONIC_OK && first < n_points; first += BLOCK) {
    size_t n = n_points - first < BLOCK ? n_points - first : BLOCK;
    convert_points(reader, bytes, n_points, first, n);
    status = append_rows(reader, n);
  }
  return status;
}

/* Two sizes, then the packed bytes. */
static conic_status read_compressed(pcd_reader *reader) {
  conic_input *input = reader->input;
  unsigned char *packed = NULL, *bytes = NULL;
  conic_status status = conic_input_fill(input, 8);
  if (status != CONIC_OK || conic_input_available(input) < 8)
    return status == CONIC_OK ? wrong_bytes(reader, "the file ends before its data") : status;
  uint64_t n_packed = conic_load_32(conic_input_bytes(input));
  uint64_t n_bytes = conic_load_32(conic_input_bytes(input) + 4);
  if (n_bytes % reader->header.row_bytes != 0)
    return wrong_bytes(reader, "the data are no whole number of points");
  if (n_bytes > conic_lzf_most_bytes(n_packed))
    return wrong_bytes(reader, "the data cannot be so much when they are unpacked");
  input->next += 8;
  size_t n_taken = 0;
  if (n_packed > conic_input_remaining_bytes(input))
    return wrong_bytes(reader, "the file ends within its data");
  status = conic_input_take(input, n_packed, &packed, &n_taken);
  if (status == CONIC_OK && n_taken < n_packed)
    status = wrong_bytes(reader, "the file ends within its data");
  if (status == CONIC_OK && n_bytes > 0) {
    bytes = conic_memory_allocate(input->context, (size_t)n_bytes, 1);
    status = bytes ? CONIC_OK : CONIC_ERROR_MEMORY;
  }
  if (status == CONIC_OK && !conic_lzf_unpack(packed, (size_t)n_packed, bytes, (size_t)n_bytes))
    status = wrong_bytes(reader, "the compressed data are damaged");
  if (status == CONIC_OK)
    status = append_unpacked(reader, bytes, (size_t)n_bytes / reader->header.row_bytes);
  conic_memory_release_these(input->context, packed, bytes);
  return status;
}

/* --- all --- */

static conic_status check_points(const pcd_reader *reader) {
  uint64_t count = reader->n_rows, declared = reader->header.n_points;
  conic_context *context = reader->input->context;
  if (count == 0 && declared > 0)
    return wrong_bytes(reader, "the file ends before its first point");
  if (reader->is_again)
    return CONIC_OK;
  if (count != declared)
    conic_log(context, CONIC_LOG_WARNING, "%s: the header declares %llu points; the %llu that are there are read",
              reader->input->name, (unsigned long long)declared, (unsigned long long)count);
  if (reader->header.has_viewpoint)
    conic_log(context, CONIC_LOG_INFO, "%s: its viewpoint is passed over; points are where the file has them",
              reader->input->name);
  return CONIC_OK;
}

static conic_status read_points(pcd_reader *reader, const conic_read_options *options) {
  conic_status status = conic_pcd_header_read(reader->input, &reader->header);
  if (status == CONIC_OK)
    status = choose_fields(reader);
  if (status == CONIC_OK)
    status = choose_values(reader, options);
  if (status == CONIC_OK)
    status = reader->header.data == CONIC_PCD_ASCII    ? read_text_rows(reader)
             : reader->header.data == CONIC_PCD_BINARY ? read_binary_rows(reader)
                                                       : read_compressed(reader);
  return status == CONIC_OK ? check_points(reader) : status;
}

conic_status conic_pcd_read(conic_input *input, const conic_read_options *options, const conic_delivery *delivery,
                            conic_model *model) {
  pcd_reader *reader = conic_memory_allocate_zeroed(input->context, 1, sizeof *reader);
  memset(model, 0, sizeof *model);
  if (!reader)
    return CONIC_ERROR_MEMORY;
  reader->input = input;
  reader->is_again = delivery && delivery->is_again;
  conic_status status = conic_builder_begin(input->context, model, 0, delivery, &reader->builder);
  if (status == CONIC_OK)
    status = read_points(reader, options);
  if (status == CONIC_OK && !delivery)
    status = conic_raw_colors_decode(input->context, &model->points, conic_raw_kind_of(options->colors_are),
                                     &model->colors_are);
  if (status == CONIC_OK)
    status = conic_builder_deliver(&reader->builder, 1);
  conic_memory_release(input->context, reader);
  return status;
}

int conic_pcd_is_likely(const char *bytes, size_t n) {
  static const char *const beginnings[] = {"VERSION ", "FIELDS ", "COLUMNS "};
  const char *c = bytes, *end = bytes + n;
  while (c < end && *c == '#') {
    const char *line_end = memchr(c, '\n', (size_t)(end - c));
    c = line_end ? line_end + 1 : end;
  }
  for (size_t i = 0; i < sizeof beginnings / sizeof *beginnings; i++)
    if ((size_t)(end - c) >= strlen(beginnings[i]) && memcmp(c, beginnings[i], strlen(beginnings[i])) == 0)
      return 1;
  return 0;
}
