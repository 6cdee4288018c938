/* STL: triangles without order, as text or binary. Corners at the same place become one vertex. The normals are left
 * out: they are the faces' own. */
#include <strings.h>

#include "core/base/byte_order.h"
#include "core/files/number.h"
#include "core/formats/readers.h"
#include "core/meshes/point_slots.h"
#include "core/splats/face_colors.h"

enum { HEAD_BYTES = 84, FACE_BYTES = 50 };

typedef struct stl_reader {
  conic_input *input;
  conic_builder builder;
  conic_point_slots slots;
  conic_face_colors colors;
  uint32_t corners[3];
  int n_corners; /* of the current face */
  /* Of binary ones: colours as Magics writes them, beside one for all, or as VisCAM does. */
  int is_magics, is_colored;
  double whole_color[3];
} stl_reader;

static conic_status add_corner(stl_reader *reader, const double place[3]) {
  conic_builder *builder = &reader->builder;
  const size_t count = builder->model->points.count + 1;
  if (count > CONIC_MAX_POINTS)
    return conic_input_wrong(reader->input, "too many vertices");
  conic_status status = conic_builder_reserve_points(builder, count);
  if (status == CONIC_OK)
    status = conic_point_slots_reserve(builder, &reader->slots, count);
  if (status != CONIC_OK)
    return status;
  conic_builder_store_position(builder, place);
  const uint32_t point = conic_point_slots_join(builder, &reader->slots);
  if (reader->n_corners < 3) {
    reader->corners[reader->n_corners++] = point;
  } else { /* of a polygon, the fan goes on */
    reader->corners[1] = reader->corners[2];
    reader->corners[2] = point;
  }
  return reader->n_corners < 3
             ? CONIC_OK
             : conic_builder_add_triangle(builder, reader->corners[0], reader->corners[1], reader->corners[2]);
}

/* Notes the triangles from `first` on, which have a colour; null: none. */
static conic_status end_face(stl_reader *reader, size_t first, const double *color) {
  conic_model *model = reader->builder.model;
  conic_status status = CONIC_OK;
  reader->n_corners = 0;
  if (color && reader->is_colored)
    status = conic_face_colors_take(reader->input->context, &reader->colors, model, first, color);
  return status;
}

/* --- text --- */

static int is_word(const char *word, size_t length, const char *wanted) {
  return length == strlen(wanted) && strncasecmp(word, wanted, length) == 0;
}

static conic_status read_vertex(stl_reader *reader) {
  double place[3];
  for (int axis = 0; axis < 3; axis++) {
    const char *word;
    size_t length;
    conic_status status = conic_input_word(reader->input, &word, &length);
    if (status != CONIC_OK)
      return status;
    if (length == 0 || conic_number_parse(word, length, &place[axis]) != length)
      return conic_input_wrong(reader->input, "a vertex has 3 numbers");
  }
  return add_corner(reader, place);
}

/* Lines do not matter: only `vertex` and the ends of faces say something, but in the solids' names. */
static conic_status read_text(stl_reader *reader) {
  conic_status status = CONIC_OK;
  int is_done = 0, has_end = 0, is_name = 1;
  for (size_t first = 0; status == CONIC_OK && !is_done;) {
    const char *word;
    size_t length;
    status = conic_input_word(reader->input, &word, &length);
    is_name = (is_name && !is_word(word, length, "facet")) || is_word(word, length, "endsolid");
    if (status == CONIC_OK && !is_name && is_word(word, length, "vertex"))
      status = read_vertex(reader);
    else if (status == CONIC_OK && !is_name &&
             (is_word(word, length, "endloop") || is_word(word, length, "endfacet"))) {
      status = end_face(reader, first, NULL);
      first = reader->builder.model->n_triangles;
    }
    has_end |= is_word(word, length, "endsolid");
    if (status == CONIC_OK && length == 0)
      status = conic_input_next_line(reader->input, &is_done);
  }
  if (status == CONIC_OK && !has_end)
    conic_log(reader->input->context, CONIC_LOG_WARNING,
              "%s: the file ends without endsolid: only a part of it may be there", reader->input->name);
  return status;
}

/* --- binary --- */

static void find_colors(stl_reader *reader, const unsigned char *head) {
  static const char mark[] = "COLOR=";
  for (size_t at = 0; at + sizeof mark + 3 <= HEAD_BYTES - 4 && !reader->is_magics; at++)
    if (memcmp(head + at, mark, sizeof mark - 1) == 0) {
      reader->is_magics = reader->is_colored = 1;
      for (int channel = 0; channel < 3; channel++)
        reader->whole_color[channel] = head[at + sizeof mark - 1 + (size_t)channel] / 255.0;
    }
}

/* Five bits a channel: from red on where Magics writes them, whose uppermost bit stands for the colour of all; from
 * blue on where VisCAM does, whose uppermost bit says that there is one. Returns null where there is none. */
static const double *take_color(const stl_reader *reader, unsigned bits, double color[3]) {
  if (reader->is_magics && bits >> 15)
    return reader->whole_color;
  if (!reader->is_magics && !(bits >> 15))
    return NULL;
  for (int channel = 0; channel < 3; channel++) {
    int shift = 5 * (reader->is_magics ? channel : 2 - channel);
    color[channel] = (double)(bits >> shift & 31) / 31.0;
  }
  return color;
}

static conic_status read_binary_face(stl_reader *reader) {
  const unsigned char *bytes = conic_input_bytes(reader->input);
  const size_t first = reader->builder.model->n_triangles;
  const unsigned bits = conic_load_16(bytes + FACE_BYTES - 2);
  double color[3];
  conic_status status = CONIC_OK;
  for (size_t corner = 0; corner < 3 && status == CONIC_OK; corner++) {
    double place[3];
    for (size_t axis = 0; axis < 3; axis++)
      place[axis] = (double)conic_float_of_bits(conic_load_32(bytes + 12 + 12 * corner + 4 * axis));
    status = add_corner(reader, place);
  }
  reader->input->next += FACE_BYTES;
  return status == CONIC_OK ? end_face(reader, first, take_color(reader, bits, color)) : status;
}

/* Colours of VisCAM show in the first face of many. */
static void look_for_viscam(stl_reader *reader) {
  const unsigned char *bytes = conic_input_bytes(reader->input);
  size_t n = conic_input_available(reader->input) / FACE_BYTES;
  for (size_t i = 0; i < n && !reader->is_colored; i++)
    reader->is_colored = bytes[i * FACE_BYTES + FACE_BYTES - 1] >> 7;
}

static conic_status read_binary(stl_reader *reader) {
  conic_input *input = reader->input;
  const uint64_t count = conic_load_32(conic_input_bytes(input) + HEAD_BYTES - 4);
  find_colors(reader, conic_input_bytes(input));
  input->next += HEAD_BYTES;
  conic_status status = conic_input_fill(input, CONIC_INPUT_WINDOW / 2);
  if (status == CONIC_OK)
    look_for_viscam(reader);
  for (uint64_t i = 0; i < count && status == CONIC_OK; i++) {
    status = conic_input_fill(input, FACE_BYTES);
    if (status == CONIC_OK && conic_input_available(input) < FACE_BYTES) {
      if (i == 0)
        return conic_input_wrong(input, "the file ends within its first face");
      conic_log(input->context, CONIC_LOG_WARNING, "%s: the file ends within face %llu of %llu; what is before is read",
                input->name, (unsigned long long)i, (unsigned long long)count);
      return CONIC_OK;
    }
    if (status == CONIC_OK)
      status = read_binary_face(reader);
  }
  return status;
}

/* Text begins with "solid" and goes on with words. A binary file may begin so, too: it is as long as it says. */
static int is_text(const conic_input *input) {
  const unsigned char *bytes = conic_input_bytes(input);
  size_t n = conic_input_available(input), blanks = 0;
  if (n >= HEAD_BYTES &&
      conic_input_remaining_bytes(input) == HEAD_BYTES + FACE_BYTES * (uint64_t)conic_load_32(bytes + HEAD_BYTES - 4))
    return 0;
  while (blanks < n && bytes[blanks] && strchr(" \t\r\n", bytes[blanks]))
    blanks++;
  n = n < 512 ? n : 512;
  return n - (blanks < n ? blanks : n) >= 5 && strncasecmp((const char *)bytes + blanks, "solid", 5) == 0 &&
         !memchr(bytes, 0, n);
}

conic_status conic_stl_read(conic_input *input, const conic_read_options *options, const conic_delivery *delivery,
                            conic_model *model) {
  stl_reader reader = {.input = input};
  (void)delivery;
  conic_status status = conic_builder_begin(input->context, model, 0, NULL, &reader.builder);
  model->up[2] = 1.0; /* as printers have it */
  if (status == CONIC_OK)
    status = conic_input_fill(input, CONIC_INPUT_LONGEST_LINE);
  const int is_binary = status == CONIC_OK && !is_text(input);
  if (status == CONIC_OK && is_binary && conic_input_available(input) < HEAD_BYTES)
    status = conic_input_wrong(input, "the file ends within the header");
  if (status == CONIC_OK)
    status = is_binary ? read_binary(&reader) : read_text(&reader);
  if (status == CONIC_OK && model->n_triangles == 0)
    status = conic_input_wrong(input, "the file ends without a face");
  conic_memory_release(input->context, reader.slots.slots);
  return conic_face_colors_finish(&reader.builder, &reader.colors, CONIC_RAW_FRACTIONS, options->keeps_faces, status);
}
