/* Textures: footprints of all sizes and shapes, a block's alike or each its own, hostile ones, on pictures of all
 * shapes, for all and for some of the pixels. */
#include "bench/loops/cross.h"

enum { N_BLOCKS = 1200, UNTOUCHED = 0x5a };

typedef struct texture_desk {
  cross_desk memory;
  const conic_texture *texture;
  const conic_texture_places *places;
  const uint32_t *pixels;
  float (*colors)[3][CONIC_BLOCK_PIXELS];
} texture_desk;

static conic_texture *random_texture(conic_context *context, int width, int height, conic_texture_wrap wrap) {
  conic_image image;
  conic_texture *texture;
  uint64_t state = (uint64_t)width * 71 + (uint64_t)height;
  CHECK_OK(conic_image_allocate(context, width, height, 1u << CONIC_PLANE_RGBA, &image));
  float *rgba = image.planes[CONIC_PLANE_RGBA];
  for (int i = 0; i < 4 * width * height; i++)
    rgba[i] = i % 4 == 3 ? 1.0f : (float)fixture_random(&state) - 0.25f;
  CHECK_OK(conic_texture_create(context, &image, wrap, &texture));
  conic_image_release(context, &image);
  return texture;
}

/* A footprint somewhere: of `size` texels, up to 30 times as long. */
static void place_pixel(uint64_t *state, double size, double x, double y, int l, conic_texture_places *p) {
  double turn = 6.2832 * fixture_random(state), length = size * pow(30.0, fixture_random(state));
  p->uv[0][l] = (float)x;
  p->uv[1][l] = (float)y;
  p->along[0][l] = (float)(size * cos(turn));
  p->along[1][l] = (float)(size * sin(turn));
  p->across[0][l] = (float)(-length * sin(turn));
  p->across[1][l] = (float)(length * cos(turn));
}

/* A block as a triangle fills it, the same footprint side by side; or each pixel by itself. */
static void place_block(uint64_t *state, double texel, conic_texture_places *p) {
  double size = texel * pow(10.0, 4.0 * fixture_random(state) - 1.5);
  double x = 8.0 * fixture_random(state) - 4.0, y = 8.0 * fixture_random(state) - 4.0;
  int is_coherent = fixture_random(state) < 0.5;
  uint64_t shape = *state;
  for (int l = 0; l < CONIC_BLOCK_PIXELS; l++) {
    uint64_t same = shape;
    size_t column = (size_t)l / CONIC_BLOCK_EDGE;
    double dx = size * (double)column, dy = size * (double)(l % CONIC_BLOCK_EDGE);
    if (is_coherent)
      place_pixel(&same, size, x + dx, y + dy, l, p);
    else
      place_pixel(state, texel * pow(10.0, 7.0 * fixture_random(state) - 2.0), 40.0 * fixture_random(state) - 20.0,
                  40.0 * fixture_random(state) - 20.0, l, p);
  }
  *state ^= shape << 1 | 1;
}

static void spoil_places(uint64_t *state, conic_texture_places *p) {
  static const float specials[] = {NAN, INFINITY, -INFINITY, 0.0f, -0.0f, 1e-42f, 1e6f, -1e6f, 1e30f, 3e38f, 1.0f};
  for (int i = 0; i < 8; i++) {
    float(*values)[CONIC_BLOCK_PIXELS] = i % 3 == 0 ? p->uv : i % 3 == 1 ? p->along : p->across;
    values[i & 1][(int)(16.0 * fixture_random(state))] = specials[(int)(11.0 * fixture_random(state))];
  }
}

static void run_texture(const cross_tables *tables, cross_desk *desk) {
  texture_desk *d = (texture_desk *)(void *)desk;
  for (int i = 0; i < N_BLOCKS; i++)
    tables->raster.texture.at_places(d->texture, &d->places[i], d->pixels[i], d->colors[i]);
}

/* No colour is beyond the texture's, where it is everywhere a number. */
static void check_range(const texture_desk *d) {
  for (int i = 0; i < N_BLOCKS; i++)
    for (int l = 0; l < 3 * CONIC_BLOCK_PIXELS && d->pixels[i] == 0xffff; l++) {
      float color = d->colors[i][l / CONIC_BLOCK_PIXELS][l % CONIC_BLOCK_PIXELS];
      CHECK(color > -0.2501f && color < 0.7501f);
    }
}

static void try_texture(cross *c, conic_texture *texture, uint64_t state) {
  static conic_texture_places places[N_BLOCKS];
  static uint32_t pixels[N_BLOCKS];
  texture_desk *desks[CONIC_N_ISAS];
  int width = conic_texture_width(texture), height = conic_texture_height(texture);
  char variant[32];
  cross_slot slot = {"texture", variant, run_texture, "pixel", 0.0};
  snprintf(variant, sizeof variant, "%d x %d", width, height);
  for (int i = 0; i < N_BLOCKS; i++) {
    pixels[i] = i % 3 ? 0xffff : (uint32_t)(65536.0 * fixture_random(&state));
    slot.n_units += __builtin_popcount(pixels[i]);
    place_block(&state, 1.0 / (width > height ? width : height), &places[i]);
    if (i % 7 == 0)
      spoil_places(&state, &places[i]);
  }
  for (int i = 0; i < c->n_tables; i++) {
    desks[i] = cross_calloc(sizeof *desks[i]);
    desks[i]->texture = texture;
    desks[i]->places = places;
    desks[i]->pixels = pixels;
    desks[i]->colors = cross_room(&desks[i]->memory, "colours", N_BLOCKS * sizeof *desks[i]->colors);
    memset(desks[i]->colors, UNTOUCHED, N_BLOCKS * sizeof *desks[i]->colors);
  }
  cross_try(c, &slot, (cross_desk **)(void *)desks);
  for (int i = 0; i < c->n_tables; i++) {
    check_range(desks[i]);
    cross_close(&desks[i]->memory);
  }
}

int cli_cross_texture(cross *c) {
  static const int sizes[][2] = {{512, 512}, {1, 1}, {1, 64}, {64, 1}, {2, 2}, {37, 20}, {5, 64}, {300, 7}, {20000, 2}};
  conic_context *context = check_context(1);
  for (int i = 0; i < (c->is_bench ? 1 : (int)(sizeof sizes / sizeof *sizes)); i++)
    for (int wrap = 0; wrap < (c->is_bench ? 1 : 2); wrap++) {
      conic_texture *texture = random_texture(context, sizes[i][0], sizes[i][1], (conic_texture_wrap)wrap);
      try_texture(c, texture, c->seed + (uint64_t)(2 * i + wrap));
      conic_texture_destroy(texture);
    }
  conic_context_destroy(context);
  return check_failures;
}
