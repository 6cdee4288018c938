/* Directions of the sequence, spread evenly over the sphere or as a sky's picture is bright. */

#include "accumulation/sequence.h"
#include "core/base/trigonometry.h"
#include "core/image/framing.h"
#include "core/image/image_common.h"
#include "lighting/light_work.h"

/* The sky's power as running sums: over the rows, and in each row over its pixels, divided by the whole. A pixel's
 * power is its greatest colour times its solid angle. */
struct conic_sky {
  conic_context *context;
  int width, height;
  double rows[3][3];       /* right, down and forward in the world */
  double whole;            /* Σ power of all pixels, over 4π·pixels: in units of a white sky's power */
  double *row_sums;        /* height + 1, from 0 to 1 */
  float *pixel_sums;       /* (width + 1) a row, from 0 to 1 */
  float *color;            /* 3 a pixel */
  double moments[3][4][4]; /* of each colour: the mean over all directions d of light · e_i·e_j, with e = (d, 1) */
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

/* A row's light, and the same times cosine and sine of the angle and of twice the angle, each averaged over its pixel.
 */
static void sum_up_row(const conic_sky *sky, int y, const double *cosine_sine, double sums[3][5]) {
  const double half = CONIC_PI / sky->width, once = conic_sin(half) / half, twice = once * conic_cos(half);
  memset(sums, 0, 3 * sizeof *sums);
  for (int x = 0; x < sky->width; x++) {
    const float *color = sky->color + 3 * ((size_t)y * (size_t)sky->width + (size_t)x);
    const double u = cosine_sine[(size_t)x * 2], v = cosine_sine[(size_t)x * 2 + 1];
    const double parts[5] = {1.0, once * u, once * v, twice * (u * u - v * v), twice * (2.0 * u * v)};
    for (int c = 0; c < 3; c++)
      for (int k = 0; k < 5; k++)
        sums[c][k] += parts[k] * (double)color[c];
  }
}

/* The moments of a row, in the order of set_direction. All means over the heights z from bottom to top are exact. */
static void add_row_moments(conic_sky *sky, int y, const double *cosine_sine) {
  double from = CONIC_PI * y / sky->height, to = CONIC_PI * (y + 1) / sky->height, sums[3][5];
  double top = conic_cos(from), bottom = conic_cos(to), a = conic_sin(from), b = conic_sin(to), span = top - bottom;
  double z = 0.5 * (top + bottom), zz = (top * top + top * bottom + bottom * bottom) / 3.0;
  double around = 0.5 * ((to - from) + (a * top - b * bottom)) / span; /* of √(1 − z²) */
  double slanted = (b * b * b - a * a * a) / (3.0 * span);             /* of z·√(1 − z²) */
  sum_up_row(sky, y, cosine_sine, sums);
  for (int c = 0; c < 3; c++) {
    const double *s = sums[c], half = 0.5 * (1.0 - zz);
    const double row[4][4] = {{half * (s[0] + s[3]), half * s[4], slanted * s[1], around * s[1]},
                              {half * s[4], half * (s[0] - s[3]), slanted * s[2], around * s[2]},
                              {slanted * s[1], slanted * s[2], zz * s[0], z * s[0]},
                              {around * s[1], around * s[2], z * s[0], s[0]}};
    for (int i = 0; i < 16; i++)
      sky->moments[c][i / 4][i % 4] += 4.0 * row_area(sky, y) / sky->width * row[i / 4][i % 4];
  }
}

static conic_status sum_up_moments(conic_sky *sky) {
  double *cosine_sine = conic_memory_allocate(sky->context, (size_t)sky->width, 2 * sizeof *cosine_sine);
  if (!cosine_sine)
    return CONIC_ERROR_MEMORY;
  for (int x = 0; x < sky->width; x++) {
    double angle = 2.0 * CONIC_PI * ((x + 0.5) / sky->width - 0.5);
    cosine_sine[(size_t)x * 2] = conic_cos(angle);
    cosine_sine[(size_t)x * 2 + 1] = conic_sin(angle);
  }
  for (int y = 0; y < sky->height; y++)
    add_row_moments(sky, y, cosine_sine);
  conic_memory_release(sky->context, cosine_sine);
  return CONIC_OK;
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
  if (conic_memory_allocate_these(sky->context, CONIC_ROOM(sky->row_sums, height + 1),
                                  CONIC_ROOM(sky->pixel_sums, (width + 1) * height),
                                  CONIC_ROOM(sky->color, 3 * (width * height))) != CONIC_OK)
    return CONIC_ERROR_MEMORY;
  if (!take_sky_colors(image, sky))
    return conic_fail(sky->context, CONIC_ERROR_INPUT, "%s: a colour is not finite, or above 1e12", who);
  sum_up_sky(sky);
  return sky->whole > 0.0 ? sum_up_moments(sky)
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

/* max(0, x) is about 3/32 + x/2 + 15/32·x²: the first three of its Legendre polynomials. */
void conic_sky_rest_without(const conic_sky *sky, uint64_t i_direction, conic_sky_rest *rest) {
  double direction[3], light[3], axes[3][3];
  conic_sky_direction(sky, i_direction, direction, light);
  for (int k = 0; k < 3; k++) { /* of the moments, in the world */
    axes[0][k] = sky->rows[2][k];
    axes[1][k] = sky->rows[0][k];
    axes[2][k] = -sky->rows[1][k];
  }
  for (int c = 0; c < 3; c++) {
    const double(*m)[4] = sky->moments[c];
    rest->q0[c] = (float)(3.0 / 32.0 * (m[3][3] - light[c]));
    for (int i = 0; i < 3; i++) {
      double first = axes[0][i] * m[0][3] + axes[1][i] * m[1][3] + axes[2][i] * m[2][3];
      rest->q1[c][i] = (float)(0.5 * (first - light[c] * direction[i]));
      for (int j = 0; j < 3; j++) {
        double second = -light[c] * direction[i] * direction[j];
        for (int k = 0; k < 9; k++)
          second += axes[k / 3][i] * m[k / 3][k % 3] * axes[k % 3][j];
        rest->q2[c][i][j] = (float)(15.0 / 32.0 * second);
      }
    }
  }
}

void conic_sky_look(const conic_sky *sky, const float direction[3], float color[3]) {
  double seen[3];
  for (int i = 0; i < 3; i++)
    seen[i] = ((double)direction[0] * sky->rows[i][0] + (double)direction[1] * sky->rows[i][1]) +
              (double)direction[2] * sky->rows[i][2];
  double x = (conic_angle(seen[0], seen[2]) / (2.0 * CONIC_PI) + 0.5) * sky->width - 0.5;
  double y = conic_angle(sqrt(seen[0] * seen[0] + seen[2] * seen[2]), -seen[1]) / CONIC_PI * sky->height - 0.5;
  y = y > 0.0 ? y < sky->height - 1 ? y : sky->height - 1 : 0.0;
  x = x < 0.0 ? x + sky->width : x;
  const int left = (int)x % sky->width, right = (left + 1) % sky->width, top = (int)y;
  const int bottom = top + (top + 1 < sky->height);
  const float across = (float)(x - (int)x), down = (float)(y - top);
  const float *rows[2] = {sky->color + 3 * (size_t)top * (size_t)sky->width,
                          sky->color + 3 * (size_t)bottom * (size_t)sky->width};
  for (int c = 0; c < 3; c++) {
    float ends[2];
    for (int row = 0; row < 2; row++)
      ends[row] = rows[row][3 * left + c] + across * (rows[row][3 * right + c] - rows[row][3 * left + c]);
    color[c] = ends[0] + down * (ends[1] - ends[0]);
  }
}
