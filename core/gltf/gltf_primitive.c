/* A primitive's vertices, as its file's morph targets and skins have them at rest, and its triangles. */
#include "core/base/byte_order.h"
#include "core/base/trigonometry.h"
#include "core/base/vectors.h"
#include "core/gltf/gltf_read.h"

/* --- attributes --- */

typedef struct gltf_numbers {
  double *values;
  size_t count;
  int n;
} gltf_numbers;

/* What Draco has packed, as an array of floats; of integers that the accessor calls normalized, parts of 1. */
static conic_status open_draco_array(conic_gltf_reader *reader, double id, const conic_gltf_accessor *accessor, int n,
                                     conic_gltf_array *array) {
  static const float most[] = {127.0f, 255.0f, 32767.0f, 65535.0f};
  const conic_draco_mesh *mesh = &reader->draco;
  const int i_type =
      conic_gltf_is_index(accessor->component, CONIC_GLTF_FLOAT) ? (int)accessor->component - CONIC_GLTF_INT8 : -1;
  const size_t n_values = mesh->n_vertices * (size_t)n;
  float *values = conic_memory_allocate(reader->gltf.context, n_values, sizeof *values);
  *array = (conic_gltf_array){.bytes = (unsigned char *)values, .own = (unsigned char *)values, .n = n};
  if (!values)
    return CONIC_ERROR_MEMORY;
  array->stride = (size_t)n * sizeof *values;
  array->count = mesh->n_vertices;
  array->component = CONIC_GLTF_FLOAT;
  if (!conic_gltf_is_index(id, UINT32_MAX) || !conic_draco_load()->attribute(mesh, (uint32_t)id, n, values))
    return conic_gltf_wrong(&reader->gltf, "what Draco has packed has other attributes than the file says");
  for (size_t i = 0; i < n_values && accessor->is_normalized && i_type >= 0 && i_type < 4; i++)
    values[i] /= most[i_type];
  conic_turn_words(values, n_values, sizeof *values);
  return CONIC_OK;
}

/* Adds `share` times an array, which is closed, to numbers that begin as zeros, or as those of other arrays. */
static void add_array(const conic_gltf *gltf, conic_gltf_array *array, double share, gltf_numbers *numbers) {
  for (size_t i = 0; i < numbers->count; i++)
    for (int k = 0; k < numbers->n; k++)
      numbers->values[i * (size_t)numbers->n + (size_t)k] += share * conic_gltf_value(array, i, k);
  conic_gltf_close_array(gltf, array);
}

static conic_gltf_slice weights_of(const conic_gltf *gltf, const conic_gltf_node *node) {
  const conic_gltf_mesh *mesh = conic_gltf_at(gltf, CONIC_GLTF_MESHES, node->mesh);
  return node->weights.n ? node->weights : mesh->weights;
}

static conic_status add_targets(conic_gltf_reader *reader, const conic_gltf_node *node,
                                const conic_gltf_primitive *primitive, const char *name, gltf_numbers *numbers) {
  conic_gltf *gltf = &reader->gltf;
  const conic_gltf_slice weights = weights_of(gltf, node);
  conic_status status = CONIC_OK;
  for (size_t i = 0; status == CONIC_OK && i < primitive->targets.n && i < weights.n; i++) {
    const conic_gltf_target *target = conic_gltf_item(gltf, CONIC_GLTF_TARGETS, primitive->targets, i);
    double share = *(double *)conic_gltf_item(gltf, CONIC_GLTF_NUMBERS, weights, i);
    double accessor = conic_gltf_find(gltf, target->attributes, name);
    conic_gltf_array array;
    if (share == 0.0 || accessor == CONIC_GLTF_NONE)
      continue;
    status = conic_gltf_open_array(gltf, accessor, &array);
    if (status == CONIC_OK && (array.count != numbers->count || array.n < numbers->n))
      status = conic_gltf_wrong(gltf, "a morph target has another number of %s than its mesh", name);
    if (status == CONIC_OK)
      add_array(gltf, &array, share, numbers);
    else
      conic_gltf_close_array(gltf, &array);
  }
  return status;
}

/* An attribute of a primitive, of `least` to `most` components; none where it has no such attribute. All have as many
 * items as the places, which are read first. The caller releases the values. */
static conic_status read_attribute(conic_gltf_reader *reader, const conic_gltf_node *node,
                                   const conic_gltf_primitive *primitive, const char *name, int least, int most,
                                   gltf_numbers *numbers) {
  conic_gltf *gltf = &reader->gltf;
  const double number = conic_gltf_find(gltf, primitive->attributes, name);
  const double packed = reader->draco.mesh ? conic_gltf_find(gltf, primitive->draco_attributes, name) : CONIC_GLTF_NONE;
  const conic_gltf_accessor *accessor = conic_gltf_at(gltf, CONIC_GLTF_ACCESSORS, number);
  const int is_position = strcmp(name, "POSITION") == 0;
  conic_gltf_array array;
  *numbers = (gltf_numbers){NULL, 0, 0};
  if (number == CONIC_GLTF_NONE)
    return CONIC_OK;
  const int n = accessor && strncmp(accessor->type, "VEC", 3) == 0 ? accessor->type[3] - '0' : 0;
  if (n < least || n > most)
    return conic_gltf_wrong(gltf, "the accessor of %s is not there, or of another type than it has", name);
  if (is_position && accessor->view == CONIC_GLTF_NONE && accessor->n_sparse == 0.0 && packed == CONIC_GLTF_NONE)
    return conic_gltf_wrong(gltf, "a primitive's positions have no data");
  conic_status status = packed == CONIC_GLTF_NONE ? conic_gltf_open_array(gltf, number, &array)
                                                  : open_draco_array(reader, packed, accessor, n, &array);
  if (status == CONIC_OK && ((double)array.count != (is_position ? accessor->count : (double)reader->part.n_vertices) ||
                             array.count > CONIC_MAX_POINTS))
    status = conic_gltf_wrong(gltf, "%zu items of %s, where there should be another number", array.count, name);
  if (status == CONIC_OK) {
    *numbers = (gltf_numbers){conic_memory_allocate_zeroed(gltf->context, array.count * (size_t)n, sizeof(double)),
                              array.count, n};
    status = numbers->values ? CONIC_OK : CONIC_ERROR_MEMORY;
  }
  if (status != CONIC_OK) {
    conic_gltf_close_array(gltf, &array);
    return status;
  }
  add_array(gltf, &array, 1.0, numbers);
  return add_targets(reader, node, primitive, name, numbers);
}

/* --- places --- */

static void put_vertex(const double place[3][4], const double p[3], double to[3]) {
  for (int row = 0; row < 3; row++)
    to[row] = place[row][0] * p[0] + place[row][1] * p[1] + place[row][2] * p[2] + place[row][3];
}

static void put_normal(const double rows[3][3], const double n[3], float to[3]) {
  for (int row = 0; row < 3; row++)
    to[row] = (float)(rows[row][0] * n[0] + rows[row][1] * n[1] + rows[row][2] * n[2]);
}

/* The joints' matrices at rest, by their nodes and the skin's inverses. */
static conic_status find_joints(conic_gltf *gltf, const conic_gltf_skin *skin, double (**joints)[3][4]) {
  conic_gltf_array inverses = {NULL};
  conic_status status =
      skin->inverses == CONIC_GLTF_NONE ? CONIC_OK : conic_gltf_open_array(gltf, skin->inverses, &inverses);
  if (status == CONIC_OK && inverses.bytes && (inverses.n != 16 || inverses.count < skin->joints.n))
    status = conic_gltf_wrong(gltf, "a skin has fewer matrices than joints");
  *joints = status == CONIC_OK ? conic_memory_allocate(gltf->context, skin->joints.n, sizeof **joints) : NULL;
  if (status == CONIC_OK && !*joints)
    status = CONIC_ERROR_MEMORY;
  for (size_t i = 0; status == CONIC_OK && i < skin->joints.n; i++) {
    double number = *(double *)conic_gltf_item(gltf, CONIC_GLTF_NUMBERS, skin->joints, i), inverse[3][4] = {{0}};
    const conic_gltf_node *node = conic_gltf_at(gltf, CONIC_GLTF_NODES, number);
    if (!node || !node->is_placed)
      status = conic_gltf_wrong(gltf, "a skin's joint is not there");
    for (int row = 0; row < 3; row++)
      for (int k = 0; k < 4; k++)
        inverse[row][k] = inverses.bytes ? conic_gltf_value(&inverses, i, 4 * k + row) : k == row;
    if (status == CONIC_OK)
      conic_gltf_join_places((const double(*)[4])node->world, (const double(*)[4])inverse, (*joints)[i]);
  }
  conic_gltf_close_array(gltf, &inverses);
  return status;
}

/* Adds what a set of four joints has of each vertex's place: 12 numbers, and their weights' sum. */
static conic_status add_influences(conic_gltf_reader *reader, const conic_gltf_node *node,
                                   const conic_gltf_primitive *primitive, int set, size_t n_joints,
                                   double (*const joints)[3][4], size_t count, double (*sums)[13]) {
  char names[2][24];
  gltf_numbers of_joints, weights = {NULL, 0, 0};
  snprintf(names[0], sizeof names[0], "JOINTS_%d", set);
  snprintf(names[1], sizeof names[1], "WEIGHTS_%d", set);
  conic_status status = read_attribute(reader, node, primitive, names[0], 4, 4, &of_joints);
  if (status == CONIC_OK)
    status = read_attribute(reader, node, primitive, names[1], 4, 4, &weights);
  if (status == CONIC_OK && (!of_joints.values || !weights.values))
    status = conic_gltf_wrong(&reader->gltf, "%s is not there", names[1]);
  for (size_t i = 0; status == CONIC_OK && i < 4 * count; i++) {
    const double weight = weights.values[i], joint = of_joints.values[i];
    if (weight == 0.0)
      continue;
    if (!conic_gltf_is_index(joint, n_joints))
      status = conic_gltf_wrong(&reader->gltf, "joint %g of a skin that has %zu", joint, n_joints);
    for (size_t k = 0; status == CONIC_OK && k < 12; k++)
      sums[i / 4][k] += weight * joints[(size_t)joint][k / 4][k % 4];
    sums[i / 4][12] += weight;
  }
  conic_memory_release_these(reader->gltf.context, of_joints.values, weights.values);
  return status;
}

/* Where a skin puts each vertex: the weighted mean of what its joints do. */
static conic_status find_influences(conic_gltf_reader *reader, const conic_gltf_node *node,
                                    const conic_gltf_primitive *primitive, size_t count, double (**sums)[13]) {
  conic_gltf *gltf = &reader->gltf;
  const conic_gltf_skin *skin = conic_gltf_at(gltf, CONIC_GLTF_SKINS, node->skin);
  double(*joints)[3][4] = NULL;
  char name[24] = "JOINTS_0";
  *sums = NULL;
  if (node->skin == CONIC_GLTF_NONE || conic_gltf_find(gltf, primitive->attributes, name) == CONIC_GLTF_NONE)
    return CONIC_OK;
  if (!skin)
    return conic_gltf_wrong(gltf, "a node's skin is not there");
  conic_status status = find_joints(gltf, skin, &joints);
  if (status == CONIC_OK) {
    *sums = conic_memory_allocate_zeroed(gltf->context, count, sizeof **sums);
    status = *sums ? CONIC_OK : CONIC_ERROR_MEMORY;
  }
  for (int set = 0; status == CONIC_OK && set < 10; set++) {
    snprintf(name, sizeof name, "JOINTS_%d", set);
    if (conic_gltf_find(gltf, primitive->attributes, name) == CONIC_GLTF_NONE)
      break;
    status = add_influences(reader, node, primitive, set, skin->joints.n, joints, count, *sums);
  }
  conic_memory_release(gltf->context, joints);
  return status;
}

/* Puts vertices and normals where the node, or the skin instead of it, has them. */
static conic_status place_part(conic_gltf_reader *reader, const conic_gltf_node *node,
                               const conic_gltf_primitive *primitive, const double world[3][4],
                               const gltf_numbers *positions, const gltf_numbers *normals, int *is_mirrored) {
  conic_mesh_part *part = &reader->part;
  double(*sums)[13], place[3][4], rows[3][3];
  conic_status status = find_influences(reader, node, primitive, part->n_vertices, &sums);
  memcpy(place, world, sizeof place);
  *is_mirrored = conic_normal_rows((const double(*)[4])place, rows);
  for (size_t i = 0; status == CONIC_OK && i < part->n_vertices; i++) {
    if (sums && sums[i][12] != 0.0) {
      for (int k = 0; k < 12; k++)
        place[k / 4][k % 4] = sums[i][k] / sums[i][12];
      int is_turned = conic_normal_rows((const double(*)[4])place, rows);
      *is_mirrored = i == 0 ? is_turned : *is_mirrored;
    }
    put_vertex((const double(*)[4])place, positions->values + 3 * i, part->position[i]);
    if (part->normal && normals->values)
      put_normal((const double(*)[3])rows, normals->values + 3 * i, part->normal[i]);
  }
  conic_memory_release(reader->gltf.context, sums);
  return status;
}

/* --- vertices --- */

/* The picture's lower left corner is (0, 0) here, and in the file its upper left one. */
static void put_coordinates(const conic_gltf_texture_use *use, const gltf_numbers *numbers, float (*to)[2]) {
  const double c = conic_cos(use->rotation), s = conic_sin(use->rotation);
  const int is_as_it_is = use->rotation == 0.0 && use->scale[0] == 1.0 && use->scale[1] == 1.0 &&
                          use->offset[0] == 0.0 && use->offset[1] == 0.0;
  for (size_t i = 0; i < numbers->count; i++) {
    double u = numbers->values[2 * i], v = numbers->values[2 * i + 1];
    if (!is_as_it_is) {
      const double x = use->scale[0] * u, y = use->scale[1] * v;
      u = use->offset[0] + (c * x + s * y);
      v = use->offset[1] + (c * y - s * x);
    }
    to[i][0] = (float)u;
    to[i][1] = 1.0f - (float)v;
  }
}

static conic_status read_coordinates(conic_gltf_reader *reader, const conic_gltf_node *node,
                                     const conic_gltf_primitive *primitive) {
  conic_gltf *gltf = &reader->gltf;
  const conic_gltf_texture_use *use = &reader->part_use;
  conic_mesh_part *part = &reader->part;
  double set = use->other_set != CONIC_GLTF_NONE ? use->other_set : use->set;
  gltf_numbers numbers;
  char name[32];
  snprintf(name, sizeof name, "TEXCOORD_%d", conic_gltf_is_index(set, 1000) ? (int)set : 1000);
  if (conic_gltf_find(gltf, primitive->attributes, name) == CONIC_GLTF_NONE)
    return CONIC_OK;
  conic_status status = read_attribute(reader, node, primitive, name, 2, 2, &numbers);
  if (status == CONIC_OK) {
    part->coordinate = conic_memory_allocate(gltf->context, part->n_vertices, sizeof *part->coordinate);
    status = part->coordinate ? CONIC_OK : CONIC_ERROR_MEMORY;
  }
  if (status == CONIC_OK)
    put_coordinates(use, &numbers, part->coordinate);
  conic_memory_release(gltf->context, numbers.values);
  return status;
}

/* Integer colours are parts of 1, whether the accessor says so or not. */
static double color_scale(const conic_gltf *gltf, const conic_gltf_primitive *primitive) {
  const conic_gltf_accessor *accessor =
      conic_gltf_at(gltf, CONIC_GLTF_ACCESSORS, conic_gltf_find(gltf, primitive->attributes, "COLOR_0"));
  if (!accessor || accessor->is_normalized)
    return 1.0;
  return accessor->component == CONIC_GLTF_UINT8 ? 255.0 : accessor->component == CONIC_GLTF_UINT16 ? 65535.0 : 1.0;
}

static conic_status read_colors(conic_gltf_reader *reader, const conic_gltf_node *node,
                                const conic_gltf_primitive *primitive) {
  conic_gltf *gltf = &reader->gltf;
  conic_mesh_part *part = &reader->part;
  const double scale = color_scale(gltf, primitive);
  gltf_numbers colors;
  conic_status status = read_attribute(reader, node, primitive, "COLOR_0", 3, 4, &colors);
  if (status == CONIC_OK && colors.values) {
    const int has_alpha = reader->options->keeps_alpha && colors.n == 4;
    status = conic_memory_allocate_these(gltf->context, CONIC_ROOM(part->color, part->n_vertices),
                                         CONIC_ROOM(part->alpha, has_alpha ? part->n_vertices : 0));
    if (!has_alpha) {
      conic_memory_release(gltf->context, part->alpha);
      part->alpha = NULL;
    }
  }
  for (size_t i = 0; status == CONIC_OK && colors.values && i < colors.count; i++) {
    const double *color = colors.values + i * (size_t)colors.n;
    for (int channel = 0; channel < 3; channel++)
      part->color[i][channel] = (float)(color[channel] / scale);
    if (part->alpha)
      part->alpha[i] = (float)(color[3] / scale);
  }
  conic_memory_release(gltf->context, colors.values);
  return status;
}

static conic_status read_part(conic_gltf_reader *reader, const conic_gltf_node *node,
                              const conic_gltf_primitive *primitive, const double world[3][4], int *is_mirrored) {
  conic_gltf *gltf = &reader->gltf;
  conic_mesh_part *part = &reader->part;
  gltf_numbers positions, normals = {NULL, 0, 0};
  conic_status status = read_attribute(reader, node, primitive, "POSITION", 3, 3, &positions);
  part->n_vertices = positions.count;
  if (status == CONIC_OK)
    status = read_attribute(reader, node, primitive, "NORMAL", 3, 3, &normals);
  if (status == CONIC_OK && positions.count > 0) {
    part->position = conic_memory_allocate(gltf->context, positions.count, sizeof *part->position);
    part->normal = normals.values ? conic_memory_allocate(gltf->context, positions.count, sizeof *part->normal) : NULL;
    status = part->position && (part->normal || !normals.values) ? CONIC_OK : CONIC_ERROR_MEMORY;
  }
  if (status == CONIC_OK && positions.values)
    status = place_part(reader, node, primitive, world, &positions, &normals, is_mirrored);
  conic_memory_release_these(gltf->context, positions.values, normals.values);
  if (status == CONIC_OK && reader->options->keeps_faces)
    status = read_coordinates(reader, node, primitive);
  return status == CONIC_OK ? read_colors(reader, node, primitive) : status;
}

/* --- triangles --- */

typedef struct gltf_corners {
  uint32_t *indices; /* null: every vertex in its order */
  size_t n;
} gltf_corners;

static conic_status read_corners(conic_gltf_reader *reader, const conic_gltf_primitive *primitive,
                                 gltf_corners *corners) {
  conic_gltf *gltf = &reader->gltf;
  conic_gltf_array array = {NULL};
  *corners = (gltf_corners){NULL, reader->part.n_vertices};
  if (primitive->indices == CONIC_GLTF_NONE && !reader->draco.mesh)
    return CONIC_OK;
  conic_status status = reader->draco.mesh ? CONIC_OK : conic_gltf_open_array(gltf, primitive->indices, &array);
  if (status == CONIC_OK && !reader->draco.mesh &&
      (array.n != 1 || (array.component != CONIC_GLTF_UINT8 && array.component != CONIC_GLTF_UINT16 &&
                        array.component != CONIC_GLTF_UINT32)))
    status = conic_gltf_wrong(gltf, "the indices of a primitive are of another type than they have");
  array.is_normalized = 0;
  corners->n = reader->draco.mesh ? 3 * reader->draco.n_triangles : array.count;
  if (status == CONIC_OK) {
    corners->indices = conic_memory_allocate(gltf->context, corners->n, sizeof *corners->indices);
    status = corners->indices ? CONIC_OK : CONIC_ERROR_MEMORY;
  }
  if (status == CONIC_OK && reader->draco.mesh)
    conic_draco_load()->triangles(&reader->draco, (uint32_t(*)[3])(void *)corners->indices);
  for (size_t i = 0; status == CONIC_OK && !reader->draco.mesh && i < corners->n; i++)
    corners->indices[i] = (uint32_t)conic_gltf_value(&array, i, 0);
  conic_gltf_close_array(gltf, &array);
  return status;
}

/* The corners of triangle i by the mode: a list, a strip, whose every second triangle is turned round, or a fan. */
static void find_triangle(const gltf_corners *corners, int mode, size_t i, uint32_t triangle[3]) {
  const size_t strip = i % 2, at[3] = {mode == 4   ? 3 * i
                                       : mode == 5 ? i + strip
                                                   : 0,
                                       mode == 4   ? 3 * i + 1
                                       : mode == 5 ? i + 1 - strip
                                                   : i + 1,
                                       mode == 4 ? 3 * i + 2 : i + 2};
  for (int k = 0; k < 3; k++)
    triangle[k] = corners->indices ? corners->indices[at[k]] : (uint32_t)at[k];
}

static conic_status add_triangles(conic_gltf_reader *reader, const conic_gltf_primitive *primitive, int is_mirrored) {
  gltf_corners corners;
  conic_status status = read_corners(reader, primitive, &corners);
  const int mode = reader->draco.mesh ? 4 : (int)primitive->mode;
  const size_t n = mode == 4 ? corners.n / 3 : corners.n < 3 ? 0 : corners.n - 2;
  for (size_t i = 0; status == CONIC_OK && i < n; i++) {
    uint32_t triangle[1][3];
    find_triangle(&corners, mode, i, triangle[0]);
    if (is_mirrored) {
      const uint32_t second = triangle[0][1];
      triangle[0][1] = triangle[0][2];
      triangle[0][2] = second;
    }
    status = conic_mesh_parts_add_triangles(&reader->parts, &reader->part, (const uint32_t(*)[3])triangle, 1);
  }
  conic_memory_release(reader->gltf.context, corners.indices);
  return status;
}

/* --- primitives --- */

/* Whether the vertices that were added last are this primitive's, too. */
static int is_shared(const conic_gltf_reader *reader, const conic_gltf_primitive *primitive,
                     const conic_gltf_texture_use *use, const double world[3][4]) {
  const conic_gltf_primitive *last = reader->part_primitive;
  if (!last || last->attributes.n != primitive->attributes.n || last->targets.n || primitive->targets.n ||
      last->draco_view != CONIC_GLTF_NONE || primitive->draco_view != CONIC_GLTF_NONE ||
      memcmp(reader->part_world, world, sizeof reader->part_world) != 0 ||
      memcmp(&reader->part_use, use, sizeof *use) != 0)
    return 0;
  for (size_t i = 0; i < last->attributes.n; i++) {
    const conic_gltf_attribute *of_last = conic_gltf_item(&reader->gltf, CONIC_GLTF_ATTRIBUTES, last->attributes, i);
    if (conic_gltf_find(&reader->gltf, primitive->attributes, of_last->name) != of_last->accessor)
      return 0;
  }
  return 1;
}

static conic_status open_draco(conic_gltf_reader *reader, const conic_gltf_primitive *primitive) {
  conic_gltf *gltf = &reader->gltf;
  conic_gltf_bytes view;
  if (primitive->draco_view == CONIC_GLTF_NONE)
    return CONIC_OK;
  if (!conic_draco_load())
    return conic_gltf_wrong(gltf, "KHR_draco_mesh_compression cannot be read: libdraco is missing");
  conic_status status = conic_gltf_open_view(gltf, primitive->draco_view, &view);
  if (status == CONIC_OK)
    reader->draco = conic_draco_load()->open(view.bytes, view.n_bytes);
  return status == CONIC_OK && !reader->draco.mesh ? conic_gltf_wrong(gltf, "what Draco has packed is spoiled")
                                                   : status;
}

/* Vertices of a skin, or of targets, are the node's own. */
static conic_status add_vertices(conic_gltf_reader *reader, const conic_gltf_node *node,
                                 const conic_gltf_primitive *primitive, const double world[3][4], int *is_mirrored) {
  conic_mesh_part *part = &reader->part;
  conic_mesh_part_release(reader->gltf.context, part);
  reader->part_primitive = NULL;
  memcpy(reader->part_world, world, sizeof reader->part_world);
  part->is_points = primitive->mode == 0.0;
  conic_status status = read_part(reader, node, primitive, world, is_mirrored);
  if (status == CONIC_OK && part->n_vertices > 0)
    status = conic_mesh_parts_add(&reader->parts, part);
  if (status == CONIC_OK && node->skin == CONIC_GLTF_NONE && !part->is_points)
    reader->part_primitive = primitive;
  return status;
}

conic_status conic_gltf_add_primitive(conic_gltf_reader *reader, const conic_gltf_node *node,
                                      const conic_gltf_primitive *primitive, const double world[3][4]) {
  conic_gltf *gltf = &reader->gltf;
  const conic_gltf_texture_use *found =
      conic_gltf_color_texture(gltf, conic_gltf_at(gltf, CONIC_GLTF_MATERIALS, primitive->material));
  conic_gltf_texture_use use = found ? *found : conic_gltf_no_material.base;
  double rows[3][3];
  int is_mirrored = conic_normal_rows(world, rows);
  if (conic_gltf_find(gltf, primitive->attributes, "POSITION") == CONIC_GLTF_NONE)
    return CONIC_OK; /* as the specification says */
  use.texture = 0.0; /* whose coordinates these are does not matter */
  conic_status status = reader->parts.faces ? conic_gltf_use_material(reader, primitive->material) : CONIC_OK;
  if (status == CONIC_OK && !is_shared(reader, primitive, &use, world)) {
    status = open_draco(reader, primitive);
    reader->part_use = use;
    if (status == CONIC_OK)
      status = add_vertices(reader, node, primitive, world, &is_mirrored);
  }
  if (status == CONIC_OK && !reader->part.is_points)
    status = add_triangles(reader, primitive, is_mirrored);
  if (reader->draco.mesh)
    conic_draco_load()->close(&reader->draco);
  return status;
}
