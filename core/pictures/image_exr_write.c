#include "core/pictures/image_exr.h"

#include "core/base/message.h"
#include "core/pictures/image_exr_bands.h"

#if CONIC_HAVE_OPENEXR

#include "core/files/deflate.h"
#include "core/files/disk.h"
#include "core/files/file.h"
#include "core/image/image_common.h"
#include "core/pictures/cryptomatte.h"
#include "core/pictures/image_channels.h"
#include "core/pictures/image_exr_stream.h"

/* Chunks of small pictures that are compressed side by side hold no more than so many bytes of pixels. */
enum { CHUNKS_BYTES = 1 << 25 };

/* zlib's level. 4, the library's default, makes files at most 5 % smaller and takes up to a half longer. */
enum { ZIP_LEVEL = 2 };

/* A chunk of scanlines: any thread compresses it, the calling one writes it in order. */
typedef struct exr_chunk {
  exr_encode_pipeline_t pipeline; /* its buffers serve chunk after chunk */
  exr_chunk_info_t info;
  exr_result_t result;
  conic_context *context;  /* of libdeflate's work … */
  conic_deflater deflater; /* … and what packs, */
  unsigned char *packed;   /* with room for the pixels, twice */
  size_t packed_room;
  int is_told; /* that there is no memory for it */
} exr_chunk;

struct conic_exr_bands {
  conic_context *context;
  const char *path; /* for messages */
  const char *part; /* null: a hidden file */
  conic_image_options options;
  unsigned planes;
  int width, height;
  conic_output *output; /* null: nothing to write */
  FILE *spool;          /* takes the bytes where the output cannot seek; null: the output does */
  conic_exr_stream stream;
  exr_context_t file;
  exr_chunk *chunks;
  size_t n_chunks;
  int next_y;              /* the first missing row of the picture */
  const conic_image *band; /* the current one … */
  int band_y;              /* … and its first row */
};

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

static exr_result_t add_channels(const conic_exr_bands *bands) {
  for (int i = 0; i < CONIC_N_PLANES; i++) {
    const conic_plane_description *plane = conic_plane_describe((conic_plane)i);
    for (int c = 0; bands->planes >> i & 1u && c < plane->n_channels; c++) {
      exr_result_t result = exr_add_channel(bands->file, 0, plane->channels[c], type_of(i, &bands->options),
                                            EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1);
      if (result != EXR_ERR_SUCCESS)
        return result;
    }
  }
  return EXR_ERR_SUCCESS;
}

/* Adds the attributes that readers of a Cryptomatte look for. */
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

/* Marks display values by OpenEXR 3.4's attribute for a colour space; linear colours have their chromaticities. */
static exr_result_t describe_display(const conic_exr_bands *bands, const conic_image *header) {
  if (!header->is_display || !(bands->planes & 1u << CONIC_PLANE_RGBA))
    return EXR_ERR_SUCCESS;
  return exr_attr_set_string(bands->file, 0, CONIC_EXR_COLOR_SPACE, CONIC_EXR_DISPLAY);
}

static exr_result_t write_header(const conic_exr_bands *bands, const conic_image *header) {
  exr_context_t file = bands->file;
  exr_compression_t compression = compression_of(&bands->options);
  int part;
  exr_result_t result = conic_exr_prepare_attributes(file, header);
  if (result == EXR_ERR_SUCCESS)
    result = exr_add_part(file, NULL, EXR_STORAGE_SCANLINE, &part);
  if (result == EXR_ERR_SUCCESS)
    result = exr_initialize_required_attr_simple(file, 0, bands->width, bands->height, compression);
  if (result == EXR_ERR_SUCCESS && (compression == EXR_COMPRESSION_ZIP || compression == EXR_COMPRESSION_ZIPS))
    result = exr_set_zip_compression_level(file, 0, ZIP_LEVEL);
  if (result == EXR_ERR_SUCCESS)
    result = add_channels(bands);
  if (result == EXR_ERR_SUCCESS)
    result = conic_exr_add_attributes(file, header);
  if (result == EXR_ERR_SUCCESS && bands->planes & CONIC_MATTE_PLANES)
    result = describe_mattes(file, header);
  if (result == EXR_ERR_SUCCESS)
    result = describe_display(bands, header);
  return conic_exr_end_header(file, result);
}

static void point_channels(const conic_exr_bands *bands, exr_encode_pipeline_t *pipeline) {
  size_t row = (size_t)(pipeline->chunk.start_y - bands->band_y);
  for (int i = 0; i < pipeline->channel_count; i++) {
    exr_coding_channel_info_t *channel = &pipeline->channels[i];
    conic_channel from = conic_channel_find(channel->channel_name);
    const uint8_t *first = (const uint8_t *)bands->band->planes[from.plane] + (size_t)from.channel * 4;
    channel->user_pixel_stride = conic_plane_describe((conic_plane)from.plane)->n_channels * 4;
    channel->user_line_stride = channel->user_pixel_stride * bands->width;
    channel->user_bytes_per_element = 4;
    channel->user_data_type = (uint16_t)(channel->data_type == EXR_PIXEL_UINT ? EXR_PIXEL_UINT : EXR_PIXEL_FLOAT);
    channel->encode_from_ptr = first + row * (size_t)channel->user_line_stride;
  }
}

#if CONIC_HAVE_LIBDEFLATE

/* Packs by libdeflate in place of OpenEXR's zlib. Pixels that do not become fewer bytes stay as they are. */
static exr_result_t pack_zip(exr_encode_pipeline_t *pipeline) {
  exr_chunk *chunk = pipeline->encoding_user_data;
  size_t n = (size_t)pipeline->packed_bytes;
  if (chunk->packed_room < 2 * n) {
    conic_memory_release(chunk->context, chunk->packed);
    chunk->packed = conic_memory_allocate(chunk->context, 2 * n, 1);
    chunk->packed_room = chunk->packed ? 2 * n : 0;
  }
  chunk->is_told = !chunk->packed;
  if (!chunk->packed)
    return EXR_ERR_OUT_OF_MEMORY;
  unsigned char *smaller = chunk->packed + n;
  size_t n_smaller = conic_deflate_exr(&chunk->deflater, pipeline->packed_buffer, n, chunk->packed, smaller, n);
  if (n_smaller == 0)
    memcpy(smaller, pipeline->packed_buffer, n);
  pipeline->compressed_buffer = smaller;
  pipeline->compressed_bytes = n_smaller ? n_smaller : n;
  return EXR_ERR_SUCCESS;
}

static void pack_by_libdeflate(const conic_exr_bands *bands, exr_chunk *chunk) {
  conic_compression compression = bands->options.compression;
  if (compression != CONIC_COMPRESSION_ZIP && compression != CONIC_COMPRESSION_ZIPS)
    return;
  chunk->context = bands->context;
  chunk->pipeline.encoding_user_data = chunk;
  chunk->pipeline.compress_fn = pack_zip;
}

#else

static void pack_by_libdeflate(const conic_exr_bands *bands, exr_chunk *chunk) {
  (void)bands, (void)chunk;
}

#endif

static void encode_chunk(void *data, size_t i_item) {
  conic_exr_bands *bands = data;
  exr_chunk *chunk = &bands->chunks[i_item];
  int is_new = !chunk->pipeline.context;
  if (is_new)
    chunk->result = exr_encoding_initialize(bands->file, 0, &chunk->info, &chunk->pipeline);
  else
    chunk->result = exr_encoding_update(bands->file, 0, &chunk->info, &chunk->pipeline);
  if (chunk->result != EXR_ERR_SUCCESS)
    return;
  point_channels(bands, &chunk->pipeline);
  if (is_new)
    chunk->result = exr_encoding_choose_default_routines(bands->file, 0, &chunk->pipeline);
  pack_by_libdeflate(bands, chunk);
  chunk->pipeline.yield_until_ready_fn = NULL;
  chunk->pipeline.write_fn = NULL;
  if (chunk->result == EXR_ERR_SUCCESS)
    chunk->result = exr_encoding_run(bands->file, 0, &chunk->pipeline);
}

/* Compresses the next chunks before `end` side by side; returns how many. */
static size_t pack_next_chunks(conic_exr_bands *bands, int *y, int end, int is_alone, exr_result_t *result) {
  size_t n = 0;
  for (*result = EXR_ERR_SUCCESS; n < bands->n_chunks && *y < end && *result == EXR_ERR_SUCCESS; n++) {
    *result = exr_write_scanline_chunk_info(bands->file, 0, *y, &bands->chunks[n].info);
    *y = bands->chunks[n].info.start_y + bands->chunks[n].info.height;
  }
  for (size_t i = 0; i < n && *result == EXR_ERR_SUCCESS && is_alone; i++)
    encode_chunk(bands, i);
  if (*result == EXR_ERR_SUCCESS && !is_alone)
    conic_parallel_for(bands->context, n, encode_chunk, bands);
  return n;
}

conic_status conic_exr_pack(conic_exr_bands *bands, const conic_image *image, int first, int begin, int end,
                            int is_alone, conic_exr_receiver *receive, void *cookie) {
  exr_result_t result = EXR_ERR_SUCCESS;
  bands->band = image;
  bands->band_y = first;
  for (int y = begin; y < end;) {
    conic_status status =
        is_alone ? CONIC_OK : conic_progress(bands->context, "write", (double)y / (double)bands->height);
    size_t n = status == CONIC_OK ? pack_next_chunks(bands, &y, end, is_alone, &result) : 0;
    for (size_t i = 0; i < n && status == CONIC_OK; i++) {
      const exr_chunk *chunk = &bands->chunks[i];
      result = result == EXR_ERR_SUCCESS ? chunk->result : result;
      status = result == EXR_ERR_SUCCESS ? receive(cookie, chunk->info.start_y, chunk->info.height,
                                                   chunk->pipeline.compressed_buffer, chunk->pipeline.compressed_bytes)
               : chunk->is_told          ? CONIC_ERROR_MEMORY
                                         : conic_exr_fail(&bands->stream, result, "write", CONIC_ERROR_ARGUMENT);
    }
    if (status != CONIC_OK)
      return status;
  }
  return CONIC_OK;
}

conic_status conic_exr_bands_append_packed(conic_exr_bands *bands, int y, int n_rows, const void *bytes,
                                           size_t n_bytes) {
  if (y != bands->next_y)
    return conic_fail(bands->context, CONIC_ERROR_ARGUMENT, "%s: cannot write: no such band", bands->path);
  exr_result_t result = exr_write_scanline_chunk(bands->file, 0, y, bytes, n_bytes);
  bands->next_y = y + n_rows;
  return result == EXR_ERR_SUCCESS ? CONIC_OK : conic_exr_fail(&bands->stream, result, "write", CONIC_ERROR_ARGUMENT);
}

uint64_t conic_exr_bands_length(const conic_exr_bands *bands) {
  return (uint64_t)bands->stream.length;
}

conic_status conic_exr_bands_flush(conic_exr_bands *bands) {
  errno = 0;
  if (fflush(bands->stream.file) == 0)
    return CONIC_OK;
  bands->stream.error = errno ? errno : EIO;
  return conic_exr_fail(&bands->stream, EXR_ERR_WRITE_IO, "write", CONIC_ERROR_IO);
}

static conic_status append_next(void *cookie, int y, int n_rows, const void *bytes, size_t n_bytes) {
  return conic_exr_bands_append_packed(cookie, y, n_rows, bytes, n_bytes);
}

conic_status conic_exr_bands_append(conic_exr_bands *bands, const conic_image *band) {
  int end = bands->next_y + band->height;
  if (band->width != bands->width || end > bands->height || bands->planes & ~conic_image_planes(band) ||
      (end < bands->height && band->height % CONIC_EXR_BAND != 0))
    return conic_fail(bands->context, CONIC_ERROR_ARGUMENT, "%s: cannot write: no such band", bands->path);
  return conic_exr_pack(bands, band, bands->next_y, bands->next_y, end, 0, append_next, bands);
}

/* An EXR's beginning says where its parts are, and must be written last; a pipe cannot go back to it. */
static conic_status choose_stream(conic_exr_bands *bands, FILE **stream) {
  *stream = conic_output_stream(bands->output);
  if (*stream != stdout && ftello(*stream) == 0)
    return CONIC_OK;
  bands->spool = conic_disk_open_nameless();
  *stream = bands->spool;
  return bands->spool ? CONIC_OK
                      : conic_fail(bands->context, CONIC_ERROR_IO, "%s: cannot write: no temporary file: %s",
                                   bands->path, strerror(errno));
}

/* Bytes of the pixels of a chunk. */
static uint64_t chunk_bytes(const conic_exr_bands *bands) {
  conic_compression compression = bands->options.compression;
  uint64_t n_rows = compression == CONIC_COMPRESSION_PIZ                                             ? 32
                    : compression == CONIC_COMPRESSION_ZIP || compression == CONIC_COMPRESSION_PXR24 ? 16
                                                                                                     : 1;
  return conic_planes_pixel_bytes(bands->planes) * n_rows * (uint64_t)bands->width;
}

/* The pixels in the file's order, the compressed ones, and the memory of compressing. */
uint64_t conic_exr_packer_bytes(const conic_exr_bands *bands) {
  return 3 * bands->n_chunks * chunk_bytes(bands);
}

static conic_status begin_file(conic_exr_bands *bands, const conic_image *header, int is_packer) {
  exr_context_initializer_t settings;
  FILE *stream = NULL;
  conic_status status = is_packer     ? CONIC_OK
                        : bands->part ? conic_output_go_on(bands->context, bands->path, bands->part, &bands->output)
                                      : conic_output_open(bands->context, bands->path, &bands->output);
  if (status == CONIC_OK && !is_packer)
    status = choose_stream(bands, &stream);
  if (status != CONIC_OK)
    return status;
  uint64_t most = CHUNKS_BYTES / chunk_bytes(bands) + 1, wanted = 2 * (uint64_t)conic_context_threads(bands->context);
  bands->n_chunks = (size_t)(wanted < most ? wanted : most);
  bands->chunks = conic_memory_allocate_zeroed(bands->context, bands->n_chunks, sizeof *bands->chunks);
  if (!bands->chunks)
    return CONIC_ERROR_MEMORY;
  conic_exr_stream_init(&bands->stream, bands->context, bands->path, stream, &settings);
  exr_result_t result = exr_start_write(&bands->file, bands->path, EXR_WRITE_FILE_DIRECTLY, &settings);
  if (result == EXR_ERR_SUCCESS)
    result = write_header(bands, header);
  return result == EXR_ERR_SUCCESS ? CONIC_OK : conic_exr_fail(&bands->stream, result, "write", CONIC_ERROR_ARGUMENT);
}

static conic_status open_bands(conic_context *context, const char *path, const char *part, const conic_image *header,
                               unsigned planes, const conic_image_options *options, int is_packer,
                               conic_exr_bands **bands) {
  *bands = NULL;
  conic_status status = conic_exr_check(context, path, planes, options);
  if (status != CONIC_OK)
    return status;
  conic_exr_bands *opened = conic_memory_allocate_zeroed(context, 1, sizeof *opened);
  if (!opened)
    return CONIC_ERROR_MEMORY;
  opened->context = context;
  opened->path = path;
  opened->part = part;
  opened->options = *options;
  opened->planes = planes;
  opened->width = header->width;
  opened->height = header->height;
  status = begin_file(opened, header, is_packer);
  if (status == CONIC_OK)
    *bands = opened;
  else
    conic_exr_bands_end(opened, status);
  return status;
}

conic_status conic_exr_bands_open(conic_context *context, const char *path, const char *part, const conic_image *header,
                                  unsigned planes, const conic_image_options *options, conic_exr_bands **bands) {
  return open_bands(context, path, part, header, planes, options, 0, bands);
}

conic_status conic_exr_packer_open(conic_context *context, int width, int height, unsigned planes,
                                   const conic_image_options *options, conic_exr_bands **bands) {
  const conic_image header = {.width = width, .height = height};
  return open_bands(context, "exr", NULL, &header, planes, options, 1, bands);
}

static conic_status copy_spool(conic_exr_bands *bands) {
  char bytes[1 << 14];
  conic_status status = CONIC_OK;
  FILE *to = conic_output_stream(bands->output);
  rewind(bands->spool);
  for (size_t n; (n = fread(bytes, 1, sizeof bytes, bands->spool)) > 0;)
    if (fwrite(bytes, 1, n, to) != n)
      break; /* the stream remembers; ending the output reports it */
  if (ferror(bands->spool))
    status =
        conic_fail(bands->context, CONIC_ERROR_IO, "%s: cannot write: the temporary file cannot be read", bands->path);
  return status;
}

static conic_status finish_file(conic_exr_bands *bands, conic_status status) {
  for (size_t i = 0; bands->chunks && i < bands->n_chunks; i++) {
    exr_chunk *chunk = &bands->chunks[i];
    if (chunk->pipeline.context)
      exr_encoding_destroy(bands->file, &chunk->pipeline);
    conic_deflater_end(&chunk->deflater);
    conic_memory_release(bands->context, chunk->packed);
  }
  exr_result_t result = bands->file ? exr_finish(&bands->file) : EXR_ERR_SUCCESS;
  if (!bands->output)
    return status;
  if (status == CONIC_OK && result != EXR_ERR_SUCCESS)
    status = conic_exr_fail(&bands->stream, result, "write", CONIC_ERROR_ARGUMENT);
  if (status == CONIC_OK && bands->next_y < bands->height)
    status = conic_fail(bands->context, CONIC_ERROR_ARGUMENT, "%s: cannot write: bands are missing", bands->path);
  return status == CONIC_OK && bands->spool ? copy_spool(bands) : status;
}

conic_status conic_exr_bands_end(conic_exr_bands *bands, conic_status status) {
  if (!bands)
    return status;
  status = finish_file(bands, status);
  if (bands->spool)
    fclose(bands->spool);
  if (bands->output)
    status = conic_output_end(bands->output, status);
  conic_memory_release_these(bands->context, bands->chunks, bands);
  return status;
}

conic_status conic_exr_write(conic_context *context, const char *path, const conic_image *image,
                             const conic_image_options *options) {
  conic_exr_bands *bands;
  conic_status status = conic_exr_bands_open(context, path, NULL, image, conic_image_planes(image), options, &bands);
  if (status == CONIC_OK)
    status = conic_exr_bands_end(bands, conic_exr_bands_append(bands, image));
  return status;
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

conic_status conic_exr_bands_open(conic_context *context, const char *path, const char *part, const conic_image *header,
                                  unsigned planes, const conic_image_options *options, conic_exr_bands **bands) {
  (void)part, (void)header;
  *bands = NULL;
  return conic_exr_check(context, path, planes, options);
}

conic_status conic_exr_packer_open(conic_context *context, int width, int height, unsigned planes,
                                   const conic_image_options *options, conic_exr_bands **bands) {
  (void)width, (void)height;
  *bands = NULL;
  return conic_exr_check(context, "exr", planes, options);
}

conic_status conic_exr_bands_append(conic_exr_bands *bands, const conic_image *band) {
  (void)bands, (void)band;
  return CONIC_ERROR_UNSUPPORTED;
}

uint64_t conic_exr_packer_bytes(const conic_exr_bands *bands) {
  (void)bands;
  return 0;
}

uint64_t conic_exr_bands_length(const conic_exr_bands *bands) {
  (void)bands;
  return 0;
}

conic_status conic_exr_bands_flush(conic_exr_bands *bands) {
  (void)bands;
  return CONIC_ERROR_UNSUPPORTED;
}

conic_status conic_exr_pack(conic_exr_bands *bands, const conic_image *image, int first, int begin, int end,
                            int is_alone, conic_exr_receiver *receive, void *cookie) {
  (void)bands, (void)image, (void)first, (void)begin, (void)end, (void)is_alone, (void)receive, (void)cookie;
  return CONIC_ERROR_UNSUPPORTED;
}

conic_status conic_exr_bands_append_packed(conic_exr_bands *bands, int y, int n_rows, const void *bytes,
                                           size_t n_bytes) {
  (void)bands, (void)y, (void)n_rows, (void)bytes, (void)n_bytes;
  return CONIC_ERROR_UNSUPPORTED;
}

conic_status conic_exr_bands_end(conic_exr_bands *bands, conic_status status) {
  (void)bands;
  return status;
}

#endif
