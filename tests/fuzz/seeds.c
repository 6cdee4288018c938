/* Writes the seeds of every fuzz target: FOLDER/TARGET/NAME. */
#include "tests/support/seeds.h"
#include "conic/accumulate.h"
#include "core/files/finished.h"
#include "core/image/image_common.h"
#include "lod/blends/levels_build.h"
#include "lod/layers/build/layers_team.h"
#include "tests/fuzz/intermediates_example.h"
#include "tests/fuzz/strips_example.h"
#include "tests/support/layers_fixture.h"
#include "tests/support/suite_example.h"

static void write_seed(const char *folder, const seed *from) {
  char path[4096];
  snprintf(path, sizeof path, "%s/%s", folder, from->target);
  mkdir(path, 0777);
  snprintf(path, sizeof path, "%s/%s/%s", folder, from->target, from->name);
  FILE *file = fopen(path, "wb");
  if (!file || fwrite(from->bytes, 1, from->n_bytes, file) != from->n_bytes || fclose(file) != 0) {
    perror(path);
    exit(1);
  }
}

/* The same EXR as if it were packed as DWAA, which OpenEXRCore leaves to OpenImageIO. */
static void write_packed_seed(const char *folder, const seed *from) {
  static const char before[] = "compression\0compression\0\1\0\0"; /* the 0 at its end is the size's last byte */
  for (size_t i = 0; i + sizeof before < from->n_bytes; i++)
    if (memcmp(from->bytes + i, before, sizeof before) == 0) {
      seed packed = *from;
      from->bytes[i + sizeof before] = 8;
      snprintf(packed.name, sizeof packed.name, "dwaa-%.20s", from->name);
      write_seed(folder, &packed);
      return;
    }
}

static void add_file(seed_set *set, const char *target, const char *path, unsigned char *bytes, size_t room) {
  FILE *file = fopen(path, "rb");
  size_t n = file ? fread(bytes, 1, room, file) : 0;
  if (file)
    fclose(file);
  unlink(path);
  seeds_add(set, target, target, 1, bytes, n);
}

/* Two strips: one packed in its place and as pixels, and one that came before its turn. */
static void seeds_strips(seed_set *set, conic_context *context) {
  static const conic_strip_piece pieces[] = {
      {.packed_bytes = 300, .place = 200, .y_end = 48, .n_rows = 32},
      {.pixel_bytes = 64, .y_end = 48, .y = 32, .n_rows = 16},
      {.pixel_bytes = sizeof(conic_strip_end), .y_end = 48, .y = 48},
      {.packed_bytes = 9, .pixel_bytes = 32, .y_begin = 192, .y_end = 200, .y = 192, .n_rows = 8},
      {.pixel_bytes = sizeof(conic_strip_end), .y_begin = 192, .y_end = 200, .y = 200}};
  static unsigned char nothing[4096], bytes[8192];
  const conic_strip_end end = {.has_hashes = 1};
  char part[4096];
  const char *path = files_path("seed.strips");
  conic_strips_file file;
  uint64_t at;
  snprintf(part, sizeof part, "%s.part", path);
  CHECK_OK(conic_strips_file_begin(context, path, part, STRIPS_EXAMPLE_KEY, &strips_example, 0, &file));
  for (size_t i = 0; i < sizeof pieces / sizeof *pieces; i++) {
    conic_strip_piece piece = pieces[i];
    const void *following = piece.n_rows ? (const void *)nothing : (const void *)&end;
    piece.checks[0] = conic_hash_bytes(nothing, (size_t)piece.packed_bytes);
    piece.checks[1] = conic_hash_bytes(following, (size_t)piece.pixel_bytes);
    CHECK_OK(conic_strips_file_add(&file, &piece, following, &at));
  }
  conic_strips_file_end(context, &file);
  unlink(part);
  add_file(set, "strips", path, bytes, sizeof bytes);
}

/* Sums of two samples of nothing. */
static void seeds_sums(seed_set *set, conic_context *context) {
  unsigned char bytes[4096];
  conic_accumulation *sums;
  conic_image image;
  const char *path = files_path("seed.sums");
  CHECK_OK(conic_image_allocate(context, 3, 2, 1u << CONIC_PLANE_RGBA | 1u << CONIC_PLANE_NORMAL, &image));
  CHECK_OK(conic_accumulation_create(context, 3, 2, conic_image_planes(&image), 0, &sums));
  for (int i = 0; i < 2; i++)
    CHECK_OK(conic_accumulation_add(sums, &image));
  CHECK_OK(conic_accumulation_write(sums, path));
  add_file(set, "sums", path, bytes, sizeof bytes);
  conic_accumulation_destroy(sums);
  conic_image_release(context, &image);
}

static int stop_in_crown(void *cookie, const char *task, double fraction) {
  return *(const int *)cookie && strcmp(task, "build") == 0 && fraction >= 1.0;
}

/* A kept branch, behind its place, and its file's end. */
static void add_branch_seed(seed_set *set, const conic_finished *list, const conic_finished_part *part, int i) {
  unsigned char bytes[1 << 16];
  uint64_t place[3];
  conic_finished_file file;
  char name[16], path[128];
  size_t at = part->files_at;
  CHECK(conic_finished_numbers(part, "branch", place, 3) && conic_finished_next_file(list, &at, &file));
  snprintf(path, sizeof path, "seed.lpc.branches/%.*s", (int)(file.n_name % 64), file.name);
  memcpy(bytes, place, sizeof place);
  FILE *stream = fopen(files_path(path), "rb");
  size_t n = stream ? fread(bytes + sizeof place, 1, sizeof bytes - sizeof place, stream) : 0;
  if (stream)
    fclose(stream);
  snprintf(name, sizeof name, "branch%d", i % 10);
  seeds_add(set, "branch", name, 1, bytes, n + sizeof place);
}

/* Branches of a build that ended when all had grown, and then goes on. */
static void seeds_branches(seed_set *set) {
  static const char key[] = "0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef";
  conic_layers_keeping keeping = {.key = key};
  conic_context_options options;
  conic_context *context;
  conic_layers_options own;
  conic_layers_builder *builder;
  conic_finished list;
  conic_finished_part part;
  conic_splats splats;
  int is_stopped = 1;
  conic_context_options_init(&options);
  options.threads = 1;
  options.log = NULL;
  options.progress = stop_in_crown;
  options.progress_cookie = &is_stopped;
  CHECK_OK(conic_context_create(&options, &context));
  layers_scene(context, CONIC_SCENE_KNOT, 7000, 0.0, &splats);
  conic_layers_options_init(&own);
  own.cloud_size = 64;
  conic_status status = conic_layers_builder_open_team(context, files_path("seed.lpc"), &own, NULL, &keeping, &builder);
  if (status == CONIC_OK) { /* else it is built without zstd */
    CHECK_OK(conic_layers_builder_append(builder, &splats));
    CHECK(conic_layers_builder_finish(builder, NULL) == CONIC_ERROR_CANCELLED);
    CHECK_OK(conic_finished_read(context, files_path("seed.lpc.branches/0.list"), "branches", key, &list));
    size_t at = 0;
    for (int i = 0; i < 6 && conic_finished_next(&list, &at, &part); i++)
      add_branch_seed(set, &list, &part, i);
    conic_finished_release(context, &list);
    is_stopped = 0;
    keeping.goes_on = 1;
    CHECK_OK(conic_layers_builder_open_team(context, files_path("seed.lpc"), &own, NULL, &keeping, &builder));
    CHECK_OK(conic_layers_builder_append(builder, &splats));
    CHECK_OK(conic_layers_builder_finish(builder, NULL));
    CHECK(unlink(files_path("seed.lpc")) == 0);
  }
  conic_splats_release(context, &splats);
  conic_context_destroy(context);
}

/* Gaussians in levels; none where this build cannot write them. */
static void seeds_levels(seed_set *set, conic_context *context) {
  conic_levels_statistics statistics;
  conic_levels_builder *builder;
  unsigned char *bytes;
  conic_gaussians scene = gaussians_random(context, 90, 1, 0);
  CHECK_OK(conic_levels_builder_open(context, files_path("seed.lpc"), 20, 1 << 20, &builder));
  CHECK_OK(conic_levels_builder_append(builder, "seed", &scene));
  if (conic_levels_builder_finish(builder, &statistics) == CONIC_OK) {
    const size_t n_bytes = files_read(files_path("seed.lpc"), &bytes);
    seeds_add(set, "levels", "lpc", 0, bytes, n_bytes);
    free(bytes);
    CHECK(unlink(files_path("seed.lpc")) == 0);
  }
  conic_gaussians_release(context, &scene);
}

/* What other programs made of the five Gaussians that fuzz_intermediates.c has. */
static void seeds_intermediates(seed_set *set, conic_context *context) {
  conic_gaussian_intermediates found;
  conic_gaussian_options options;
  unsigned char bytes[1 << 16];
  conic_gaussians scene = intermediates_example(context, &options);
  CHECK_OK(conic_gaussian_intermediates_find(context, &scene, &intermediates_camera, &options, NULL, &found));
  CHECK_OK(conic_gaussian_intermediates_write(context, files_path("seed.npz"), &found));
  add_file(set, "intermediates", files_path("seed.npz"), bytes, sizeof bytes);
  conic_gaussian_intermediates_release(context, &found);
  conic_gaussians_release(context, &scene);
}

/* A pixel with a text. */
static void seeds_shots(seed_set *set, conic_context *context) {
  static const char tiff[] = "II*\0\10\0\0\0\1\0\16\1\2\0\6\0\0\0\32\0\0\0\0\0\0\0{\"a\":1";
  unsigned char bytes[4096];
  conic_image image;
  CHECK_OK(conic_image_allocate(context, 1, 1, 1u << CONIC_PLANE_RGBA, &image));
  image.shot = "{\"conic_shot\": 1}";
  for (int i = 0; i < 2; i++)
    if (conic_image_write(context, files_path(i ? "seed.png" : "seed.exr"), &image) == CONIC_OK)
      add_file(set, "picture_shot", files_path(i ? "seed.png" : "seed.exr"), bytes, sizeof bytes);
  seeds_add(set, "picture_shot", "tif", 1, tiff, sizeof tiff - 1);
  conic_image_release(context, &image);
}

/* Points in any format that batches are read of. */
static void seeds_stream(seed_set *set) {
  static const char *const targets[] = {"ply", "las", "xyz", "pcd", "ptx", "e57", "obj"};
  for (int i = 0, n = set->n; i < n; i++)
    for (size_t k = 0; k < sizeof targets / sizeof *targets; k++)
      if (strcmp(set->seeds[i].target, targets[k]) == 0)
        seeds_add(set, "stream", targets[k], 1, set->seeds[i].bytes, set->seeds[i].n_bytes);
}

int main(int argc, char **argv) {
  if (argc != 2) {
    fprintf(stderr, "usage: %s FOLDER\n", argv[0]);
    return 2;
  }
  conic_context *context = files_context();
  seed_set *set = seeds_make(context);
  seeds_all_assimp(set);
  seeds_all_gltf(set);
  seeds_all_records(set);
  seeds_all_hierarchies(set);
  seeds_all_references(set);
  seeds_stream(set);
  seeds_intermediates(set, context);
  seeds_shots(set, context);
  seeds_sums(set, context);
  seeds_strips(set, context);
  seeds_branches(set);
  seeds_levels(set, context);
  seeds_text(set, "camera_path", "keys",
             "{\"up\": [0, 1, 0], \"keys\": [{\"time\": 0, \"place\": [0, 1, 5], \"target\": [0, 0, 0], \"fov\": 50}, "
             "{\"time\": 1.5, \"place\": [3, 1, 4], \"roll\": -10}, {\"time\": 2, \"target\": [1, 0, 0]}]}");
  seeds_text(set, "motion", "json",
             "[{\"frame\": 1, \"matrix\": [[1,0,0,0.25],[0,1,0,0],[0,0,1,0],[0,0,0,1]]},\n"
             " {\"input\": 2, \"frame\": -1.5, \"file\": \"walk.0001.ply\"}]\n");
  seeds_text(
      set, "shot", "json",
      "{\"conic_shot\": 1, \"conic\": \"0.6.0\", \"inputs\": [{\"name\": \"a \\\"b\\\".ply\", \"bytes\": 12, "
      "\"sha256\": \"82907b05ff270d1cb93fab619df708504259a9aa9214808f6563f59d1076fe3c\"}, {\"name\": \"m.mtl\", "
      "\"as\": \"part\", \"sampled\": true}],\n"
      "\"camera\": {\"width\": 6, \"height\": 4, \"fx\": 8.25, \"fy\": 8, \"cx\": 3, \"cy\": 2, \"cam_from_world\": "
      "[[1, 0, 0, 0.1], [0, 1, 0, 0], [0, 0, 1, -3e-5]], \"kind\": \"fisheye\"}, \"planes\": [\"rgba\", \"id\"],\n"
      "\"render\": {\"method\": \"ray\", \"lighting\": {\"is_given\": true, \"lights\": [{\"frame\": \"head\", "
      "\"color\": [1, 0.5, 0]}]}}, \"reading\": {\"gaussians\": true, \"where\": \"z > 1\", \"patches\": "
      "{\"surface\": {\"degree\": 2}}}, \"map\": {\"minimum\": [null, 0, null]}, \"way\": {\"kind\": \"cameras\", "
      "\"cameras\": [{\"width\": 1, \"height\": 1, \"fx\": 1, \"fy\": 1, \"cx\": 0, \"cy\": 0, \"cam_from_world\": "
      "[[0, 1, 0, 0], [0, 0, 1, 0], [1, 0, 0, 0]]}]}}");
  seeds_text(set, "suite", "json", SUITE_EXAMPLE);
  seeds_text(set, "input_places", "three", "0:1,2 -3e4;2:0 -1 0 5 1 0 0 6 0 0 1 7;1:2 0 0 .5 0 2 0 0 0 0 2 0 0 0 0 1");
  seeds_text(set, "http_response", "range",
             "HTTP/1.1 302 Found\r\nLocation: x\r\n\r\nHTTP/2 206\r\nContent-Range: bytes 0-65535/1234567\r\n"
             "Content-Length: 65536\r\nContent-Encoding: gzip\r\nETag: \"a-1\"\r\n\r\n");
  seeds_text(set, "frames", "frames",
             "conic frames 1\nkey 0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef\n"
             "file 82907b05ff270d1cb93fab619df708504259a9aa9214808f6563f59d1076fe3c 5831 a/f.0001.exr\nframe 0\n"
             "file 46e96ae1ec3d53ce1900ceecd503c342834f51d9fdd5dd8315fc8f8934906eed 57 b.exr\nframe 15\nfile 4");
  seeds_text(set, "frames", "branches",
             "conic frames 1\nkey 0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef\n"
             "file 82907b05ff270d1cb93fab619df708504259a9aa9214808f6563f59d1076fe3c 5831 1073741824-30.branch\n"
             "branch 1073741824 30 500\n");
  seeds_text(set, "filter", "lists", "classification = 2, 9 and not (intensity < 100 or z > 50)");
  seeds_text(set, "filter", "chain", "x >= -1.5e3 and y <= .5 or return_number != 1, 2, 3 and user_data = 7");
  seeds_text(set, "gaussians", "json",
             "{\"version\":1,\"lodLevels\":1,\"filenames\":[\"a.sog\"],\"tree\":{\"children\":[{\"lods\":{\"0\":"
             "{\"file\":0,\"offset\":0,\"count\":1}}}]}}");
  for (int i = 0; i < set->n; i++)
    write_seed(argv[1], &set->seeds[i]);
  for (int i = 0; i < set->n; i++)
    if (strcmp(set->seeds[i].target, "exr") == 0)
      write_packed_seed(argv[1], &set->seeds[i]);
  seeds_release(set);
  files_end(context);
  return check_result();
}
