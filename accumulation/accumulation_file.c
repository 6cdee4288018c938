/* Sums in a file, all in little-endian order:
 *
 *   8 bytes   "conicsum"
 *   4 × 4     version 1; width; height; planes, as bits
 *   4 × 8     first sample; number of samples; of these, those in the half; key
 *   16 a channel and pixel: the whole part, and the one behind the point
 *   8 bytes   a hash of all that */

#include "accumulation/accumulation_struct.h"
#include "core/base/byte_order.h"
#include "core/base/random.h"
#include "core/files/disk.h"
#include "core/files/file.h"
#include "core/image/image_common.h"

enum { HEAD_BYTES = 56, VERSION = 1, WORDS_TOGETHER = 1 << 12 };

static const char magic[8] = {'c', 'o', 'n', 'i', 'c', 's', 'u', 'm'};

static uint64_t hash_word(uint64_t hash, uint64_t word) {
  return conic_random_mix(hash ^ word) + UINT64_C(0x9e3779b97f4a7c15);
}

static size_t sums_of(const conic_accumulation *a) {
  return (size_t)a->width * (size_t)a->height * a->n_channels;
}

static void store_head(const conic_accumulation *a, uint8_t head[HEAD_BYTES]) {
  const uint64_t numbers[4] = {a->first_sample, a->n_samples, a->n_half, a->key};
  memcpy(head, magic, sizeof magic);
  conic_store_32(head + 8, VERSION);
  conic_store_32(head + 12, (uint32_t)a->width);
  conic_store_32(head + 16, (uint32_t)a->height);
  conic_store_32(head + 20, a->planes);
  for (size_t i = 0; i < 4; i++)
    conic_store_64(head + 24 + 8 * i, numbers[i]);
}

static uint64_t hash_head(const uint8_t head[HEAD_BYTES]) {
  uint64_t hash = 0;
  for (int i = 0; i < HEAD_BYTES; i += 8)
    hash = hash_word(hash, conic_load_64(head + i));
  return hash;
}

conic_status conic_accumulation_write(const conic_accumulation *sums, const char *path) {
  uint8_t head[HEAD_BYTES], bytes[16 * WORDS_TOGETHER];
  conic_output *output;
  size_t n = sums_of(sums);
  conic_status status = conic_output_open(sums->context, path, &output);
  if (status != CONIC_OK)
    return status;
  FILE *stream = conic_output_stream(output);
  store_head(sums, head);
  uint64_t hash = hash_head(head);
  fwrite(head, 1, sizeof head, stream); /* the stream remembers failures, and commit reports them */
  for (size_t first = 0; first < n; first += WORDS_TOGETHER) {
    size_t n_now = n - first < WORDS_TOGETHER ? n - first : WORDS_TOGETHER;
    for (size_t i = 0; i < n_now; i++) {
      const conic_exact_sum *sum = &sums->sums[first + i];
      conic_store_64(bytes + 16 * i, sum->whole);
      conic_store_64(bytes + 16 * i + 8, sum->part);
      hash = hash_word(hash_word(hash, sum->whole), sum->part);
    }
    fwrite(bytes, 16, n_now, stream);
  }
  conic_store_64(bytes, hash);
  fwrite(bytes, 8, 1, stream);
  return conic_output_end(output, CONIC_OK);
}

/* Makes the sums that a head describes, whose bytes must follow it; null after a message. */
static conic_status make_from_head(conic_context *context, const char *path, const uint8_t head[HEAD_BYTES],
                                   uint64_t n_bytes, conic_accumulation **made) {
  uint32_t width = conic_load_32(head + 12), height = conic_load_32(head + 16), planes = conic_load_32(head + 20);
  uint64_t first = conic_load_64(head + 24), n = conic_load_64(head + 32), n_half = conic_load_64(head + 40);
  if (memcmp(head, magic, sizeof magic) != 0 || conic_load_32(head + 8) != VERSION)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: cannot read: it holds no sums of samples", path);
  if (width < 1 || height < 1 || width > CONIC_IMAGE_MAX_SIZE || height > CONIC_IMAGE_MAX_SIZE || !planes ||
      planes & ~CONIC_ACCUMULATED_PLANES || first >= CONIC_MAX_ACCUMULATED || n > CONIC_MAX_ACCUMULATED - first ||
      n_half > n)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: a number of its head is out of range (at byte 12)", path);
  uint64_t n_channels = conic_accumulation_channel(planes, CONIC_N_PLANES) + 1;
  if (n_bytes != HEAD_BYTES + 16 * n_channels * width * height + 8)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: cannot read: it has %llu bytes, which is not what its head says",
                      path, (unsigned long long)n_bytes);
  conic_status status = conic_accumulation_create(context, (int)width, (int)height, planes, first, made);
  if (status != CONIC_OK)
    return status;
  (*made)->n_samples = n;
  (*made)->n_half = n_half;
  (*made)->key = conic_load_64(head + 48);
  return CONIC_OK;
}

static conic_status read_sums(conic_context *context, const char *path, FILE *file, uint64_t hash,
                              conic_accumulation *sums) {
  uint8_t bytes[16 * WORDS_TOGETHER];
  size_t n = sums_of(sums);
  for (size_t first = 0; first < n; first += WORDS_TOGETHER) {
    size_t n_now = n - first < WORDS_TOGETHER ? n - first : WORDS_TOGETHER;
    if (fread(bytes, 16, n_now, file) != n_now)
      return conic_fail(context, CONIC_ERROR_INPUT, "%s: cannot read: it ends too early", path);
    for (size_t i = 0; i < n_now; i++) {
      conic_exact_sum *sum = &sums->sums[first + i];
      sum->whole = conic_load_64(bytes + 16 * i);
      sum->part = conic_load_64(bytes + 16 * i + 8);
      hash = hash_word(hash_word(hash, sum->whole), sum->part);
    }
  }
  if (fread(bytes, 8, 1, file) != 1 || conic_load_64(bytes) != hash)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: is damaged: its sums are not those of its hash", path);
  return CONIC_OK;
}

conic_status conic_accumulation_read(conic_context *context, const char *path, conic_accumulation **sums) {
  uint8_t head[HEAD_BYTES];
  conic_disk_entry entry = {0};
  if (!sums)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "accumulation: no place to put it");
  *sums = NULL;
  errno = 0;
  if (!path || !conic_disk_look(path, &entry) || !entry.is_file)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: cannot read: %s", path ? path : "",
                      errno ? strerror(errno) : "it is no regular file");
  FILE *file = conic_disk_open_stream(path, "rb");
  if (!file)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: cannot read: %s", path, strerror(errno));
  conic_status status =
      fread(head, 1, sizeof head, file) == sizeof head
          ? make_from_head(context, path, head, entry.n_bytes, sums)
          : conic_fail(context, CONIC_ERROR_INPUT, "%s: cannot read: it holds no sums of samples", path);
  if (*sums)
    status = read_sums(context, path, file, hash_head(head), *sums);
  fclose(file);
  if (status != CONIC_OK) {
    conic_accumulation_destroy(*sums);
    *sums = NULL;
  }
  return status;
}
