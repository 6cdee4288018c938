/* A texture's members. */
#ifndef CONIC_TEXTURE_LEVELS_H
#define CONIC_TEXTURE_LEVELS_H

#include "conic/texture.h"

/* Enough for pictures of 65535 pixels. */
enum { CONIC_TEXTURE_LEVELS = 17 };

/* A component of a texel. Device code keeps them in its own memory (opencl/triangle_set.cl). */
typedef float conic_texel;

/* One picture of the pyramid, row by row from the top: linear RGB and an unused float; in a cover, premultiplied RGB
 * and alpha. */
typedef struct conic_texture_level {
  int width, height;
  conic_texel *texels;
} conic_texture_level;

static inline const conic_texel *conic_texels_of(const conic_texture_level *level) {
  return level->texels;
}

struct conic_texture {
  conic_context *context;
  conic_texture_wrap wrap;
  int n_levels; /* each has half the width and height of the one before, rounded up; the last is one texel */
  conic_texture_level levels[CONIC_TEXTURE_LEVELS];
  struct conic_texture *cover; /* the same picture with colours times alpha, and alpha; null where alpha is 1
                                  throughout */
};

/* conic_texture_sample with the fourth float beside the colour. */
void conic_texture_sample_channels(const conic_texture *texture, const float uv[2], const float along[2],
                                   const float across[2], float color[4]);

/* Replaces the texture's alpha by the other's. Errors: INPUT (no room), MEMORY. */
conic_status conic_texture_take_alpha(conic_texture *texture, const conic_texture *other);

/* Whether a file's texture has room beside the existing ones. Errors: INPUT. */
conic_status conic_texture_check_room(conic_context *context, const char *name, int width, int height);

/* Makes a texture of the image's rgba plane, which the texture owns from then on; the image is released, on failure,
 * too. Errors: as conic_texture_create. */
conic_status conic_texture_take(conic_context *context, conic_image *image, conic_texture_wrap wrap,
                                conic_texture **texture);

/* conic_image_read for a picture that will become a texture: its size is checked before it is decoded. Errors: as
 * there, and INPUT (no colour; too large). */
conic_status conic_texture_read_image(conic_context *context, const char *path, conic_image *image);

#endif
