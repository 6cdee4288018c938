#include "core/files/mapping.h"

#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/base/memory.h"
#include "core/base/message.h"
#include "core/files/guard.h"

/* What cannot be mapped is read to its end. */
static conic_status read_all(conic_context *context, const char *name, int descriptor, conic_mapping *mapping) {
  size_t room = 0;
  for (;;) {
    if (mapping->n_bytes == room) {
      room = 2 * room + 65536;
      conic_status status = conic_memory_grow(context, &mapping->bytes, mapping->n_bytes, room, 1);
      if (status != CONIC_OK)
        return status;
    }
    ssize_t n = read(descriptor, mapping->bytes + mapping->n_bytes, room - mapping->n_bytes);
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
  struct stat found;
  if (fstat(descriptor, &found) != 0)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: cannot read: %s", name, strerror(errno));
  if (S_ISDIR(found.st_mode))
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: cannot read: it is a directory", name);
  conic_status status = conic_guard_note(context, &found);
  if (status != CONIC_OK)
    return status;
  if (!S_ISREG(found.st_mode) || found.st_size == 0)
    return read_all(context, name, descriptor, mapping);
  void *bytes = mmap(NULL, (size_t)found.st_size, PROT_READ, MAP_PRIVATE, descriptor, 0);
  if (bytes == MAP_FAILED)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: cannot map: %s", name, strerror(errno));
  mapping->bytes = bytes;
  mapping->n_bytes = (size_t)found.st_size;
  mapping->is_mapped = 1;
  return CONIC_OK;
}

conic_status conic_mapping_open(conic_context *context, const char *path, conic_mapping *mapping) {
  int is_standard = strcmp(path, "-") == 0;
  const char *name = is_standard ? "standard input" : path;
  memset(mapping, 0, sizeof *mapping);
  int descriptor = is_standard ? STDIN_FILENO : open(path, O_RDONLY | O_CLOEXEC);
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
    munmap(mapping->bytes, mapping->n_bytes);
  else
    conic_memory_release(context, mapping->bytes);
  memset(mapping, 0, sizeof *mapping);
}

static uint64_t mix_word(uint64_t sum, uint64_t word) {
  sum = (sum ^ word) * UINT64_C(0x9e3779b97f4a7c15); /* both steps can be undone, so no word's change is lost */
  return sum << 29 | sum >> 35;
}

unsigned long long conic_checksum(const unsigned char *bytes, size_t n_bytes) {
  uint64_t lanes[4] = {1, 2, 3, 4}, sum = n_bytes;
  size_t i = 0;
  for (; i + 32 <= n_bytes; i += 32)
    for (int lane = 0; lane < 4; lane++) {
      uint64_t word;
      memcpy(&word, bytes + i + (size_t)lane * 8, sizeof word);
      lanes[lane] = mix_word(lanes[lane], word);
    }
  for (int lane = 0; lane < 4; lane++)
    sum = mix_word(sum, lanes[lane]);
  for (; i < n_bytes; i++)
    sum = mix_word(sum, bytes[i]);
  return mix_word(sum ^ sum >> 32, 0);
}
