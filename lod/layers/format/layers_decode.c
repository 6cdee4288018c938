#include "lod/layers/format/layers_decode.h"

#include "core/base/color.h"
#include "core/base/memory.h"
#include "core/files/mapping.h"
#include "core/splats/ellipse.h"
#include "lod/layers/format/layers_code.h"
#include "lod/layers/format/layers_key.h"

struct conic_layers_decoder {
  conic_context *context;
  conic_layers_header header;
  conic_layers_coder *coder;
  conic_layers_sample *samples;
  float colors[256];
};

enum { ALIGNMENT = 64 };

static size_t aligned(size_t n_bytes) {
  return (n_bytes + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
}

static int n_arrays(const conic_layers_header *header) {
  return header->flags & CONIC_LAYERS_COLORS ? 9 : 6;
}

size_t conic_layers_cloud_bytes(const conic_layers_header *header, const conic_layers_entry *entry) {
  return aligned(entry->n_samples * sizeof(uint64_t)) +
         (size_t)n_arrays(header) * aligned(entry->n_samples * sizeof(float));
}

void conic_layers_cloud_place(const conic_layers_header *header, const conic_layers_entry *entry, void *block,
                              conic_layers_cloud *cloud) {
  size_t n = entry->n_samples;
  char *at = (char *)block + aligned(n * sizeof(uint64_t));
  cloud->count = n;
  cloud->keys = block;
  for (int i = 0; i < 9; i++) {
    float **arrays = i < 3 ? cloud->position : i < 6 ? cloud->normal : cloud->color;
    arrays[i % 3] = i < n_arrays(header) ? (float *)(void *)at : NULL;
    at += aligned(n * sizeof(float));
  }
}

conic_status conic_layers_decoder_create(conic_context *context, const conic_layers_header *header,
                                         conic_layers_decoder **decoder) {
  *decoder = NULL;
  conic_layers_decoder *made = conic_memory_allocate_zeroed(context, 1, sizeof *made);
  if (!made)
    return CONIC_ERROR_MEMORY;
  made->context = context;
  made->header = *header;
  conic_srgb_decode_table(made->colors);
  conic_status status = conic_layers_coder_create(context, header->most_samples,
                                                  (header->flags & CONIC_LAYERS_COLORS) != 0, &made->coder);
  if (status == CONIC_OK) {
    made->samples = conic_memory_allocate(context, header->most_samples, sizeof *made->samples);
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
  conic_memory_release(decoder->context, decoder->samples);
  conic_memory_release(decoder->context, decoder);
}

/* The middle of its cell of the grid. */
static float place_cloud(const conic_layers_header *header, uint64_t key, int axis) {
  return (float)(((double)conic_layers_step(key, axis) + 0.5) * header->quantum);
}

static void store_sample(const conic_layers_decoder *decoder, size_t i, conic_layers_cloud *cloud) {
  const conic_layers_sample *sample = &decoder->samples[i];
  float normal[3];
  cloud->keys[i] = sample->key;
  conic_layers_normal_of(sample->normal, normal);
  for (int axis = 0; axis < 3; axis++) {
    cloud->position[axis][i] = place_cloud(&decoder->header, sample->key, axis);
    cloud->normal[axis][i] = normal[axis];
    if (cloud->color[0])
      cloud->color[axis][i] = decoder->colors[sample->color[axis]];
  }
}

const char *conic_layers_decode(conic_layers_decoder *decoder, const conic_layers_entry *entry,
                                const unsigned char *bytes, conic_layers_cloud *cloud) {
  if (conic_checksum(bytes, entry->n_bytes) != entry->sum)
    return "its bytes are damaged: their sum is another";
  const char *wrong = conic_layers_unpack(decoder->coder, bytes, entry->n_bytes, entry->n_samples, entry->key,
                                          conic_layers_last_key(&decoder->header, entry), decoder->samples);
  for (size_t i = 0; i < entry->n_samples && !wrong; i++)
    store_sample(decoder, i, cloud);
  return wrong;
}

/* The first sample whose key is not below `key`. */
static size_t first_from(const conic_layers_cloud *cloud, uint64_t key) {
  size_t low = 0, high = cloud->count;
  while (low < high) {
    size_t middle = low + (high - low) / 2;
    if (cloud->keys[middle] < key)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

void conic_layers_range(const conic_layers_header *header, const conic_layers_cloud *cloud,
                        const conic_layers_entry *below, size_t *first, size_t *end) {
  *first = first_from(cloud, below->key);
  *end = first_from(cloud, conic_layers_last_key(header, below) + 1);
}
