/* Splits each attribute of a cloud's records into streams of bytes that are alike, and joins them again. */
#ifndef CONIC_LAYERS_SPLIT_H
#define CONIC_LAYERS_SPLIT_H

#include "lod/layers/format/layers_schema.h"

/* Fills the streams of attribute i, which must not be the position, and says how long they are. */
void conic_layers_split(const conic_layers_schema *schema, uint32_t i, const unsigned char *samples, size_t n,
                        unsigned char *const *streams, size_t *n_bytes);

/* And back. Null, or what is wrong with them. */
const char *conic_layers_join(const conic_layers_schema *schema, uint32_t i, size_t n,
                              const unsigned char *const *streams, unsigned char *samples);

/* How many clip lines there are, by the first stream of theirs; SIZE_MAX where it makes no sense. */
size_t conic_layers_count_lines(const unsigned char *kinds, size_t n);

/* The code of a length, and back: the bits of the float, without the last `n_dropped`, above those of the least length.
 */
uint32_t conic_layers_code_length(const conic_layers_attribute *attribute, unsigned n_dropped, uint32_t most,
                                  float length);
float conic_layers_length_of(const conic_layers_attribute *attribute, unsigned n_dropped, uint32_t code);

/* The size that is read where `size` was written; and the outline of an ellipse in a record. */
uint16_t conic_layers_size_as_read(const conic_layers_attribute *sizes, uint16_t size);
uint16_t conic_layers_size_of_axes(float cutoff, const unsigned char *axes);

/* A length of an axis as finely as it is kept. */
float conic_layers_axis_length(float length);

#endif
