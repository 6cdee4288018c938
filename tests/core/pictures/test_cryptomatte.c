/* Cryptomatte: hashes that others have computed, floats that survive, ranks, and what stands in a file. */
#include "core/pictures/cryptomatte.h"
#include "tests/support/image_fixture.h"

static void test_hash(void) {
  CHECK(conic_cryptomatte_hash("") == 0);
  CHECK(conic_cryptomatte_hash("a") == 0x3c2569b2);
  CHECK(conic_cryptomatte_hash("abc") == 0xb3dd93fa);
  CHECK(conic_cryptomatte_hash("test") == 0xba6bd213);
  CHECK(conic_cryptomatte_hash("hello") == 0x248bfa47);
  CHECK(conic_cryptomatte_hash("Hello, world!") == 0xc0363e43);
  CHECK(conic_cryptomatte_hash("The quick brown fox jumps over the lazy dog") == 0x2e4ff723);
}

/* An exponent of all zeros or all ones, which names a denormal, an infinity or no number, loses its last bit's value;
 * the names of the specification's own sample stay what they are there. */
static void test_conversion(void) {
  CHECK(conic_cryptomatte_bits("bunny") == 0x13851a76 && conic_cryptomatte_bits("default") == 0x42c9679f);
  CHECK(conic_cryptomatte_bits("") == 0x00800000);
  CHECK(conic_cryptomatte_hash("796") == 0x802fdfe2 && conic_cryptomatte_bits("796") == 0x80afdfe2);
  CHECK(conic_cryptomatte_hash("454") == 0xffbffb25 && conic_cryptomatte_bits("454") == 0xff3ffb25);
  for (int i = 0; i < 4000; i++) {
    char name[16];
    snprintf(name, sizeof name, "%d", i);
    uint32_t bits = conic_cryptomatte_bits(name);
    float value;
    memcpy(&value, &bits, sizeof value);
    CHECK(isnormal(value));
  }
}

static uint32_t bits_of(float value) {
  uint32_t bits;
  memcpy(&bits, &value, sizeof bits);
  return bits;
}

static void check_rank(const conic_image *image, int pixel, int rank, uint32_t bits, float coverage) {
  const float *pair = (const float *)image->planes[CONIC_PLANE_MATTE_0 + rank / 2] + 4 * pixel + rank % 2 * 2;
  CHECK(bits_of(pair[0]) == bits);
  CHECK(pair[1] == coverage);
}

static void test_ranks(conic_context *context) {
  static const uint32_t few[9] = {0, 70, 60, 0, 60, 70, 60, 50, 0},
                        many[16] = {1, 2, 3, 4, 5, 6, 7, 8, 8, 7, 8, 6, 5, 9, 9, 9};
  static const uint32_t kept[6] = {8, 9, 5, 6, 7, 1};
  conic_image image;
  CHECK_OK(conic_image_allocate(context, 2, 1, CONIC_MATTE_PLANES, &image));
  for (int plane = CONIC_PLANE_MATTE_0; plane <= CONIC_PLANE_MATTE_2; plane++)
    memset(image.planes[plane], 0xff, 2 * 4 * sizeof(float));
  conic_cryptomatte_rank(few, NULL, 9, &image, 1);
  check_rank(&image, 1, 0, 60, 3.0f / 9.0f);
  check_rank(&image, 1, 1, 70, 2.0f / 9.0f);
  check_rank(&image, 1, 2, 50, 1.0f / 9.0f);
  for (int rank = 3; rank < 6; rank++)
    check_rank(&image, 1, rank, 0, 0.0f);
  conic_cryptomatte_rank(many, NULL, 16, &image, 0);
  for (int rank = 0; rank < 6; rank++)
    check_rank(&image, 0, rank, kept[rank], (float)(rank < 2 ? 3 : rank < 5 ? 2 : 1) / 16.0f);
  check_rank(&image, 1, 0, 60, 3.0f / 9.0f);
  conic_image_release(context, &image);
}

static void test_manifest(conic_context *context) {
  conic_cryptomatte_manifest manifest = {0};
  CHECK_OK(conic_cryptomatte_name(context, &manifest, "bunny"));
  CHECK(strcmp(manifest.text, "{\"bunny\":\"13851a76\"}") == 0);
  CHECK_OK(conic_cryptomatte_name(context, &manifest, "default"));
  CHECK(strcmp(manifest.text, "{\"bunny\":\"13851a76\",\"default\":\"42c9679f\"}") == 0);
  conic_cryptomatte_manifest_release(context, &manifest);
  CHECK_OK(conic_cryptomatte_name(context, &manifest, "\x01\"\\\x1fé"));
  CHECK(strncmp(manifest.text, "{\"\\u0001\\\"\\\\\\u001fé\":\"", 22) == 0);
  for (int i = 0; i < 3000; i++)
    CHECK_OK(conic_cryptomatte_name(context, &manifest, "name"));
  CHECK(strlen(manifest.text) == manifest.length && manifest.text[manifest.length - 1] == '}');
  conic_cryptomatte_manifest_release(context, &manifest);
  CHECK(!manifest.text);
}

static int holds(const unsigned char *bytes, size_t n_bytes, const char *text) {
  size_t length = strlen(text);
  for (size_t i = 0; i + length <= n_bytes; i++)
    if (memcmp(bytes + i, text, length) == 0)
      return 1;
  return 0;
}

/* The bits come back as they were, and the header names them; the one way to compress that changes bits is refused. */
static void test_file(conic_context *context) {
  conic_cryptomatte_manifest manifest = {0};
  conic_image image = random_image(context, 20, 10, 1u << CONIC_PLANE_RGBA | CONIC_MATTE_PLANES), back;
  conic_image_options options;
  size_t n_bytes;
  CHECK_OK(conic_cryptomatte_name(context, &manifest,
                                  "a name of more bytes than an attribute of an image has room for: "
                                  "so it takes a way of its own into the header"));
  image.manifest = manifest.text;
  conic_image_options_init(&options);
  options.is_half = 1;
  CHECK_OK(conic_image_write_as(context, in_folder("a.exr"), &image, &options));
  CHECK_OK(conic_image_read(context, in_folder("a.exr"), &back));
  for (int plane = CONIC_PLANE_MATTE_0; plane <= CONIC_PLANE_MATTE_2; plane++)
    CHECK(conic_image_hash(&image, (conic_plane)plane) == conic_image_hash(&back, (conic_plane)plane));
  unsigned char *bytes = read_bytes(in_folder("a.exr"), &n_bytes);
  CHECK(holds(bytes, n_bytes, "cryptomatte/3ae39a5/name") && holds(bytes, n_bytes, "CryptoObject"));
  CHECK(holds(bytes, n_bytes, "cryptomatte/3ae39a5/hash") && holds(bytes, n_bytes, "MurmurHash3_32"));
  CHECK(holds(bytes, n_bytes, "cryptomatte/3ae39a5/conversion") && holds(bytes, n_bytes, "uint32_to_float32"));
  CHECK(holds(bytes, n_bytes, "cryptomatte/3ae39a5/manifest") && holds(bytes, n_bytes, manifest.text));
  CHECK(holds(bytes, n_bytes, "CryptoObject00.R") && holds(bytes, n_bytes, "CryptoObject02.A"));
  free(bytes);
  options.compression = CONIC_COMPRESSION_PXR24;
  CHECK(conic_image_write_as(context, in_folder("b.exr"), &image, &options) == CONIC_ERROR_ARGUMENT);
  CHECK(conic_image_check_output_as(context, in_folder("b.exr"), CONIC_MATTE_PLANES, &options) == CONIC_ERROR_ARGUMENT);
  CHECK_OK(conic_image_check_output_as(context, in_folder("b.exr"), 1u << CONIC_PLANE_RGBA, &options));
  CHECK(empty_test_folder() == 1);
  conic_image_release(context, &image);
  conic_image_release(context, &back);
  conic_cryptomatte_manifest_release(context, &manifest);
}

/* That other names are hashed by another number is a difference, but none of amount. */
static void test_comparison(conic_context *context) {
  conic_difference difference;
  conic_image a = random_image(context, 4, 4, CONIC_MATTE_PLANES), b = random_image(context, 4, 4, CONIC_MATTE_PLANES);
  ((float *)b.planes[CONIC_PLANE_MATTE_1])[5] = 1e30f;
  CHECK_OK(conic_image_compare(context, &a, &b, &difference));
  CHECK(!difference.identical && difference.differing_pixels == 1 && difference.max_abs == 0.0);
  conic_image_release(context, &a);
  conic_image_release(context, &b);
}

int main(void) {
  conic_context *context = check_context(2);
  open_test_folder();
  test_hash();
  test_conversion();
  test_ranks(context);
  test_manifest(context);
  if (has_feature("OpenEXR"))
    test_file(context);
  test_comparison(context);
  close_test_folder();
  conic_context_destroy(context);
  return check_result();
}
