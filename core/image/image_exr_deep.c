#include "core/image/image_exr_deep.h"

#include "core/base/message.h"

#if CONIC_HAVE_OPENEXR

#include <string.h>

#include "core/base/memory.h"
#include "core/files/file.h"
#include "core/image/image_exr_stream.h"

struct conic_deep_writer {
  conic_context *context;
  const char *path; /* for messages */
  conic_output *output;
  conic_exr_stream stream;
  exr_context_t file;
  int width, next_y;
  int32_t *ends; /* of the line's pixels: how many samples up to and with each */
  void *packed;  /* the line's samples, a channel after the other */
  size_t packed_bytes;
};

/* In the order of their names, in which a file has them. */
static exr_result_t add_channels(exr_context_t file) {
  exr_result_t result = exr_add_channel(file, 0, "Z", EXR_PIXEL_FLOAT, EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1);
  if (result == EXR_ERR_SUCCESS)
    result = exr_add_channel(file, 0, "id", EXR_PIXEL_UINT, EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1);
  if (result == EXR_ERR_SUCCESS)
    result = exr_add_channel(file, 0, "weight", EXR_PIXEL_FLOAT, EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1);
  return result;
}

static exr_result_t write_header(exr_context_t file, int width, int height, uint32_t most_samples,
                                 const conic_image *header) {
  int part;
  exr_result_t result = EXR_ERR_SUCCESS;
  if (header)
    result = conic_exr_prepare_attributes(file, header);
  if (result == EXR_ERR_SUCCESS)
    result = exr_add_part(file, "deep", EXR_STORAGE_DEEP_SCANLINE, &part);
  if (result == EXR_ERR_SUCCESS)
    result = exr_initialize_required_attr_simple(file, 0, width, height, EXR_COMPRESSION_NONE);
  if (result == EXR_ERR_SUCCESS)
    result = exr_attr_set_int(file, 0, "version", 1);
  if (result == EXR_ERR_SUCCESS)
    result = exr_attr_set_int(file, 0, "maxSamplesPerPixel", (int32_t)most_samples);
  if (result == EXR_ERR_SUCCESS)
    result = add_channels(file);
  if (result == EXR_ERR_SUCCESS && header)
    result = conic_exr_add_attributes(file, header);
  if (result == EXR_ERR_SUCCESS)
    result = exr_write_header(file);
  return result;
}

static conic_status begin_parts(conic_deep_writer *writer, int height, uint32_t most_samples,
                                const conic_image *header) {
  exr_context_initializer_t settings;
  conic_exr_stream_init(&writer->stream, writer->context, writer->path, conic_output_stream(writer->output), &settings);
  writer->ends = conic_memory_allocate(writer->context, (size_t)writer->width, sizeof *writer->ends);
  if (!writer->ends)
    return CONIC_ERROR_MEMORY;
  exr_result_t result = exr_start_write(&writer->file, writer->path, EXR_WRITE_FILE_DIRECTLY, &settings);
  if (result == EXR_ERR_SUCCESS)
    result = write_header(writer->file, writer->width, height, most_samples, header);
  return result == EXR_ERR_SUCCESS ? CONIC_OK : conic_exr_fail(&writer->stream, result, "write", CONIC_ERROR_ARGUMENT);
}

conic_status conic_deep_open(conic_context *context, const char *path, int width, int height, uint32_t most_samples,
                             const conic_image *header, conic_deep_writer **writer) {
  *writer = NULL;
  conic_deep_writer *opened = conic_memory_allocate_zeroed(context, 1, sizeof *opened);
  if (!opened)
    return CONIC_ERROR_MEMORY;
  opened->context = context;
  opened->width = width;
  opened->path = path;
  conic_status status = conic_output_open(context, path, &opened->output);
  if (status == CONIC_OK)
    status = begin_parts(opened, height, most_samples, header);
  if (status == CONIC_OK)
    *writer = opened;
  else
    conic_deep_abandon(opened);
  return status;
}

/* The samples as they stand in the file; null without memory. */
static const void *pack(conic_deep_writer *writer, const conic_deep_line *line) {
  size_t n_bytes = 4 * line->n_samples;
  if (3 * n_bytes > writer->packed_bytes || !writer->packed) {
    conic_memory_release(writer->context, writer->packed);
    writer->packed_bytes = 0;
    writer->packed = conic_memory_allocate(writer->context, 3 * n_bytes, 1);
    if (!writer->packed)
      return NULL;
    writer->packed_bytes = 3 * n_bytes;
  }
  unsigned char *to = writer->packed;
  if (n_bytes) {
    memcpy(to, line->depths, n_bytes);
    memcpy(to + n_bytes, line->ids, n_bytes);
    memcpy(to + 2 * n_bytes, line->weights, n_bytes);
  }
  return to;
}

conic_status conic_deep_append(conic_deep_writer *writer, const conic_deep_line *line) {
  int32_t end = 0;
  if (line->n_samples > INT32_MAX / 12)
    return conic_fail(writer->context, CONIC_ERROR_UNSUPPORTED, "%s: cannot write: over %d samples in line %d",
                      writer->path, INT32_MAX / 12, writer->next_y);
  const void *packed = pack(writer, line);
  if (!packed)
    return CONIC_ERROR_MEMORY;
  for (int x = 0; x < writer->width; x++)
    writer->ends[x] = end += (int32_t)line->counts[x];
  uint64_t n_bytes = 12 * (uint64_t)line->n_samples;
  exr_result_t result = exr_write_deep_scanline_chunk(writer->file, 0, writer->next_y++, packed, n_bytes, n_bytes,
                                                      writer->ends, (uint64_t)writer->width * sizeof *writer->ends);
  return result == EXR_ERR_SUCCESS ? CONIC_OK : conic_exr_fail(&writer->stream, result, "write", CONIC_ERROR_ARGUMENT);
}

static void release_writer(conic_deep_writer *writer) {
  conic_memory_release(writer->context, writer->ends);
  conic_memory_release(writer->context, writer->packed);
  conic_memory_release(writer->context, writer);
}

conic_status conic_deep_finish(conic_deep_writer *writer) {
  exr_result_t result = exr_finish(&writer->file);
  conic_status status =
      result == EXR_ERR_SUCCESS ? CONIC_OK : conic_exr_fail(&writer->stream, result, "write", CONIC_ERROR_ARGUMENT);
  status = conic_output_end(writer->output, status);
  release_writer(writer);
  return status;
}

void conic_deep_abandon(conic_deep_writer *writer) {
  if (!writer)
    return;
  if (writer->file)
    exr_finish(&writer->file);
  conic_output_abandon(writer->output);
  release_writer(writer);
}

#else

conic_status conic_deep_open(conic_context *context, const char *path, int width, int height, uint32_t most_samples,
                             const conic_image *header, conic_deep_writer **writer) {
  (void)width, (void)height, (void)most_samples, (void)header;
  *writer = NULL;
  return conic_fail(context, CONIC_ERROR_UNSUPPORTED, "%s: cannot write: this build is without OpenEXR", path);
}

conic_status conic_deep_append(conic_deep_writer *writer, const conic_deep_line *line) {
  (void)writer, (void)line;
  return CONIC_ERROR_UNSUPPORTED;
}

conic_status conic_deep_finish(conic_deep_writer *writer) {
  (void)writer;
  return CONIC_ERROR_UNSUPPORTED;
}

void conic_deep_abandon(conic_deep_writer *writer) {
  (void)writer;
}

#endif
