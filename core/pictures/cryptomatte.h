/* Cryptomatte 1.2: of every pixel which things cover it, and how much of it, as compositing programs read it from an
 * EXR. A thing is known by the hash of its name, written as a float. */
#ifndef CONIC_CRYPTOMATTE_H
#define CONIC_CRYPTOMATTE_H

#include <stddef.h>
#include <stdint.h>

#include "conic/image.h"

/* What the channels are called by, before the number of their layer. */
#define CONIC_CRYPTOMATTE_NAME "CryptoObject"

/* MurmurHash3_32 of the text's bytes, from seed 0. */
uint32_t conic_cryptomatte_hash(const char *text);

/* The bits of the float that stands for a name: the hash, but for one bit of the exponent where that would make it no
 * normal number. Never 0. */
uint32_t conic_cryptomatte_bits(const char *name);

/* Fills a pixel of the image's matte planes from its samples, of each of which `bits` is its thing's, or 0: nothing's.
 * At most 6 things are kept, the most covered first, and those that cover as much by their bits. */
void conic_cryptomatte_rank(const uint32_t *bits, size_t n_samples, conic_image *image, size_t pixel);

/* The names that there are, in JSON: begins as zero bytes. */
typedef struct conic_cryptomatte_manifest {
  char *text; /* whole after each addition */
  size_t length, room;
} conic_cryptomatte_manifest;

/* Errors: MEMORY. */
conic_status conic_cryptomatte_name(conic_context *context, conic_cryptomatte_manifest *manifest, const char *name);
void conic_cryptomatte_manifest_release(conic_context *context, conic_cryptomatte_manifest *manifest);

#endif
