#include "core/files/scratch.h"

#include <unistd.h>

#include "core/files/disk.h"
#include "core/files/file.h"

static conic_status complain(const conic_scratch *scratch, const char *doing, const char *why) {
  return conic_fail(scratch->context, CONIC_ERROR_IO, "%s: cannot %s%s: %s", scratch->path, doing,
                    scratch->is_named ? "" : " a temporary file beside it", why);
}

conic_status conic_scratch_open(conic_context *context, const char *path, conic_scratch *scratch) {
  static const char pattern[] = CONIC_SCRATCH_START "XXXXXX";
  size_t folder_length = (size_t)(conic_file_name(path) - path);
  *scratch = (conic_scratch){context, path, -1, 0};
  char *name = conic_memory_allocate(context, folder_length + sizeof pattern, 1);
  if (!name)
    return CONIC_ERROR_MEMORY;
  memcpy(name, path, folder_length);
  memcpy(name + folder_length, pattern, sizeof pattern);
  scratch->descriptor = conic_disk_create_nameless(name);
  conic_status status = scratch->descriptor >= 0 ? CONIC_OK : complain(scratch, "write", strerror(errno));
  conic_memory_release(context, name);
  return status;
}

void conic_scratch_close(conic_scratch *scratch) {
  if (scratch->context && scratch->descriptor >= 0)
    close(scratch->descriptor);
  scratch->descriptor = -1;
}

conic_status conic_scratch_write(const conic_scratch *scratch, uint64_t at, const void *bytes, size_t n_bytes) {
  for (size_t done = 0; done < n_bytes;) {
    ptrdiff_t n = conic_disk_write_at(scratch->descriptor, (const char *)bytes + done, n_bytes - done, at + done);
    if (n < 0 && errno == EINTR)
      continue;
    if (n <= 0)
      return complain(scratch, "write", strerror(errno));
    done += (size_t)n;
  }
  return CONIC_OK;
}

conic_status conic_scratch_read(const conic_scratch *scratch, uint64_t at, void *bytes, size_t n_bytes) {
  for (size_t done = 0; done < n_bytes;) {
    ptrdiff_t n = conic_disk_read_at(scratch->descriptor, (char *)bytes + done, n_bytes - done, at + done);
    if (n < 0 && errno == EINTR)
      continue;
    if (n <= 0)
      return complain(scratch, "read", n < 0 ? strerror(errno) : "it is too short");
    done += (size_t)n;
  }
  return CONIC_OK;
}
