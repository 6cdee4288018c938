#include "core/pictures/image_samples.h"

#include "core/base/base.h"
#include "core/base/color.h"

/* conic_srgb_code is one look-up and about one step. Their number is a power of two, so that the step is found exactly.
 */
enum { N_STEPS = sizeof((conic_samples_tables *)0)->first };

typedef struct conversion {
  conic_samples_layout layout;
  size_t width;
  float *rgba;
  void *samples;
  conic_samples_tables tables;
} conversion;

void conic_samples_tables_fill(conic_samples_tables *tables) {
  conic_srgb_thresholds(tables->thresholds);
  conic_srgb_decode_table(tables->decoded);
  for (int i = 0; i < N_STEPS; i++)
    tables->first[i] = conic_srgb_code(tables->thresholds, (float)i * (1.0f / N_STEPS));
}

static uint8_t code_8(const conic_samples_tables *tables, float linear) {
  if (!(linear > 0.0f))
    return 0;
  if (linear >= 1.0f)
    return 255;
  uint8_t code = tables->first[(int)(linear * N_STEPS)];
  while (code < 255 && linear >= tables->thresholds[code])
    code++;
  return code;
}

/* round(scale · value), clamped to the scale; NaN gives 0. */
static unsigned quantize(double value, double scale) {
  if (!(value > 0.0))
    return 0;
  return value >= 1.0 ? (unsigned)scale : (unsigned)(value * scale + 0.5);
}

/* The colour as the layout needs it, still linear. */
static void arrange_pixel(const float rgba[4], int is_straight, float color[4]) {
  float alpha = rgba[3];
  memcpy(color, rgba, 4 * sizeof *color);
  if (!is_straight || alpha == 1.0f)
    return;
  for (int c = 0; c < 3; c++)
    color[c] = alpha > 0.0f ? rgba[c] / alpha : 0.0f;
}

void conic_samples_row_from_rgba(const conic_samples_tables *tables, conic_samples_layout layout, const float *rgba,
                                 size_t width, void *samples) {
  size_t n = (size_t)layout.n_channels;
  int has_curve = layout.tone != CONIC_TONE_SRGB && layout.sample_bytes < 4 && !layout.is_display;
  for (size_t x = 0; x < width; x++) {
    float color[4];
    arrange_pixel(rgba + 4 * x, layout.is_straight, color);
    if (has_curve)
      conic_tone_map(layout.tone, color, color);
    for (size_t c = 0; c < n; c++) {
      size_t i = x * n + c;
      if (layout.sample_bytes == 4)
        ((float *)samples)[i] = color[c];
      else if (layout.is_display && layout.sample_bytes == 2)
        ((uint16_t *)samples)[i] = (uint16_t)quantize((double)color[c], 65535.0);
      else if (layout.is_display)
        ((uint8_t *)samples)[i] = (uint8_t)quantize((double)color[c], 255.0);
      else if (layout.sample_bytes == 2)
        ((uint16_t *)samples)[i] =
            (uint16_t)quantize(c < 3 ? conic_srgb_encode((double)color[c]) : (double)color[c], 65535.0);
      else
        ((uint8_t *)samples)[i] = c < 3 ? code_8(tables, color[c]) : (uint8_t)quantize((double)color[c], 255.0);
    }
  }
}

static void encode_row(void *data, size_t y) {
  const conversion *work = data;
  size_t row_bytes = work->width * (size_t)work->layout.n_channels * (size_t)work->layout.sample_bytes;
  conic_samples_row_from_rgba(&work->tables, work->layout, work->rgba + y * work->width * 4, work->width,
                              (unsigned char *)work->samples + y * row_bytes);
}

static float decode_sample(const conversion *work, size_t i, int is_color) {
  if (work->layout.sample_bytes == 4)
    return ((const float *)work->samples)[i];
  if (work->layout.sample_bytes == 2) {
    double value = ((const uint16_t *)work->samples)[i] / 65535.0;
    return (float)(is_color && !work->layout.is_display ? conic_srgb_decode(value) : value);
  }
  uint8_t code = ((const uint8_t *)work->samples)[i];
  return is_color && !work->layout.is_display ? work->tables.decoded[code] : (float)(code / 255.0);
}

static void decode_row(void *data, size_t y) {
  const conversion *work = data;
  size_t n = (size_t)work->layout.n_channels;
  int is_grey = n < 3, has_alpha = conic_samples_have_alpha(work->layout);
  for (size_t x = 0; x < work->width; x++) {
    float *pixel = work->rgba + (y * work->width + x) * 4;
    size_t first = (y * work->width + x) * n;
    for (size_t c = 0; c < 3; c++)
      pixel[c] = decode_sample(work, first + (is_grey ? 0 : c), 1);
    pixel[3] = has_alpha ? decode_sample(work, first + (is_grey ? 1 : 3), 0) : 1.0f;
    if (has_alpha && work->layout.is_straight)
      for (int c = 0; c < 3; c++)
        pixel[c] *= pixel[3];
  }
}

void conic_samples_from_rgba(conic_context *context, const float *rgba, int width, int height,
                             conic_samples_layout layout, void *samples) {
  conversion work = {.layout = layout, .width = (size_t)width, .rgba = (float *)rgba, .samples = samples};
  conic_samples_tables_fill(&work.tables);
  conic_parallel_for(context, (size_t)height, encode_row, &work);
}

void conic_samples_to_rgba(conic_context *context, const void *samples, int width, int height,
                           conic_samples_layout layout, float *rgba) {
  conversion work = {.layout = layout, .width = (size_t)width, .samples = (void *)samples};
  work.rgba = rgba;
  conic_samples_tables_fill(&work.tables);
  conic_parallel_for(context, (size_t)height, decode_row, &work);
}
