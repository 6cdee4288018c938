#include "core/pictures/image_numpy.h"

#include "core/files/mapping.h"
#include "core/files/numpy_array.h"
#include "core/files/zip.h"
#include "core/image/image_common.h"

static const size_t most_plane_bytes = CONIC_MOST_BYTES < UINT32_MAX ? CONIC_MOST_BYTES : (size_t)UINT32_MAX;

/* Where the pixels of an array are: its axes by their meaning. */
typedef struct numpy_pixels {
  const conic_numpy_array *array;
  size_t height, width, n_channels;
  int is_channel_first;
} numpy_pixels;

static int is_channel_count(size_t n) {
  return n == 1 || n == 3 || n == 4;
}

/* Whether the array has the shape of a picture. */
static int find_numpy_pixels(const conic_numpy_array *array, numpy_pixels *pixels) {
  const size_t *shape = array->shape;
  int n = array->n_axes;
  for (; n > 3 && *shape == 1; n--)
    shape++;
  *pixels = (numpy_pixels){.array = array, .n_channels = 1};
  if (n == 3 && !is_channel_count(shape[2]) && is_channel_count(shape[0])) {
    *pixels = (numpy_pixels){array, shape[1], shape[2], shape[0], 1};
  } else if (n == 2 || (n == 3 && is_channel_count(shape[2]))) {
    pixels->height = shape[0];
    pixels->width = shape[1];
    pixels->n_channels = n == 3 ? shape[2] : 1;
  }
  return pixels->height >= 1 && pixels->height <= CONIC_IMAGE_MAX_SIZE && pixels->width >= 1 &&
         pixels->width <= CONIC_IMAGE_MAX_SIZE;
}

static double numpy_sample(const numpy_pixels *p, size_t i_pixel, size_t channel) {
  size_t at = p->is_channel_first ? channel * p->height * p->width + i_pixel : i_pixel * p->n_channels + channel;
  return conic_numpy_array_at(p->array, at);
}

uint32_t conic_numpy_whole_number(double value) {
  if (value == -1.0)
    return CONIC_NO_ID;
  if (!(value >= 0.0 && value <= 4294967295.0) || value != (double)(uint32_t)value)
    return CONIC_NO_ID - 1;
  return (uint32_t)value;
}

static unsigned greatest_code(const conic_numpy_array *array) {
  if (array->type != 'u')
    return 0;
  return array->n_type_bytes == 1 ? 255 : array->n_type_bytes == 2 ? 65535 : 0;
}

/* The channels of a plane from `first` on; grey goes to R, G and B. */
static void take_numpy_plane(const numpy_pixels *p, conic_plane plane, size_t first, conic_image *image) {
  const conic_plane_description *about = conic_plane_describe(plane);
  const unsigned most = plane == CONIC_PLANE_RGBA ? greatest_code(p->array) : 0;
  size_t n = (size_t)about->n_channels, n_taken = plane == CONIC_PLANE_RGBA && first == 0 ? 4 : n - first;
  for (size_t i = 0; i < p->height * p->width; i++)
    for (size_t c = 0; c < n_taken; c++) {
      size_t at = i * n + first + c;
      int is_missing = plane == CONIC_PLANE_RGBA && first == 0 && c == 3 && p->n_channels != 4;
      double value = is_missing ? 1.0 : numpy_sample(p, i, p->n_channels == 1 ? 0 : c);
      if (most && !is_missing)
        value /= most;
      if (about->is_uint)
        ((uint32_t *)image->planes[plane])[at] = conic_numpy_whole_number(value);
      else
        ((float *)image->planes[plane])[at] = (float)value;
    }
  if (p->array->type == 'f' && p->array->n_type_bytes == 2)
    image->half_planes |= 1u << plane;
}

/* Puts an array into the image. An image without a size takes the array's. */
static conic_status put_numpy_plane(conic_context *context, const char *path, const char *name,
                                    const conic_numpy_array *array, conic_plane plane, size_t first,
                                    conic_image *image) {
  const conic_plane_description *about = conic_plane_describe(plane);
  numpy_pixels pixels;
  if (!find_numpy_pixels(array, &pixels))
    return conic_fail(context, CONIC_ERROR_INPUT,
                      "%s: %s is not of the shape of a picture: (H, W), (H, W, 3) or (H, W, 4) (at byte 0)", path,
                      name);
  int fits =
      plane == CONIC_PLANE_RGBA ? first == 0 || pixels.n_channels == 1 : pixels.n_channels == (size_t)about->n_channels;
  if (!fits)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: %s has %zu channels a pixel, and the plane %s %d (at byte 0)",
                      path, name, pixels.n_channels, first ? "alpha" : about->name, first ? 1 : about->n_channels);
  if (image->width && ((size_t)image->width != pixels.width || (size_t)image->height != pixels.height))
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: %s has %zu x %zu pixels, and what came before %d x %d", path,
                      name, pixels.width, pixels.height, image->width, image->height);
  if (!image->planes[plane]) {
    conic_image alone;
    conic_status status = conic_image_allocate(context, (int)pixels.width, (int)pixels.height, 1u << plane, &alone);
    if (status != CONIC_OK)
      return status;
    image->width = alone.width;
    image->height = alone.height;
    image->planes[plane] = alone.planes[plane];
  }
  if (plane == CONIC_PLANE_RGBA && first == 0)
    image->lacks_alpha = pixels.n_channels != 4;
  if (plane == CONIC_PLANE_RGBA && first == 3)
    image->lacks_alpha = 0;
  take_numpy_plane(&pixels, plane, first, image);
  return CONIC_OK;
}

/* An array's name in an .npz, and its plane. */
typedef struct numpy_name {
  const char *name;
  conic_plane plane;
  size_t first;
} numpy_name;

static conic_status put_numpy_name(const conic_zip *zip, const numpy_name *about, conic_image *image,
                                   unsigned *most_code) {
  char file[40];
  unsigned char *bytes = NULL;
  size_t n_bytes = 0;
  conic_numpy_array array;
  snprintf(file, sizeof file, "%s.npy", about->name);
  if (!conic_zip_has(zip, file) || (!about->first && image->planes[about->plane]))
    return CONIC_OK;
  conic_status status = conic_zip_read(zip, file, most_plane_bytes, &bytes, &n_bytes);
  if (status == CONIC_OK)
    status = conic_numpy_array_open(zip->context, zip->name, about->name, bytes, n_bytes, &array);
  if (status == CONIC_OK)
    status = put_numpy_plane(zip->context, zip->name, about->name, &array, about->plane, about->first, image);
  if (status == CONIC_OK && about->plane == CONIC_PLANE_RGBA && !about->first)
    *most_code = greatest_code(&array);
  conic_memory_release(zip->context, bytes);
  return status;
}

static conic_status read_named_arrays(conic_context *context, const char *path, const conic_mapping *file,
                                      conic_image *image, unsigned *most_code) {
  static const char *const colors[] = {"rgba", "rgb", "render_colors", "image", "colors", "render", "renders"};
  static const char *const alphas[] = {"A", "alpha", "render_alphas", "alphas"};
  conic_zip zip;
  conic_status status = conic_zip_open(context, path, file->bytes, file->n_bytes, &zip);
  for (size_t i = 0; i < sizeof colors / sizeof *colors && status == CONIC_OK; i++)
    status = put_numpy_name(&zip, &(numpy_name){colors[i], CONIC_PLANE_RGBA, 0}, image, most_code);
  for (size_t i = 0; i < sizeof alphas / sizeof *alphas && status == CONIC_OK && image->planes[CONIC_PLANE_RGBA]; i++)
    status = put_numpy_name(&zip, &(numpy_name){alphas[i], CONIC_PLANE_RGBA, 3}, image, most_code);
  for (int plane = CONIC_PLANE_Z; plane < CONIC_N_PLANES && status == CONIC_OK; plane++)
    status = put_numpy_name(&zip, &(numpy_name){conic_plane_describe((conic_plane)plane)->name, (conic_plane)plane, 0},
                            image, most_code);
  if (status == CONIC_OK && !conic_image_planes(image))
    status = conic_fail(context, CONIC_ERROR_INPUT,
                        "%s: it has no array of the name of a plane: rgba, rgb, A, Z, N … (at byte 0)", path);
  return status;
}

conic_status conic_numpy_plane_read(conic_context *context, const char *path, conic_plane plane, conic_image *image) {
  conic_mapping file;
  conic_numpy_array array;
  conic_status status = conic_mapping_open(context, path, &file);
  if (status != CONIC_OK)
    return status;
  status = conic_numpy_array_open(context, path, "the array", file.bytes, file.n_bytes, &array);
  if (status == CONIC_OK)
    status = put_numpy_plane(context, path, "the array", &array, plane, 0, image);
  conic_mapping_close(context, &file);
  return status;
}

conic_status conic_numpy_image_read(conic_context *context, const char *path, conic_image *image, unsigned *most_code) {
  conic_mapping file;
  conic_numpy_array array;
  *most_code = 0;
  memset(image, 0, sizeof *image);
  conic_status status = conic_mapping_open(context, path, &file);
  if (status != CONIC_OK)
    return status;
  if (file.n_bytes >= 2 && memcmp(file.bytes, "PK", 2) == 0)
    status = read_named_arrays(context, path, &file, image, most_code);
  else {
    status = conic_numpy_array_open(context, path, "the array", file.bytes, file.n_bytes, &array);
    if (status == CONIC_OK)
      status = put_numpy_plane(context, path, "the array", &array, CONIC_PLANE_RGBA, 0, image);
    if (status == CONIC_OK)
      *most_code = greatest_code(&array);
  }
  conic_mapping_close(context, &file);
  if (status != CONIC_OK)
    conic_image_release(context, image);
  return status;
}
