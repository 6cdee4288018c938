/* Pictures that become textures: no more memory than there may be, told by their headers; and nothing that may have no
 * end. */
#include <sys/stat.h>

#include "tests/support/image_fixture.h"

enum { SIDE = 512, TEXTURE_BYTES = SIDE * SIDE * 16 * 4 / 3 + 64, MOST_SEEN = 1 << 20 };

static char message[1024];
static size_t largest; /* allocation */

static void keep_last_message(void *cookie, conic_log_level level, const char *text) {
  (void)cookie;
  if (level == CONIC_LOG_ERROR)
    snprintf(message, sizeof message, "%s", text);
}

static void *note_size(void *cookie, size_t n_bytes) {
  (void)cookie;
  largest = n_bytes > largest ? n_bytes : largest;
  return malloc(n_bytes);
}

static void give_back(void *cookie, void *pointer) {
  (void)cookie;
  free(pointer);
}

static conic_context *open_context(size_t max_texture_bytes) {
  conic_context_options options;
  conic_context *context;
  conic_context_options_init(&options);
  CHECK(options.max_texture_bytes == (size_t)4 << 30);
  options.threads = 1;
  options.log = keep_last_message;
  options.allocate = note_size;
  options.release = give_back;
  options.max_texture_bytes = max_texture_bytes;
  CHECK_OK(conic_context_create(&options, &context));
  return context;
}

static void write_flat(const char *name) {
  conic_context *context = check_context(1);
  conic_image image;
  CHECK_OK(conic_image_allocate(context, SIDE, SIDE, 1u << CONIC_PLANE_RGBA, &image));
  for (size_t i = 0; i < (size_t)4 * SIDE * SIDE; i++)
    ((float *)image.planes[CONIC_PLANE_RGBA])[i] = 1.0f;
  CHECK_OK(conic_image_write(context, in_folder(name), &image));
  conic_image_release(context, &image);
  conic_context_destroy(context);
}

static void expect(conic_context *context, const char *name, conic_status expected, conic_texture **texture) {
  message[0] = '\0';
  conic_status status = conic_texture_read(context, in_folder(name), CONIC_WRAP_REPEAT, texture);
  if (status == expected && (status == CONIC_OK || strstr(message, "512 × 512 pixels takes 6 MiB")))
    return;
  fprintf(stderr, "%s: status %d: %s\n", name, (int)status, message);
  check_failures++;
}

/* Refused before it is decoded; textures count together, and those that are gone count no more. */
static void check_bound(const char *name) {
  conic_texture *one, *two;
  conic_context *context = open_context(TEXTURE_BYTES / 2);
  write_flat(name);
  largest = 0;
  expect(context, name, CONIC_ERROR_INPUT, &one);
  CHECK(largest < MOST_SEEN);
  conic_context_destroy(context);
  context = open_context(TEXTURE_BYTES * 3 / 2);
  for (int i = 0; i < 2; i++) {
    expect(context, name, CONIC_OK, &one);
    expect(context, name, CONIC_ERROR_INPUT, &two);
    conic_texture_destroy(one);
  }
  conic_context_destroy(context);
  context = open_context(0);
  expect(context, name, CONIC_OK, &one);
  conic_texture_destroy(one);
  conic_context_destroy(context);
}

#if !defined(_WIN32) /* where no such thing stands among files */

static void check_endless(conic_context *context) {
  conic_texture *texture;
  conic_image image;
  CHECK(mkfifo(in_folder("pipe.png"), 0600) == 0);
  const char *const paths[] = {"/dev/zero", "/dev/null", test_folder, in_folder("pipe.png")};
  for (size_t i = 0; i < sizeof paths / sizeof paths[0]; i++) {
    CHECK(conic_texture_read(context, paths[i], CONIC_WRAP_REPEAT, &texture) == CONIC_ERROR_INPUT && !texture);
    CHECK(strstr(message, i == 2 ? "a directory" : "no regular file"));
    CHECK(conic_image_read(context, paths[i], &image) == CONIC_ERROR_INPUT);
  }
}

#else

static void check_endless(conic_context *context) {
  (void)context;
}

#endif

/* A few bytes that OpenImageIO makes gigabytes of where it opens them: a JPEG whose scans may follow in any order, the
 * canvas of a GIF, and the three kinds of WebP. */
static void check_hasty(conic_context *context) {
  static const unsigned char jpeg[] = {0xff, 0xd8, 0xff, 0xe0, 0, 4, 1,    2, 0xff, 0xff, 0xc2, 0, 17, 8,
                                       0xff, 0xdc, 0xff, 0xdc, 3, 1, 0x22, 0, 2,    17,   0,    3, 17, 0,
                                       0xff, 0xda, 0,    12,   3, 1, 0,    2, 0,    3,    0,    0, 0,  0},
                             gif[] = {'G', 'I', 'F', '8', '9', 'a', 0xff, 0xff, 0xff, 0xff, 0x80, 0,
                                      0,   0,   0,   0,   1,   1,   1,    ',',  0,    0,    0,    0,
                                      1,   0,   1,   0,   0,   2,   2,    0x44, 1,    0,    ';'},
                             webp[][30] = {{"RIFF\x16\0\0\0WEBPVP8 \x0a\0\0\0\x10\0\0\x9d\x01\x2a\xff\x3f\xff\x3f"},
                                           {"RIFF\x16\0\0\0WEBPVP8L\x0a\0\0\0\x2f\xff\xff\xff\x0f"},
                                           {"RIFF\x16\0\0\0WEBPVP8X\x0a\0\0\0\x10\0\0\0\xfe\xff\0\xfe\xff\0"}};
  conic_image image;
  write_bytes(in_folder("a"), jpeg, sizeof jpeg);
  CHECK(conic_image_read(context, in_folder("a"), &image) == CONIC_ERROR_INPUT);
  CHECK(strstr(message, "65500 × 65500 pixels cannot be in a file"));
  write_bytes(in_folder("a"), gif, sizeof gif);
  CHECK(conic_image_read(context, in_folder("a"), &image) == CONIC_ERROR_INPUT);
  CHECK(strstr(message, "65535 × 65535 pixels cannot be in a file"));
  for (int i = 0; i < 3; i++) {
    write_bytes(in_folder("a"), webp[i], sizeof webp[i]);
    CHECK(conic_image_read(context, in_folder("a"), &image) == CONIC_ERROR_INPUT);
    CHECK(strstr(message, i == 0   ? "16383 × 16383 pixels cannot be"
                          : i == 1 ? "16384 × 16384 pixels cannot be"
                                   : "65535 × 65535 pixels cannot be"));
  }
}

int main(void) {
  conic_context *context = open_context((size_t)1 << 30);
  open_test_folder();
  check_bound("a.pfm");
  if (has_feature("libpng"))
    check_bound("a.png");
  if (has_feature("OpenEXR"))
    check_bound("a.exr");
  if (has_feature("OpenImageIO")) {
    check_bound("a.tif");
    check_bound("a.jpg");
    check_hasty(context);
  } else
    fprintf(stderr, "skipped: OpenImageIO's formats\n");
  check_endless(context);
  close_test_folder();
  conic_context_destroy(context);
  return check_result();
}
