/* Memory that runs out at the n-th allocation, for every n, on the way from a file to a picture: a clean error each
 * time, nothing leaked, nothing left behind. */
#include <dirent.h>
#include <stdatomic.h>

#include "tests/support/files.h"
#include "tests/support/las_file.h"

/* An allocator that counts, and fails at one call (and at no other, so that what cleans up is seen to work). */
typedef struct allocator {
  atomic_long n_calls, n_alive;
  long failing_call; /* from 1; 0: none */
} allocator;

static allocator memory;
static int n_messages;

static void *allocate(void *cookie, size_t bytes) {
  allocator *self = cookie;
  if (atomic_fetch_add(&self->n_calls, 1) + 1 == self->failing_call)
    return NULL;
  void *pointer = malloc(bytes);
  if (pointer)
    atomic_fetch_add(&self->n_alive, 1);
  return pointer;
}

static void release(void *cookie, void *pointer) {
  allocator *self = cookie;
  if (pointer)
    atomic_fetch_sub(&self->n_alive, 1);
  free(pointer);
}

static void count_message(void *cookie, conic_log_level level, const char *message) {
  (void)cookie;
  n_messages += level == CONIC_LOG_ERROR;
  files_log(NULL, level, message);
}

static conic_status open_context(int threads, conic_context **context) {
  conic_context_options options;
  conic_context_options_init(&options);
  options.allocate = allocate;
  options.release = release;
  options.allocator_cookie = &memory;
  options.log = count_message;
  options.threads = threads;
  return conic_context_create(&options, context);
}

static conic_status draw(conic_context *context, const conic_splats *splats, const conic_camera *camera,
                         conic_image *image) {
  conic_render_options options;
  conic_renderer *renderer = NULL;
  conic_render_options_init(&options);
  conic_status status = conic_renderer_create(context, &renderer);
  if (status == CONIC_OK)
    status = conic_image_allocate(context, camera->width, camera->height, CONIC_DRAWN_PLANES, image);
  for (int frame = 0; frame < 2 && status == CONIC_OK; frame++) /* the second reuses the first one's memory */
    status = conic_render(renderer, splats, camera, &options, image, NULL);
  conic_renderer_destroy(renderer);
  return status;
}

static conic_status write_and_read(conic_context *context, const char *path, const conic_image *image) {
  conic_image back;
  conic_status status = conic_image_write(context, path, image);
  if (status == CONIC_OK)
    status = conic_image_read(context, path, &back);
  if (status == CONIC_OK)
    conic_image_release(context, &back);
  unlink(path);
  return status;
}

static conic_status write_all(conic_context *context, const conic_splats *splats, const conic_image *image) {
  conic_status status = conic_splats_write(context, files_path("splats.ply"), splats, NULL);
  unlink(files_path("splats.ply"));
  if (status == CONIC_OK)
    status = write_and_read(context, files_path("picture.pfm"), image);
  if (status == CONIC_OK)
    status = write_and_read(context, files_path("picture.png"), image);
  if (status == CONIC_OK)
    status = write_and_read(context, files_path("picture.exr"), image);
  return status == CONIC_ERROR_UNSUPPORTED ? CONIC_OK : status; /* without the libraries there are none to be written */
}

static conic_status choose(conic_octree *octree, const conic_camera *camera, conic_context *context) {
  conic_selection selection;
  conic_selection_options options;
  conic_render_options render;
  memset(&selection, 0, sizeof selection);
  conic_selection_options_init(&options);
  conic_render_options_init(&render);
  conic_status status = conic_octree_select(octree, camera, &render, &options, &selection);
  options.budget = 50;
  if (status == CONIC_OK)
    status = conic_octree_select(octree, camera, &render, &options, &selection);
  conic_selection_release(context, &selection);
  return status;
}

/* Built, written, read, chosen from. */
static conic_status through_octree(conic_context *context, const conic_splats *splats, const conic_camera *camera,
                                   int quantize) {
  conic_splats copy, leaves;
  conic_octree *octree = NULL, *back = NULL;
  conic_octree_options options;
  const char *path = files_path("splats.cot");
  memset(&copy, 0, sizeof copy);
  memset(&leaves, 0, sizeof leaves);
  conic_octree_options_init(&options);
  options.quantize = quantize;
  conic_status status = conic_splats_append(context, &copy, splats);
  if (status == CONIC_OK)
    status = conic_octree_build(context, &copy, &options, &octree);
  if (status == CONIC_OK)
    status = conic_octree_write(octree, path);
  if (status == CONIC_OK)
    status = conic_octree_read(context, path, &back);
  unlink(path);
  if (status == CONIC_OK)
    status = conic_octree_leaves(back, &leaves);
  if (status == CONIC_OK)
    status = choose(back, camera, context);
  conic_splats_release(context, &copy);
  conic_splats_release(context, &leaves);
  conic_octree_destroy(octree);
  conic_octree_destroy(back);
  return status;
}

/* The whole way for one input; that of the first goes on to files, which the others would write alike. */
static conic_status run(const char *input, int threads) {
  conic_context *context;
  conic_model model;
  conic_camera camera;
  conic_image image;
  conic_estimate_options estimate;
  conic_estimate_options_init(&estimate);
  memset(&image, 0, sizeof image);
  conic_status status = open_context(threads, &context);
  if (status != CONIC_OK)
    return status;
  status = conic_model_read(context, files_path(input), NULL, &model);
  if (status == CONIC_OK)
    status = conic_model_to_splats(context, &estimate, &model, NULL);
  if (status == CONIC_OK)
    status = conic_splats_thin(context, &model.points, 150, 7);
  if (status == CONIC_OK)
    status = conic_camera_read(context, files_path("camera.json"), &camera);
  if (status == CONIC_OK)
    status = draw(context, &model.points, &camera, &image);
  const int is_first = strcmp(input, "points.ply") == 0;
  if (status == CONIC_OK && is_first)
    status = write_all(context, &model.points, &image);
  for (int quantize = 0; quantize < 2 && is_first && status == CONIC_OK; quantize++)
    status = through_octree(context, &model.points, &camera, quantize);
  conic_image_release(context, &image);
  conic_model_release(context, &model);
  conic_context_destroy(context);
  return status;
}

static int count_files(void) {
  int n = 0;
  DIR *folder = opendir(files_folder);
  for (const struct dirent *entry; folder && (entry = readdir(folder));)
    n += strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0;
  if (folder)
    closedir(folder);
  return n;
}

/* Returns how many allocations the whole way takes. */
static long test_input(const char *input, int threads) {
  int n_files = count_files();
  for (long n = 1;; n++) {
    int failures_before = check_failures;
    atomic_store(&memory.n_calls, 0);
    memory.failing_call = n;
    n_messages = 0;
    conic_status status = run(input, threads);
    if (atomic_load(&memory.n_calls) < n) {
      CHECK_OK(status);
      CHECK(atomic_load(&memory.n_alive) == 0);
      return n - 1;
    }
    CHECK(status == CONIC_ERROR_MEMORY);
    CHECK(n_messages == (n > 1)); /* without a context there is no log */
    CHECK(atomic_load(&memory.n_alive) == 0);
    CHECK(count_files() == n_files);
    if (check_failures > failures_before) {
      fprintf(stderr, "%s, %d threads, allocation %ld: status %d, %d messages, the last '%s', %ld blocks alive\n",
              input, threads, n, (int)status, n_messages, files_message, atomic_load(&memory.n_alive));
      return 0;
    }
  }
}

enum { N_POINTS = 300 };

static double coordinate(int i, int axis) {
  return axis == 0 ? i % 20 : axis == 1 ? i / 20 : 0.25 * ((i * 7) % 5);
}

static void write_ply(void) {
  FILE *file = fopen(files_path("points.ply"), "wb");
  if (!file)
    exit(1);
  fprintf(
      file,
      "ply\nformat ascii 1.0\nelement vertex %d\nproperty float x\nproperty float y\nproperty float z\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty list uchar int unknown\nend_header\n",
      N_POINTS);
  for (int i = 0; i < N_POINTS; i++)
    fprintf(file, "%g %g %g %d 100 50 1 7\n", coordinate(i, 0), coordinate(i, 1), coordinate(i, 2), i % 256);
  fclose(file);
}

static void write_obj(void) {
  FILE *file = fopen(files_path("mesh.obj"), "wb");
  if (!file)
    exit(1);
  fprintf(file, "vn 0 0 1\n");
  for (int i = 0; i < N_POINTS; i++)
    fprintf(file, "v %g %g %g%s\n", coordinate(i, 0), coordinate(i, 1), coordinate(i, 2), i == 7 ? " 1 0 0" : "");
  for (int i = 1; i + 21 <= N_POINTS; i++)
    fprintf(file, "f %d//1 %d//1 %d//1 %d//1\n", i, i + 1, i + 21, i + 20);
  fclose(file);
}

static void write_xyz(void) {
  FILE *file = fopen(files_path("points.xyz"), "wb");
  if (!file)
    exit(1);
  for (int i = 0; i < N_POINTS; i++)
    fprintf(file, "%g %g %g 200 %d 0 0 0 1\n", coordinate(i, 0), coordinate(i, 1), coordinate(i, 2), i % 256);
  fclose(file);
}

static void write_las(void) {
  las_file file = las_begin(2, 2, N_POINTS, 0);
  for (int i = 0; i < N_POINTS; i++) {
    las_set_point(&file, (size_t)i, (int32_t)coordinate(i, 0), (int32_t)coordinate(i, 1), (int32_t)coordinate(i, 2));
    las_set_color(&file, (size_t)i, 255, 0, (unsigned)i % 256);
  }
  files_write_bytes("points.las", file.bytes, file.n_bytes);
  free(file.bytes);
}

/* Where pictures repeat, a block that was kept comes back for one as large or up to half smaller; all are released in
 * the end. */
static void test_kept(int repeats, size_t size, int comes_back) {
  enum { KEPT = 5000 };
  conic_context_options options;
  conic_context *context;
  conic_context_options_init(&options);
  memory = (allocator){0};
  options.allocate = allocate;
  options.release = release;
  options.allocator_cookie = &memory;
  options.large_pages = repeats;
  options.threads = 1;
  CHECK_OK(conic_context_create(&options, &context));
  void *first = conic_memory_allocate(context, KEPT, 1);
  const long n_before = memory.n_alive;
  conic_memory_keep(context, first);
  CHECK(memory.n_alive == n_before - !repeats);
  void *second = conic_memory_allocate(context, size, 1);
  CHECK(memory.n_alive == n_before + (repeats && !comes_back));
  conic_memory_release(context, second);
  for (size_t k = 0; k < 12; k++) /* more than are kept */
    conic_memory_keep(context, conic_memory_allocate(context, ((size_t)10 << k) * KEPT, 1));
  conic_memory_keep(context, NULL);
  conic_context_destroy(context);
  CHECK(memory.n_alive == 0);
}

int main(void) {
  test_kept(0, 5000, 0);
  test_kept(1, 5000, 1);
  test_kept(1, 2500, 1);
  test_kept(1, 5001, 0);
  test_kept(1, 2499, 0);
  static const char *const inputs[] = {"points.ply", "mesh.obj", "points.xyz", "points.las"};
  conic_context *context = files_context(); /* for the folder */
  files_write("camera.json", "{\"width\": 48, \"height\": 40, \"fx\": 50, \"fy\": 50, \"cx\": 24, \"cy\": 20,\n"
                             "\"world_to_camera\": [[1,0,0,-10],[0,1,0,-7],[0,0,1,20],[0,0,0,1]]}");
  write_ply();
  write_obj();
  write_xyz();
  write_las();
  for (int i = 0; i < 4; i++) {
    long n = test_input(inputs[i], 1);
    fprintf(stderr, "%s: %ld allocations\n", inputs[i], n);
    CHECK(n > 50);
  }
  CHECK(test_input("points.ply", 3) > 50);
  for (int i = 0; i < 4; i++)
    unlink(files_path(inputs[i]));
  unlink(files_path("camera.json"));
  files_end(context);
  return check_result();
}
