#include "core/pictures/image_pfm.h"

#include "core/base/byte_order.h"
#include "core/files/disk.h"
#include "core/files/file.h"
#include "core/image/image_common.h"

/* Up to this number, floats hold every whole number. */
enum { MOST_NUMBER = 1 << 24 };

/* The samples of a pixel that the file takes: without alpha; whole numbers as floats, -1 where nothing is. */
static void take_pixel(const void *plane, const conic_plane_description *description, size_t i_pixel, float *to) {
  size_t n = (size_t)description->n_channels, first = i_pixel * n;
  for (size_t c = 0; c < n && c < 3; c++)
    if (!description->is_uint)
      to[c] = ((const float *)plane)[first + c];
    else if (((const uint32_t *)plane)[first + c] == CONIC_NO_ID)
      to[c] = -1.0f;
    else
      to[c] = (float)((const uint32_t *)plane)[first + c];
}

/* Writes the plane, the bottom row first. */
static conic_status write_rows(conic_context *context, FILE *stream, const conic_image *image, conic_plane plane) {
  const conic_plane_description *description = conic_plane_describe(plane);
  size_t width = (size_t)image->width, n_written = description->n_channels == 1 ? 1 : 3, n_row = width * n_written;
  float *row = conic_memory_allocate(context, n_row, sizeof *row);
  if (!row)
    return CONIC_ERROR_MEMORY;
  for (int y = image->height - 1; y >= 0; y--) {
    for (size_t x = 0; x < width; x++)
      take_pixel(image->planes[plane], description, (size_t)y * width + x, row + x * n_written);
    conic_turn_words(row, n_row, sizeof *row);
    if (fwrite(row, sizeof *row, n_row, stream) != n_row)
      break; /* the stream remembers, and commit says so */
  }
  conic_memory_release(context, row);
  return CONIC_OK;
}

/* Which of these planes the file takes; CONIC_N_PLANES: none. */
static conic_plane choose_plane(unsigned planes) {
  for (int i = 0; i < CONIC_N_PLANES; i++)
    if (planes == 1u << i || (i == CONIC_PLANE_RGBA && planes & 1u))
      return (conic_plane)i;
  return CONIC_N_PLANES;
}

conic_status conic_pfm_check(conic_context *context, const char *path, unsigned planes) {
  if (choose_plane(planes) == CONIC_N_PLANES)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "%s: a PFM holds rgba, or a lone other plane", path);
  return CONIC_OK;
}

static conic_status check_numbers(conic_context *context, const char *path, const conic_image *image,
                                  conic_plane plane) {
  const uint32_t *numbers = image->planes[plane];
  for (size_t i = 0; conic_plane_describe(plane)->is_uint && i < conic_image_pixels(image); i++)
    if (numbers[i] > MOST_NUMBER && numbers[i] != CONIC_NO_ID)
      return conic_fail(context, CONIC_ERROR_UNSUPPORTED,
                        "%s: cannot write: floats hold numbers up to %d, and there is %lu; an EXR holds it", path,
                        MOST_NUMBER, (unsigned long)numbers[i]);
  return CONIC_OK;
}

conic_status conic_pfm_write(conic_context *context, const char *path, const conic_image *image) {
  conic_plane plane = choose_plane(conic_image_planes(image));
  conic_output *output;
  conic_status status = conic_pfm_check(context, path, conic_image_planes(image));
  if (status == CONIC_OK)
    status = check_numbers(context, path, image, plane);
  if (status == CONIC_OK)
    status = conic_output_open(context, path, &output);
  if (status != CONIC_OK)
    return status;
  FILE *stream = conic_output_stream(output);
  int is_grey = conic_plane_describe(plane)->n_channels == 1;
  fprintf(stream, "%s\n%d %d\n-1.0\n", is_grey ? "Pf" : "PF", image->width, image->height);
  status = write_rows(context, stream, image, plane);
  return conic_output_end(output, status);
}

static int is_space(int c) {
  return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

/* Reads the next word of the header, with the one white space after it; 0 where it exceeds the room or the file
 * ends. */
static int read_word(FILE *file, char word[32]) {
  int c = getc(file), n = 0;
  while (is_space(c))
    c = getc(file);
  for (; c != EOF && !is_space(c) && n < 31; c = getc(file))
    word[n++] = (char)c;
  word[n] = 0;
  return n > 0 && is_space(c);
}

/* A whole positive number up to the largest size; 0 for anything else. */
static int parse_size(const char *word) {
  int value = 0;
  for (; *word; word++) {
    if (*word < '0' || *word > '9')
      return 0;
    value = value * 10 + (*word - '0');
    if (value > CONIC_IMAGE_MAX_SIZE)
      return 0;
  }
  return value;
}

/* -1 (little-endian) or 1, the sign of a decimal number; 0 where it is zero or no number. */
static int parse_scale_sign(const char *word) {
  int sign = 1, n_digits = 0, is_zero = 1;
  if (*word == '-' || *word == '+')
    sign = *word++ == '-' ? -1 : 1;
  for (; (*word >= '0' && *word <= '9') || *word == '.'; word++)
    if (*word != '.') {
      n_digits++;
      if (*word != '0')
        is_zero = 0;
    }
  if (*word == 'e' || *word == 'E')
    for (word++; *word == '-' || *word == '+' || (*word >= '0' && *word <= '9'); word++)
      ;
  return *word || !n_digits || is_zero ? 0 : sign;
}

static conic_status read_rows(conic_context *context, const char *path, FILE *file, int is_grey, int is_big,
                              conic_image *image) {
  size_t width = (size_t)image->width, n_channels = is_grey ? 1 : 3;
  float *row = conic_memory_allocate(context, width * n_channels, sizeof *row);
  if (!row)
    return CONIC_ERROR_MEMORY;
  conic_status status = CONIC_OK;
  for (int y = image->height - 1; y >= 0; y--) {
    size_t n = fread(row, sizeof *row, width * n_channels, file);
    if (n != width * n_channels) {
      status = conic_fail(context, CONIC_ERROR_INPUT, "%s: the file ends in row %d of %d (at byte %lld)", path,
                          image->height - y, image->height, (long long)ftello(file));
      break;
    }
    float *rgba = (float *)image->planes[CONIC_PLANE_RGBA] + (size_t)y * width * 4;
    for (size_t x = 0; x < width; x++) {
      for (size_t c = 0; c < 3; c++) {
        const float *value = &row[x * n_channels + (is_grey ? 0 : c)];
        rgba[x * 4 + c] = is_big ? conic_float_of_bits(conic_load_big_32(value)) : conic_load_float(value);
      }
      rgba[x * 4 + 3] = 1.0f;
    }
  }
  conic_memory_release(context, row);
  return status;
}

/* A false header must not make us allocate more than the file can fill. */
static int is_long_enough(FILE *file, int width, int height, int n_channels) {
  long long here = ftello(file);
  if (here < 0 || fseeko(file, 0, SEEK_END) != 0)
    return 1; /* a pipe: its end shows while reading */
  long long end = ftello(file);
  fseeko(file, here, SEEK_SET);
  return end - here >= 4LL * n_channels * width * height;
}

static conic_status read_pfm(conic_context *context, const char *path, FILE *file, conic_image *image) {
  char magic[32], word[32];
  int size[2], sign;
  if (!read_word(file, magic) || (strcmp(magic, "PF") != 0 && strcmp(magic, "Pf") != 0))
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: not a PFM file (line 1)", path);
  for (int i = 0; i < 2; i++)
    if (!read_word(file, word) || !(size[i] = parse_size(word)))
      return conic_fail(context, CONIC_ERROR_INPUT, "%s: the %s is not a number from 1 to %d (line 2)", path,
                        i == 0 ? "width" : "height", CONIC_IMAGE_MAX_SIZE);
  if (!read_word(file, word) || !(sign = parse_scale_sign(word)))
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: the scale is not a number other than 0 (line 3)", path);
  int is_grey = magic[1] == 'f';
  if (!is_long_enough(file, size[0], size[1], is_grey ? 1 : 3))
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: the file is too short for %d × %d pixels (at byte %lld)", path,
                      size[0], size[1], (long long)ftello(file));
  conic_status status = conic_image_check_size(context, path, size[0], size[1], 16);
  if (status == CONIC_OK)
    status = conic_image_allocate(context, size[0], size[1], 1u << CONIC_PLANE_RGBA, image);
  if (status != CONIC_OK)
    return status;
  image->lacks_alpha = 1;
  status = read_rows(context, path, file, is_grey, sign > 0, image);
  if (status != CONIC_OK)
    conic_image_release(context, image);
  return status;
}

conic_status conic_pfm_read(conic_context *context, const char *path, conic_image *image) {
  FILE *file = conic_disk_open_stream(path, "rb");
  if (!file)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: cannot read: %s", path, strerror(errno));
  conic_status status = read_pfm(context, path, file, image);
  fclose(file);
  return status;
}
