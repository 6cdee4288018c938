/* Colours whose scale is known only when all have been read: they are collected as they stand in the file, and then
 * decoded. */
#ifndef CORE_RAW_COLORS_H
#define CORE_RAW_COLORS_H

#include "conic/splats.h"

/* Decodes sRGB values in place, by the largest of them: up to 1 are fractions (where `may_be_fractions`), up to 255
 * codes of 8 bits, beyond that codes of 16. Where the largest is 0 nobody has filled them in, and they are dropped: the
 * points are white. Errors: MEMORY. */
conic_status conic_raw_colors_decode(conic_context *context, conic_splats *points, int may_be_fractions);

#endif
