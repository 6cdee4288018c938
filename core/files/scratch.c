#include "core/files/scratch.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "core/base/memory.h"
#include "core/base/message.h"

static conic_status complain(const conic_scratch *scratch, const char *doing, const char *why) {
  return conic_fail(scratch->context, CONIC_ERROR_IO, "%s: cannot %s a temporary file beside it: %s", scratch->path,
                    doing, why);
}

conic_status conic_scratch_open(conic_context *context, const char *path, conic_scratch *scratch) {
  static const char pattern[] = ".conic-spool-XXXXXX";
  const char *slash = strrchr(path, '/');
  size_t folder_length = slash ? (size_t)(slash - path) + 1 : 0;
  *scratch = (conic_scratch){context, path, -1};
  char *name = conic_memory_allocate(context, folder_length + sizeof pattern, 1);
  if (!name)
    return CONIC_ERROR_MEMORY;
  memcpy(name, path, folder_length);
  memcpy(name + folder_length, pattern, sizeof pattern);
  scratch->descriptor = mkstemp(name);
  conic_status status = scratch->descriptor >= 0 ? CONIC_OK : complain(scratch, "write", strerror(errno));
  if (status == CONIC_OK) {
    unlink(name);
    fcntl(scratch->descriptor, F_SETFD, FD_CLOEXEC);
  }
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
    ssize_t n = pwrite(scratch->descriptor, (const char *)bytes + done, n_bytes - done, (off_t)(at + done));
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
    ssize_t n = pread(scratch->descriptor, (char *)bytes + done, n_bytes - done, (off_t)(at + done));
    if (n < 0 && errno == EINTR)
      continue;
    if (n <= 0)
      return complain(scratch, "read", n < 0 ? strerror(errno) : "it is too short");
    done += (size_t)n;
  }
  return CONIC_OK;
}
