/* Pictures to be judged: what each of their values stands for. A float stands for itself. A code of 8 or 16 bits, or a
 * half float, stands for all numbers that are rounded to it. docs/reference/judge.md says which files are read, and
 * how. */
#ifndef CONIC_PICTURE_H
#define CONIC_PICTURE_H

#include "conic/image.h"

CONIC_BEGIN_C

/* How codes were made of values. */
typedef enum conic_code_rounding {
  CONIC_CODES_EITHER = 0,  /* one of the next two */
  CONIC_CODES_NEAREST = 1, /* value · 255 + ½, cut off */
  CONIC_CODES_DOWN = 2     /* value · 255, cut off */
} conic_code_rounding;

#define CONIC_N_CODE_ROUNDINGS 3

/* "either", "nearest", "down"; null for a number that is none. */
CONIC_API const char *conic_code_rounding_name(conic_code_rounding rounding);

typedef struct conic_picture_options {
  size_t size;                  /* sizeof(conic_picture_options), set by the init function */
  conic_code_rounding rounding; /* of codes */
  int is_srgb;                  /* codes of colours are sRGB-encoded; else code / 255 is the value */
  int is_clipped;               /* a colour of 0 or 1, in floats too, stands for all values beyond it */
  int is_straight;              /* where there is alpha, the colours are not multiplied by it; always so in a PNG */
} conic_picture_options;

/* Either rounding, not sRGB, not clipped, premultiplied. */
CONIC_API void conic_picture_options_init_sized(conic_picture_options *options, size_t size);
#define conic_picture_options_init(options) conic_picture_options_init_sized(options, sizeof *(options))

typedef struct conic_picture {
  conic_image image;    /* the values, or the least that they stand for */
  conic_image greatest; /* the greatest, in the same planes; empty where the values are exact */
  uint32_t most_code;   /* of its colours: 255, 65535, or 0 for floats */
  int is_alpha_dropped; /* alpha was the greatest code everywhere, so it is not judged */
  uint64_t reserved[4];
} conic_picture;

/* Reads EXR, PFM, NPY, NPZ and PNG. Beside P.pfm and P.npy it looks for the planes in `planes` (bits), in P.Z.pfm,
 * P.N.npy …. On success the caller owns *picture. Errors: INPUT (also a kind of file that is not known to keep its
 * values), UNSUPPORTED, MEMORY. */
CONIC_API conic_status conic_picture_read(conic_context *context, const char *path, unsigned planes,
                                          const conic_picture_options *options, conic_picture *picture);

/* Makes a picture of an image. Its rgba are codes divided by `most_code`; 0: they are floats. *picture takes the image
 * over, also on failure. Errors: ARGUMENT, MEMORY. */
CONIC_API conic_status conic_picture_take(conic_context *context, conic_image *image, unsigned most_code,
                                          const conic_picture_options *options, conic_picture *picture);

CONIC_API void conic_picture_release(conic_context *context, conic_picture *picture);

CONIC_END_C
#endif
