#include "lod/layers/format/layers_decode.h"

#include "core/base/byte_order.h"
#include "core/base/color.h"
#include "core/base/real.h"
#include "core/splats/coordinate.h"
#include "lod/layers/format/layers_code.h"
#include "lod/layers/format/layers_key.h"

struct conic_layers_decoder {
  conic_context *context;
  conic_layers_header header;
  conic_layers_coder *coder;
  const conic_layers_choice *choice;
  int of_kind[CONIC_LAYERS_KINDS]; /* attributes; −1: none */
  unsigned char is_wanted[CONIC_LAYERS_MOST_ATTRIBUTES];
  unsigned char *samples;
  float colors[256];
};

enum { ALIGNMENT = 64 };

static size_t aligned(size_t n_bytes) {
  return (n_bytes + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
}

/* Where arrays go, one behind the other; without memory they are only counted. */
typedef struct array_places {
  char *memory;
  size_t at;
} array_places;

static void *next_cloud_array(array_places *places, size_t n, size_t n_bytes, int is_there) {
  void *array = is_there && places->memory ? places->memory + places->at : NULL;
  places->at += is_there ? aligned(n * n_bytes) : 0;
  return array;
}

static int file_has(const conic_layers_header *header, conic_layers_kind kind) {
  return conic_layers_schema_find(&header->schema, kind) >= 0;
}

size_t conic_layers_cloud_place(const conic_layers_header *header, const conic_layers_entry *entry,
                                const conic_layers_choice *choice, void *block, conic_layers_cloud *cloud) {
  size_t n = entry->n_samples;
  array_places at = {block, 0};
  int has_axes = file_has(header, CONIC_LAYERS_AXES);
  int has_colors = file_has(header, CONIC_LAYERS_COLOR) || (choice && choice->colored_by >= 0);
  memset(cloud, 0, sizeof *cloud);
  cloud->count = n;
  cloud->keys = next_cloud_array(&at, n, sizeof(uint64_t), 1);
  for (int i = 0; i < 3; i++) {
    cloud->position[i] = next_cloud_array(&at, n, sizeof(float), 1);
    cloud->normal[i] = next_cloud_array(&at, n, sizeof(float), 1);
    cloud->color[i] = next_cloud_array(&at, n, sizeof(float), has_colors);
  }
  cloud->facing = next_cloud_array(&at, n, sizeof(uint16_t), !has_axes && header->version > 0);
  cloud->outline = next_cloud_array(&at, n, sizeof(float), has_axes || file_has(header, CONIC_LAYERS_SIZE));
  for (int i = 0; i < 6; i++)
    cloud->axis[i] = next_cloud_array(&at, n, sizeof(float), has_axes);
  cloud->opacity = next_cloud_array(&at, n, sizeof(float), file_has(header, CONIC_LAYERS_OPACITY));
  cloud->dot = next_cloud_array(&at, n, sizeof(float), file_has(header, CONIC_LAYERS_DOT));
  cloud->lines = next_cloud_array(&at, n, sizeof(conic_layers_lines), file_has(header, CONIC_LAYERS_CLIP));
  cloud->is_left_out = next_cloud_array(&at, n, 1, choice && choice->filter);
  size_t n_kept = choice ? choice->n_kept : 0;
  cloud->values = next_cloud_array(&at, n * n_kept, sizeof(double), n_kept > 0);
  return at.at;
}

size_t conic_layers_cloud_bytes(const conic_layers_header *header, const conic_layers_entry *entry,
                                const conic_layers_choice *choice) {
  conic_layers_cloud cloud;
  return conic_layers_cloud_place(header, entry, choice, NULL, &cloud);
}

/* Values are unpacked where something is made of them. */
static void choose_attributes(conic_layers_decoder *decoder) {
  const conic_layers_schema *schema = &decoder->header.schema;
  const conic_layers_choice *choice = decoder->choice;
  for (uint32_t i = 0; i < schema->n; i++)
    decoder->is_wanted[i] = schema->list[i].kind != CONIC_LAYERS_VALUE;
  if (choice && choice->colored_by >= 0)
    decoder->is_wanted[choice->colored_by] = 1;
  for (size_t k = 0; choice && choice->filter && k < conic_filter_names(choice->filter); k++)
    if (choice->filtered_by[k] >= 0)
      decoder->is_wanted[choice->filtered_by[k]] = 1;
  for (uint32_t k = 0; choice && k < choice->n_kept; k++)
    decoder->is_wanted[choice->kept[k]] = 1;
}

conic_status conic_layers_decoder_create(conic_context *context, const conic_layers_header *header,
                                         const conic_layers_choice *choice, conic_layers_decoder **decoder) {
  *decoder = NULL;
  conic_layers_decoder *made = conic_memory_allocate_zeroed(context, 1, sizeof *made);
  if (!made)
    return CONIC_ERROR_MEMORY;
  made->context = context;
  made->header = *header;
  conic_srgb_decode_table(made->colors);
  made->choice = choice;
  for (int kind = 0; kind < CONIC_LAYERS_KINDS; kind++)
    made->of_kind[kind] = conic_layers_schema_find(&header->schema, (conic_layers_kind)kind);
  choose_attributes(made);
  conic_layers_schema_narrow(&made->header.schema, made->is_wanted);
  conic_status status =
      conic_layers_coder_create(context, header->most_samples, &made->header.schema, made->is_wanted, &made->coder);
  if (status == CONIC_OK) {
    made->samples = conic_memory_allocate(context, header->most_samples, made->header.schema.sample_bytes);
    status = made->samples ? CONIC_OK : CONIC_ERROR_MEMORY;
  }
  if (status == CONIC_OK)
    *decoder = made;
  else
    conic_layers_decoder_destroy(made);
  return status;
}

void conic_layers_decoder_destroy(conic_layers_decoder *decoder) {
  if (!decoder)
    return;
  conic_layers_coder_destroy(decoder->coder);
  conic_memory_release_these(decoder->context, decoder->samples, decoder);
}

/* The middle of its cell of the grid. */
static float place_cloud(const conic_layers_header *header, uint64_t key, int axis) {
  return (float)(((double)conic_layers_step(key, axis) + 0.5) * header->quantum);
}

/* The bytes of an attribute that there is. */
static const unsigned char *bytes_of_attribute(const conic_layers_decoder *decoder, size_t i, int attribute) {
  return conic_layers_value_at(&decoder->header.schema, decoder->samples, i, (uint32_t)attribute);
}

static void store_ellipse(const conic_layers_decoder *decoder, size_t i, float normal[3], conic_layers_cloud *cloud) {
  const unsigned char *at = bytes_of_attribute(decoder, i, decoder->of_kind[CONIC_LAYERS_AXES]);
  float cutoff = (float)decoder->header.schema.list[decoder->of_kind[CONIC_LAYERS_AXES]].scale;
  conic_layers_axes axes;
  float u[3], v[3];
  memcpy(&axes, at, sizeof axes);
  conic_layers_axes_of(&axes, u, v, normal);
  for (int axis = 0; axis < 3; axis++) {
    cloud->axis[axis][i] = u[axis] * axes.length[0];
    cloud->axis[3 + axis][i] = v[axis] * axes.length[1];
  }
  cloud->outline[i] = conic_layers_size_of(conic_layers_size_of_axes(cutoff, at));
}

static void store_payload(const conic_layers_decoder *decoder, size_t i, conic_layers_cloud *cloud) {
  if (cloud->opacity)
    cloud->opacity[i] =
        (float)conic_load_16(bytes_of_attribute(decoder, i, decoder->of_kind[CONIC_LAYERS_OPACITY])) / 65535.0f;
  if (cloud->dot)
    cloud->dot[i] = *bytes_of_attribute(decoder, i, decoder->of_kind[CONIC_LAYERS_DOT]) ? 1.0f : 0.0f;
  if (cloud->lines)
    memcpy(&cloud->lines[i], bytes_of_attribute(decoder, i, decoder->of_kind[CONIC_LAYERS_CLIP]), sizeof *cloud->lines);
}

static void store_chosen(const conic_layers_decoder *decoder, size_t i, conic_layers_cloud *cloud) {
  const conic_layers_choice *choice = decoder->choice;
  const conic_layers_attribute *list = decoder->header.schema.list;
  double values[CONIC_FILTER_MOST_NAMES];
  if (choice->colored_by >= 0) {
    float linear[3];
    conic_coloring_color(
        &choice->coloring,
        conic_layers_number_get(&list[choice->colored_by], bytes_of_attribute(decoder, i, choice->colored_by)), linear);
    for (int channel = 0; channel < 3; channel++)
      cloud->color[channel][i] = linear[channel]; /* NOLINT(clang-analyzer-core.NullDereference): coloured */
  }
  for (uint32_t k = 0; k < choice->n_kept; k++)
    cloud->values[k * cloud->count + i] =
        conic_layers_number_get(&list[choice->kept[k]], bytes_of_attribute(decoder, i, choice->kept[k]));
  if (!choice->filter)
    return;
  for (size_t k = 0; k < conic_filter_names(choice->filter); k++) {
    int by = choice->filtered_by[k], axis = CONIC_LAYERS_BY_X - by;
    values[k] = by >= 0 ? conic_layers_number_get(&list[by], bytes_of_attribute(decoder, i, by))
                        : conic_coordinate_of(decoder->header.origin[axis], cloud->position[axis][i]);
  }
  cloud->is_left_out[i] = !conic_filter_passes(choice->filter, values);
}

static void store_drawn_sample(const conic_layers_decoder *decoder, size_t i, conic_layers_cloud *cloud) {
  const conic_layers_sample *sample = conic_layers_sample_at(decoder->samples, decoder->header.schema.sample_bytes, i);
  float normal[3];
  cloud->keys[i] = sample->key;
  if (cloud->facing)
    cloud->facing[i] = conic_layers_facing(sample->normal);
  if (cloud->axis[0])
    store_ellipse(decoder, i, normal, cloud);
  else
    conic_layers_normal_of(sample->normal, normal);
  if (cloud->outline && !cloud->axis[0])
    cloud->outline[i] = conic_layers_size_of(sample->size);
  for (int axis = 0; axis < 3; axis++) {
    cloud->position[axis][i] = place_cloud(&decoder->header, sample->key, axis);
    cloud->normal[axis][i] = normal[axis];
    if (cloud->color[0])
      cloud->color[axis][i] = decoder->colors[sample->color[axis]];
  }
  store_payload(decoder, i, cloud);
  if (decoder->choice)
    store_chosen(decoder, i, cloud);
}

const char *conic_layers_decode(conic_layers_decoder *decoder, const conic_layers_entry *entry,
                                const unsigned char *bytes, conic_layers_cloud *cloud) {
  if (conic_checksum(bytes, entry->n_bytes) != entry->sum)
    return "its bytes are damaged: their sum is another";
  const char *wrong = conic_layers_unpack(decoder->coder, bytes, entry->n_bytes, entry->n_samples, entry->key,
                                          conic_layers_last_key(&decoder->header, entry), decoder->samples);
  for (size_t i = 0; i < entry->n_samples && !wrong; i++)
    store_drawn_sample(decoder, i, cloud);
  return wrong;
}

/* The first sample whose key is not below `key`. */
static size_t first_from(const conic_layers_cloud *cloud, uint64_t key) {
  size_t low = 0;
  CONIC_BISECT(low, cloud->count, cloud->keys[middle] < key);
  return low;
}

void conic_layers_range(const conic_layers_header *header, const conic_layers_cloud *cloud,
                        const conic_layers_entry *below, size_t *first, size_t *end) {
  *first = first_from(cloud, below->key);
  *end = first_from(cloud, conic_layers_last_key(header, below) + 1);
}
