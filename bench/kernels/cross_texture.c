/* The slot `texture` of every kernel table against the plain C one, bit for bit: footprints of all sizes and shapes, a
 * block's alike or each its own, hostile ones, on pictures of all shapes, for all and for some of the pixels. */
#include "raster/kernels/tile_kernels.h"
#include "tests/support/fixture.h"

enum { N_BLOCKS = 1200, UNTOUCHED = 0x5a };

static conic_texture *make_texture(conic_context *context, int width, int height, conic_texture_wrap wrap) {
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
    double dx = size * (double)(l / CONIC_BLOCK_EDGE), dy = size * (double)(l % CONIC_BLOCK_EDGE);
    if (is_coherent)
      place_pixel(&same, size, x + dx, y + dy, l, p);
    else
      place_pixel(state, texel * pow(10.0, 7.0 * fixture_random(state) - 2.0), 40.0 * fixture_random(state) - 20.0,
                  40.0 * fixture_random(state) - 20.0, l, p);
  }
  *state ^= shape << 1 | 1;
}

static void spoil(uint64_t *state, conic_texture_places *p) {
  static const float specials[] = {NAN, INFINITY, -INFINITY, 0.0f, -0.0f, 1e-42f, 1e6f, -1e6f, 1e30f, 3e38f, 1.0f};
  for (int i = 0; i < 8; i++) {
    float(*values)[CONIC_BLOCK_PIXELS] = i % 3 == 0 ? p->uv : i % 3 == 1 ? p->along : p->across;
    values[i & 1][(int)(16.0 * fixture_random(state))] = specials[(int)(11.0 * fixture_random(state))];
  }
}

static void compare(const conic_tile_kernels *kernels, const conic_texture *texture) {
  const conic_tile_kernels *plain = &conic_tile_kernels_scalar;
  double texel = 1.0 / (conic_texture_width(texture) > conic_texture_height(texture) ? conic_texture_width(texture)
                                                                                     : conic_texture_height(texture));
  uint64_t state = 11;
  for (int i = 0; i < N_BLOCKS; i++) {
    float expected[3][CONIC_BLOCK_PIXELS], found[3][CONIC_BLOCK_PIXELS];
    conic_texture_places places;
    uint32_t pixels = i % 3 ? 0xffff : (uint32_t)(65536.0 * fixture_random(&state));
    place_block(&state, texel, &places);
    if (i % 7 == 0)
      spoil(&state, &places);
    memset(expected, UNTOUCHED, sizeof expected);
    memset(found, UNTOUCHED, sizeof found);
    plain->texture(texture, &places, pixels, expected);
    kernels->texture(texture, &places, pixels, found);
    CHECK(memcmp(expected, found, sizeof found) == 0);
    for (int l = 0; l < 3 * CONIC_BLOCK_PIXELS && pixels == 0xffff; l++)
      CHECK(found[l / CONIC_BLOCK_PIXELS][l % CONIC_BLOCK_PIXELS] > -0.2501f &&
            found[l / CONIC_BLOCK_PIXELS][l % CONIC_BLOCK_PIXELS] < 0.7501f);
  }
}

int main(void) {
  static const int sizes[][2] = {{1, 1}, {1, 64}, {64, 1}, {2, 2}, {37, 20}, {5, 64}, {300, 7}, {512, 512}, {20000, 2}};
  conic_context *context = check_context(1);
  for (int i = 0; i < (int)(sizeof sizes / sizeof *sizes); i++)
    for (int wrap = 0; wrap < 2; wrap++) {
      conic_texture *texture = make_texture(context, sizes[i][0], sizes[i][1], (conic_texture_wrap)wrap);
      for (int isa = CONIC_ISA_SCALAR; isa < CONIC_N_ISAS; isa++)
        if (conic_tile_kernels_of((conic_isa)isa))
          compare(conic_tile_kernels_of((conic_isa)isa), texture);
      conic_texture_destroy(texture);
    }
  conic_context_destroy(context);
  return check_result();
}
