/* A layered point cloud that is built in several goes, each by another number of processes and ended somewhere, is the
 * one that is built in one, byte for byte. */
#include <dirent.h>

#include "core/files/sha256.h"
#include "lod/layers/build/layers_team.h"
#include "tests/support/layers_fixture.h"
#include "tests/support/sanitized.h"
#include "tests/support/thread_team.h"

static char key[CONIC_SHA256_ROOM] = "0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef";

/* Part of the way: how many processes, and where each of them is stopped, at how much of what. */
typedef struct go {
  int count;
  const char *task;
  double fraction;
} go;

typedef struct kept_case {
  const conic_splats *splats;
  conic_layers_options options;
  const char *path;
  conic_layers_keeping keeping;
  go now;
  uint64_t n_finished;
  conic_status statuses[THREAD_TEAM_MOST];
} kept_case;

static int stop_there(void *cookie, const char *task, double fraction) {
  const kept_case *c = cookie;
  return c->now.task && strcmp(task, c->now.task) == 0 && fraction >= c->now.fraction;
}

static conic_splats rows_of(const conic_splats *splats, size_t first, size_t count) {
  conic_splats part = *splats;
  part.count = count;
  float **arrays[] = {part.position, part.tangent_u, part.tangent_v, part.normal, part.color, part.sight};
  for (int i = 0; i < 18; i++)
    if (arrays[i / 3][i % 3])
      arrays[i / 3][i % 3] += first;
  return part;
}

static void build_rows(const conic_team *team, void *cookie) {
  kept_case *c = cookie;
  conic_context_options options;
  conic_context *context;
  conic_layers_builder *builder;
  conic_context_options_init(&options);
  options.threads = 1 + team->index % 2;
  options.log = NULL;
  options.progress = stop_there;
  options.progress_cookie = c;
  if (conic_context_create(&options, &context) != CONIC_OK)
    exit(1);
  conic_status status = conic_layers_builder_open_team(context, c->path, &c->options, team, &c->keeping, &builder);
  size_t n = c->splats->count, first = n * (size_t)team->index / (size_t)team->count,
         end = n * (size_t)(team->index + 1) / (size_t)team->count;
  if (status == CONIC_OK) {
    conic_splats rows = rows_of(c->splats, first, end - first);
    if (team->index == 0)
      c->n_finished = conic_layers_builder_finished(builder);
    status = conic_layers_builder_append(builder, &rows);
    if (status == CONIC_OK)
      status = conic_layers_builder_finish(builder, NULL);
    else
      conic_layers_builder_abandon(builder);
  }
  c->statuses[team->index] = status;
  conic_context_destroy(context);
}

static int are_same_files(const char *a, const char *b) {
  unsigned char *first, *second;
  size_t n = files_read(a, &first), n_second = files_read(b, &second);
  int same = n > 0 && n == n_second && memcmp(first, second, n) == 0;
  free(first);
  free(second);
  return same;
}

/* How many files of a folder have that ending; the last one's path. 0: there is none, or no folder. */
static int list_files(const char *folder, const char *ending, char *path, size_t room) {
  DIR *listing = opendir(folder);
  int n = 0;
  for (struct dirent *entry; listing && (entry = readdir(listing));) {
    size_t length = strlen(entry->d_name), n_ending = strlen(ending);
    if (length <= n_ending || strcmp(entry->d_name + length - n_ending, ending) != 0)
      continue;
    n++;
    snprintf(path, room, "%s/%s", folder, entry->d_name);
  }
  if (listing)
    closedir(listing);
  return n;
}

static void take_go(kept_case *c, go now, int goes_on, int may_begin) {
  c->now = now;
  c->keeping = (conic_layers_keeping){key, goes_on, may_begin};
  thread_team_run(now.count, build_rows, c);
}

/* Goes until one is not stopped. What is found each time has become more. */
static void check_goes(const char *whole, kept_case *c, const go *goes) {
  char folder[FOLDER_ROOM + 128], file[FOLDER_ROOM + 512];
  uint64_t n_before = 0;
  snprintf(folder, sizeof folder, "%s.branches", c->path);
  for (int i = 0;; i++) {
    take_go(c, goes[i], i > 0, 0);
    int is_last = !goes[i].task;
    for (int k = 0; k < goes[i].count; k++)
      CHECK((c->statuses[k] == CONIC_OK) == is_last);
    CHECK(i == 0 ? c->n_finished == 0 : c->n_finished > n_before);
    n_before = i == 0 ? 0 : c->n_finished;
    if (is_last)
      break;
    CHECK(list_files(folder, ".list", file, sizeof file) == goes[i].count);
    CHECK(list_files(folder, ".branch", file, sizeof file) > 0);
  }
  CHECK(access(folder, F_OK) != 0);
  CHECK(are_same_files(whole, c->path));
  CHECK(unlink(c->path) == 0);
}

static kept_case case_of(conic_context *context, const conic_splats *splats, const char *whole) {
  kept_case c = {.splats = splats, .path = files_path("kept.lpc")};
  conic_layers_options_init(&c.options);
  c.options.cloud_size = 64;
  CHECK_OK(layers_build(context, splats, whole, &c.options, NULL));
  return c;
}

/* So that the median of all outlines is not that of a few branches. */
static void enlarge_along_x(conic_splats *splats) {
  for (size_t i = 0; i < splats->count; i++)
    for (int axis = 0; axis < 3; axis++) {
      float factor = 1.0f + 0.2f * (splats->position[0][i] + 2.0f);
      splats->tangent_u[axis][i] *= factor;
      splats->tangent_v[axis][i] *= factor;
    }
}

static void test_goes(conic_context *context) {
  static const go half[] = {{1, "build", 0.5}, {1, NULL, 0.0}}, ranks[] = {{3, "build", 0.3}, {2, NULL, 0.0}},
                  many[] = {{1, "build", 0.2}, {3, "build", 0.3}, {2, "build", 0.5}, {4, NULL, 0.0}},
                  late[] = {{2, "write", 0.0}, {3, NULL, 0.0}}, crown[] = {{2, "build", 1.0}, {1, NULL, 0.0}};
  const char *whole = files_path("whole.lpc");
  conic_splats splats;
  layers_scene(context, CONIC_SCENE_KNOT, 12000, 0.0, &splats);
  enlarge_along_x(&splats);
  kept_case c = case_of(context, &splats, whole);
  if (!IS_SANITIZED) {
    check_goes(whole, &c, half);
    check_goes(whole, &c, ranks);
    check_goes(whole, &c, late);
    check_goes(whole, &c, crown);
  }
  check_goes(whole, &c, many);
  c.options.memory_bytes = 1 << 16; /* branches wait in files */
  check_goes(whole, &c, ranks);
  c.options.memory_bytes = UINT64_C(1) << 30;
  c.options.keeps_all = 1;
  CHECK_OK(layers_build(context, &splats, whole, &c.options, NULL));
  check_goes(whole, &c, ranks);
  conic_splats_release(context, &splats);
}

/* Points that get their normals from their neighbours; so many coincide that they are parted, one lies far out. */
static void test_points_that_coincide(conic_context *context) {
  static const go goes[] = {{1, "build", 0.4}, {3, "build", 0.5}, {2, NULL, 0.0}};
  const char *whole = files_path("whole.lpc");
  conic_splats splats;
  layers_scene(context, CONIC_SCENE_SPHERE, 20000, 0.0, &splats);
  conic_splats points = {.count = splats.count};
  memcpy(points.position, splats.position, sizeof points.position);
  for (size_t i = 8000; i < 12000; i++)
    for (int axis = 0; axis < 3; axis++)
      points.position[axis][i] = 0.5f;
  points.position[0][777] = 40.0f;
  kept_case c = case_of(context, &points, whole);
  check_goes(whole, &c, goes);
  conic_splats_release(context, &splats);
}

static void append_text(const char *path, const char *text) {
  FILE *file = fopen(path, "ab");
  CHECK(file && fputs(text, file) >= 0 && fclose(file) == 0);
}

static void copy_list(const char *list, const char *folder) {
  unsigned char *bytes;
  char path[FOLDER_ROOM + 512];
  size_t n = files_read(list, &bytes);
  snprintf(path, sizeof path, "%s/7.list", folder);
  FILE *file = fopen(path, "wb");
  CHECK(file && fwrite(bytes, 1, n, file) == n && fclose(file) == 0);
  free(bytes);
}

/* What is not as it was written is made again; what is of another key, or not there, is told of and left alone. */
static void test_damaged_branches(conic_context *context) {
  static const go stopped = {2, "build", 0.5}, alone = {1, NULL, 0.0};
  char folder[FOLDER_ROOM + 128], file[FOLDER_ROOM + 512], list[FOLDER_ROOM + 512];
  const char *whole = files_path("whole.lpc");
  conic_splats splats;
  layers_scene(context, CONIC_SCENE_KNOT, 12000, 0.0, &splats);
  kept_case c = case_of(context, &splats, whole);
  snprintf(folder, sizeof folder, "%s.branches", c.path);
  take_go(&c, alone, 1, 0);
  CHECK(c.statuses[0] == CONIC_ERROR_INPUT && access(folder, F_OK) != 0);

  take_go(&c, stopped, 1, 1);
  int n = list_files(folder, ".branch", file, sizeof file);
  CHECK(n > 8 && list_files(folder, ".list", list, sizeof list) == 2);
  take_go(&c, (go){1, "build", 0.0}, 1, 0); /* what there is without damage */
  uint64_t n_finished = c.n_finished;
  FILE *stream = fopen(file, "r+b");
  CHECK(stream && fseek(stream, 500, SEEK_SET) == 0);
  int byte = fgetc(stream);
  CHECK(fseek(stream, 500, SEEK_SET) == 0 && fputc(byte ^ 1, stream) != EOF && fclose(stream) == 0);
  CHECK(list_files(folder, ".list", list, sizeof list) == 1);
  copy_list(list, folder); /* as where a run was ended that had put lists together */
  append_text(list, "file 0123456789abcdef0123456789abcdef0123456789abcdef0123456789ab");
  key[0] = 'f';
  take_go(&c, alone, 1, 1);
  key[0] = '0';
  CHECK(c.statuses[0] == CONIC_ERROR_INPUT && list_files(folder, ".branch", file, sizeof file) == n);
  take_go(&c, alone, 1, 1);
  CHECK_OK(c.statuses[0]);
  CHECK(c.n_finished > 0 && c.n_finished < n_finished);
  CHECK(are_same_files(whole, c.path));

  take_go(&c, stopped, 0, 1);
  take_go(&c, (go){3, "sort", 0.0}, 0, 1); /* begins anew: nothing of before is left */
  CHECK(c.n_finished == 0 && list_files(folder, ".branch", file, sizeof file) == 0);
  take_go(&c, alone, 0, 1);
  CHECK_OK(c.statuses[0]);
  CHECK(access(folder, F_OK) != 0 && are_same_files(whole, c.path));
  CHECK(unlink(c.path) == 0 && unlink(whole) == 0);
  conic_splats_release(context, &splats);
}

int main(void) {
  conic_context *context = files_context();
  test_goes(context);
  test_points_that_coincide(context);
  test_damaged_branches(context);
  files_end(context);
  return check_result();
}
