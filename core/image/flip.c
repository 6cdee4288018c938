/* ꟻLIP for pictures of low dynamic range (Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström, Fairchild 2020): the
 * difference that is visible when one flips between two pictures on a screen at arm's length. docs/reference/diff.md
 * describes it. All filters are sums of products of two one-dimensional ones. A tile's rows are filtered across one by
 * one, and down over the last rows. */

#include "core/base/gaussian.h"
#include "core/base/power.h"
#include "core/base/real.h"
#include "core/base/trigonometry.h"
#include "core/image/compare.h"
#include "core/image/image_common.h"

/* The published viewer: 0.7 m before a screen that is 0.7 m wide and shows 3840 pixels. */
#define PIXELS_PER_DEGREE (3840.0 * CONIC_PI / 180.0)

/* Three standard deviations of the widest filter, that of Cz, are 9.05 px; those of the features' 8.24 px. */
enum { RADIUS = 10, FEATURE_RADIUS = 9, HALO = 2 * RADIUS, N_TAPS = HALO + 1 };
enum { TILE_WIDTH = 256, TILE_HEIGHT = 64, PADDED_WIDTH = TILE_WIDTH + HALO };

/* Filters of a row: the eye's sensitivity to Y, Cx and Cz, whose filter is a sum of two Gaussians; and a Gaussian with
 * its first two derivatives, which finds edges and points in Y. */
enum { SPATIAL_Y, SPATIAL_CX, SPATIAL_CZ1, SPATIAL_CZ2, SMOOTH, SLOPE, BEND, N_FILTERS };
/* The results after filtering down as well. */
enum { SLOPE_X = SMOOTH, BEND_X, SLOPE_Y, BEND_Y, N_SUMS };

static const int filter_source[N_FILTERS] = {0, 1, 2, 2, 0, 0, 0}; /* of Y, Cx, Cz */

typedef struct flip_tile {
  double opponent[3][PADDED_WIDTH];             /* Y, Cx, Cz of a row */
  double across[N_TAPS][N_FILTERS][TILE_WIDTH]; /* the last rows, filtered across */
} flip_tile;

/* A thread's buffers: a tile of both pictures, and one row of each, filtered down too. */
typedef struct flip_buffers {
  flip_tile tiles[2];
  double sums[2][N_SUMS][TILE_WIDTH];
} flip_buffers;

typedef struct flip_work {
  const conic_image *images[2];
  double weights[N_FILTERS][N_TAPS];
  double greatest; /* the largest colour difference */
  size_t n_tiles_x;
  flip_buffers *buffers; /* a thread */
  double *tile_sums;
  float *map; /* a value a pixel; may be null */
} flip_work;

/* One-dimensional factor of a·π/b·exp(−π²x²/b), x in degrees; not normalised. */
static void sensitivity(double a, double b, double weights[N_TAPS]) {
  for (int i = 0; i < N_TAPS; i++) {
    double x = (double)(i - RADIUS) / PIXELS_PER_DEGREE;
    weights[i] = sqrt(a * sqrt(CONIC_PI / b)) * conic_gaussian_exp(-CONIC_PI * CONIC_PI * x * x / b);
  }
}

static double sum_of(const double weights[N_TAPS]) {
  double sum = 0.0;
  for (int i = 0; i < N_TAPS; i++)
    sum += weights[i];
  return sum;
}

static void scale(double weights[N_TAPS], double factor) {
  for (int i = 0; i < N_TAPS; i++)
    weights[i] *= factor;
}

/* Scales the positive weights to the sum 1, and the negative ones to −1. */
static void balance(double weights[N_TAPS]) {
  double positive = 0.0, negative = 0.0;
  for (int i = 0; i < N_TAPS; i++) {
    positive += weights[i] > 0.0 ? weights[i] : 0.0;
    negative -= weights[i] < 0.0 ? weights[i] : 0.0;
  }
  for (int i = 0; i < N_TAPS; i++)
    weights[i] /= weights[i] > 0.0 ? positive : negative;
}

static void set_filters(double weights[N_FILTERS][N_TAPS]) {
  double deviation = 0.5 * 0.082 * PIXELS_PER_DEGREE; /* of the feature detectors: half of 0.082° */
  sensitivity(1.0, 0.0047, weights[SPATIAL_Y]);
  sensitivity(1.0, 0.0053, weights[SPATIAL_CX]);
  sensitivity(34.1, 0.04, weights[SPATIAL_CZ1]);
  sensitivity(13.5, 0.025, weights[SPATIAL_CZ2]);
  scale(weights[SPATIAL_Y], 1.0 / sum_of(weights[SPATIAL_Y]));
  scale(weights[SPATIAL_CX], 1.0 / sum_of(weights[SPATIAL_CX]));
  double wide = sum_of(weights[SPATIAL_CZ1]), narrow = sum_of(weights[SPATIAL_CZ2]);
  double both = 1.0 / sqrt(wide * wide + narrow * narrow);
  scale(weights[SPATIAL_CZ1], both);
  scale(weights[SPATIAL_CZ2], both);
  for (int i = 0; i < N_TAPS; i++) {
    double x = (double)(i - RADIUS) / deviation;
    double gauss = i < RADIUS - FEATURE_RADIUS || i > RADIUS + FEATURE_RADIUS ? 0.0 : conic_gaussian_exp(-0.5 * x * x);
    weights[SMOOTH][i] = gauss;
    weights[SLOPE][i] = -x * gauss;
    weights[BEND][i] = (x * x - 1.0) * gauss;
  }
  scale(weights[SMOOTH], 1.0 / sum_of(weights[SMOOTH]));
  balance(weights[SLOPE]);
  balance(weights[BEND]);
}

/* XYZ of linear RGB, relative to the white point: X/X_w, Y, Z/Z_w. */
static void xyz_of(const double rgb[3], double xyz[3]) {
  xyz[0] = (10135552.0 * rgb[0] + 8788810.0 * rgb[1] + 4435075.0 * rgb[2]) / (24577794.0 * 0.950428545);
  xyz[1] = (2613072.0 * rgb[0] + 8788810.0 * rgb[1] + 887015.0 * rgb[2]) / 12288897.0;
  xyz[2] = (1425312.0 * rgb[0] + 8788810.0 * rgb[1] + 70074185.0 * rgb[2]) / (73733382.0 * 1.088900371);
}

/* From Y, Cx, Cz back to linear RGB that a screen can show. */
static void rgb_of(double y, double cx, double cz, double rgb[3]) {
  double relative = (y + 16.0) / 116.0;
  double x = (relative + cx / 500.0) * 0.950428545, z = (relative - cz / 200.0) * 1.088900371;
  rgb[0] = conic_unit(3.241003275 * x - 1.537398934 * relative - 0.498615861 * z);
  rgb[1] = conic_unit(-0.969224334 * x + 1.875930071 * relative + 0.041554224 * z);
  rgb[2] = conic_unit(0.055639423 * x - 0.204011202 * relative + 1.057148933 * z);
}

static double lightness(double v) {
  const double delta = 6.0 / 29.0;
  return v > delta * delta * delta ? conic_cube_root(v) : v / (3.0 * delta * delta) + 4.0 / 29.0;
}

/* CIELAB, with Hunt's adjustment: chroma grows with lightness. */
static void lab_of(const double rgb[3], double lab[3]) {
  double xyz[3];
  xyz_of(rgb, xyz);
  double x = lightness(xyz[0]), y = lightness(xyz[1]), z = lightness(xyz[2]);
  lab[0] = 116.0 * y - 16.0;
  lab[1] = 0.01 * lab[0] * (500.0 * (x - y));
  lab[2] = 0.01 * lab[0] * (200.0 * (y - z));
}

/* HyAB, the distance for large differences, to the power of 0.7. */
static double color_distance(const double a_rgb[3], const double b_rgb[3]) {
  double a[3], b[3];
  lab_of(a_rgb, a);
  lab_of(b_rgb, b);
  double chroma = sqrt((a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
  return conic_power(fabs(a[0] - b[0]) + chroma, 0.7);
}

/* Distances up to 0.4 of the greatest take up the scale to 0.95. */
static double color_difference(const flip_work *work, const double a_rgb[3], const double b_rgb[3]) {
  double distance = color_distance(a_rgb, b_rgb), knee = 0.4 * work->greatest;
  if (distance < knee)
    return distance * (0.95 / knee);
  return 0.95 + 0.05 * (distance - knee) / (work->greatest - knee);
}

static double length_of_slope(double x, double y) {
  return sqrt(x * x + y * y) / 116.0; /* Y is 116 wide */
}

/* How much stronger an edge or a point is in one picture than in the other. */
static double feature_difference(const flip_buffers *buffers, size_t x) {
  double edges[2], points[2];
  for (int k = 0; k < 2; k++) {
    const double(*sums)[TILE_WIDTH] = buffers->sums[k];
    edges[k] = length_of_slope(sums[SLOPE_X][x], sums[SLOPE_Y][x]);
    points[k] = length_of_slope(sums[BEND_X][x], sums[BEND_Y][x]);
  }
  double edge = fabs(edges[0] - edges[1]), point = fabs(points[0] - points[1]);
  return sqrt((edge > point ? edge : point) * 0.70710678118654752);
}

static double pixel_error(const flip_work *work, const flip_buffers *buffers, size_t x) {
  double rgb[2][3];
  for (int k = 0; k < 2; k++) {
    const double(*sums)[TILE_WIDTH] = buffers->sums[k];
    rgb_of(sums[SPATIAL_Y][x], sums[SPATIAL_CX][x], sums[SPATIAL_CZ1][x] + sums[SPATIAL_CZ2][x], rgb[k]);
  }
  if (rgb[0][0] == rgb[1][0] && rgb[0][1] == rgb[1][1] && rgb[0][2] == rgb[1][2])
    return 0.0;
  double difference = color_difference(work, rgb[0], rgb[1]), feature = feature_difference(buffers, x);
  return feature < 1.0 ? conic_power(difference, 1.0 - feature) : 1.0;
}

static size_t clamp_to(ptrdiff_t i, size_t n) {
  return i < 0 ? 0 : (size_t)i < n ? (size_t)i : n - 1;
}

static void load_row(const conic_image *image, ptrdiff_t x_begin, ptrdiff_t y, size_t n, flip_tile *tile) {
  const float *rgba = image->planes[CONIC_PLANE_RGBA];
  const float *row = rgba + 4 * clamp_to(y, (size_t)image->height) * (size_t)image->width;
  for (size_t i = 0; i < n; i++) {
    const float *pixel = row + 4 * clamp_to(x_begin + (ptrdiff_t)i, (size_t)image->width);
    double rgb[3] = {conic_unit((double)pixel[0]), conic_unit((double)pixel[1]), conic_unit((double)pixel[2])}, xyz[3];
    for (int c = 0; image->is_display && c < 3; c++)
      rgb[c] = conic_srgb_decode(rgb[c]);
    xyz_of(rgb, xyz);
    tile->opponent[0][i] = 116.0 * xyz[1] - 16.0;
    tile->opponent[1][i] = 500.0 * (xyz[0] - xyz[1]);
    tile->opponent[2][i] = 200.0 * (xyz[1] - xyz[2]);
  }
}

static void filter_across(const flip_work *work, flip_tile *tile, size_t i_row, size_t n) {
  for (int k = 0; k < N_FILTERS; k++) {
    double *sums = tile->across[i_row % N_TAPS][k];
    memset(sums, 0, n * sizeof *sums);
    for (size_t t = 0; t < N_TAPS; t++)
      conic_add_weighted(sums, tile->opponent[filter_source[k]] + t, work->weights[k][t], n);
  }
}

/* Filters down to the row whose filters begin at row i_row of the tile. */
static void filter_down(const flip_work *work, const flip_tile *tile, size_t i_row, size_t n,
                        double sums[N_SUMS][TILE_WIDTH]) {
  static const struct {
    int across, down;
  } parts[N_SUMS] = {[SPATIAL_Y] = {SPATIAL_Y, SPATIAL_Y},
                     [SPATIAL_CX] = {SPATIAL_CX, SPATIAL_CX},
                     [SPATIAL_CZ1] = {SPATIAL_CZ1, SPATIAL_CZ1},
                     [SPATIAL_CZ2] = {SPATIAL_CZ2, SPATIAL_CZ2},
                     [SLOPE_X] = {SLOPE, SMOOTH},
                     [BEND_X] = {BEND, SMOOTH},
                     [SLOPE_Y] = {SMOOTH, SLOPE},
                     [BEND_Y] = {SMOOTH, BEND}};
  for (int k = 0; k < N_SUMS; k++) {
    memset(sums[k], 0, n * sizeof **sums);
    for (size_t t = 0; t < N_TAPS; t++)
      conic_add_weighted(sums[k], tile->across[(i_row + t) % N_TAPS][parts[k].across], work->weights[parts[k].down][t],
                         n);
  }
}

/* Whether a channel is NaN in one picture only; filtering must not soften that. */
static int differs_by_nan(const flip_work *work, size_t i_pixel) {
  const float *a = (const float *)work->images[0]->planes[CONIC_PLANE_RGBA] + 4 * i_pixel;
  const float *b = (const float *)work->images[1]->planes[CONIC_PLANE_RGBA] + 4 * i_pixel;
  for (int c = 0; c < 3; c++)
    if ((a[c] != a[c]) != (b[c] != b[c]))
      return 1;
  return 0;
}

/* The sum over a row, which starts at pixel `first` of the image. */
static double finish_row(const flip_work *work, const flip_buffers *buffers, size_t first, size_t n) {
  double sum = 0.0;
  for (size_t x = 0; x < n; x++) {
    double error = differs_by_nan(work, first + x) ? 1.0 : pixel_error(work, buffers, x);
    sum += error;
    if (work->map)
      work->map[first + x] = (float)error;
  }
  return sum;
}

static void compare_tile(void *data, size_t i_item, int i_thread) {
  flip_work *work = data;
  flip_buffers *buffers = &work->buffers[i_thread];
  size_t width = (size_t)work->images[0]->width, height = (size_t)work->images[0]->height;
  size_t x = i_item % work->n_tiles_x * TILE_WIDTH, y = i_item / work->n_tiles_x * TILE_HEIGHT;
  size_t n = width - x < TILE_WIDTH ? width - x : TILE_WIDTH;
  size_t n_rows = height - y < TILE_HEIGHT ? height - y : TILE_HEIGHT;
  double sum = 0.0;
  for (size_t i_row = 0; i_row < n_rows + HALO; i_row++) {
    for (int k = 0; k < 2; k++) {
      load_row(work->images[k], (ptrdiff_t)x - RADIUS, (ptrdiff_t)(y + i_row) - RADIUS, n + HALO, &buffers->tiles[k]);
      filter_across(work, &buffers->tiles[k], i_row, n);
    }
    if (i_row < HALO)
      continue;
    for (int k = 0; k < 2; k++)
      filter_down(work, &buffers->tiles[k], i_row - HALO, n, buffers->sums[k]);
    sum += finish_row(work, buffers, (y + i_row - HALO) * width + x, n);
  }
  work->tile_sums[i_item] = sum;
}

conic_status conic_compare_flip(conic_context *context, const conic_image *a, const conic_image *b, float *map,
                                double *mean) {
  static const double green[3] = {0, 1, 0}, blue[3] = {0, 0, 1};
  flip_work work = {.images = {a, b}};
  work.n_tiles_x = ((size_t)a->width + TILE_WIDTH - 1) / TILE_WIDTH;
  size_t n_tiles = work.n_tiles_x * (((size_t)a->height + TILE_HEIGHT - 1) / TILE_HEIGHT);
  work.map = map;
  work.greatest = color_distance(green, blue);
  set_filters(work.weights);
  work.buffers = conic_memory_allocate(context, (size_t)conic_context_threads(context), sizeof *work.buffers);
  work.tile_sums = work.buffers ? conic_memory_allocate(context, n_tiles, sizeof *work.tile_sums) : NULL;
  if (work.tile_sums) {
    double sum = 0.0;
    conic_parallel_for(context, n_tiles, compare_tile, &work);
    for (size_t i = 0; i < n_tiles; i++)
      sum += work.tile_sums[i];
    *mean = sum / (double)conic_image_pixels(a);
  }
  conic_status status = work.tile_sums ? CONIC_OK : CONIC_ERROR_MEMORY;
  conic_memory_release_these(context, work.tile_sums, work.buffers);
  return status;
}
