/* Functions that the image code shares inside the library. */
#pragma once

#include "conic/image.h"
#include "core/base/base.h"

#define CONIC_IMAGE_MAX_SIZE 65535

static inline size_t conic_image_pixels(const conic_image *image) {
  return (size_t)image->width * (size_t)image->height;
}

/* Bytes a pixel of all these planes together. */
size_t conic_planes_pixel_bytes(unsigned planes);

static inline size_t conic_image_plane_bytes(const conic_image *image, int plane) {
  return conic_image_pixels(image) * conic_planes_pixel_bytes(1u << plane);
}

/* Whether two floats have the same bits: -0 differs from 0, and a NaN equals itself. */
static inline int conic_same_bits(float a, float b) {
  uint32_t bits_a, bits_b;
  memcpy(&bits_a, &a, sizeof a);
  memcpy(&bits_b, &b, sizeof b);
  return bits_a == bits_b;
}

/* Refuses a picture that takes more than 2¹⁶ bytes of memory for each byte of its file, so that the file bounds the
 * memory. Lossless compression stays under 2¹¹ for all but flat pictures, and far under 2¹⁶ for those. Also refuses a
 * picture for a texture that there is no room for. Errors: INPUT. */
conic_status conic_image_check_size(conic_context *context, const char *path, int width, int height,
                                    size_t pixel_bytes);

/* The same as a bound on all samples of the file's picture, for callers who check before the size is known. */
int conic_image_most_mib(conic_context *context, const char *path);

/* 64-bit FNV-1a. */
uint64_t conic_hash_bytes(const void *bytes, size_t n_bytes);

/* conic_image_hash of one plane row by row: the hash of no pixels, and of more pixels that follow. */
#define CONIC_IMAGE_HASH_START UINT64_C(0xcbf29ce484222325)
uint64_t conic_image_hash_on(uint64_t hash, const void *values, size_t n_bytes);
