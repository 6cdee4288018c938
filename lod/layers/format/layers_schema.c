#include "lod/layers/format/layers_schema.h"

#include "core/base/byte_order.h"
#include "core/splats/point_fields.h"

/* What of a kind there is in a cloud and in memory. */
static const struct {
  uint16_t n_streams, n_bytes; /* in a record, behind its head */
  int is_needed;
} layer_kinds[CONIC_LAYERS_KINDS] = {[CONIC_LAYERS_POSITION] = {2, 0, 1},
                                     [CONIC_LAYERS_NORMAL] = {2, 0, 1},
                                     [CONIC_LAYERS_COLOR] = {3, 0, 0},
                                     [CONIC_LAYERS_SIZE] = {1, 0, 0},
                                     [CONIC_LAYERS_AXES] = {10, sizeof(conic_layers_axes), 1},
                                     [CONIC_LAYERS_OPACITY] = {2, 2, 0},
                                     [CONIC_LAYERS_DOT] = {1, 1, 0},
                                     [CONIC_LAYERS_CLIP] = {7, sizeof(conic_layers_lines), 0}};

static const struct {
  const char *name;
  size_t n_bytes;
  double low, high;
} layer_numbers[CONIC_LAYERS_NUMBERS] = {
    [CONIC_LAYERS_UINT8] = {"uint8", 1, 0.0, 255.0},
    [CONIC_LAYERS_INT8] = {"int8", 1, -128.0, 127.0},
    [CONIC_LAYERS_UINT16] = {"uint16", 2, 0.0, 65535.0},
    [CONIC_LAYERS_INT16] = {"int16", 2, -32768.0, 32767.0},
    [CONIC_LAYERS_UINT32] = {"uint32", 4, 0.0, 4294967295.0},
    [CONIC_LAYERS_INT32] = {"int32", 4, -2147483648.0, 2147483647.0},
    [CONIC_LAYERS_FLOAT] = {"float", 4, 0.0, 0.0},
    [CONIC_LAYERS_DOUBLE] = {"double", 8, 0.0, 0.0},
};

const char *conic_layers_number_name(unsigned type) {
  return type < CONIC_LAYERS_NUMBERS ? layer_numbers[type].name : NULL;
}

int conic_layers_number_of(const char *name) {
  for (int i = 0; i < CONIC_LAYERS_NUMBERS; i++)
    if (strcmp(name, layer_numbers[i].name) == 0)
      return i;
  return -1;
}

static size_t layers_number_bytes(unsigned type) {
  return type < CONIC_LAYERS_NUMBERS ? layer_numbers[type].n_bytes : 0;
}

/* The bytes that an attribute takes in a record, behind its head. */
static size_t record_bytes_of(const conic_layers_attribute *attribute) {
  if (attribute->kind == CONIC_LAYERS_VALUE)
    return layers_number_bytes(attribute->type);
  return attribute->kind < CONIC_LAYERS_KINDS ? layer_kinds[attribute->kind].n_bytes : 0;
}

static unsigned attribute_streams(const conic_layers_attribute *attribute) {
  return attribute->kind == CONIC_LAYERS_VALUE ? (unsigned)layers_number_bytes(attribute->type)
                                               : layer_kinds[attribute->kind].n_streams;
}

static const char *check_attribute(const conic_layers_schema *schema, uint32_t i) {
  const conic_layers_attribute *attribute = &schema->list[i];
  const double numbers[] = {attribute->scale, attribute->offset,     attribute->low,       attribute->high,
                            attribute->error, attribute->typical[0], attribute->typical[1]};
  if (!memchr(attribute->name, 0, sizeof attribute->name) || !attribute->name[0])
    return "an attribute's name does not end";
  if (attribute->n_streams == 0 || attribute->n_streams > CONIC_LAYERS_MOST_STREAMS)
    return "an attribute's streams are none or too many";
  for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++)
    if (!(numbers[k] - numbers[k] == 0.0))
      return "a number of an attribute is not finite";
  if (attribute->kind >= CONIC_LAYERS_KINDS)
    return attribute->flags & CONIC_LAYERS_NEEDED ? "an attribute is needed and not known" : NULL;
  if (attribute->kind == CONIC_LAYERS_VALUE && attribute->type >= CONIC_LAYERS_NUMBERS)
    return "a value has a type that is none";
  if (attribute->kind == CONIC_LAYERS_SIZE &&
      (attribute->type > 7 || !(attribute->offset >= 0.0) || !(attribute->offset <= 65535.0)))
    return "the sizes have a scale that is none";
  if (attribute->kind == CONIC_LAYERS_AXES && !(attribute->offset >= 0.0 && attribute->offset <= 1048575.0))
    return "the axes have a scale that is none";
  if (attribute->n_streams != attribute_streams(attribute))
    return "an attribute has other streams than its kind";
  for (uint32_t k = 0; k < i && attribute->kind != CONIC_LAYERS_VALUE; k++)
    if (schema->list[k].kind == attribute->kind)
      return "an attribute is there twice";
  return NULL;
}

/* Counts the attribute behind the others in, and gives it its place in a record. */
static void place_last(conic_layers_schema *schema) {
  const conic_layers_attribute *attribute = &schema->list[schema->n];
  uint32_t n_bytes = (uint32_t)record_bytes_of(attribute);
  schema->at[schema->n++] = n_bytes ? (uint32_t)sizeof(conic_layers_sample) + schema->extra_bytes : 0;
  schema->extra_bytes += n_bytes;
  schema->n_streams += attribute->n_streams;
  schema->sample_bytes = (uint32_t)conic_layers_stride(schema->extra_bytes);
}

const char *conic_layers_schema_lay_out(conic_layers_schema *schema) {
  const char *wrong = NULL;
  uint32_t n = schema->n;
  if (schema->n < 2 || schema->n > CONIC_LAYERS_MOST_ATTRIBUTES)
    return "the attributes are too few or too many";
  if (schema->list[0].kind != CONIC_LAYERS_POSITION)
    return "positions are not its first attribute";
  if (conic_layers_schema_find(schema, CONIC_LAYERS_NORMAL) < 0 &&
      conic_layers_schema_find(schema, CONIC_LAYERS_AXES) < 0)
    return "its samples have no direction";
  schema->n_streams = schema->extra_bytes = schema->sample_bytes = 0;
  for (schema->n = 0; schema->n < n && !wrong;) {
    wrong = check_attribute(schema, schema->n);
    if (!wrong)
      place_last(schema);
  }
  return wrong;
}

conic_layers_attribute *conic_layers_schema_add(conic_layers_schema *schema, conic_layers_kind kind, const char *name,
                                                unsigned type) {
  if (schema->n == CONIC_LAYERS_MOST_ATTRIBUTES)
    return NULL;
  conic_layers_attribute *attribute = &schema->list[schema->n];
  memset(attribute, 0, sizeof *attribute);
  for (size_t i = 0; i + 1 < sizeof attribute->name && name[i]; i++)
    attribute->name[i] = name[i];
  attribute->kind = (uint16_t)kind;
  attribute->type = (uint16_t)type;
  attribute->scale = 1.0;
  attribute->n_streams = (uint16_t)attribute_streams(attribute);
  attribute->flags = kind != CONIC_LAYERS_VALUE && layer_kinds[kind].is_needed ? CONIC_LAYERS_NEEDED : 0;
  place_last(schema);
  return attribute;
}

void conic_layers_schema_narrow(conic_layers_schema *schema, const unsigned char *is_wanted) {
  schema->extra_bytes = 0;
  for (uint32_t i = 0; i < schema->n; i++) {
    uint32_t n_bytes = is_wanted[i] ? (uint32_t)record_bytes_of(&schema->list[i]) : 0;
    schema->at[i] = n_bytes ? (uint32_t)sizeof(conic_layers_sample) + schema->extra_bytes : 0;
    schema->extra_bytes += n_bytes;
  }
  schema->sample_bytes = (uint32_t)conic_layers_stride(schema->extra_bytes);
}

void conic_layers_schema_drop(conic_layers_schema *schema, uint32_t i) {
  schema->n_streams -= schema->list[i].n_streams;
  schema->n--;
  memmove(&schema->list[i], &schema->list[i + 1], (schema->n - i) * sizeof *schema->list);
  memmove(&schema->at[i], &schema->at[i + 1], (schema->n - i) * sizeof *schema->at);
}

int conic_layers_schema_find(const conic_layers_schema *schema, conic_layers_kind kind) {
  for (uint32_t i = 0; i < schema->n; i++)
    if (schema->list[i].kind == kind)
      return (int)i;
  return -1;
}

int conic_layers_schema_value(const conic_layers_schema *schema, const char *name) {
  for (int is_alike = 0; is_alike < 2; is_alike++)
    for (uint32_t i = 0; i < schema->n; i++)
      if (schema->list[i].kind == CONIC_LAYERS_VALUE &&
          (is_alike ? conic_field_is(schema->list[i].name, name) : strcmp(schema->list[i].name, name) == 0))
        return (int)i;
  return -1;
}

double conic_layers_number_get(const conic_layers_attribute *attribute, const void *from) {
  size_t n_bytes = layers_number_bytes(attribute->type);
  /* NOLINTNEXTLINE(clang-analyzer-core.*): every type has bytes */
  uint64_t bits = conic_load_bits(from, n_bytes), sign = UINT64_C(1) << (8 * n_bytes - 1);
  double number = (double)bits;
  if (attribute->type == CONIC_LAYERS_FLOAT)
    number = (double)conic_float_of_bits((uint32_t)bits);
  else if (attribute->type == CONIC_LAYERS_DOUBLE)
    number = conic_double_of_bits(bits);
  else if (layer_numbers[attribute->type].low < 0.0 && bits & sign)
    number = (double)bits - 2.0 * (double)sign;
  return number * attribute->scale + attribute->offset;
}

void conic_layers_number_put(const conic_layers_attribute *attribute, double value, void *to) {
  double number = (value - attribute->offset) / attribute->scale;
  double low = layer_numbers[attribute->type].low, high = layer_numbers[attribute->type].high;
  unsigned char bytes[8];
  if (attribute->type == CONIC_LAYERS_FLOAT)
    conic_store_float(bytes, (float)number);
  else if (attribute->type == CONIC_LAYERS_DOUBLE)
    conic_store_64(bytes, conic_bits_of_double(number));
  else {
    number = floor(number + 0.5);
    number = number > low ? number < high ? number : high : low; /* what is no number: the least */
    conic_store_64(bytes, (uint64_t)(int64_t)number);
  }
  memcpy(to, bytes, layers_number_bytes(attribute->type));
}

int conic_layers_stand_in_schema(const conic_layers_schema *schema, double quantum, conic_layers_schema *stand_ins) {
  enum { KEPT = 3, OCTAVES_BELOW = 8, FRACTION_BITS = 23 };
  memset(stand_ins, 0, sizeof *stand_ins);
  if (conic_layers_schema_find(schema, CONIC_LAYERS_OPACITY) >= 0)
    return 0;
  conic_layers_schema_add(stand_ins, CONIC_LAYERS_POSITION, "position", 0);
  conic_layers_schema_add(stand_ins, CONIC_LAYERS_NORMAL, "normal", 0);
  if (conic_layers_schema_find(schema, CONIC_LAYERS_COLOR) >= 0)
    conic_layers_schema_add(stand_ins, CONIC_LAYERS_COLOR, "color", 0);
  conic_layers_attribute *sizes = conic_layers_schema_add(stand_ins, CONIC_LAYERS_SIZE, "size", KEPT);
  double offset = (double)(conic_bits_of_float((float)quantum) >> (FRACTION_BITS - KEPT)) - (OCTAVES_BELOW << KEPT);
  sizes->offset = offset > 0.0 ? offset : 0.0;
  if (conic_layers_schema_find(schema, CONIC_LAYERS_DOT) >= 0)
    conic_layers_schema_add(stand_ins, CONIC_LAYERS_DOT, "dot", 0);
  return 1;
}
