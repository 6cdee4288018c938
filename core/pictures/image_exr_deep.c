#include "core/pictures/image_exr_deep.h"

#include "core/base/message.h"

#if CONIC_HAVE_OPENEXR

#include "core/files/file.h"
#include "core/pictures/image_exr_stream.h"

#if CONIC_HAVE_ZLIB || CONIC_HAVE_LIBDEFLATE
static const exr_compression_t compression = EXR_COMPRESSION_ZIPS;
#else
static const exr_compression_t compression = EXR_COMPRESSION_NONE;
#endif

struct conic_deep_writer {
  conic_context *context;
  const char *path; /* for messages */
  conic_output *output;
  conic_exr_stream stream;
  exr_context_t file;
  int next_y;
};

/* Adds the channels in the order of their names, which is a file's order. */
static exr_result_t add_channels(exr_context_t file) {
  static const char *const names[] = {"A", "B", "G", "R", "Z", "id", "weight"};
  exr_result_t result = EXR_ERR_SUCCESS;
  for (size_t i = 0; i < sizeof names / sizeof names[0] && result == EXR_ERR_SUCCESS; i++)
    result = exr_add_channel(file, 0, names[i], strcmp(names[i], "id") == 0 ? EXR_PIXEL_UINT : EXR_PIXEL_FLOAT,
                             EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1);
  return result;
}

static exr_result_t write_header(exr_context_t file, int width, int height, uint32_t most_samples,
                                 const conic_image *header) {
  int part;
  exr_result_t result = conic_exr_prepare_attributes(file, header);
  if (result == EXR_ERR_SUCCESS)
    result = exr_add_part(file, "deep", EXR_STORAGE_DEEP_SCANLINE, &part);
  if (result == EXR_ERR_SUCCESS)
    result = exr_initialize_required_attr_simple(file, 0, width, height, compression);
  if (result == EXR_ERR_SUCCESS)
    result = exr_attr_set_int(file, 0, "version", 1);
  if (result == EXR_ERR_SUCCESS)
    result = exr_attr_set_int(file, 0, "maxSamplesPerPixel", (int32_t)most_samples);
  if (result == EXR_ERR_SUCCESS)
    result = add_channels(file);
  if (result == EXR_ERR_SUCCESS && header)
    result = conic_exr_add_attributes(file, header);
  return conic_exr_end_header(file, result);
}

static conic_status begin_parts(conic_deep_writer *writer, int width, int height, uint32_t most_samples,
                                const conic_image *header) {
  exr_context_initializer_t settings;
  conic_exr_stream_init(&writer->stream, writer->context, writer->path, conic_output_stream(writer->output), &settings);
  exr_result_t result = exr_start_write(&writer->file, writer->path, EXR_WRITE_FILE_DIRECTLY, &settings);
  if (result == EXR_ERR_SUCCESS)
    result = write_header(writer->file, width, height, most_samples, header);
  return result == EXR_ERR_SUCCESS ? CONIC_OK : conic_exr_fail(&writer->stream, result, "write", CONIC_ERROR_ARGUMENT);
}

conic_status conic_deep_open(conic_context *context, const char *path, int width, int height, uint32_t most_samples,
                             const conic_image *header, conic_deep_writer **writer) {
  *writer = NULL;
  conic_deep_writer *opened = conic_memory_allocate_zeroed(context, 1, sizeof *opened);
  if (!opened)
    return CONIC_ERROR_MEMORY;
  opened->context = context;
  opened->path = path;
  conic_status status = conic_output_open(context, path, &opened->output);
  if (status == CONIC_OK)
    status = begin_parts(opened, width, height, most_samples, header);
  if (status != CONIC_OK)
    return conic_deep_end(opened, status);
  *writer = opened;
  return CONIC_OK;
}

conic_status conic_deep_append(conic_deep_writer *writer, const conic_deep_packed *packed) {
  exr_result_t result =
      exr_write_deep_scanline_chunk(writer->file, 0, writer->next_y++, packed->samples, packed->n_samples,
                                    packed->n_unpacked, packed->ends, packed->n_ends);
  return result == EXR_ERR_SUCCESS ? CONIC_OK : conic_exr_fail(&writer->stream, result, "write", CONIC_ERROR_ARGUMENT);
}

conic_status conic_deep_end(conic_deep_writer *writer, conic_status status) {
  if (!writer)
    return status;
  exr_result_t result = writer->file ? exr_finish(&writer->file) : EXR_ERR_SUCCESS;
  if (status == CONIC_OK && result != EXR_ERR_SUCCESS)
    status = conic_exr_fail(&writer->stream, result, "write", CONIC_ERROR_ARGUMENT);
  status = conic_output_end(writer->output, status);
  conic_memory_release(writer->context, writer);
  return status;
}

#else

conic_status conic_deep_open(conic_context *context, const char *path, int width, int height, uint32_t most_samples,
                             const conic_image *header, conic_deep_writer **writer) {
  (void)width, (void)height, (void)most_samples, (void)header;
  *writer = NULL;
  return conic_fail(context, CONIC_ERROR_UNSUPPORTED, "%s: cannot write: this build is without OpenEXR", path);
}

conic_status conic_deep_append(conic_deep_writer *writer, const conic_deep_packed *packed) {
  (void)writer, (void)packed;
  return CONIC_ERROR_UNSUPPORTED;
}

conic_status conic_deep_end(conic_deep_writer *writer, conic_status status) {
  (void)writer;
  return status;
}

#endif
