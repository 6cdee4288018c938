/* Colours whose scale is known only when all have been read: they are collected as they stand in the file, and then
 * decoded. */
#pragma once

#include "conic/model.h"

/* What tells the scale: the largest value, whether any is no multiple of 256, and whether any is no byte twice. Zeroed:
 * none was seen. */
typedef struct conic_raw_range {
  float largest;
  int has_low_bits, has_two_bytes;
} conic_raw_range;

void conic_raw_colors_see(const conic_splats *points, conic_raw_range *range);
/* Adds what others have been seen to be. */
void conic_raw_colors_unite(conic_raw_range *range, const conic_raw_range *other);

/* What is known of values beforehand, as bits. */
typedef enum conic_raw_kind {
  CONIC_RAW_FRACTIONS = 1, /* they may be fractions of 1 */
  CONIC_RAW_LINEAR = 2     /* fractions are linear */
} conic_raw_kind;

/* Of numbers with that conic_color_meaning, or of those that may be anything. */
static inline unsigned conic_raw_kind_of(int meaning) {
  return meaning == CONIC_COLORS_CODES    ? 0u
         : meaning == CONIC_COLORS_LINEAR ? (unsigned)CONIC_RAW_FRACTIONS | (unsigned)CONIC_RAW_LINEAR
                                          : (unsigned)CONIC_RAW_FRACTIONS;
}

/* How to decode values of that range: what they are fractions of, and the linear value of every whole one up to it,
 * which is null where the colours mean nothing. The caller releases `table`. Errors: MEMORY. */
typedef struct conic_raw_scale {
  int whole, is_linear;
  float *table;
} conic_raw_scale;

conic_status conic_raw_colors_scale(conic_context *context, const conic_raw_range *range, unsigned kind,
                                    conic_raw_scale *scale);

/* Decodes n values in place. */
void conic_raw_colors_apply(const conic_raw_scale *scale, float *values, size_t n);

/* Decodes sRGB values in place, and says what they are (conic_color_meaning). The largest of them tells: below 2
 * fractions, up to 255 codes of 8 bits, up to 4095 codes of 12, beyond that codes of 16. Codes of 8 bits that stand in
 * both bytes count as 16. Where all are multiples of 256, they are codes of 8 bits in the upper half, and 255 × 256 is
 * white. Where the largest is 0, nobody has filled them in: they are dropped, and the points are white. Errors: MEMORY.
 */
conic_status conic_raw_colors_decode(conic_context *context, conic_splats *points, unsigned kind, uint32_t *colors_are);
