#include "core/raw_colors.h"

#include "core/color.h"
#include "core/memory.h"

static float largest_of(const conic_splats *points) {
  float largest = 0.0f;
  for (int channel = 0; channel < 3; channel++)
    for (size_t i = 0; i < points->count; i++)
      largest = points->color[channel][i] > largest ? points->color[channel][i] : largest;
  return largest;
}

static void drop(conic_context *context, conic_splats *points) {
  for (int channel = 0; channel < 3; channel++) {
    conic_memory_release(context, points->color[channel]);
    points->color[channel] = NULL;
  }
}

/* Whole codes, which is nearly all, are looked up. */
static void decode(float *values, size_t n, const float *table, int scale) {
  for (size_t i = 0; i < n; i++) {
    float value = values[i];
    int is_code = value >= 0.0f && value <= (float)scale && value == (float)(int)value;
    values[i] = is_code ? table[(int)value] : (float)conic_srgb_decode((double)value / (double)scale);
  }
}

conic_status conic_raw_colors_decode(conic_context *context, conic_splats *points, int may_be_fractions) {
  if (!points->color[0])
    return CONIC_OK;
  float largest = largest_of(points);
  if (!(largest > 0.0f)) {
    drop(context, points);
    return CONIC_OK;
  }
  int scale = may_be_fractions && largest <= 1.0f ? 1 : largest <= 255.0f ? 255 : 65535;
  float *table = conic_memory_allocate(context, (size_t)scale + 1, sizeof *table);
  if (!table)
    return CONIC_ERROR_MEMORY;
  for (int code = 0; code <= scale; code++)
    table[code] = (float)conic_srgb_decode((double)code / (double)scale);
  for (int channel = 0; channel < 3; channel++)
    decode(points->color[channel], points->count, table, scale);
  conic_memory_release(context, table);
  return CONIC_OK;
}
