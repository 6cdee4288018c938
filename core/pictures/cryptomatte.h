/* Cryptomatte 1.2: which things cover each pixel, and how much of it, as compositing programs read it from an EXR. A
 * thing is known by the hash of its name, written as a float. */
#pragma once

#include "conic/image.h"
#include "core/base/base.h"

/* The channels' name, before the number of their layer. */
#define CONIC_CRYPTOMATTE_NAME "CryptoObject"

/* MurmurHash3_32 of the text's bytes, from seed 0. */
uint32_t conic_cryptomatte_hash(const char *text);

/* The bits of the float that stands for a name: the hash, with one bit of the exponent changed where the float would
 * not be a normal number. Never 0. */
uint32_t conic_cryptomatte_bits(const char *name);

/* Fills a pixel of the image's matte planes from its samples; bits[i] is the thing of sample i, 0: none, and shares[i]
 * how much of the pixel that is; null: all are as much. At most 6 things are kept, the most covered first, equally
 * covered ones by their bits. */
void conic_cryptomatte_rank(const uint32_t *bits, const float *shares, size_t n_samples, conic_image *image,
                            size_t pixel);

/* The names so far, in JSON: begins as zero bytes. */
typedef struct conic_cryptomatte_manifest {
  char *text; /* complete after each addition */
  size_t length, room;
} conic_cryptomatte_manifest;

/* Adds a name. Errors: MEMORY. */
conic_status conic_cryptomatte_name(conic_context *context, conic_cryptomatte_manifest *manifest, const char *name);
void conic_cryptomatte_manifest_release(conic_context *context, conic_cryptomatte_manifest *manifest);
