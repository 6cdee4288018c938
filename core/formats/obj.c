#include "core/formats/readers.h"

#include "core/base/vectors.h"
#include "core/splats/polygon.h"

/* A face's corner that names a normal; the normal may be read later. */
typedef struct obj_corner {
  uint32_t i_vertex, i_normal;
} obj_corner;

/* The largest index that faces use, and the first line that uses it: only the end tells whether it exists. */
typedef struct largest_index {
  uint64_t index, line;
} largest_index;

enum { VERTEX, TEXTURE, NORMAL, N_KINDS };
static const char *const kind_names[N_KINDS] = {"vertices", "texture coordinates", "normals"};

typedef struct obj_reader {
  conic_input *input;
  conic_builder builder;
  uint64_t counts[N_KINDS];
  largest_index used[N_KINDS];
  uint64_t n_wrong[N_KINDS];      /* indices that name none of what there is so far */
  uint64_t n_lines, n_degenerate; /* that are left out: lines, and faces of fewer than 3 corners */
  double (*normals)[3];
  size_t normal_capacity;
  obj_corner *corners;
  size_t n_corners, corner_capacity;
  conic_faces *faces; /* the model's, if the reader keeps faces' other attributes */
} obj_reader;

/* A corner's vertex, texture coordinate and normal; CONIC_NO_CORNER where it lacks one. */
typedef uint32_t face_corner[3];

/* v x y z, then nothing, a weight (unused), r g b, or r g b a. What colours are fractions of, the whole file tells. */
static conic_status read_vertex(void *data) {
  obj_reader *reader = data;
  double values[7];
  int n;
  conic_splats *points = &reader->builder.model->points;
  conic_status status = conic_input_numbers(reader->input, values, 7, &n);
  if (status != CONIC_OK)
    return status;
  if (n < 3 || n == 5)
    return conic_input_wrong(reader->input,
                             "a vertex has 3 values, 4 with a weight, 6 with a colour or 7 with colour and alpha");
  if (points->count >= CONIC_MAX_POINTS)
    return conic_input_wrong(reader->input, "too many vertices");
  status = conic_builder_reserve_points(&reader->builder, points->count + 1);
  if (status == CONIC_OK && n >= 6)
    status = conic_builder_add_field(&reader->builder, CONIC_SPLATS_COLORS);
  if (status != CONIC_OK)
    return status;
  conic_builder_store_position(&reader->builder, values);
  for (int channel = 0; channel < 3 && points->color[0]; channel++)
    points->color[channel][points->count] = n >= 6 ? (float)values[3 + channel] : 1.0f;
  points->count++;
  reader->counts[VERTEX]++;
  return CONIC_OK;
}

static conic_status read_normal(void *data) {
  obj_reader *reader = data;
  double values[3];
  int n;
  conic_status status = conic_input_numbers(reader->input, values, 3, &n);
  if (status == CONIC_OK && n != 3)
    status = conic_input_wrong(reader->input, "a normal has 3 values");
  if (status == CONIC_OK && reader->counts[NORMAL] >= CONIC_MAX_POINTS)
    status = conic_input_wrong(reader->input, "too many normals");
  if (status == CONIC_OK)
    status = conic_memory_reserve(reader->input->context, &reader->normals, reader->counts[NORMAL],
                                  reader->counts[NORMAL] + 1, &reader->normal_capacity, sizeof *reader->normals);
  if (status == CONIC_OK)
    memcpy(reader->normals[reader->counts[NORMAL]++], values, sizeof values);
  if (status == CONIC_OK && reader->faces)
    status = conic_faces_add_normal(reader->input->context, reader->faces, values);
  return status;
}

/* Texture coordinates are counted, to check indices, and kept only on request. */
static conic_status read_texture(void *data) {
  obj_reader *reader = data;
  double values[3] = {0.0, 0.0, 0.0};
  int n;
  conic_status status = conic_input_numbers(reader->input, values, 3, &n);
  if (status == CONIC_OK && n < 1)
    return conic_input_wrong(reader->input, "a texture coordinate has 1 to 3 values");
  if (status == CONIC_OK && reader->faces && reader->counts[TEXTURE] >= CONIC_MAX_POINTS)
    return conic_input_wrong(reader->input, "too many texture coordinates");
  if (status == CONIC_OK && reader->faces)
    status = conic_faces_add_coordinate(reader->input->context, reader->faces, values);
  reader->counts[TEXTURE]++;
  return status;
}

/* Reads an integer; returns past it, or null. */
static const char *parse_index(const char *text, const char *end, int64_t *index) {
  const char *c = text;
  int is_negative = c < end && *c == '-';
  if (c < end && (*c == '-' || *c == '+'))
    c++;
  const char *digits = c;
  for (*index = 0; c < end && *c >= '0' && *c <= '9'; c++)
    if (*index < INT64_C(1) << 40)
      *index = *index * 10 + (*c - '0');
  if (c == digits)
    return NULL;
  if (is_negative)
    *index = -*index;
  return c;
}

/* Turns the file's numbers, from 1 or back from the last, into indices from 0. */
static conic_status resolve_index(obj_reader *reader, int kind, int64_t index, uint32_t *resolved) {
  uint64_t count = reader->counts[kind];
  const int is_wrong = index == 0 || (index < 0 && (uint64_t)-index > count);
  if (is_wrong && kind == VERTEX)
    return conic_input_wrong(reader->input, "index %lld, but there are only %llu %s so far", (long long)index,
                             (unsigned long long)count, kind_names[kind]);
  if (is_wrong) {
    if (reader->n_wrong[kind]++ == 0)
      conic_log(reader->input->context, CONIC_LOG_WARNING,
                "%s: index %lld, but there are only %llu %s so far: corners that name such do without (line %llu)",
                reader->input->name, (long long)index, (unsigned long long)count, kind_names[kind],
                (unsigned long long)reader->input->line);
    *resolved = CONIC_NO_CORNER;
    return CONIC_OK;
  }
  uint64_t found = index < 0 ? count - (uint64_t)-index : (uint64_t)index - 1;
  if (found >= CONIC_MAX_POINTS)
    return conic_input_wrong(reader->input, "an index is out of range");
  if (found >= count && found + 1 > reader->used[kind].index) {
    reader->used[kind].index = found + 1;
    reader->used[kind].line = reader->input->line;
  }
  *resolved = (uint32_t)found;
  return CONIC_OK;
}

/* v, v/t, v//n or v/t/n. */
static conic_status read_corner(obj_reader *reader, const char *word, size_t length, face_corner resolved) {
  const char *c = word, *end = word + length;
  resolved[VERTEX] = resolved[TEXTURE] = resolved[NORMAL] = CONIC_NO_CORNER;
  for (int kind = VERTEX; kind < N_KINDS; kind++) {
    int64_t index;
    if (kind > VERTEX) {
      if (c == end)
        break;
      if (*c++ != '/')
        return conic_input_wrong(reader->input, "a face's corner is v, v/t, v//n or v/t/n");
      if (kind == TEXTURE && c < end && *c == '/')
        continue;
      if (kind == NORMAL && c == end) /* v/t/ exists, too */
        break;
    }
    c = parse_index(c, end, &index);
    if (!c || (kind == VERTEX && index == 0))
      return conic_input_wrong(reader->input, "a face's corner is v, v/t, v//n or v/t/n");
    conic_status status = resolve_index(reader, kind, index, &resolved[kind]);
    if (status != CONIC_OK)
      return status;
  }
  if (c != end)
    return conic_input_wrong(reader->input, "a face's corner is v, v/t, v//n or v/t/n");
  if (resolved[NORMAL] == CONIC_NO_CORNER)
    return CONIC_OK;
  const obj_corner corner = {resolved[VERTEX], resolved[NORMAL]};
  return conic_memory_append(reader->input->context, &reader->corners, &reader->n_corners, &reader->corner_capacity,
                             &corner, sizeof corner);
}

static conic_status add_obj_triangle(obj_reader *reader, const face_corner a, const face_corner b,
                                     const face_corner c) {
  const uint32_t normals[3] = {a[NORMAL], b[NORMAL], c[NORMAL]};
  const uint32_t coordinates[3] = {a[TEXTURE], b[TEXTURE], c[TEXTURE]};
  conic_status status = conic_builder_add_triangle(&reader->builder, a[VERTEX], b[VERTEX], c[VERTEX]);
  if (status == CONIC_OK && reader->faces)
    status = conic_faces_add(reader->input->context, reader->faces, normals, coordinates);
  return status;
}

static conic_status read_face(void *data) {
  obj_reader *reader = data;
  face_corner first = {0, 0, 0}, previous = {0, 0, 0}, current;
  conic_model *model = reader->builder.model;
  size_t n_before = model->n_triangles;
  for (uint64_t n = 0;; n++) {
    const char *word;
    size_t length;
    conic_status status = conic_input_word(reader->input, &word, &length);
    if (status != CONIC_OK)
      return status;
    if (length == 0 || word[0] == '#') {
      conic_polygon_settle(model, n_before);
      reader->n_degenerate += n < 3;
      return CONIC_OK;
    }
    status = read_corner(reader, word, length, current);
    if (status == CONIC_OK && n >= 2)
      status = add_obj_triangle(reader, first, previous, current);
    if (status != CONIC_OK)
      return status;
    if (n == 0)
      memcpy(first, current, sizeof first);
    memcpy(previous, current, sizeof previous);
  }
}

/* usemtl NAME, which may have blanks */
static conic_status read_material(void *data) {
  obj_reader *reader = data;
  const char *name;
  size_t length;
  conic_status status = conic_input_rest(reader->input, &name, &length);
  if (status != CONIC_OK || !reader->faces)
    return status;
  if (conic_texts_find(&reader->faces->material_names, name, length) >= CONIC_MAX_MATERIALS)
    return conic_input_wrong(reader->input, "too many materials");
  return conic_faces_use_material(reader->input->context, reader->faces, name, length);
}

static conic_status add_library(obj_reader *reader, const char *name, size_t length) {
  char path[2 * CONIC_INPUT_LONGEST_WORD];
  if (length > CONIC_INPUT_LONGEST_WORD || reader->faces->libraries.count == CONIC_MAX_MATERIALS)
    return conic_input_wrong(reader->input, "a material file's name is too long, or there are too many");
  conic_input_find(reader->input, name, length, path, sizeof path);
  return conic_texts_add(reader->input->context, &reader->faces->libraries, path, strlen(path));
}

/* mtllib FILE …: one file whose name has blanks, where there is such a file. */
static conic_status read_libraries(void *data) {
  obj_reader *reader = data;
  const char *word;
  char path[2 * CONIC_INPUT_LONGEST_WORD];
  size_t length;
  conic_status status = conic_input_rest(reader->input, &word, &length);
  if (status != CONIC_OK || !reader->faces)
    return status;
  if (length <= CONIC_INPUT_LONGEST_WORD && conic_input_find(reader->input, word, length, path, sizeof path))
    return add_library(reader, word, length);
  for (;;) {
    status = conic_input_word(reader->input, &word, &length);
    if (status == CONIC_OK && length > 0)
      status = add_library(reader, word, length);
    if (status != CONIC_OK || length == 0)
      return status;
  }
}

/* Said once for a file. */
static conic_status leave_out_line(void *data) {
  obj_reader *reader = data;
  if (reader->n_lines++ == 0)
    conic_log(reader->input->context, CONIC_LOG_WARNING, "%s: lines are not drawn, and are left out (line %llu)",
              reader->input->name, (unsigned long long)reader->input->line);
  return CONIC_OK;
}

static const conic_input_statement statements[] = {
    {"v", read_vertex},        {"vn", read_normal},        {"vt", read_texture}, {"f", read_face},
    {"usemtl", read_material}, {"mtllib", read_libraries}, {"l", leave_out_line}};

/* Corners do without a texture coordinate or a normal that there is not. */
static void leave_out(uint32_t (*corners)[3], size_t n, uint64_t count) {
  for (size_t i = 0; i < 3 * n; i++)
    if (corners[i / 3][i % 3] >= count)
      corners[i / 3][i % 3] = CONIC_NO_CORNER;
}

static void drop_missing(obj_reader *reader) {
  conic_faces *faces = reader->faces;
  size_t n_kept = 0;
  for (size_t i = 0; i < reader->n_corners; i++)
    if (reader->corners[i].i_normal < reader->counts[NORMAL])
      reader->corners[n_kept++] = reader->corners[i];
  reader->n_corners = n_kept;
  if (faces) {
    leave_out(faces->normal_corners, faces->count, reader->counts[NORMAL]);
    leave_out(faces->texture_corners, faces->count, reader->counts[TEXTURE]);
  }
  for (int kind = TEXTURE; kind < N_KINDS; kind++)
    if (reader->used[kind].index > reader->counts[kind])
      conic_log(reader->input->context, CONIC_LOG_WARNING,
                "%s: index %llu, but there are only %llu %s: corners that name others do without (line %llu)",
                reader->input->name, (unsigned long long)reader->used[kind].index,
                (unsigned long long)reader->counts[kind], kind_names[kind],
                (unsigned long long)reader->used[kind].line);
  if (reader->n_degenerate)
    conic_log(reader->input->context, CONIC_LOG_WARNING, "%s: faces of fewer than 3 corners are left out: %llu",
              reader->input->name, (unsigned long long)reader->n_degenerate);
}

static conic_status check_indices(const obj_reader *reader) {
  if (reader->used[VERTEX].index > reader->counts[VERTEX])
    return conic_fail(reader->input->context, CONIC_ERROR_INPUT,
                      "%s: index %llu, but there are only %llu %s (line %llu)", reader->input->name,
                      (unsigned long long)reader->used[VERTEX].index, (unsigned long long)reader->counts[VERTEX],
                      kind_names[VERTEX], (unsigned long long)reader->used[VERTEX].line);
  if (reader->counts[VERTEX] == 0)
    return conic_input_wrong(reader->input, "the file ends without a vertex");
  return CONIC_OK;
}

/* A vertex's normal is the unit sum over all corners, in the file's order; zero where no corner names one. */
static conic_status gather_normals(obj_reader *reader) {
  conic_splats *points = &reader->builder.model->points;
  if (reader->n_corners == 0)
    return CONIC_OK;
  conic_status status = conic_builder_add_field(&reader->builder, CONIC_SPLATS_NORMALS);
  if (status != CONIC_OK)
    return status;
  double(*sums)[3] = conic_memory_allocate_zeroed(reader->input->context, points->count, sizeof *sums);
  if (!sums)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < reader->n_corners; i++)
    for (int axis = 0; axis < 3; axis++)
      sums[reader->corners[i].i_vertex][axis] += reader->normals[reader->corners[i].i_normal][axis];
  for (size_t i = 0; i < points->count; i++) {
    conic_normalize(sums[i]);
    for (int axis = 0; axis < 3; axis++)
      points->normal[axis][i] = (float)sums[i][axis];
  }
  conic_memory_release(reader->input->context, sums);
  return CONIC_OK;
}

conic_status conic_obj_read(conic_input *input, const conic_read_options *options, const conic_delivery *delivery,
                            conic_model *model) {
  obj_reader reader = {.input = input};
  (void)delivery;
  input->continues_lines = 1;
  conic_status status = conic_builder_begin(input->context, model, 0, NULL, &reader.builder);
  if (status == CONIC_OK && options->keeps_faces) {
    status = conic_faces_create(input->context, &model->faces);
    reader.faces = model->faces;
  }
  if (status == CONIC_OK)
    status = conic_input_read_statements(input, statements, sizeof statements / sizeof *statements, &reader);
  if (status == CONIC_OK)
    status = check_indices(&reader);
  if (status == CONIC_OK)
    drop_missing(&reader);
  if (status == CONIC_OK)
    status = gather_normals(&reader);
  if (status == CONIC_OK)
    status = conic_raw_colors_decode(input->context, &model->points, conic_raw_kind_of(options->colors_are),
                                     &model->colors_are);
  conic_memory_release_these(input->context, reader.normals, reader.corners);
  return status;
}
