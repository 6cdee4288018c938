#include "core/splats/raw_colors.h"

#include "core/base/color.h"
#include "core/base/memory.h"

static int is_upper_half(float value) {
  return value >= 0.0f && value <= 65280.0f && value == (float)((int)value & 0xff00);
}

static int is_one_byte(float value) {
  return value >= 0.0f && value <= 65535.0f && value == (float)(((int)value >> 8) * 257);
}

void conic_raw_colors_see(const conic_splats *points, conic_raw_range *range) {
  for (int channel = 0; channel < 3 && points->color[0]; channel++)
    for (size_t i = 0; i < points->count; i++) {
      float value = points->color[channel][i];
      if (!(value - value == 0.0f))
        continue;
      range->largest = value > range->largest ? value : range->largest;
      range->has_low_bits |= !is_upper_half(value);
      range->has_two_bytes |= !is_one_byte(value);
    }
}

void conic_raw_colors_unite(conic_raw_range *range, const conic_raw_range *other) {
  range->largest = other->largest > range->largest ? other->largest : range->largest;
  range->has_low_bits |= other->has_low_bits;
  range->has_two_bytes |= other->has_two_bytes;
}

static void drop_colors(conic_context *context, conic_splats *points) {
  for (int channel = 0; channel < 3; channel++) {
    conic_memory_release(context, points->color[channel]);
    points->color[channel] = NULL;
  }
}

/* What white is. A picture of 16 bits whose brightest value is a sixteenth of white would be black to the eye: such
 * values are a camera's 12 bits. */
static int find_whole(const conic_raw_range *range, int may_be_fractions) {
  float largest = range->largest;
  if (largest <= 255.0f)
    return may_be_fractions && largest < 2.0f ? 1 : 255; /* a little above 1 they are fractions still */
  return !range->has_low_bits ? 65280 : largest <= 4095.0f && range->has_two_bytes ? 4095 : 65535;
}

static double decode(const conic_raw_scale *scale, double value) {
  return scale->is_linear ? value : conic_srgb_decode(value / (double)scale->whole);
}

conic_status conic_raw_colors_scale(conic_context *context, const conic_raw_range *range, unsigned kind,
                                    conic_raw_scale *scale) {
  *scale = (conic_raw_scale){0, 0, NULL};
  if (!(range->largest > 0.0f))
    return CONIC_OK;
  int whole = find_whole(range, (kind & CONIC_RAW_FRACTIONS) != 0);
  float *table = conic_memory_allocate(context, (size_t)whole + 1, sizeof *table);
  if (!table)
    return CONIC_ERROR_MEMORY;
  *scale = (conic_raw_scale){whole, whole == 1 && kind & CONIC_RAW_LINEAR, table};
  for (int code = 0; code <= whole; code++)
    table[code] = (float)decode(scale, (double)code);
  return CONIC_OK;
}

/* Whole codes, which is nearly all, are looked up. */
void conic_raw_colors_apply(const conic_raw_scale *scale, float *values, size_t n) {
  for (size_t i = 0; i < n; i++) {
    float value = values[i];
    int is_code = value >= 0.0f && value <= (float)scale->whole && value == (float)(int)value;
    values[i] = is_code ? scale->table[(int)value] : (float)decode(scale, (double)value);
  }
}

conic_status conic_raw_colors_decode(conic_context *context, conic_splats *points, unsigned kind,
                                     uint32_t *colors_are) {
  conic_raw_scale scale;
  conic_raw_range range = {0.0f, 0, 0};
  *colors_are = CONIC_COLORS_NONE;
  if (!points->color[0])
    return CONIC_OK;
  conic_raw_colors_see(points, &range);
  conic_status status = conic_raw_colors_scale(context, &range, kind, &scale);
  if (status != CONIC_OK)
    return status;
  if (!scale.table)
    drop_colors(context, points);
  else
    *colors_are = scale.whole > 1 ? CONIC_COLORS_CODES : scale.is_linear ? CONIC_COLORS_LINEAR : CONIC_COLORS_DISPLAY;
  for (int channel = 0; channel < 3 && scale.table; channel++)
    conic_raw_colors_apply(&scale, points->color[channel], points->count);
  conic_memory_release(context, scale.table);
  return CONIC_OK;
}
