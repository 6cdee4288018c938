/* What the image code shares inside the library. */
#ifndef CORE_IMAGE_H
#define CORE_IMAGE_H

#include <stddef.h>
#include <stdint.h>

#include "conic/image.h"

#define CONIC_IMAGE_MAX_SIZE 65535

static inline size_t conic_image_pixels(const conic_image *image) {
  return (size_t)image->width * (size_t)image->height;
}

/* 64-bit FNV-1a. */
uint64_t conic_hash_bytes(const void *bytes, size_t n_bytes);

#endif
