/* Directions of the sequence, spread evenly over the sphere or as a sky's picture is bright. */
#include <math.h>
#include <string.h>

#include "conic/lighting.h"

#include "accumulation/sequence.h"
#include "core/base/memory.h"
#include "core/base/message.h"
#include "core/base/trigonometry.h"
#include "core/base/vectors.h"
#include "core/image/framing.h"
#include "core/image/image_common.h"

/* The sky's power as running sums: over the rows, and in each row over its pixels, divided by the whole. A pixel's
 * power is its greatest colour times its solid angle. */
struct conic_sky {
  conic_context *context;
  int width, height;
  double rows[3][3]; /* right, down and forward in the world */
  double whole;      /* Σ power of all pixels, over 4π·pixels: in units of a white sky's power */
  double *row_sums;  /* height + 1, from 0 to 1 */
  float *pixel_sums; /* (width + 1) a row, from 0 to 1 */
  float *color;      /* 3 a pixel */
};

static double power_of(const float *color) {
  float greatest = color[0] > color[1] ? color[0] : color[1];
  return (double)(color[2] > greatest ? color[2] : greatest);
}

static int take_sky_colors(const conic_image *image, conic_sky *sky) {
  const float *rgba = image->planes[CONIC_PLANE_RGBA];
  for (size_t i = 0; i < conic_image_pixels(image); i++)
    for (size_t c = 0; c < 3; c++) {
      float value = rgba[4 * i + c];
      if (!(value < 1e12f) || !(value > -1e12f))
        return 0;
      sky->color[3 * i + c] = value > 0.0f ? value : 0.0f; /* negative values, which filters leave, are no light */
    }
  return 1;
}

/* A row's area is that between its two latitudes. */
static double row_area(const conic_sky *sky, int y) {
  return 0.5 * (conic_cos(CONIC_PI * y / sky->height) - conic_cos(CONIC_PI * (y + 1) / sky->height));
}

static void sum_up_sky(conic_sky *sky) {
  size_t width = (size_t)sky->width;
  double whole = 0.0;
  for (int y = 0; y < sky->height; y++) {
    const float *color = sky->color + 3 * (size_t)y * width;
    float *sums = sky->pixel_sums + (size_t)y * (width + 1);
    double of_row = 0.0, so_far = 0.0;
    for (size_t x = 0; x < width; x++)
      of_row += power_of(color + 3 * x);
    sums[0] = 0.0f;
    for (size_t x = 0; x < width; x++) {
      so_far += power_of(color + 3 * x);
      sums[x + 1] = of_row > 0.0 ? (float)(so_far / of_row) : (float)(x + 1) / (float)width;
    }
    sky->row_sums[y] = whole;
    whole += of_row / sky->width * row_area(sky, y);
  }
  sky->row_sums[sky->height] = whole;
  for (int y = 0; y <= sky->height && whole > 0.0; y++)
    sky->row_sums[y] /= whole;
  sky->whole = whole;
}

static conic_status fill_sky(const char *who, const conic_image *image, const double up[3], conic_sky *sky) {
  conic_framing framing, own;
  size_t width = (size_t)image->width, height = (size_t)image->height;
  conic_framing_init(&framing);
  memcpy(framing.up, up, sizeof framing.up);
  framing.azimuth_deg = framing.elevation_deg = 0.0;
  conic_status status = conic_framing_take(sky->context, &framing, &own);
  if (status != CONIC_OK)
    return status;
  conic_framing_rotation(&own, sky->rows);
  sky->width = image->width;
  sky->height = image->height;
  sky->row_sums = conic_memory_allocate(sky->context, height + 1, sizeof *sky->row_sums);
  sky->pixel_sums = conic_memory_allocate(sky->context, (width + 1) * height, sizeof *sky->pixel_sums);
  sky->color = conic_memory_allocate(sky->context, width * height, 3 * sizeof *sky->color);
  if (!sky->row_sums || !sky->pixel_sums || !sky->color)
    return CONIC_ERROR_MEMORY;
  if (!take_sky_colors(image, sky))
    return conic_fail(sky->context, CONIC_ERROR_INPUT, "%s: a colour is not finite, or above 1e12", who);
  sum_up_sky(sky);
  return sky->whole > 0.0 ? CONIC_OK
                          : conic_fail(sky->context, CONIC_ERROR_INPUT, "%s: no light: no colour is above 0", who);
}

static conic_status check_sky_place(conic_context *context, const double up[3], conic_sky **sky) {
  if (sky)
    *sky = NULL;
  return sky && up ? CONIC_OK
                   : conic_fail(context, CONIC_ERROR_ARGUMENT, "sky: no place to put it, or no direction up");
}

static conic_status make_sky(conic_context *context, const char *who, const conic_image *image, const double up[3],
                             conic_sky **sky) {
  if (!image || !image->planes[CONIC_PLANE_RGBA])
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: the picture has no colours", who);
  conic_sky *made = conic_memory_allocate_zeroed(context, 1, sizeof *made);
  if (!made)
    return CONIC_ERROR_MEMORY;
  made->context = context;
  conic_status status = fill_sky(who, image, up, made);
  if (status == CONIC_OK)
    *sky = made;
  else
    conic_sky_destroy(made);
  return status;
}

conic_status conic_sky_create(conic_context *context, const conic_image *image, const double up[3], conic_sky **sky) {
  conic_status status = check_sky_place(context, up, sky);
  return status == CONIC_OK ? make_sky(context, "sky", image, up, sky) : status;
}

conic_status conic_sky_read(conic_context *context, const char *path, const double up[3], conic_sky **sky) {
  conic_image image;
  conic_status status = check_sky_place(context, up, sky);
  if (status == CONIC_OK)
    status = conic_image_read(context, path, &image);
  if (status != CONIC_OK)
    return status;
  status = make_sky(context, path, &image, up, sky);
  conic_image_release(context, &image);
  return status;
}

void conic_sky_destroy(conic_sky *sky) {
  if (!sky)
    return;
  conic_memory_release_these(sky->context, sky->row_sums, sky->pixel_sums, sky->color, sky);
}

/* Finds the two ascending sums between which `u` lies; *u becomes its place between them, 0 to 1. */
static int find_row(const double *sums, int n, double *u) {
  int low = 0, high = n;
  while (high - low > 1) {
    int middle = low + (high - low) / 2;
    if (sums[middle] <= *u)
      low = middle;
    else
      high = middle;
  }
  *u = (*u - sums[low]) / (sums[low + 1] - sums[low]);
  return low;
}

static int find_pixel(const float *sums, int n, double *u) {
  int low = 0, high = n;
  while (high - low > 1) {
    int middle = low + (high - low) / 2;
    if ((double)sums[middle] <= *u)
      low = middle;
    else
      high = middle;
  }
  *u = (*u - (double)sums[low]) / ((double)sums[low + 1] - (double)sums[low]);
  return low;
}

/* A unit vector at a height from -1 to 1 above the plane of the first and the third row, and at that angle about it. */
static void set_direction(double height, double angle, double direction[3]) {
  double around = sqrt((1.0 - height) * (1.0 + height));
  direction[0] = around * conic_cos(angle);
  direction[1] = around * conic_sin(angle);
  direction[2] = height;
}

void conic_sky_direction(const conic_sky *sky, uint64_t i, double direction[3], double light[3]) {
  double u = conic_sequence_at(i, CONIC_SEQUENCE_DIRECTION), v = conic_sequence_at(i, CONIC_SEQUENCE_DIRECTION + 1),
         from_sky[3];
  if (!sky) {
    set_direction(1.0 - 2.0 * u, 2.0 * CONIC_PI * v, direction);
    light[0] = light[1] = light[2] = 4.0; /* the mean over all directions of the cosine is a quarter */
    return;
  }
  int y = find_row(sky->row_sums, sky->height, &u);
  int x = find_pixel(sky->pixel_sums + (size_t)y * ((size_t)sky->width + 1), sky->width, &v);
  const float *color = sky->color + 3 * ((size_t)y * (size_t)sky->width + (size_t)x);
  double top = conic_cos(CONIC_PI * y / sky->height), bottom = conic_cos(CONIC_PI * (y + 1) / sky->height);
  set_direction(top + u * (bottom - top), 2.0 * CONIC_PI * ((x + v) / sky->width - 0.5), from_sky);
  for (int axis = 0; axis < 3; axis++) {
    direction[axis] =
        (from_sky[1] * sky->rows[0][axis] - from_sky[2] * sky->rows[1][axis]) + from_sky[0] * sky->rows[2][axis];
    light[axis] = 4.0 * sky->whole * (double)color[axis] / power_of(color);
  }
}
