/* The XYZ and PTS reader: text, a point a line, values parted by blanks or commas.
 *
 * Empty lines and lines that begin with # or // are comments. The first line may hold nothing but the number of points
 * (PTS); there must then be as many. All points have as many values as the first:
 *
 *   3   x y z
 *   4   x y z intensity
 *   6   x y z and a colour, or x y z and a normal
 *   7   x y z intensity and a colour
 *   9   x y z, a colour and a normal, or a normal and a colour
 *
 * Three values are a normal if, in the first 256 points, one of them is negative or all of them have length 1 (to 5 %;
 * those of length 0 do not count, but not all may be 0); else they are a colour. Of 9 values the last three are the
 * normal unless only the first three are one. A colour is sRGB-encoded; the largest value of the whole file tells
 * whether it is a fraction of 1, a code of 8 bits or one of 16 (core/formats/raw_colors.h). Intensity is passed over.
 * Positions are kept in double, from the first finite one as the origin. */
#ifndef CONIC_XYZ_H
#define CONIC_XYZ_H

#include "conic/model.h"
#include "core/files/input.h"
#include "core/splats/builder.h"

/* Whether text begins like such a file: with numbers only, after comments. */
int conic_xyz_is_likely(const char *bytes, size_t n);

/* Reads a model from the start of the file; with a delivery the points go there. On failure *model is for the caller to
 * release. Errors: INPUT, MEMORY, CANCELLED, the receiver's. */
conic_status conic_xyz_read(conic_input *input, const conic_delivery *delivery, conic_model *model);

#endif
