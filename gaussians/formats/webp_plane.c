#include "gaussians/formats/webp_plane.h"

#if CONIC_HAVE_WEBP

#include <webp/decode.h>
#include <webp/encode.h>

enum { LEVEL = 4 }; /* of 9 */

conic_status conic_webp_decode(conic_context *context, const char *name, const unsigned char *bytes, size_t n_bytes,
                               size_t most_pixels, size_t size[2], unsigned char **pixels) {
  WebPBitstreamFeatures features;
  *pixels = NULL;
  if (WebPGetFeatures(bytes, n_bytes, &features) != VP8_STATUS_OK || features.has_animation || features.width <= 0 ||
      features.height <= 0)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: a picture in it is no WebP (at byte 0)", name);
  size[0] = (size_t)features.width;
  size[1] = (size_t)features.height;
  if (size[0] * size[1] > most_pixels)
    return conic_fail(context, CONIC_ERROR_INPUT,
                      "%s: a picture in it has %zux%zu pixels: more than are of use (at byte 0)", name, size[0],
                      size[1]);
  *pixels = conic_memory_allocate(context, size[0] * size[1], 4);
  if (!*pixels)
    return CONIC_ERROR_MEMORY;
  if (WebPDecodeRGBAInto(bytes, n_bytes, *pixels, size[0] * size[1] * 4, (int)size[0] * 4))
    return CONIC_OK;
  conic_memory_release(context, *pixels);
  *pixels = NULL;
  return conic_fail(context, CONIC_ERROR_INPUT, "%s: a picture in it is spoiled (at byte 0)", name);
}

conic_status conic_webp_encode(conic_context *context, const unsigned char *pixels, const size_t size[2],
                               unsigned char **bytes, size_t *n_bytes) {
  WebPConfig config;
  WebPPicture picture;
  WebPMemoryWriter writer;
  *bytes = NULL;
  WebPMemoryWriterInit(&writer);
  int is_done = WebPConfigInit(&config) && WebPConfigLosslessPreset(&config, LEVEL) && WebPPictureInit(&picture);
  if (is_done) {
    config.exact = 1;
    picture.use_argb = 1;
    picture.width = (int)size[0];
    picture.height = (int)size[1];
    picture.writer = WebPMemoryWrite;
    picture.custom_ptr = &writer;
    is_done = WebPPictureImportRGBA(&picture, pixels, (int)size[0] * 4) && WebPEncode(&config, &picture);
    WebPPictureFree(&picture);
  }
  *bytes = is_done ? conic_memory_allocate(context, writer.size, 1) : NULL;
  *n_bytes = writer.size;
  if (*bytes)
    memcpy(*bytes, writer.mem, writer.size);
  WebPMemoryWriterClear(&writer);
  return *bytes ? CONIC_OK : conic_fail(context, CONIC_ERROR_MEMORY, "no memory for WebP");
}

#else

static conic_status refuse(conic_context *context) {
  return conic_fail(context, CONIC_ERROR_UNSUPPORTED, "WebP needs libwebp, which is not in this build");
}

conic_status conic_webp_decode(conic_context *context, const char *name, const unsigned char *bytes, size_t n_bytes,
                               size_t most_pixels, size_t size[2], unsigned char **pixels) {
  (void)name;
  (void)bytes;
  (void)n_bytes;
  (void)most_pixels;
  (void)size;
  *pixels = NULL;
  return refuse(context);
}

conic_status conic_webp_encode(conic_context *context, const unsigned char *pixels, const size_t size[2],
                               unsigned char **bytes, size_t *n_bytes) {
  (void)pixels;
  (void)size;
  *bytes = NULL;
  *n_bytes = 0;
  return refuse(context);
}

#endif
