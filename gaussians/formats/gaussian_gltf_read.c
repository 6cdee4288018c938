/* Gaussians in glTF, by KHR_gaussian_splatting and as it was before its name was settled: the points of primitives,
 * where the nodes put them. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/base/memory.h"
#include "core/base/message.h"
#include "core/base/vectors.h"
#include "core/files/json_read.h"
#include "gaussians/formats/gaussian_formats.h"
#include "gaussians/scene/activation.h"

enum { MOST_BUFFERS = 64, MOST_DEPTH = 32, NONE = -1 };

/* Attributes: those of one number of the harmonics follow the first five, of the old names the last three. */
enum { POSITION, ROTATION, SCALE, OPACITY, COLOR, SH, N_ATTRIBUTES = SH + CONIC_MOST_HARMONICS / 3 };

typedef struct gltf_view {
  double buffer, offset, length, stride;
} gltf_view;

typedef struct gltf_accessor {
  double view, offset, type, count;
  int n_components, is_normalized, is_sparse;
} gltf_accessor;

typedef struct gltf_primitive {
  int mesh, is_gaussian, is_linear;
  double accessors[N_ATTRIBUTES];
} gltf_primitive;

typedef struct gltf_node {
  double mesh, matrix[16], translation[3], rotation[4], scale[3];
  int has_matrix, is_child;
  size_t first_child, n_children;
} gltf_node;

typedef struct gltf_buffer {
  const unsigned char *bytes;
  size_t n_bytes;
  unsigned char *own;    /* decoded */
  conic_mapping mapping; /* or a file */
} gltf_buffer;

typedef struct gltf_reader {
  const conic_gaussian_bytes *file;
  conic_json json;
  gltf_buffer binary, buffers[MOST_BUFFERS];
  int n_buffers;
  gltf_view *views;
  gltf_accessor *accessors;
  gltf_primitive *primitives;
  gltf_node *nodes;
  double *children;
  size_t n_views, n_accessors, n_primitives, n_nodes, n_children;
  size_t view_room, accessor_room, primitive_room, node_room, child_room;
  int n_meshes;
  conic_gaussians *gaussians; /* null: they are counted */
  size_t n_placed;
} gltf_reader;

static conic_status gltf_wrong(const gltf_reader *reader, const char *what) {
  return conic_gaussian_bytes_wrong(reader->file, 0, what);
}

/* --- the JSON --- */

typedef conic_status read_member(gltf_reader *reader, void *item, const char *key);

/* The object that comes next, member by member; what `read` leaves alone is passed over. */
static conic_status read_object(gltf_reader *reader, read_member *read, void *item) {
  char key[CONIC_JSON_KEY_ROOM];
  conic_status status = conic_json_begin_object(&reader->json);
  while (status == CONIC_OK && conic_json_next_member(&reader->json, key))
    status = read(reader, item, key);
  return status == CONIC_OK ? reader->json.status : status;
}

/* An array of objects, appended to *items, which begin as `start`. */
static conic_status read_array(gltf_reader *reader, read_member *read, void *items, size_t *n, size_t *room,
                               const void *start, size_t size) {
  conic_status status = conic_json_begin_array(&reader->json);
  while (status == CONIC_OK && conic_json_next_item(&reader->json)) {
    char **array = items;
    status = conic_memory_reserve(reader->file->context, items, *n, *n + 1, room, size);
    if (status != CONIC_OK)
      break;
    memcpy(*array + *n * size, start, size);
    status = read_object(reader, read, *array + *n * size);
    (*n)++;
  }
  return status == CONIC_OK ? reader->json.status : status;
}

static int decode_letter(char c) {
  return c >= 'A' && c <= 'Z'   ? c - 'A'
         : c >= 'a' && c <= 'z' ? c - 'a' + 26
         : c >= '0' && c <= '9' ? c - '0' + 52
         : c == '+'             ? 62
         : c == '/'             ? 63
                                : NONE;
}

static conic_status decode_base64(const gltf_reader *reader, const char *text, size_t length, gltf_buffer *buffer) {
  uint32_t bits = 0;
  int n_bits = 0;
  buffer->own = conic_memory_allocate(reader->file->context, length, 1);
  if (!buffer->own)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < length && text[i] != '='; i++) {
    int value = decode_letter(text[i]);
    if (value == NONE)
      return gltf_wrong(reader, "a buffer's data are no base64");
    bits = (bits << 6 | (uint32_t)value) & 0xffffff;
    n_bits += 6;
    if (n_bits >= 8)
      buffer->own[buffer->n_bytes++] = (unsigned char)(bits >> (n_bits -= 8));
  }
  buffer->bytes = buffer->own;
  return CONIC_OK;
}

static conic_status open_beside(const gltf_reader *reader, const char *name, size_t length, gltf_buffer *buffer) {
  const char *path = reader->file->path, *slash = path ? strrchr(path, '/') : NULL;
  int n_folder = slash ? (int)(slash + 1 - path) : 0;
  char beside[4096];
  int n = snprintf(beside, sizeof beside, "%.*s%.*s", n_folder, path ? path : "", (int)length, name);
  if (!path || length > 4000 || n < 0 || (size_t)n >= sizeof beside || memchr(name, ':', length))
    return gltf_wrong(reader, "a buffer is in another file, which cannot be looked for");
  conic_status status = conic_mapping_open(reader->file->context, beside, &buffer->mapping);
  buffer->bytes = buffer->mapping.bytes;
  buffer->n_bytes = buffer->mapping.n_bytes;
  return status;
}

static conic_status read_buffer(gltf_reader *reader, void *item, const char *key) {
  static const char base64[] = ";base64,";
  const char *text;
  size_t length;
  if (strcmp(key, "uri") != 0)
    return conic_json_skip(&reader->json);
  conic_status status = conic_json_raw_text(&reader->json, &text, &length);
  if (status != CONIC_OK)
    return status;
  if (length < 5 || memcmp(text, "data:", 5) != 0)
    return open_beside(reader, text, length, item);
  for (size_t i = 5; i + sizeof base64 - 1 <= length; i++)
    if (memcmp(text + i, base64, sizeof base64 - 1) == 0)
      return decode_base64(reader, text + i + sizeof base64 - 1, length - i - sizeof base64 + 1, item);
  return gltf_wrong(reader, "a buffer's data are no base64");
}

static conic_status read_buffers(gltf_reader *reader) {
  conic_status status = conic_json_begin_array(&reader->json);
  while (status == CONIC_OK && conic_json_next_item(&reader->json)) {
    if (reader->n_buffers == MOST_BUFFERS)
      return gltf_wrong(reader, "too many buffers");
    gltf_buffer *buffer = &reader->buffers[reader->n_buffers++];
    status = read_object(reader, read_buffer, buffer);
    if (status == CONIC_OK && !buffer->bytes) { /* the binary part of a .glb */
      buffer->bytes = reader->binary.bytes;
      buffer->n_bytes = reader->binary.n_bytes;
    }
  }
  return status == CONIC_OK ? reader->json.status : status;
}

static conic_status read_view(gltf_reader *reader, void *item, const char *key) {
  static const char *const keys[] = {"buffer", "byteOffset", "byteLength", "byteStride"};
  for (int i = 0; i < 4; i++)
    if (strcmp(key, keys[i]) == 0)
      return conic_json_number(&reader->json, (double *)item + i);
  return conic_json_skip(&reader->json);
}

static conic_status read_accessor(gltf_reader *reader, void *item, const char *key) {
  static const char *const keys[] = {"bufferView", "byteOffset", "componentType", "count"};
  gltf_accessor *accessor = item;
  char type[8];
  for (int i = 0; i < 4; i++)
    if (strcmp(key, keys[i]) == 0)
      return conic_json_number(&reader->json, &accessor->view + i);
  if (strcmp(key, "normalized") == 0)
    return conic_json_truth(&reader->json, &accessor->is_normalized);
  if (strcmp(key, "type") != 0) {
    accessor->is_sparse |= strcmp(key, "sparse") == 0;
    return conic_json_skip(&reader->json);
  }
  conic_status status = conic_json_text(&reader->json, type, sizeof type);
  accessor->n_components = strcmp(type, "SCALAR") == 0                   ? 1
                           : memcmp(type, "VEC", 3) == 0 && type[3] != 0 ? type[3] - '0'
                                                                         : 0;
  return status;
}

/* Which attribute a name is; NONE: none that matters. */
static int find_attribute(const char *key) {
  static const char prefix[] = "KHR_gaussian_splatting:";
  static const char *const names[] = {"POSITION", "ROTATION", "SCALE", "OPACITY"};
  const char *name = key;
  int degree, i_order;
  char end;
  if (strcmp(key, "POSITION") == 0)
    return POSITION;
  if (strcmp(key, "COLOR_0") == 0)
    return COLOR;
  if (strncmp(key, prefix, sizeof prefix - 1) == 0)
    name += sizeof prefix - 1;
  else if (*key == '_') /* as it was first */
    name++;
  else
    return NONE;
  for (int i = ROTATION; i <= OPACITY; i++)
    if (strcmp(name, names[i]) == 0)
      return i;
  if (strncmp(name, "SH_DEGREE_", 10) != 0 || !name[10] || strncmp(name + 11, "_COEF_", 6) != 0)
    return NONE;
  degree = name[10] - '0';
  i_order = name[17] - '0';
  end = name[17] ? name[18] : 'x';
  return degree >= 0 && degree <= CONIC_MAX_SH_DEGREE && i_order >= 0 && i_order <= 2 * degree && end == 0
             ? SH + degree * degree + i_order
             : NONE;
}

static conic_status read_attribute(gltf_reader *reader, void *item, const char *key) {
  gltf_primitive *primitive = item;
  int attribute = find_attribute(key);
  primitive->is_gaussian |= attribute == ROTATION;
  return attribute == NONE ? conic_json_skip(&reader->json)
                           : conic_json_number(&reader->json, &primitive->accessors[attribute]);
}

static conic_status read_extension(gltf_reader *reader, void *item, const char *key) {
  char text[32];
  if (strcmp(key, "colorSpace") != 0)
    return conic_json_skip(&reader->json);
  conic_status status = conic_json_text(&reader->json, text, sizeof text);
  ((gltf_primitive *)item)->is_linear = strncmp(text, "lin_", 4) == 0;
  return status;
}

static conic_status read_extensions(gltf_reader *reader, void *item, const char *key) {
  return strcmp(key, "KHR_gaussian_splatting") == 0 ? read_object(reader, read_extension, item)
                                                    : conic_json_skip(&reader->json);
}

static conic_status read_primitive(gltf_reader *reader, void *item, const char *key) {
  ((gltf_primitive *)item)->mesh = reader->n_meshes;
  if (strcmp(key, "attributes") == 0)
    return read_object(reader, read_attribute, item);
  return strcmp(key, "extensions") == 0 ? read_object(reader, read_extensions, item) : conic_json_skip(&reader->json);
}

static conic_status read_gltf_mesh(gltf_reader *reader, void *item, const char *key) {
  gltf_primitive start = {0};
  (void)item;
  for (int i = 0; i < N_ATTRIBUTES; i++)
    start.accessors[i] = NONE;
  return strcmp(key, "primitives") == 0 ? read_array(reader, read_primitive, &reader->primitives, &reader->n_primitives,
                                                     &reader->primitive_room, &start, sizeof start)
                                        : conic_json_skip(&reader->json);
}

static conic_status read_meshes(gltf_reader *reader) {
  conic_status status = conic_json_begin_array(&reader->json);
  while (status == CONIC_OK && conic_json_next_item(&reader->json)) {
    status = read_object(reader, read_gltf_mesh, NULL);
    reader->n_meshes++;
  }
  return status == CONIC_OK ? reader->json.status : status;
}

static conic_status read_children(gltf_reader *reader, gltf_node *node) {
  node->first_child = reader->n_children;
  conic_status status = conic_json_begin_array(&reader->json);
  while (status == CONIC_OK && conic_json_next_item(&reader->json)) {
    status = conic_memory_reserve(reader->file->context, &reader->children, reader->n_children, reader->n_children + 1,
                                  &reader->child_room, sizeof *reader->children);
    if (status == CONIC_OK)
      status = conic_json_number(&reader->json, &reader->children[reader->n_children++]);
  }
  node->n_children = reader->n_children - node->first_child;
  return status == CONIC_OK ? reader->json.status : status;
}

static conic_status read_node(gltf_reader *reader, void *item, const char *key) {
  gltf_node *node = item;
  size_t n;
  if (strcmp(key, "mesh") == 0)
    return conic_json_number(&reader->json, &node->mesh);
  if (strcmp(key, "children") == 0)
    return read_children(reader, node);
  if (strcmp(key, "translation") == 0)
    return conic_json_numbers(&reader->json, node->translation, 3, &n);
  if (strcmp(key, "rotation") == 0)
    return conic_json_numbers(&reader->json, node->rotation, 4, &n);
  if (strcmp(key, "scale") == 0)
    return conic_json_numbers(&reader->json, node->scale, 3, &n);
  if (strcmp(key, "matrix") != 0)
    return conic_json_skip(&reader->json);
  node->has_matrix = 1;
  return conic_json_numbers(&reader->json, node->matrix, 16, &n);
}

static conic_status read_root(gltf_reader *reader, void *item, const char *key) {
  static const gltf_view view = {NONE, 0, 0, 0};
  static const gltf_accessor accessor = {.view = NONE};
  static const gltf_node node = {.mesh = NONE, .rotation = {0, 0, 0, 1}, .scale = {1, 1, 1}};
  (void)item;
  if (strcmp(key, "bufferViews") == 0)
    return read_array(reader, read_view, &reader->views, &reader->n_views, &reader->view_room, &view, sizeof view);
  if (strcmp(key, "accessors") == 0)
    return read_array(reader, read_accessor, &reader->accessors, &reader->n_accessors, &reader->accessor_room,
                      &accessor, sizeof accessor);
  if (strcmp(key, "nodes") == 0)
    return read_array(reader, read_node, &reader->nodes, &reader->n_nodes, &reader->node_room, &node, sizeof node);
  if (strcmp(key, "buffers") == 0)
    return read_buffers(reader);
  return strcmp(key, "meshes") == 0 ? read_meshes(reader) : conic_json_skip(&reader->json);
}

/* --- the data --- */

/* Numbers of one attribute: where they are, and how they are stored. */
typedef struct gltf_numbers {
  const unsigned char *bytes;
  size_t stride, count;
  int n_components, type, is_normalized;
} gltf_numbers;

enum { INT8 = 5120, UINT8 = 5121, INT16 = 5122, UINT16 = 5123, FLOAT = 5126 };

/* Whether a number from JSON is one below `end`. */
static int is_index(double number, size_t end) {
  return number >= 0.0 && number < (double)end;
}

static conic_status find_numbers(const gltf_reader *reader, double i_accessor, int n_components,
                                 gltf_numbers *numbers) {
  static const char missing[] = "an accessor of Gaussians names what is not there, or is not of a type that they have";
  memset(numbers, 0, sizeof *numbers);
  if (!is_index(i_accessor, reader->n_accessors))
    return gltf_wrong(reader, missing);
  const gltf_accessor *accessor = &reader->accessors[(size_t)i_accessor];
  if (!is_index(accessor->view, reader->n_views) || accessor->is_sparse || accessor->n_components < n_components ||
      accessor->n_components > 4 || !is_index(accessor->count, CONIC_MOST_GAUSSIANS))
    return gltf_wrong(reader, missing);
  const gltf_view *view = &reader->views[(size_t)accessor->view];
  int type = is_index(accessor->type, 10000) ? (int)accessor->type : 0;
  size_t size = type == FLOAT ? 4 : type == INT8 || type == UINT8 ? 1 : type == INT16 || type == UINT16 ? 2 : 0;
  if (!is_index(view->buffer, (size_t)reader->n_buffers) || size == 0)
    return gltf_wrong(reader, missing);
  const gltf_buffer *buffer = &reader->buffers[(size_t)view->buffer];
  size_t item = size * (size_t)accessor->n_components, stride = item;
  if (view->stride != 0.0 && is_index(view->stride, 256))
    stride = (size_t)view->stride;
  double start = view->offset + accessor->offset, count = accessor->count;
  double end = start + (count > 0.0 ? (count - 1.0) * (double)stride + (double)item : 0.0);
  if (!(view->offset >= 0.0 && accessor->offset >= 0.0 && start <= (double)buffer->n_bytes &&
        end <= (double)buffer->n_bytes) ||
      stride < item)
    return gltf_wrong(reader, "an accessor of Gaussians reaches past the end of its buffer");
  *numbers = (gltf_numbers){buffer->bytes ? buffer->bytes + (size_t)start : NULL,
                            stride,
                            (size_t)count,
                            accessor->n_components,
                            type,
                            accessor->is_normalized};
  return CONIC_OK;
}

static float number_at(const gltf_numbers *numbers, size_t i, int component) {
  const unsigned char *p = numbers->bytes + i * numbers->stride;
  double value, most;
  if (numbers->type == FLOAT)
    return conic_load_float(p + 4 * component);
  if (numbers->type == INT8 || numbers->type == UINT8) {
    value = p[component] - (numbers->type == INT8 && p[component] & 0x80 ? 256 : 0);
    most = numbers->type == INT8 ? 127.0 : 255.0;
  } else {
    int bits = p[2 * component] | p[2 * component + 1] << 8;
    value = bits - (numbers->type == INT16 && bits & 0x8000 ? 65536 : 0);
    most = numbers->type == INT16 ? 32767.0 : 65535.0;
  }
  value = numbers->is_normalized ? value / most : value;
  return (float)(numbers->is_normalized && value < -1.0 ? -1.0 : value);
}

/* The degree up to which all coefficients are there. */
static int find_primitive_degree(const gltf_primitive *primitive) {
  int degree = 0;
  for (int i = 1; i < N_ATTRIBUTES - SH; i++) {
    if (primitive->accessors[SH + i] < 0.0)
      break;
    if (i + 1 == (degree + 2) * (degree + 2))
      degree++;
  }
  return degree;
}

/* One attribute of a primitive into the next Gaussians; components go to columns, or to harmonics from `i_harmonic`. */
static conic_status take_attribute(gltf_reader *reader, const gltf_primitive *primitive, int attribute, int n,
                                   size_t count, float **columns, int first_component, double factor, double offset,
                                   int i_harmonic) {
  gltf_numbers numbers;
  conic_status status = find_numbers(reader, primitive->accessors[attribute], first_component + n, &numbers);
  if (status == CONIC_OK && numbers.count != count)
    status = gltf_wrong(reader, "attributes of the same Gaussians are of different numbers");
  for (int k = 0; status == CONIC_OK && k < n; k++)
    for (size_t i = 0; i < count; i++) {
      float value = number_at(&numbers, i, first_component + k);
      value = factor == 1.0 ? value : (float)((double)value * factor + offset);
      if (columns)
        columns[k][reader->n_placed + i] = value;
      else
        conic_gaussians_put_harmonic(reader->gaussians, reader->n_placed + i, (size_t)(i_harmonic + k), value);
    }
  return status;
}

/* Drafts of the extension had logarithms; a scale below 0 tells them. */
static void activate_old_scales(conic_gaussians *gaussians, size_t first, size_t count) {
  int is_log = 0;
  for (int axis = 0; axis < 3; axis++)
    for (size_t i = first; i < first + count; i++)
      is_log |= gaussians->scale[axis][i] < 0.0f;
  for (int axis = 0; is_log && axis < 3; axis++)
    for (size_t i = first; i < first + count; i++)
      gaussians->scale[axis][i] = conic_scale_of_log(gaussians->scale[axis][i]);
}

static conic_status take_harmonics(gltf_reader *reader, const gltf_primitive *primitive, size_t count) {
  conic_gaussians *gaussians = reader->gaussians;
  conic_status status = CONIC_OK;
  int degree = find_primitive_degree(primitive), n = (gaussians->sh_degree + 1) * (gaussians->sh_degree + 1);
  if (primitive->accessors[SH] < 0.0) {
    status = take_attribute(reader, primitive, COLOR, 3, count, NULL, 0, 1.0 / CONIC_SH_CONSTANT,
                            -0.5 / CONIC_SH_CONSTANT, 0);
    degree = 0;
  }
  for (int i = primitive->accessors[SH] < 0.0; status == CONIC_OK && i < n; i++)
    if (i < (degree + 1) * (degree + 1))
      status = take_attribute(reader, primitive, SH + i, 3, count, NULL, 0, 1.0, 0.0, 3 * i);
    else
      for (size_t k = 0; k < 3 * count; k++)
        conic_gaussians_put_harmonic(gaussians, reader->n_placed + k / 3, 3 * (size_t)i + k % 3, 0.0f);
  return status;
}

static conic_status take_primitive(gltf_reader *reader, const gltf_primitive *primitive, size_t count) {
  conic_gaussians *gaussians = reader->gaussians;
  float *rotation[4] = {gaussians->rotation[1], gaussians->rotation[2], gaussians->rotation[3], gaussians->rotation[0]};
  conic_status status = take_attribute(reader, primitive, POSITION, 3, count, gaussians->position, 0, 1.0, 0.0, 0);
  if (status == CONIC_OK)
    status = take_attribute(reader, primitive, ROTATION, 4, count, rotation, 0, 1.0, 0.0, 0);
  if (status == CONIC_OK)
    status = take_attribute(reader, primitive, SCALE, 3, count, gaussians->scale, 0, 1.0, 0.0, 0);
  if (status == CONIC_OK && primitive->accessors[OPACITY] >= 0.0)
    status = take_attribute(reader, primitive, OPACITY, 1, count, &gaussians->opacity, 0, 1.0, 0.0, 0);
  else if (status == CONIC_OK)
    status = take_attribute(reader, primitive, COLOR, 1, count, &gaussians->opacity, 3, 1.0, 0.0, 0);
  if (status == CONIC_OK)
    status = take_harmonics(reader, primitive, count);
  if (status == CONIC_OK)
    activate_old_scales(gaussians, reader->n_placed, count);
  return status;
}

/* --- the nodes --- */

/* What a node does: p → turn·p·scale + shift. */
typedef struct gltf_place {
  double turn[3][3], scale, shift[3];
} gltf_place;

static const gltf_place no_place = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, 1.0, {0, 0, 0}};

static void rotation_of(const double q[4], double r[3][3]) {
  double x = q[0], y = q[1], z = q[2], w = q[3];
  const double matrix[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                               {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                               {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
  memcpy(r, matrix, sizeof matrix);
}

/* A node's own place; 0 where it stretches or mirrors. */
static int find_place(const gltf_node *node, gltf_place *place) {
  *place = no_place;
  if (!node->has_matrix) {
    rotation_of(node->rotation, place->turn);
    place->scale = node->scale[0];
    memcpy(place->shift, node->translation, sizeof place->shift);
    return node->scale[0] > 0.0 && node->scale[0] == node->scale[1] && node->scale[0] == node->scale[2];
  }
  const double *m = node->matrix;
  double columns[3][3], across[3], longest = 0.0, shortest = 0.0;
  for (int k = 0; k < 3; k++) {
    memcpy(columns[k], m + 4 * k, sizeof columns[k]);
    place->shift[k] = m[12 + k];
    double length = conic_length(columns[k]);
    longest = k == 0 || length > longest ? length : longest;
    shortest = k == 0 || length < shortest ? length : shortest;
  }
  place->scale = longest;
  for (int row = 0; row < 3; row++)
    for (int k = 0; k < 3; k++)
      place->turn[row][k] = columns[k][row] / longest;
  conic_cross(columns[0], columns[1], across);
  double volume = conic_dot(across, columns[2]) / (longest * longest * longest);
  return shortest > 0.9999 * longest && volume > 0.999;
}

static void join_places(const gltf_place *outer, const gltf_place *inner, gltf_place *joined) {
  gltf_place made = *outer;
  for (int row = 0; row < 3; row++) {
    for (int k = 0; k < 3; k++)
      made.turn[row][k] = outer->turn[row][0] * inner->turn[0][k] + outer->turn[row][1] * inner->turn[1][k] +
                          outer->turn[row][2] * inner->turn[2][k];
    made.shift[row] += outer->scale * conic_dot(outer->turn[row], inner->shift);
  }
  made.scale *= inner->scale;
  *joined = made;
}

/* Moves the Gaussians from n_placed on. */
static void put_in_place(gltf_reader *reader, const gltf_place *place, size_t count) {
  conic_gaussians part = *reader->gaussians;
  if (memcmp(place, &no_place, sizeof no_place) == 0)
    return;
  for (int k = 0; k < 4; k++) {
    part.rotation[k] += reader->n_placed;
    if (k == 3)
      break;
    part.position[k] += reader->n_placed;
    part.scale[k] += reader->n_placed;
  }
  size_t n_harmonics = conic_harmonics_of_degree(part.sh_degree) * reader->n_placed;
  part.count = count;
  part.sh = part.sh ? part.sh + n_harmonics : NULL;
  part.sh_half = part.sh_half ? part.sh_half + n_harmonics : NULL;
  conic_gaussians_rotate(reader->file->context, &part, place->turn);
  for (int axis = 0; axis < 3; axis++)
    for (size_t i = 0; i < count; i++) {
      part.position[axis][i] = (float)((double)part.position[axis][i] * place->scale + place->shift[axis]);
      part.scale[axis][i] = (float)((double)part.scale[axis][i] * place->scale);
    }
}

static conic_status place_mesh(gltf_reader *reader, int i_mesh, const gltf_place *place, int is_stretched) {
  conic_status status = CONIC_OK;
  for (size_t i = 0; status == CONIC_OK && i < reader->n_primitives; i++) {
    const gltf_primitive *primitive = &reader->primitives[i];
    gltf_numbers positions;
    if (primitive->mesh != i_mesh || !primitive->is_gaussian)
      continue;
    if (is_stretched)
      return gltf_wrong(reader, "a node stretches or mirrors its Gaussians, which is not read");
    status = find_numbers(reader, primitive->accessors[POSITION], 3, &positions);
    if (status == CONIC_OK && reader->n_placed + positions.count > CONIC_MOST_GAUSSIANS)
      status = gltf_wrong(reader, "too many Gaussians");
    if (status == CONIC_OK && reader->gaussians)
      status = take_primitive(reader, primitive, positions.count);
    if (status == CONIC_OK && reader->gaussians)
      put_in_place(reader, place, positions.count);
    reader->n_placed += positions.count;
  }
  return status;
}

static conic_status place_node(gltf_reader *reader, size_t i_node, const gltf_place *outer, int is_stretched,
                               int depth) {
  const gltf_node *node = &reader->nodes[i_node];
  gltf_place own, place;
  is_stretched |= !find_place(node, &own);
  join_places(outer, &own, &place);
  if (depth == MOST_DEPTH)
    return gltf_wrong(reader, "nodes are nested too deeply");
  conic_status status = CONIC_OK;
  if (is_index(node->mesh, (size_t)reader->n_meshes))
    status = place_mesh(reader, (int)node->mesh, &place, is_stretched);
  for (size_t i = 0; status == CONIC_OK && i < node->n_children; i++) {
    double child = reader->children[node->first_child + i];
    status = is_index(child, reader->n_nodes) ? place_node(reader, (size_t)child, &place, is_stretched, depth + 1)
                                              : gltf_wrong(reader, "a node's child is not there");
  }
  return status;
}

/* Every node that is no other's child; of a file without nodes, the meshes as they are. */
static conic_status place_nodes(gltf_reader *reader) {
  conic_status status = CONIC_OK;
  reader->n_placed = 0;
  for (size_t i = 0; i < reader->n_children; i++)
    if (is_index(reader->children[i], reader->n_nodes))
      reader->nodes[(size_t)reader->children[i]].is_child++;
  for (size_t i = 0; status == CONIC_OK && i < reader->n_nodes; i++)
    if (reader->nodes[i].is_child > 1 && !reader->gaussians)
      status = gltf_wrong(reader, "a node is the child of two");
    else if (!reader->nodes[i].is_child)
      status = place_node(reader, i, &no_place, 0, 0);
  for (int i = 0; status == CONIC_OK && i < reader->n_meshes && reader->n_nodes == 0; i++)
    status = place_mesh(reader, i, &no_place, 0);
  return status;
}

/* --- the file --- */

static conic_status open_parts(gltf_reader *reader) {
  const conic_gaussian_bytes *file = reader->file;
  size_t from = 0, length = file->n_bytes;
  if (length >= 4 && memcmp(file->bytes, "glTF", 4) == 0) {
    size_t n_json = length >= 20 ? conic_load_32(file->bytes + 12) : 0;
    if (length < 20 || n_json > length - 20 || conic_load_32(file->bytes + 16) != 0x4e4f534a)
      return conic_gaussian_bytes_wrong(file, 12, "the JSON of a .glb does not come first, or is cut off");
    from = 20;
    size_t at = from + n_json, n_left = length - at;
    length = n_json;
    if (n_left >= 8 && conic_load_32(file->bytes + at + 4) == 0x004e4942) {
      size_t n_binary = conic_load_32(file->bytes + at);
      reader->binary.bytes = file->bytes + at + 8;
      reader->binary.n_bytes = n_binary < n_left - 8 ? n_binary : n_left - 8;
    }
  }
  return conic_json_take(file->context, file->name, file->bytes + from, length, &reader->json);
}

static int find_file_degree(const gltf_reader *reader) {
  int most = 0;
  for (size_t i = 0; i < reader->n_primitives; i++) {
    int degree = reader->primitives[i].is_gaussian ? find_primitive_degree(&reader->primitives[i]) : 0;
    most = degree > most ? degree : most;
  }
  return most;
}

static conic_status read_gltf(gltf_reader *reader, conic_gaussians *gaussians) {
  conic_context *context = reader->file->context;
  conic_status status = open_parts(reader);
  if (status == CONIC_OK)
    status = read_object(reader, read_root, NULL);
  if (status == CONIC_OK)
    status = place_nodes(reader);
  if (status == CONIC_OK && reader->n_placed == 0)
    status = gltf_wrong(reader, "there are no Gaussians in it");
  if (status == CONIC_OK)
    status = conic_gaussians_begin(context, reader->file->name, reader->file->options, reader->n_placed,
                                   find_file_degree(reader), 0, gaussians);
  if (status != CONIC_OK)
    return status;
  for (size_t i = 0; i < reader->n_primitives; i++)
    gaussians->is_linear |= reader->primitives[i].is_gaussian && reader->primitives[i].is_linear;
  reader->gaussians = gaussians;
  memcpy(gaussians->frame, "luf", sizeof gaussians->frame);
  return place_nodes(reader);
}

conic_status conic_gaussian_gltf_read(const conic_gaussian_bytes *file, conic_gaussians *gaussians) {
  gltf_reader *reader = conic_memory_allocate_zeroed(file->context, 1, sizeof *reader);
  if (!reader)
    return CONIC_ERROR_MEMORY;
  reader->file = file;
  conic_status status = read_gltf(reader, gaussians);
  for (int i = 0; i < reader->n_buffers; i++) {
    conic_memory_release(file->context, reader->buffers[i].own);
    conic_mapping_close(file->context, &reader->buffers[i].mapping);
  }
  if (reader->json.context)
    conic_json_close(&reader->json);
  conic_memory_release(file->context, reader->views);
  conic_memory_release(file->context, reader->accessors);
  conic_memory_release(file->context, reader->primitives);
  conic_memory_release(file->context, reader->nodes);
  conic_memory_release(file->context, reader->children);
  conic_memory_release(file->context, reader);
  return status;
}
