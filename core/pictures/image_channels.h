/* The channels of files whose planes go by name, as an EXR's do. */
#ifndef CONIC_IMAGE_CHANNELS_H
#define CONIC_IMAGE_CHANNELS_H

#include "conic/image.h"

/* Which of an image's channels a file's is; plane < 0: none. */
typedef struct conic_channel {
  int plane, channel;
} conic_channel;

conic_channel conic_channel_find(const char *name);

/* The same of a picture of luminance alone, where Y stands for R, G and B. */
conic_channel conic_channel_find_in(const char *name, int is_luminance);

/* What the file says nothing of: alpha 1, and grey for a picture of luminance alone. */
void conic_channels_complete(conic_image *image, int has_alpha, int is_luminance);

#endif
