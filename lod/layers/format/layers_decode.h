/* From a cloud's bytes to its samples. */
#ifndef CONIC_LAYERS_DECODE_H
#define CONIC_LAYERS_DECODE_H

#include "lod/layers/format/layers_format.h"

/* The samples of a cloud, in ascending order of their keys, so that those in the place of a node below are a range
 * (conic_layers_range). All pointers lie in one block. */
typedef struct conic_layers_cloud {
  size_t count;
  uint64_t *keys;
  float *position[3]; /* from the header's origin */
  float *normal[3];   /* unit */
  float *color[3];    /* linear; null where the file has none */
} conic_layers_cloud;

/* What a cloud's samples take, and laying them out in a block of so many bytes, aligned to 64. */
size_t conic_layers_cloud_bytes(const conic_layers_header *header, const conic_layers_entry *entry);
void conic_layers_cloud_place(const conic_layers_header *header, const conic_layers_entry *entry, void *block,
                              conic_layers_cloud *cloud);

/* Decodes clouds, one after the other; each thread has its own. */
typedef struct conic_layers_decoder conic_layers_decoder;

/* `header` is copied. Errors: MEMORY, UNSUPPORTED (built without zstd). */
conic_status conic_layers_decoder_create(conic_context *context, const conic_layers_header *header,
                                         conic_layers_decoder **decoder);
void conic_layers_decoder_destroy(conic_layers_decoder *decoder);

/* Decodes the entry->n_bytes bytes into `cloud`, which conic_layers_cloud_place has laid out. Checks the sum and
 * everything else before it is used. Returns null, or what is wrong with the bytes. The same bytes give the same bits
 * everywhere. */
const char *conic_layers_decode(conic_layers_decoder *decoder, const conic_layers_entry *entry,
                                const unsigned char *bytes, conic_layers_cloud *cloud);

/* The samples of `cloud` in the place of the node `below`: from *first to before *end. */
void conic_layers_range(const conic_layers_header *header, const conic_layers_cloud *cloud,
                        const conic_layers_entry *below, size_t *first, size_t *end);

#endif
