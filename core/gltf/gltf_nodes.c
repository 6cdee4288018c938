/* Nodes: which are in the scene, and where. */
#include "core/base/vectors.h"
#include "core/gltf/gltf.h"

static const double at_origin[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};

static int place_by(const double translation[3], const double rotation[4], const double scale[3], double rows[3][4]) {
  const double quaternion[4] = {rotation[3], rotation[0], rotation[1], rotation[2]};
  const double square = conic_dot(rotation, rotation) + rotation[3] * rotation[3];
  const double length = fabs(square - 1.0) < 1e-6 ? 1.0 : sqrt(square); /* what is rounded stays as it is */
  double turn[3][3], unit[4];
  if (!(square > 0.0) || !conic_is_finite(square))
    return 0;
  for (int k = 0; k < 4; k++)
    unit[k] = quaternion[k] / length;
  conic_rotation_of(unit, turn);
  for (int row = 0; row < 3; row++) {
    for (int k = 0; k < 3; k++)
      rows[row][k] = turn[row][k] * scale[k];
    rows[row][3] = translation[row];
  }
  return 1;
}

int conic_gltf_place_of(const conic_gltf_node *node, double rows[3][4]) {
  if (node->matrix[15] == 0.0)
    return place_by(node->translation, node->rotation, node->scale, rows);
  for (int row = 0; row < 3; row++)
    for (int k = 0; k < 4; k++)
      rows[row][k] = node->matrix[4 * k + row];
  return 1;
}

void conic_gltf_join_places(const double outer[3][4], const double inner[3][4], double joined[3][4]) {
  double made[3][4];
  for (int row = 0; row < 3; row++)
    for (int k = 0; k < 4; k++)
      made[row][k] = outer[row][0] * inner[0][k] + outer[row][1] * inner[1][k] + outer[row][2] * inner[2][k] +
                     (k == 3 ? outer[row][3] : 0.0);
  memcpy(joined, made, sizeof made);
}

conic_status conic_gltf_link_nodes(conic_gltf *gltf) {
  const conic_gltf_list *nodes = &gltf->lists[CONIC_GLTF_NODES];
  for (size_t i = 0; i < nodes->n; i++) {
    const conic_gltf_slice children = ((conic_gltf_node *)nodes->items)[i].children;
    for (size_t k = 0; k < children.n; k++) {
      double number = *(double *)conic_gltf_item(gltf, CONIC_GLTF_NUMBERS, children, k);
      conic_gltf_node *child = conic_gltf_at(gltf, CONIC_GLTF_NODES, number);
      if (!child)
        return conic_gltf_wrong(gltf, "a node's child is not there");
      if (child->parent != SIZE_MAX)
        return conic_gltf_wrong(gltf, "a node is the child of two");
      child->parent = i;
    }
  }
  return CONIC_OK;
}

/* --- the scene --- */

typedef struct node_stack {
  size_t *nodes;
  size_t n, room;
} node_stack;

/* Puts nodes on the stack so that the first of them comes off first. */
static conic_status push_nodes(const conic_gltf *gltf, conic_gltf_slice numbers, node_stack *stack) {
  conic_status status = conic_memory_reserve(gltf->context, &stack->nodes, stack->n, stack->n + numbers.n, &stack->room,
                                             sizeof *stack->nodes);
  for (size_t k = numbers.n; status == CONIC_OK && k-- > 0;)
    stack->nodes[stack->n++] = (size_t) * (double *)conic_gltf_item(gltf, CONIC_GLTF_NUMBERS, numbers, k);
  return status;
}

/* Of each node that is reached: its place in the world, and whether it is visible. */
static conic_status place_node(const conic_gltf *gltf, conic_gltf_node *node) {
  const conic_gltf_node *parent =
      node->parent == SIZE_MAX ? NULL : (conic_gltf_node *)gltf->lists[CONIC_GLTF_NODES].items + node->parent;
  double own[3][4];
  if (!conic_gltf_place_of(node, own))
    return conic_gltf_wrong(gltf, "a node's rotation is none (line %llu)", (unsigned long long)node->line);
  conic_gltf_join_places(parent ? (const double(*)[4])parent->world : at_origin, (const double(*)[4])own, node->world);
  node->is_visible &= parent ? parent->is_visible : 1;
  node->is_placed = 1;
  return CONIC_OK;
}

static conic_status find_instances(conic_gltf *gltf, const conic_gltf_node *node, conic_gltf_array arrays[3],
                                   size_t *count) {
  static const char *const names[] = {"TRANSLATION", "ROTATION", "SCALE"};
  conic_status status = CONIC_OK;
  int is_counted = 0;
  *count = 0;
  for (int i = 0; i < 3 && status == CONIC_OK; i++) {
    double accessor = conic_gltf_find(gltf, node->instances, names[i]);
    if (accessor == CONIC_GLTF_NONE)
      continue;
    status = conic_gltf_open_array(gltf, accessor, &arrays[i]);
    if (status == CONIC_OK && (arrays[i].n != (i == 1 ? 4 : 3) || (is_counted && *count != arrays[i].count)))
      return conic_gltf_wrong(gltf, "the %s of instances are of another type or number", names[i]);
    *count = arrays[i].count;
    is_counted = 1;
  }
  return status;
}

static conic_status visit_instances(conic_gltf *gltf, const conic_gltf_node *node, conic_gltf_visit *visit,
                                    void *cookie) {
  conic_gltf_array arrays[3] = {{NULL}, {NULL}, {NULL}};
  size_t count;
  conic_status status = find_instances(gltf, node, arrays, &count);
  for (size_t i = 0; status == CONIC_OK && i < count; i++) {
    double numbers[3][4] = {{0, 0, 0}, {0, 0, 0, 1}, {1, 1, 1}}, own[3][4], world[3][4];
    for (int k = 0; k < 3; k++)
      for (int c = 0; arrays[k].bytes && c < arrays[k].n; c++)
        numbers[k][c] = conic_gltf_value(&arrays[k], i, c);
    if (!place_by(numbers[0], numbers[1], numbers[2], own))
      status = conic_gltf_wrong(gltf, "the rotation of instance %zu is none", i);
    else {
      conic_gltf_join_places((const double(*)[4])node->world, (const double(*)[4])own, world);
      status = visit(cookie, node, (const double(*)[4])world);
    }
  }
  for (int i = 0; i < 3; i++)
    conic_gltf_close_array(gltf, &arrays[i]);
  return status;
}

static conic_status visit_node(conic_gltf *gltf, const conic_gltf_node *node, conic_gltf_visit *visit, void *cookie) {
  if (!node->is_visible || node->mesh == CONIC_GLTF_NONE)
    return CONIC_OK;
  if (!conic_gltf_at(gltf, CONIC_GLTF_MESHES, node->mesh))
    return conic_gltf_wrong(gltf, "a node's mesh is not there (line %llu)", (unsigned long long)node->line);
  return node->has_instances ? visit_instances(gltf, node, visit, cookie)
                             : visit(cookie, node, (const double(*)[4])node->world);
}

/* Places all nodes from those on the stack down, and those that hang from them. */
static conic_status place_below(conic_gltf *gltf, node_stack *stack) {
  conic_status status = CONIC_OK;
  while (status == CONIC_OK && stack->n > 0) {
    conic_gltf_node *node = (conic_gltf_node *)gltf->lists[CONIC_GLTF_NODES].items + stack->nodes[--stack->n];
    status = place_node(gltf, node);
    if (status == CONIC_OK)
      status = push_nodes(gltf, node->children, stack);
  }
  return status;
}

/* Places all that hangs from nodes without a parent: skins may need it, wherever it is. */
static conic_status place_all(conic_gltf *gltf, node_stack *stack) {
  const conic_gltf_list *list = &gltf->lists[CONIC_GLTF_NODES];
  conic_gltf_node *nodes = list->items;
  conic_status status = CONIC_OK;
  for (size_t i = 0; status == CONIC_OK && i < list->n; i++) {
    if (nodes[i].parent != SIZE_MAX || nodes[i].is_placed)
      continue;
    status = conic_memory_reserve(gltf->context, &stack->nodes, 0, 1, &stack->room, sizeof *stack->nodes);
    if (status == CONIC_OK) {
      stack->nodes[stack->n++] = i;
      status = place_below(gltf, stack);
    }
  }
  return status;
}

/* The roots of the scene; of a file without scenes, all. */
static conic_status push_scene(conic_gltf *gltf, node_stack *stack) {
  const conic_gltf_list *nodes = &gltf->lists[CONIC_GLTF_NODES];
  const conic_gltf_scene *scene =
      conic_gltf_at(gltf, CONIC_GLTF_SCENES, gltf->scene == CONIC_GLTF_NONE ? 0.0 : gltf->scene);
  if (!scene && gltf->scene != CONIC_GLTF_NONE)
    return conic_gltf_wrong(gltf, "its scene is not there");
  if (scene) {
    for (size_t k = 0; k < scene->nodes.n; k++) {
      const conic_gltf_node *node =
          conic_gltf_at(gltf, CONIC_GLTF_NODES, *(double *)conic_gltf_item(gltf, CONIC_GLTF_NUMBERS, scene->nodes, k));
      if (!node || node->parent != SIZE_MAX)
        return conic_gltf_wrong(gltf, "a scene's node is not there, or is the child of another");
    }
    return push_nodes(gltf, scene->nodes, stack);
  }
  conic_status status =
      conic_memory_reserve(gltf->context, &stack->nodes, 0, nodes->n, &stack->room, sizeof *stack->nodes);
  for (size_t i = nodes->n; status == CONIC_OK && i-- > 0;)
    if (((conic_gltf_node *)nodes->items)[i].parent == SIZE_MAX)
      stack->nodes[stack->n++] = i;
  return status;
}

static conic_status visit_scene(conic_gltf *gltf, node_stack *stack, conic_gltf_visit *visit, void *cookie) {
  conic_status status = push_scene(gltf, stack);
  while (status == CONIC_OK && stack->n > 0) {
    const conic_gltf_node *node = (conic_gltf_node *)gltf->lists[CONIC_GLTF_NODES].items + stack->nodes[--stack->n];
    status = visit_node(gltf, node, visit, cookie);
    if (status == CONIC_OK)
      status = push_nodes(gltf, node->children, stack);
  }
  return status;
}

conic_status conic_gltf_visit_meshes(conic_gltf *gltf, conic_gltf_visit *visit, void *cookie) {
  node_stack stack = {NULL, 0, 0};
  conic_gltf_node alone = {.is_visible = 1, .skin = CONIC_GLTF_NONE};
  memcpy(alone.world, at_origin, sizeof at_origin);
  conic_status status = place_all(gltf, &stack);
  if (status == CONIC_OK && gltf->lists[CONIC_GLTF_NODES].n)
    status = visit_scene(gltf, &stack, visit, cookie);
  else
    for (size_t i = 0; status == CONIC_OK && i < gltf->lists[CONIC_GLTF_MESHES].n; i++) {
      alone.mesh = (double)i;
      status = visit_node(gltf, &alone, visit, cookie);
    }
  conic_memory_release(gltf->context, stack.nodes);
  return status;
}
