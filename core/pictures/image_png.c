#include "core/pictures/image_png.h"

#include "core/base/byte_order.h"
#include "core/files/disk.h"
#include "core/files/file.h"
#include "core/image/image_common.h"
#include "core/pictures/image_foreign.h"
#include "core/pictures/image_samples.h"
#include "core/pictures/picture_shot.h"
#include "core/pictures/png_strips.h"

/* --- writing --- */

/* Completes a chunk, whose n bytes of data stand in their place, and writes it. The stream remembers what it refuses.
 */
static void put_chunk(FILE *to, unsigned char *chunk, const char *name, size_t n) {
  fwrite(chunk, 1, conic_png_close_chunk(chunk, name, n), to);
}

/* 8 bits of R, G, B and A, sRGB-encoded and marked so, also for those who know chunks of old alone. */
static void write_head(const conic_image *image, FILE *to) {
  static const uint32_t chromaticities[] = {31270, 32900, 64000, 33000, 30000, 60000, 15000, 6000};
  unsigned char chunk[64], *data = chunk + CONIC_PNG_DATA;
  fwrite("\x89PNG\r\n\x1a\n", 1, 8, to);
  conic_store_big_32(data, (uint32_t)image->width);
  conic_store_big_32(data + 4, (uint32_t)image->height);
  memcpy(data + 8, "\x08\x06\0\0\0", 5);
  put_chunk(to, chunk, "IHDR", 13);
  conic_store_big_32(data, 45455);
  put_chunk(to, chunk, "gAMA", 4);
  data[0] = 0;
  put_chunk(to, chunk, "sRGB", 1);
  for (size_t i = 0; i < 8; i++)
    conic_store_big_32(data + (size_t)i * 4, chromaticities[i]);
  put_chunk(to, chunk, "cHRM", 32);
}

/* Latin-1 where it is that, else UTF-8, without language and translation. */
static conic_status write_shot(conic_context *context, const char *shot, FILE *to) {
  size_t n_key = sizeof CONIC_SHOT_KEYWORD, n = strlen(shot), n_blank = 0;
  for (const char *c = shot; *c; c++)
    n_blank = (unsigned char)*c < 0x80 ? n_blank : 4;
  unsigned char *chunk = conic_memory_allocate(context, n_key + n_blank + n + 12, 1), *data = chunk + CONIC_PNG_DATA;
  if (!chunk)
    return CONIC_ERROR_MEMORY;
  memcpy(data, CONIC_SHOT_KEYWORD, n_key);
  memset(data + n_key, 0, n_blank);
  memcpy(data + n_key + n_blank, shot, n);
  put_chunk(to, chunk, n_blank ? "iTXt" : "tEXt", n_key + n_blank + n);
  conic_memory_release(context, chunk);
  return CONIC_OK;
}

static void write_resolution(double dpi, FILE *to) {
  unsigned char chunk[32], *data = chunk + CONIC_PNG_DATA;
  for (int i = 0; i < 2; i++)
    conic_store_big_32(data + (size_t)i * 4, (uint32_t)(dpi / 0.0254 + 0.5));
  data[8] = 1; /* a metre */
  put_chunk(to, chunk, "pHYs", 9);
}

static conic_status write_image(conic_context *context, const conic_image *image, conic_tone tone,
                                const conic_png_rows *rows, FILE *to) {
  unsigned char end[12];
  write_head(image, to);
  if (rows)
    write_resolution(rows->dpi, to);
  conic_status status = image->shot ? write_shot(context, image->shot, to) : CONIC_OK;
  if (status == CONIC_OK)
    status = conic_png_write_strips(context, image, tone, rows, to);
  if (status == CONIC_OK)
    put_chunk(to, end, "IEND", 0);
  return status;
}

conic_status conic_png_check(conic_context *context, const char *path, unsigned planes) {
  if (!(planes & 1u << CONIC_PLANE_RGBA))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "%s: cannot write: the format holds rgba, which the image has not",
                      path);
  return CONIC_OK;
}

static conic_status write_file(conic_context *context, const char *path, const conic_image *image, conic_tone tone,
                               const conic_png_rows *rows) {
  conic_output *output;
  conic_status status = conic_output_open(context, path, &output);
  if (status != CONIC_OK)
    return status;
  status = write_image(context, image, tone, rows, conic_output_stream(output));
  return conic_output_end(output, status); /* which also says what is wrong with the stream */
}

conic_status conic_png_write(conic_context *context, const char *path, const conic_image *image, conic_tone tone) {
  conic_status status = conic_png_check(context, path, conic_image_planes(image));
  return status == CONIC_OK ? write_file(context, path, image, tone, NULL) : status;
}

conic_status conic_png_write_rows(conic_context *context, const char *path, const conic_png_rows *rows) {
  const conic_image size = {.width = rows->width, .height = rows->height};
  return write_file(context, path, &size, CONIC_TONE_SRGB, rows);
}

conic_status conic_png_write_to(conic_context *context, FILE *stream, const conic_image *image) {
  conic_status status = conic_png_check(context, "a picture", conic_image_planes(image));
  return status == CONIC_OK ? write_image(context, image, CONIC_TONE_SRGB, NULL, stream) : status;
}

/* --- reading --- */

#if CONIC_HAVE_PNG

#include <png.h>

/* A file being read. libpng leaves by longjmp: memory to release is noted here, not in variables. */
typedef struct png_work {
  conic_context *context;
  const char *path;
  FILE *file;
  png_structp png;
  png_infop info;
  int width, height;
  conic_samples_layout layout;
  unsigned char *samples;
  int is_raw;        /* codes are read as they are */
  char message[100]; /* libpng's */
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

conic_status conic_png_read(conic_context *context, const char *path, conic_image *image) {
  return conic_foreign_read(context, path, image);
}

conic_status conic_png_read_codes(conic_context *context, const char *path, conic_image *image, unsigned *most_code) {
  (void)image;
  (void)most_code;
  return conic_fail(context, CONIC_ERROR_UNSUPPORTED, "%s: the codes of a PNG need libpng, which this build lacks",
                    path);
}

#endif
