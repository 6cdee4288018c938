#include "core/pictures/image_foreign.h"

#include "core/files/file.h"
#include "core/image/image_common.h"
#include "core/pictures/image_channels.h"
#include "core/pictures/image_samples.h"
#include "core/pictures/openimageio_bridge.h"

/* OpenImageIO writes EXR too, but only its rgba. */
static int is_float_format(const char *format) {
  return strcmp(format, "hdr") == 0 || strcmp(format, "zfile") == 0 || strcmp(format, "openexr") == 0;
}

static conic_samples_layout choose_layout(const conic_bridge_writer *writer) {
  conic_samples_layout layout = {.n_channels = writer->has_alpha ? 4 : 3, .sample_bytes = 1};
  layout.is_straight = writer->has_alpha;
  if (strcmp(writer->format, "tiff") == 0)
    layout.sample_bytes = 2;
  if (is_float_format(writer->format)) {
    layout.sample_bytes = 4;
    layout.is_straight = 0;
  }
  return layout;
}

static int take_bytes(void *cookie, const void *bytes, size_t n_bytes) {
  return fwrite(bytes, 1, n_bytes, cookie) == n_bytes;
}

static conic_status write_samples(conic_context *context, const conic_bridge *bridge, const char *path,
                                  const char *format, const conic_bridge_picture *picture, const void *samples) {
  char message[CONIC_BRIDGE_MESSAGE] = "";
  conic_output *output;
  conic_status status = conic_output_open(context, path, &output);
  if (status != CONIC_OK)
    return status;
  FILE *stream = conic_output_stream(output);
  conic_bridge_result result = bridge->write(format, picture, samples, take_bytes, stream, message);
  if (result == CONIC_BRIDGE_OK || ferror(stream))
    return conic_output_commit(output); /* which also says what is wrong with the stream */
  conic_output_abandon(output);
  if (result == CONIC_BRIDGE_MEMORY)
    return conic_fail(context, CONIC_ERROR_MEMORY, "%s: cannot write: out of memory", path);
  return conic_fail(context, CONIC_ERROR_UNSUPPORTED, "%s: cannot write: %s", path, message);
}

/* The format of the ending, if it holds one of these planes. */
static conic_status find_writer(conic_context *context, const char *path, const char *ending, unsigned planes,
                                const conic_bridge **bridge, conic_bridge_writer *writer) {
  char message[CONIC_BRIDGE_MESSAGE] = "";
  *bridge = conic_bridge_load(message);
  if (!*bridge)
    return conic_fail(context, CONIC_ERROR_UNSUPPORTED, "%s: cannot write: %s", path, message);
  conic_bridge_result result = (*bridge)->find_writer(ending, writer, message);
  if (result == CONIC_BRIDGE_MEMORY)
    return conic_fail(context, CONIC_ERROR_MEMORY, "%s: cannot write: out of memory", path);
  if (result != CONIC_BRIDGE_OK)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "%s: cannot write: %s", path, message);
  if (!(planes & 1u << CONIC_PLANE_RGBA))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "%s: cannot write: the format holds rgba, which the image has not",
                      path);
  return CONIC_OK;
}

conic_status conic_foreign_check(conic_context *context, const char *path, const char *ending, unsigned planes) {
  const conic_bridge *bridge;
  conic_bridge_writer writer;
  return find_writer(context, path, ending, planes, &bridge, &writer);
}

conic_status conic_foreign_write(conic_context *context, const char *path, const char *ending, const conic_image *image,
                                 conic_tone tone) {
  const conic_bridge *bridge;
  conic_bridge_writer writer = {.has_alpha = 0};
  conic_status status = find_writer(context, path, ending, conic_image_planes(image), &bridge, &writer);
  if (status != CONIC_OK)
    return status;
  const float *rgba = image->planes[CONIC_PLANE_RGBA];
  conic_samples_layout layout = choose_layout(&writer);
  layout.is_display = image->is_display != 0;
  layout.tone = tone;
  const conic_bridge_picture picture = {image->width,        image->height,      layout.n_channels,
                                        layout.sample_bytes, layout.is_straight, .description = image->shot};
  void *samples = conic_memory_allocate(context, conic_image_pixels(image),
                                        (size_t)layout.n_channels * (size_t)layout.sample_bytes);
  if (!samples)
    return CONIC_ERROR_MEMORY;
  conic_samples_from_rgba(context, rgba, image->width, image->height, layout, samples);
  status = write_samples(context, bridge, path, writer.format, &picture, samples);
  conic_memory_release(context, samples);
  return status;
}

typedef struct reading {
  conic_context *context;
  const char *path;
  conic_status status;
  void *samples;
} reading;

static void *make_room_for_picture(void *cookie, const conic_bridge_picture *picture) {
  reading *work = cookie;
  if (picture->width < 1 || picture->height < 1 || picture->width > CONIC_IMAGE_MAX_SIZE ||
      picture->height > CONIC_IMAGE_MAX_SIZE || picture->n_channels < 1 ||
      picture->n_channels > CONIC_BRIDGE_CHANNELS) {
    work->status =
        conic_fail(work->context, CONIC_ERROR_INPUT, "%s: a picture of %d × %d with %d channels cannot be used",
                   work->path, picture->width, picture->height, picture->n_channels);
    return NULL;
  }
  size_t pixel_bytes = (size_t)picture->n_channels * (size_t)picture->sample_bytes;
  work->status = conic_image_check_size(work->context, work->path, picture->width, picture->height, pixel_bytes);
  if (work->status != CONIC_OK)
    return NULL;
  work->samples = conic_memory_allocate(work->context, (size_t)picture->width * (size_t)picture->height, pixel_bytes);
  if (!work->samples)
    work->status = CONIC_ERROR_MEMORY;
  return work->samples;
}

/* Whether the file begins as an image of a well-known format: then the build lacks something. */
static int is_known_image(const char *path) {
  static const struct {
    const char *bytes;
    size_t n_bytes;
  } starts[] = {{"\x89PNG", 4},     {"\xff\xd8\xff", 3},     {"II*\0", 4}, {"MM\0*", 4},
                {"#?RADIANCE", 10}, {"\x76\x2f\x31\x01", 4}, {"GIF8", 4},  {"BM", 2}};
  for (size_t i = 0; i < sizeof starts / sizeof starts[0]; i++)
    if (conic_file_begins_with(path, starts[i].bytes, starts[i].n_bytes))
      return 1;
  return 0;
}

/* Reads the samples and the picture's layout, or says why not. */
static conic_status read_samples(conic_context *context, const char *path, conic_bridge_picture *picture,
                                 reading *work) {
  char message[CONIC_BRIDGE_MESSAGE] = "";
  const conic_bridge *bridge = conic_bridge_load(message);
  if (!bridge && is_known_image(path))
    return conic_fail(context, CONIC_ERROR_UNSUPPORTED, "%s: cannot read: %s", path, message);
  if (!bridge)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: cannot read: no image of a known format", path);
  int most_mib = conic_image_most_mib(context, path), width, height;
  if (conic_foreign_size(path, &width, &height))
    work->status = conic_image_check_size(context, path, width, height, 4);
  if (work->status != CONIC_OK)
    return work->status;
  conic_bridge_result result = bridge->read(path, most_mib, picture, make_room_for_picture, work, message);
  if (result == CONIC_BRIDGE_OK)
    return CONIC_OK;
  if (work->status != CONIC_OK)
    return work->status; /* which is logged */
  if (result == CONIC_BRIDGE_MEMORY)
    return conic_fail(context, CONIC_ERROR_MEMORY, "%s: cannot read: out of memory", path);
  return conic_fail(context, CONIC_ERROR_INPUT, "%s: cannot read: %s", path, message);
}

static float read_value(const conic_bridge_channel *channel, const void *sample) {
  uint32_t number;
  float value;
  memcpy(&number, sample, sizeof number);
  memcpy(&value, sample, sizeof value);
  return channel->is_uint ? (float)number : value;
}

static uint32_t read_number(const conic_bridge_channel *channel, const void *sample) {
  uint32_t number;
  float value;
  memcpy(&number, sample, sizeof number);
  memcpy(&value, sample, sizeof value);
  if (channel->is_uint)
    return number;
  return value >= 4294967296.0f ? UINT32_MAX : value > 0.0f ? (uint32_t)value : 0;
}

static int has_channel(const conic_bridge_picture *picture, const char *name) {
  for (int i = 0; i < picture->n_channels; i++)
    if (strcmp(picture->channels[i].name, name) == 0)
      return 1;
  return 0;
}

/* Puts channel `i` of the samples into its plane, if it has one. */
static void take_channel(const conic_bridge_picture *picture, const unsigned char *samples, int i, conic_channel to,
                         const conic_image *image) {
  const conic_plane_description *plane = conic_plane_describe((conic_plane)to.plane);
  size_t n = conic_image_pixels(image), stride = (size_t)plane->n_channels;
  for (size_t pixel = 0; pixel < n; pixel++) {
    const unsigned char *sample = samples + 4 * (pixel * (size_t)picture->n_channels + (size_t)i);
    size_t at = pixel * stride + (size_t)to.channel;
    if (plane->is_uint)
      ((uint32_t *)image->planes[to.plane])[at] = read_number(&picture->channels[i], sample);
    else
      ((float *)image->planes[to.plane])[at] = read_value(&picture->channels[i], sample);
  }
}

/* Takes an EXR's planes as conic_exr_read would. */
static conic_status take_channels(conic_context *context, const char *path, const conic_bridge_picture *picture,
                                  const void *samples, conic_image *image) {
  conic_channel to[CONIC_BRIDGE_CHANNELS];
  unsigned planes = 0;
  int is_luminance = has_channel(picture, "Y") && !has_channel(picture, "R") && !has_channel(picture, "G") &&
                     !has_channel(picture, "B");
  for (int i = 0; i < picture->n_channels; i++) {
    to[i] = conic_channel_find_in(picture->channels[i].name, is_luminance);
    planes |= to[i].plane < 0 ? 0 : 1u << to[i].plane;
  }
  if (!planes)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: has no channel that conic knows", path);
  conic_status status = conic_image_allocate(context, picture->width, picture->height, planes, image);
  for (int i = 0; i < picture->n_channels && status == CONIC_OK; i++)
    if (to[i].plane >= 0)
      take_channel(picture, samples, i, to[i], image);
  if (status == CONIC_OK)
    conic_channels_complete(image, has_channel(picture, "A"), is_luminance);
  return status;
}

static conic_status take_colors(conic_context *context, const conic_bridge_picture *picture, const void *samples,
                                conic_image *image) {
  const conic_samples_layout layout = {picture->n_channels, picture->sample_bytes, picture->is_straight};
  conic_status status = conic_image_allocate(context, picture->width, picture->height, 1u << CONIC_PLANE_RGBA, image);
  if (status != CONIC_OK)
    return status;
  image->lacks_alpha = !conic_samples_have_alpha(layout);
  conic_samples_to_rgba(context, samples, picture->width, picture->height, layout, image->planes[CONIC_PLANE_RGBA]);
  return status;
}

conic_status conic_foreign_read(conic_context *context, const char *path, conic_image *image) {
  conic_bridge_picture picture = {0};
  reading work = {.context = context, .path = path, .status = CONIC_OK};
  conic_status status = read_samples(context, path, &picture, &work);
  if (status == CONIC_OK)
    status = picture.is_named ? take_channels(context, path, &picture, work.samples, image)
                              : take_colors(context, &picture, work.samples, image);
  conic_memory_release(context, work.samples);
  return status;
}
