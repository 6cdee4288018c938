/* Tone curves: against their published formulas, and in the codes of files. */
#include "conic/image.h"
#include "core/base/color.h"
#include "core/pictures/image_samples.h"
#include "tests/support/image_fixture.h"

static float map_grey(conic_tone tone, float grey) {
  float color[3] = {grey, grey, grey};
  conic_tone_map(tone, color, color);
  double apart = tone == CONIC_TONE_AGX ? 6e-4 : 2e-5; /* the matrices' rows sum to 1 but for their last digits */
  CHECK_NEAR(color[0], color[1], apart);
  CHECK_NEAR(color[0], color[2], apart);
  return color[1];
}

/* The numbers are those of the formulas as they were published, in Python. */
static void test_known_values(void) {
  static const struct {
    conic_tone tone;
    float linear[3];
    double mapped[3];
  } known[] = {
      {CONIC_TONE_FILMIC, {0.01f, 0.18f, 0.5f}, {0.007663655, 0.128338449, 0.304300561}},
      {CONIC_TONE_FILMIC, {1.0f, 2.0f, 4.0f}, {0.492918546, 0.713238011, 0.918030079}},
      {CONIC_TONE_FILMIC, {5.6f, 5.7f, 1e30f}, {1.0, 1.0, 1.0}},
      {CONIC_TONE_ACES, {0.18f, 0.18f, 0.18f}, {0.105591247, 0.105591247, 0.105590191}},
      {CONIC_TONE_ACES, {1.0f, 1.0f, 1.0f}, {0.619115427, 0.619115427, 0.619109236}},
      {CONIC_TONE_ACES, {4.0f, 4.0f, 4.0f}, {0.909013768, 0.909013768, 0.909004678}},
      {CONIC_TONE_ACES, {1.0f, 0.0f, 0.0f}, {0.688027874, 0.0, 0.002639007}},
      {CONIC_TONE_ACES, {0.0f, 2.0f, 0.5f}, {0.369768994, 0.813593613, 0.467038992}},
      {CONIC_TONE_ACES, {1e30f, 1e30f, 1e30f}, {1.0, 1.0, 1.0}},
      {CONIC_TONE_AGX, {0.18f, 0.18f, 0.18f}, {0.210977570, 0.211040601, 0.211044524}},
      {CONIC_TONE_AGX, {4.0f, 4.0f, 4.0f}, {0.856477986, 0.856868174, 0.856892457}},
      {CONIC_TONE_AGX, {1.0f, 0.0f, 0.0f}, {0.712387674, 0.043291500, 0.043351963}},
      {CONIC_TONE_AGX, {0.01f, 0.02f, 0.03f}, {0.010251906, 0.022652832, 0.036818824}},
      {CONIC_TONE_AGX, {30.0f, 1.0f, 0.1f}, {1.0, 0.748691674, 0.642641941}},
      {CONIC_TONE_AGX, {1e30f, 1e30f, 1e30f}, {0.996383629, 0.996874976, 0.996905555}},
  };
  for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
    float mapped[3];
    conic_tone_map(known[i].tone, known[i].linear, mapped);
    for (int c = 0; c < 3; c++)
      CHECK_NEAR(mapped[c], known[i].mapped[c], 1e-7);
  }
}

/* From black to what is far beyond white, in steps of a sixteenth of a stop or less. */
static void test_greys_rise(void) {
  for (int tone = CONIC_TONE_FILMIC; tone < CONIC_N_TONES; tone++) {
    float before = map_grey((conic_tone)tone, 0.0f);
    CHECK(before == 0.0f);
    for (double grey = 1e-4; grey < 1e4; grey *= 1.04) {
      float here = map_grey((conic_tone)tone, (float)grey);
      CHECK(here > before || here == 1.0f || (here == 0.0f && grey < 0.01) || (tone == CONIC_TONE_AGX && grey > 16.0));
      before = here;
    }
    CHECK(tone == CONIC_TONE_AGX ? before > 0.9968f && before < 1.0f : before == 1.0f);
  }
}

static void test_odd_colors(void) {
  for (int tone = CONIC_TONE_FILMIC; tone < CONIC_N_TONES; tone++) {
    CHECK(map_grey((conic_tone)tone, -1.0f) == 0.0f && map_grey((conic_tone)tone, NAN) == 0.0f);
    CHECK(map_grey((conic_tone)tone, INFINITY) == map_grey((conic_tone)tone, 1e30f));
    float broken[3] = {NAN, 1.0f, -INFINITY}, whole[3] = {0.0f, 1.0f, 0.0f};
    conic_tone_map((conic_tone)tone, broken, broken);
    conic_tone_map((conic_tone)tone, whole, whole);
    CHECK(memcmp(broken, whole, sizeof whole) == 0); /* one channel does not spoil the others */
  }
  float bright[3] = {-2.0f, 0.5f, 7.0f};
  conic_tone_map(CONIC_TONE_SRGB, bright, bright);
  CHECK(bright[0] == -2.0f && bright[1] == 0.5f && bright[2] == 7.0f);
  CHECK(strcmp(conic_tone_name(CONIC_TONE_FILMIC), "filmic") == 0 && !conic_tone_name((conic_tone)CONIC_N_TONES));
}

/* Pixels of all brightnesses, some half covered. */
static conic_image bright_image(conic_context *context) {
  conic_image image;
  CHECK_OK(conic_image_allocate(context, 64, 64, 1u << CONIC_PLANE_RGBA, &image));
  float *rgba = image.planes[CONIC_PLANE_RGBA];
  for (int i = 0; i < 64 * 64; i++) {
    rgba[4 * i + 3] = i % 3 ? 1.0f : 0.5f;
    for (int c = 0; c < 3; c++)
      rgba[4 * i + c] = rgba[4 * i + 3] * (float)((i * (c + 1)) % 4096) / 512.0f;
  }
  return image;
}

/* The curve is of colours that are not multiplied by alpha; these become the codes that they would without it. */
static void test_codes(conic_context *context) {
  conic_image image = bright_image(context);
  const float *rgba = image.planes[CONIC_PLANE_RGBA];
  float thresholds[255];
  static uint8_t codes[64 * 64 * 4], display[64 * 64 * 4];
  static uint16_t wide[64 * 64 * 4];
  static float floats[64 * 64 * 4];
  conic_srgb_thresholds(thresholds);
  for (int tone = 0; tone < CONIC_N_TONES; tone++) {
    conic_samples_layout layout = {.n_channels = 4, .sample_bytes = 1, .is_straight = 1, .tone = (conic_tone)tone};
    conic_samples_from_rgba(context, rgba, 64, 64, layout, codes);
    layout.sample_bytes = 2;
    conic_samples_from_rgba(context, rgba, 64, 64, layout, wide);
    for (int i = 0; i < 64 * 64; i++) {
      float color[3];
      for (int c = 0; c < 3; c++)
        color[c] = rgba[4 * i + c] / rgba[4 * i + 3];
      conic_tone_map((conic_tone)tone, color, color);
      for (int c = 0; c < 3; c++) {
        double encoded = conic_srgb_encode((double)color[c]);
        CHECK(codes[4 * i + c] == conic_srgb_code(thresholds, color[c]));
        CHECK_NEAR(wide[4 * i + c], 65535.0 * (encoded < 1.0 ? encoded : 1.0), 0.5001);
      }
      CHECK(codes[4 * i + 3] == (i % 3 ? 255 : 128));
    }
    layout.sample_bytes = 4;
    layout.is_straight = 0;
    conic_samples_from_rgba(context, rgba, 64, 64, layout, floats);
    CHECK(memcmp(floats, rgba, sizeof floats) == 0);
    layout.sample_bytes = 1;
    layout.is_straight = layout.is_display = 1;
    conic_samples_from_rgba(context, rgba, 64, 64, layout, tone ? codes : display);
    CHECK(tone == 0 || memcmp(codes, display, sizeof codes) == 0);
  }
  conic_image_release(context, &image);
}

/* FNV-1a of mapped colours, the same on every machine. */
static void test_bits(conic_context *context) {
  static const uint64_t wanted[CONIC_N_TONES] = {0xc33df7d3659ca202, 0x6e0927862978cb8d, 0x1cd4d203e19c2b1a,
                                                 0xc2e4f75d4c34514a};
  for (int tone = 0; tone < CONIC_N_TONES; tone++) {
    conic_image image = bright_image(context);
    float *rgba = image.planes[CONIC_PLANE_RGBA];
    for (int i = 0; i < 64 * 64; i++)
      conic_tone_map((conic_tone)tone, rgba + 4 * i, rgba + 4 * i);
    uint64_t hash = conic_image_hash(&image, CONIC_PLANE_RGBA);
    CHECK(hash == wanted[tone]);
    conic_image_release(context, &image);
  }
}

static void test_options(conic_context *context) {
  conic_image image = bright_image(context);
  conic_image_options options;
  conic_image_options_init(&options);
  CHECK(options.tone == CONIC_TONE_SRGB);
  options.tone = (conic_tone)CONIC_N_TONES;
  CHECK(conic_image_write_as(context, in_folder("a.pfm"), &image, &options) == CONIC_ERROR_ARGUMENT);
  conic_image_release(context, &image);
}

int main(void) {
  conic_context *context = check_context(2);
  open_test_folder();
  test_known_values();
  test_greys_rise();
  test_odd_colors();
  test_codes(context);
  test_bits(context);
  test_options(context);
  close_test_folder();
  conic_context_destroy(context);
  return check_result();
}
