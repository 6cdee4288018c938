/* Pictures of layered point clouds: one picture, whatever the memory, the cache, occlusion culling and threads; and
 * what else of it is promised. */
#include "tests/support/files.h"
#include "tests/support/image_fixture.h"
#include "tests/support/layers_frame.h"

static const char *path;

/* Draws both, and compares. */
static void expect_same(layers_frame *a, layers_frame *b, const char *what) {
  CHECK_OK(layers_draw(a));
  CHECK_OK(layers_draw(b));
  if (layers_same_picture(&a->f.image, &b->f.image))
    return;
  fprintf(stderr, "%s: another picture\n", what);
  check_failures++;
}

/* Error 0 is the picture of all samples, ids included; of those that face away, most are not even looked at one by one.
 */
static void check_whole(int cull_back) {
  layers_frame frame = layers_open(2, path, NULL);
  fixture *f = &frame.f;
  conic_image whole;
  f->options.cull_back = cull_back;
  frame.draw.occlusion = CONIC_OCCLUSION_OFF;
  CHECK_OK(layers_draw(&frame));
  CHECK_OK(conic_layers_splats(frame.layers, f->options.kernel.cutoff, &f->splats));
  CHECK(f->splats.count == (size_t)LAYERS_SHELLS * LAYERS_SHELL_SPLATS && frame.drawn.n_places_coarser == 0);
  CHECK_OK(conic_image_allocate(f->context, f->camera.width, f->camera.height, ALL_PLANES, &whole));
  conic_layers_scale scale;
  conic_layers_measure(frame.layers, f->options.kernel.cutoff, &scale);
  f->options.near_z = scale.near_z;
  f->options.splat_length = scale.splat_length;
  CHECK_OK(conic_render(f->renderer, &f->splats, &f->camera, &f->options, &whole, NULL));
  CHECK(layers_same_picture(&whole, &f->image));
  uint64_t n_turned = frame.drawn.n_splats_turned;
  CHECK(cull_back ? n_turned > 0 && f->statistics.splats_in < f->splats.count * 3 / 5 : n_turned == 0);
  CHECK(cull_back || f->statistics.splats_in == f->splats.count);
  conic_image_release(f->context, &whole);
  layers_close(&frame);
}

/* The camera within the shells, so that some of them reach near. */
static void step_inside(conic_camera *camera) {
  camera->cam_from_world[2][3] *= 0.2;
}

/* Occlusion culling changes nothing, and leaves much out. */
static void check_occlusion(void) {
  layers_frame on = layers_open(2, path, NULL), off = layers_open(2, path, NULL);
  uint64_t n_left = 0, n_places_left = 0;
  on.draw.occlusion = CONIC_OCCLUSION_ON;
  off.draw.occlusion = CONIC_OCCLUSION_OFF;
  conic_camera outside = on.f.camera;
  for (int i = 0; i < 3 * CONIC_N_METHODS; i++) {
    conic_render_options *o = &on.f.options;
    o->method = (conic_method)(i % CONIC_N_METHODS);
    o->passes = i / CONIC_N_METHODS == 1 ? 1 : 3;
    o->prefilter = i / CONIC_N_METHODS == 2 ? 0.0f : 1.0f;
    o->cull_back = i % 4 == 3;
    on.draw.error_px = i % 5 == 4 ? 2.0 : 0.0;
    on.f.camera = outside;
    if (i % 7 == 6)
      step_inside(&on.f.camera);
    off.f.options = on.f.options;
    off.f.camera = on.f.camera;
    off.draw.error_px = on.draw.error_px;
    expect_same(&on, &off, conic_method_name(o->method));
    CHECK(off.drawn.n_splats_left == 0 && off.drawn.n_places_hidden + off.drawn.n_places_grazing == 0);
    CHECK(on.drawn.n_splats_left + on.f.statistics.splats_in + on.drawn.n_splats_turned ==
          off.f.statistics.splats_in + off.drawn.n_splats_turned);
    CHECK(on.f.statistics.fragments <= off.f.statistics.fragments);
    n_left += on.drawn.n_splats_left;
    n_places_left += on.drawn.n_places_hidden;
    if (i == CONIC_METHOD_CONIC)
      CHECK(on.drawn.n_splats_left > off.f.statistics.splats_in / 2);
  }
  CHECK(n_left > 0 && n_places_left > 0);
  layers_close(&on);
  layers_close(&off);
}

static int same_counts(const conic_render_statistics *a, const conic_render_statistics *b) {
  for (int i = 0; i < CONIC_N_METHODS; i++)
    if (a->splats_by_method[i] != b->splats_by_method[i])
      return 0;
  return a->splats_in == b->splats_in && a->splats_culled == b->splats_culled &&
         a->splats_skipped == b->splats_skipped && a->splats_drawn == b->splats_drawn &&
         a->splats_fallback == b->splats_fallback && a->fragments == b->fragments &&
         a->pixels_covered == b->pixels_covered;
}

/* In a sixteenth of the memory that it would take: the same picture, in windows, with the same counts. */
static void check_memory(void) {
  conic_layers_access access;
  conic_layers_access_init(&access);
  layers_frame large = layers_open(2, path, &access);
  access.memory_bytes = (uint64_t)1 << 20;
  layers_frame small = layers_open(2, path, &access);
  for (int i = 0; i < 4; i++) {
    small.f.options.cull_back = large.f.options.cull_back = i & 1;
    small.draw.occlusion = large.draw.occlusion = i & 2 ? CONIC_OCCLUSION_ON : CONIC_OCCLUSION_OFF;
    small.f.options.method = large.f.options.method = i == 2 ? CONIC_METHOD_AUTO : CONIC_METHOD_CONIC;
    expect_same(&large, &small, "little memory");
    CHECK(large.drawn.n_bands == 1 && small.drawn.n_bands > 3);
    if (!(i & 2)) /* what is found to be hidden depends on the shares that are drawn */
      CHECK(same_counts(&large.f.statistics, &small.f.statistics));
  }
  small.draw.samples = 2;
  large.draw.samples = 2;
  expect_same(&large, &small, "samples in little memory");
  CHECK(same_counts(&large.f.statistics, &small.f.statistics));
  layers_close(&large);
  layers_close(&small);
}

static void check_cache_and_threads(void) {
  layers_frame one = layers_open(1, path, NULL), seven = layers_open(7, path, NULL);
  one.draw.occlusion = seven.draw.occlusion = CONIC_OCCLUSION_ON;
  expect_same(&one, &seven, "threads");
  CHECK(one.drawn.n_clouds_read > 0 && same_counts(&one.f.statistics, &seven.f.statistics));
  uint64_t hash = conic_image_hash(&one.f.image, CONIC_PLANE_RGBA);
  CHECK_OK(layers_draw(&one)); /* from the cache */
  CHECK(one.drawn.n_clouds_read == 0 && conic_image_hash(&one.f.image, CONIC_PLANE_RGBA) == hash);
  one.f.options.tile = 16;
  one.f.options.isa = CONIC_ISA_SCALAR;
  expect_same(&one, &seven, "tiles");
  layers_close(&one);
  layers_close(&seven);
}

/* Fewer splats for more error; never more than the budget; the error that a budget comes to gives the same picture, or,
 * of stand-ins, which a budget prefers, one of no more splats. */
static void check_choice(int only_samples) {
  layers_frame frame = layers_open(2, path, NULL);
  uint64_t last = UINT64_MAX;
  frame.draw.only_samples = only_samples;
  for (double error = 0.5; error < 100.0; error *= 3.0) {
    frame.draw.error_px = error;
    CHECK_OK(layers_draw(&frame));
    CHECK(frame.f.statistics.splats_in <= last && frame.drawn.error_px == error);
    last = frame.f.statistics.splats_in;
  }
  CHECK(last < 2000);
  frame.draw.error_px = 0.0;
  const uint64_t budgets[] = {3000, 20000, 100000};
  for (size_t i = 0; i < 3; i++) {
    layers_frame other = layers_open(2, path, NULL);
    frame.draw.budget = budgets[i];
    CHECK_OK(layers_draw(&frame));
    CHECK(frame.f.statistics.splats_in <= budgets[i] && frame.f.statistics.splats_in >= budgets[i] / 3);
    other.draw.error_px = frame.drawn.error_px;
    other.draw.only_samples = only_samples;
    CHECK_OK(layers_draw(&other));
    CHECK(other.f.statistics.splats_in <= frame.f.statistics.splats_in);
    CHECK(!only_samples || layers_same_picture(&frame.f.image, &other.f.image));
    layers_close(&other);
  }
  uint64_t n_covered = UINT64_MAX;
  for (uint64_t budget = 1; budget < 70; budget += 17) { /* fewer than the coarsest cloud has */
    layers_frame other = layers_open(7, path, NULL);
    frame.draw.budget = other.draw.budget = budget;
    other.draw.only_samples = only_samples;
    CHECK_OK(layers_draw(&frame));
    CHECK_OK(layers_draw(&other));
    CHECK(only_samples ? frame.f.statistics.splats_in == (budget < 69 ? budget : 69)
                       : frame.f.statistics.splats_in <= budget && frame.f.statistics.splats_in > 0);
    CHECK(layers_same_picture(&frame.f.image, &other.f.image));
    layers_close(&other);
    CHECK(frame.f.statistics.pixels_covered <= n_covered); /* fewer splats are larger, and leave no holes */
    n_covered = frame.f.statistics.pixels_covered;
  }
  frame.draw.budget = 0;
  for (int level = 1; level < 5; level++) {
    frame.draw.most_levels = level;
    CHECK_OK(layers_draw(&frame));
    CHECK(frame.drawn.n_levels == level);
  }
  layers_close(&frame);
}

/* No hole at any error that is larger than a sample's disc: of what full resolution covers away from the silhouette,
 * coarser pictures cover all middles of samples. Stand-ins leave none that is wider than the error. */
static void check_coverage(int only_samples) {
  layers_frame full = layers_open(2, path, NULL), coarse = layers_open(2, path, NULL);
  CHECK_OK(layers_draw(&full));
  for (double error = 1.0; error < 40.0; error *= 2.0) {
    conic_difference difference;
    coarse.draw.error_px = error;
    coarse.draw.only_samples = only_samples;
    CHECK_OK(layers_draw(&coarse));
    CHECK_OK(conic_image_compare(full.f.context, &full.f.image, &coarse.f.image, &difference));
    double within = only_samples ? 0.0 : 3.14159 / 4.0 * error * error;
    if ((double)difference.largest_hole > fmax(layers_disc_pixels(&full), within)) {
      fprintf(stderr, "error %g: a hole of %zu pixels\n", error, difference.largest_hole);
      check_failures++;
    }
  }
  layers_close(&full);
  layers_close(&coarse);
}

/* A damaged cloud is an error; or, where that is tolerated, drawn coarser and said so. */
static void check_damage(conic_context *context) {
  const char *damaged = files_path("damaged.lpc");
  size_t n_bytes;
  unsigned char *bytes = read_bytes(path, &n_bytes);
  bytes[n_bytes - 100] ^= 1;
  FILE *file = fopen(damaged, "wb");
  CHECK(file && fwrite(bytes, 1, n_bytes, file) == n_bytes && fclose(file) == 0);
  free(bytes);
  layers_frame frame = layers_open(2, damaged, NULL), sound = layers_open(2, path, NULL);
  frame.draw.occlusion = CONIC_OCCLUSION_OFF; /* or the cloud may never be looked at */
  CHECK(layers_draw(&frame) == CONIC_ERROR_INPUT);
  frame.draw.may_be_coarser = 1;
  CHECK(layers_draw(&frame) == CONIC_ERROR_INPUT); /* what is wrong is not late */
  frame.draw.tolerates_damage = 1;
  CHECK_OK(layers_draw(&frame));
  CHECK(frame.drawn.n_clouds_missing == 1 && frame.drawn.n_clouds_damaged == 1);
  CHECK(frame.drawn.n_places_coarser == 1 && frame.drawn.missing_error_px > 0.0);
  CHECK_OK(layers_draw(&sound));
  CHECK(frame.f.statistics.pixels_covered + 20 > sound.f.statistics.pixels_covered);
  frame.draw.error_px = 20.0; /* coarse enough not to need it */
  frame.draw.may_be_coarser = 0;
  CHECK_OK(layers_draw(&frame));
  layers_close(&frame);
  layers_close(&sound);
  remove(damaged);
  (void)context;
}

int main(void) {
  conic_context *context = files_context();
  if (!has_feature("zstd")) {
    fprintf(stderr, "skipped: this build is without zstd\n");
    return 77;
  }
  char name[256];
  snprintf(name, sizeof name, "%s", files_path("shells.lpc"));
  path = name;
  layers_build(context, path, 64);
  check_whole(0);
  check_whole(1);
  check_occlusion();
  check_memory();
  check_cache_and_threads();
  check_choice(0);
  check_choice(1);
  check_coverage(0);
  check_coverage(1);
  check_damage(context);
  remove(path);
  rmdir(files_folder);
  conic_context_destroy(context);
  return check_result();
}
