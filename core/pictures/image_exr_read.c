#include "core/pictures/image_exr.h"

#include "core/files/disk.h"
#include "core/pictures/image_foreign.h"

#if CONIC_HAVE_OPENEXR

#include <stdatomic.h>

#include "core/image/image_common.h"
#include "core/pictures/image_channels.h"
#include "core/pictures/image_exr_stream.h"
#include "core/pictures/openimageio_bridge.h"

typedef struct exr_reader {
  conic_exr_stream stream;
  exr_context_t file;
  exr_storage_t storage;
  exr_attr_box2i_t window;
  int is_luminance;                      /* Y stands for R, G and B */
  int lines_per_chunk;                   /* scanlines */
  int tile_width, tile_height, n_across; /* tiles */
  size_t n_chunks;
  conic_image *image;
  unsigned half_planes;
  exr_decode_pipeline_t *pipelines; /* one a thread */
  atomic_int result;
  atomic_ullong failed_bytes; /* unpacked bytes of the chunk that could not be decoded */
  int is_for_others;          /* the library cannot decode it, but another one may */
} exr_reader;

static int has_channel(const exr_attr_chlist_t *channels, const char *name) {
  for (int i = 0; i < channels->num_channels; i++)
    if (strcmp(channels->entries[i].name.str, name) == 0)
      return 1;
  return 0;
}

/* Finds the planes that the file's channels make. */
static conic_status choose_planes(conic_context *context, exr_reader *reader, unsigned *planes, int *has_alpha) {
  const exr_attr_chlist_t *channels;
  const char *path = reader->stream.path;
  exr_compression_t compression = EXR_COMPRESSION_NONE;
  exr_result_t result = exr_get_channels(reader->file, 0, &channels);
  if (result == EXR_ERR_SUCCESS)
    result = exr_get_compression(reader->file, 0, &compression);
  if (result != EXR_ERR_SUCCESS)
    return conic_exr_fail(&reader->stream, result, "read", CONIC_ERROR_INPUT);
  reader->is_luminance = has_channel(channels, "Y") && !has_channel(channels, "R") && !has_channel(channels, "G") &&
                         !has_channel(channels, "B");
  *has_alpha = has_channel(channels, "A");
  *planes = 0;
  for (int i = 0; i < channels->num_channels; i++) {
    const exr_attr_chlist_entry_t *channel = &channels->entries[i];
    conic_channel target = conic_channel_find_in(channel->name.str, reader->is_luminance);
    if (target.plane < 0) {
      conic_log(context, CONIC_LOG_INFO, "%s: channel %s is ignored", path, channel->name.str);
      continue;
    }
    if (channel->x_sampling != 1 || channel->y_sampling != 1)
      return conic_fail(context, CONIC_ERROR_UNSUPPORTED, "%s: cannot read: channel %s is subsampled", path,
                        channel->name.str);
    *planes |= 1u << target.plane;
    if (channel->pixel_type == EXR_PIXEL_HALF || compression == EXR_COMPRESSION_PXR24)
      reader->half_planes |= 1u << target.plane;
  }
  if (!*planes)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: has no channel that conic knows", path);
  return CONIC_OK;
}

/* Finds how the part is divided into chunks. */
static exr_result_t read_layout(exr_reader *reader) {
  exr_result_t result = exr_get_data_window(reader->file, 0, &reader->window);
  int width = reader->window.max.x - reader->window.min.x + 1, height = reader->window.max.y - reader->window.min.y + 1;
  if (result == EXR_ERR_SUCCESS && reader->storage == EXR_STORAGE_SCANLINE) {
    result = exr_get_scanlines_per_chunk(reader->file, 0, &reader->lines_per_chunk);
    if (result == EXR_ERR_SUCCESS && reader->lines_per_chunk < 1)
      result = EXR_ERR_INVALID_ATTR;
    if (result == EXR_ERR_SUCCESS)
      reader->n_chunks = (size_t)((height - 1) / reader->lines_per_chunk) + 1;
  } else if (result == EXR_ERR_SUCCESS) {
    result = exr_get_tile_sizes(reader->file, 0, 0, 0, &reader->tile_width, &reader->tile_height);
    if (result == EXR_ERR_SUCCESS && (reader->tile_width < 1 || reader->tile_height < 1))
      result = EXR_ERR_INVALID_ATTR;
    if (result != EXR_ERR_SUCCESS)
      return result;
    reader->n_across = (width - 1) / reader->tile_width + 1;
    reader->n_chunks = (size_t)reader->n_across * (size_t)((height - 1) / reader->tile_height + 1);
  }
  return result;
}

/* The chunk's place in the file, and in the picture. */
static exr_result_t find_chunk(const exr_reader *reader, size_t i_chunk, exr_chunk_info_t *info, int *x, int *y) {
  if (reader->storage == EXR_STORAGE_SCANLINE) {
    *x = 0;
    *y = (int)i_chunk * reader->lines_per_chunk;
    return exr_read_scanline_chunk_info(reader->file, 0, reader->window.min.y + *y, info);
  }
  int i_across = (int)(i_chunk % (size_t)reader->n_across), i_down = (int)(i_chunk / (size_t)reader->n_across);
  *x = i_across * reader->tile_width;
  *y = i_down * reader->tile_height;
  return exr_read_tile_chunk_info(reader->file, 0, i_across, i_down, 0, 0, info);
}

static void point_channels(const exr_reader *reader, exr_decode_pipeline_t *pipeline, int x, int y) {
  const conic_image *image = reader->image;
  for (int i = 0; i < pipeline->channel_count; i++) {
    exr_coding_channel_info_t *channel = &pipeline->channels[i];
    conic_channel target = conic_channel_find_in(channel->channel_name, reader->is_luminance);
    channel->decode_to_ptr = NULL;
    if (target.plane < 0)
      continue;
    const conic_plane_description *plane = conic_plane_describe((conic_plane)target.plane);
    size_t first = ((size_t)y * (size_t)image->width + (size_t)x) * (size_t)plane->n_channels + (size_t)target.channel;
    channel->user_pixel_stride = plane->n_channels * 4;
    channel->user_line_stride = channel->user_pixel_stride * image->width;
    channel->user_bytes_per_element = 4;
    channel->user_data_type = (uint16_t)(plane->is_uint ? EXR_PIXEL_UINT : EXR_PIXEL_FLOAT);
    channel->decode_to_ptr = (uint8_t *)image->planes[target.plane] + first * 4;
  }
}

static void decode_chunk(void *data, size_t i_item, int i_thread) {
  exr_reader *reader = data;
  exr_decode_pipeline_t *pipeline = &reader->pipelines[i_thread];
  exr_chunk_info_t info = {0};
  int x, y, is_new = !pipeline->context;
  if (atomic_load(&reader->result) != EXR_ERR_SUCCESS)
    return;
  exr_result_t result = find_chunk(reader, i_item, &info, &x, &y);
  if (result == EXR_ERR_SUCCESS && (info.width > reader->image->width - x || info.height > reader->image->height - y))
    result = EXR_ERR_CORRUPT_CHUNK;
  if (result == EXR_ERR_SUCCESS)
    result = is_new ? exr_decoding_initialize(reader->file, 0, &info, pipeline)
                    : exr_decoding_update(reader->file, 0, &info, pipeline);
  if (result == EXR_ERR_SUCCESS) {
    point_channels(reader, pipeline, x, y);
    result = exr_decoding_choose_default_routines(reader->file, 0, pipeline);
  }
  if (result == EXR_ERR_SUCCESS)
    result = exr_decoding_run(reader->file, 0, pipeline);
  if (result != EXR_ERR_SUCCESS) {
    atomic_store(&reader->failed_bytes, info.unpacked_size);
    atomic_store(&reader->result, result);
  }
}

/* Some decoders report lack of memory for data that run past their room. If there is memory, the data are at fault.
 * Errors: INPUT, MEMORY. */
static conic_status doubt_memory(conic_context *context, const exr_reader *reader) {
  void *room = conic_memory_allocate(context, 4, (size_t)atomic_load(&reader->failed_bytes));
  if (!room)
    return CONIC_ERROR_MEMORY;
  conic_memory_release(context, room);
  return conic_fail(context, CONIC_ERROR_INPUT, "%s: cannot read: its data do not fit its size", reader->stream.path);
}

static conic_status read_chunks(conic_context *context, exr_reader *reader) {
  size_t n_threads = (size_t)conic_context_threads(context);
  reader->pipelines = conic_memory_allocate_zeroed(context, n_threads, sizeof *reader->pipelines);
  if (!reader->pipelines)
    return CONIC_ERROR_MEMORY;
  conic_parallel_for(context, reader->n_chunks, decode_chunk, reader);
  for (size_t i = 0; i < n_threads; i++)
    if (reader->pipelines[i].context)
      exr_decoding_destroy(reader->file, &reader->pipelines[i]);
  conic_memory_release(context, reader->pipelines);
  exr_result_t result = atomic_load(&reader->result);
  if (result == EXR_ERR_OUT_OF_MEMORY)
    return doubt_memory(context, reader);
  reader->is_for_others = result == EXR_ERR_FEATURE_NOT_IMPLEMENTED && conic_bridge_is_there();
  if (reader->is_for_others)
    return CONIC_ERROR_UNSUPPORTED;
  return result == EXR_ERR_SUCCESS ? CONIC_OK : conic_exr_fail(&reader->stream, result, "read", CONIC_ERROR_INPUT);
}

static void take_floats(conic_attribute *to, conic_attribute_type type, const void *floats, size_t n_bytes) {
  float values[16] = {0};
  memcpy(values, floats, n_bytes);
  to->type = type;
  for (size_t i = 0; i < n_bytes / sizeof *values; i++)
    to->values[i] = (double)values[i];
}

/* Returns whether the attribute is of a type that conic writes. */
static int take_attribute(const exr_attribute_t *from, conic_attribute *to) {
  if (from->type == EXR_ATTR_STRING && from->string->str && strlen(from->string->str) < sizeof to->text) {
    to->type = CONIC_ATTRIBUTE_TEXT;
    memcpy(to->text, from->string->str, strlen(from->string->str) + 1);
  } else if (from->type == EXR_ATTR_DOUBLE) {
    to->type = CONIC_ATTRIBUTE_DOUBLE;
    to->values[0] = from->d;
  } else if (from->type == EXR_ATTR_M44D) {
    to->type = CONIC_ATTRIBUTE_MATRIX;
    memcpy(to->values, from->m44d->m, sizeof to->values);
  } else if (from->type == EXR_ATTR_FLOAT)
    take_floats(to, CONIC_ATTRIBUTE_FLOAT, &from->f, sizeof from->f);
  else if (from->type == EXR_ATTR_V2F)
    take_floats(to, CONIC_ATTRIBUTE_FLOAT_PAIR, from->v2f, sizeof *from->v2f);
  else if (from->type == EXR_ATTR_M44F)
    take_floats(to, CONIC_ATTRIBUTE_FLOAT_MATRIX, from->m44f, sizeof *from->m44f);
  else if (from->type == EXR_ATTR_CHROMATICITIES)
    take_floats(to, CONIC_ATTRIBUTE_CHROMATICITIES, from->chromaticities, sizeof *from->chromaticities);
  else
    return 0;
  return 1;
}

/* Keeps the attributes of the types that conic writes, as far as there is room. */
static void read_attributes(exr_reader *reader) {
  int32_t n = 0;
  conic_image *image = reader->image;
  if (exr_get_attribute_count(reader->file, 0, &n) != EXR_ERR_SUCCESS)
    return;
  for (int32_t i = 0; i < n && image->n_attributes < CONIC_MAX_ATTRIBUTES; i++) {
    const exr_attribute_t *from;
    conic_attribute *to = &image->attributes[image->n_attributes];
    if (exr_get_attribute_by_index(reader->file, 0, EXR_ATTR_LIST_FILE_ORDER, i, &from) != EXR_ERR_SUCCESS ||
        strlen(from->name) >= sizeof to->name || !take_attribute(from, to))
      continue;
    memcpy(to->name, from->name, strlen(from->name) + 1);
    image->n_attributes++;
  }
}

/* Whether the header says that the colours are display values. */
static int says_display(const exr_reader *reader) {
  const exr_attribute_t *space;
  return exr_get_attribute_by_name(reader->file, 0, CONIC_EXR_COLOR_SPACE, &space) == EXR_ERR_SUCCESS &&
         space->type == EXR_ATTR_STRING && space->string->str && strcmp(space->string->str, CONIC_EXR_DISPLAY) == 0;
}

/* Reads the part; the file is open and its header parsed. */
static conic_status read_part(conic_context *context, exr_reader *reader) {
  unsigned planes = 0;
  int has_alpha = 0;
  exr_result_t result = exr_get_storage(reader->file, 0, &reader->storage);
  if (result == EXR_ERR_SUCCESS && reader->storage != EXR_STORAGE_SCANLINE && reader->storage != EXR_STORAGE_TILED)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: cannot read: it is a deep image", reader->stream.path);
  if (result == EXR_ERR_SUCCESS)
    result = read_layout(reader);
  if (result != EXR_ERR_SUCCESS)
    return conic_exr_fail(&reader->stream, result, "read", CONIC_ERROR_INPUT);
  conic_status status = choose_planes(context, reader, &planes, &has_alpha);
  if (status != CONIC_OK)
    return status;
  int width = reader->window.max.x - reader->window.min.x + 1, height = reader->window.max.y - reader->window.min.y + 1;
  size_t pixel_bytes = 0;
  for (int i = 0; i < CONIC_N_PLANES; i++)
    pixel_bytes += planes >> i & 1 ? 4 * (size_t)conic_plane_describe((conic_plane)i)->n_channels : 0;
  status = conic_image_check_size(context, reader->stream.path, width, height, pixel_bytes);
  if (status == CONIC_OK)
    status = conic_image_allocate(context, width, height, planes, reader->image);
  if (status != CONIC_OK)
    return status == CONIC_ERROR_ARGUMENT ? CONIC_ERROR_INPUT : status;
  status = read_chunks(context, reader);
  if (status != CONIC_OK) {
    conic_image_release(context, reader->image);
    return status;
  }
  conic_channels_complete(reader->image, has_alpha, reader->is_luminance);
  read_attributes(reader);
  reader->image->half_planes = reader->half_planes;
  reader->image->is_display = (uint64_t)says_display(reader);
  return CONIC_OK;
}

conic_status conic_exr_read(conic_context *context, const char *path, conic_image *image) {
  exr_context_initializer_t settings;
  exr_reader reader = {0};
  FILE *file = conic_disk_open_stream(path, "rb");
  if (!file)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: cannot read: %s", path, strerror(errno));
  conic_exr_stream_init(&reader.stream, context, path, file, &settings);
  reader.image = image;
  atomic_init(&reader.result, EXR_ERR_SUCCESS);
  atomic_init(&reader.failed_bytes, 0);
  exr_result_t result = exr_start_read(&reader.file, path, &settings);
  conic_status status = result == EXR_ERR_SUCCESS ? read_part(context, &reader)
                                                  : conic_exr_fail(&reader.stream, result, "read", CONIC_ERROR_INPUT);
  if (reader.is_for_others) {
    status = conic_foreign_read(context, path, image);
    if (status == CONIC_OK) {
      read_attributes(&reader);
      image->is_display = (uint64_t)says_display(&reader);
    }
  }
  if (result == EXR_ERR_SUCCESS)
    exr_finish(&reader.file);
  fclose(file);
  return status;
}

#else

conic_status conic_exr_read(conic_context *context, const char *path, conic_image *image) {
  return conic_foreign_read(context, path, image);
}

#endif
