/* A file of version 2, which tells nothing of groups, is drawn as its samples: as what is drawn of a newer file where a
 * condition leaves none of them out. */
#include "tests/support/files.h"
#include "tests/support/image_fixture.h"
#include "tests/support/layers_frame.h"
#include "tests/support/mend.h"

static const char *write_older(const char *path) {
  const char *older = files_path("older.lpc");
  enum { VERSION = 8, N_CLOUDS = 24, N_ATTRIBUTES = 192, CHILD = 44, COVERING = 60, GROWTH = 104, REACH = 108 };
  size_t n_bytes;
  unsigned char *bytes = read_bytes(path, &n_bytes);
  size_t entry = CONIC_LAYERS_HEADER_BYTES + conic_load_32(bytes + N_ATTRIBUTES) * CONIC_LAYERS_ATTRIBUTE_BYTES;
  CHECK(bytes[VERSION] == 3);
  bytes[VERSION] = 2;
  for (uint32_t i = 0; i < conic_load_32(bytes + N_CLOUDS); i++, entry += CONIC_LAYERS_ENTRY_BYTES) {
    uint32_t child = conic_load_32(bytes + entry + CHILD), one = 0x3f800000;
    conic_store_32(bytes + entry + GROWTH, child ? 0 : one);
    conic_store_32(bytes + entry + REACH, child ? conic_load_32(bytes + entry + COVERING) : 0);
  }
  mend_layers(bytes, n_bytes);
  write_bytes(older, bytes, n_bytes);
  free(bytes);
  return older;
}

int main(void) {
  if (!has_feature("zstd")) {
    fprintf(stderr, "skipped: this build is without zstd\n");
    return 77;
  }
  conic_context *context = files_context();
  const char *path = files_path("newer.lpc");
  layers_build(context, path, 64);
  layers_frame older = layers_open(2, write_older(path), NULL), newer = layers_open(2, path, NULL);
  for (double error = 0.0; error < 20.0; error = 2.0 * error + 1.0) {
    older.draw.error_px = newer.draw.error_px = error;
    CHECK_OK(conic_layers_choose(newer.layers, NULL, "x > -100", NULL));
    CHECK_OK(layers_draw(&older));
    CHECK_OK(layers_draw(&newer));
    CHECK(layers_same_picture(&older.f.image, &newer.f.image));
    uint64_t n = newer.f.statistics.splats_in;
    CHECK_OK(conic_layers_choose(newer.layers, NULL, NULL, NULL));
    CHECK_OK(layers_draw(&newer));
    CHECK(layers_same_picture(&older.f.image, &newer.f.image) == (error == 0.0));
    CHECK(error < 3.0 || newer.f.statistics.splats_in < n);
  }
  layers_close(&older);
  layers_close(&newer);
  CHECK(unlink(path) == 0 && unlink(files_path("older.lpc")) == 0);
  files_end(context);
  return check_result();
}
