/* OFF: a polygon mesh as text. [ST][C][N]OFF says what a vertex has beside its place; many files leave that out. */
#include "core/formats/readers.h"
#include "core/splats/face_colors.h"
#include "core/splats/polygon.h"

/* On a line: enough for polygons of a thousand corners. */
enum { MOST_NUMBERS = 1024 };

typedef struct off_reader {
  conic_input *input;
  conic_builder builder;
  conic_face_colors colors;
  int has_normals, has_coordinates, is_homogeneous; /* as the first word says */
  uint64_t n_vertices, n_faces;
} off_reader;

/* The numbers of the next line that has some; *n is 0 where the file ends before. */
static conic_status next_line_numbers(off_reader *reader, double numbers[MOST_NUMBERS], int *n, int *is_done) {
  conic_status status = CONIC_OK;
  for (*n = 0; status == CONIC_OK && *n == 0 && !*is_done;) {
    status = conic_input_numbers(reader->input, numbers, MOST_NUMBERS, n);
    if (status == CONIC_OK)
      status = conic_input_next_line(reader->input, is_done);
  }
  return status;
}

/* The first word, and the counts, which may stand on its line. */
static conic_status read_off_head(off_reader *reader) {
  conic_input *input = reader->input;
  const char *word;
  size_t length;
  double numbers[MOST_NUMBERS];
  int n, is_done = 0;
  conic_status status = conic_input_word(input, &word, &length);
  while (status == CONIC_OK && !is_done && (length == 0 || *word == '#')) {
    status = conic_input_next_line(input, &is_done);
    if (status == CONIC_OK)
      status = conic_input_word(input, &word, &length);
  }
  for (; status == CONIC_OK && length > 3; word++, length--) {
    reader->has_coordinates |= *word == 'S';
    reader->has_normals |= *word == 'N';
    reader->is_homogeneous |= *word == '4';
  }
  if (status == CONIC_OK)
    status = next_line_numbers(reader, numbers, &n, &is_done);
  if (status != CONIC_OK)
    return status;
  if (n < 2 || !(numbers[0] >= 1.0 && numbers[0] <= (double)CONIC_MAX_POINTS) ||
      !(numbers[1] >= 0.0 && numbers[1] < 1e18))
    return conic_input_wrong(input, "the numbers of vertices and faces are expected");
  reader->n_vertices = (uint64_t)numbers[0];
  reader->n_faces = (uint64_t)numbers[1];
  return CONIC_OK;
}

/* x y z [w] [nx ny nz] [r g b [a]] [s t]. What the first word does not say is a colour, if it may be one. */
static conic_status store_vertex(off_reader *reader, const double *numbers, int n) {
  conic_splats *points = &reader->builder.model->points;
  const int at_normal = 3 + reader->is_homogeneous, at_color = at_normal + 3 * reader->has_normals;
  const int n_left = n - at_color - 2 * reader->has_coordinates, has_color = n_left == 3 || n_left == 4;
  if (n < at_color)
    return conic_input_wrong(reader->input, "a vertex has too few numbers");
  conic_status status = conic_builder_reserve_points(&reader->builder, points->count + 1);
  if (status == CONIC_OK && has_color)
    status = conic_builder_add_field(&reader->builder, CONIC_SPLATS_COLORS);
  if (status == CONIC_OK && reader->has_normals)
    status = conic_builder_add_field(&reader->builder, CONIC_SPLATS_NORMALS);
  if (status != CONIC_OK)
    return status;
  double place[3];
  for (int axis = 0; axis < 3; axis++) {
    place[axis] = reader->is_homogeneous ? numbers[axis] / numbers[3] : numbers[axis];
    if (points->normal[axis])
      points->normal[axis][points->count] = (float)numbers[at_normal + axis];
    if (points->color[axis])
      points->color[axis][points->count] = has_color ? (float)numbers[at_color + axis] : 0.0f;
  }
  conic_builder_store_position(&reader->builder, place);
  points->count++;
  return CONIC_OK;
}

static conic_status read_vertices(off_reader *reader, int *is_done) {
  conic_status status = CONIC_OK;
  for (uint64_t i = 0; i < reader->n_vertices && status == CONIC_OK; i++) {
    double numbers[MOST_NUMBERS];
    int n;
    status = next_line_numbers(reader, numbers, &n, is_done);
    if (status == CONIC_OK && n == 0)
      return conic_input_wrong(reader->input, "the file ends before its %llu vertices",
                               (unsigned long long)reader->n_vertices);
    if (status == CONIC_OK)
      status = store_vertex(reader, numbers, n);
  }
  return status;
}

/* Colours behind a face's corners: three or four codes, or fractions; one alone is a number in a table of Geomview's.
 */
static conic_status end_face(off_reader *reader, size_t first, const double *numbers, int n) {
  conic_context *context = reader->input->context;
  conic_model *model = reader->builder.model;
  conic_status status = CONIC_OK;
  if (!model->points.color[0] && n >= 3)
    status = conic_face_colors_take(context, &reader->colors, model, first, numbers);
  conic_polygon_settle(model, first);
  return status;
}

/* The fan of a face's corners, once its line is read. */
static conic_status add_fan(off_reader *reader, const double *corners, int n) {
  conic_status status = CONIC_OK;
  for (int i = 0; i < n; i++)
    if (!(corners[i] >= 0.0 && corners[i] < (double)reader->n_vertices))
      return conic_input_wrong(reader->input, "vertex index %g, but there are only %llu vertices", corners[i],
                               (unsigned long long)reader->n_vertices);
  for (int i = 2; i < n && status == CONIC_OK; i++)
    status = conic_builder_add_triangle(&reader->builder, (uint32_t)corners[0], (uint32_t)corners[i - 1],
                                        (uint32_t)corners[i]);
  return status;
}

/* A face: the number of its corners, these, and perhaps a colour; *has_face is 0 where the file ends before. */
static conic_status read_face(off_reader *reader, int *is_done, int *has_face) {
  const size_t first = reader->builder.model->n_triangles;
  double numbers[MOST_NUMBERS];
  int n;
  conic_status status = conic_input_numbers(reader->input, numbers, MOST_NUMBERS, &n);
  while (status == CONIC_OK && n == 0 && !*is_done) { /* an empty line */
    status = conic_input_next_line(reader->input, is_done);
    if (status == CONIC_OK && !*is_done)
      status = conic_input_numbers(reader->input, numbers, MOST_NUMBERS, &n);
  }
  *has_face = n > 0;
  if (status != CONIC_OK || n == 0)
    return status;
  if (!(numbers[0] >= 0.0 && numbers[0] <= (double)(n - 1)))
    return conic_input_wrong(reader->input, "a face has fewer corners than it says");
  const int n_corners = (int)numbers[0];
  status = add_fan(reader, numbers + 1, n_corners);
  if (status == CONIC_OK)
    status = end_face(reader, first, numbers + 1 + n_corners, n - 1 - n_corners);
  return status == CONIC_OK ? conic_input_next_line(reader->input, is_done) : status;
}

static conic_status read_faces(off_reader *reader, int is_done) {
  conic_status status = CONIC_OK;
  for (uint64_t i = 0; i < reader->n_faces && status == CONIC_OK; i++) {
    int has_face = 0;
    if (!is_done)
      status = read_face(reader, &is_done, &has_face);
    if (status != CONIC_OK || has_face)
      continue;
    conic_log(reader->input->context, CONIC_LOG_WARNING,
              "%s: the file ends before face %llu of %llu; what is before is read (line %llu)", reader->input->name,
              (unsigned long long)i, (unsigned long long)reader->n_faces, (unsigned long long)reader->input->line);
    return CONIC_OK;
  }
  return status;
}

conic_status conic_off_read(conic_input *input, const conic_read_options *options, const conic_delivery *delivery,
                            conic_model *model) {
  off_reader reader = {.input = input};
  int is_done = 0;
  (void)delivery;
  conic_status status = conic_builder_begin(input->context, model, 0, NULL, &reader.builder);
  if (status == CONIC_OK)
    status = read_off_head(&reader);
  if (status == CONIC_OK)
    status = read_vertices(&reader, &is_done);
  if (status == CONIC_OK && model->points.color[0])
    status = conic_raw_colors_decode(input->context, &model->points, conic_raw_kind_of(options->colors_are),
                                     &model->colors_are);
  if (status == CONIC_OK)
    status = read_faces(&reader, is_done);
  return conic_face_colors_finish(&reader.builder, &reader.colors, conic_raw_kind_of(options->colors_are),
                                  options->keeps_faces, status);
}
