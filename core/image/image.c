#include <limits.h>

#include "core/base/byte_order.h"
#include "core/base/context_struct.h"
#include "core/files/disk.h"
#include "core/image/image_common.h"
#include "core/image/texture_levels.h"

static const conic_plane_description descriptions[CONIC_N_PLANES] = {
    [CONIC_PLANE_RGBA] = {"rgba", 4, 0, {"R", "G", "B", "A"}},
    [CONIC_PLANE_Z] = {"Z", 1, 0, {"Z"}},
    [CONIC_PLANE_NORMAL] = {"N", 3, 0, {"N.X", "N.Y", "N.Z"}},
    [CONIC_PLANE_ALBEDO] = {"albedo", 3, 0, {"albedo.R", "albedo.G", "albedo.B"}},
    [CONIC_PLANE_WEIGHT] = {"weight", 1, 0, {"weight"}},
    [CONIC_PLANE_COUNT] = {"count", 1, 1, {"count"}},
    [CONIC_PLANE_ID] = {"id", 1, 1, {"id"}},
    [CONIC_PLANE_CLUSTER] = {"cluster", 1, 1, {"cluster"}},
    [CONIC_PLANE_POSITION] = {"P", 3, 0, {"P.X", "P.Y", "P.Z"}},
    [CONIC_PLANE_MATTE_0] = {"CryptoObject00",
                             4,
                             0,
                             {"CryptoObject00.R", "CryptoObject00.G", "CryptoObject00.B", "CryptoObject00.A"}},
    [CONIC_PLANE_MATTE_1] = {"CryptoObject01",
                             4,
                             0,
                             {"CryptoObject01.R", "CryptoObject01.G", "CryptoObject01.B", "CryptoObject01.A"}},
    [CONIC_PLANE_MATTE_2] = {"CryptoObject02",
                             4,
                             0,
                             {"CryptoObject02.R", "CryptoObject02.G", "CryptoObject02.B", "CryptoObject02.A"}},
    [CONIC_PLANE_TRANSPARENCY] = {"T", 1, 0, {"T"}},
    [CONIC_PLANE_MEDIAN_Z] = {"medianZ", 1, 0, {"medianZ"}},
    [CONIC_PLANE_INVERSE_Z] = {"inverseZ", 1, 0, {"inverseZ"}},
    [CONIC_PLANE_LAST] = {"last", 1, 1, {"last"}},
    [CONIC_PLANE_DOUBT] = {"doubt", 1, 1, {"doubt"}},
    [CONIC_PLANE_AO] = {"ao", 1, 0, {"ao"}},
    [CONIC_PLANE_SHADOW] = {"shadow", 1, 0, {"shadow"}},
    [CONIC_PLANE_SAMPLES] = {"samples", 1, 1, {"samples"}},
    [CONIC_PLANE_VARIANCE] = {"variance", 1, 0, {"variance"}},
    [CONIC_PLANE_MOTION] = {"motion", 4, 0, {"forward.u", "forward.v", "backward.u", "backward.v"}},
    [CONIC_PLANE_BOUND] = {"bound", 1, 0, {"bound"}},
};

const conic_plane_description *conic_plane_describe(conic_plane plane) {
  return (int)plane >= 0 && plane < CONIC_N_PLANES ? &descriptions[plane] : NULL;
}

conic_status conic_image_check_size(conic_context *context, const char *path, int width, int height,
                                    size_t pixel_bytes) {
  conic_disk_entry found;
  uint64_t image_bytes = (uint64_t)width * (uint64_t)height * pixel_bytes;
  if (context->reads_texture && conic_texture_check_room(context, path, width, height) != CONIC_OK)
    return CONIC_ERROR_INPUT;
  if (!conic_disk_look(path, &found) || !found.is_file || image_bytes >> 16 <= found.n_bytes)
    return CONIC_OK;
  return conic_fail(context, CONIC_ERROR_INPUT, "%s: %d × %d pixels cannot be in a file of %lld bytes (at byte %lld)",
                    path, width, height, (long long)found.n_bytes, (long long)found.n_bytes);
}

int conic_image_most_mib(conic_context *context, const char *path) {
  conic_disk_entry found;
  uint64_t most = INT_MAX;
  if (conic_disk_look(path, &found))
    most = 1 + (found.n_bytes >> 4);
  if (context->reads_texture && context->options.max_texture_bytes)
    most = most <= context->options.max_texture_bytes >> 20 ? most : 1 + (context->options.max_texture_bytes >> 20);
  return most < INT_MAX ? (int)most : INT_MAX;
}

conic_status conic_image_allocate(conic_context *context, int width, int height, unsigned planes, conic_image *image) {
  if (!image)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "image: no place to put it");
  memset(image, 0, sizeof *image);
  if (width < 1 || height < 1 || width > CONIC_IMAGE_MAX_SIZE || height > CONIC_IMAGE_MAX_SIZE)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "image: a size of %d × %d is outside 1 to %d", width, height,
                      CONIC_IMAGE_MAX_SIZE);
  if (planes >> CONIC_N_PLANES)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "image: there is no plane of bit %u", planes);
  image->width = width;
  image->height = height;
  for (int i = 0; i < CONIC_N_PLANES; i++) {
    if (!(planes >> i & 1))
      continue;
    size_t pixel_bytes = (size_t)descriptions[i].n_channels * 4;
    image->planes[i] = conic_memory_allocate_zeroed(context, conic_image_pixels(image), pixel_bytes);
    if (!image->planes[i]) {
      conic_image_release(context, image);
      return CONIC_ERROR_MEMORY;
    }
    conic_memory_prefer_large_pages(context, image->planes[i], conic_image_pixels(image) * pixel_bytes);
  }
  return CONIC_OK;
}

unsigned conic_image_planes(const conic_image *image) {
  unsigned planes = 0;
  for (int i = 0; i < CONIC_N_PLANES; i++)
    if (image->planes[i])
      planes |= 1u << i;
  return planes;
}

size_t conic_planes_pixel_bytes(unsigned planes) {
  size_t n_values = 0;
  for (int i = 0; i < CONIC_N_PLANES; i++)
    n_values += planes >> i & 1 ? (size_t)descriptions[i].n_channels : 0;
  return 4 * n_values;
}

void conic_image_release(conic_context *context, conic_image *image) {
  if (!image)
    return;
  for (int i = 0; i < CONIC_N_PLANES; i++)
    conic_memory_release(context, image->planes[i]);
  memset(image, 0, sizeof *image);
}

/* Hashes words whose bytes may be in another order in memory: `turned` flips the last bits of a byte's place. */
static uint64_t hash_words(uint64_t hash, const uint8_t *byte, size_t n_bytes, size_t turned) {
  for (size_t i = 0; i < n_bytes; i++)
    hash = (hash ^ byte[i ^ turned]) * UINT64_C(0x100000001b3);
  return hash;
}

uint64_t conic_hash_bytes(const void *bytes, size_t n_bytes) {
  return hash_words(CONIC_IMAGE_HASH_START, bytes, n_bytes, 0);
}

uint64_t conic_image_hash_on(uint64_t hash, const void *values, size_t n_bytes) {
  return hash_words(hash, values, n_bytes, CONIC_IS_BIG_ENDIAN ? 3 : 0);
}

uint64_t conic_image_hash(const conic_image *image, conic_plane plane) {
  const conic_plane_description *description = conic_plane_describe(plane);
  if (!description || !image->planes[plane])
    return 0;
  return conic_image_hash_on(CONIC_IMAGE_HASH_START, image->planes[plane],
                             conic_image_pixels(image) * (size_t)description->n_channels * 4);
}
