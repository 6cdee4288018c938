#include "core/files/mapping.h"

#include <errno.h>
#include <stdint.h>
#include <string.h>
#include <unistd.h>

#include "core/base/byte_order.h"
#include "core/base/memory.h"
#include "core/base/message.h"
#include "core/files/disk.h"
#include "core/files/guard.h"

/* Reads a file that cannot be mapped to its end. */
static conic_status read_all(conic_context *context, const char *name, int descriptor, conic_mapping *mapping) {
  size_t room = 0;
  for (;;) {
    if (mapping->n_bytes == room) {
      room = 2 * room + 65536;
      conic_status status = conic_memory_grow(context, &mapping->bytes, mapping->n_bytes, room, 1);
      if (status != CONIC_OK)
        return status;
    }
    ptrdiff_t n = conic_disk_read(descriptor, mapping->bytes + mapping->n_bytes, room - mapping->n_bytes);
    if (n == 0)
      return CONIC_OK;
    if (n < 0 && errno == EINTR && conic_progress(context, "read", 0.0) != CONIC_OK)
      return CONIC_ERROR_CANCELLED;
    if (n < 0 && errno != EINTR)
      return conic_fail(context, CONIC_ERROR_INPUT, "%s: cannot read: %s (at byte %zu)", name, strerror(errno),
                        mapping->n_bytes);
    mapping->n_bytes += n > 0 ? (size_t)n : 0;
  }
}

static conic_status map(conic_context *context, const char *name, int descriptor, conic_mapping *mapping) {
  conic_disk_entry found;
  if (!conic_disk_look_at(descriptor, &found))
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: cannot read: %s", name, strerror(errno));
  if (found.is_folder)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: cannot read: it is a directory", name);
  conic_status status = conic_guard_note(context, name, &found);
  if (status != CONIC_OK)
    return status;
  if (!found.is_file || found.n_bytes == 0)
    return read_all(context, name, descriptor, mapping);
  void *bytes = found.n_bytes <= SIZE_MAX ? conic_disk_map(descriptor, (size_t)found.n_bytes) : NULL;
  if (!bytes)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: cannot map: %s", name, strerror(errno));
  mapping->bytes = bytes;
  mapping->n_bytes = (size_t)found.n_bytes;
  mapping->is_mapped = 1;
  return CONIC_OK;
}

conic_status conic_mapping_open(conic_context *context, const char *path, conic_mapping *mapping) {
  int is_standard = strcmp(path, "-") == 0;
  const char *name = is_standard ? "standard input" : path;
  memset(mapping, 0, sizeof *mapping);
  int descriptor = is_standard ? STDIN_FILENO : conic_disk_open(path);
  if (descriptor < 0)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: cannot read: %s", path, strerror(errno));
  conic_status status = map(context, name, descriptor, mapping);
  if (!is_standard)
    close(descriptor);
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
