/* Accessors: numbers of all types, with strides, sparse or not. */
#include "core/base/byte_order.h"
#include "core/gltf/gltf.h"

/* An accessor without a view has zeros, which cost a file nothing; more of them than that are of no use. */
static const size_t most_zeros_bytes = (size_t)1 << 28;

/* Bytes of a component, by its type from INT8 on. */
static const size_t sizes[] = {1, 1, 2, 2, 0, 4, 4};

static size_t component_bytes(double component) {
  return component >= CONIC_GLTF_INT8 && conic_gltf_is_index(component, CONIC_GLTF_FLOAT + 1)
             ? sizes[(int)component - CONIC_GLTF_INT8]
             : 0;
}

static int count_components(const char *type) {
  static const struct {
    const char *type;
    int n;
  } types[] = {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT4", 16}};
  for (size_t i = 0; i < sizeof types / sizeof *types; i++)
    if (strcmp(type, types[i].type) == 0)
      return types[i].n;
  return 0;
}

/* Finds `count` items of `size` bytes from `offset` on in a view. */
static conic_status find_items(conic_gltf *gltf, double i_view, double offset, size_t count, size_t size,
                               conic_gltf_bytes *view) {
  conic_status status = conic_gltf_open_view(gltf, i_view, view);
  if (status != CONIC_OK)
    return status;
  view->stride = view->stride ? view->stride : size;
  if (view->stride < size)
    return conic_gltf_wrong(gltf, "a stride of %zu bytes, where an accessor's items have %zu", view->stride, size);
  if (!conic_gltf_is_index(offset, view->n_bytes + 1))
    return conic_gltf_wrong(gltf, "an accessor begins past the end of its view");
  size_t left = view->n_bytes - (size_t)offset;
  if (count > 0 && (left < size || (left - size) / view->stride < count - 1))
    return conic_gltf_wrong(gltf, "an accessor of %zu items reaches past the end of its view of a buffer", count);
  view->bytes += (size_t)offset;
  view->n_bytes = left;
  return CONIC_OK;
}

static uint32_t whole_at(const unsigned char *bytes, int component) {
  return component == CONIC_GLTF_UINT32                                    ? conic_load_32(bytes)
         : component == CONIC_GLTF_UINT16 || component == CONIC_GLTF_INT16 ? conic_load_16(bytes)
                                                                           : *bytes;
}

/* Replaces some of an accessor's own items. */
static conic_status put_sparse(conic_gltf *gltf, const conic_gltf_accessor *accessor, size_t size,
                               conic_gltf_array *array) {
  conic_gltf_bytes indices, values;
  const size_t index_size = component_bytes(accessor->sparse_component);
  if (!conic_gltf_is_index(accessor->n_sparse, array->count + 1) || index_size == 0 ||
      accessor->sparse_component == CONIC_GLTF_FLOAT)
    return conic_gltf_wrong(gltf, "an accessor's sparse values are more than its items, or have no indices");
  const size_t n = (size_t)accessor->n_sparse;
  conic_status status = find_items(gltf, accessor->sparse_view, accessor->sparse_offset, n, index_size, &indices);
  if (status == CONIC_OK)
    status = find_items(gltf, accessor->value_view, accessor->value_offset, n, size, &values);
  for (size_t i = 0; status == CONIC_OK && i < n; i++) {
    uint32_t at = whole_at(indices.bytes + i * indices.stride, (int)accessor->sparse_component);
    if (at >= array->count)
      return conic_gltf_wrong(gltf, "sparse value %u of an accessor that has %zu items", at, array->count);
    memcpy(array->own + at * size, values.bytes + i * values.stride, size);
  }
  return status;
}

/* The items side by side in memory of the array's own, for sparse values to be put in. */
static conic_status copy_items(conic_gltf *gltf, size_t size, conic_gltf_array *array) {
  if (!array->bytes && array->count > most_zeros_bytes / size)
    return conic_gltf_wrong(gltf, "an accessor of %zu items has no view", array->count);
  array->own = conic_memory_allocate_zeroed(gltf->context, array->count, size);
  if (!array->own)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; array->bytes && i < array->count; i++)
    memcpy(array->own + i * size, array->bytes + i * array->stride, size);
  array->bytes = array->own;
  array->stride = size;
  return CONIC_OK;
}

conic_status conic_gltf_open_array(conic_gltf *gltf, double number, conic_gltf_array *array) {
  const conic_gltf_accessor *accessor = conic_gltf_at(gltf, CONIC_GLTF_ACCESSORS, number);
  *array = (conic_gltf_array){.bytes = NULL};
  if (!accessor)
    return conic_gltf_wrong(gltf, "an accessor is not there");
  const int n = count_components(accessor->type);
  const size_t size = (size_t)n * component_bytes(accessor->component);
  if (size == 0 || !conic_gltf_is_index(accessor->count, UINT32_MAX))
    return conic_gltf_wrong(gltf, "an accessor of %g items of the type %s, of components of the type %g",
                            accessor->count, accessor->type[0] ? accessor->type : "none", accessor->component);
  array->n = n;
  array->component = (int)accessor->component;
  array->is_normalized = accessor->is_normalized && array->component <= CONIC_GLTF_UINT16;
  array->count = (size_t)accessor->count;
  conic_status status = CONIC_OK;
  if (accessor->view != CONIC_GLTF_NONE) {
    conic_gltf_bytes view;
    status = find_items(gltf, accessor->view, accessor->offset, array->count, size, &view);
    array->bytes = view.bytes;
    array->stride = view.stride;
  }
  if (status == CONIC_OK && (accessor->n_sparse != 0.0 || !array->bytes))
    status = copy_items(gltf, size, array);
  if (status == CONIC_OK && accessor->n_sparse != 0.0)
    status = put_sparse(gltf, accessor, size, array);
  return status;
}

void conic_gltf_close_array(const conic_gltf *gltf, conic_gltf_array *array) {
  conic_memory_release(gltf->context, array->own);
  *array = (conic_gltf_array){.bytes = NULL};
}

double conic_gltf_value(const conic_gltf_array *array, size_t i, int k) {
  static const double most[] = {127.0, 255.0, 32767.0, 65535.0};
  const unsigned char *bytes = array->bytes + i * array->stride + (size_t)k * sizes[array->component - CONIC_GLTF_INT8];
  if (array->component == CONIC_GLTF_FLOAT)
    return (double)conic_load_float(bytes);
  const uint32_t bits = whole_at(bytes, array->component);
  double value = array->component == CONIC_GLTF_INT8    ? (double)(int8_t)bits
                 : array->component == CONIC_GLTF_INT16 ? (double)(int16_t)bits
                                                        : (double)bits;
  if (!array->is_normalized)
    return value;
  value /= most[array->component - CONIC_GLTF_INT8]; /* NOLINT(clang-analyzer-core.*): of two bytes at most */
  return value > -1.0 ? value : -1.0;
}
