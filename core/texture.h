/* A texture's inside. */
#ifndef CORE_TEXTURE_H
#define CORE_TEXTURE_H

#include "conic/texture.h"

/* Enough for pictures of 65535 pixels. */
enum { CONIC_TEXTURE_LEVELS = 17 };

/* One picture of the pyramid: linear RGB and a float of no matter, row by row from the top. */
typedef struct conic_texture_level {
  int width, height;
  float *texels;
} conic_texture_level;

struct conic_texture {
  conic_context *context;
  conic_texture_wrap wrap;
  int n_levels; /* each has half the width and height of the one before, rounded up; the last is one texel */
  conic_texture_level levels[CONIC_TEXTURE_LEVELS];
};

#endif
