/* .cot files: what is written is read, to the bit; whatever is spoiled is refused, also where its sums were made right
 * again; memory that runs out is an error. */
#include "tests/support/files.h"
#include "tests/support/octree_fixture.h"

enum { HEADER_BYTES = 256 };

typedef struct bytes {
  unsigned char *at;
  size_t n;
} bytes;

static bytes read_bytes(const char *path) {
  bytes b = {malloc(1 << 20), 0};
  FILE *file = fopen(path, "rb");
  if (!file || !b.at)
    exit(1);
  b.n = fread(b.at, 1, 1 << 20, file);
  fclose(file);
  return b;
}

static void scene_splats(conic_context *context, size_t n, int with_rest, conic_splats *splats) {
  conic_scene_options options;
  conic_scene *scene;
  conic_scene_options_init(&options);
  options.type = CONIC_SCENE_KNOT;
  options.count = n;
  options.offset[1] = 1e6;
  CHECK_OK(conic_splats_allocate(context, n,
                                 CONIC_SPLATS_TANGENTS | CONIC_SPLATS_COLORS |
                                     (with_rest ? CONIC_SPLATS_OPACITIES | CONIC_SPLATS_DOTS : 0u),
                                 splats));
  CHECK_OK(conic_scene_create(context, &options, &scene));
  CHECK_OK(conic_scene_sample(scene, 0, n, splats));
  conic_scene_destroy(scene);
  for (size_t i = 0; i < n && with_rest; i++) {
    splats->opacity[i] = 0.25f + 0.5f * (float)i / (float)n;
    splats->dot[i] = i % 7 == 0;
  }
}

static bytes make_file(conic_context *context, size_t n, int quantize, int with_rest) {
  const char *path = files_path("made.cot");
  conic_splats splats;
  scene_splats(context, n, with_rest, &splats);
  conic_octree *octree = octree_build(context, &splats, quantize);
  conic_octree_info info;
  CHECK_OK(conic_octree_write(octree, path));
  CHECK_OK(conic_octree_describe(octree, &info));
  bytes file = read_bytes(path);
  CHECK(info.n_bytes == file.n);
  CHECK(conic_octree_is_file(path));
  conic_octree *back;
  CHECK_OK(conic_octree_read(context, path, &back));
  CHECK_OK(conic_octree_decode(back));
  CHECK(back->n_nodes == octree->n_nodes && back->n_levels == octree->n_levels);
  CHECK(memcmp(back->codes, octree->codes, octree->n_nodes * CONIC_NODE_BYTES) == 0);
  CHECK(memcmp(back->index, octree->index, octree->leaves.count * sizeof *back->index) == 0);
  CHECK(memcmp(back->drawn, octree->drawn, octree->n_nodes * sizeof *back->drawn) == 0);
  CHECK(memcmp(back->error, octree->error, octree->n_nodes * sizeof *back->error) == 0);
  CHECK(memcmp(back->end, octree->end, octree->n_nodes * sizeof *back->end) == 0);
  for (int axis = 0; axis < 3; axis++) {
    size_t n_bytes = octree->leaves.count * sizeof(float);
    CHECK(memcmp(back->leaves.position[axis], octree->leaves.position[axis], n_bytes) == 0);
    CHECK(memcmp(back->leaves.tangent_v[axis], octree->leaves.tangent_v[axis], n_bytes) == 0);
    CHECK(memcmp(back->leaves.color[axis], octree->leaves.color[axis], n_bytes) == 0);
    CHECK(back->leaves.origin[axis] == octree->leaves.origin[axis]);
  }
  CHECK(!with_rest == !back->leaves.opacity && !with_rest == !back->leaves.dot);
  for (size_t i = 0; i < octree->leaves.count && with_rest; i++)
    CHECK(back->leaves.dot[i] == splats.dot[octree->index[i]]);
  octree_check_sound(back);
  conic_octree_destroy(back);
  conic_octree_destroy(octree);
  conic_splats_release(context, &splats);
  CHECK(unlink(path) == 0);
  return file;
}

/* Returns whether it was taken for sound. */
static int try_bytes(conic_context *context, const unsigned char *content, size_t n) {
  const char *path = files_write_bytes("spoiled.cot", content, n);
  conic_octree *octree;
  files_message[0] = 0;
  conic_status status = conic_octree_read(context, path, &octree);
  CHECK(status == CONIC_OK || status == CONIC_ERROR_INPUT);
  CHECK(!octree == (status != CONIC_OK));
  if (status != CONIC_OK)
    CHECK(strncmp(files_message, path, strlen(path)) == 0 && strstr(files_message, "(at byte "));
  if (octree) { /* then it can be used */
    conic_octree_defects found;
    conic_octree_info info;
    conic_splats leaves;
    CHECK_OK(conic_octree_check(octree, &found));
    CHECK_OK(conic_octree_describe(octree, &info));
    CHECK_OK(conic_octree_leaves(octree, &leaves));
    conic_splats_release(context, &leaves);
    conic_selection selection = {0};
    fixture f = {.context = context};
    conic_render_options_init(&f.options);
    f.options.kernel.cutoff = info.cutoff;
    fixture_camera(&f, 64, 64, 60.0);
    f.options.near_z = 0.1;
    octree_select(octree, &f, 2.0, 0, &selection);
    CHECK(selection.splats.count <= octree->n_leaves);
    octree_select(octree, &f, 0.0, 30, &selection);
    conic_selection_release(context, &selection);
  }
  conic_octree_destroy(octree);
  CHECK(unlink(path) == 0);
  return status == CONIC_OK;
}

/* Cut anywhere, every byte changed: refused. */
static void test_damage(conic_context *context, bytes file) {
  int n_taken = 0;
  for (size_t n = 0; n < file.n; n += n < 300 ? 1 : 97)
    n_taken += try_bytes(context, file.at, n);
  for (size_t i = 0; i < file.n; i++) {
    file.at[i] ^= (unsigned char)(1u << i % 8);
    n_taken += try_bytes(context, file.at, file.n);
    file.at[i] ^= (unsigned char)(1u << i % 8);
  }
  CHECK(n_taken == 0);
  CHECK(try_bytes(context, file.at, file.n));
  unsigned char *longer = calloc(file.n + 64, 1);
  if (!longer)
    exit(1);
  memcpy(longer, file.at, file.n);
  CHECK(!try_bytes(context, longer, file.n + 64));
  free(longer);
}

/* A header that lies, with the right sum. */
static void test_lies(conic_context *context, bytes file) {
  static const unsigned char values[] = {0, 1, 2, 0x7f, 0x80, 0xff};
  unsigned char whole[HEADER_BYTES];
  memcpy(whole, file.at, sizeof whole);
  for (size_t i = 8; i < HEADER_BYTES - 8; i++)
    for (size_t k = 0; k < sizeof values; k++) {
      file.at[i] = values[k];
      conic_octree_mend(file.at, file.n);
      try_bytes(context, file.at, file.n);
      memcpy(file.at, whole, sizeof whole);
    }
}

/* Bytes anywhere changed by chance, with the right sums: read or refused, and what is read can be used. */
static void test_chance(conic_context *context, bytes file) {
  uint64_t state = 5;
  unsigned char *spoiled = malloc(file.n);
  int n_taken = 0;
  if (!spoiled)
    exit(1);
  for (int i = 0; i < 3000; i++) {
    memcpy(spoiled, file.at, file.n);
    for (int k = 0; k < 1 + i % 5; k++) {
      size_t at = HEADER_BYTES + (size_t)(fixture_random(&state) * (double)(file.n - HEADER_BYTES));
      spoiled[at] = (unsigned char)(256.0 * fixture_random(&state));
    }
    conic_octree_mend(spoiled, file.n);
    n_taken += try_bytes(context, spoiled, file.n);
  }
  CHECK(n_taken > 300);
  free(spoiled);
}

/* Codes that lie, in an octree whose sums are right: written by the library itself. */
static void test_structure(conic_context *context) {
  static const uint8_t spoils[] = {0x00, 0x01, 0x10, 0x08, 0x80, 0x88, 0xff, 0x02, 0x20};
  char path[160];
  snprintf(path, sizeof path, "%s", files_path("structure.cot"));
  conic_splats splats;
  scene_splats(context, 200, 0, &splats);
  conic_octree *octree = octree_build(context, &splats, 0);
  int n_refused = 0;
  for (size_t i = 0; i < octree->n_nodes; i++)
    for (size_t k = 0; k < sizeof spoils; k++) {
      uint8_t *code = octree->codes + i * CONIC_NODE_BYTES, before = *code;
      if (spoils[k] == before)
        continue;
      *code = spoils[k];
      CHECK_OK(conic_octree_write(octree, path));
      bytes file = read_bytes(path);
      n_refused += !try_bytes(context, file.at, file.n);
      free(file.at);
      *code = before;
    }
  CHECK(n_refused > 500);                       /* nearly all: few give as many nodes and leaves by another tree */
  for (size_t i = 1; i < CONIC_NODE_BYTES; i++) /* bounds that lie are read, and found by the check */
    for (size_t k = 0; k < 40; k++) {
      uint8_t *code = octree->codes + k * CONIC_NODE_BYTES + i, before = *code;
      *code = (uint8_t)(k % 2 ? 0xff : 0x00);
      CHECK_OK(conic_octree_write(octree, path));
      bytes file = read_bytes(path);
      CHECK(try_bytes(context, file.at, file.n));
      free(file.at);
      *code = before;
    }
  uint32_t index = octree->index[5];
  octree->index[5] = octree->index[6]; /* twice */
  CHECK_OK(conic_octree_write(octree, path));
  bytes file = read_bytes(path);
  CHECK(!try_bytes(context, file.at, file.n));
  free(file.at);
  octree->index[5] = 200; /* out of range */
  CHECK_OK(conic_octree_write(octree, path));
  file = read_bytes(path);
  CHECK(!try_bytes(context, file.at, file.n));
  free(file.at);
  octree->index[5] = index;
  octree->leaves.position[0][3] = NAN; /* leaves that cannot be drawn */
  octree->leaves.tangent_u[1][9] = INFINITY;
  CHECK_OK(conic_octree_write(octree, path));
  file = read_bytes(path);
  CHECK(try_bytes(context, file.at, file.n));
  free(file.at);
  CHECK(unlink(path) == 0);
  conic_octree_destroy(octree);
  conic_splats_release(context, &splats);
}

int main(void) {
  conic_context *context = files_context();
  for (int quantize = 0; quantize < 2; quantize++) {
    bytes file = make_file(context, 150, quantize, quantize == 0);
    test_damage(context, file);
    test_lies(context, file);
    test_chance(context, file);
    free(file.at);
    free(make_file(context, 1, quantize, 1).at);
    free(make_file(context, 2, quantize, 0).at);
    free(make_file(context, 9000, quantize, 1).at);
  }
  test_structure(context);
  CHECK(!conic_octree_is_file("/dev/null"));
  conic_octree *octree;
  files_check_failed("missing", conic_octree_read(context, files_path("none.cot"), &octree), "cannot read", NULL);
  files_check_failed("a folder", conic_octree_read(context, files_folder, &octree), "it is a directory", NULL);
  files_end(context);
  return check_result();
}
