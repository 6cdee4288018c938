/* Layered point clouds: every sample once and where it was, within the bounds that the index states; the same file
 * whatever the threads and memory; sets of every shape. */
#include "core/base/color.h"
#include "lod/layers/format/layers_code.h"
#include "lod/layers/format/layers_key.h"
#include "tests/support/layers_fixture.h"
#include "tests/support/random_numbers.h"

/* What of an input sample comes back: the step that it lies in on each axis, its normal's and its colour's codes. */
typedef struct expected {
  uint64_t key;
  uint8_t codes[5];
} expected;

static int compare_expected(const void *a, const void *b) {
  const expected *first = a, *second = b;
  if (first->key != second->key)
    return first->key < second->key ? -1 : 1;
  return memcmp(first->codes, second->codes, sizeof first->codes);
}

static void normal_of(const conic_splats *splats, size_t i, float normal[3]) {
  double u[3], v[3], length[2] = {0.0, 0.0};
  for (int axis = 0; axis < 3; axis++) {
    u[axis] = (double)splats->tangent_u[axis][i];
    v[axis] = (double)splats->tangent_v[axis][i];
    length[0] += u[axis] * u[axis];
    length[1] += v[axis] * v[axis];
  }
  for (int axis = 0; axis < 3; axis++) {
    int b = (axis + 1) % 3, c = (axis + 2) % 3;
    normal[axis] = (float)((u[b] * v[c] - u[c] * v[b]) / sqrt(length[0] * length[1]));
  }
}

static expected *expect_input(const conic_splats *splats, const conic_layers_header *header) {
  expected *list = calloc(splats->count, sizeof *list);
  float thresholds[255];
  conic_srgb_thresholds(thresholds);
  for (size_t i = 0; i < splats->count && list; i++) {
    uint32_t steps[3];
    float normal[3];
    for (int axis = 0; axis < 3; axis++) {
      double from_corner = (splats->origin[axis] - header->origin[axis]) + (double)splats->position[axis][i];
      steps[axis] = (uint32_t)floor(from_corner / header->quantum);
      list[i].codes[2 + axis] = conic_srgb_code(thresholds, splats->color[axis][i]);
    }
    list[i].key = conic_layers_key(steps[0], steps[1], steps[2]);
    normal_of(splats, i, normal);
    conic_layers_code_normal(normal, list[i].codes);
    conic_layers_normal_of(list[i].codes, normal); /* on the equator there are two codes of one normal */
    conic_layers_code_normal(normal, list[i].codes);
  }
  qsort(list, splats->count, sizeof *list, compare_expected);
  return list;
}

static expected *expect_decoded(const layers_all *all) {
  expected *list = calloc(all->n, sizeof *list);
  float thresholds[255];
  conic_srgb_thresholds(thresholds);
  if (!list)
    return NULL;
  for (size_t i = 0; i < all->n; i++) {
    list[i].key = all->samples[i].key;
    conic_layers_code_normal(all->samples[i].normal, list[i].codes);
    for (int channel = 0; channel < 3; channel++)
      list[i].codes[2 + channel] = conic_srgb_code(thresholds, all->samples[i].color[channel]);
  }
  qsort(list, all->n, sizeof *list, compare_expected);
  return list;
}

/* Every sample of the input once, and no other; a key's position is within half a step of all that lies in the step. */
static void check_samples(const conic_splats *splats, const layers_all *all) {
  const conic_layers_header *header = &all->view.header;
  CHECK(all->n == splats->count && header->n_samples == splats->count);
  if (all->n != splats->count)
    return;
  expected *in = expect_input(splats, header), *out = expect_decoded(all);
  size_t n_others = 0, n_moved = 0;
  for (size_t i = 0; i < all->n; i++) {
    n_others += compare_expected(&in[i], &out[i]) ? 1 : 0;
    for (int axis = 0; axis < 3; axis++) {
      double middle = ((double)conic_layers_step(all->samples[i].key, axis) + 0.5) * header->quantum;
      n_moved += fabs((double)all->samples[i].position[axis] - middle) <= 1e-6 * fabs(middle) ? 0 : 1;
    }
  }
  CHECK(n_others == 0);
  CHECK(n_moved == 0);
  CHECK(conic_layers_position_error(header) >= 0.866 * header->quantum);
  free(in);
  free(out);
}

static double distance(const float a[3], const float b[3]) {
  double sum = 0.0;
  for (int axis = 0; axis < 3; axis++)
    sum += ((double)a[axis] - (double)b[axis]) * ((double)a[axis] - (double)b[axis]);
  return sqrt(sum);
}

static int is_above(const layers_all *all, uint32_t cloud, uint32_t node) {
  while (cloud < node)
    node = all->view.entries[node].parent;
  return cloud == node;
}

/* One node against all samples in its place, by brute force. */
static void check_node(const layers_all *all, uint32_t i_node) {
  const conic_layers_entry *entry = &all->view.entries[i_node];
  uint64_t last = conic_layers_last_key(&all->view.header, entry);
  size_t n_place = 0, n_drawn = 0, n_bare = 0, n_outside = 0, n_turned = 0;
  const layers_sample **place = calloc(all->n, sizeof(void *)), **drawn = calloc(all->n, sizeof(void *));
  for (size_t i = 0; i < all->n; i++) {
    const layers_sample *sample = &all->samples[i];
    if (sample->key < entry->key || sample->key > last)
      continue;
    place[n_place++] = sample;
    if (is_above(all, sample->cloud, i_node))
      drawn[n_drawn++] = sample;
  }
  for (size_t i = 0; i < n_place; i++) {
    double nearest = HUGE_VAL, cosine = 0.0;
    for (size_t k = 0; k < n_drawn && nearest > (double)entry->covering; k++) {
      double to = distance(place[i]->position, drawn[k]->position);
      nearest = to < nearest ? to : nearest;
    }
    n_bare += nearest <= (double)entry->covering ? 0 : 1;
    n_outside += distance(place[i]->position, entry->center) + (double)entry->radius <= (double)entry->sphere ? 0 : 1;
    for (int axis = 0; axis < 3; axis++)
      cosine += (double)place[i]->normal[axis] * (double)entry->axis[axis];
    n_turned += entry->cone <= -1.0f || cosine >= (double)entry->cone ? 0 : 1;
  }
  CHECK(n_place == entry->n_place && n_drawn == entry->n_drawn);
  CHECK(n_bare == 0 && n_outside == 0 && n_turned == 0);
  CHECK(entry->child || n_place == n_drawn);
  if (entry->child) { /* as far as a sample stands for others, or as large as it is itself; and no larger */
    float below = fmaxf(all->view.entries[entry->child].radius, all->view.entries[entry->child + 1].radius);
    CHECK(entry->radius >= entry->covering && entry->radius >= below);
    CHECK(entry->radius <= 1.0001f * fmaxf(entry->covering, below));
  }
  CHECK(entry->child ? entry->error > 0.0f : entry->error == 0.0f);
  free(place);
  free(drawn);
}

static void check_sound(conic_context *context, const char *path) {
  conic_layers_defects found;
  CHECK_OK(conic_layers_check(context, path, &found));
  CHECK(found.clouds == 0 && found.coverage == 0 && found.spheres == 0 && found.cones == 0);
}

static conic_layers_options options_for(uint32_t cloud_size, double quantum) {
  conic_layers_options options;
  conic_layers_options_init(&options);
  options.cloud_size = cloud_size;
  options.quantum = quantum;
  return options;
}

/* Small sets: all that can be said of them, by brute force. */
static void test_scene(conic_context *context, conic_scene_type type, size_t n, double offset, double quantum) {
  const char *path = files_path("scene.lpc");
  conic_layers_options options = options_for(64, quantum);
  conic_layers_statistics statistics;
  conic_layers_info info;
  conic_splats splats;
  layers_all all;
  layers_scene(context, type, n, offset, &splats);
  CHECK_OK(layers_build(context, &splats, path, &options, &statistics));
  layers_read(context, path, &all);
  check_samples(&splats, &all);
  for (uint32_t i = 0; i < all.view.header.n_clouds; i++)
    check_node(&all, i);
  check_sound(context, path);
  CHECK_OK(conic_layers_describe(context, path, &info));
  double low[3], high[3], length, spacing;
  conic_splats_bounds(&splats, low, high);
  for (int axis = 0; axis < 3; axis++)
    CHECK(info.minimum[axis] == low[axis] && info.maximum[axis] == high[axis]);
  CHECK_OK(conic_splats_length(context, &splats, &length));
  CHECK_OK(conic_splats_spacing(context, &splats, &spacing));
  CHECK_NEAR(info.splat_radius / (1.5 * length), 1.0, 0.035);
  CHECK_NEAR(info.spacing / spacing, 1.0, 0.02);
  CHECK_NEAR(info.quantum / (quantum * spacing), 1.0, 0.02);
  CHECK_NEAR(info.near_z / conic_default_near(&splats), 1.0, 1e-12);
  CHECK(info.n_samples == n && info.n_clouds == statistics.n_clouds && info.n_bytes == statistics.n_bytes);
  CHECK(statistics.n_in == n && statistics.n_samples == n && info.has_colors && !info.is_unoriented);
  CHECK(info.most_samples <= 3 * 64);
  double bits = info.bits_position + info.bits_normal + info.bits_color + info.bits_index + info.bits_more;
  CHECK_NEAR(bits, 8.0 * (double)info.n_bytes / (double)n, 1e-9);
  layers_release(&all);
  conic_splats_release(context, &splats);
  CHECK(unlink(path) == 0);
}

static size_t read_file(const char *path, unsigned char **bytes) {
  FILE *file = fopen(path, "rb");
  size_t room = 1 << 22;
  *bytes = malloc(room);
  if (!file || !*bytes)
    exit(1);
  size_t n = fread(*bytes, 1, room, file);
  fclose(file);
  return n;
}

/* Threads, and memory so small that everything goes through files, change no byte. */
static void test_same(void) {
  static const struct {
    int threads;
    uint64_t memory_bytes;
  } ways[] = {{1, UINT64_C(1) << 30}, {2, UINT64_C(1) << 30}, {7, UINT64_C(1) << 30}, {2, 1 << 16}, {1, 1 << 20}};
  unsigned char *first = NULL;
  size_t n_first = 0;
  for (size_t i = 0; i < sizeof ways / sizeof *ways; i++) {
    conic_context *context = check_context(ways[i].threads);
    conic_layers_options options = options_for(100, 0.5);
    conic_splats splats;
    const char *path = files_path("same.lpc");
    options.memory_bytes = ways[i].memory_bytes;
    layers_scene(context, CONIC_SCENE_KNOT, 20000, 0.0, &splats);
    CHECK_OK(layers_build(context, &splats, path, &options, NULL));
    check_sound(context, path);
    unsigned char *bytes;
    size_t n = read_file(path, &bytes);
    if (i == 0) {
      first = bytes;
      n_first = n;
    } else {
      CHECK(n == n_first && memcmp(bytes, first, n) == 0);
      free(bytes);
    }
    conic_splats_release(context, &splats);
    CHECK(unlink(path) == 0);
    conic_context_destroy(context);
  }
  free(first);
}

typedef void place_samples(uint64_t *state, size_t i, float position[3]);

/* NOLINTBEGIN(readability-non-const-parameter): others draw from the state */
static void coincident(uint64_t *state, size_t i, float position[3]) {
  (void)state;
  (void)i;
  position[0] = 1.0f;
  position[1] = 2.0f;
  position[2] = 3.0f;
}

static void two_places(uint64_t *state, size_t i, float position[3]) {
  coincident(state, i, position);
  position[0] = i % 5 ? 1.0f : -1.0f;
}

static void on_a_line(uint64_t *state, size_t i, float position[3]) {
  (void)state;
  position[0] = (float)i;
  position[1] = position[2] = 0.0f;
}

/* NOLINTEND(readability-non-const-parameter) */

/* Nine tenths in a clump, the others far away: of very uneven density. */
static void clumped(uint64_t *state, size_t i, float position[3]) {
  float width = i % 10 ? 1e-3f : 1e3f;
  for (int axis = 0; axis < 3; axis++)
    position[axis] = width * (float)(random_unit(state) - 0.5);
}

static void in_a_volume(uint64_t *state, size_t i, float position[3]) {
  (void)i;
  for (int axis = 0; axis < 3; axis++)
    position[axis] = (float)random_unit(state);
}

static void half_unusable(uint64_t *state, size_t i, float position[3]) {
  in_a_volume(state, i, position);
  if (i % 2)
    position[i % 3] = i % 4 == 1 ? NAN : INFINITY;
}

static void test_shape(conic_context *context, place_samples *place, size_t n, size_t n_usable) {
  const char *path = files_path("shape.lpc");
  conic_layers_options options = options_for(64, 0.5);
  conic_layers_statistics statistics;
  conic_splats splats;
  uint64_t state = 3;
  CHECK_OK(conic_splats_allocate(context, n, CONIC_SPLATS_NORMALS, &splats));
  for (size_t i = 0; i < n; i++) {
    float position[3];
    place(&state, i, position);
    for (int axis = 0; axis < 3; axis++) {
      splats.position[axis][i] = position[axis];
      splats.normal[axis][i] = axis == (int)(i % 3) ? -2.0f : 0.5f;
    }
  }
  CHECK_OK(layers_build(context, &splats, path, &options, &statistics));
  CHECK(statistics.n_in == n && statistics.n_samples == n_usable && statistics.n_nan == n - n_usable);
  CHECK(statistics.n_levels < 40);
  check_sound(context, path);
  layers_all all;
  layers_read(context, path, &all);
  CHECK(all.n == n_usable);
  for (uint32_t i = 0; i < all.view.header.n_clouds; i++)
    CHECK(all.view.entries[i].n_samples <= 3 * 64);
  layers_release(&all);
  conic_splats_release(context, &splats);
  CHECK(unlink(path) == 0);
}

/* Points alone: their normals are those of the surface, to what its curvature and the steps leave; memory and threads
 * change nothing here either. */
static void test_bare(void) {
  static const struct {
    int threads;
    uint64_t memory_bytes;
  } ways[] = {{1, UINT64_C(1) << 30}, {3, UINT64_C(1) << 30}, {2, 1 << 16}};
  unsigned char *first = NULL;
  size_t n_first = 0;
  for (size_t i = 0; i < sizeof ways / sizeof *ways; i++) {
    conic_context *context = check_context(ways[i].threads);
    const char *path = files_path("bare.lpc");
    conic_layers_options options = options_for(64, 0.5);
    conic_layers_statistics statistics;
    conic_splats splats, points;
    layers_all all;
    unsigned char *bytes;
    options.memory_bytes = ways[i].memory_bytes;
    layers_scene(context, CONIC_SCENE_SPHERE, 40000, 0.0, &splats);
    points = (conic_splats){.count = splats.count};
    memcpy(points.position, splats.position, sizeof points.position);
    CHECK_OK(layers_build(context, &points, path, &options, &statistics));
    CHECK(statistics.n_zero == points.count);
    check_sound(context, path);
    layers_read(context, path, &all);
    CHECK(all.view.header.flags == CONIC_LAYERS_UNORIENTED);
    double sum = 0.0, least = 1.0;
    for (size_t k = 0; k < all.n; k++) {
      double cosine = 0.0, length = 0.0;
      for (int axis = 0; axis < 3; axis++) {
        double at = all.view.header.origin[axis] + (double)all.samples[k].position[axis];
        cosine += at * (double)all.samples[k].normal[axis];
        length += at * at;
      }
      cosine = fabs(cosine) / sqrt(length);
      sum += cosine;
      least = cosine < least ? cosine : least;
    }
    CHECK(sum / (double)all.n > 0.9995 && least > 0.97);
    layers_release(&all);
    size_t n = read_file(path, &bytes);
    if (first)
      CHECK(n == n_first && memcmp(first, bytes, n) == 0);
    free(first);
    first = bytes;
    n_first = n;
    conic_splats_release(context, &splats);
    CHECK(unlink(path) == 0);
    conic_context_destroy(context);
  }
  free(first);
}

/* A sphere that was scanned from its middle: all normals look there, and the file says that they have a side. */
static void test_seen_points(conic_context *context) {
  const char *path = files_path("seen.lpc");
  conic_layers_options options = options_for(64, 0.5);
  conic_splats splats, points;
  layers_all all;
  size_t n_inwards = 0;
  layers_scene(context, CONIC_SCENE_SPHERE, 5000, 0.0, &splats);
  points = (conic_splats){.count = splats.count};
  memcpy(points.position, splats.position, sizeof points.position);
  for (int axis = 0; axis < 3; axis++) {
    points.sight[axis] = splats.tangent_u[axis];
    for (size_t i = 0; i < splats.count; i++)
      points.sight[axis][i] = -points.position[axis][i];
  }
  CHECK_OK(layers_build(context, &points, path, &options, NULL));
  layers_read(context, path, &all);
  CHECK(all.view.header.flags == 0);
  for (size_t k = 0; k < all.n; k++) {
    double along = 0.0;
    for (int axis = 0; axis < 3; axis++)
      along +=
          (all.view.header.origin[axis] + (double)all.samples[k].position[axis]) * (double)all.samples[k].normal[axis];
    n_inwards += along < 0.0;
  }
  CHECK(all.n == points.count && n_inwards == all.n);
  layers_release(&all);
  conic_splats_release(context, &splats);
  CHECK(unlink(path) == 0);
}

/* Points anywhere on a square, clumped as chance has it: their outlines leave no hole, and are no larger for it than
 * twice what a lattice needs on average. */
static void test_random_square(conic_context *context) {
  enum { N = 3000, PROBES = 60 };
  const char *path = files_path("square.lpc");
  conic_layers_options options = options_for(64, 0.5);
  conic_splats points;
  layers_all all;
  uint64_t state = 5;
  double sum = 0.0;
  int n_holes = 0;
  CHECK_OK(conic_splats_allocate(context, N, 0, &points));
  for (size_t i = 0; i < N; i++)
    for (int axis = 0; axis < 3; axis++)
      points.position[axis][i] = axis < 2 ? (float)random_unit(&state) : 0.0f;
  CHECK_OK(layers_build(context, &points, path, &options, NULL));
  layers_read(context, path, &all);
  for (int probe = 0; probe < PROBES * PROBES; probe++) {
    double x = 0.1 + 0.8 * (probe % PROBES) / PROBES, y = 0.1 + 0.8 * (int)(probe / PROBES) / PROBES;
    int is_covered = 0;
    for (size_t k = 0; k < all.n && !is_covered; k++) {
      double dx = all.view.header.origin[0] + (double)all.samples[k].position[0] - x;
      double dy = all.view.header.origin[1] + (double)all.samples[k].position[1] - y;
      is_covered = dx * dx + dy * dy <= (double)(all.samples[k].outline * all.samples[k].outline);
    }
    n_holes += !is_covered;
  }
  for (size_t k = 0; k < all.n; k++)
    sum += (double)all.samples[k].outline;
  CHECK(all.n == N && n_holes == 0);
  CHECK(sum / N < 2.0 / sqrt(2.0 * N));
  layers_release(&all);
  conic_splats_release(context, &points);
  CHECK(unlink(path) == 0);
}

/* One disc that is much larger than the others does not make them as large. */
static void test_sizes(conic_context *context) {
  const char *path = files_path("sizes.lpc");
  conic_layers_options options = options_for(64, 0.5);
  conic_layers_info before, after;
  conic_splats splats;
  layers_scene(context, CONIC_SCENE_SPHERE, 150, 0.0, &splats); /* a leaf */
  CHECK_OK(layers_build(context, &splats, path, &options, NULL));
  CHECK_OK(conic_layers_describe(context, path, &before));
  for (int axis = 0; axis < 3; axis++)
    splats.tangent_v[axis][7] *= 50.0f;
  CHECK_OK(layers_build(context, &splats, path, &options, NULL));
  CHECK_OK(conic_layers_describe(context, path, &after));
  CHECK(after.splat_radius == before.splat_radius);
  conic_splats_release(context, &splats);
  CHECK(unlink(path) == 0);
}

static void test_refused(conic_context *context) {
  const char *path = files_path("refused.lpc");
  conic_layers_options options = options_for(64, 0.5);
  conic_splats splats, empty = {0};
  conic_layers_builder *builder;
  layers_scene(context, CONIC_SCENE_SPHERE, 100, 0.0, &splats);
  files_check_failed("nothing", layers_build(context, &empty, path, NULL, NULL),
                     "refused.lpc: not written: there is no sample", NULL);
  for (size_t i = 0; i < splats.count; i++)
    splats.position[1][i] = NAN;
  files_check_failed("nothing finite", layers_build(context, &splats, path, NULL, NULL), "no sample", NULL);
  CHECK_OK(conic_layers_builder_open(context, path, &options, &builder));
  CHECK_OK(conic_layers_builder_append(builder, &splats));
  conic_splats grey = splats;
  grey.color[0] = grey.color[1] = grey.color[2] = NULL;
  CHECK(conic_layers_builder_append(builder, &grey) == CONIC_ERROR_ARGUMENT);
  conic_layers_builder_abandon(builder);
  options.cloud_size = 3;
  CHECK(conic_layers_builder_open(context, path, &options, &builder) == CONIC_ERROR_ARGUMENT && !builder);
  options = options_for(64, -1.0);
  CHECK(conic_layers_builder_open(context, path, &options, &builder) == CONIC_ERROR_ARGUMENT && !builder);
  CHECK(access(path, F_OK) != 0);
  CHECK(!conic_layers_is_file("/dev/null") && !conic_layers_is_file(files_folder));
  conic_splats_release(context, &splats);
}

int main(void) {
  if (layers_are_missing()) {
    fprintf(stderr, "skipped: this build has no zstd\n");
    return 77;
  }
  conic_context *context = files_context();
  test_scene(context, CONIC_SCENE_SPHERE, 4000, 0.0, 0.5);
  test_scene(context, CONIC_SCENE_GYROID, 4000, 0.0, 0.5);
  test_scene(context, CONIC_SCENE_KNOT, 3000, 1e6, 0.125);
  test_scene(context, CONIC_SCENE_TERRAIN, 100, 0.0, 0.01);
  test_same();
  test_shape(context, coincident, 1, 1);
  test_shape(context, coincident, 3000, 3000);
  test_shape(context, two_places, 3000, 3000);
  test_shape(context, on_a_line, 3000, 3000);
  test_shape(context, clumped, 5000, 5000);
  test_shape(context, in_a_volume, 5000, 5000);
  test_shape(context, half_unusable, 2000, 1000);
  test_bare();
  test_seen_points(context);
  test_random_square(context);
  test_sizes(context);
  test_refused(context);
  files_end(context);
  return check_result();
}
