/* Gaussians in glTF, by KHR_gaussian_splatting and as it was before its name was settled: the points of primitives,
 * where the nodes put them. */

#include "core/base/vectors.h"
#include "gaussians/formats/gaussian_gltf.h"
#include "gaussians/scene/activation.h"

/* --- the data --- */

/* Numbers of one attribute: where they are, and how they are stored. */
typedef struct gltf_numbers {
  const unsigned char *bytes;
  size_t stride, count;
  int type, is_normalized;
} gltf_numbers;

enum { INT8 = 5120, UINT8 = 5121, INT16 = 5122, UINT16 = 5123, FLOAT = 5126 };

static conic_status find_numbers(const conic_gltf_reader *reader, double i_accessor, int n_components,
                                 gltf_numbers *numbers) {
  static const char missing[] = "an accessor of Gaussians names what is not there, or is not of a type that they have";
  memset(numbers, 0, sizeof *numbers);
  if (!conic_gltf_is_index(i_accessor, reader->n_accessors))
    return conic_gltf_wrong(reader, missing);
  const conic_gltf_accessor *accessor = &reader->accessors[(size_t)i_accessor];
  if (!conic_gltf_is_index(accessor->view, reader->n_views) || accessor->is_sparse ||
      accessor->n_components < n_components || accessor->n_components > 4 ||
      !conic_gltf_is_index(accessor->count, CONIC_MOST_GAUSSIANS))
    return conic_gltf_wrong(reader, missing);
  const conic_gltf_view *view = &reader->views[(size_t)accessor->view];
  int type = conic_gltf_is_index(accessor->type, 10000) ? (int)accessor->type : 0;
  size_t size = type == FLOAT ? 4 : type == INT8 || type == UINT8 ? 1 : type == INT16 || type == UINT16 ? 2 : 0;
  if (!conic_gltf_is_index(view->buffer, (size_t)reader->n_buffers) || size == 0)
    return conic_gltf_wrong(reader, missing);
  const conic_gltf_buffer *buffer = &reader->buffers[(size_t)view->buffer];
  size_t item = size * (size_t)accessor->n_components, stride = item;
  if (view->stride != 0.0 && conic_gltf_is_index(view->stride, 256))
    stride = (size_t)view->stride;
  double start = view->offset + accessor->offset, count = accessor->count;
  double end = start + (count > 0.0 ? (count - 1.0) * (double)stride + (double)item : 0.0);
  if (!(view->offset >= 0.0 && accessor->offset >= 0.0 && start <= (double)buffer->n_bytes &&
        end <= (double)buffer->n_bytes) ||
      stride < item)
    return conic_gltf_wrong(reader, "an accessor of Gaussians reaches past the end of its buffer");
  *numbers = (gltf_numbers){buffer->bytes ? buffer->bytes + (size_t)start : NULL, stride, (size_t)count, type,
                            accessor->is_normalized};
  return CONIC_OK;
}

static float gltf_number_at(const gltf_numbers *numbers, size_t i, int component) {
  const unsigned char *p = numbers->bytes + i * numbers->stride;
  double value, most;
  if (numbers->type == FLOAT)
    return conic_load_float(p + 4 * component);
  if (numbers->type == INT8 || numbers->type == UINT8) {
    value = p[component] - (numbers->type == INT8 && p[component] & 0x80 ? 256 : 0);
    most = numbers->type == INT8 ? 127.0 : 255.0;
  } else {
    int bits = conic_load_16(p + 2 * component);
    value = bits - (numbers->type == INT16 && bits & 0x8000 ? 65536 : 0);
    most = numbers->type == INT16 ? 32767.0 : 65535.0;
  }
  value = numbers->is_normalized ? value / most : value;
  return (float)(numbers->is_normalized && value < -1.0 ? -1.0 : value);
}

/* The degree up to which all coefficients are there. */
static int find_primitive_degree(const conic_gltf_primitive *primitive) {
  int degree = 0;
  for (int i = 1; i < CONIC_GLTF_N_ATTRIBUTES - CONIC_GLTF_SH; i++) {
    if (primitive->accessors[CONIC_GLTF_SH + i] < 0.0)
      break;
    if (i + 1 == (degree + 2) * (degree + 2))
      degree++;
  }
  return degree;
}

/* One attribute of a primitive into the next Gaussians; components go to columns, or to harmonics from `i_harmonic`. */
static conic_status take_attribute(conic_gltf_reader *reader, const conic_gltf_primitive *primitive, int attribute,
                                   int n, size_t count, float **columns, int first_component, double factor,
                                   double offset, int i_harmonic) {
  gltf_numbers numbers;
  conic_status status = find_numbers(reader, primitive->accessors[attribute], first_component + n, &numbers);
  if (status == CONIC_OK && numbers.count != count)
    status = conic_gltf_wrong(reader, "attributes of the same Gaussians are of different numbers");
  for (int k = 0; status == CONIC_OK && k < n; k++)
    for (size_t i = 0; i < count; i++) {
      float value = gltf_number_at(&numbers, i, first_component + k);
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

static conic_status take_harmonics(conic_gltf_reader *reader, const conic_gltf_primitive *primitive, size_t count) {
  conic_gaussians *gaussians = reader->gaussians;
  conic_status status = CONIC_OK;
  int degree = find_primitive_degree(primitive), n = (gaussians->sh_degree + 1) * (gaussians->sh_degree + 1);
  if (primitive->accessors[CONIC_GLTF_SH] < 0.0) {
    status = take_attribute(reader, primitive, CONIC_GLTF_COLOR, 3, count, NULL, 0, 1.0 / CONIC_SH_CONSTANT,
                            -0.5 / CONIC_SH_CONSTANT, 0);
    degree = 0;
  }
  for (int i = primitive->accessors[CONIC_GLTF_SH] < 0.0; status == CONIC_OK && i < n; i++)
    if (i < (degree + 1) * (degree + 1))
      status = take_attribute(reader, primitive, CONIC_GLTF_SH + i, 3, count, NULL, 0, 1.0, 0.0, 3 * i);
    else
      for (size_t k = 0; k < 3 * count; k++)
        conic_gaussians_put_harmonic(gaussians, reader->n_placed + k / 3, 3 * (size_t)i + k % 3, 0.0f);
  return status;
}

static conic_status take_primitive(conic_gltf_reader *reader, const conic_gltf_primitive *primitive, size_t count) {
  conic_gaussians *gaussians = reader->gaussians;
  float *rotation[4] = {gaussians->rotation[1], gaussians->rotation[2], gaussians->rotation[3], gaussians->rotation[0]};
  conic_status status =
      take_attribute(reader, primitive, CONIC_GLTF_POSITION, 3, count, gaussians->position, 0, 1.0, 0.0, 0);
  if (status == CONIC_OK)
    status = take_attribute(reader, primitive, CONIC_GLTF_ROTATION, 4, count, rotation, 0, 1.0, 0.0, 0);
  if (status == CONIC_OK)
    status = take_attribute(reader, primitive, CONIC_GLTF_SCALE, 3, count, gaussians->scale, 0, 1.0, 0.0, 0);
  if (status == CONIC_OK && primitive->accessors[CONIC_GLTF_OPACITY] >= 0.0)
    status = take_attribute(reader, primitive, CONIC_GLTF_OPACITY, 1, count, &gaussians->opacity, 0, 1.0, 0.0, 0);
  else if (status == CONIC_OK)
    status = take_attribute(reader, primitive, CONIC_GLTF_COLOR, 1, count, &gaussians->opacity, 3, 1.0, 0.0, 0);
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

/* A node's own place; 0 where it stretches or mirrors. */
static int find_place(const conic_gltf_node *node, gltf_place *place) {
  const double *turn = node->rotation, quaternion[4] = {turn[3], turn[0], turn[1], turn[2]};
  *place = no_place;
  if (!node->has_matrix) {
    conic_rotation_of(quaternion, place->turn);
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
static void put_in_place(conic_gltf_reader *reader, const gltf_place *place, size_t count) {
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

static conic_status place_mesh(conic_gltf_reader *reader, int i_mesh, const gltf_place *place, int is_stretched) {
  conic_status status = CONIC_OK;
  for (size_t i = 0; status == CONIC_OK && i < reader->n_primitives; i++) {
    const conic_gltf_primitive *primitive = &reader->primitives[i];
    gltf_numbers positions;
    if (primitive->mesh != i_mesh || !primitive->is_gaussian)
      continue;
    if (is_stretched)
      return conic_gltf_wrong(reader, "a node stretches or mirrors its Gaussians, which is not read");
    status = find_numbers(reader, primitive->accessors[CONIC_GLTF_POSITION], 3, &positions);
    if (status == CONIC_OK && reader->n_placed + positions.count > CONIC_MOST_GAUSSIANS)
      status = conic_gltf_wrong(reader, "too many Gaussians");
    if (status == CONIC_OK && reader->gaussians)
      status = take_primitive(reader, primitive, positions.count);
    if (status == CONIC_OK && reader->gaussians)
      put_in_place(reader, place, positions.count);
    reader->n_placed += positions.count;
  }
  return status;
}

static conic_status place_node(conic_gltf_reader *reader, size_t i_node, const gltf_place *outer, int is_stretched,
                               int depth) {
  const conic_gltf_node *node = &reader->nodes[i_node];
  gltf_place own, place;
  is_stretched |= !find_place(node, &own);
  join_places(outer, &own, &place);
  if (depth == CONIC_GLTF_MOST_DEPTH)
    return conic_gltf_wrong(reader, "nodes are nested too deeply");
  conic_status status = CONIC_OK;
  if (conic_gltf_is_index(node->mesh, (size_t)reader->n_meshes))
    status = place_mesh(reader, (int)node->mesh, &place, is_stretched);
  for (size_t i = 0; status == CONIC_OK && i < node->n_children; i++) {
    double child = reader->children[node->first_child + i];
    status = conic_gltf_is_index(child, reader->n_nodes)
                 ? place_node(reader, (size_t)child, &place, is_stretched, depth + 1)
                 : conic_gltf_wrong(reader, "a node's child is not there");
  }
  return status;
}

/* Every node that is no other's child; of a file without nodes, the meshes as they are. */
static conic_status place_nodes(conic_gltf_reader *reader) {
  conic_status status = CONIC_OK;
  reader->n_placed = 0;
  for (size_t i = 0; i < reader->n_children; i++)
    if (conic_gltf_is_index(reader->children[i], reader->n_nodes))
      reader->nodes[(size_t)reader->children[i]].is_child++;
  for (size_t i = 0; status == CONIC_OK && i < reader->n_nodes; i++)
    if (reader->nodes[i].is_child > 1 && !reader->gaussians)
      status = conic_gltf_wrong(reader, "a node is the child of two");
    else if (!reader->nodes[i].is_child)
      status = place_node(reader, i, &no_place, 0, 0);
  for (int i = 0; status == CONIC_OK && i < reader->n_meshes && reader->n_nodes == 0; i++)
    status = place_mesh(reader, i, &no_place, 0);
  return status;
}

/* --- the file --- */

static int find_file_degree(const conic_gltf_reader *reader) {
  int most = 0;
  for (size_t i = 0; i < reader->n_primitives; i++) {
    int degree = reader->primitives[i].is_gaussian ? find_primitive_degree(&reader->primitives[i]) : 0;
    most = degree > most ? degree : most;
  }
  return most;
}

static conic_status read_gltf(conic_gltf_reader *reader, conic_gaussians *gaussians) {
  conic_context *context = reader->file->context;
  conic_status status = conic_gltf_parse(reader);
  if (status == CONIC_OK)
    status = place_nodes(reader);
  if (status == CONIC_OK && reader->n_placed == 0)
    status = conic_gltf_wrong(reader, "there are no Gaussians in it");
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
  conic_gltf_reader *reader = conic_memory_allocate_zeroed(file->context, 1, sizeof *reader);
  if (!reader)
    return CONIC_ERROR_MEMORY;
  reader->file = file;
  conic_status status = read_gltf(reader, gaussians);
  conic_gltf_release(reader);
  conic_memory_release(file->context, reader);
  return status;
}
