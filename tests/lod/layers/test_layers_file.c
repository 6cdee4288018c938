/* .lpc files: whatever is spoiled is refused, or found when its cloud is read, also where its sums were made right
 * again; bounds that lie are found by the check; memory that runs out is an error. */
#include "core/base/byte_order.h"
#include "tests/support/layers_fixture.h"
#include "tests/support/mend.h"
#include "tests/support/random_numbers.h"

typedef struct bytes {
  unsigned char *at;
  size_t n;
} bytes;

static bytes make_file(conic_context *context, size_t n) {
  const char *path = files_path("made.lpc");
  conic_layers_options options;
  conic_splats splats;
  conic_layers_options_init(&options);
  options.cloud_size = 64;
  layers_scene(context, CONIC_SCENE_KNOT, n, 1e5, &splats);
  CHECK_OK(layers_build(context, &splats, path, &options, NULL));
  conic_splats_release(context, &splats);
  bytes file = {malloc(1 << 20), 0};
  FILE *stream = fopen(path, "rb");
  if (!stream || !file.at)
    exit(1);
  file.n = fread(file.at, 1, 1 << 20, stream);
  fclose(stream);
  CHECK(conic_layers_is_file(path));
  CHECK(unlink(path) == 0);
  return file;
}

typedef enum verdict { REFUSED, UNSOUND, SOUND } verdict;

/* Refused with a place, or looked at; then nothing may be sound that is not. */
static verdict try_bytes(conic_context *context, const unsigned char *content, size_t n) {
  const char *path = files_write_bytes("spoiled.lpc", content, n);
  conic_layers_info info;
  conic_layers_defects found = {0};
  files_message[0] = 0;
  conic_status status = conic_layers_describe(context, path, &info);
  CHECK(status == CONIC_OK || status == CONIC_ERROR_INPUT);
  if (status != CONIC_OK)
    CHECK(strncmp(files_message, path, strlen(path)) == 0 && strstr(files_message, "(at byte "));
  else
    CHECK_OK(conic_layers_check(context, path, &found));
  CHECK(unlink(path) == 0);
  if (status != CONIC_OK)
    return REFUSED;
  return found.clouds + found.coverage + found.spheres + found.cones ? UNSOUND : SOUND;
}

/* Cut anywhere, every byte changed: refused, or, within a cloud, found. */
static void test_damage(conic_context *context, bytes file) {
  conic_layers_header header;
  CHECK_OK(conic_layers_read_header(context, "made", file.at, file.n, &header));
  size_t head = CONIC_LAYERS_HEADER_BYTES + (size_t)conic_layers_index_bytes(&header);
  for (size_t n = 0; n < file.n; n += n < 300 ? 1 : 97)
    CHECK(try_bytes(context, file.at, n) == REFUSED);
  for (size_t i = 0; i < file.n; i++) {
    file.at[i] ^= (unsigned char)(1u << i % 8);
    CHECK(try_bytes(context, file.at, file.n) == (i < head ? REFUSED : UNSOUND));
    file.at[i] ^= (unsigned char)(1u << i % 8);
  }
  CHECK(try_bytes(context, file.at, file.n) == SOUND);
  unsigned char *longer = calloc(file.n + 64, 1);
  if (!longer)
    exit(1);
  memcpy(longer, file.at, file.n);
  CHECK(try_bytes(context, longer, file.n + 64) == REFUSED);
  free(longer);
}

/* A header that lies, with the right sum. */
static void test_lies(conic_context *context, bytes file) {
  static const unsigned char values[] = {0, 1, 2, 0x7f, 0x80, 0xff};
  unsigned char *spoiled = malloc(file.n);
  if (!spoiled)
    exit(1);
  for (size_t i = 8; i < CONIC_LAYERS_HEADER_BYTES - 8; i++)
    for (size_t k = 0; k < sizeof values; k++) {
      memcpy(spoiled, file.at, file.n);
      spoiled[i] = values[k];
      mend_layers(spoiled, file.n);
      try_bytes(context, spoiled, file.n);
    }
  memcpy(spoiled, file.at, file.n);
  conic_store_float(spoiled + 200, -3.0f); /* of what points up, y */
  mend_layers(spoiled, file.n);
  CHECK(try_bytes(context, spoiled, file.n) == REFUSED);
  free(spoiled);
}

/* Bytes anywhere changed by chance, with the right sums: refused, or read without harm. */
static void test_chance(conic_context *context, bytes file) {
  uint64_t state = 5;
  size_t n_looked_at = 0;
  unsigned char *spoiled = malloc(file.n);
  if (!spoiled)
    exit(1);
  for (int i = 0; i < 2000; i++) {
    memcpy(spoiled, file.at, file.n);
    for (int k = 0; k < 1 + i % 5; k++) {
      size_t at =
          CONIC_LAYERS_HEADER_BYTES + (size_t)(random_unit(&state) * (double)(file.n - CONIC_LAYERS_HEADER_BYTES));
      spoiled[at] = (unsigned char)(256.0 * random_unit(&state));
    }
    mend_layers(spoiled, file.n);
    n_looked_at += try_bytes(context, spoiled, file.n) != REFUSED ? 1 : 0;
  }
  CHECK(n_looked_at > 300);
  free(spoiled);
}

/* Bounds that are too narrow, with the right sums: each is found, node by node. */
static void test_bounds(conic_context *context, bytes file) {
  conic_layers_header header;
  CHECK_OK(conic_layers_read_header(context, "made", file.at, file.n, &header));
  size_t n_bytes = CONIC_LAYERS_HEADER_BYTES + (size_t)conic_layers_index_bytes(&header);
  conic_layers_entry *entries = calloc(conic_layers_all_entries(&header), sizeof *entries);
  unsigned char *spoiled = malloc(file.n);
  if (!entries || !spoiled)
    exit(1);
  CHECK_OK(conic_layers_read_index(context, "made", &header, file.at + CONIC_LAYERS_HEADER_BYTES, entries));
  for (uint32_t i = 0; i < header.n_clouds; i++)
    for (int which = 0; which < 3; which++) {
      const char *path = files_path("bounds.lpc");
      conic_layers_defects found;
      conic_layers_entry held = entries[i];
      entries[i].covering *= which == 0 ? 0.5f : 1.0f;
      entries[i].sphere *= which == 1 ? 0.5f : 1.0f;
      entries[i].cone = which == 2 ? 1.0f : held.cone;
      memcpy(spoiled, file.at, file.n);
      unsigned char *index = spoiled + CONIC_LAYERS_HEADER_BYTES;
      conic_layers_write_entries(entries, header.n_clouds, index + conic_layers_table_bytes(&header));
      header.index_sum = conic_checksum(index, (size_t)conic_layers_index_bytes(&header));
      conic_layers_write_header(&header, spoiled);
      CHECK(n_bytes < file.n);
      files_write_bytes("bounds.lpc", spoiled, file.n);
      CHECK_OK(conic_layers_check(context, path, &found));
      CHECK(found.clouds == 0);
      CHECK(found.coverage == (which == 0 && held.child ? 1 : 0));
      CHECK(found.spheres == (which == 1 ? 1 : 0));
      CHECK(found.cones == (which == 2 ? 1 : 0));
      CHECK(unlink(path) == 0);
      entries[i] = held;
    }
  free(entries);
  free(spoiled);
}

/* An allocator that fails from some call on. */
typedef struct failing {
  int n_left, n_alive;
} failing;

static void *fail_at_last(void *cookie, size_t n) {
  failing *self = cookie;
  if (self->n_left-- <= 0)
    return NULL;
  self->n_alive++;
  return malloc(n);
}

static void release(void *cookie, void *pointer) {
  failing *self = cookie;
  self->n_alive--;
  free(pointer);
}

/* Every allocation of building and checking fails once: a clean error, nothing kept, nothing written. */
static void test_memory(conic_context *plenty) {
  const char *path = files_path("memory.lpc");
  conic_splats splats;
  layers_scene(plenty, CONIC_SCENE_SPHERE, 2000, 0.0, &splats);
  int is_done = 0;
  for (int n = 4; !is_done && n < 4000; n += 1 + n / 16) {
    failing allocator = {.n_left = n};
    conic_context_options options;
    conic_context *context;
    conic_layers_options build_options;
    conic_layers_defects found;
    conic_context_options_init(&options);
    options.threads = 1;
    options.allocate = fail_at_last;
    options.release = release;
    options.allocator_cookie = &allocator;
    if (conic_context_create(&options, &context) != CONIC_OK)
      continue;
    conic_layers_options_init(&build_options);
    build_options.cloud_size = 64;
    conic_status status = layers_build(context, &splats, path, &build_options, NULL);
    CHECK(status == CONIC_OK || status == CONIC_ERROR_MEMORY);
    CHECK((access(path, F_OK) == 0) == (status == CONIC_OK));
    if (status == CONIC_OK)
      is_done = conic_layers_check(context, path, &found) == CONIC_OK;
    unlink(path);
    conic_context_destroy(context);
    CHECK(allocator.n_alive == 0);
  }
  CHECK(is_done);
  conic_splats_release(plenty, &splats);
}

int main(void) {
  if (layers_are_missing()) {
    fprintf(stderr, "skipped: this build has no zstd\n");
    return 77;
  }
  conic_context *context = files_context();
  bytes file = make_file(context, 500);
  test_damage(context, file);
  test_lies(context, file);
  test_chance(context, file);
  test_bounds(context, file);
  test_memory(context);
  free(file.at);
  conic_layers_info info;
  files_check_failed("missing", conic_layers_describe(context, files_path("none.lpc"), &info), "cannot read", NULL);
  files_check_failed("a folder", conic_layers_describe(context, files_folder, &info), "it is a directory", NULL);
  files_end(context);
  return check_result();
}
