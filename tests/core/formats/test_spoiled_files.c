/* Every reader against sound files that were spoiled: cut everywhere, and bytes replaced. Whatever it is, it is
 * read, or refused with one line that names the file and a place; memory stays in proportion to the file, and all of it
 * comes back. The program's side of bad input is bad_input.sh. */
#include "core/files/mapping.h"
#include "core/formats/material_file.h"
#include "tests/support/random_numbers.h"
#include "tests/support/sanitized.h"
#include "tests/support/seeds.h"

/* An allocator that knows how much is out. */
typedef struct ledger {
  size_t alive_bytes, peak_bytes;
} ledger;

static ledger memory;
static int n_messages;

static void *allocate(void *cookie, size_t bytes) {
  ledger *self = cookie;
  char *block = malloc(bytes + 16);
  if (!block)
    return NULL;
  memcpy(block, &bytes, sizeof bytes);
  self->alive_bytes += bytes;
  if (self->alive_bytes > self->peak_bytes)
    self->peak_bytes = self->alive_bytes;
  return block + 16;
}

static void release(void *cookie, void *pointer) {
  ledger *self = cookie;
  size_t bytes;
  char *block = (char *)pointer - 16;
  memcpy(&bytes, block, sizeof bytes);
  self->alive_bytes -= bytes;
  free(block);
}

static void count_message(void *cookie, conic_log_level level, const char *message) {
  (void)cookie;
  n_messages += level == CONIC_LOG_ERROR;
  files_log(NULL, level, message);
}

static conic_context *open_context(void) {
  conic_context_options options;
  conic_context *context;
  conic_context_options_init(&options);
  options.allocate = allocate;
  options.release = release;
  options.allocator_cookie = &memory;
  options.log = count_message;
  options.threads = 1;
  if (conic_context_create(&options, &context) != CONIC_OK)
    exit(1);
  return context;
}

static int is_picture(const char *target) {
  static const char *const pictures[] = {"pfm", "exr", "png", "tif", "jpg", "numpy"};
  for (size_t i = 0; i < sizeof pictures / sizeof *pictures; i++)
    if (strcmp(target, pictures[i]) == 0)
      return 1;
  return 0;
}

/* A file of the materials that the seeds name. */
static conic_status read_materials(conic_context *context, const char *path) {
  static char names[] = "\0red\0plain";
  const conic_texts texts = {names, sizeof names, sizeof names, 3};
  conic_material materials[3];
  memset(materials, 0, sizeof materials);
  conic_status status = conic_material_file_read(context, path, &texts, materials);
  for (int i = 0; i < 3; i++)
    conic_texture_destroy(materials[i].texture);
  return status;
}

static conic_status read_cameras(conic_context *context, const char *path) {
  conic_cameras cameras;
  conic_status status = conic_cameras_read(context, path, NULL, &cameras);
  conic_cameras_release(context, &cameras);
  return status;
}

/* Both files of a model in one. */
static conic_status read_joined(conic_context *context, const char *path) {
  conic_cameras cameras;
  conic_mapping mapping;
  conic_status status = conic_mapping_open(context, path, &mapping);
  if (status != CONIC_OK)
    return status;
  status = camera_read_joined(context, path, mapping.bytes, mapping.n_bytes, &cameras);
  conic_mapping_close(context, &mapping);
  conic_cameras_release(context, &cameras);
  return status;
}

static conic_status read_target(conic_context *context, const char *target, const char *path) {
  conic_model model;
  conic_image image;
  conic_octree *octree;
  conic_status status;
  if (strcmp(target, "camera") == 0)
    return read_cameras(context, path);
  if (strcmp(target, "colmap") == 0)
    return read_joined(context, path);
  if (strcmp(target, "cot") == 0) {
    status = conic_octree_read(context, path, &octree);
    conic_octree_destroy(octree);
    return status;
  }
  if (strcmp(target, "gaussians") == 0) {
    conic_gaussians scene;
    status = conic_gaussians_read(context, path, NULL, &scene);
    conic_gaussians_release(context, &scene);
    return status;
  }
  if (strcmp(target, "lpc") == 0) {
    conic_layers_info info;
    return conic_layers_describe(context, path, &info);
  }
  if (strcmp(target, "mtl") == 0)
    return read_materials(context, path);
  if (strcmp(target, "chy") == 0) {
    conic_hybrid *hybrid;
    status = conic_hybrid_read(context, path, &hybrid);
    conic_hybrid_destroy(hybrid);
    return status;
  }
  if (is_picture(target)) {
    status = conic_image_read(context, path, &image);
    if (status == CONIC_OK)
      conic_image_release(context, &image);
    return status;
  }
  conic_read_options options;
  conic_read_options_init(&options);
  options.keeps_faces = strcmp(target, "obj") == 0 || strcmp(target, "ply") == 0;
  status = conic_model_read(context, path, &options, &model);
  for (size_t i = 0; i < model.n_triangles; i++)
    for (int corner = 0; corner < 3; corner++)
      CHECK(model.triangles[i][corner] < model.points.count);
  conic_model_release(context, &model);
  return status;
}

/* The window, tables and rows that reading begins with, and what a point of a few bytes takes while its arrays grow.
 * A picture is refused where it takes more than 2¹⁶ times its file. */
static size_t memory_bound(const char *target, size_t n_bytes) {
  return ((size_t)1 << 20) + n_bytes * (is_picture(target) ? (size_t)1 << 17 : 64);
}

/* A .gltf whose buffer is no `data:` any more names a file beside it, which is what is told of then. */
static int names_file_beside(const char *path) {
  size_t n_folder = strlen(files_folder);
  return strstr(path, ".gltf") && strncmp(files_message, files_folder, n_folder) == 0 &&
         strncmp(files_message + n_folder, "/data", 5) == 0;
}

/* Reads what a spoiled file holds; returns whether it was taken for sound. */
static int check(conic_context *context, const seed *from, const unsigned char *bytes, size_t n_bytes) {
  const char *path = files_write_bytes(from->name, bytes, n_bytes);
  int failures_before = check_failures;
  size_t before = memory.alive_bytes;
  memory.peak_bytes = before;
  n_messages = 0;
  files_message[0] = 0;
  conic_status status = read_target(context, from->target, path);
  CHECK(status == CONIC_OK || status == CONIC_ERROR_INPUT ||
        (status == CONIC_ERROR_UNSUPPORTED && (strcmp(from->target, "exr") == 0 || strcmp(from->target, "e57") == 0)));
  CHECK(n_messages == (status != CONIC_OK));
  CHECK(memory.alive_bytes == before);
  CHECK(memory.peak_bytes - before <= memory_bound(from->target, n_bytes));
  if (status == CONIC_ERROR_INPUT) {
    int is_beside = names_file_beside(path);
    size_t n_path = strlen(path);
    CHECK(is_beside || (strncmp(files_message, path, n_path) == 0 && files_message[n_path] == ':'));
    for (const char *c = files_message; *c; c++)
      CHECK((unsigned char)*c >= 0x20);
    int is_pfm = n_bytes >= 2 && bytes[0] == 'P' && (bytes[1] | 0x20) == 'f';
    int is_by_library = is_picture(from->target) && !is_pfm;
    if (!is_beside && (n_bytes == 0 || !is_by_library)) /* the libraries for pictures seldom say where */
      CHECK(strstr(files_message, "(line ") || strstr(files_message, "(at byte "));
  }
  if (check_failures > failures_before)
    fprintf(stderr, "%s: %zu bytes, status %d, peak %zu: %s\n", path, n_bytes, (int)status, memory.peak_bytes - before,
            files_message);
  CHECK(unlink(path) == 0);
  return status == CONIC_OK;
}

/* So many places of a file are spoiled, and cut at: of small files each; fewer under a sanitizer, which takes ten times
 * as long. Of large files it spoils others, so that both together try more. Fuzzing tries more still. */
enum { N_PLACES = IS_SANITIZED ? 16 : 90, N_CUTS = IS_SANITIZED ? 32 : 500, N_RANDOM = IS_SANITIZED ? 20 : 50 };

static void test_cut(conic_context *context, const seed *from) {
  CHECK(check(context, from, from->bytes, from->n_bytes));
  for (size_t n = 0; n < from->n_bytes; n += 1 + from->n_bytes / N_CUTS) {
    int is_sound = check(context, from, from->bytes, n);
    if (is_sound && !from->may_be_cut) {
      fprintf(stderr, "%s: sound with %zu of %zu bytes\n", from->name, n, from->n_bytes);
      check_failures++;
    }
  }
}

static void test_replaced(conic_context *context, const seed *from) {
  static const unsigned char values[] = {0, 1, 7, 0xFF, 0x80, '9', '-', ' ', '\n'};
  unsigned char *bytes = malloc(from->n_bytes);
  if (!bytes)
    exit(1);
  size_t step = 1 + from->n_bytes / N_PLACES;
  for (size_t i = IS_SANITIZED ? step / 2 : 0; i < from->n_bytes; i += step) {
    for (size_t k = 0; k < sizeof values; k++) {
      memcpy(bytes, from->bytes, from->n_bytes);
      bytes[i] = values[k];
      if (strcmp(from->target, "e57") == 0) /* past the sums, which test_e57.c is about */
        conic_e57_mend(bytes, from->n_bytes);
      check(context, from, bytes, from->n_bytes);
    }
  }
  free(bytes);
}

/* Nothing but chance behind a beginning that says what the file is. */
static void test_random(conic_context *context, const seed *from) {
  uint64_t state = 7;
  unsigned char bytes[600];
  for (int run = 0; run < N_RANDOM; run++) {
    size_t n_kept = (size_t)(run % 10) * from->n_bytes / 10;
    n_kept = n_kept < sizeof bytes ? n_kept : sizeof bytes;
    for (size_t i = 0; i < sizeof bytes; i++)
      bytes[i] = i < n_kept ? from->bytes[i] : (unsigned char)(256.0 * random_unit(&state));
    check(context, from, bytes, sizeof bytes);
  }
}

/* Of a zip archive, every file that has another sum than its entry in the index says is refused. */
static void test_zip_sums(conic_context *context, const seed *from) {
  if (!strstr(from->name, ".sog"))
    return;
  int n_entries = 0;
  for (size_t at = 0; at + 46 <= from->n_bytes; at++) {
    if (memcmp(from->bytes + at, "PK\1\2", 4) != 0)
      continue;
    from->bytes[at + 16] ^= 0x55;
    CHECK(!check(context, from, from->bytes, from->n_bytes));
    from->bytes[at + 16] ^= 0x55;
    n_entries++;
  }
  CHECK(n_entries > 1);
}

static void test_no_file(conic_context *context, const seed *from) {
  n_messages = 0;
  CHECK(read_target(context, from->target, files_path("absent")) == CONIC_ERROR_INPUT && n_messages == 1);
  CHECK(strstr(files_message, "absent: "));
  n_messages = 0;
  CHECK(read_target(context, from->target, files_folder) == CONIC_ERROR_INPUT && n_messages == 1);
  CHECK(strstr(files_message, files_folder) == files_message);
}

/* Other people's decoders, where they are in the build: a cut picture must not pass for a whole one, nor damaged data
 * for sound ones where the format has check sums. */
static void test_foreign(conic_context *writing, conic_context *reading, const char *target, int has_sums) {
  seed_set set = {.n = 0};
  seeds_picture(&set, writing, target, 1u << CONIC_PLANE_RGBA);
  if (set.n == 0) {
    fprintf(stderr, "skipped: this build does not write %s\n", target);
    return;
  }
  seed *from = &set.seeds[0];
  test_cut(reading, from);
  test_replaced(reading, from);
  if (has_sums) {
    size_t middle = from->n_bytes - 40; /* within the compressed samples, which come last */
    from->bytes[middle] ^= 0x55;
    CHECK(!check(reading, from, from->bytes, from->n_bytes));
  }
  free(from->bytes);
}

int main(void) {
  conic_context *context = files_context(); /* for the folder, and to write the seeds */
  seed_set *set = seeds_make(context);
  conic_context *counted = open_context();
  for (int i = 0; i < set->n; i++) {
    test_no_file(counted, &set->seeds[i]);
    test_cut(counted, &set->seeds[i]);
    test_replaced(counted, &set->seeds[i]);
    test_random(counted, &set->seeds[i]);
    test_zip_sums(counted, &set->seeds[i]);
  }
  test_foreign(context, counted, "tif", 1);
  test_foreign(context, counted, "jpg", 0);
  conic_context_destroy(counted);
  CHECK(memory.alive_bytes == 0);
  seeds_release(set);
  files_end(context);
  return check_result();
}
