/* Reads a picture to be judged, and the ranges that its values stand for. */
#include "conic/picture.h"

#include "core/base/color.h"
#include "core/files/file.h"
#include "core/image/image_common.h"
#include "core/pictures/image_numpy.h"
#include "core/pictures/image_png.h"

/* A value is a float before it becomes a code, and its rounding may carry it over a border. */
#define CODE_SLACK 0x1p-22

CONIC_DEFINE_NAMES(conic_code_rounding_name, conic_code_rounding, CONIC_N_CODE_ROUNDINGS, "either", "nearest", "down")

CONIC_DEFINE_ZERO_OPTIONS(conic_picture_options)

void conic_picture_release(conic_context *context, conic_picture *picture) {
  if (!picture)
    return;
  conic_image_release(context, &picture->image);
  conic_image_release(context, &picture->greatest);
  memset(picture, 0, sizeof *picture);
}

/* The range of values that become a code; the first and the last code stand for all values beyond, too. */
static void range_of_code(double code, double most, const conic_picture_options *o, int is_color, double range[2]) {
  double below = o->rounding == CONIC_CODES_DOWN ? 0.0 : 0.5, above = o->rounding == CONIC_CODES_NEAREST ? 0.5 : 1.0;
  for (int side = 0; side < 2; side++) {
    double value = (side ? code + above : code - below) / most;
    value += side ? CODE_SLACK : -CODE_SLACK;
    range[side] = is_color && o->is_srgb ? conic_srgb_decode(value) : value;
  }
  if (code <= 0.0)
    range[0] = -HUGE_VAL;
  if (code >= most)
    range[1] = HUGE_VAL;
}

/* The range of values that become a half float, rounded to nearest or towards zero. */
static void range_of_half(double value, double range[2]) {
  double step = fabs(value) * 0x1p-10 + 0x1p-24;
  range[0] = value - step;
  range[1] = value + step;
}

static float outward_float(double x, int is_up) {
  return (float)(x + (is_up ? 1.0 : -1.0) * fabs(x) * 0x1p-24);
}

/* Multiplies a colour's range by alpha's. Where alpha may be 0, the colour's code may be anything. */
static void multiply_by_alpha(const double alpha[2], double color[2]) {
  if (!(alpha[0] > 0.0)) {
    color[0] = -HUGE_VAL;
    color[1] = HUGE_VAL;
    return;
  }
  const double most = alpha[1] < 1.0 ? alpha[1] : 1.0;
  color[0] *= color[0] < 0.0 ? most : alpha[0];
  color[1] *= color[1] < 0.0 ? alpha[0] : most;
}

static void spread_pixel(float *low, float *high, unsigned most_code, const conic_picture_options *o, int has_alpha) {
  double range[4][2];
  for (int c = 0; c < 4; c++) {
    range[c][0] = (double)low[c];
    range[c][1] = (double)high[c];
    if (most_code)
      range_of_code(floor(range[c][0] * most_code + 0.5), most_code, o, c < 3, range[c]);
  }
  for (int c = 0; c < 3 && has_alpha && o->is_straight; c++)
    multiply_by_alpha(range[3], range[c]);
  for (int c = 0; c < 4; c++) {
    if (!most_code && o->is_clipped && c < 3) {
      range[c][0] = range[c][0] <= 0.0 ? -HUGE_VAL : range[c][0];
      range[c][1] = range[c][1] >= 1.0 ? HUGE_VAL : range[c][1];
    }
    low[c] = outward_float(range[c][0], 0);
    high[c] = outward_float(range[c][1], 1);
  }
}

/* An opaque picture's alpha says nothing: writers of codes over a background fill it in. */
static int is_alpha_full(const conic_image *image) {
  const float *rgba = image->planes[CONIC_PLANE_RGBA];
  for (size_t i = 0; i < conic_image_pixels(image); i++)
    if (rgba[4 * i + 3] < 1.0f)
      return 0;
  return 1;
}

static void spread_halves(conic_picture *picture, int plane) {
  const conic_plane_description *about = conic_plane_describe((conic_plane)plane);
  float *low = picture->image.planes[plane], *high = picture->greatest.planes[plane];
  for (size_t i = 0; i < conic_image_pixels(&picture->image) * (size_t)about->n_channels; i++) {
    double range[2];
    range_of_half((double)low[i], range);
    low[i] = outward_float(range[0], 0);
    high[i] = outward_float(range[1], 1);
  }
}

/* Copies the image to `greatest`, and moves both to the ends of the ranges. */
static conic_status spread_picture(conic_context *context, unsigned most_code, const conic_picture_options *o,
                                   conic_picture *picture) {
  conic_image *image = &picture->image;
  const unsigned planes = conic_image_planes(image);
  int is_colored = planes & 1u && (most_code || o->is_clipped || o->is_straight);
  if (!(image->half_planes & planes) && !is_colored)
    return CONIC_OK;
  if (is_colored && most_code && !image->lacks_alpha && is_alpha_full(image))
    image->lacks_alpha = (uint64_t)(picture->is_alpha_dropped = 1);
  conic_status status = conic_image_allocate(context, image->width, image->height, planes, &picture->greatest);
  for (int plane = 0; plane < CONIC_N_PLANES && status == CONIC_OK; plane++) {
    const conic_plane_description *about = conic_plane_describe((conic_plane)plane);
    if (!image->planes[plane])
      continue;
    memcpy(picture->greatest.planes[plane], image->planes[plane],
           conic_image_pixels(image) * (size_t)about->n_channels * 4);
    if (image->half_planes >> plane & 1 && !about->is_uint)
      spread_halves(picture, plane);
  }
  float *low = image->planes[CONIC_PLANE_RGBA], *high = picture->greatest.planes[CONIC_PLANE_RGBA];
  for (size_t i = 0; status == CONIC_OK && is_colored && i < conic_image_pixels(image); i++)
    spread_pixel(low + 4 * i, high + 4 * i, most_code, o, !image->lacks_alpha);
  return status;
}

/* Takes the options as this version has them. Errors: ARGUMENT. */
static conic_status take_picture_options(conic_context *context, const conic_picture_options *options,
                                         conic_picture_options *own) {
  conic_picture_options_init(own);
  if ((options && !conic_options_take(own, options)) || !conic_code_rounding_name(own->rounding))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "picture: the options were not initialised");
  return CONIC_OK;
}

conic_status conic_picture_take(conic_context *context, conic_image *image, unsigned most_code,
                                const conic_picture_options *options, conic_picture *picture) {
  conic_picture_options own;
  memset(picture, 0, sizeof *picture);
  picture->image = *image;
  picture->most_code = most_code;
  memset(image, 0, sizeof *image);
  conic_status status = take_picture_options(context, options, &own);
  if (status == CONIC_OK && most_code > 65535)
    status = conic_fail(context, CONIC_ERROR_ARGUMENT, "picture: codes have 16 bits at most");
  if (status == CONIC_OK)
    status = spread_picture(context, most_code, &own, picture);
  if (status != CONIC_OK)
    conic_picture_release(context, picture);
  return status;
}

/* Moves a PFM's only plane, which its reader takes for colours, to its own place. */
static conic_status take_pfm_plane(conic_context *context, const char *path, conic_plane plane, conic_image *image) {
  const conic_plane_description *about = conic_plane_describe(plane);
  conic_image read, made;
  conic_status status = conic_image_read(context, path, &read);
  if (status != CONIC_OK)
    return status;
  if (read.width != image->width || read.height != image->height)
    status = conic_fail(context, CONIC_ERROR_INPUT, "%s: it has %d x %d pixels, and the picture %d x %d", path,
                        read.width, read.height, image->width, image->height);
  if (status == CONIC_OK)
    status = conic_image_allocate(context, read.width, read.height, 1u << plane, &made);
  for (size_t i = 0; status == CONIC_OK && i < conic_image_pixels(&read); i++)
    for (size_t c = 0; c < (size_t)about->n_channels; c++) {
      float value = ((const float *)read.planes[CONIC_PLANE_RGBA])[4 * i + c];
      size_t at = i * (size_t)about->n_channels + c;
      if (about->is_uint)
        ((uint32_t *)made.planes[plane])[at] = conic_numpy_whole_number((double)value);
      else
        ((float *)made.planes[plane])[at] = value;
    }
  if (status == CONIC_OK)
    image->planes[plane] = made.planes[plane];
  conic_image_release(context, &read);
  return status;
}

/* Reads the planes in files beside P.pfm or P.npy. */
static conic_status read_planes_beside(conic_context *context, const char *path, unsigned planes, conic_image *image) {
  const char *dot = strrchr(conic_file_name(path), '.');
  conic_status status = CONIC_OK;
  for (int plane = CONIC_PLANE_Z; plane < CONIC_N_PLANES && dot && status == CONIC_OK; plane++) {
    const conic_plane_description *about = conic_plane_describe((conic_plane)plane);
    char beside[4096];
    int n = snprintf(beside, sizeof beside, "%.*s.%s%s", (int)(dot - path), path, about->name, dot);
    if (!(planes >> plane & 1) || n >= (int)sizeof beside || image->planes[plane] || !conic_file_is_there(beside))
      continue;
    status = conic_file_has_ending(path, "pfm") ? take_pfm_plane(context, beside, (conic_plane)plane, image)
                                                : conic_numpy_plane_read(context, beside, (conic_plane)plane, image);
  }
  return status;
}

/* The reader for a file, by its first bytes. */
typedef enum evidence_kind { EVIDENCE_NONE, EVIDENCE_PNG, EVIDENCE_NUMPY, EVIDENCE_FLOATS } evidence_kind;

static evidence_kind find_evidence_kind(const char *path) {
  static const struct {
    const char *bytes;
    size_t n;
    evidence_kind kind;
  } starts[] = {{"\x89PNG", 4, EVIDENCE_PNG},  {"\x93NUMPY", 6, EVIDENCE_NUMPY},
                {"PK\3\4", 4, EVIDENCE_NUMPY}, {"\x76\x2f\x31\x01", 4, EVIDENCE_FLOATS},
                {"PF", 2, EVIDENCE_FLOATS},    {"Pf", 2, EVIDENCE_FLOATS}};
  for (size_t i = 0; i < sizeof starts / sizeof *starts; i++)
    if (conic_file_begins_with(path, starts[i].bytes, starts[i].n))
      return starts[i].kind;
  return EVIDENCE_NONE;
}

conic_status conic_picture_read(conic_context *context, const char *path, unsigned planes,
                                const conic_picture_options *options, conic_picture *picture) {
  conic_picture_options own;
  conic_image image = {.width = 0};
  unsigned most_code = 0;
  memset(picture, 0, sizeof *picture);
  conic_status status = take_picture_options(context, options, &own);
  if (status != CONIC_OK)
    return status;
  switch (conic_file_is_there(path) ? find_evidence_kind(path) : EVIDENCE_FLOATS) {
  case EVIDENCE_PNG:
    own.is_straight = 1;
    status = conic_png_read_codes(context, path, &image, &most_code);
    break;
  case EVIDENCE_NUMPY:
    status = conic_numpy_image_read(context, path, &image, &most_code);
    break;
  case EVIDENCE_FLOATS: /* its reader also says what is wrong with a file */
    status = conic_image_read(context, path, &image);
    break;
  case EVIDENCE_NONE:
    return conic_fail(context, CONIC_ERROR_INPUT,
                      "%s: its values are not known to be kept; EXR, PFM, NPY, NPZ and PNG keep them (at byte 0)",
                      path);
  }
  if (status == CONIC_OK && (conic_file_has_ending(path, "pfm") || conic_file_has_ending(path, "npy")))
    status = read_planes_beside(context, path, planes, &image);
  if (status != CONIC_OK) {
    conic_image_release(context, &image);
    return status;
  }
  return conic_picture_take(context, &image, most_code, &own, picture);
}
