#include "core/pictures/image_channels.h"

#include "core/image/image_common.h"

conic_channel conic_channel_find(const char *name) {
  for (int i = 0; i < CONIC_N_PLANES; i++) {
    const conic_plane_description *plane = conic_plane_describe((conic_plane)i);
    for (int c = 0; c < plane->n_channels; c++)
      if (strcmp(plane->channels[c], name) == 0)
        return (conic_channel){i, c};
  }
  return (conic_channel){-1, -1};
}

conic_channel conic_channel_find_in(const char *name, int is_luminance) {
  return conic_channel_find(is_luminance && strcmp(name, "Y") == 0 ? "R" : name);
}

void conic_channels_complete(conic_image *image, int has_alpha, int is_luminance) {
  float *rgba = image->planes[CONIC_PLANE_RGBA];
  size_t n = rgba ? conic_image_pixels(image) : 0;
  image->lacks_alpha = rgba && !has_alpha;
  for (size_t i = 0; i < n; i++) {
    if (!has_alpha)
      rgba[4 * i + 3] = 1.0f;
    if (is_luminance)
      rgba[4 * i + 1] = rgba[4 * i + 2] = rgba[4 * i];
  }
}
