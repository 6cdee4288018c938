#include "core/pictures/image_png.h"

#include "core/base/byte_order.h"
#include "core/files/disk.h"
#include "core/pictures/image_foreign.h"

#if CONIC_HAVE_PNG

#include <png.h>

#include "core/files/file.h"
#include "core/image/image_common.h"
#include "core/pictures/image_samples.h"
#include "core/pictures/picture_shot.h"
#include "core/pictures/png_strips.h"

/* A file being read or written. libpng leaves by longjmp: memory to release is noted here, not in variables. */
typedef struct png_work {
  conic_context *context;
  const char *path;
  FILE *file;
  png_structp png;
  png_infop info;
  int width, height;
  conic_samples_layout layout;
  unsigned char *samples;
  int is_raw;               /* codes are read as they are */
  const conic_image *image; /* that is written */
  char message[100];        /* libpng's */
  conic_status status;
} png_work;

static void keep_error(png_structp png, png_const_charp message) {
  png_work *work = png_get_error_ptr(png);
  snprintf(work->message, sizeof work->message, "%s", message);
  png_longjmp(png, 1);
}

/* Warnings, after which libpng continues, are at most noted. */
static void keep_quiet(png_structp png, png_const_charp message) {
  png_work *work = png_get_error_ptr(png);
  conic_log(work->context, CONIC_LOG_INFO, "%s: %s", work->path, message);
}

static size_t row_bytes(const png_work *work) {
  return (size_t)work->width * (size_t)work->layout.n_channels * (size_t)work->layout.sample_bytes;
}

/* --- writing --- */

static void write_png(png_structp png, png_bytep bytes, size_t n_bytes) {
  png_work *work = png_get_io_ptr(png);
  if (fwrite(bytes, 1, n_bytes, work->file) != n_bytes)
    png_error(png, "the file cannot be written");
}

static void flush_nothing(png_structp png) {
  (void)png;
}

/* Latin-1 where it is that, else UTF-8; packed where it is long. */
static void write_shot(png_work *work) {
  enum { LONG_TEXT = 2048 };
  int is_long = strlen(work->image->shot) > LONG_TEXT, is_ascii = 1;
  for (const char *c = work->image->shot; *c; c++)
    is_ascii &= (unsigned char)*c < 0x80;
  png_text text;
  memset(&text, 0, sizeof text);
  text.compression = is_ascii  ? is_long ? PNG_TEXT_COMPRESSION_zTXt : PNG_TEXT_COMPRESSION_NONE
                     : is_long ? PNG_ITXT_COMPRESSION_zTXt
                               : PNG_ITXT_COMPRESSION_NONE;
  text.key = (png_charp)CONIC_SHOT_KEYWORD;
  text.text = (png_charp)work->image->shot;
  text.text_length = is_ascii ? strlen(work->image->shot) : 0;
  png_set_text(work->png, work->info, &text, 1);
}

/* Returns 0 where libpng or the caller gave up. */
static int encode(png_work *work) {
  if (setjmp(png_jmpbuf(work->png)))
    return 0;
  png_set_write_fn(work->png, work, write_png, flush_nothing);
  png_set_IHDR(work->png, work->info, (png_uint_32)work->width, (png_uint_32)work->height, 8, PNG_COLOR_TYPE_RGBA,
               PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_sRGB_gAMA_and_cHRM(work->png, work->info, PNG_sRGB_INTENT_PERCEPTUAL);
  if (work->image->shot)
    write_shot(work);
  png_write_info(work->png, work->info);
  work->status = conic_png_write_strips(work->context, work->image, work->layout.tone, work->file);
  if (work->status == CONIC_OK)
    png_write_chunk(work->png, (png_const_bytep) "IEND", NULL, 0);
  return work->status == CONIC_OK;
}

static conic_status write_samples(png_work *work) {
  conic_output *output;
  if (work->file) {
    int is_done = encode(work);
    return work->status != CONIC_OK || is_done
               ? work->status
               : conic_fail(work->context, CONIC_ERROR_MEMORY, "%s: cannot write: %s", work->path, work->message);
  }
  conic_status status = conic_output_open(work->context, work->path, &output);
  if (status != CONIC_OK)
    return status;
  work->file = conic_output_stream(output);
  if (encode(work) || ferror(work->file))
    return conic_output_commit(output); /* which also says what is wrong with the stream */
  conic_output_abandon(output);
  if (work->status != CONIC_OK)
    return work->status;
  return conic_fail(work->context, CONIC_ERROR_MEMORY, "%s: cannot write: %s", work->path, work->message);
}

conic_status conic_png_check(conic_context *context, const char *path, unsigned planes) {
  if (!(planes & 1u << CONIC_PLANE_RGBA))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "%s: cannot write: the format holds rgba, which the image has not",
                      path);
  return CONIC_OK;
}

static conic_status encode_image(conic_context *context, const char *path, FILE *stream, const conic_image *image,
                                 conic_tone tone) {
  png_work work = {.context = context,
                   .path = path,
                   .file = stream,
                   .width = image->width,
                   .height = image->height,
                   .image = image,
                   .layout = {.tone = tone}};
  conic_status status = conic_png_check(context, path, conic_image_planes(image));
  if (status != CONIC_OK)
    return status;
  work.png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &work, keep_error, keep_quiet);
  work.info = work.png ? png_create_info_struct(work.png) : NULL;
  status = work.info ? write_samples(&work)
                     : conic_fail(context, CONIC_ERROR_MEMORY, "%s: cannot write: out of memory", path);
  png_destroy_write_struct(&work.png, &work.info);
  return status;
}

conic_status conic_png_write(conic_context *context, const char *path, const conic_image *image, conic_tone tone) {
  return encode_image(context, path, NULL, image, tone);
}

conic_status conic_png_write_to(conic_context *context, FILE *stream, const conic_image *image) {
  return encode_image(context, "a picture", stream, image, CONIC_TONE_SRGB);
}

/* --- reading --- */

static void read_png(png_structp png, png_bytep bytes, size_t n_bytes) {
  png_work *work = png_get_io_ptr(png);
  if (fread(bytes, 1, n_bytes, work->file) == n_bytes)
    return;
  if (ferror(work->file))
    png_error(png, strerror(errno));
  snprintf(work->message, sizeof work->message, "the file ends early (at byte %lld)", (long long)ftello(work->file));
  png_longjmp(png, 1);
}

/* Returns 0 where libpng gave up. */
static int decode_header(png_work *work) {
  if (setjmp(png_jmpbuf(work->png)))
    return 0;
  png_set_user_limits(work->png, CONIC_IMAGE_MAX_SIZE, CONIC_IMAGE_MAX_SIZE);
  png_set_read_fn(work->png, work, read_png);
  png_read_info(work->png, work->info);
  png_set_expand(work->png);
  if (!CONIC_IS_BIG_ENDIAN)
    png_set_swap(work->png); /* samples of 16 bits */
  png_set_interlace_handling(work->png);
  png_read_update_info(work->png, work->info);
  work->width = (int)png_get_image_width(work->png, work->info);
  work->height = (int)png_get_image_height(work->png, work->info);
  work->layout.n_channels = png_get_channels(work->png, work->info);
  work->layout.sample_bytes = png_get_bit_depth(work->png, work->info) / 8;
  work->layout.is_straight = !work->is_raw;
  work->layout.is_display = work->is_raw;
  return 1;
}

static int decode_rows(png_work *work, int n_passes) {
  if (setjmp(png_jmpbuf(work->png)))
    return 0;
  for (int i = 0; i < n_passes; i++)
    for (int y = 0; y < work->height; y++)
      png_read_row(work->png, work->samples + (size_t)y * row_bytes(work), NULL);
  png_read_end(work->png, NULL);
  return 1;
}

static conic_status fail_to_read(const png_work *work) {
  return conic_fail(work->context, CONIC_ERROR_INPUT, "%s: cannot read: %s", work->path, work->message);
}

/* The size is checked before memory is taken for the picture. */
static conic_status read_samples(png_work *work, conic_image *image) {
  conic_context *context = work->context;
  if (!decode_header(work))
    return fail_to_read(work);
  size_t pixel_bytes = (size_t)work->layout.n_channels * (size_t)work->layout.sample_bytes;
  conic_status status = conic_image_check_size(context, work->path, work->width, work->height, pixel_bytes);
  if (status != CONIC_OK)
    return status;
  work->samples = conic_memory_allocate_zeroed(context, (size_t)work->height, row_bytes(work));
  if (!work->samples)
    return CONIC_ERROR_MEMORY;
  int is_interlaced = png_get_interlace_type(work->png, work->info) != PNG_INTERLACE_NONE;
  if (!decode_rows(work, is_interlaced ? PNG_INTERLACE_ADAM7_PASSES : 1))
    return fail_to_read(work);
  status = conic_image_allocate(context, work->width, work->height, 1u << CONIC_PLANE_RGBA, image);
  if (status != CONIC_OK)
    return status;
  image->lacks_alpha = !conic_samples_have_alpha(work->layout);
  conic_samples_to_rgba(context, work->samples, work->width, work->height, work->layout,
                        image->planes[CONIC_PLANE_RGBA]);
  return CONIC_OK;
}

static conic_status open_and_read(png_work *in, conic_image *image) {
  png_work work = *in;
  conic_context *context = work.context;
  const char *path = work.path;
  work.file = conic_disk_open_stream(path, "rb");
  if (!work.file)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: cannot read: %s", path, strerror(errno));
  work.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &work, keep_error, keep_quiet);
  work.info = work.png ? png_create_info_struct(work.png) : NULL;
  conic_status status = work.info ? read_samples(&work, image)
                                  : conic_fail(context, CONIC_ERROR_MEMORY, "%s: cannot read: out of memory", path);
  png_destroy_read_struct(&work.png, &work.info, NULL);
  conic_memory_release(context, work.samples);
  fclose(work.file);
  in->layout = work.layout;
  return status;
}

conic_status conic_png_read(conic_context *context, const char *path, conic_image *image) {
  png_work work = {.context = context, .path = path};
  return open_and_read(&work, image);
}

conic_status conic_png_read_codes(conic_context *context, const char *path, conic_image *image, unsigned *most_code) {
  png_work work = {.context = context, .path = path, .is_raw = 1};
  conic_status status = open_and_read(&work, image);
  *most_code = work.layout.sample_bytes == 2 ? 65535 : 255;
  return status;
}

#else

conic_status conic_png_check(conic_context *context, const char *path, unsigned planes) {
  return conic_foreign_check(context, path, "png", planes);
}

conic_status conic_png_write(conic_context *context, const char *path, const conic_image *image, conic_tone tone) {
  return conic_foreign_write(context, path, "png", image, tone);
}

conic_status conic_png_read(conic_context *context, const char *path, conic_image *image) {
  return conic_foreign_read(context, path, image);
}

conic_status conic_png_write_to(conic_context *context, FILE *stream, const conic_image *image) {
  (void)stream;
  (void)image;
  return conic_fail(context, CONIC_ERROR_UNSUPPORTED, "pictures in a page need libpng, which this build lacks");
}

conic_status conic_png_read_codes(conic_context *context, const char *path, conic_image *image, unsigned *most_code) {
  (void)image;
  (void)most_code;
  return conic_fail(context, CONIC_ERROR_UNSUPPORTED, "%s: the codes of a PNG need libpng, which this build lacks",
                    path);
}

#endif
