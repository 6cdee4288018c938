#include "core/image/texture_levels.h"

#include "core/base/memory.h"
#include "core/base/message.h"

/* What an old row or column of `n` texels gives to texel i of a new one of `m`: the overlaps of the old texels with the
 * new one's place, which add up to 1. Returns how many there are, 2 or 3; *first is the first. */
static int shares_of(int i, int n, int m, int *first, double shares[3]) {
  double scale = (double)n / (double)m, begin = (double)i * scale, end = (double)(i + 1) * scale;
  int count = 0;
  *first = (int)begin;
  for (int k = *first; k < n && (double)k < end && count < 3; k++) {
    double low = begin > (double)k ? begin : (double)k, high = end < (double)(k + 1) ? end : (double)(k + 1);
    shares[count++] = (high - low) / scale;
  }
  return count;
}

static void reduce_level(const conic_texture_level *from, conic_texture_level *to) {
  for (int y = 0; y < to->height; y++) {
    double row_shares[3], column_shares[3];
    int first_row, first_column, n_rows = shares_of(y, from->height, to->height, &first_row, row_shares);
    for (int x = 0; x < to->width; x++) {
      int n_columns = shares_of(x, from->width, to->width, &first_column, column_shares);
      double sum[3] = {0.0, 0.0, 0.0};
      for (int row = 0; row < n_rows; row++)
        for (int column = 0; column < n_columns; column++) {
          const float *texel =
              from->texels + 4 * ((size_t)(first_row + row) * (size_t)from->width + (size_t)(first_column + column));
          for (int channel = 0; channel < 3; channel++)
            sum[channel] += row_shares[row] * column_shares[column] * (double)texel[channel];
        }
      float *texel = to->texels + 4 * ((size_t)y * (size_t)to->width + (size_t)x);
      for (int channel = 0; channel < 3; channel++)
        texel[channel] = (float)sum[channel];
      texel[3] = 0.0f;
    }
  }
}

static conic_status add_level(conic_texture *texture, int width, int height) {
  conic_texture_level *level = &texture->levels[texture->n_levels];
  level->width = width;
  level->height = height;
  level->texels = conic_memory_allocate(texture->context, (size_t)width * (size_t)height, 4 * sizeof(float));
  if (!level->texels)
    return CONIC_ERROR_MEMORY;
  texture->n_levels++;
  return CONIC_OK;
}

/* Colour without its alpha; what is no usable number is black. */
static void fill_first(const conic_image *image, const conic_texture_level *level) {
  const float *rgba = image->planes[CONIC_PLANE_RGBA];
  for (size_t i = 0; i < (size_t)level->width * (size_t)level->height; i++) {
    float alpha = rgba[4 * i + 3];
    for (int channel = 0; channel < 3; channel++) {
      float value = alpha > 0.0f ? rgba[4 * i + (size_t)channel] / alpha : 0.0f;
      level->texels[4 * i + (size_t)channel] = value >= -1e6f && value <= 1e6f ? value : 0.0f;
    }
    level->texels[4 * i + 3] = 0.0f;
  }
}

conic_status conic_texture_create(conic_context *context, const conic_image *image, conic_texture_wrap wrap,
                                  conic_texture **texture) {
  *texture = NULL;
  if (!image->planes[CONIC_PLANE_RGBA] || (wrap != CONIC_WRAP_REPEAT && wrap != CONIC_WRAP_CLAMP))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "a texture needs an image with colour, and a known wrap");
  conic_texture *made = conic_memory_allocate_zeroed(context, 1, sizeof *made);
  if (!made)
    return CONIC_ERROR_MEMORY;
  made->context = context;
  made->wrap = wrap;
  int width = image->width, height = image->height;
  conic_status status = add_level(made, width, height);
  if (status == CONIC_OK)
    fill_first(image, &made->levels[0]);
  while (status == CONIC_OK && (width > 1 || height > 1)) {
    width = (width + 1) / 2;
    height = (height + 1) / 2;
    status = add_level(made, width, height);
    if (status == CONIC_OK)
      reduce_level(&made->levels[made->n_levels - 2], &made->levels[made->n_levels - 1]);
  }
  if (status == CONIC_OK)
    *texture = made;
  else
    conic_texture_destroy(made);
  return status;
}

conic_status conic_texture_read(conic_context *context, const char *path, conic_texture_wrap wrap,
                                conic_texture **texture) {
  conic_image image;
  *texture = NULL;
  conic_status status = conic_image_read(context, path, &image);
  if (status != CONIC_OK)
    return status;
  if (image.planes[CONIC_PLANE_RGBA])
    status = conic_texture_create(context, &image, wrap, texture);
  else
    status = conic_fail(context, CONIC_ERROR_INPUT, "%s: the image has no colour", path);
  conic_image_release(context, &image);
  return status;
}

void conic_texture_destroy(conic_texture *texture) {
  if (!texture)
    return;
  for (int i = 0; i < CONIC_TEXTURE_LEVELS; i++)
    conic_memory_release(texture->context, texture->levels[i].texels);
  conic_memory_release(texture->context, texture);
}

int conic_texture_width(const conic_texture *texture) {
  return texture->levels[0].width;
}

int conic_texture_height(const conic_texture *texture) {
  return texture->levels[0].height;
}
