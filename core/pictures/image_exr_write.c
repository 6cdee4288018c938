#include "core/pictures/image_exr.h"

#include "core/base/message.h"

#if CONIC_HAVE_OPENEXR

#include <errno.h>
#include <string.h>

#include "core/base/memory.h"
#include "core/base/threads.h"
#include "core/files/disk.h"
#include "core/files/file.h"
#include "core/pictures/cryptomatte.h"
#include "core/pictures/image_channels.h"
#include "core/pictures/image_exr_stream.h"

/* zlib's level. 4, the library's default, makes files at most 5 % smaller and takes up to a half longer. */
enum { ZIP_LEVEL = 2 };

/* One chunk of scanlines on its way: compressed on any thread, written in order by the calling one. */
typedef struct exr_chunk {
  exr_encode_pipeline_t pipeline; /* its buffers serve chunk after chunk */
  exr_chunk_info_t info;
  exr_result_t result;
} exr_chunk;

typedef struct exr_writer {
  const conic_image *image;
  const conic_image_options *options;
  exr_context_t file;
  exr_chunk *chunks;
  conic_status status; /* whether it is to go on */
} exr_writer;

static exr_compression_t compression_of(const conic_image_options *options) {
  static const exr_compression_t compressions[CONIC_N_COMPRESSIONS] = {EXR_COMPRESSION_ZIP, EXR_COMPRESSION_NONE,
                                                                       EXR_COMPRESSION_RLE, EXR_COMPRESSION_ZIPS,
                                                                       EXR_COMPRESSION_PIZ, EXR_COMPRESSION_PXR24};
  return compressions[options->compression];
}

/* Places, depths and sums need floats; colours and directions look the same in half. */
static exr_pixel_type_t type_of(int i_plane, const conic_image_options *options) {
  int is_looked_at = i_plane == CONIC_PLANE_RGBA || i_plane == CONIC_PLANE_NORMAL || i_plane == CONIC_PLANE_ALBEDO;
  if (conic_plane_describe((conic_plane)i_plane)->is_uint)
    return EXR_PIXEL_UINT;
  return is_looked_at && options->is_half ? EXR_PIXEL_HALF : EXR_PIXEL_FLOAT;
}

static exr_result_t add_channels(exr_context_t file, const exr_writer *writer) {
  const conic_image *image = writer->image;
  for (int i = 0; i < CONIC_N_PLANES; i++) {
    const conic_plane_description *plane = conic_plane_describe((conic_plane)i);
    for (int c = 0; image->planes[i] && c < plane->n_channels; c++) {
      exr_result_t result =
          exr_add_channel(file, 0, plane->channels[c], type_of(i, writer->options), EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1);
      if (result != EXR_ERR_SUCCESS)
        return result;
    }
  }
  return EXR_ERR_SUCCESS;
}

/* What readers of a Cryptomatte look for. */
static exr_result_t describe_mattes(exr_context_t file, const conic_image *image) {
  const char *const values[][2] = {{"name", CONIC_CRYPTOMATTE_NAME},
                                   {"hash", "MurmurHash3_32"},
                                   {"conversion", "uint32_to_float32"},
                                   {"manifest", image->manifest}};
  exr_result_t result = EXR_ERR_SUCCESS;
  for (size_t i = 0; i < sizeof values / sizeof *values && result == EXR_ERR_SUCCESS; i++) {
    char key[32];
    snprintf(key, sizeof key, "cryptomatte/%.7x/%s", (unsigned)conic_cryptomatte_bits(CONIC_CRYPTOMATTE_NAME) >> 4,
             values[i][0]);
    if (values[i][1])
      result = exr_attr_set_string(file, 0, key, values[i][1]);
  }
  return result;
}

/* By the attribute of OpenEXR 3.4 that names a colour space; linear colours have their chromaticities. */
static exr_result_t describe_display(exr_context_t file, const conic_image *image) {
  if (!image->is_display || !image->planes[CONIC_PLANE_RGBA])
    return EXR_ERR_SUCCESS;
  return exr_attr_set_string(file, 0, CONIC_EXR_COLOR_SPACE, CONIC_EXR_DISPLAY);
}

static exr_result_t write_header(exr_context_t file, const exr_writer *writer) {
  const conic_image *image = writer->image;
  exr_compression_t compression = compression_of(writer->options);
  int part;
  exr_result_t result = conic_exr_prepare_attributes(file, image);
  if (result == EXR_ERR_SUCCESS)
    result = exr_add_part(file, NULL, EXR_STORAGE_SCANLINE, &part);
  if (result == EXR_ERR_SUCCESS)
    result = exr_initialize_required_attr_simple(file, 0, image->width, image->height, compression);
  if (result == EXR_ERR_SUCCESS && (compression == EXR_COMPRESSION_ZIP || compression == EXR_COMPRESSION_ZIPS))
    result = exr_set_zip_compression_level(file, 0, ZIP_LEVEL);
  if (result == EXR_ERR_SUCCESS)
    result = add_channels(file, writer);
  if (result == EXR_ERR_SUCCESS)
    result = conic_exr_add_attributes(file, image);
  if (result == EXR_ERR_SUCCESS && conic_image_planes(image) & CONIC_MATTE_PLANES)
    result = describe_mattes(file, image);
  if (result == EXR_ERR_SUCCESS)
    result = describe_display(file, image);
  if (result == EXR_ERR_SUCCESS)
    result = exr_write_header(file);
  return result;
}

static void point_channels(exr_encode_pipeline_t *pipeline, const conic_image *image) {
  for (int i = 0; i < pipeline->channel_count; i++) {
    exr_coding_channel_info_t *channel = &pipeline->channels[i];
    conic_channel from = conic_channel_find(channel->channel_name);
    const uint8_t *first = (const uint8_t *)image->planes[from.plane] + (size_t)from.channel * 4;
    channel->user_pixel_stride = conic_plane_describe((conic_plane)from.plane)->n_channels * 4;
    channel->user_line_stride = channel->user_pixel_stride * image->width;
    channel->user_bytes_per_element = 4;
    channel->user_data_type = (uint16_t)(channel->data_type == EXR_PIXEL_UINT ? EXR_PIXEL_UINT : EXR_PIXEL_FLOAT);
    channel->encode_from_ptr = first + (size_t)pipeline->chunk.start_y * (size_t)channel->user_line_stride;
  }
}

static void encode_chunk(void *data, size_t i_item, int i_thread) {
  exr_writer *writer = data;
  exr_chunk *chunk = &writer->chunks[i_item];
  int is_new = !chunk->pipeline.context;
  (void)i_thread;
  if (is_new)
    chunk->result = exr_encoding_initialize(writer->file, 0, &chunk->info, &chunk->pipeline);
  else
    chunk->result = exr_encoding_update(writer->file, 0, &chunk->info, &chunk->pipeline);
  if (chunk->result != EXR_ERR_SUCCESS)
    return;
  point_channels(&chunk->pipeline, writer->image);
  if (is_new)
    chunk->result = exr_encoding_choose_default_routines(writer->file, 0, &chunk->pipeline);
  chunk->pipeline.yield_until_ready_fn = NULL;
  chunk->pipeline.write_fn = NULL;
  if (chunk->result == EXR_ERR_SUCCESS)
    chunk->result = exr_encoding_run(writer->file, 0, &chunk->pipeline);
}

/* Compresses up to n_chunks chunks side by side, writes them, and goes on. */
static exr_result_t write_chunks(conic_context *context, exr_writer *writer, size_t n_chunks) {
  exr_result_t result = EXR_ERR_SUCCESS;
  for (int y = 0; y < writer->image->height && result == EXR_ERR_SUCCESS;) {
    size_t n = 0;
    writer->status = conic_progress(context, "write", (double)y / (double)writer->image->height);
    if (writer->status != CONIC_OK)
      break;
    for (; n < n_chunks && y < writer->image->height && result == EXR_ERR_SUCCESS; n++) {
      result = exr_write_scanline_chunk_info(writer->file, 0, y, &writer->chunks[n].info);
      y = writer->chunks[n].info.start_y + writer->chunks[n].info.height;
    }
    if (result == EXR_ERR_SUCCESS)
      conic_parallel_for(context, n, encode_chunk, writer);
    for (size_t i = 0; i < n && result == EXR_ERR_SUCCESS; i++) {
      const exr_chunk *chunk = &writer->chunks[i];
      result = chunk->result;
      if (result == EXR_ERR_SUCCESS)
        result = exr_write_scanline_chunk(writer->file, 0, chunk->info.start_y, chunk->pipeline.compressed_buffer,
                                          chunk->pipeline.compressed_bytes);
    }
  }
  for (size_t i = 0; i < n_chunks; i++)
    if (writer->chunks[i].pipeline.context)
      exr_encoding_destroy(writer->file, &writer->chunks[i].pipeline);
  return result;
}

static conic_status write_stream(conic_context *context, const char *path, FILE *file, const conic_image *image,
                                 const conic_image_options *options) {
  conic_exr_stream stream;
  exr_context_initializer_t settings;
  exr_writer writer = {.image = image, .options = options};
  size_t n_chunks = 2 * (size_t)conic_context_threads(context);
  conic_exr_stream_init(&stream, context, path, file, &settings);
  writer.chunks = conic_memory_allocate_zeroed(context, n_chunks, sizeof *writer.chunks);
  if (!writer.chunks)
    return CONIC_ERROR_MEMORY;
  exr_result_t result = exr_start_write(&writer.file, path, EXR_WRITE_FILE_DIRECTLY, &settings);
  if (result == EXR_ERR_SUCCESS)
    result = write_header(writer.file, &writer);
  if (result == EXR_ERR_SUCCESS)
    result = write_chunks(context, &writer, n_chunks);
  exr_result_t finish = exr_finish(&writer.file);
  conic_memory_release(context, writer.chunks);
  if (result == EXR_ERR_SUCCESS)
    result = finish;
  if (writer.status != CONIC_OK)
    return writer.status;
  return result == EXR_ERR_SUCCESS ? CONIC_OK : conic_exr_fail(&stream, result, "write", CONIC_ERROR_ARGUMENT);
}

/* Into what cannot be gone back in, as a pipe: an EXR's beginning says where its parts are. */
static conic_status write_by_way(conic_context *context, const char *path, FILE *to, const conic_image *image,
                                 const conic_image_options *options) {
  char bytes[1 << 14];
  FILE *spool = conic_disk_open_nameless();
  if (!spool)
    return conic_fail(context, CONIC_ERROR_IO, "%s: cannot write: no temporary file: %s", path, strerror(errno));
  conic_status status = write_stream(context, path, spool, image, options);
  rewind(spool);
  for (size_t n; status == CONIC_OK && (n = fread(bytes, 1, sizeof bytes, spool)) > 0;)
    if (fwrite(bytes, 1, n, to) != n)
      break; /* the stream remembers, and commit says so */
  if (ferror(spool))
    status = conic_fail(context, CONIC_ERROR_IO, "%s: cannot write: the temporary file cannot be read", path);
  fclose(spool);
  return status;
}

conic_status conic_exr_write(conic_context *context, const char *path, const conic_image *image,
                             const conic_image_options *options) {
  conic_output *output;
  conic_status status = conic_exr_check(context, path, conic_image_planes(image), options);
  if (status == CONIC_OK)
    status = conic_output_open(context, path, &output);
  if (status != CONIC_OK)
    return status;
  FILE *stream = conic_output_stream(output);
  int is_plain = stream != stdout && ftello(stream) == 0;
  status = is_plain ? write_stream(context, path, stream, image, options)
                    : write_by_way(context, path, stream, image, options);
  return conic_output_end(output, status);
}

conic_status conic_exr_check(conic_context *context, const char *path, unsigned planes,
                             const conic_image_options *options) {
  if (planes & CONIC_MATTE_PLANES && options->compression == CONIC_COMPRESSION_PXR24)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "%s: cannot write: pxr24 loses bits by which mattes are named",
                      path);
  return CONIC_OK;
}

#else

conic_status conic_exr_check(conic_context *context, const char *path, unsigned planes,
                             const conic_image_options *options) {
  (void)planes, (void)options;
  return conic_fail(context, CONIC_ERROR_UNSUPPORTED, "%s: cannot write: this build is without OpenEXR", path);
}

conic_status conic_exr_write(conic_context *context, const char *path, const conic_image *image,
                             const conic_image_options *options) {
  return conic_exr_check(context, path, conic_image_planes(image), options);
}

#endif
