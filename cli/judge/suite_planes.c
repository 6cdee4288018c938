#include "cli/judge/suite_planes.h"

#include "core/base/byte_order.h"
#include "core/files/file.h"
#include "core/files/numpy_array.h"

const char *const cli_suite_channel_names[SUITE_CHANNELS] = {"R", "G", "B", "A", "Z"};
const char *const cli_suite_range_names[SUITE_RANGES] = {"value", "low", "high", "least", "most"};

/* The most that underflow may leave of a number. */
static const double nothing = 1e-37, float_unit = 0x1p-24;

typedef struct channel_range {
  double of[SUITE_RANGES];
} channel_range;

static channel_range range_of_bound(const conic_gaussian_bound *b, int i) {
  return (channel_range){{b->value[i], b->low[i], b->high[i], b->least[i], b->most[i]}};
}

/* The range of a number after one more rounding to float, when it is written or put over the background. */
static channel_range range_once_more(channel_range r) {
  for (int k = SUITE_LOW; k < SUITE_RANGES; k++)
    r.of[k] += (k == SUITE_LOW || k == SUITE_LEAST ? -1.0 : 1.0) * float_unit * fabs(r.of[k]);
  return r;
}

/* The range of 1 − T, or of Σ w. Each Gaussian adds four roundings: of T, of 1 − α, of w and of the sum. */
static channel_range range_of_opacity(const conic_gaussian_bound *b) {
  const channel_range T = range_once_more(range_of_bound(b, CONIC_BOUND_T));
  const double spread = 4.0 * float_unit * b->most[CONIC_BOUND_COUNT];
  return range_once_more(
      (channel_range){{1.0 - T.of[SUITE_VALUE], 1.0 - T.of[SUITE_HIGH] - spread, 1.0 - T.of[SUITE_LOW] + spread,
                       1.0 - T.of[SUITE_MOST] - spread, 1.0 - T.of[SUITE_LEAST] + spread}});
}

static channel_range range_of_channel(const conic_gaussian_bound *b, int channel) {
  return channel < 3    ? range_once_more(range_of_bound(b, CONIC_BOUND_RGB + channel))
         : channel == 3 ? range_of_opacity(b)
                        : range_of_bound(b, CONIC_BOUND_Z);
}

/* Rounds the end of a range to the next float outside; an end that could not be computed is none. */
static float rounded_outwards(double value, int range) {
  if (range == SUITE_VALUE)
    return (float)value;
  int is_low = range == SUITE_LOW || range == SUITE_LEAST;
  double end = is_low ? value - nothing : value + nothing;
  if (end != end)
    return is_low ? -INFINITY : INFINITY;
  float rounded = (float)end;
  if (is_low ? (double)rounded > end : (double)rounded < end)
    rounded = nextafterf(rounded, is_low ? -INFINITY : INFINITY);
  return rounded;
}

static conic_status allocate_numbers(conic_context *context, suite_planes *planes) {
  planes->numbers = conic_memory_allocate(context, cli_suite_at(planes, SUITE_RANGES, 0), sizeof(float));
  return planes->numbers ? CONIC_OK : CONIC_ERROR_MEMORY;
}

conic_status cli_suite_take_bounds(conic_context *context, const conic_gaussian_bound *bounds, int has_background,
                                   suite_planes *planes) {
  const size_t n_pixels = (size_t)planes->width * (size_t)planes->height;
  if (allocate_numbers(context, planes) != CONIC_OK)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < n_pixels; i++)
    for (int c = 0; c < SUITE_CHANNELS; c++) {
      channel_range r = range_of_channel(&bounds[i], c);
      if (c == 3 && has_background)
        r.of[SUITE_HIGH] = r.of[SUITE_MOST] = 1.0;
      for (int k = 0; k < SUITE_RANGES; k++)
        planes->numbers[cli_suite_at(planes, k, i) + (size_t)c] = rounded_outwards(r.of[k], k);
    }
  return CONIC_OK;
}

/* The errors that docs/reference/oracle.md allows floats for surface splats. */
static const double surface_color_bound = 1e-4, surface_depth_bound = 1e-5;

static void widen_surface_range(channel_range *r, int channel) {
  for (int k = SUITE_LOW; k < SUITE_RANGES; k++) {
    const double size = fabs(r->of[k]);
    double spread = channel == 4 ? surface_depth_bound * size : surface_color_bound * (size > 1.0 ? size : 1.0);
    r->of[k] += k == SUITE_LOW || k == SUITE_LEAST ? -spread : spread;
  }
}

/* With alternatives, the range reaches from the least to the greatest of all. */
static channel_range range_of_surface(const conic_reference *reference, size_t pixel, int channel,
                                      const conic_alternative *alternatives, size_t n) {
  const double value = channel == 4 ? reference->planes[CONIC_PLANE_Z][pixel]
                                    : reference->planes[CONIC_PLANE_RGBA][4 * pixel + (size_t)channel];
  channel_range r = {{value, value, value, value, value}};
  for (size_t i = 0; i < n; i++) {
    r.of[SUITE_LEAST] = fmin(r.of[SUITE_LEAST], alternatives[i].low[channel]);
    r.of[SUITE_MOST] = fmax(r.of[SUITE_MOST], alternatives[i].high[channel]);
  }
  widen_surface_range(&r, channel);
  return r;
}

conic_status cli_suite_take_reference(conic_context *context, const conic_reference *reference, suite_planes *planes) {
  const size_t n_pixels = (size_t)planes->width * (size_t)planes->height;
  size_t at = 0;
  if (allocate_numbers(context, planes) != CONIC_OK)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < n_pixels; i++) {
    size_t n = 0;
    while (at + n < reference->n_alternatives && reference->alternatives[at + n].pixel == i)
      n++;
    for (int c = 0; c < SUITE_CHANNELS; c++) {
      const channel_range r = range_of_surface(reference, i, c, reference->alternatives + at, n);
      for (int k = 0; k < SUITE_RANGES; k++)
        planes->numbers[cli_suite_at(planes, k, i) + (size_t)c] = rounded_outwards(r.of[k], k);
    }
    at += n;
  }
  return CONIC_OK;
}

/* --- files, always little-endian --- */

static void put_number(FILE *to, uint64_t value, int n_bytes) {
  unsigned char bytes[8];
  conic_store_64(bytes, value);
  fwrite(bytes, 1, (size_t)n_bytes, to);
}

static void put_bits(FILE *to, float value) {
  put_number(to, conic_bits_of_float(value), 4);
}

/* The head of an attribute with a value of so many bytes. */
static void put_attribute_head(FILE *to, const char *name, const char *type, size_t n_bytes) {
  fwrite(name, 1, strlen(name) + 1, to);
  fwrite(type, 1, strlen(type) + 1, to);
  put_number(to, n_bytes, 4);
}

/* Which number is the k-th channel of an EXR: channels are in the order of their names' bytes. */
static void find_exr_channel(int k, int *range, int *channel, char name[16]) {
  static const int ranges[SUITE_RANGES] = {SUITE_VALUE, SUITE_HIGH, SUITE_LEAST, SUITE_LOW, SUITE_MOST};
  static const int channels[SUITE_CHANNELS] = {3, 2, 1, 0, 4};
  *range = ranges[k / SUITE_CHANNELS];
  *channel = channels[k % SUITE_CHANNELS];
  snprintf(name, 16, "%s%s%s", *range == SUITE_VALUE ? "" : cli_suite_range_names[*range],
           *range == SUITE_VALUE ? "" : ".", cli_suite_channel_names[*channel]);
}

enum { EXR_CHANNELS = SUITE_RANGES * SUITE_CHANNELS };

static void put_exr_channels(FILE *to) {
  char name[16];
  int range, channel;
  size_t n = 1;
  for (int k = 0; k < EXR_CHANNELS; k++) {
    find_exr_channel(k, &range, &channel, name);
    n += strlen(name) + 1 + 16;
  }
  put_attribute_head(to, "channels", "chlist", n);
  for (int k = 0; k < EXR_CHANNELS; k++) {
    find_exr_channel(k, &range, &channel, name);
    fwrite(name, 1, strlen(name) + 1, to);
    put_number(to, 2, 4); /* floats */
    put_number(to, 0, 4);
    put_number(to, 1, 4); /* every pixel has a sample, in x and in y */
    put_number(to, 1, 4);
  }
  fputc(0, to);
}

static void put_exr_head(FILE *to, const suite_planes *planes) {
  static const char *const windows[2] = {"dataWindow", "displayWindow"};
  put_number(to, 20000630, 4);
  put_number(to, 2, 4);
  put_exr_channels(to);
  put_attribute_head(to, "compression", "compression", 1);
  fputc(0, to);
  for (int i = 0; i < 2; i++) {
    put_attribute_head(to, windows[i], "box2i", 16);
    put_number(to, 0, 8);
    put_number(to, (uint64_t)planes->width - 1, 4);
    put_number(to, (uint64_t)planes->height - 1, 4);
  }
  put_attribute_head(to, "lineOrder", "lineOrder", 1);
  fputc(0, to);
  put_attribute_head(to, "pixelAspectRatio", "float", 4);
  put_bits(to, 1.0f);
  put_attribute_head(to, "screenWindowCenter", "v2f", 8);
  put_number(to, 0, 8);
  put_attribute_head(to, "screenWindowWidth", "float", 4);
  put_bits(to, 1.0f);
  fputc(0, to);
}

static void put_exr_row(FILE *to, const suite_planes *planes, int y, size_t n_row) {
  char name[16];
  int range, channel;
  put_number(to, (uint64_t)y, 4);
  put_number(to, n_row, 4);
  for (int k = 0; k < EXR_CHANNELS; k++) {
    find_exr_channel(k, &range, &channel, name);
    for (int x = 0; x < planes->width; x++) {
      size_t pixel = (size_t)y * (size_t)planes->width + (size_t)x;
      put_bits(to, planes->numbers[cli_suite_at(planes, range, pixel) + (size_t)channel]);
    }
  }
}

conic_status cli_suite_write_exr(conic_context *context, const char *path, const suite_planes *planes) {
  conic_output *output;
  const size_t n_row = (size_t)planes->width * EXR_CHANNELS * sizeof(float);
  conic_status status = conic_output_open(context, path, &output);
  if (status != CONIC_OK)
    return status;
  FILE *to = conic_output_stream(output);
  put_exr_head(to, planes);
  uint64_t offset = (uint64_t)ftell(to) + 8 * (uint64_t)planes->height;
  for (int y = 0; y < planes->height; y++)
    put_number(to, offset + (uint64_t)y * (n_row + 8), 8);
  for (int y = 0; y < planes->height; y++)
    put_exr_row(to, planes, y, n_row);
  return conic_output_commit(output);
}

conic_status cli_suite_write_npy(conic_context *context, const char *path, const suite_planes *planes) {
  const size_t shape[] = {SUITE_RANGES, (size_t)planes->height, (size_t)planes->width, SUITE_CHANNELS};
  unsigned char head[CONIC_NUMPY_HEAD];
  conic_output *output;
  conic_status status = conic_output_open(context, path, &output);
  if (status != CONIC_OK)
    return status;
  FILE *to = conic_output_stream(output);
  conic_numpy_head("<f4", shape, 4, head);
  fwrite(head, 1, sizeof head, to);
  for (size_t i = 0; i < cli_suite_at(planes, SUITE_RANGES, 0); i++)
    put_bits(to, planes->numbers[i]);
  return conic_output_commit(output);
}

conic_status cli_suite_take_npy(conic_context *context, const char *path, const unsigned char *bytes, size_t n_bytes,
                                suite_planes *planes) {
  conic_numpy_array array;
  conic_status status = conic_numpy_array_open(context, path, "the array", bytes, n_bytes, &array);
  int width = planes->width, height = planes->height;
  if (status == CONIC_OK &&
      !(array.type == 'f' && array.n_axes == 4 && array.shape[0] == SUITE_RANGES && array.shape[1] == (size_t)height &&
        array.shape[2] == (size_t)width && array.shape[3] == SUITE_CHANNELS))
    status = conic_fail(context, CONIC_ERROR_INPUT, "%s: the array is not of %d x %d x %d x %d floats", path,
                        SUITE_RANGES, height, width, SUITE_CHANNELS);
  if (status == CONIC_OK)
    status = allocate_numbers(context, planes);
  for (size_t i = 0; status == CONIC_OK && i < cli_suite_at(planes, SUITE_RANGES, 0); i++)
    planes->numbers[i] = (float)conic_numpy_array_at(&array, i);
  return status;
}
