/* The streams of a cloud: what the builder packs and the decoder unpacks (docs/reference/format-lpc.md). */
#ifndef CONIC_LAYERS_CODE_H
#define CONIC_LAYERS_CODE_H

#include "core/files/zstd.h"
#include "lod/layers/format/layers_format.h"

/* A sample while a file is built, and in its cloud: 16 bytes. */
typedef struct conic_layers_sample {
  uint64_t key;
  uint8_t normal[2]; /* octahedron */
  uint16_t size;     /* outline's radius: the upper half of a float's bits, rounded up; 0: not known */
  uint8_t color[3];  /* sRGB codes */
  uint8_t bare;      /* it has no normal yet: 64, and where in its step it is, in quarters, 2 bits an axis; else 0 */
} conic_layers_sample;

/* Parts of a cloud's bytes, for the statistics. */
enum { CONIC_LAYERS_POSITION = 0, CONIC_LAYERS_NORMAL = 1, CONIC_LAYERS_COLOR = 2, CONIC_LAYERS_PARTS = 3 };

/* Packs clouds, one after the other; each thread has its own. */
typedef struct conic_layers_coder conic_layers_coder;

/* For clouds of up to `most_samples`. Errors: MEMORY, UNSUPPORTED (built without zstd). */
conic_status conic_layers_coder_create(conic_context *context, size_t most_samples, int has_colors,
                                       conic_layers_coder **coder);
void conic_layers_coder_destroy(conic_layers_coder *coder);

/* Packs samples, ascending by key, of a place that begins with `first_key`. Returns how many bytes it came to; *bytes
 * is valid until the next call. Adds to the sizes of the parts. */
size_t conic_layers_encode(conic_layers_coder *coder, const conic_layers_sample *samples, size_t n, uint64_t first_key,
                           const unsigned char **bytes, uint64_t part_bytes[CONIC_LAYERS_PARTS]);

/* Unpacks n samples: key, normal, colour. Returns null, or what is wrong. */
const char *conic_layers_unpack(conic_layers_coder *coder, const unsigned char *bytes, size_t n_bytes, size_t n,
                                uint64_t first_key, uint64_t last_key, conic_layers_sample *samples);

/* A normal of any length but zero as two codes of the octahedron, and the unit normal that they give. */
void conic_layers_code_normal(const float normal[3], uint8_t code[2]);
void conic_layers_normal_of(const uint8_t code[2], float normal[3]);

#endif
