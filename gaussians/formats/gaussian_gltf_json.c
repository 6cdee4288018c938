/* What a glTF says of its Gaussians, and the buffers that they are in. */

#include "core/files/file.h"
#include "gaussians/formats/gaussian_gltf.h"

conic_status conic_gltf_wrong(const conic_gltf_reader *reader, const char *what) {
  return conic_gaussian_bytes_wrong(reader->file, 0, what);
}

typedef conic_status read_member(conic_gltf_reader *reader, void *item, const char *key);

/* The object that comes next, member by member; what `read` leaves alone is passed over. */
static conic_status read_object(conic_gltf_reader *reader, read_member *read, void *item) {
  char key[CONIC_JSON_KEY_ROOM];
  conic_status status = conic_json_begin_object(&reader->json);
  while (status == CONIC_OK && conic_json_next_member(&reader->json, key))
    status = read(reader, item, key);
  return status == CONIC_OK ? reader->json.status : status;
}

/* An array of objects, appended to *items, which begin as `start`. */
static conic_status read_array(conic_gltf_reader *reader, read_member *read, void *items, size_t *n, size_t *room,
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
                                : CONIC_GLTF_NONE;
}

static conic_status decode_base64(const conic_gltf_reader *reader, const char *text, size_t length,
                                  conic_gltf_buffer *buffer) {
  uint32_t bits = 0;
  int n_bits = 0;
  buffer->own = conic_memory_allocate(reader->file->context, length, 1);
  if (!buffer->own)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < length && text[i] != '='; i++) {
    int value = decode_letter(text[i]);
    if (value == CONIC_GLTF_NONE)
      return conic_gltf_wrong(reader, "a buffer's data are no base64");
    bits = (bits << 6 | (uint32_t)value) & 0xffffff;
    n_bits += 6;
    if (n_bits >= 8)
      buffer->own[buffer->n_bytes++] = (unsigned char)(bits >> (n_bits -= 8));
  }
  buffer->bytes = buffer->own;
  return CONIC_OK;
}

static conic_status open_beside(const conic_gltf_reader *reader, const char *name, size_t length,
                                conic_gltf_buffer *buffer) {
  const char *path = reader->file->path;
  int n_folder = path ? (int)(conic_file_name(path) - path) : 0;
  char beside[4096];
  int n = snprintf(beside, sizeof beside, "%.*s%.*s", n_folder, path ? path : "", (int)length, name);
  if (!path || length > 4000 || n < 0 || (size_t)n >= sizeof beside || memchr(name, ':', length))
    return conic_gltf_wrong(reader, "a buffer is in another file, which cannot be looked for");
  conic_status status = conic_mapping_open(reader->file->context, beside, &buffer->mapping);
  buffer->bytes = buffer->mapping.bytes;
  buffer->n_bytes = buffer->mapping.n_bytes;
  return status;
}

static conic_status read_buffer(conic_gltf_reader *reader, void *item, const char *key) {
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
  return conic_gltf_wrong(reader, "a buffer's data are no base64");
}

static conic_status read_buffers(conic_gltf_reader *reader) {
  conic_status status = conic_json_begin_array(&reader->json);
  while (status == CONIC_OK && conic_json_next_item(&reader->json)) {
    if (reader->n_buffers == CONIC_GLTF_MOST_BUFFERS)
      return conic_gltf_wrong(reader, "too many buffers");
    conic_gltf_buffer *buffer = &reader->buffers[reader->n_buffers++];
    status = read_object(reader, read_buffer, buffer);
    if (status == CONIC_OK && !buffer->bytes) { /* the binary part of a .glb */
      buffer->bytes = reader->binary.bytes;
      buffer->n_bytes = reader->binary.n_bytes;
    }
  }
  return status == CONIC_OK ? reader->json.status : status;
}

static conic_status read_view(conic_gltf_reader *reader, void *item, const char *key) {
  static const char *const keys[] = {"buffer", "byteOffset", "byteLength", "byteStride"};
  for (int i = 0; i < 4; i++)
    if (strcmp(key, keys[i]) == 0)
      return conic_json_number(&reader->json, (double *)item + i);
  return conic_json_skip(&reader->json);
}

static conic_status read_accessor(conic_gltf_reader *reader, void *item, const char *key) {
  static const char *const keys[] = {"bufferView", "byteOffset", "componentType", "count"};
  conic_gltf_accessor *accessor = item;
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

/* Which attribute a name is; CONIC_GLTF_NONE: none that matters. */
static int find_attribute(const char *key) {
  static const char prefix[] = "KHR_gaussian_splatting:";
  static const char *const names[] = {"POSITION", "ROTATION", "SCALE", "OPACITY"};
  const char *name = key;
  int degree, i_order;
  char end;
  if (strcmp(key, "POSITION") == 0)
    return CONIC_GLTF_POSITION;
  if (strcmp(key, "COLOR_0") == 0)
    return CONIC_GLTF_COLOR;
  if (strncmp(key, prefix, sizeof prefix - 1) == 0)
    name += sizeof prefix - 1;
  else if (*key == '_') /* as it was first */
    name++;
  else
    return CONIC_GLTF_NONE;
  for (int i = CONIC_GLTF_ROTATION; i <= CONIC_GLTF_OPACITY; i++)
    if (strcmp(name, names[i]) == 0)
      return i;
  if (strncmp(name, "SH_DEGREE_", 10) != 0 || !name[10] || strncmp(name + 11, "_COEF_", 6) != 0)
    return CONIC_GLTF_NONE;
  degree = name[10] - '0';
  i_order = name[17] - '0';
  end = name[17] ? name[18] : 'x';
  return degree >= 0 && degree <= CONIC_MAX_SH_DEGREE && i_order >= 0 && i_order <= 2 * degree && end == 0
             ? CONIC_GLTF_SH + degree * degree + i_order
             : CONIC_GLTF_NONE;
}

static conic_status read_attribute(conic_gltf_reader *reader, void *item, const char *key) {
  conic_gltf_primitive *primitive = item;
  int attribute = find_attribute(key);
  primitive->is_gaussian |= attribute == CONIC_GLTF_ROTATION;
  return attribute == CONIC_GLTF_NONE ? conic_json_skip(&reader->json)
                                      : conic_json_number(&reader->json, &primitive->accessors[attribute]);
}

static conic_status read_extension(conic_gltf_reader *reader, void *item, const char *key) {
  char text[32];
  if (strcmp(key, "colorSpace") != 0)
    return conic_json_skip(&reader->json);
  conic_status status = conic_json_text(&reader->json, text, sizeof text);
  ((conic_gltf_primitive *)item)->is_linear = strncmp(text, "lin_", 4) == 0;
  return status;
}

static conic_status read_extensions(conic_gltf_reader *reader, void *item, const char *key) {
  return strcmp(key, "KHR_gaussian_splatting") == 0 ? read_object(reader, read_extension, item)
                                                    : conic_json_skip(&reader->json);
}

static conic_status read_primitive(conic_gltf_reader *reader, void *item, const char *key) {
  ((conic_gltf_primitive *)item)->mesh = reader->n_meshes;
  if (strcmp(key, "attributes") == 0)
    return read_object(reader, read_attribute, item);
  return strcmp(key, "extensions") == 0 ? read_object(reader, read_extensions, item) : conic_json_skip(&reader->json);
}

static conic_status read_gltf_mesh(conic_gltf_reader *reader, void *item, const char *key) {
  conic_gltf_primitive start = {0};
  (void)item;
  for (int i = 0; i < CONIC_GLTF_N_ATTRIBUTES; i++)
    start.accessors[i] = CONIC_GLTF_NONE;
  return strcmp(key, "primitives") == 0 ? read_array(reader, read_primitive, &reader->primitives, &reader->n_primitives,
                                                     &reader->primitive_room, &start, sizeof start)
                                        : conic_json_skip(&reader->json);
}

static conic_status read_meshes(conic_gltf_reader *reader) {
  conic_status status = conic_json_begin_array(&reader->json);
  while (status == CONIC_OK && conic_json_next_item(&reader->json)) {
    status = read_object(reader, read_gltf_mesh, NULL);
    reader->n_meshes++;
  }
  return status == CONIC_OK ? reader->json.status : status;
}

static conic_status read_children(conic_gltf_reader *reader, conic_gltf_node *node) {
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

static conic_status read_node(conic_gltf_reader *reader, void *item, const char *key) {
  conic_gltf_node *node = item;
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

static conic_status read_root(conic_gltf_reader *reader, void *item, const char *key) {
  static const conic_gltf_view view = {CONIC_GLTF_NONE, 0, 0, 0};
  static const conic_gltf_accessor accessor = {.view = CONIC_GLTF_NONE};
  static const conic_gltf_node node = {.mesh = CONIC_GLTF_NONE, .rotation = {0, 0, 0, 1}, .scale = {1, 1, 1}};
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

/* The JSON of a file, and the binary part of a .glb. */
static conic_status open_parts(conic_gltf_reader *reader) {
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

conic_status conic_gltf_parse(conic_gltf_reader *reader) {
  conic_status status = open_parts(reader);
  return status == CONIC_OK ? read_object(reader, read_root, NULL) : status;
}

void conic_gltf_release(conic_gltf_reader *reader) {
  conic_context *context = reader->file->context;
  for (int i = 0; i < reader->n_buffers; i++) {
    conic_memory_release(context, reader->buffers[i].own);
    conic_mapping_close(context, &reader->buffers[i].mapping);
  }
  if (reader->json.context)
    conic_json_close(&reader->json);
  conic_memory_release_these(context, reader->views, reader->accessors, reader->primitives, reader->nodes,
                             reader->children);
}
