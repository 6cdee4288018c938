/* The cameras of a glTF: those at its nodes. */

#include "core/base/byte_order.h"
#include "core/base/trigonometry.h"
#include "core/base/vectors.h"
#include "core/cameras/camera_list.h"
#include "core/files/json_read.h"

enum { MOST_NODE_DEPTH = 64, DEFAULT_HEIGHT = 1024, NO_NODE = -1 };

typedef struct gltf_lens {
  int is_orthographic;
  double angle_y_rad, aspect; /* 0: not given */
  double half_width, half_height;
} gltf_lens;

typedef struct gltf_camera_node {
  double camera, matrix[16], translation[3], rotation[4], scale[3]; /* the rotation is x, y, z, w */
  int has_matrix;
  double parent;
  size_t first_child, n_children;
  uint64_t line;
  char name[64];
} gltf_camera_node;

typedef struct gltf_camera_reader {
  conic_camera_list *list;
  conic_json json;
  gltf_lens *lenses;
  gltf_camera_node *nodes;
  double *children;
  size_t n_lenses, n_nodes, n_children, lens_room, node_room, child_room;
} gltf_camera_reader;

static conic_status gltf_camera_wrong(const gltf_camera_reader *reader, const char *what) {
  return conic_camera_list_wrong(reader->list, what);
}

/* --- the JSON --- */

static void read_lens_numbers(conic_json *json, gltf_lens *lens, int is_orthographic) {
  static const char *const names[] = {"yfov", "aspectRatio", "xmag", "ymag"};
  double *const numbers[] = {&lens->angle_y_rad, &lens->aspect, &lens->half_width, &lens->half_height};
  char key[CONIC_JSON_KEY_ROOM];
  lens->is_orthographic = is_orthographic;
  conic_json_begin_object(json);
  while (conic_json_next_member(json, key)) {
    int i = 0;
    while (i < 4 && strcmp(key, names[i]) != 0)
      i++;
    if (i < 4)
      conic_json_number(json, numbers[i]);
    else
      conic_json_skip(json);
  }
}

static conic_status read_gltf_lens(gltf_camera_reader *reader) {
  char key[CONIC_JSON_KEY_ROOM];
  gltf_lens lens = {0};
  conic_json_begin_object(&reader->json);
  while (conic_json_next_member(&reader->json, key)) {
    int is_orthographic = strcmp(key, "orthographic") == 0;
    if (is_orthographic || strcmp(key, "perspective") == 0)
      read_lens_numbers(&reader->json, &lens, is_orthographic);
    else
      conic_json_skip(&reader->json);
  }
  return reader->json.status == CONIC_OK
             ? conic_memory_append(reader->list->context, &reader->lenses, &reader->n_lenses, &reader->lens_room, &lens,
                                   sizeof lens)
             : reader->json.status;
}

static conic_status read_node_children(gltf_camera_reader *reader, gltf_camera_node *node) {
  node->first_child = reader->n_children;
  conic_status status = conic_json_begin_array(&reader->json);
  while (status == CONIC_OK && conic_json_next_item(&reader->json)) {
    double child;
    status = conic_json_number(&reader->json, &child);
    if (status == CONIC_OK)
      status = conic_memory_append(reader->list->context, &reader->children, &reader->n_children, &reader->child_room,
                                   &child, sizeof child);
  }
  node->n_children = reader->n_children - node->first_child;
  return status;
}

static void read_node_numbers(conic_json *json, double *numbers, size_t n) {
  size_t n_read;
  if (conic_json_numbers(json, numbers, n, &n_read) == CONIC_OK && n_read != n)
    conic_json_wrong(json, "a node's place has another number of numbers");
}

static conic_status read_camera_node(gltf_camera_reader *reader) {
  conic_json *json = &reader->json;
  char key[CONIC_JSON_KEY_ROOM];
  conic_status status = CONIC_OK;
  gltf_camera_node node = {
      .camera = NO_NODE, .rotation = {0, 0, 0, 1}, .scale = {1, 1, 1}, .parent = NO_NODE, .line = json->line};
  conic_json_begin_object(json);
  while (status == CONIC_OK && conic_json_next_member(json, key))
    if (strcmp(key, "camera") == 0)
      conic_json_number(json, &node.camera);
    else if (strcmp(key, "children") == 0)
      status = read_node_children(reader, &node);
    else if (strcmp(key, "name") == 0)
      conic_json_text(json, node.name, sizeof node.name);
    else if (strcmp(key, "translation") == 0)
      read_node_numbers(json, node.translation, 3);
    else if (strcmp(key, "rotation") == 0)
      read_node_numbers(json, node.rotation, 4);
    else if (strcmp(key, "scale") == 0)
      read_node_numbers(json, node.scale, 3);
    else if (strcmp(key, "matrix") == 0 && ++node.has_matrix)
      read_node_numbers(json, node.matrix, 16);
    else
      conic_json_skip(json);
  if (status == CONIC_OK)
    status = json->status;
  return status == CONIC_OK ? conic_memory_append(reader->list->context, &reader->nodes, &reader->n_nodes,
                                                  &reader->node_room, &node, sizeof node)
                            : status;
}

static conic_status read_gltf_items(gltf_camera_reader *reader, conic_status (*read)(gltf_camera_reader *)) {
  conic_status status = conic_json_begin_array(&reader->json);
  while (status == CONIC_OK && conic_json_next_item(&reader->json))
    status = read(reader);
  return status == CONIC_OK ? reader->json.status : status;
}

static conic_status read_gltf_json(gltf_camera_reader *reader) {
  char key[CONIC_JSON_KEY_ROOM];
  conic_status status = conic_json_begin_object(&reader->json);
  while (status == CONIC_OK && conic_json_next_member(&reader->json, key))
    if (strcmp(key, "cameras") == 0)
      status = read_gltf_items(reader, read_gltf_lens);
    else if (strcmp(key, "nodes") == 0)
      status = read_gltf_items(reader, read_camera_node);
    else
      conic_json_skip(&reader->json);
  return status == CONIC_OK ? reader->json.status : status;
}

/* --- places --- */

static int is_index_of(double number, size_t n) {
  return number >= 0.0 && number < (double)n && number == (double)(size_t)number;
}

static conic_status link_nodes(gltf_camera_reader *reader) {
  for (size_t i = 0; i < reader->n_nodes; i++)
    for (size_t k = 0; k < reader->nodes[i].n_children; k++) {
      double child = reader->children[reader->nodes[i].first_child + k];
      if (!is_index_of(child, reader->n_nodes))
        return gltf_camera_wrong(reader, "a node's child is not there");
      if (reader->nodes[(size_t)child].parent >= 0.0)
        return gltf_camera_wrong(reader, "a node is the child of two");
      reader->nodes[(size_t)child].parent = (double)i;
    }
  return CONIC_OK;
}

/* A node's transformation of points: three rows. */
static int find_node_matrix(const gltf_camera_node *node, double rows[3][4]) {
  const double quaternion[4] = {node->rotation[3], node->rotation[0], node->rotation[1], node->rotation[2]};
  double turn[3][3];
  if (!node->has_matrix && !conic_camera_rotation(quaternion, turn))
    return 0;
  for (int row = 0; row < 3; row++)
    for (int k = 0; k < 4; k++)
      rows[row][k] = node->has_matrix ? node->matrix[4 * k + row]
                     : k < 3          ? turn[row][k] * node->scale[k]
                                      : node->translation[row];
  return 1;
}

static void join_matrices(const double outer[3][4], double inner[3][4]) {
  double joined[3][4];
  for (int row = 0; row < 3; row++)
    for (int k = 0; k < 4; k++)
      joined[row][k] = outer[row][0] * inner[0][k] + outer[row][1] * inner[1][k] + outer[row][2] * inner[2][k] +
                       (k == 3 ? outer[row][3] : 0.0);
  memcpy(inner, joined, sizeof joined);
}

/* A camera's place: its axes in the world, of any length. */
static conic_status find_camera_place(const gltf_camera_reader *reader, const gltf_camera_node *node,
                                      double place[3][4]) {
  static const char no_rotation[] = "a node's rotation is none";
  if (!find_node_matrix(node, place))
    return gltf_camera_wrong(reader, no_rotation);
  for (int depth = 0; node->parent >= 0.0; depth++) {
    double outer[3][4];
    node = &reader->nodes[(size_t)node->parent];
    if (depth == MOST_NODE_DEPTH)
      return gltf_camera_wrong(reader, "nodes are nested too deeply");
    if (!find_node_matrix(node, outer))
      return gltf_camera_wrong(reader, no_rotation);
    join_matrices((const double(*)[4])outer, place);
  }
  for (int k = 0; k < 3; k++) {
    double column[3] = {place[0][k], place[1][k], place[2][k]}, length = conic_length(column);
    int is_unit = fabs(length - 1.0) < 1e-12; /* then it stays, to the bit */
    for (int row = 0; row < 3 && !is_unit; row++)
      place[row][k] /= length; /* NaN for zero length, which is refused */
  }
  return CONIC_OK;
}

/* --- cameras --- */

/* 1024 pixels high, as wide as the camera says. */
static void choose_gltf_size(const conic_camera_list *list, double aspect, conic_camera *camera) {
  double width = (double)(int)((aspect > 0.0 && aspect < 64.0 ? aspect : 1.0) * DEFAULT_HEIGHT + 0.5);
  camera->width = list->options.width ? list->options.width : width >= 1.0 ? (int)width : 1;
  camera->height = list->options.width ? list->options.height : DEFAULT_HEIGHT;
}

static void take_gltf_lens(const conic_camera_list *list, const gltf_lens *lens, conic_camera *camera) {
  if (lens->is_orthographic) {
    choose_gltf_size(list, lens->half_width / lens->half_height, camera);
    camera->kind = CONIC_CAMERA_ORTHOGRAPHIC;
    camera->fx = 0.5 * camera->width / lens->half_width;
    camera->fy = 0.5 * camera->height / lens->half_height;
  } else {
    int is_angle = lens->angle_y_rad > 0.0 && lens->angle_y_rad < CONIC_PI;
    choose_gltf_size(list, lens->aspect, camera);
    camera->fx = camera->fy = is_angle ? 0.5 * camera->height / conic_tan(0.5 * lens->angle_y_rad) : 0.0;
  }
  camera->cx = 0.5 * camera->width;
  camera->cy = 0.5 * camera->height;
}

static conic_status add_gltf_cameras(gltf_camera_reader *reader) {
  conic_status status = link_nodes(reader);
  for (size_t i = 0; i < reader->n_nodes && status == CONIC_OK; i++) {
    const gltf_camera_node *node = &reader->nodes[i];
    conic_camera camera = {.width = 0};
    double place[3][4];
    if (node->camera == NO_NODE)
      continue;
    reader->list->line = node->line;
    if (!is_index_of(node->camera, reader->n_lenses))
      return gltf_camera_wrong(reader, "a node's camera is not there");
    take_gltf_lens(reader->list, &reader->lenses[(size_t)node->camera], &camera);
    status = find_camera_place(reader, node, place);
    if (status == CONIC_OK) {
      conic_camera_place_opengl((const double(*)[4])place, &camera);
      status = conic_camera_list_add(reader->list, &camera, node->name, strlen(node->name));
    }
  }
  if (status == CONIC_OK && reader->list->cameras->count == 0)
    return gltf_camera_wrong(reader, "there are no cameras at its nodes");
  return status;
}

/* The JSON of a .gltf, or of the first chunk of a .glb. */
static conic_status open_gltf_json(gltf_camera_reader *reader, const unsigned char *bytes, size_t n_bytes) {
  size_t from = 0, n = n_bytes;
  if (n_bytes >= 4 && memcmp(bytes, "glTF", 4) == 0) {
    from = 20;
    n = n_bytes < 20 ? 0 : (size_t)conic_load_32(bytes + 12);
    if (n_bytes < 20 || n > n_bytes - 20 || memcmp(bytes + 16, "JSON", 4) != 0)
      return gltf_camera_wrong(reader, "the GLB does not begin with its JSON (at byte 12)");
  }
  return conic_json_take(reader->list->context, reader->list->name, bytes + from, n, &reader->json);
}

conic_status conic_camera_gltf_read(conic_camera_list *list, const unsigned char *bytes, size_t n_bytes) {
  gltf_camera_reader reader = {.list = list};
  list->cameras->kind = CONIC_CAMERA_FILE_GLTF;
  conic_status status = open_gltf_json(&reader, bytes, n_bytes);
  if (status != CONIC_OK)
    return status;
  status = read_gltf_json(&reader);
  if (status == CONIC_OK)
    status = add_gltf_cameras(&reader);
  conic_memory_release_these(list->context, reader.lenses, reader.nodes, reader.children);
  conic_json_close(&reader.json);
  return status;
}
