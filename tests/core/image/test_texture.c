/* Textures: the pyramid, wrapping, and the elliptical filter against a sum over the finest texels. */
#include "tests/support/fixture.h"

static conic_texture *make(conic_context *context, int width, int height, conic_texture_wrap wrap,
                           float (*color)(int x, int y, int channel)) {
  conic_image image;
  conic_texture *texture;
  CHECK_OK(conic_image_allocate(context, width, height, 1u << CONIC_PLANE_RGBA, &image));
  for (int i = 0; i < width * height; i++)
    for (int channel = 0; channel < 4; channel++)
      ((float *)image.planes[CONIC_PLANE_RGBA])[4 * i + channel] =
          channel == 3 ? 1.0f : color(i % width, i / width, channel);
  CHECK_OK(conic_texture_create(context, &image, wrap, &texture));
  conic_image_release(context, &image);
  return texture;
}

static float uniform(int x, int y, int channel) {
  (void)x;
  (void)y;
  return 0.2f + 0.3f * (float)channel;
}

static float noise(int x, int y, int channel) {
  int place = x * 7919 + y * 104729 + channel;
  uint64_t state = (uint64_t)place;
  return (float)fixture_random(&state);
}

static float ramp(int x, int y, int channel) {
  return channel == 0 ? (float)x : channel == 1 ? (float)y : 1.0f;
}

/* One colour is one colour, at any size, shape and place, and whatever the arguments. */
static void check_uniform(conic_context *context) {
  uint64_t state = 1;
  for (int wrap = 0; wrap < 2; wrap++) {
    conic_texture *texture = make(context, 37, 64, (conic_texture_wrap)wrap, uniform);
    for (int i = 0; i < 3000; i++) {
      float size = (float)pow(10.0, 6.0 * fixture_random(&state) - 4.0), sides[3][2], color[3];
      for (int k = 0; k < 6; k++)
        sides[k / 2][k % 2] = (float)(fixture_random(&state) - 0.5) * (k < 2 ? 20.0f : size);
      if (i % 50 == 0)
        sides[i / 50 % 3][i / 150 % 2] = i % 100 ? NAN : INFINITY;
      conic_texture_sample(texture, sides[0], sides[1], sides[2], color);
      for (int channel = 0; channel < 3; channel++)
        CHECK_NEAR(color[channel], 0.2f + 0.3f * (float)channel, 2e-6);
    }
    conic_texture_destroy(texture);
  }
}

/* The filter as it is meant: a Gaussian over the first level's texels, of the footprint's variance and a texel's. */
static void filter_plainly(int size, const float uv[2], const float along[2], const float across[2], double color[3]) {
  double x = (double)uv[0] * size - 0.5, y = (1.0 - (double)uv[1]) * size - 0.5, sum = 0.0;
  double ax = (double)along[0] * size, ay = -(double)along[1] * size;
  double bx = (double)across[0] * size, by = -(double)across[1] * size;
  double xx = 0.25 * (ax * ax + bx * bx + 1.0), xy = 0.25 * (ax * ay + bx * by), yy = 0.25 * (ay * ay + by * by + 1.0);
  double determinant = xx * yy - xy * xy;
  color[0] = color[1] = color[2] = 0.0;
  for (int j = (int)y - 3 * size; j < (int)y + 3 * size; j++)
    for (int i = (int)x - 3 * size; i < (int)x + 3 * size; i++) {
      double dx = i - x, dy = j - y, q = (yy * dx * dx - 2.0 * xy * dx * dy + xx * dy * dy) / determinant;
      if (q >= 4.0)
        continue;
      double weight = exp(-0.5 * q) - exp(-2.0);
      sum += weight;
      for (int channel = 0; channel < 3; channel++)
        color[channel] += weight * (double)noise(((i % size) + size) % size, ((j % size) + size) % size, channel);
    }
  for (int channel = 0; channel < 3; channel++)
    color[channel] /= sum;
}

/* Within the first level the filter is that; with coarser ones it is near. */
static void check_filter(conic_context *context) {
  enum { SIZE = 64 };
  conic_texture *texture = make(context, SIZE, SIZE, CONIC_WRAP_REPEAT, noise);
  uint64_t state = 8;
  double worst_fine = 0.0, coarse = 0.0;
  int n_coarse = 0;
  for (int i = 0; i < 300; i++) {
    double widths[2] = {i < 150 ? 0.9 : 5.0 * fixture_random(&state) + 1.0, 0.0}, turn = 6.28 * fixture_random(&state);
    widths[1] = widths[0] * (1.0 + 5.0 * fixture_random(&state));
    const float uv[2] = {(float)fixture_random(&state), (float)fixture_random(&state)};
    const float along[2] = {(float)(widths[0] * cos(turn) / SIZE), (float)(widths[0] * sin(turn) / SIZE)};
    const float across[2] = {(float)(-widths[1] * sin(turn) / SIZE), (float)(widths[1] * cos(turn) / SIZE)};
    float color[3];
    double expected[3];
    conic_texture_sample(texture, uv, along, across, color);
    filter_plainly(SIZE, uv, along, across, expected);
    for (int channel = 0; channel < 3; channel++) {
      double error = fabs((double)color[channel] - expected[channel]);
      if (i < 150)
        worst_fine = fmax(worst_fine, error);
      else
        coarse += error * error;
      n_coarse += i >= 150;
    }
  }
  printf("filter: %.1e on the first level, %.1e (rms) beyond\n", worst_fine, sqrt(coarse / n_coarse));
  CHECK(worst_fine < 3e-5);
  CHECK(sqrt(coarse / n_coarse) < 0.03); /* of noise, whose own deviation is 0.29 */
  conic_texture_destroy(texture);
}

/* Places: texel centres, which way is up, and what is beyond the borders. */
static void check_places(conic_context *context) {
  enum { SIZE = 16 };
  const float none[2] = {0.0f, 0.0f};
  conic_texture *repeats = make(context, SIZE, SIZE, CONIC_WRAP_REPEAT, ramp);
  conic_texture *clamps = make(context, SIZE, SIZE, CONIC_WRAP_CLAMP, ramp);
  CHECK(conic_texture_width(repeats) == SIZE && conic_texture_height(repeats) == SIZE);
  for (int i = 2; i < SIZE - 2; i++) {
    const float uv[2] = {((float)i + 0.5f) / SIZE, ((float)i + 0.5f) / SIZE};
    const float far_uv[2] = {uv[0] + 3.0f, uv[1] - 5.0f};
    float color[3], far_color[3];
    conic_texture_sample(repeats, uv, none, none, color);
    conic_texture_sample(repeats, far_uv, none, none, far_color);
    CHECK_NEAR(color[0], i, 1e-4);
    CHECK_NEAR(color[1], SIZE - 1 - i, 1e-4);
    CHECK_NEAR(far_color[0], i, 1e-4);
    CHECK_NEAR(far_color[1], SIZE - 1 - i, 1e-4);
    conic_texture_sample(clamps, far_uv, none, none, color);
    CHECK_NEAR(color[0], SIZE - 1, 1e-4);
    CHECK_NEAR(color[1], SIZE - 1, 1e-4);
  }
  const float wide[2] = {40.0f, 0.0f}, high[2] = {0.0f, 40.0f};
  float color[3];
  conic_texture_sample(repeats, none, wide, high, color); /* everything */
  CHECK_NEAR(color[0], 7.5, 1e-4);
  CHECK_NEAR(color[1], 7.5, 1e-4);
  conic_texture_destroy(repeats);
  conic_texture_destroy(clamps);
}

int main(void) {
  conic_context *context = check_context(1);
  check_uniform(context);
  check_filter(context);
  check_places(context);
  conic_context_destroy(context);
  return check_result();
}
