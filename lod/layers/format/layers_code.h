/* The streams of a cloud: what the builder packs and the decoder unpacks (docs/reference/format-lpc.md). */
#pragma once

#include "core/files/zstd.h"
#include "lod/layers/format/layers_format.h"

/* --- attributes as streams of bytes that are alike --- */

/* Fills the streams of attribute i, which must not be the position, and says how long they are. */
void conic_layers_split(const conic_layers_schema *schema, uint32_t i, const unsigned char *samples, size_t n,
                        unsigned char *const *streams, size_t *n_bytes);

/* And back. */
void conic_layers_join(const conic_layers_schema *schema, uint32_t i, size_t n, const unsigned char *const *streams,
                       unsigned char *samples);

/* How many clip lines there are, by the first stream of theirs; SIZE_MAX where it makes no sense. */
size_t conic_layers_count_lines(const unsigned char *kinds, size_t n);

/* The size that is read where `size` was written; and the outline of an ellipse in a record. */
uint16_t conic_layers_size_as_read(const conic_layers_attribute *sizes, uint16_t size);
uint16_t conic_layers_size_of_axes(float cutoff, const unsigned char *axes);

/* A length of an axis as finely as it is kept. */
float conic_layers_axis_length(float length);

/* Packs clouds, one after the other; each thread has its own. */
typedef struct conic_layers_coder conic_layers_coder;

/* For clouds of up to `most_samples` with the attributes of `schema`, which is copied. With `is_wanted` it unpacks the
 * attributes for which that is not 0, the first always among them; where it is null, it packs. Errors: MEMORY,
 * UNSUPPORTED (built without zstd). */
conic_status conic_layers_coder_create(conic_context *context, size_t most_samples, const conic_layers_schema *schema,
                                       const unsigned char *is_wanted, conic_layers_coder **coder);
void conic_layers_coder_destroy(conic_layers_coder *coder);

/* Packs records, ascending by key, of a place that begins with `first_key`. Returns how many bytes they became; *bytes
 * is valid until the next call. Adds to the sizes of the attributes. */
size_t conic_layers_encode(conic_layers_coder *coder, const unsigned char *samples, size_t n, uint64_t first_key,
                           const unsigned char **bytes, uint64_t attribute_bytes[CONIC_LAYERS_MOST_ATTRIBUTES]);

/* Unpacks n records. Returns null, or what is wrong. */
const char *conic_layers_unpack(conic_layers_coder *coder, const unsigned char *bytes, size_t n_bytes, size_t n,
                                uint64_t first_key, uint64_t last_key, unsigned char *samples);
