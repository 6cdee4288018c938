/* EXR files: every bit there and back, what stands in the header, and files that are cut short. */
#include "core/pictures/image_exr_bands.h"
#include "core/pictures/image_foreign.h"
#include "tests/support/image_fixture.h"

static conic_attribute text_attribute(const char *name, const char *text) {
  conic_attribute attribute = {.type = CONIC_ATTRIBUTE_TEXT};
  snprintf(attribute.name, sizeof attribute.name, "%s", name);
  snprintf(attribute.text, sizeof attribute.text, "%s", text);
  return attribute;
}

static void test_round_trip(conic_context *context, int width, int height, unsigned planes) {
  conic_image image = random_image(context, width, height, planes), back;
  CHECK_OK(conic_image_write(context, in_folder("a.exr"), &image));
  CHECK_OK(conic_image_read(context, in_folder("a.exr"), &back));
  CHECK(same_planes(&image, &back));
  for (int i = 0; i < CONIC_N_PLANES; i++)
    CHECK(conic_image_hash(&image, (conic_plane)i) == conic_image_hash(&back, (conic_plane)i));
  conic_image_release(context, &image);
  conic_image_release(context, &back);
}

/* Through OpenImageIO, as DWAA and DWAB may have to be read, all planes are there too, to the bit. */
static void test_by_openimageio(conic_context *context) {
  conic_image image = random_image(context, 37, 29, EVERY_PLANE), back;
  CHECK_OK(conic_image_write(context, in_folder("a.exr"), &image));
  CHECK_OK(conic_foreign_read(context, in_folder("a.exr"), &back));
  CHECK(same_planes(&image, &back));
  conic_image_release(context, &back);
  conic_image_release(context, &image);
}

static float nearest_half(float value) {
  double step = ldexp(1.0, -24), size = fabs((double)value);
  if (!(size < 65520.0))
    return isnan(value) ? value : copysignf(INFINITY, value);
  for (double top = ldexp(1.0, -13); size >= top; top *= 2.0)
    step *= 2.0;
  return copysignf((float)(nearbyint(size / step) * step), value);
}

/* Every way to compress keeps every bit but pxr24; half is the nearest there is, and only for what is looked at. */
static void test_options(conic_context *context) {
  conic_image image = random_image(context, 67, 45, EVERY_PLANE & ~CONIC_MATTE_PLANES), back;
  conic_image_options options;
  conic_image_options_init(&options);
  for (int i = 0; i < 2 * CONIC_N_COMPRESSIONS; i++) {
    options.compression = (conic_compression)(i % CONIC_N_COMPRESSIONS);
    options.is_half = i >= CONIC_N_COMPRESSIONS;
    CHECK_OK(conic_image_write_as(context, in_folder("a.exr"), &image, &options));
    CHECK_OK(conic_image_read(context, in_folder("a.exr"), &back));
    for (int plane = 0; plane < CONIC_PLANE_MATTE_0; plane++) {
      int is_half = plane == CONIC_PLANE_RGBA || plane == CONIC_PLANE_NORMAL || plane == CONIC_PLANE_ALBEDO;
      int is_exact =
          options.compression != CONIC_COMPRESSION_PXR24 || conic_plane_describe((conic_plane)plane)->is_uint;
      size_t n = 67 * 45 * (size_t)conic_plane_describe((conic_plane)plane)->n_channels;
      const float *a = image.planes[plane], *b = back.planes[plane];
      if (!options.is_half || !is_half) {
        CHECK((memcmp(a, b, 4 * n) == 0) == is_exact);
        continue;
      }
      for (size_t k = 0; k < n; k++)
        CHECK(isnan(a[k]) ? isnan(b[k]) : b[k] == nearest_half(a[k]));
    }
    conic_image_release(context, &back);
  }
  options.compression = CONIC_N_COMPRESSIONS;
  CHECK(conic_image_write_as(context, in_folder("a.exr"), &image, &options) == CONIC_ERROR_ARGUMENT);
  conic_image_release(context, &image);
}

/* Rows of `image` from `y` on as an image that shares its memory. */
static conic_image band_of(const conic_image *image, int y, int height) {
  conic_image band = *image;
  band.height = height;
  for (int i = 0; i < CONIC_N_PLANES; i++)
    if (image->planes[i])
      band.planes[i] = (unsigned char *)image->planes[i] +
                       (size_t)y * (size_t)image->width * 4 * (size_t)conic_plane_describe((conic_plane)i)->n_channels;
  return band;
}

static conic_status write_bands(conic_context *context, const char *part, const conic_image *image,
                                const conic_image_options *options, int rows, int last_row) {
  conic_exr_bands *bands;
  conic_image header = *image;
  memset(header.planes, 0, sizeof header.planes);
  conic_status status =
      conic_exr_bands_open(context, in_folder("b.exr"), part, &header, conic_image_planes(image), options, &bands);
  for (int y = 0; y < last_row && status == CONIC_OK; y += rows) {
    conic_image band = band_of(image, y, y + rows < last_row ? rows : last_row - y);
    status = conic_exr_bands_append(bands, &band);
  }
  return conic_exr_bands_end(bands, status);
}

/* Written band by band, the file is the same; what is no band of it leaves no file. */
static void test_bands(conic_context *context) {
  conic_image image = random_image(context, 61, 301, EVERY_PLANE & ~CONIC_MATTE_PLANES);
  conic_image_options options;
  conic_image_options_init(&options);
  image.attributes[image.n_attributes++] = text_attribute("conicVersion", "1");
  for (int i = 0; i < CONIC_N_COMPRESSIONS; i++) {
    size_t n_bytes, n_banded;
    options.compression = (conic_compression)i;
    CHECK_OK(conic_image_write_as(context, in_folder("a.exr"), &image, &options));
    CHECK_OK(write_bands(context, NULL, &image, &options, i % 2 ? 32 : 96, 301));
    unsigned char *bytes = read_bytes(in_folder("a.exr"), &n_bytes);
    unsigned char *banded = read_bytes(in_folder("b.exr"), &n_banded);
    CHECK(n_bytes == n_banded && memcmp(bytes, banded, n_bytes) == 0);
    free(bytes);
    free(banded);
  }
  CHECK(remove(in_folder("b.exr")) == 0);
  CHECK(write_bands(context, NULL, &image, &options, 40, 301) == CONIC_ERROR_ARGUMENT);
  CHECK(write_bands(context, NULL, &image, &options, 32, 288) == CONIC_ERROR_ARGUMENT);
  CHECK(fopen(in_folder("b.exr"), "rb") == NULL);
  conic_image_release(context, &image);
}

/* A file that is to be gone on with stays as far as it was written, and becomes the file when it is whole. */
static void test_part(conic_context *context) {
  conic_image image = random_image(context, 61, 301, 1u << CONIC_PLANE_RGBA);
  conic_image_options options;
  char part[4096];
  size_t n_bytes, n_banded, n_part;
  conic_image_options_init(&options);
  snprintf(part, sizeof part, "%s", in_folder("b.exr.part"));
  CHECK_OK(conic_image_write_as(context, in_folder("a.exr"), &image, &options));
  unsigned char *bytes = read_bytes(in_folder("a.exr"), &n_bytes);
  CHECK(write_bands(context, part, &image, &options, 32, 288) == CONIC_ERROR_ARGUMENT);
  unsigned char *begun = read_bytes(part, &n_part);
  CHECK(n_part > n_bytes / 2 && memcmp(begun + n_part / 2, bytes + n_part / 2, n_part - n_part / 2) == 0);
  CHECK_OK(write_bands(context, part, &image, &options, 96, 301));
  unsigned char *banded = read_bytes(in_folder("b.exr"), &n_banded);
  CHECK(n_bytes == n_banded && memcmp(bytes, banded, n_bytes) == 0);
  CHECK(fopen(part, "rb") == NULL && remove(in_folder("b.exr")) == 0);
  free(begun);
  free(banded);
  free(bytes);
  conic_image_release(context, &image);
}

/* The file is the same whatever the threads. */
static void test_threads(conic_context *context) {
  conic_image image = random_image(context, 61, 301, EVERY_PLANE);
  size_t n_bytes, n_alone;
  conic_context *alone = check_context(1);
  CHECK_OK(conic_image_write(context, in_folder("a.exr"), &image));
  CHECK_OK(conic_image_write(alone, in_folder("b.exr"), &image));
  unsigned char *bytes = read_bytes(in_folder("a.exr"), &n_bytes);
  unsigned char *bytes_alone = read_bytes(in_folder("b.exr"), &n_alone);
  CHECK(n_bytes > 1000 && n_bytes == n_alone && memcmp(bytes, bytes_alone, n_bytes) == 0);
  free(bytes);
  free(bytes_alone);
  conic_context_destroy(alone);
  conic_image_release(context, &image);
}

/* Where `wanted` stands in the bytes; null where it does not. */
static const unsigned char *find(const unsigned char *bytes, size_t n_bytes, const void *wanted, size_t n_wanted) {
  for (size_t i = 0; i + n_wanted <= n_bytes; i++)
    if (memcmp(bytes + i, wanted, n_wanted) == 0)
      return bytes + i;
  return NULL;
}

/* Whether the header has an attribute of this name, type and value, by the format's own layout: name, type, size,
 * value. */
static int has_attribute(const unsigned char *bytes, size_t n_bytes, const char *name, const char *type,
                         const void *value, uint32_t n_value) {
  unsigned char wanted[512];
  size_t n = 0;
  memcpy(wanted, name, strlen(name) + 1);
  n += strlen(name) + 1;
  memcpy(wanted + n, type, strlen(type) + 1);
  n += strlen(type) + 1;
  memcpy(wanted + n, &n_value, 4);
  memcpy(wanted + n + 4, value, n_value);
  return find(bytes, n_bytes, wanted, n + 4 + n_value) != NULL;
}

static void test_attributes(conic_context *context) {
  conic_image image = random_image(context, 3, 3, 1u << CONIC_PLANE_RGBA), back;
  const char *long_name = "conicANameOverThirtyOneCharacters";
  conic_attribute number = {.name = "conicEpsilon", .type = CONIC_ATTRIBUTE_DOUBLE, .values = {0.1}};
  conic_attribute matrix = {.name = "worldToCamera", .type = CONIC_ATTRIBUTE_MATRIX};
  size_t n_bytes;
  for (int i = 0; i < 16; i++)
    matrix.values[i] = i / 3.0;
  image.n_attributes = 5;
  image.attributes[0] = text_attribute("conicMethod", "conic \xc3\xa9");
  image.attributes[1] = number;
  image.attributes[2] = matrix;
  image.attributes[3] = text_attribute(long_name, "");
  image.attributes[4] = text_attribute("colorInteropID", "srgb_rec709_display"); /* as from a file that was read */
  image.is_display = 1;
  CHECK_OK(conic_image_write(context, in_folder("a.exr"), &image));
  unsigned char *bytes = read_bytes(in_folder("a.exr"), &n_bytes);
  CHECK(has_attribute(bytes, n_bytes, "conicMethod", "string", "conic \xc3\xa9", 8));
  CHECK(has_attribute(bytes, n_bytes, "conicEpsilon", "double", number.values, 8));
  CHECK(has_attribute(bytes, n_bytes, "worldToCamera", "m44d", matrix.values, 128));
  CHECK(has_attribute(bytes, n_bytes, "colorInteropID", "string", "srgb_rec709_display", 19));
  free(bytes);
  CHECK_OK(conic_image_read(context, in_folder("a.exr"), &back));
  for (int i = 0; i < image.n_attributes; i++) {
    int is_found = 0;
    for (int k = 0; k < back.n_attributes; k++)
      is_found |= memcmp(&image.attributes[i], &back.attributes[k], sizeof image.attributes[i]) == 0;
    CHECK(is_found);
  }
  CHECK(back.is_display);
  conic_image_release(context, &back);
  empty_test_folder();
  image.attributes[0] = text_attribute("channels", "a name that the format needs itself");
  CHECK(conic_image_write(context, in_folder("a.exr"), &image) == CONIC_ERROR_ARGUMENT);
  CHECK(empty_test_folder() == 0);
  conic_image_release(context, &image);
}

/* The channels stand in the header in the order of their names, with the types 0 (UINT) and 2 (FLOAT). */
static void test_channels(conic_context *context) {
  static const char names[][12] = {
      "A",          "B",          "G",     "N.X",     "N.Y",      "N.Z",      "P.X",       "P.Y",
      "P.Z",        "R",          "T",     "Z",       "albedo.B", "albedo.G", "albedo.R",  "ao",
      "backward.u", "backward.v", "bound", "cluster", "count",    "doubt",    "forward.u", "forward.v",
      "id",         "inverseZ",   "last",  "medianZ", "samples",  "shadow",   "variance",  "weight"};
  static const char *const integers[] = {"cluster", "count", "doubt", "id", "last", "samples"};
  conic_image image = random_image(context, 3, 3, EVERY_PLANE & ~CONIC_MATTE_PLANES);
  size_t n_bytes;
  CHECK_OK(conic_image_write(context, in_folder("a.exr"), &image));
  unsigned char *bytes = read_bytes(in_folder("a.exr"), &n_bytes);
  const unsigned char *at = find(bytes, n_bytes, "channels\0chlist\0", 16);
  CHECK(at);
  at = at ? at + 16 + 4 : NULL;
  for (size_t i = 0; at && i < sizeof names / sizeof names[0]; i++) {
    CHECK(strcmp((const char *)at, names[i]) == 0);
    int is_integer = 0;
    for (size_t k = 0; k < sizeof integers / sizeof integers[0]; k++)
      is_integer |= strcmp(names[i], integers[k]) == 0;
    at += strlen((const char *)at) + 1;
    CHECK(*at == (is_integer ? 0 : 2));
    at += 16;
  }
  CHECK(at && *at == 0);
  free(bytes);
  conic_image_release(context, &image);
}

static void test_cut_short(conic_context *context) {
  conic_image image = random_image(context, 50, 70, 1u << CONIC_PLANE_RGBA | 1u << CONIC_PLANE_ID), back;
  size_t n_bytes;
  CHECK_OK(conic_image_write(context, in_folder("a.exr"), &image));
  unsigned char *bytes = read_bytes(in_folder("a.exr"), &n_bytes);
  for (size_t part = 0; part < 40; part++) {
    write_bytes(in_folder("b.exr"), bytes, n_bytes * part / 40);
    CHECK(conic_image_read(context, in_folder("b.exr"), &back) == CONIC_ERROR_INPUT);
    CHECK(conic_image_planes(&back) == 0);
  }
  write_bytes(in_folder("b.exr"), bytes, n_bytes - 1);
  CHECK(conic_image_read(context, in_folder("b.exr"), &back) == CONIC_ERROR_INPUT);
  free(bytes);
  conic_image_release(context, &image);
}

int main(void) {
  conic_context *context = check_context(3);
  if (!has_feature("OpenEXR")) {
    conic_image image = {.width = 1, .height = 1, .planes = {(float[4]){0}}};
    CHECK(conic_image_write(context, "/tmp/conic-unsupported.exr", &image) == CONIC_ERROR_UNSUPPORTED);
    conic_context_destroy(context);
    fprintf(stderr, "skipped: this build is without OpenEXR\n");
    return check_failures ? 1 : 77;
  }
  open_test_folder();
  test_round_trip(context, 1, 1, 1u << CONIC_PLANE_ID);
  test_round_trip(context, 130, 97, EVERY_PLANE);
  test_round_trip(context, 7, 16, 1u << CONIC_PLANE_RGBA | 1u << CONIC_PLANE_Z);
  for (int i = 0; i < CONIC_N_PLANES; i++)
    test_round_trip(context, 17, 33, 1u << i);
  test_threads(context);
  test_bands(context);
  test_part(context);
  test_options(context);
  if (has_feature("OpenImageIO"))
    test_by_openimageio(context);
  test_attributes(context);
  test_channels(context);
  test_cut_short(context);
  close_test_folder();
  conic_context_destroy(context);
  return check_result();
}
