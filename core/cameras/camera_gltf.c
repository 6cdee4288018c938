/* The cameras of a glTF: those at its nodes. */

#include "core/base/trigonometry.h"
#include "core/base/vectors.h"
#include "core/cameras/camera_list.h"
#include "core/gltf/gltf.h"

enum { MOST_NODE_DEPTH = 64, DEFAULT_HEIGHT = 1024 };

/* --- places --- */

/* A node's transformation of points: three rows. */
static int find_node_matrix(const conic_gltf_node *node, double rows[3][4]) {
  const double quaternion[4] = {node->rotation[3], node->rotation[0], node->rotation[1], node->rotation[2]};
  double turn[3][3];
  if (node->matrix[15] != 0.0)
    return conic_gltf_place_of(node, rows);
  if (!conic_camera_rotation(quaternion, turn))
    return 0;
  for (int row = 0; row < 3; row++)
    for (int k = 0; k < 4; k++)
      rows[row][k] = k < 3 ? turn[row][k] * node->scale[k] : node->translation[row];
  return 1;
}

/* A camera's place: its axes in the world, of any length. */
static conic_status find_camera_place(const conic_camera_list *list, const conic_gltf *gltf,
                                      const conic_gltf_node *node, double place[3][4]) {
  static const char no_rotation[] = "a node's rotation is none";
  if (!find_node_matrix(node, place))
    return conic_camera_list_wrong(list, no_rotation);
  for (int depth = 0; node->parent != SIZE_MAX; depth++) {
    double outer[3][4];
    node = conic_gltf_at(gltf, CONIC_GLTF_NODES, (double)node->parent);
    if (depth == MOST_NODE_DEPTH)
      return conic_camera_list_wrong(list, "nodes are nested too deeply");
    if (!find_node_matrix(node, outer))
      return conic_camera_list_wrong(list, no_rotation);
    conic_gltf_join_places((const double(*)[4])outer, (const double(*)[4])place, place);
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

static void take_gltf_lens(const conic_camera_list *list, const conic_gltf_camera *lens, conic_camera *camera) {
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

static conic_status add_gltf_camera(conic_camera_list *list, const conic_gltf *gltf, const conic_gltf_node *node) {
  const conic_gltf_camera *lens = conic_gltf_at(gltf, CONIC_GLTF_CAMERAS, node->camera);
  conic_camera camera = {.width = 0};
  double place[3][4];
  list->line = node->line;
  if (!lens)
    return conic_camera_list_wrong(list, "a node's camera is not there");
  take_gltf_lens(list, lens, &camera);
  conic_status status = find_camera_place(list, gltf, node, place);
  if (status != CONIC_OK)
    return status;
  conic_camera_place_opengl((const double(*)[4])place, &camera);
  return conic_camera_list_add(list, &camera, node->name, strlen(node->name));
}

conic_status conic_camera_gltf_read(conic_camera_list *list, const unsigned char *bytes, size_t n_bytes) {
  conic_gltf gltf;
  list->cameras->kind = CONIC_CAMERA_FILE_GLTF;
  conic_status status = conic_gltf_open(list->context, list->name, NULL, bytes, n_bytes, &gltf);
  if (status == CONIC_OK)
    status = conic_gltf_link_nodes(&gltf);
  for (size_t i = 0; status == CONIC_OK && i < gltf.lists[CONIC_GLTF_NODES].n; i++) {
    const conic_gltf_node *node = conic_gltf_at(&gltf, CONIC_GLTF_NODES, (double)i);
    if (node->camera != CONIC_GLTF_NONE)
      status = add_gltf_camera(list, &gltf, node);
  }
  if (status == CONIC_OK && list->cameras->count == 0)
    status = conic_camera_list_wrong(list, "there are no cameras at its nodes");
  conic_gltf_close(&gltf);
  return status;
}
