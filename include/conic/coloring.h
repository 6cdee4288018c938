/* Colours made from what points hold: a value of the file (intensity, classification, …), the height, or the normal
 * (docs/reference/formats.md, Colours). */
#ifndef CONIC_COLORING_H
#define CONIC_COLORING_H

#include "conic/triangles.h"

CONIC_BEGIN_C

typedef struct conic_coloring_options {
  size_t size; /* sizeof(conic_coloring_options), set by the init function */

  /* "rgb": the file's colours. "height", along `up`. "normal": its x, y, z as red, green, blue. "auto": the file's
   * colours; without colours, the intensity; without an intensity, or with the same one everywhere, the height. Any
   * other word: the file's value of that name. */
  const char *by;
  const char *ramp; /* one of conic_ramp_name; null: the one that suits the values */

  /* What the ramp's two ends mean; if has_range is 0, the 2nd and the 98th percentile. */
  int has_range;
  double minimum, maximum;

  double up[3]; /* of any length; zero: the source's, or +y */
} conic_coloring_options;

/* "rgb", nothing else set. */
CONIC_API void conic_coloring_options_init_sized(conic_coloring_options *options, size_t size);
#define conic_coloring_options_init(options) conic_coloring_options_init_sized(options, sizeof *(options))

/* The names of the ramps from 0 on: "sequential", "grey", …, "classes"; null after the last. */
CONIC_API const char *conic_ramp_name(int i);

/* What the colours mean. */
typedef struct conic_coloring {
  char field[40];          /* "height", "normal", or the value's name; empty: the colours are the file's */
  const char *ramp;        /* null for normals */
  double minimum, maximum; /* of the ramp's ends */
  int is_root;             /* the ramp follows the square root of the value above the minimum: for intensities */
  uint32_t classes[8];     /* for "classes": which classes below 256 there are, as bits */
  uint64_t reserved[8];
} conic_coloring;

/* The linear colour of a value; grey for a value that is not finite. */
CONIC_API void conic_coloring_color(const conic_coloring *coloring, double value, float linear[3]);

/* Sets `field` and `field_is_optional` so that reading keeps what the colours are made of. Null options ask for
 * nothing. */
CONIC_API void conic_coloring_read(const conic_coloring_options *options, conic_read_options *reading);

/* Gives the vertices of a drawing their colours, in place, by one scale for all of it. Releases the scalars that the
 * colours are made of. Triangles lose their textures and their materials' colours, unless the colours stay as they are.
 * Colours from normals need tangent axes. Either set may be null or empty. Errors: ARGUMENT, MEMORY, INPUT (no scalar
 * was read). */
CONIC_API conic_status conic_drawing_color(conic_context *context, const conic_coloring_options *options,
                                           conic_splats *splats, conic_triangles *triangles, conic_coloring *coloring);

CONIC_END_C
#endif
