/* A file of version 2, which has no stand-ins, is drawn as its samples: as a newer file is where these are asked for.
 */
#include "tests/support/files.h"
#include "tests/support/image_fixture.h"
#include "tests/support/layers_frame.h"
#include "tests/support/mend.h"

enum { VERSION = 8, N_CLOUDS = 24, FILE_BYTES = 168, INDEX_SUM = 176, HEADER_SUM = 248, N_ATTRIBUTES = 192 };
enum { OFFSET = 8, CHILD = 44, COVERING = 60, GROWTH = 104, REACH = 108, STAND_IN_BYTES = 112 };

/* Takes the stand-ins out, and gives entries what they stated before. */
static const char *write_older(const char *path) {
  const char *older = files_path("older.lpc");
  size_t n_bytes;
  unsigned char *bytes = read_bytes(path, &n_bytes), *made = calloc(1, n_bytes);
  size_t n = conic_load_32(bytes + N_CLOUDS), n_stand_ins = 0;
  size_t index = CONIC_LAYERS_HEADER_BYTES + conic_load_32(bytes + N_ATTRIBUTES) * CONIC_LAYERS_ATTRIBUTE_BYTES;
  CHECK(bytes[VERSION] == 3 && made);
  for (size_t i = 0; i < n; i++)
    n_stand_ins += conic_load_32(bytes + index + i * CONIC_LAYERS_ENTRY_BYTES + STAND_IN_BYTES);
  size_t less = n_stand_ins + n * (CONIC_LAYERS_ENTRY_BYTES - CONIC_LAYERS_OLD_ENTRY_BYTES);
  memcpy(made, bytes, index);
  for (size_t i = 0; i < n; i++) {
    unsigned char *entry = made + index + i * CONIC_LAYERS_OLD_ENTRY_BYTES;
    memcpy(entry, bytes + index + i * CONIC_LAYERS_ENTRY_BYTES, GROWTH);
    int is_leaf = conic_load_32(entry + CHILD) == 0;
    conic_store_32(entry + GROWTH, is_leaf ? 0x3f800000 : 0);
    conic_store_32(entry + REACH, is_leaf ? 0 : conic_load_32(entry + COVERING));
    conic_store_64(entry + OFFSET, conic_load_64(entry + OFFSET) - less);
  }
  size_t clouds = index + n * CONIC_LAYERS_ENTRY_BYTES + n_stand_ins;
  memcpy(made + clouds - less, bytes + clouds, n_bytes - clouds);
  made[VERSION] = 2;
  conic_store_64(made + FILE_BYTES, n_bytes - less);
  conic_store_64(made + INDEX_SUM,
                 conic_checksum(made + CONIC_LAYERS_HEADER_BYTES,
                                index + n * CONIC_LAYERS_OLD_ENTRY_BYTES - CONIC_LAYERS_HEADER_BYTES));
  conic_store_64(made + HEADER_SUM, conic_checksum(made, HEADER_SUM));
  write_bytes(older, made, n_bytes - less);
  free(bytes);
  free(made);
  return older;
}

int main(void) {
  if (!has_feature("zstd")) {
    fprintf(stderr, "skipped: this build is without zstd\n");
    return 77;
  }
  conic_context *context = files_context();
  char path[256];
  snprintf(path, sizeof path, "%s", files_path("newer.lpc"));
  layers_build(context, path, 64);
  layers_frame older = layers_open(2, write_older(path), NULL), newer = layers_open(2, path, NULL);
  for (double error = 0.0; error < 30.0; error = 2.0 * error + 1.0) {
    older.draw.error_px = newer.draw.error_px = error;
    newer.draw.only_samples = 1;
    CHECK_OK(layers_draw(&older));
    CHECK_OK(layers_draw(&newer));
    CHECK(layers_same_picture(&older.f.image, &newer.f.image));
    uint64_t n = newer.f.statistics.splats_in;
    newer.draw.only_samples = 0;
    CHECK_OK(layers_draw(&newer));
    CHECK(newer.f.statistics.splats_in <= n); /* an error never draws more for stand-ins, */
    CHECK(error > 0.0 || layers_same_picture(&older.f.image, &newer.f.image)); /* and all is as it was */
  }
  layers_close(&older);
  layers_close(&newer);
  CHECK(unlink(path) == 0 && unlink(files_path("older.lpc")) == 0);
  files_end(context);
  return check_result();
}
