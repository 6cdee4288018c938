/* Textures: pictures that lie on triangles, with the smaller pictures (mip levels) that filtering reads. */
#ifndef CONIC_TEXTURE_H
#define CONIC_TEXTURE_H

#include "conic/context.h"
#include "conic/image.h"

CONIC_BEGIN_C

/* What is seen beyond the picture's borders. */
typedef enum conic_texture_wrap {
  CONIC_WRAP_REPEAT = 0, /* the picture again */
  CONIC_WRAP_CLAMP = 1   /* its outermost texels */
} conic_texture_wrap;

/* Immutable, and may be read by any number of threads. Coordinates are OBJ's: (0, 0) is the lower left corner of the
 * picture, (1, 1) the upper right one. */
typedef struct conic_texture conic_texture;

/* Makes a texture of the image's rgba, taken as linear; alpha is divided out, and texels without alpha are black. The
 * image is copied. On success the caller owns *texture, which must not outlive the context; on failure it is null.
 * Errors: ARGUMENT (no rgba), MEMORY. */
CONIC_API conic_status conic_texture_create(conic_context *context, const conic_image *image, conic_texture_wrap wrap,
                                            conic_texture **texture);

/* Reads one from a file that conic_image_read understands; integer samples are decoded from sRGB. Errors: as there. */
CONIC_API conic_status conic_texture_read(conic_context *context, const char *path, conic_texture_wrap wrap,
                                          conic_texture **texture);

/* Null is allowed. */
CONIC_API void conic_texture_destroy(conic_texture *texture);

CONIC_API int conic_texture_width(const conic_texture *texture);
CONIC_API int conic_texture_height(const conic_texture *texture);

/* The linear colour at (u, v), filtered over a parallelogram with the sides `along` and `across`: the changes of (u, v)
 * over the two sides of the area to be covered, a pixel's or a sample's. Zero sides give the bilinear colour. Numbers
 * that are not finite count as 0. */
CONIC_API void conic_texture_sample(const conic_texture *texture, const float uv[2], const float along[2],
                                    const float across[2], float color[3]);

/* Whether a texel's alpha is below 1. */
CONIC_API int conic_texture_has_alpha(const conic_texture *texture);

/* conic_texture_sample with alpha. Each texel's colour weighs in proportion to its alpha; rgba is not premultiplied,
 * and black where alpha is 0. A texture without alpha gives conic_texture_sample's colour and 1. */
CONIC_API void conic_texture_sample_rgba(const conic_texture *texture, const float uv[2], const float along[2],
                                         const float across[2], float rgba[4]);

CONIC_END_C
#endif
