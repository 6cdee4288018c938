/* Files of Gaussians: small ones of which every number is known, and every format's round trip. */
#include "core/base/byte_order.h"
#include "core/base/gaussian.h"
#include "gaussians/formats/codebook.h"
#include "gaussians/formats/webp_plane.h"
#include "gaussians/scene/activation.h"
#include "tests/support/gaussian_fixture.h"
#include "tests/support/mesh_file.h"

static float number_at(const void *numbers, size_t i) {
  return ((const float *)numbers)[i];
}

/* Numbers with far strays are met by their table's values as well as by 256 equal steps in the worst case, and far
 * better on the whole, where few values go to the strays. */
static void check_codebook(conic_context *context, size_t n_strays, double most_of_uniform) {
  enum { N = 20000 };
  static float numbers[N];
  float codebook[CONIC_CODES];
  double squares = 0.0, greatest = 0.0, uniform = 0.0, step = 20.0 / 255.0;
  uint64_t state = 5;
  for (size_t i = 0; i < N; i++)
    numbers[i] = (float)(i < 2          ? 20.0 * (double)i - 15.0
                         : i < n_strays ? 20.0 * random_unit(&state) - 15.0
                                        : random_unit(&state) * random_unit(&state) - random_unit(&state));
  numbers[N / 2] = (float)NAN;
  CHECK_OK(conic_codebook_make(context, numbers, number_at, N, codebook));
  for (int code = 1; code < CONIC_CODES; code++)
    CHECK(codebook[code - 1] <= codebook[code]);
  for (size_t i = 0; i < N; i++) {
    double value = (double)numbers[i], off = fabs((double)codebook[conic_codebook_find(codebook, numbers[i])] - value);
    double off_uniform = fabs(floor((value + 15.0) / step + 0.5) * step - 15.0 - value);
    if (i == N / 2)
      continue;
    greatest = off > greatest ? off : greatest;
    squares += off * off;
    uniform += off_uniform * off_uniform;
  }
  CHECK(greatest <= 0.5 * step + 1e-6);
  CHECK(squares < most_of_uniform * uniform);
}

static void test_codebook(conic_context *context) {
  check_codebook(context, 100, 0.1);
  check_codebook(context, 4000, 0.9);
}

static void test_splat(conic_context *context) {
  unsigned char row[32] = {0, 0, 0x80, 0x3f, 0, 0, 0,    0x40, 0, 0,   0x40, 0x40, 0, 0,   0x80, 0x3f,
                           0, 0, 0,    0x3f, 0, 0, 0x80, 0x3e, 0, 255, 51,   102,  0, 128, 128,  192};
  conic_gaussians scene = gaussians_read_again(context, files_write_bytes("a.splat", row, sizeof row), 1);
  CHECK(scene.count == 1 && scene.sh_degree == 0 && scene.position[2][0] == 3.0f && scene.scale[1][0] == 0.5f);
  CHECK_NEAR(0.5 + CONIC_SH_CONSTANT * (double)scene.sh[0], 0.0, 1e-7);
  CHECK_NEAR(0.5 + CONIC_SH_CONSTANT * (double)scene.sh[1], 1.0, 1e-7);
  CHECK(scene.opacity[0] == 0.4f && scene.rotation[0][0] == -1.0f && scene.rotation[3][0] == 0.5f);
  conic_gaussians_release(context, &scene);
  const char *path = files_write_bytes("a.splat", row, 31);
  files_check_failed("31 bytes", conic_gaussians_read(context, path, NULL, &scene), "a.splat", "32 bytes", NULL);
  CHECK(unlink(path) == 0);
}

static void write_webp(conic_context *context, const char *name, const unsigned char *pixels, size_t width) {
  const size_t size[2] = {width, 1};
  unsigned char *bytes;
  size_t n;
  CHECK_OK(conic_webp_encode(context, pixels, size, &bytes, &n));
  files_write_bytes(name, bytes, n);
  conic_memory_release(context, bytes);
}

/* Version 1 in a folder: codes are steps between two values of a channel, and the opacity's between logits. */
static void test_old_sog(conic_context *context) {
  static const char *const names[] = {"l.webp", "u.webp", "q.webp", "s.webp", "c.webp", "n.webp", "i.webp"};
  static const char meta[] =
      "{\"means\":{\"shape\":[2,3],\"dtype\":\"float32\",\"mins\":[0,-1,0],\"maxs\":[1,1,0],\"files\":[\"l.webp\","
      "\"u.webp\"]},\"scales\":{\"mins\":[-4,-3,-2],\"maxs\":[0,-1,-1],\"files\":[\"s.webp\"]},\"quats\":{\"files\":"
      "[\"q.webp\"]},\"sh0\":{\"mins\":[-1,0,1,-2],\"maxs\":[1,2,3,2],\"files\":[\"c.webp\"]},\"shN\":{\"shape\":[2,9]"
      ",\"mins\":-0.5,\"maxs\":0.5,\"quantization\":8,\"files\":[\"n.webp\",\"i.webp\"]}}";
  static const unsigned char pixels[7][8] = {
      {0, 255, 0, 255, 255, 0, 7, 255},  {0, 255, 0, 255, 255, 0, 7, 255}, {128, 128, 128, 252, 128, 255, 128, 255},
      {0, 51, 255, 255, 255, 0, 0, 255}, {0, 255, 51, 0, 255, 0, 0, 255},  {0},
      {0, 0, 0, 255, 1, 0, 0, 255}};
  unsigned char centroids[256 * 4] = {0};
  conic_gaussians scene;
  if (!gaussians_have(CONIC_GAUSSIANS_SOG))
    return;
  for (size_t i = 0; i < 2 * 3 * 4; i++)
    centroids[i] = i < 12 ? 0 : i % 4 == 1 ? 255 : 51;
  for (int i = 0; i < 7; i++)
    write_webp(context, names[i], i == 5 ? centroids : pixels[i], i == 5 ? 192 : 2);
  scene = gaussians_read_again(context, files_write("meta.json", meta), 1);
  CHECK(scene.count == 2 && scene.sh_degree == 1 && scene.kind == CONIC_GAUSSIANS_SOG);
  CHECK(scene.position[0][0] == 0.0f && scene.position[2][0] == 0.0f);
  CHECK_NEAR((double)scene.position[0][1], exp(1.0) - 1.0, 1e-6);
  CHECK_NEAR((double)scene.position[1][1], 1.0 - exp(1.0), 1e-6);
  CHECK(scene.log_scale[0][0] == -4.0f && scene.log_scale[1][0] == -2.6f && scene.log_scale[2][0] == -1.0f);
  CHECK(scene.log_scale[0][1] == 0.0f && scene.scale[0][1] == 1.0f);
  CHECK(scene.sh[0] == -1.0f && scene.sh[1] == 2.0f && scene.sh[2] == 1.4f && scene.sh[12] == 1.0f);
  CHECK(scene.logit_opacity[0] == -2.0f && scene.logit_opacity[1] == 2.0f);
  CHECK_NEAR((double)scene.opacity[1], 1.0 / (1.0 + exp(-2.0)), 1e-7);
  CHECK(scene.sh[3] == -0.5f && scene.sh[12 + 3] == -0.3f && scene.sh[12 + 4] == 0.5f);
  conic_gaussians_release(context, &scene);
  write_webp(context, "n.webp", centroids, 256); /* of no degree */
  const char *path = files_write("meta.json", meta);
  files_check_failed("256 wide", conic_gaussians_read(context, path, NULL, &scene), "64 centroids wide", NULL);
  CHECK(unlink(path) == 0);
  for (int i = 0; i < 7; i++)
    CHECK(unlink(files_path(names[i])) == 0);
}

/* Streamed .sog: the files of level 0, each once, whichever leaves name them. */
static void test_sog_levels(conic_context *context) {
  static const char *const names[] = {"a.sog", "b.sog", "c.sog"};
  static const char format[] =
      "{\"lodLevels\":2,\"tree\":{\"bound\":{},\"children\":[{\"lods\":{\"1\":{\"file\":2,\"offset\":0,\"count\":1},"
      "\"0\":"
      "{\"file\":1,\"offset\":2,\"count\":1}}},{\"lods\":{\"%s\":{\"file\":%s,\"offset\":0,\"count\":5}}},{"
      "\"children\":"
      "[{\"lods\":{\"0\":{\"file\":1,\"offset\":0,\"count\":2}}}]}]},\"filenames\":[\"a.sog\",\"%s\",\"c.sog\"]}";
  static const struct {
    const char *level, *file, *name, *what;
  } cases[] = {{"0", "0", "b.sog", NULL},        {"0", "2", "b.sog", "several kinds"},
               {"0", "3", "b.sog", "not named"}, {"0", "-1", "b.sog", "not named"},
               {"0", "0", NULL, "../"},          {"0", "0", "/b.sog", "/b.sog"},
               {"0", "0", "d.sog", "d.sog"}};
  conic_gaussians scene, parts[3];
  char text[sizeof format + FOLDER_ROOM + 64], outside[FOLDER_ROOM + 16];
  conic_gaussians_write_options options;
  conic_gaussians_write_options_init(&options);
  options.kind = CONIC_GAUSSIANS_SOG;
  if (!gaussians_have(CONIC_GAUSSIANS_SOG))
    return;
  snprintf(outside, sizeof outside, "..%s/b.sog", strrchr(files_folder, '/')); /* which is there */
  for (int i = 0; i < 3; i++) {
    scene = gaussians_random(context, i == 0 ? 5 : 3, i == 2 ? 0 : 1, 0);
    CHECK_OK(conic_gaussians_write(context, files_path(names[i]), &scene, &options));
    CHECK_OK(conic_gaussians_read(context, files_path(names[i]), NULL, &parts[i]));
    conic_gaussians_release(context, &scene);
  }
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    snprintf(text, sizeof text, format, cases[i].level, cases[i].file, cases[i].name ? cases[i].name : outside);
    const char *path = files_write("lod-meta.json", text);
    conic_status status = conic_gaussians_read(context, i ? path : files_folder, NULL, &scene);
    if (cases[i].what)
      files_check_failed(cases[i].what, status, cases[i].what, NULL);
    else
      CHECK(status == CONIC_OK && scene.count == 8 && scene.sh_degree == 1 && scene.kind == CONIC_GAUSSIANS_SOG);
    for (size_t k = 0; k < 8 && status == CONIC_OK; k++) {
      const conic_gaussians *part = &parts[k < 5 ? 0 : 1];
      size_t at = k < 5 ? k : k - 5;
      CHECK(scene.position[1][k] == part->position[1][at] && scene.opacity[k] == part->opacity[at]);
      CHECK(memcmp(scene.sh + 12 * k, part->sh + 12 * at, 12 * sizeof(float)) == 0);
    }
    conic_gaussians_release(context, &scene);
    CHECK(unlink(path) == 0);
  }
  const char *path = files_write("lod-meta.json", "{\"lodLevels\":1,\"tree\":{},\"filenames\":[]}");
  files_check_failed("no leaf", conic_gaussians_read(context, path, NULL, &scene), "level 0", NULL);
  CHECK(unlink(path) == 0);
  for (int i = 0; i < 3; i++) {
    conic_gaussians_release(context, &parts[i]);
    CHECK(unlink(files_path(names[i])) == 0);
  }
}

/* All levels of compression, and what no file can be. */
static void test_ksplat(conic_context *context) {
  static unsigned char bytes[KSPLAT_ROOM];
  conic_gaussians scene;
  for (int level = 0; level < 3; level++) {
    size_t n = gaussians_put_ksplat(level, bytes);
    scene = gaussians_read_again(context, files_write_bytes("a.bin", bytes, n), 0);
    CHECK(scene.count == 4 && scene.sh_degree == 1 && scene.kind == CONIC_GAUSSIANS_KSPLAT);
    for (size_t i = 0; i < 4 && scene.count == 4; i++) {
      CHECK_NEAR((double)scene.position[0][i], (double)i, 1e-6);
      CHECK_NEAR((double)scene.position[1][i], 2.0, 1e-6);
      CHECK_NEAR((double)scene.position[2][i], -0.5, 1e-6);
      CHECK(scene.scale[0][i] == 0.5f && scene.scale[2][i] == 2.0f && scene.rotation[1][i] == -1.0f);
      CHECK_NEAR(0.5 + CONIC_SH_CONSTANT * (double)scene.sh[12 * i + 1], 0.2, 1e-6);
      CHECK(scene.opacity[i] == 0.4f);
      for (size_t k = 0; k < 9; k++) /* of the file: three of red first */
        CHECK_NEAR((double)scene.sh[12 * i + 3 + 3 * (k % 3) + k / 3], i == 3 ? 0.0 : (double)k / 8.0 - 0.5,
                   level == 2 ? 0.008 : 0.0);
    }
    conic_gaussians_release(context, &scene);
    const char *path = files_write_bytes("a.ksplat", bytes, n - 1);
    files_check_failed("cut", conic_gaussians_read(context, path, NULL, &scene), "a.ksplat", "ends within", NULL);
    CHECK(unlink(path) == 0);
  }
  static const struct {
    size_t at;
    uint32_t value;
    const char *what;
  } cases[] = {{0, 2, "version"},         {20, 3, "level"},          {4, 9, "sections"},
               {4136, 4, "section that"}, {4096, 5, "section that"}, {4116, 8, "its buckets"},
               {4104, 1, "buckets hold"}, {4128, 7, "its buckets"}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    size_t n = gaussians_put_ksplat(1, bytes);
    conic_store_32(bytes + cases[i].at, cases[i].value);
    const char *path = files_write_bytes("a.ksplat", bytes, n);
    files_check_failed(cases[i].what, conic_gaussians_read(context, path, NULL, &scene), cases[i].what, NULL);
    CHECK(unlink(path) == 0);
  }
}

/* Versions 1 and 3 unpacked: half floats and three bytes of rotation; fixed point and three of ten bits. */
static void test_spz(conic_context *context) {
  static const unsigned char old[] = {'N', 'G',  'S', 'P',  1, 0,    0,   0, 1,   0,   0,   0, 0,   0, 1,   0,
                                      0,   0x3c, 0,   0xc0, 0, 0x38, 255, 0, 255, 102, 160, 0, 255, 0, 128, 255};
  static const unsigned char later[] = {'N', 'G', 'S', 'P', 3, 0,    0,    0,    1,   0,   0,   0,   1,   8,   0,
                                        0,   0,   1,   0,   0, 0xff, 0xff, 0x80, 0,   0,   51,  127, 128, 255, 160,
                                        176, 144, 0,   0,   0, 0xc0, 0,    128,  255, 192, 128, 128, 128, 128, 129};
  conic_gaussians scene = gaussians_read_again(context, files_write_bytes("a.spz", old, sizeof old), 1);
  CHECK(scene.position[0][0] == 1.0f && scene.position[1][0] == -2.0f && scene.position[2][0] == 0.5f);
  CHECK(scene.opacity[0] == 1.0f && scene.is_antialiased && strcmp(scene.frame, "rub") == 0);
  CHECK_NEAR((double)scene.sh[1], 0.5 / 0.15, 1e-6);
  CHECK(scene.log_scale[0][0] == 0.0f && scene.log_scale[1][0] == -10.0f && scene.log_scale[2][0] == 255.0f / 16 - 10);
  CHECK(scene.rotation[1][0] == -1.0f && scene.rotation[0][0] == 0.0f && scene.rotation[3][0] == 1.0f);
  conic_gaussians_release(context, &scene);

  scene = gaussians_read_again(context, files_write_bytes("b.spz", later, sizeof later), 1);
  CHECK(scene.sh_degree == 1 && scene.position[0][0] == 1.0f && scene.position[1][0] == -0x1p-8f * 256.0f);
  CHECK(scene.position[2][0] == 0.5f && scene.opacity[0] == 0.2f);
  CHECK(scene.rotation[0][0] == 1.0f && scene.rotation[2][0] == 0.0f); /* w is left out */
  CHECK(scene.sh[3] == -1.0f && scene.sh[4] == 0.0f && scene.sh[5] == 127.0f / 128.0f && scene.sh[6] == 0.5f);
  conic_gaussians_release(context, &scene);
}

/* One Gaussian in a chunk: at its low end, its high one, and a third of the way. */
static void test_compressed(conic_context *context) {
  static const char header[] =
      "ply\nformat binary_little_endian 1.0\ncomment SplatRenderMode: mip\nelement chunk 1\nproperty float min_x\n"
      "property float min_y\nproperty float min_z\nproperty float max_x\nproperty float max_y\nproperty float max_z\n"
      "property float min_scale_x\nproperty float min_scale_y\nproperty float min_scale_z\n"
      "property float max_scale_x\nproperty float max_scale_y\nproperty float max_scale_z\nelement vertex 1\n"
      "property uint packed_position\nproperty uint packed_rotation\nproperty uint packed_scale\n"
      "property uint packed_color\nelement sh 1\n";
  unsigned char bytes[4096];
  size_t n = sizeof header - 1;
  memcpy(bytes, header, n);
  for (int i = 0; i < 9; i++)
    n += (size_t)snprintf((char *)bytes + n, 64, "property uchar f_rest_%d\n", i);
  n += (size_t)snprintf((char *)bytes + n, 64, "end_header\n");
  const float bounds[12] = {0, 0, 0, 1, 2, 3, -8, -8, -8, 0, 0, 0};
  const uint32_t packed[4] = {1023u << 11 | 682u, 2u << 30 | 512u << 20 | 512u << 10 | 1023u, 2047u << 21,
                              255u << 24 | 51u << 8 | 128u};
  const unsigned char harmonics[9] = {0, 128, 255, 64, 64, 64, 192, 192, 192};
  for (size_t i = 0; i < 12; i++)
    conic_store_float(bytes + n + 4 * i, bounds[i]);
  for (size_t i = 0; i < 4; i++)
    conic_store_32(bytes + n + 48 + 4 * i, packed[i]);
  memcpy(bytes + n + 64, harmonics, 9);
  conic_gaussians scene = gaussians_read_again(context, files_write_bytes("c.ply", bytes, n + 73), 0);
  CHECK(scene.kind == CONIC_GAUSSIANS_COMPRESSED_PLY && scene.is_antialiased && scene.sh_degree == 1);
  CHECK(scene.position[0][0] == 0.0f && scene.position[1][0] == 2.0f);
  CHECK_NEAR((double)scene.position[2][0], 3.0 * 682 / 2047, 1e-6);
  CHECK(scene.scale[0][0] == 1.0f && scene.scale[1][0] == (float)exp(-8.0));
  CHECK_NEAR((double)scene.rotation[3][0], sqrt(0.5), 1e-6);
  CHECK_NEAR((double)scene.rotation[2][0], sqrt(0.5), 1e-3); /* what is left out */
  CHECK_NEAR(0.5 + CONIC_SH_CONSTANT * (double)scene.sh[2], 0.2, 1e-6);
  CHECK_NEAR((double)scene.opacity[0], 128.0 / 255.0, 1e-7);
  CHECK(scene.sh[3] == -4.0f && scene.sh[6] == 1.0f / 64.0f && scene.sh[9] == 4.0f);
  CHECK(scene.sh[4] == (64.5f / 256.0f - 0.5f) * 8.0f);
  conic_gaussians_release(context, &scene);
}

/* A box of one Gaussian in base64 under two nodes, the inner of which turns x to y; names and logarithms of a draft. */
static void test_gltf(conic_context *context) {
  static const char format[] =
      "{\"asset\":{\"version\":\"2.0\"},\"extensionsUsed\":[\"KHR_gaussian_splatting\"],\"nodes\":[{\"children\":[1],"
      "\"translation\":[10,0,0]},{\"mesh\":0,\"scale\":[2,2,2],\"rotation\":[0,0,%s,0.70710678118654757]}],"
      "\"meshes\":[{\"primitives\":[{\"mode\":0,\"attributes\":{\"POSITION\":0,\"COLOR_0\":1,\"_ROTATION\":2,"
      "\"_SCALE\":3},\"extensions\":{\"KHR_gaussian_splatting\":{\"colorSpace\":\"lin_rec709_display\"}}}]}],"
      "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":1,\"type\":\"VEC3\"},"
      "{\"bufferView\":0,\"byteOffset\":12,\"componentType\":5121,\"normalized\":true,\"count\":1,\"type\":\"VEC4\"},"
      "{\"bufferView\":0,\"byteOffset\":16,\"componentType\":5120,\"normalized\":true,\"count\":1,\"type\":\"VEC4\"},"
      "{\"bufferView\":0,\"byteOffset\":20,\"componentType\":5126,\"count\":%d,\"type\":\"VEC3\"}],"
      "\"bufferViews\":[{\"buffer\":0,\"byteLength\":32}],\"buffers\":[{\"byteLength\":32,\"uri\":"
      /* 1, 0, 0; 0, 51, 255, 102; 0, 0, 0, 127; 0, -1, -2 */
      "\"data:application/octet-stream;base64,AACAPwAAAAAAAAAAADP/ZgAAAH8AAAAAAACAvwAAAMA=\"}]}";
  char text[sizeof format + 64];
  snprintf(text, sizeof text, format, "0.70710678118654757", 1);
  conic_gaussians scene = gaussians_read_again(context, files_write("a.gltf", text), 0);
  CHECK(scene.count == 1 && scene.is_linear && strcmp(scene.frame, "luf") == 0);
  CHECK_NEAR((double)scene.position[0][0], 10.0, 1e-6);
  CHECK_NEAR((double)scene.position[1][0], 2.0, 1e-6);
  CHECK_NEAR((double)scene.scale[0][0], 2.0, 1e-6);
  CHECK_NEAR((double)scene.scale[2][0], 2.0 * exp(-2.0), 1e-6);
  CHECK_NEAR((double)scene.rotation[0][0], sqrt(0.5), 1e-6);
  CHECK_NEAR((double)scene.rotation[3][0], sqrt(0.5), 1e-6);
  CHECK_NEAR((double)scene.opacity[0], 0.4, 1e-6);
  CHECK_NEAR(0.5 + CONIC_SH_CONSTANT * (double)scene.sh[1], 0.2, 1e-6);
  conic_gaussians_release(context, &scene);
  snprintf(text, sizeof text, format, "0.70710678118654757", 2);
  const char *path = files_write("a.gltf", text);
  files_check_failed("two scales", conic_gaussians_read(context, path, NULL, &scene), "a.gltf", "buffer", NULL);
  CHECK(unlink(path) == 0);
}

/* A node that mirrors its Gaussians is refused; what is not known of them is told. */
static void test_gltf_told(conic_context *context) {
  static const char format[] =
      "{\"nodes\":[{\"mesh\":0,\"scale\":[%s]}],\"meshes\":[{\"primitives\":[{\"mode\":0,\"attributes\":{\"POSITION\":"
      "0,"
      "\"COLOR_0\":1,\"_ROTATION\":1,\"_SCALE\":0},\"extensions\":{\"KHR_gaussian_splatting\":{\"%s\":\"%s\"}}}]}],"
      "\"accessors\":[{\"componentType\":5126,\"count\":1,\"type\":\"VEC3\"},{\"componentType\":5126,\"count\":1,"
      "\"type\":\"VEC4\"}]}";
  static const char *const cases[][4] = {{"1,1,1", "kernel", "ellipse", NULL},
                                         {"1,1,1", "kernel", "box", "the kernel box"},
                                         {"1,1,1", "projection", "tangential", "the projection tangential"},
                                         {"1,1,1", "sortingMethod", "none", "the sorting method none"},
                                         {"1,1,1", "colorSpace", "lin_rec709_display", NULL},
                                         {"1,1,1", "colorSpace", "acescg", "the colour space acescg"},
                                         {"1,-2,1", "kernel", "ellipse", NULL}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    conic_gaussians scene;
    char text[sizeof format + 64];
    snprintf(text, sizeof text, format, cases[i][0], cases[i][1], cases[i][2]);
    const char *path = files_write("a.gltf", text);
    files_warning[0] = 0;
    conic_status status = conic_gaussians_read(context, path, NULL, &scene);
    if (cases[i][0][2] == '-')
      files_check_failed("mirrored", status, "a.gltf", "mirrors", NULL);
    else
      CHECK(status == CONIC_OK && scene.count == 1);
    CHECK(cases[i][3] ? strstr(files_warning, cases[i][3]) != NULL : files_warning[0] == 0);
    conic_gaussians_release(context, &scene);
    CHECK(unlink(path) == 0);
  }
}

/* An .spz within a glTF is what it is alone, where the node puts it. */
static void test_gltf_packed(conic_context *context) {
  static const char *const extensions[] = {
      "\"KHR_gaussian_splatting\":{\"extensions\":{\"KHR_gaussian_splatting_compression_spz\":{\"bufferView\":0}}}",
      "\"KHR_gaussian_splatting\":{\"extensions\":{\"KHR_gaussian_splatting_compression_spz_2\":{\"bufferView\":0}}}",
      "\"KHR_spz_gaussian_splats_compression\":{\"bufferView\":0}"};
  static mesh_file file;
  conic_gaussians scene = gaussians_random(context, 5, 1, 0), alone, packed;
  conic_gaussians_write_options options;
  unsigned char *bytes;
  conic_gaussians_write_options_init(&options);
  options.kind = CONIC_GAUSSIANS_SPZ;
  if (!gaussians_have(CONIC_GAUSSIANS_SPZ)) {
    conic_gaussians_release(context, &scene);
    return;
  }
  const char *path = files_path("a.spz");
  CHECK_OK(conic_gaussians_write(context, path, &scene, &options));
  CHECK_OK(conic_gaussians_read(context, path, NULL, &alone));
  size_t n = files_read(path, &bytes);
  CHECK(unlink(path) == 0);
  for (size_t i = 0; i < sizeof extensions / sizeof *extensions; i++) {
    file.n = 0;
    mesh_text(
        &file,
        "{\"nodes\":[{\"mesh\":0,\"translation\":[1,0,0]}],\"meshes\":[{\"primitives\":[{\"mode\":0,"
        "\"attributes\":{},\"extensions\":{%s}}]}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":%zu}],\"buffers\":"
        "[{\"byteLength\":%zu,\"uri\":\"data:;base64,",
        extensions[i], n, n);
    mesh_base64(&file, bytes, n);
    mesh_text(&file, "\"}]}");
    path = files_write_bytes("a.gltf", file.bytes, file.n);
    CHECK_OK(conic_gaussians_read(context, path, NULL, &packed));
    CHECK(packed.count == 5 && packed.sh_degree == 1 && strcmp(packed.frame, "luf") == 0);
    for (size_t k = 0; k < 5 && packed.count == 5; k++) {
      CHECK_NEAR((double)packed.position[0][k], (double)alone.position[0][k] + 1.0, 1e-6);
      CHECK(packed.scale[1][k] == alone.scale[1][k] && packed.opacity[k] == alone.opacity[k]);
      CHECK(packed.rotation[2][k] == alone.rotation[2][k] && packed.sh[12 * k + 7] == alone.sh[12 * k + 7]);
    }
    conic_gaussians_release(context, &packed);
    CHECK(unlink(path) == 0);
  }
  free(bytes);
  conic_gaussians_release(context, &alone);
  conic_gaussians_release(context, &scene);
}

/* What each format may lose of gaussians_random's: half a step of its numbers. */
typedef struct format_bounds {
  double position, scale, rotation_deg, opacity, color, harmonics;
} format_bounds;

static const format_bounds bounds[CONIC_N_GAUSSIAN_KINDS] = {
    [CONIC_GAUSSIANS_PLY] = {0, 3e-7, 1e-6, 2e-7, 0, 0},
    [CONIC_GAUSSIANS_COMPRESSED_PLY] = {2.1e-3, 2e-3, 0.2, 1.97e-3, 2e-3, 0.0157},
    [CONIC_GAUSSIANS_SPLAT] = {0, 0, 0.9, 1.97e-3, 2e-3, 1},
    [CONIC_GAUSSIANS_SPZ] = {0.5 / 4096 + 1e-9, 0.032, 0.25, 1.97e-3, 3.7e-3, 0.5 / 128},
    [CONIC_GAUSSIANS_SOG] = {1e-4, 0.06, 0.9, 1.97e-3, 4e-3, 6e-3},
    [CONIC_GAUSSIANS_GLTF] = {0, 0, 1e-5, 0, 0, 0},
    [CONIC_GAUSSIANS_GLB] = {0, 0, 1e-5, 0, 0, 0},
};

static void check_bounds(const char *name, const conic_gaussians_differences *apart, const format_bounds *bound) {
  int before = check_failures;
  CHECK(apart->position <= bound->position && apart->scale <= bound->scale && apart->opacity <= bound->opacity);
  CHECK(apart->rotation_deg <= bound->rotation_deg && apart->color <= bound->color);
  CHECK(apart->harmonics <= bound->harmonics);
  if (check_failures > before)
    fprintf(stderr, "%s: %g %g %g %g %g %g\n", name, apart->position, apart->scale, apart->rotation_deg, apart->opacity,
            apart->color, apart->harmonics);
}

/* Written and read, a scene is what it was but for those steps; and written again, the same to the bit, but for .sog,
 * whose steps are chosen by the numbers. */
static void test_round_trip(conic_context *context, conic_gaussian_kind kind, size_t n, int degree, unsigned fields) {
  static const char *const names[] = {"t.ply", "t.compressed.ply", "t.splat", "t.spz", "t.sog", "t.gltf", "t.glb"};
  conic_gaussians scene = gaussians_random(context, n, degree, fields);
  conic_gaussians_write_options options;
  conic_gaussians_differences apart;
  conic_gaussian_kind found = CONIC_GAUSSIANS_PLY;
  conic_gaussians_write_options_init(&options);
  options.kind = kind;
  CHECK(conic_gaussians_find_kind(names[kind], &found) && found == kind);
  scene.is_antialiased = kind != CONIC_GAUSSIANS_SPLAT && kind < CONIC_GAUSSIANS_GLTF;
  CHECK_OK(conic_gaussians_write(context, files_path(names[kind]), &scene, &options));
  CHECK(conic_gaussians_is_file(context, files_path(names[kind])));
  conic_gaussians again = gaussians_read_again(context, files_path(names[kind]), 1), third;
  int most = conic_gaussian_kind_sh_degree(kind);
  CHECK(again.kind == kind && again.sh_degree == (degree < most ? degree : most));
  CHECK(again.is_antialiased == scene.is_antialiased);
  CHECK(strcmp(again.frame, conic_gaussian_kind_frame(kind)) == 0);
  CHECK_OK(conic_gaussians_compare(context, &scene, &again, &apart));
  if (degree <= most)
    check_bounds(names[kind], &apart, &bounds[kind]);
  CHECK_OK(conic_gaussians_write(context, files_path(names[kind]), &again, &options));
  third = gaussians_read_again(context, files_path(names[kind]), 1);
  CHECK_OK(conic_gaussians_compare(context, &again, &third, &apart));
  CHECK(apart.is_same || kind == CONIC_GAUSSIANS_SOG);
  conic_gaussians_release(context, &scene);
  conic_gaussians_release(context, &again);
  conic_gaussians_release(context, &third);
}

static void test_round_trips(conic_context *context) {
  for (int kind = 0; kind < CONIC_N_GAUSSIAN_KINDS; kind++) {
    if (!gaussians_have((conic_gaussian_kind)kind)) {
      fprintf(stderr, "%s is not in this build\n", conic_gaussian_kind_name((conic_gaussian_kind)kind));
      continue;
    }
    for (int degree = 0; degree <= CONIC_MAX_SH_DEGREE; degree++)
      test_round_trip(context, (conic_gaussian_kind)kind, 70, degree, 0);
    test_round_trip(context, (conic_gaussian_kind)kind, 600, 2, CONIC_GAUSSIANS_HALF);
  }
  test_round_trip(context, CONIC_GAUSSIANS_PLY, 3, 1, CONIC_GAUSSIANS_2D);
}

/* Numbers that no Gaussian should have come back, where files keep floats. */
static void test_odd_numbers(conic_context *context) {
  conic_gaussians scene = gaussians_random(context, 6, 0, 0), again;
  conic_gaussians_write_options options;
  conic_gaussians_differences apart;
  const float odd[] = {(float)NAN, (float)INFINITY, -(float)INFINITY, 0.0f, 1e-9f, 1e9f};
  for (int i = 0; i < 6; i++) {
    scene.position[0][i] = scene.sh[3 * i] = odd[i];
    scene.scale[1][i] = odd[i] < 0.0f ? 1.0f : odd[i];
    scene.rotation[2][i] = odd[i];
    scene.opacity[i] = i == 3 ? 0.0f : i == 4 ? 1.0f : 0.5f;
  }
  for (int kind = 0; kind < CONIC_N_GAUSSIAN_KINDS; kind++) {
    conic_gaussians_write_options_init(&options);
    options.kind = (conic_gaussian_kind)kind;
    if (!gaussians_have(options.kind))
      continue;
    conic_status status = conic_gaussians_write(context, files_path("odd.splat"), &scene, &options);
    CHECK(status == (kind == CONIC_GAUSSIANS_SPZ ? CONIC_ERROR_INPUT : CONIC_OK)); /* 1e9 does not fit */
    if (status != CONIC_OK)
      continue;
    again = gaussians_read_again(context, files_path("odd.splat"), 0);
    CHECK_OK(conic_gaussians_compare(context, &scene, &again, &apart));
    if (kind == CONIC_GAUSSIANS_PLY)
      CHECK(apart.position == 0.0 && apart.color == 0.0 && apart.opacity == 0.0 && apart.scale < 1e-5);
    conic_gaussians_release(context, &again);
  }
  conic_gaussians_release(context, &scene);
}

int main(void) {
  conic_context *context = files_context();
  test_codebook(context);
  test_splat(context);
  test_ksplat(context);
  test_old_sog(context);
  test_sog_levels(context);
  test_spz(context);
  test_compressed(context);
  test_gltf(context);
  test_gltf_told(context);
  test_gltf_packed(context);
  test_round_trips(context);
  test_odd_numbers(context);
  files_end(context);
  return check_result();
}
