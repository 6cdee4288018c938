#include "core/files/mapping.h"

#include "core/base/byte_order.h"
#include "core/files/disk.h"

conic_status conic_mapping_take(conic_input *input, uint64_t most, conic_mapping *mapping) {
  const uint64_t n_bytes = input->start_bytes + input->size_bytes;
  if (!input->has_size || n_bytes == 0)
    return conic_input_take_rest(input, most, &mapping->bytes, &mapping->n_bytes);
  void *bytes = n_bytes <= SIZE_MAX ? conic_disk_map(input->descriptor, (size_t)n_bytes) : NULL;
  if (!bytes)
    return conic_fail(input->context, CONIC_ERROR_INPUT, "%s: cannot map: %s", input->name, strerror(errno));
  mapping->bytes = bytes;
  mapping->n_bytes = (size_t)n_bytes;
  mapping->is_mapped = 1;
  return CONIC_OK;
}

conic_status conic_mapping_open(conic_context *context, const char *path, conic_mapping *mapping) {
  conic_input input;
  memset(mapping, 0, sizeof *mapping);
  conic_status status = conic_input_open(context, path, &input);
  if (status != CONIC_OK)
    return status;
  status = conic_mapping_take(&input, SIZE_MAX, mapping);
  conic_input_close(&input);
  if (status != CONIC_OK)
    conic_mapping_close(context, mapping);
  return status;
}

void conic_mapping_close(conic_context *context, conic_mapping *mapping) {
  if (mapping->is_mapped)
    conic_disk_unmap(mapping->bytes, mapping->n_bytes);
  else
    conic_memory_release(context, mapping->bytes);
  memset(mapping, 0, sizeof *mapping);
}

static uint64_t mix_word(uint64_t sum, uint64_t word) {
  sum = (sum ^ word) * UINT64_C(0x9e3779b97f4a7c15); /* both steps can be undone, so that every change of a word
                                                        shows */
  return sum << 29 | sum >> 35;
}

static void mix_lanes(uint64_t lanes[4], const unsigned char bytes[32]) {
  for (size_t lane = 0; lane < 4; lane++)
    lanes[lane] = mix_word(lanes[lane], conic_load_64(bytes + lane * 8));
}

void conic_checksum_begin(conic_checksumming *sum) {
  *sum = (conic_checksumming){.lanes = {1, 2, 3, 4}};
}

void conic_checksum_add(conic_checksumming *sum, const unsigned char *bytes, size_t n_bytes) {
  size_t n_rest = (size_t)(sum->n_bytes % sizeof sum->rest);
  sum->n_bytes += n_bytes;
  if (n_rest) {
    size_t n = n_bytes < sizeof sum->rest - n_rest ? n_bytes : sizeof sum->rest - n_rest;
    memcpy(sum->rest + n_rest, bytes, n);
    if (n_rest + n < sizeof sum->rest)
      return;
    mix_lanes(sum->lanes, sum->rest);
    bytes += n;
    n_bytes -= n;
  }
  for (; n_bytes >= sizeof sum->rest; n_bytes -= sizeof sum->rest, bytes += sizeof sum->rest)
    mix_lanes(sum->lanes, bytes);
  memcpy(sum->rest, bytes, n_bytes);
}

unsigned long long conic_checksum_end(const conic_checksumming *sum) {
  uint64_t all = sum->n_bytes;
  for (int lane = 0; lane < 4; lane++)
    all = mix_word(all, sum->lanes[lane]);
  for (size_t i = 0; i < sum->n_bytes % sizeof sum->rest; i++)
    all = mix_word(all, sum->rest[i]);
  return mix_word(all ^ all >> 32, 0);
}

unsigned long long conic_checksum(const unsigned char *bytes, size_t n_bytes) {
  conic_checksumming sum;
  conic_checksum_begin(&sum);
  conic_checksum_add(&sum, bytes, n_bytes);
  return conic_checksum_end(&sum);
}
