/* Packs a line of a deep EXR as the file holds it: its channels one after the other, compressed as by ZIPS. The library
 * can write such lines but cannot make them. */

#include "core/base/base.h"
#include "core/base/byte_order.h"
#include "core/pictures/image_exr_deep.h"

/* Where a sample's channels are, in the order of their names: A, B, G, R, Z, id, weight. */
static const size_t channels[] = {offsetof(conic_deep_sample, rgba) + 3 * sizeof(float),
                                  offsetof(conic_deep_sample, rgba) + 2 * sizeof(float),
                                  offsetof(conic_deep_sample, rgba) + sizeof(float),
                                  offsetof(conic_deep_sample, rgba),
                                  offsetof(conic_deep_sample, depth),
                                  offsetof(conic_deep_sample, id),
                                  offsetof(conic_deep_sample, weight)};
enum { N_CHANNELS = sizeof channels / sizeof channels[0] };

/* Makes room for n bytes. */
static int make_room(conic_context *context, unsigned char **bytes, size_t *room, size_t n) {
  if (*bytes && n <= *room)
    return 1;
  conic_memory_release(context, *bytes);
  *room = n + n / 2;
  *bytes = conic_memory_allocate(context, *room, 1);
  if (!*bytes)
    *room = 0;
  return *bytes != NULL;
}

/* Bytes that do not become fewer stay as they are. */
static int compress_bytes(conic_context *context, conic_deep_packed *packed, unsigned char *bytes, size_t *n) {
  if (!make_room(context, &packed->scratch, &packed->scratch_room, 2 * *n))
    return 0;
  unsigned char *smaller = packed->scratch + *n;
  size_t n_smaller = conic_deflate_exr(&packed->deflater, bytes, *n, packed->scratch, smaller, *n);
  if (n_smaller == 0 || n_smaller == *n)
    return 1;
  memcpy(bytes, smaller, n_smaller);
  *n = n_smaller;
  return 1;
}

conic_status conic_deep_pack(conic_context *context, const conic_deep_line *line, int width,
                             conic_deep_packed *packed) {
  int32_t end = 0;
  if (line->n_samples > INT32_MAX / (4 * N_CHANNELS))
    return conic_fail(context, CONIC_ERROR_UNSUPPORTED, "a line of a deep image has over %d samples",
                      INT32_MAX / (4 * N_CHANNELS));
  packed->n_ends = 4 * (size_t)width;
  packed->n_samples = packed->n_unpacked = (size_t)4 * N_CHANNELS * line->n_samples;
  if (!make_room(context, &packed->ends, &packed->ends_room, packed->n_ends) ||
      !make_room(context, &packed->samples, &packed->samples_room, packed->n_samples))
    return CONIC_ERROR_MEMORY;
  for (int x = 0; x < width; x++) {
    end += (int32_t)line->counts[x];
    conic_store_32(packed->ends + 4 * (size_t)x, (uint32_t)end);
  }
  for (size_t c = 0; c < N_CHANNELS; c++)
    for (size_t i = 0; i < line->n_samples; i++)
      memcpy(packed->samples + 4 * (c * line->n_samples + i), (const char *)&line->samples[i] + channels[c], 4);
  conic_turn_words(packed->samples, N_CHANNELS * line->n_samples, 4);
  return compress_bytes(context, packed, packed->ends, &packed->n_ends) &&
                 compress_bytes(context, packed, packed->samples, &packed->n_samples)
             ? CONIC_OK
             : CONIC_ERROR_MEMORY;
}

void conic_deep_packed_release(conic_context *context, conic_deep_packed *packed) {
  conic_memory_release_these(context, packed->ends, packed->samples, packed->scratch);
  conic_deflater_end(&packed->deflater);
}
