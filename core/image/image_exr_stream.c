#if CONIC_HAVE_OPENEXR

#include "core/image/image_exr_stream.h"

#include <errno.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/base/message.h"
#include "core/image/image_common.h"

static conic_exr_stream *stream_of(exr_const_context_t file) {
  void *data = NULL;
  if (!file || exr_get_user_data(file, &data) != EXR_ERR_SUCCESS)
    return NULL;
  return data;
}

/* Called on whichever thread failed, so the message is kept and logged by the calling one. */
static void keep_message(exr_const_context_t file, exr_result_t code, const char *message) {
  conic_exr_stream *stream = stream_of(file);
  (void)code;
  if (stream && !atomic_flag_test_and_set(&stream->has_message))
    snprintf(stream->message, sizeof stream->message, "%s", message);
}

static int64_t write_bytes(exr_const_context_t file, void *data, const void *bytes, uint64_t n_bytes, uint64_t offset,
                           exr_stream_error_func_ptr_t report) {
  conic_exr_stream *stream = data;
  (void)file;
  (void)report;
  errno = 0;
  if ((int64_t)offset != stream->position && fseeko(stream->file, (off_t)offset, SEEK_SET) != 0) {
    stream->error = errno;
    return -1;
  }
  size_t n = fwrite(bytes, 1, (size_t)n_bytes, stream->file);
  stream->position = (int64_t)(offset + n);
  if (n != n_bytes) {
    stream->error = errno ? errno : EIO;
    return -1;
  }
  return (int64_t)n;
}

static int64_t read_bytes(exr_const_context_t file, void *data, void *bytes, uint64_t n_bytes, uint64_t offset,
                          exr_stream_error_func_ptr_t report) {
  conic_exr_stream *stream = data;
  uint64_t n = 0;
  (void)file;
  (void)report;
  while (n < n_bytes) {
    ssize_t got = pread(fileno(stream->file), (char *)bytes + n, (size_t)(n_bytes - n), (off_t)(offset + n));
    if (got < 0 && errno == EINTR)
      continue;
    if (got < 0)
      return -1;
    if (got == 0)
      break;
    n += (uint64_t)got;
  }
  return (int64_t)n;
}

static int64_t size_of_file(exr_const_context_t file, void *data) {
  conic_exr_stream *stream = data;
  struct stat status;
  (void)file;
  return fstat(fileno(stream->file), &status) == 0 && S_ISREG(status.st_mode) ? (int64_t)status.st_size : -1;
}

void conic_exr_stream_init(conic_exr_stream *stream, conic_context *context, const char *path, FILE *file,
                           exr_context_initializer_t *settings) {
  memset(stream, 0, sizeof *stream);
  stream->context = context;
  stream->path = path;
  stream->file = file;
  atomic_flag_clear(&stream->has_message);
  exr_context_initializer_t defaults = EXR_DEFAULT_CONTEXT_INITIALIZER;
  *settings = defaults;
  settings->user_data = stream;
  settings->error_handler_fn = keep_message;
  settings->read_fn = read_bytes;
  settings->size_fn = size_of_file;
  settings->write_fn = write_bytes;
  settings->max_image_width = CONIC_IMAGE_MAX_SIZE;
  settings->max_image_height = CONIC_IMAGE_MAX_SIZE;
}

conic_status conic_exr_fail(conic_exr_stream *stream, exr_result_t result, const char *doing, conic_status otherwise) {
  const char *message = stream->message[0] ? stream->message : exr_get_default_error_message(result);
  if (result == EXR_ERR_OUT_OF_MEMORY)
    return conic_fail(stream->context, CONIC_ERROR_MEMORY, "%s: cannot %s: out of memory", stream->path, doing);
  if (stream->error)
    return conic_fail(stream->context, CONIC_ERROR_IO, "%s: cannot %s: %s", stream->path, doing,
                      strerror(stream->error));
  if (result == EXR_ERR_FEATURE_NOT_IMPLEMENTED)
    otherwise = CONIC_ERROR_UNSUPPORTED;
  return conic_fail(stream->context, otherwise, "%s: cannot %s: %s", stream->path, doing, message);
}

#else
typedef int conic_exr_stream_is_not_built;
#endif
