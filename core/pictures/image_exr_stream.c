#if CONIC_HAVE_OPENEXR

#include "core/pictures/image_exr_stream.h"
#include "core/files/disk.h"

#include <errno.h>
#include <string.h>

#include "core/base/message.h"
#include "core/image/image_common.h"
#include "core/pictures/picture_shot.h"

/* The file whose header this thread writes. The library is locked while it reports what is wrong with one, and would
 * wait for itself for ever if it were asked then whose file it is. */
static _Thread_local conic_exr_stream *described;

static conic_exr_stream *stream_of(exr_const_context_t file) {
  void *data = described;
  if (data)
    return data;
  if (!file || exr_get_user_data(file, &data) != EXR_ERR_SUCCESS)
    return NULL;
  return data;
}

/* Called on the thread that failed; the message is kept, and the calling thread logs it. */
static void keep_message(exr_const_context_t file, exr_result_t code, const char *message) {
  conic_exr_stream *stream = stream_of(file);
  (void)code;
  if (stream && !atomic_flag_test_and_set(&stream->has_message))
    snprintf(stream->message, sizeof stream->message, "%s", message);
}

static int64_t write_bytes(exr_const_context_t file, void *data, const void *bytes, uint64_t n_bytes, uint64_t offset,
                           exr_stream_error_func_ptr_t report) {
  conic_exr_stream *stream = data;
  (void)file, (void)report;
  errno = 0;
  if (!stream->file)
    return (int64_t)n_bytes;
  if ((int64_t)offset != stream->position && fseeko(stream->file, (off_t)offset, SEEK_SET) != 0) {
    stream->error = errno;
    return -1;
  }
  size_t n = fwrite(bytes, 1, (size_t)n_bytes, stream->file);
  stream->position = (int64_t)(offset + n);
  stream->length = stream->position > stream->length ? stream->position : stream->length;
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
  (void)file, (void)report;
  while (n < n_bytes) {
    ptrdiff_t got = conic_disk_read_at(fileno(stream->file), (char *)bytes + n, (size_t)(n_bytes - n), offset + n);
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
  conic_disk_entry entry;
  (void)file;
  return conic_disk_look_at(fileno(stream->file), &entry) && entry.is_file ? (int64_t)entry.n_bytes : -1;
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

static exr_result_t add_floats(exr_context_t file, const conic_attribute *attribute) {
  float values[16];
  for (int i = 0; i < 16; i++)
    values[i] = (float)attribute->values[i];
  if (attribute->type == CONIC_ATTRIBUTE_FLOAT)
    return exr_attr_set_float(file, 0, attribute->name, values[0]);
  if (attribute->type == CONIC_ATTRIBUTE_FLOAT_PAIR)
    return exr_attr_set_v2f(file, 0, attribute->name, &(exr_attr_v2f_t){.x = values[0], .y = values[1]});
  if (attribute->type == CONIC_ATTRIBUTE_CHROMATICITIES) {
    exr_attr_chromaticities_t chromaticities;
    memcpy(&chromaticities, values, sizeof chromaticities);
    return exr_attr_set_chromaticities(file, 0, attribute->name, &chromaticities);
  }
  exr_attr_m44f_t matrix;
  memcpy(matrix.m, values, sizeof matrix.m);
  return exr_attr_set_m44f(file, 0, attribute->name, &matrix);
}

static exr_result_t add_attribute(exr_context_t file, const conic_attribute *attribute) {
  exr_attr_m44d_t matrix;
  switch (attribute->type) {
  case CONIC_ATTRIBUTE_TEXT:
    return exr_attr_set_string(file, 0, attribute->name, attribute->text);
  case CONIC_ATTRIBUTE_DOUBLE:
    return exr_attr_set_double(file, 0, attribute->name, attribute->values[0]);
  case CONIC_ATTRIBUTE_MATRIX:
    memcpy(matrix.m, attribute->values, sizeof matrix.m);
    return exr_attr_set_m44d(file, 0, attribute->name, &matrix);
  case CONIC_ATTRIBUTE_FLOAT:
  case CONIC_ATTRIBUTE_FLOAT_PAIR:
  case CONIC_ATTRIBUTE_FLOAT_MATRIX:
  case CONIC_ATTRIBUTE_CHROMATICITIES:
    return add_floats(file, attribute);
  }
  return EXR_ERR_INVALID_ARGUMENT;
}

/* Old readers refuse files with names over 31 bytes, which need a flag: it is set only for such names. */
static int has_long_name(const conic_image *image) {
  for (int i = 0; i < image->n_attributes; i++)
    if (strlen(image->attributes[i].name) > 31)
      return 1;
  return 0;
}

exr_result_t conic_exr_prepare_attributes(exr_context_t file, const conic_image *image) {
  described = stream_of(file);
  return image && has_long_name(image) ? exr_set_longname_support(file, 1) : EXR_ERR_SUCCESS;
}

exr_result_t conic_exr_end_header(exr_context_t file, exr_result_t result) {
  if (result == EXR_ERR_SUCCESS)
    result = exr_write_header(file);
  described = NULL;
  return result;
}

exr_result_t conic_exr_add_attributes(exr_context_t file, const conic_image *image) {
  exr_result_t result = EXR_ERR_SUCCESS;
  for (int i = 0; result == EXR_ERR_SUCCESS && i < image->n_attributes; i++)
    result = add_attribute(file, &image->attributes[i]);
  if (result == EXR_ERR_SUCCESS && image->shot)
    result = exr_attr_set_string(file, 0, CONIC_SHOT_KEYWORD, image->shot);
  return result;
}

#else
typedef int conic_exr_stream_is_not_built;
#endif
