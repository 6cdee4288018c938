/* Chooses an image's format: for writing by the ending of its name, for reading by the file's first bytes. */
#include <strings.h>

#include "core/base/loan_find.h"
#include "core/files/file.h"
#include "core/files/guard.h"
#include "core/image/image_common.h"
#include "core/pictures/image_exr.h"
#include "core/pictures/image_foreign.h"
#include "core/pictures/image_numpy.h"
#include "core/pictures/image_pfm.h"
#include "core/pictures/image_png.h"

CONIC_DEFINE_ZERO_OPTIONS(conic_image_options)

CONIC_DEFINE_NAMES(conic_compression_name, conic_compression, CONIC_N_COMPRESSIONS, "zip", "none", "rle", "zips", "piz",
                   "pxr24")

static conic_status check_image(conic_context *context, const char *path, const conic_image *image) {
  if (!image || image->width < 1 || image->height < 1 || image->width > CONIC_IMAGE_MAX_SIZE ||
      image->height > CONIC_IMAGE_MAX_SIZE || image->n_attributes < 0 || image->n_attributes > CONIC_MAX_ATTRIBUTES)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "%s: cannot write: the image has no valid size", path);
  if (!conic_image_planes(image))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "%s: cannot write: the image has no plane", path);
  return CONIC_OK;
}

/* Which kind of file PATH stands for. */
static conic_status find_format(conic_context *context, const char *path, const conic_image_options *options,
                                const char **format) {
  if (!path || !*path)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "image: no file name to write to");
  *format = conic_file_ending(path);
  if (!**format && options->format)
    *format = options->format;
  else if (strcmp(path, "-") == 0)
    *format = "png";
  if (!**format)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "%s: the name needs an ending, such as .exr", path);
  return CONIC_OK;
}

static conic_status take_options(conic_context *context, const conic_image_options *options, conic_image_options *own) {
  conic_image_options_init(own);
  if ((options && !conic_options_take(own, options)) || !conic_compression_name(own->compression) ||
      !conic_tone_name(own->tone))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "image: the options were not initialised");
  return CONIC_OK;
}

conic_status conic_image_check_output_as(conic_context *context, const char *path, unsigned planes,
                                         const conic_image_options *options) {
  conic_image_options own;
  const char *format = NULL;
  conic_status status = take_options(context, options, &own);
  if (status == CONIC_OK)
    status = find_format(context, path, &own, &format);
  if (status != CONIC_OK)
    return status;
  if (strcasecmp(format, "exr") == 0)
    return conic_exr_check(context, path, planes, &own);
  if (strcasecmp(format, "pfm") == 0)
    return conic_pfm_check(context, path, planes);
  if (strcasecmp(format, "png") == 0)
    return conic_png_check(context, path, planes);
  return conic_foreign_check(context, path, format, planes);
}

conic_status conic_image_check_output(conic_context *context, const char *path, unsigned planes) {
  return conic_image_check_output_as(context, path, planes, NULL);
}

conic_status conic_image_write_as(conic_context *context, const char *path, const conic_image *image,
                                  const conic_image_options *options) {
  conic_image_options own;
  const char *format = NULL;
  conic_status status = take_options(context, options, &own);
  if (status == CONIC_OK)
    status = find_format(context, path, &own, &format);
  if (status == CONIC_OK)
    status = check_image(context, path, image);
  if (status != CONIC_OK)
    return status;
  if (strcasecmp(format, "exr") == 0)
    return conic_exr_write(context, path, image, &own);
  if (strcasecmp(format, "pfm") == 0)
    return conic_pfm_write(context, path, image);
  if (strcasecmp(format, "png") == 0)
    return conic_png_write(context, path, image, own.tone);
  return conic_foreign_write(context, path, format, image, own.tone);
}

conic_status conic_image_write(conic_context *context, const char *path, const conic_image *image) {
  return conic_image_write_as(context, path, image, NULL);
}

static conic_status copy_lent(conic_context *context, const char *name, const conic_image *lent, conic_image *image) {
  unsigned planes = conic_image_planes(lent);
  if (!planes)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "%s: the image has no planes", name);
  conic_status status = conic_image_allocate(context, lent->width, lent->height, planes, image);
  if (status != CONIC_OK)
    return status;
  conic_image copy = *lent;
  memcpy(copy.planes, image->planes, sizeof copy.planes);
  copy.manifest = NULL;
  size_t n_pixels = (size_t)lent->width * (size_t)lent->height;
  for (int i = 0; i < CONIC_N_PLANES; i++)
    if (copy.planes[i])
      memcpy(copy.planes[i], lent->planes[i], n_pixels * 4 * (size_t)conic_plane_describe((conic_plane)i)->n_channels);
  *image = copy;
  return CONIC_OK;
}

conic_status conic_image_read(conic_context *context, const char *path, conic_image *image) {
  unsigned char start[4] = {0};
  unsigned most_code;
  if (!path || !image)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "image: no file name, or no place for the image");
  memset(image, 0, sizeof *image);
  const conic_image *lent = conic_loan_find(context, path, "image");
  if (lent)
    return copy_lent(context, path, lent, image);
  conic_disk_entry found;
  if (conic_disk_look(path, &found) && !found.is_file) /* a device or pipe might not end, or never begin */
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: cannot read: it is %s", path,
                      found.is_folder ? "a directory" : "no regular file");
  FILE *file = conic_disk_open_stream(path, "rb");
  if (!file)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: cannot read: %s", path, strerror(errno));
  conic_status status = conic_disk_look_at(fileno(file), &found) ? conic_guard_note(context, path, &found) : CONIC_OK;
  errno = 0;
  size_t n = fread(start, 1, sizeof start, file);
  int error = ferror(file) ? errno : 0;
  fclose(file);
  if (status != CONIC_OK)
    return status;
  if (error)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: cannot read: %s", path, strerror(error));
  if (n == 0)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: the file is empty (at byte 0)", path);
  if (n == 4 && memcmp(start, "\x76\x2f\x31\x01", 4) == 0)
    return conic_exr_read(context, path, image);
  if (start[0] == 'P' && (start[1] == 'F' || start[1] == 'f'))
    return conic_pfm_read(context, path, image);
  if (n == 4 && memcmp(start, "\x89PNG", 4) == 0)
    return conic_png_read(context, path, image);
  if (n == 4 && (memcmp(start, "\x93NUM", 4) == 0 || memcmp(start, "PK\3\4", 4) == 0))
    return conic_numpy_image_read(context, path, image, &most_code);
  return conic_foreign_read(context, path, image);
}
