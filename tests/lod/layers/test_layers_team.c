/* A layered point cloud that several processes build is the one that a single one builds, byte for byte; and where one
 * of them fails, all do, and nothing is left. */
#include <dirent.h>

#include "core/splats/point_values.h"
#include "lod/layers/build/layers_team.h"
#include "tests/support/layers_fixture.h"
#include "tests/support/thread_team.h"

/* What is built: a part of the samples for each process, in their order. */
typedef struct team_case {
  const conic_splats *splats;
  conic_layers_options options;
  const double *weights; /* of the processes' parts; null: all alike */
  const char *path;
  int failing; /* which process fails, at its first batch; -1: none */
  int refused; /* or, above 0, whose options have no meaning, which no process opens then */
  conic_status statuses[THREAD_TEAM_MOST];
  conic_layers_statistics statistics;
} team_case;

static conic_splats part_of(const conic_splats *splats, size_t first, size_t count, conic_point_values *values) {
  conic_splats part = *splats;
  part.count = count;
  float **arrays[] = {part.position, part.tangent_u, part.tangent_v, part.normal, part.color, part.sight};
  for (int i = 0; i < 18; i++)
    if (arrays[i / 3][i % 3])
      arrays[i / 3][i % 3] += first;
  if (splats->values) {
    *values = *splats->values;
    values->count = count;
    for (size_t k = 0; k < values->n; k++)
      values->value[k] += first;
    part.values = values;
  }
  return part;
}

static size_t start_of(const team_case *c, int index, int count) {
  double before = 0.0, all = 0.0;
  for (int i = 0; i < count; i++) {
    double weight = c->weights ? c->weights[i] : 1.0;
    before += i < index ? weight : 0.0;
    all += weight;
  }
  return (size_t)(before / all * (double)c->splats->count);
}

static void build_part(const conic_team *team, void *cookie) {
  team_case *c = cookie;
  conic_context_options options;
  conic_context *context;
  conic_layers_builder *builder;
  conic_point_values *values = calloc(1, sizeof *values);
  conic_context_options_init(&options);
  options.threads = 1 + team->index % 2;
  options.log = NULL;
  if (conic_context_create(&options, &context) != CONIC_OK || !values)
    exit(1);
  conic_layers_options own = c->options;
  own.cloud_size = c->refused > 0 && c->refused == team->index ? 1 : own.cloud_size;
  conic_status status = conic_layers_builder_open_team(context, c->path, &own, team, NULL, &builder);
  size_t first = start_of(c, team->index, team->count), end = start_of(c, team->index + 1, team->count), n;
  for (; first < end && status == CONIC_OK; first += n) {
    n = end - first < 700 ? end - first : 700;
    conic_splats batch = part_of(c->splats, first, n, values);
    status = c->failing == team->index ? CONIC_ERROR_INPUT : conic_layers_builder_append(builder, &batch);
  }
  if (status == CONIC_OK)
    status = conic_layers_builder_finish(builder, team->index == 0 ? &c->statistics : NULL);
  else
    conic_layers_builder_abandon(builder);
  c->statuses[team->index] = status;
  conic_context_destroy(context);
  free(values);
}

/* Against what one process builds, by several. */
static void check_case(conic_context *context, team_case *c, const int *counts) {
  unsigned char *alone = NULL, *together = NULL;
  conic_layers_statistics statistics;
  const char *path = files_path("alone.lpc");
  CHECK_OK(layers_build(context, c->splats, path, &c->options, &statistics));
  size_t n_alone = files_read(path, &alone);
  CHECK(n_alone > 0);
  c->path = files_path("together.lpc");
  for (; *counts; counts++) {
    thread_team_run(*counts, build_part, c);
    size_t n = files_read(c->path, &together);
    for (int i = 0; i < *counts; i++)
      CHECK_OK(c->statuses[i]);
    CHECK(n == n_alone && memcmp(alone, together, n) == 0);
    if (!(n == n_alone && memcmp(alone, together, n) == 0))
      fprintf(stderr, "%d processes: %zu bytes, alone %zu\n", *counts, n, n_alone);
    CHECK(c->statistics.n_in == statistics.n_in && c->statistics.n_samples == statistics.n_samples &&
          c->statistics.n_clouds == statistics.n_clouds && c->statistics.n_zero == statistics.n_zero);
    free(together);
    together = NULL;
    CHECK(unlink(c->path) == 0);
  }
  free(alone);
  CHECK(unlink(path) == 0);
}

static conic_layers_options small_clouds(void) {
  conic_layers_options options;
  conic_layers_options_init(&options);
  options.cloud_size = 64;
  return options;
}

static const int all_counts[] = {1, 2, 7, 0}, some_counts[] = {3, 0};

static void test_surface(conic_context *context) {
  conic_splats splats;
  team_case c = {.splats = &splats, .options = small_clouds(), .failing = -1};
  layers_scene(context, CONIC_SCENE_KNOT, 6000, 0.0, &splats);
  check_case(context, &c, all_counts);
  c.options.memory_bytes = 1 << 16; /* nearly all goes to files, and parcels are small */
  check_case(context, &c, some_counts);
  c.options.memory_bytes = UINT64_C(1) << 30;
  c.options.keeps_all = 1;
  check_case(context, &c, some_counts);
  conic_splats_release(context, &splats);
}

/* Most have nothing, among them the first; of some others the last takes nearly all. */
static void test_uneven(conic_context *context) {
  static const double last_alone[] = {0.0, 0.0, 1.0}, few[] = {0.001, 0.0, 1.0};
  static const int three[] = {3, 0};
  conic_splats splats;
  team_case c = {.splats = &splats, .options = small_clouds(), .failing = -1, .weights = last_alone};
  layers_scene(context, CONIC_SCENE_SPHERE, 3000, 1e6, &splats);
  check_case(context, &c, three);
  c.weights = few;
  check_case(context, &c, three);
  splats.count = 5; /* one leaf */
  check_case(context, &c, three);
  conic_splats_release(context, &splats);
}

/* Points that get their normals while the cloud is built; many coincide, and one lies far out. */
static void test_bare_points(conic_context *context) {
  conic_splats splats;
  team_case c = {.options = small_clouds(), .failing = -1};
  layers_scene(context, CONIC_SCENE_SPHERE, 6000, 0.0, &splats);
  conic_splats points = {.count = splats.count};
  memcpy(points.position, splats.position, sizeof points.position);
  for (size_t i = 3000; i < 3350; i++)
    for (int axis = 0; axis < 3; axis++)
      points.position[axis][i] = 0.5f;
  points.position[0][777] = 40.0f;
  c.splats = &points;
  check_case(context, &c, all_counts);
  conic_splats_release(context, &splats);
}

/* More samples than are looked at for the spacing and for what values are typical. */
static void test_values(conic_context *context) {
  conic_splats splats;
  team_case c = {.splats = &splats, .options = small_clouds(), .failing = -1};
  layers_scene(context, CONIC_SCENE_KNOT, 100000, 0.0, &splats);
  conic_point_values *values = calloc(1, sizeof *values);
  double *column = malloc(splats.count * sizeof *column);
  for (size_t i = 0; i < splats.count; i++)
    column[i] = i % 7 == 3 ? (double)NAN : (double)(i * 2654435761u % 100003);
  *values = (conic_point_values){.n = 1, .count = splats.count};
  snprintf(values->field[0].name, sizeof values->field[0].name, "echo");
  values->field[0].type = "uint16"; /* not all fit */
  values->value[0] = column;
  splats.values = values;
  c.options.cloud_size = 512;
  /* one batch of all: the fixture's batches have no values of their own */
  conic_layers_builder *builder;
  unsigned char *alone, *together;
  const char *path = files_path("values.lpc");
  CHECK_OK(conic_layers_builder_open(context, path, &c.options, &builder));
  CHECK_OK(conic_layers_builder_append(builder, &splats));
  CHECK_OK(conic_layers_builder_finish(builder, NULL));
  c.path = files_path("together.lpc");
  thread_team_run(3, build_part, &c);
  size_t n = files_read(path, &alone);
  CHECK(n > 0 && files_read(c.path, &together) == n && memcmp(alone, together, n) == 0);
  CHECK(unlink(path) == 0 && unlink(c.path) == 0);
  free(alone);
  free(together);
  splats.values = NULL;
  free(values);
  free(column);
  conic_splats_release(context, &splats);
}

static int count_entries(const char *folder) {
  DIR *listing = opendir(folder);
  int n = 0;
  while (listing && readdir(listing))
    n++;
  closedir(listing);
  return n;
}

/* All fail, only one of them for a reason of its own, and nothing is left behind. */
static void test_failing(conic_context *context) {
  conic_splats splats;
  layers_scene(context, CONIC_SCENE_SPHERE, 5000, 0.0, &splats);
  int n_entries = count_entries(files_folder);
  for (int failing = 0; failing < 3; failing++) {
    team_case c = {.splats = &splats, .options = small_clouds(), .failing = failing, .path = files_path("none.lpc")};
    thread_team_run(3, build_part, &c);
    for (int i = 0; i < 3; i++)
      CHECK(c.statuses[i] == (i == failing ? CONIC_ERROR_INPUT : CONIC_ERROR_CANCELLED));
  }
  team_case refused = {
      .splats = &splats, .options = small_clouds(), .failing = -1, .refused = 2, .path = files_path("none.lpc")};
  thread_team_run(3, build_part, &refused);
  for (int i = 0; i < 3; i++)
    CHECK(refused.statuses[i] == (i == 2 ? CONIC_ERROR_ARGUMENT : CONIC_ERROR_CANCELLED));
  team_case c = {.splats = &splats, .options = small_clouds(), .failing = -1};
  c.path = files_path("folder.lpc");
  CHECK(mkdir(c.path, 0777) == 0);
  thread_team_run(3, build_part, &c);
  CHECK(c.statuses[0] == CONIC_ERROR_IO && c.statuses[1] == CONIC_ERROR_CANCELLED);
  CHECK(rmdir(c.path) == 0);
  CHECK(count_entries(files_folder) == n_entries);
  conic_splats_release(context, &splats);
}

int main(void) {
  conic_context *context = files_context();
  test_surface(context);
  test_uneven(context);
  test_bare_points(context);
  test_values(context);
  test_failing(context);
  files_end(context);
  return check_result();
}
