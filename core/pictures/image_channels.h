/* The channels of files that name their planes, as EXRs do. */
#pragma once

#include "conic/image.h"

/* The image's channel for a file's; plane < 0: none. */
typedef struct conic_channel {
  int plane, channel;
} conic_channel;

conic_channel conic_channel_find(const char *name);

/* The same in a picture of luminance alone, where Y stands for R, G and B. */
conic_channel conic_channel_find_in(const char *name, int is_luminance);

/* Completes an image: alpha 1, and grey in a picture of luminance alone. */
void conic_channels_complete(conic_image *image, int has_alpha, int is_luminance);
