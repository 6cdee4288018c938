#include "core/image/texture_levels.h"

#include "core/base/context_struct.h"
#include "core/image/image_common.h"

/* The shares of an old row or column of `n` texels in texel i of a new one of `m`: how much each old texel overlaps the
 * new one. They add up to 1. Returns how many there are, 2 or 3; *first is the first old texel. */
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
      double sum[4] = {0.0, 0.0, 0.0, 0.0};
      for (int row = 0; row < n_rows; row++)
        for (int column = 0; column < n_columns; column++) {
          const float *texel =
              from->texels + 4 * ((size_t)(first_row + row) * (size_t)from->width + (size_t)(first_column + column));
          for (int channel = 0; channel < 4; channel++)
            sum[channel] += row_shares[row] * column_shares[column] * (double)texel[channel];
        }
      float *texel = to->texels + 4 * ((size_t)y * (size_t)to->width + (size_t)x);
      for (int channel = 0; channel < 4; channel++)
        texel[channel] = (float)sum[channel];
    }
  }
}

static size_t level_bytes(int width, int height) {
  return (size_t)width * (size_t)height * 4 * sizeof(conic_texel);
}

/* Bytes of all levels. */
static size_t pyramid_bytes(int width, int height) {
  size_t n = level_bytes(width, height);
  while (width > 1 || height > 1) {
    width = (width + 1) / 2;
    height = (height + 1) / 2;
    n += level_bytes(width, height);
  }
  return n;
}

conic_status conic_texture_check_room(conic_context *context, const char *name, int width, int height) {
  size_t most = context->options.max_texture_bytes, n = pyramid_bytes(width, height), there = context->texture_bytes;
  if (most == 0 || (there <= most && n <= most - there))
    return CONIC_OK;
  return conic_fail(
      context, CONIC_ERROR_INPUT,
      "%s: a texture of %d × %d pixels takes %zu MiB; there are %zu left of the %zu MiB that textures may "
      "take (--max-texture)",
      name, width, height, (n + 0xfffff) >> 20, there <= most ? (most - there) >> 20 : 0, most >> 20);
}

static conic_status add_level(conic_texture *texture, int width, int height, float *texels) {
  conic_texture_level *level = &texture->levels[texture->n_levels];
  level->width = width;
  level->height = height;
  level->texels =
      texels ? texels
             : conic_memory_allocate(texture->context, (size_t)width * (size_t)height, 4 * sizeof(conic_texel));
  if (!level->texels)
    return CONIC_ERROR_MEMORY;
  texture->n_levels++;
  texture->context->texture_bytes += level_bytes(width, height);
  return CONIC_OK;
}

static float alpha_of_texel(const float *texel) {
  return texel[3] > 0.0f ? texel[3] < 1.0f ? texel[3] : 1.0f : 0.0f;
}

/* Divides colours by alpha; numbers that cannot be used become black. */
static void make_texels(const conic_texture_level *level) {
  for (size_t i = 0; i < (size_t)level->width * (size_t)level->height; i++) {
    float *texel = level->texels + 4 * i, alpha = texel[3];
    for (int channel = 0; channel < 3; channel++) {
      float value = alpha > 0.0f ? texel[channel] / alpha : 0.0f;
      texel[channel] = value >= -1e6f && value <= 1e6f ? value : 0.0f;
    }
    texel[3] = alpha_of_texel(texel);
  }
}

/* Makes all levels from the first level's `texels`, which the texture owns afterwards, on failure, too. */
static conic_status make_levels(conic_context *context, float *texels, int width, int height, conic_texture_wrap wrap,
                                conic_texture **texture) {
  conic_texture *made = conic_memory_allocate_zeroed(context, 1, sizeof *made);
  *texture = NULL;
  if (!made) {
    conic_memory_release(context, texels);
    return CONIC_ERROR_MEMORY;
  }
  made->context = context;
  made->wrap = wrap;
  conic_status status = add_level(made, width, height, texels);
  while (status == CONIC_OK && (width > 1 || height > 1)) {
    width = (width + 1) / 2;
    height = (height + 1) / 2;
    status = add_level(made, width, height, NULL);
    if (status == CONIC_OK)
      reduce_level(&made->levels[made->n_levels - 2], &made->levels[made->n_levels - 1]);
  }
  if (status == CONIC_OK)
    *texture = made;
  else
    conic_texture_destroy(made);
  return status;
}

/* Makes the cover from the texels' colours and alphas; null where all are opaque. */
static conic_status make_cover(conic_context *context, const float *texels, int width, int height,
                               conic_texture_wrap wrap, conic_texture **cover) {
  size_t n = (size_t)width * (size_t)height, i = 0;
  *cover = NULL;
  while (i < n && texels[4 * i + 3] == 1.0f)
    i++;
  if (i == n)
    return CONIC_OK;
  conic_status status = conic_texture_check_room(context, "alpha", width, height);
  float *covering = status == CONIC_OK ? conic_memory_allocate(context, n, 4 * sizeof *covering) : NULL;
  if (!covering)
    return status == CONIC_OK ? CONIC_ERROR_MEMORY : status;
  for (i = 0; i < n; i++) {
    for (size_t channel = 0; channel < 3; channel++)
      covering[4 * i + channel] = texels[4 * i + channel] * texels[4 * i + 3];
    covering[4 * i + 3] = texels[4 * i + 3];
  }
  return make_levels(context, covering, width, height, wrap, cover);
}

/* Makes `texels`, the image's colours, the first level; the texture owns them, on failure, too. */
static conic_status make_texture(conic_context *context, float *texels, int width, int height, conic_texture_wrap wrap,
                                 conic_texture **texture) {
  const conic_texture_level first = {width, height, texels};
  conic_texture *cover;
  make_texels(&first);
  conic_status status = make_cover(context, texels, width, height, wrap, &cover);
  if (status != CONIC_OK) {
    conic_memory_release(context, texels);
    return status;
  }
  for (size_t i = 0; i < (size_t)width * (size_t)height; i++)
    texels[4 * i + 3] = 0.0f;
  status = make_levels(context, texels, width, height, wrap, texture);
  if (status == CONIC_OK)
    (*texture)->cover = cover;
  else
    conic_texture_destroy(cover);
  return status;
}

static int is_as_large(const conic_texture *a, const conic_texture *b) {
  return a->levels[0].width == b->levels[0].width && a->levels[0].height == b->levels[0].height;
}

/* Takes alpha texel by texel, or, where the sizes differ, samples the other picture over each texel. */
conic_status conic_texture_take_alpha(conic_texture *texture, const conic_texture *other) {
  const conic_texture_level *level = &texture->levels[0];
  const float along[2] = {1.0f / (float)level->width, 0.0f}, across[2] = {0.0f, 1.0f / (float)level->height};
  size_t n = (size_t)level->width * (size_t)level->height;
  conic_texture *cover;
  float *texels = conic_memory_allocate(texture->context, n, 4 * sizeof *texels);
  if (!texels)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < n; i++) {
    const size_t x = i % (size_t)level->width, y = i / (size_t)level->width;
    const float uv[2] = {((float)x + 0.5f) * along[0], 1.0f - ((float)y + 0.5f) * across[1]};
    float rgba[4] = {0.0f, 0.0f, 0.0f, 1.0f};
    if (!is_as_large(texture, other))
      conic_texture_sample_rgba(other, uv, along, across, rgba);
    else if (other->cover)
      rgba[3] = other->cover->levels[0].texels[4 * i + 3];
    memcpy(texels + 4 * i, level->texels + 4 * i, 3 * sizeof *texels);
    texels[4 * i + 3] = rgba[3];
  }
  conic_status status = make_cover(texture->context, texels, level->width, level->height, texture->wrap, &cover);
  conic_memory_release(texture->context, texels);
  if (status != CONIC_OK)
    return status;
  conic_texture_destroy(texture->cover);
  texture->cover = cover;
  return CONIC_OK;
}

void conic_texture_sample_rgba(const conic_texture *texture, const float uv[2], const float along[2],
                               const float across[2], float rgba[4]) {
  const conic_texture *cover = texture->cover;
  conic_texture_sample_channels(cover ? cover : texture, uv, along, across, rgba);
  float alpha = cover ? alpha_of_texel(rgba) : 1.0f;
  for (int channel = 0; channel < 3 && cover; channel++)
    rgba[channel] = alpha > 0.0f ? rgba[channel] / alpha : 0.0f;
  rgba[3] = alpha;
}

int conic_texture_has_alpha(const conic_texture *texture) {
  return texture->cover != NULL;
}

conic_status conic_texture_create(conic_context *context, const conic_image *image, conic_texture_wrap wrap,
                                  conic_texture **texture) {
  *texture = NULL;
  if (!image->planes[CONIC_PLANE_RGBA] || (wrap != CONIC_WRAP_REPEAT && wrap != CONIC_WRAP_CLAMP))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "a texture needs an image with colour, and a known wrap");
  size_t n_pixels = conic_image_pixels(image);
  float *texels = conic_memory_copy(context, image->planes[CONIC_PLANE_RGBA], n_pixels * 4 * sizeof *texels);
  if (!texels)
    return CONIC_ERROR_MEMORY;
  return make_texture(context, texels, image->width, image->height, wrap, texture);
}

conic_status conic_texture_take(conic_context *context, conic_image *image, conic_texture_wrap wrap,
                                conic_texture **texture) {
  float *texels = image->planes[CONIC_PLANE_RGBA];
  int width = image->width, height = image->height;
  image->planes[CONIC_PLANE_RGBA] = NULL;
  conic_image_release(context, image);
  *texture = NULL;
  return make_texture(context, texels, width, height, wrap, texture);
}

conic_status conic_texture_read_image(conic_context *context, const char *path, conic_image *image) {
  context->reads_texture = 1;
  conic_status status = conic_image_read(context, path, image);
  context->reads_texture = 0;
  if (status != CONIC_OK || image->planes[CONIC_PLANE_RGBA])
    return status;
  conic_image_release(context, image);
  return conic_fail(context, CONIC_ERROR_INPUT, "%s: the image has no colour", path);
}

conic_status conic_texture_read(conic_context *context, const char *path, conic_texture_wrap wrap,
                                conic_texture **texture) {
  conic_image image;
  *texture = NULL;
  conic_status status = conic_texture_read_image(context, path, &image);
  return status == CONIC_OK ? conic_texture_take(context, &image, wrap, texture) : status;
}

void conic_texture_destroy(conic_texture *texture) {
  if (!texture)
    return;
  conic_texture_destroy(texture->cover);
  for (int i = 0; i < texture->n_levels; i++) {
    const conic_texture_level *level = &texture->levels[i];
    texture->context->texture_bytes -= level_bytes(level->width, level->height);
    conic_memory_release(texture->context, level->texels);
  }
  conic_memory_release(texture->context, texture);
}

int conic_texture_width(const conic_texture *texture) {
  return texture->levels[0].width;
}

int conic_texture_height(const conic_texture *texture) {
  return texture->levels[0].height;
}
