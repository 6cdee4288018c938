/* Images: their planes, hashes, PFM files, and what happens when a file cannot be written or read. */
#if !defined(_WIN32)
#include <signal.h>
#include <sys/resource.h>
#endif

#include "core/base/byte_order.h"
#include "core/image/image_common.h"
#include "tests/support/image_fixture.h"

static void test_descriptions(void) {
  static const char *const names[] = {
      "rgba",   "Z",       "N",        "albedo",         "weight",         "count",
      "id",     "cluster", "P",        "CryptoObject00", "CryptoObject01", "CryptoObject02",
      "T",      "medianZ", "inverseZ", "last",           "doubt",          "ao",
      "shadow", "samples", "variance", "motion",         "bound"};
  for (int i = 0; i < CONIC_N_PLANES; i++) {
    const conic_plane_description *plane = conic_plane_describe((conic_plane)i);
    CHECK(plane && strcmp(plane->name, names[i]) == 0);
    if (!plane)
      continue;
    CHECK(plane->is_uint == ((i >= CONIC_PLANE_COUNT && i <= CONIC_PLANE_CLUSTER) || i == CONIC_PLANE_LAST ||
                             i == CONIC_PLANE_DOUBT || i == CONIC_PLANE_SAMPLES));
    for (int c = 0; c < plane->n_channels; c++)
      CHECK(plane->channels[c] && plane->channels[c][0]);
  }
  CHECK(!conic_plane_describe(CONIC_N_PLANES));
  CHECK(!conic_plane_describe((conic_plane)-1));
}

static void test_allocation(conic_context *context) {
  conic_image image;
  CHECK_OK(conic_image_allocate(context, 3, 2, 1u << CONIC_PLANE_RGBA | 1u << CONIC_PLANE_ID, &image));
  CHECK(conic_image_planes(&image) == (1u << CONIC_PLANE_RGBA | 1u << CONIC_PLANE_ID));
  for (int i = 0; i < 24; i++)
    CHECK(((float *)image.planes[CONIC_PLANE_RGBA])[i] == 0.0f);
  conic_image_release(context, &image);
  CHECK(conic_image_planes(&image) == 0 && image.width == 0);
  conic_image_release(context, &image);
  const int wrong[][2] = {{0, 1}, {1, 0}, {-1, 5}, {65536, 1}, {1, 65536}};
  for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++)
    CHECK(conic_image_allocate(context, wrong[i][0], wrong[i][1], 1, &image) == CONIC_ERROR_ARGUMENT);
  CHECK(conic_image_allocate(context, 1, 1, EVERY_PLANE + 1, &image) == CONIC_ERROR_ARGUMENT);
}

static void test_allocation_limit(void) {
  conic_context_options options;
  conic_context *context;
  conic_image image;
  conic_context_options_init(&options);
  options.max_allocation_bytes = 1000;
  CHECK_OK(conic_context_create(&options, &context));
  CHECK(conic_image_allocate(context, 16, 16, EVERY_PLANE, &image) == CONIC_ERROR_MEMORY);
  CHECK(conic_image_planes(&image) == 0);
  conic_context_destroy(context);
}

/* Against the test vectors that the function's authors published. */
static void test_hash(conic_context *context) {
  conic_image image;
  CHECK(conic_hash_bytes("", 0) == UINT64_C(0xcbf29ce484222325));
  CHECK(conic_hash_bytes("foobar", 6) == UINT64_C(0x85944171f73967e8));
  CHECK_OK(conic_image_allocate(context, 1, 1, 1u << CONIC_PLANE_COUNT, &image));
  *(uint32_t *)image.planes[CONIC_PLANE_COUNT] = conic_load_32("foob");
  CHECK(conic_image_hash(&image, CONIC_PLANE_COUNT) == UINT64_C(0xdd120e790c2512af));
  CHECK(conic_image_hash(&image, CONIC_PLANE_ID) == 0);
  CHECK(conic_image_hash(&image, CONIC_N_PLANES) == 0);
  conic_image_release(context, &image);
}

static void check_pfm(conic_context *context, const void *bytes, size_t n_bytes, const float expected[6]) {
  conic_image image;
  write_bytes(in_folder("a.pfm"), bytes, n_bytes);
  CHECK_OK(conic_image_read(context, in_folder("a.pfm"), &image));
  CHECK(image.width == 1 && image.height == 2 && conic_image_planes(&image) == 1u << CONIC_PLANE_RGBA);
  const float *rgba = image.planes[CONIC_PLANE_RGBA];
  for (int y = 0; rgba && y < 2; y++) {
    for (int c = 0; c < 3; c++)
      CHECK(rgba[4 * y + c] == expected[3 * y + c]);
    CHECK(rgba[4 * y + 3] == 1.0f);
  }
  conic_image_release(context, &image);
}

/* Files made by hand: the bottom row stands first, and the sign of the scale tells the order of the bytes. */
static void test_pfm_by_hand(conic_context *context) {
  static const char little[] = "PF\n1 2\n-1.0\n"
                               "\0\0\x80\x3f"
                               "\0\0\0\x40"
                               "\0\0\x40\x40"
                               "\0\0\x80\x40"
                               "\0\0\xa0\x40"
                               "\0\0\xc0\x40";
  static const char big[] = "PF 1\t2 +2.5e0\n"
                            "\x3f\x80\0\0"
                            "\x40\0\0\0"
                            "\x40\x40\0\0"
                            "\x40\x80\0\0"
                            "\x40\xa0\0\0"
                            "\x40\xc0\0\0";
  static const char grey[] = "Pf\n1 2\n-1\n"
                             "\0\0\x80\x3f"
                             "\0\0\0\x40";
  check_pfm(context, little, sizeof little - 1, (const float[]){4, 5, 6, 1, 2, 3});
  check_pfm(context, big, sizeof big - 1, (const float[]){4, 5, 6, 1, 2, 3});
  check_pfm(context, grey, sizeof grey - 1, (const float[]){2, 2, 2, 1, 1, 1});
}

static void test_pfm_refused(conic_context *context) {
  static const char *const files[] = {"PF",
                                      "PF\n",
                                      "PF\n0 1\n-1\n",
                                      "PF\n1 -1\n-1\n1234",
                                      "PF\n1 65536\n-1\n",
                                      "PF\n99999999999999999999 1\n-1\n",
                                      "PF\n1 1\n0.0\n123456789012",
                                      "PF\n1 1\nx\n123456789012",
                                      "PF\n1 1\n-1\n12345678901",
                                      "Pf\n65535 65535\n-1\n1234",
                                      "PF\n1 1 -1",
                                      "Pfx\n1 1\n-1\n1234"};
  conic_image image;
  for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
    write_bytes(in_folder("a.pfm"), files[i], strlen(files[i]));
    CHECK(conic_image_read(context, in_folder("a.pfm"), &image) == CONIC_ERROR_INPUT);
    CHECK(conic_image_planes(&image) == 0);
  }
}

/* Any lone plane: three channels as colour, numbers as floats, nothing as -1; and no number that a float has not. */
static void test_pfm_planes(conic_context *context) {
  conic_image image;
  size_t n_bytes;
  float samples[3];
  CHECK_OK(conic_image_allocate(context, 1, 3, 1u << CONIC_PLANE_ID, &image));
  uint32_t *ids = image.planes[CONIC_PLANE_ID];
  ids[0] = 1u << 24;
  ids[1] = CONIC_NO_ID;
  ids[2] = 7;
  CHECK_OK(conic_image_write(context, in_folder("a.pfm"), &image));
  unsigned char *bytes = read_bytes(in_folder("a.pfm"), &n_bytes);
  CHECK(n_bytes == 24 && memcmp(bytes, "Pf\n1 3\n-1.0\n", 12) == 0);
  memcpy(samples, bytes + 12, sizeof samples);
  conic_turn_words(samples, 3, 4);
  CHECK(samples[0] == 7.0f && samples[1] == -1.0f && samples[2] == 16777216.0f);
  free(bytes);
  ids[0]++;
  CHECK(conic_image_write(context, in_folder("b.pfm"), &image) == CONIC_ERROR_UNSUPPORTED);
  CHECK(access(in_folder("b.pfm"), F_OK) != 0);
  conic_image_release(context, &image);

  image = random_image(context, 2, 1, 1u << CONIC_PLANE_NORMAL);
  CHECK_OK(conic_image_write(context, in_folder("a.pfm"), &image));
  bytes = read_bytes(in_folder("a.pfm"), &n_bytes);
  conic_turn_words(bytes + 12, 6, 4);
  CHECK(n_bytes == 36 && memcmp(bytes, "PF\n", 3) == 0 &&
        memcmp(bytes + 12, image.planes[CONIC_PLANE_NORMAL], 24) == 0);
  free(bytes);
  conic_image_release(context, &image);
}

static void test_pfm_round_trip(conic_context *context) {
  conic_image image = random_image(context, 13, 7, 1u << CONIC_PLANE_RGBA), back;
  float *rgba = image.planes[CONIC_PLANE_RGBA];
  for (int i = 0; i < 13 * 7; i++)
    rgba[4 * i + 3] = 1.0f;
  CHECK_OK(conic_image_write(context, in_folder("a.PFM"), &image));
  CHECK_OK(conic_image_read(context, in_folder("a.PFM"), &back));
  CHECK(same_planes(&image, &back));
  conic_image_release(context, &image);
  conic_image_release(context, &back);

  conic_image depth = random_image(context, 5, 3, 1u << CONIC_PLANE_Z);
  size_t n_bytes;
  CHECK_OK(conic_image_write(context, in_folder("a.pfm"), &depth));
  unsigned char *bytes = read_bytes(in_folder("a.pfm"), &n_bytes);
  const char header[] = "Pf\n5 3\n-1.0\n";
  const size_t n_header = sizeof header - 1;
  CHECK(n_bytes == n_header + 60 && memcmp(bytes, header, n_header) == 0);
  conic_turn_words(bytes + n_header, 15, 4);
  if (n_bytes == n_header + 60)
    CHECK(memcmp(bytes + n_header, (float *)depth.planes[CONIC_PLANE_Z] + 10, 20) == 0); /* the bottom row first */
  free(bytes);
  conic_image_release(context, &depth);
}

/* What the caller asked for has no meaning. */
static void test_wrong_arguments(conic_context *context) {
  conic_image image = random_image(context, 4, 4, 1u << CONIC_PLANE_RGBA), none = {0};
  conic_image normals = random_image(context, 4, 4, 1u << CONIC_PLANE_NORMAL | 1u << CONIC_PLANE_Z);
  CHECK(conic_image_write(context, "", &image) == CONIC_ERROR_ARGUMENT);
  CHECK(conic_image_write(context, in_folder("noending"), &image) == CONIC_ERROR_ARGUMENT);
  CHECK(conic_image_write(context, in_folder(".exr/noending"), &image) == CONIC_ERROR_ARGUMENT);
  CHECK(conic_image_write(context, in_folder("a.pfm"), &none) == CONIC_ERROR_ARGUMENT);
  CHECK(conic_image_write(context, in_folder("a.pfm"), &normals) == CONIC_ERROR_ARGUMENT);
  const conic_status unknown = has_feature("OpenImageIO") ? CONIC_ERROR_ARGUMENT : CONIC_ERROR_UNSUPPORTED;
  const conic_status lacking = has_feature("libpng") ? CONIC_ERROR_ARGUMENT : unknown;
  CHECK(conic_image_write(context, in_folder("a.nosuchformat"), &image) == unknown);
  CHECK(conic_image_write(context, in_folder("a.term"), &image) == unknown);
  CHECK(conic_image_write(context, in_folder("a.null"), &image) == unknown);
  CHECK(conic_image_write(context, in_folder("a.png"), &normals) == lacking);
  CHECK(conic_image_check_output(context, "noending", 1u << CONIC_PLANE_RGBA) == CONIC_ERROR_ARGUMENT);
  CHECK(conic_image_check_output(context, "a.pfm", 1u << CONIC_PLANE_NORMAL | 2u) == CONIC_ERROR_ARGUMENT);
  CHECK_OK(conic_image_check_output(context, "a.pfm", 1u << CONIC_PLANE_NORMAL));
  CHECK(conic_image_check_output(context, "a.nosuchformat", 1u << CONIC_PLANE_RGBA) == unknown);
  CHECK(conic_image_check_output(context, "a.png", 1u << CONIC_PLANE_NORMAL) == lacking);
  CHECK_OK(conic_image_check_output(context, "a.pfm", 1u << CONIC_PLANE_Z));
  CHECK(empty_test_folder() == 0);
  conic_image_release(context, &image);
  conic_image_release(context, &normals);
}

#if !defined(_WIN32)

/* The endings that this build writes. */
static int writable_endings(const char *endings[8]) {
  static const char *const foreign[] = {"tif", "jpg", "hdr"};
  int n = 0;
  endings[n++] = "pfm";
  if (has_feature("OpenEXR"))
    endings[n++] = "exr";
  if (has_feature("libpng") || has_feature("OpenImageIO"))
    endings[n++] = "png";
  for (size_t i = 0; has_feature("OpenImageIO") && i < sizeof foreign / sizeof foreign[0]; i++)
    endings[n++] = foreign[i];
  return n;
}

/* A full disk, a missing folder, a folder in the way: IO, and nothing is left behind. */
static void test_write_failures(conic_context *context) {
  conic_image image = random_image(context, 200, 100, EVERY_PLANE);
  const char *endings[8];
  int n_endings = writable_endings(endings);
  struct rlimit limit, lower;
  char name[64];
  signal(SIGXFSZ, SIG_IGN);
  getrlimit(RLIMIT_FSIZE, &limit);
  lower = limit;
  lower.rlim_cur = 200; /* bytes: as if the disk were then full */
  for (int i = 0; i < n_endings; i++) {
    snprintf(name, sizeof name, "missing/a.%s", endings[i]);
    CHECK(conic_image_write(context, in_folder(name), &image) == CONIC_ERROR_IO);
    snprintf(name, sizeof name, "a.%s", endings[i]);
    setrlimit(RLIMIT_FSIZE, &lower);
    conic_status status = conic_image_write(context, in_folder(name), &image);
    setrlimit(RLIMIT_FSIZE, &limit);
    CHECK(status == CONIC_ERROR_IO);
    CHECK(empty_test_folder() == 0);
    if (access("/dev/full", W_OK) == 0 && symlink("/dev/full", in_folder(name)) == 0) {
      CHECK(conic_image_write(context, in_folder(name), &image) == CONIC_ERROR_IO);
      CHECK(empty_test_folder() == 1); /* the link itself */
    }
  }
  conic_image_release(context, &image);
}

#else

static void test_write_failures(conic_context *context) {
  (void)context; /* no disk can be made to look full */
}

#endif

/* A file that stood there before stays as it was when writing fails, and is replaced when it does not. */
static void test_replacing(conic_context *context) {
  conic_image image = random_image(context, 8, 8, 1u << CONIC_PLANE_Z);
  size_t n_bytes;
  write_bytes(in_folder("a.pfm"), "before", 6);
  conic_image wrong = image;
  wrong.planes[CONIC_PLANE_ID] = image.planes[CONIC_PLANE_Z];
  CHECK(conic_image_write(context, in_folder("a.pfm"), &wrong) == CONIC_ERROR_ARGUMENT);
  unsigned char *bytes = read_bytes(in_folder("a.pfm"), &n_bytes);
  CHECK(n_bytes == 6 && memcmp(bytes, "before", 6) == 0);
  free(bytes);
  CHECK_OK(conic_image_write(context, in_folder("a.pfm"), &image));
  bytes = read_bytes(in_folder("a.pfm"), &n_bytes);
  CHECK(n_bytes == 12 + 256);
  free(bytes);
  CHECK(empty_test_folder() == 1);
  conic_image_release(context, &image);
}

static void test_read_failures(conic_context *context) {
  conic_image image;
  CHECK(conic_image_read(context, in_folder("absent.exr"), &image) == CONIC_ERROR_INPUT);
  CHECK(conic_image_read(context, test_folder, &image) == CONIC_ERROR_INPUT);
  write_bytes(in_folder("a.exr"), "", 0);
  CHECK(conic_image_read(context, in_folder("a.exr"), &image) == CONIC_ERROR_INPUT);
  write_bytes(in_folder("a.png"), "ply\nformat ascii 1.0\n", 21);
  CHECK(conic_image_read(context, in_folder("a.png"), &image) == CONIC_ERROR_INPUT);
  const conic_status broken = has_feature("OpenImageIO") ? CONIC_ERROR_INPUT : CONIC_ERROR_UNSUPPORTED;
  write_bytes(in_folder("a.hdr"), "#?RADIANCE\nFORMAT=", 18);
  CHECK(conic_image_read(context, in_folder("a.hdr"), &image) == broken);
  CHECK(conic_image_planes(&image) == 0);
}

int main(void) {
  conic_context *context = check_context(2);
  open_test_folder();
  test_descriptions();
  test_allocation(context);
  test_allocation_limit();
  test_hash(context);
  test_pfm_by_hand(context);
  test_pfm_refused(context);
  test_pfm_round_trip(context);
  test_pfm_planes(context);
  empty_test_folder();
  test_wrong_arguments(context);
  test_write_failures(context);
  test_replacing(context);
  test_read_failures(context);
  close_test_folder();
  conic_context_destroy(context);
  return check_result();
}
