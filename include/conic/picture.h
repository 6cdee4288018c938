/* Pictures that are to be judged: what each of their values stands for. A float stands for itself; a code of 8 or 16
 * bits, or a half float, for all that is rounded to it. docs/reference/judge.md says which files are read, and how. */
#ifndef CONIC_PICTURE_H
#define CONIC_PICTURE_H

#include "conic/image.h"

#ifdef __cplusplus
extern "C" {
#endif

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
  int is_clipped;               /* of floats, too, a colour of 0 or 1 stands for all that is beyond it */
  int is_straight;              /* where there is alpha, the colours are not multiplied by it: always so in a PNG */
} conic_picture_options;

/* Either rounding, not sRGB, not clipped, premultiplied. */
CONIC_API void conic_picture_options_init_sized(conic_picture_options *options, size_t size);
#define conic_picture_options_init(options) conic_picture_options_init_sized(options, sizeof *(options))

typedef struct conic_picture {
  conic_image image;    /* the values, or the least that they stand for */
  conic_image greatest; /* the greatest, in the same planes; empty where the values are exact */
  uint32_t most_code;   /* of its colours: 255, 65535, or 0 for floats */
  int is_alpha_dropped; /* alpha was the greatest code everywhere: nothing is said of it */
  uint64_t reserved[4];
} conic_picture;

/* Reads EXR, PFM, NPY, NPZ and PNG; beside P.pfm and P.npy the planes in P.Z.pfm, P.N.npy … of those in `planes`
 * (bits). On success the caller owns *picture. Errors: INPUT (also a kind of file whose values are not known to be
 * kept), UNSUPPORTED, MEMORY. */
CONIC_API conic_status conic_picture_read(conic_context *context, const char *path, unsigned planes,
                                          const conic_picture_options *options, conic_picture *picture);

/* What the rgba of an image stand for that are codes, divided by `most_code`; 0: floats. *picture takes the image over,
 * also on failure. Errors: ARGUMENT, MEMORY. */
CONIC_API conic_status conic_picture_take(conic_context *context, conic_image *image, unsigned most_code,
                                          const conic_picture_options *options, conic_picture *picture);

CONIC_API void conic_picture_release(conic_context *context, conic_picture *picture);

#ifdef __cplusplus
}
#endif
#endif
