/* Which format an image is written in, by the ending of its name; and read in, by the file's first bytes. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "conic/image.h"
#include "core/base/message.h"
#include "core/files/file.h"
#include "core/image/image_common.h"
#include "core/image/image_exr.h"
#include "core/image/image_foreign.h"
#include "core/image/image_pfm.h"
#include "core/image/image_png.h"

/* The part of PATH's name after its last dot; empty where there is none. */
static const char *ending_of(const char *path) {
  const char *slash = strrchr(path, '/');
  const char *dot = strrchr(slash ? slash : path, '.');
  return dot ? dot + 1 : "";
}

static conic_status check_image(conic_context *context, const char *path, const conic_image *image) {
  if (!image || image->width < 1 || image->height < 1 || image->width > CONIC_IMAGE_MAX_SIZE ||
      image->height > CONIC_IMAGE_MAX_SIZE || image->n_attributes < 0 || image->n_attributes > CONIC_MAX_ATTRIBUTES)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "%s: cannot write: the image has no valid size", path);
  if (!conic_image_planes(image))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "%s: cannot write: the image has no plane", path);
  return CONIC_OK;
}

static conic_status check_name(conic_context *context, const char *path) {
  if (!path || !*path)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "image: no file name to write to");
  if (strcmp(path, "-") == 0)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "image: cannot be written to standard output");
  if (!*ending_of(path))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "%s: the name needs an ending, such as .exr", path);
  return CONIC_OK;
}

conic_status conic_image_check_output(conic_context *context, const char *path, unsigned planes) {
  conic_status status = check_name(context, path);
  if (status != CONIC_OK)
    return status;
  if (conic_file_has_ending(path, "exr"))
    return conic_exr_check(context, path);
  if (conic_file_has_ending(path, "pfm"))
    return conic_pfm_check(context, path, planes);
  if (conic_file_has_ending(path, "png"))
    return conic_png_check(context, path, planes);
  return conic_foreign_check(context, path, planes);
}

conic_status conic_image_write(conic_context *context, const char *path, const conic_image *image) {
  conic_status status = check_name(context, path);
  if (status == CONIC_OK)
    status = check_image(context, path, image);
  if (status != CONIC_OK)
    return status;
  if (conic_file_has_ending(path, "exr"))
    return conic_exr_write(context, path, image);
  if (conic_file_has_ending(path, "pfm"))
    return conic_pfm_write(context, path, image);
  if (conic_file_has_ending(path, "png"))
    return conic_png_write(context, path, image);
  return conic_foreign_write(context, path, image);
}

conic_status conic_image_read(conic_context *context, const char *path, conic_image *image) {
  unsigned char start[4] = {0};
  if (!path || !image)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "image: no file name, or no place for the image");
  memset(image, 0, sizeof *image);
  FILE *file = fopen(path, "rb");
  if (!file)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: cannot read: %s", path, strerror(errno));
  errno = 0;
  size_t n = fread(start, 1, sizeof start, file);
  int error = ferror(file) ? errno : 0;
  fclose(file);
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
  return conic_foreign_read(context, path, image);
}
