/* On an OpenCL device, whole pictures are those of the CPU, in every bit of every plane: all methods and kernels, clip
 * lines, both pass modes, splats friendly and hostile, in one part and in several, by tiles and by pixels. */
#include "opencl/opencl_renderer.h"
#include "tests/support/opencl_fixture.h"

enum { N_RENDERERS = 6 };

/* Ways to draw the same. */
typedef struct way {
  const char *name;
  conic_opencl_work work;
  int projects_on_host;
  size_t part_splats;
} way;

static const way ways[N_RENDERERS] = {{"tiles", CONIC_OPENCL_WORK_TILES, 0, 0},
                                      {"pixels", CONIC_OPENCL_WORK_PIXELS, 0, 0},
                                      {"tiles, in parts", CONIC_OPENCL_WORK_TILES, 0, 101},
                                      {"pixels, in parts", CONIC_OPENCL_WORK_PIXELS, 0, 700},
                                      {"tiles, projected by the host", CONIC_OPENCL_WORK_TILES, 1, 0},
                                      {"pixels, by the host, in parts", CONIC_OPENCL_WORK_PIXELS, 1, 80}};

static conic_renderer *renderers[N_RENDERERS];

/* With `simulates` also on a device that does not say that it rounds correctly, as a simulator may; and without the
 * ways that are like others but for parts, of which the last has some. */
static void open_renderers(conic_context *context, int simulates) {
  for (int i = 0; i < N_RENDERERS; i++) {
    if (simulates && (i == 2 || i == 3))
      continue;
    conic_opencl_options options;
    conic_opencl_options_init(&options);
    options.allow_inexact = simulates;
    options.work = ways[i].work;
    options.projects_on_host = ways[i].projects_on_host;
    options.part_splats = ways[i].part_splats / (simulates ? 4 : 1);
    CHECK_OK(conic_opencl_renderer_create(context, &options, NULL, &renderers[i]));
  }
}

static void check_counts(const conic_render_statistics *a, const conic_render_statistics *b) {
  CHECK(a->splats_in == b->splats_in && a->splats_culled == b->splats_culled);
  CHECK(a->splats_skipped == b->splats_skipped && a->splats_drawn == b->splats_drawn);
  CHECK(a->splats_fallback == b->splats_fallback && a->fragments == b->fragments);
  CHECK(a->pixels_covered == b->pixels_covered && a->near_z == b->near_z);
  CHECK(memcmp(a->splats_by_method, b->splats_by_method, sizeof a->splats_by_method) == 0);
  CHECK(a->splats_by_laplace == b->splats_by_laplace);
}

/* By tiles, fragments are kept from pass to pass only where neither counts nor ids are wanted. */
static void compare_without_counts(fixture *f, const char *scene) {
  const unsigned planes = ALL_PLANES & ~(1u << CONIC_PLANE_COUNT | 1u << CONIC_PLANE_ID);
  conic_render_statistics statistics;
  conic_image image;
  CHECK_OK(conic_image_allocate(f->context, f->camera.width, f->camera.height, planes, &image));
  CHECK_OK(conic_render(renderers[0], &f->splats, &f->camera, &f->options, &image, &statistics));
  check_counts(&f->statistics, &statistics);
  for (int plane = 0; plane < CONIC_N_DRAWN_PLANES; plane++)
    if (planes & 1u << plane &&
        conic_image_hash(&image, (conic_plane)plane) != conic_image_hash(&f->image, (conic_plane)plane)) {
      fprintf(stderr, "%s: %s differs where neither counts nor ids are wanted\n", scene,
              conic_plane_describe((conic_plane)plane)->name);
      check_failures++;
    }
  conic_image_release(f->context, &image);
}

/* Draws what the fixture holds on the CPU and in the first `n_ways` ways on the device. */
static void compare(fixture *f, int n_ways, const char *scene) {
  conic_image image;
  fixture_render(f);
  CHECK_OK(conic_image_allocate(f->context, f->camera.width, f->camera.height, ALL_PLANES, &image));
  for (int i = 0; i < n_ways; i++) {
    conic_render_statistics statistics;
    char what[160];
    if (!renderers[i])
      continue;
    snprintf(what, sizeof what, "%s, %s, passes %d, kernel %d: %s", scene, conic_method_name(f->options.method),
             f->options.passes, (int)f->options.kernel.type, ways[i].name);
    for (int plane = 0; plane < CONIC_N_DRAWN_PLANES; plane++) /* so that what is not drawn differs */
      memset(image.planes[plane], 0x5a,
             (size_t)image.width * (size_t)image.height * 4 *
                 (size_t)conic_plane_describe((conic_plane)plane)->n_channels);
    CHECK_OK(conic_render(renderers[i], &f->splats, &f->camera, &f->options, &image, &statistics));
    CHECK(opencl_same(&f->image, &image, what));
    check_counts(&f->statistics, &statistics);
  }
  conic_image_release(f->context, &image);
  compare_without_counts(f, scene);
}

/* Every second pair of a method and a kernel, from the first on; the rest of the options as it comes. */
static void check_hostile(fixture *f, int first, double share_of_specials, double decades) {
  uint64_t state = 7;
  for (int number = first; number < CONIC_N_METHODS * CONIC_N_KERNELS; number += 2)
    for (int passes = 1; passes <= 3; passes += 2) {
      fill(f, &state, decades, share_of_specials);
      if (number / 2 % 2)
        opencl_add_clips(f, &state);
      choose(f, number);
      f->options.passes = passes;
      f->options.near_z = 1e-3;
      f->options.exposure = number % 3 ? 0.5 : 0.0;
      f->options.light[0] = 1.0;
      f->options.light[1] = 2.0;
      if (f->options.has_background)
        f->options.background[1] = 0.3f;
      if (number == 5 || number == 12)
        f->options.kernel.cutoff = 3.0f;
      compare(f, N_RENDERERS, "hostile");
      opencl_drop_clips(f);
    }
}

/* A few pictures of each method, small enough for a simulator (scripts/oclgrind). */
static void check_small(fixture *f) {
  uint64_t state = 13;
  fixture_camera(f, 18, 17, 16.0);
  for (int number = 0; number < CONIC_N_METHODS; number++) {
    fill(f, &state, 1.5, 0.01);
    opencl_add_clips(f, &state);
    f->splats.count = 48;
    f->splats.n_clips = 18;
    choose(f, number + CONIC_N_METHODS * (number % CONIC_N_KERNELS));
    f->options.passes = number % 3 ? 3 : 1;
    f->options.light[2] = -1.0;
    f->options.near_z = 1e-3;
    compare(f, N_RENDERERS, "small");
    opencl_drop_clips(f);
  }
}

static void check_scene(fixture *f, conic_scene_type type, size_t count, double distance, const char *name) {
  f->camera.cam_from_world[2][3] = distance;
  conic_splats_release(f->context, &f->splats);
  fixture_scene(f, type, count);
  for (int method = 0; method < CONIC_N_METHODS; method++)
    for (int passes = 1; passes <= 3; passes += 2) {
      conic_render_options_init(&f->options);
      f->options.method = (conic_method)method;
      f->options.passes = passes;
      compare(f, 4, name);
    }
}

static void check_odd_cases(fixture *f) {
  conic_render_options_init(&f->options);
  size_t count = f->splats.count;
  f->splats.count = 0; /* nothing at all */
  compare(f, N_RENDERERS, "nothing");
  f->splats.count = 1;
  compare(f, N_RENDERERS, "one");
  f->splats.count = count;
  f->camera.cx = -1e5; /* all off the screen */
  compare(f, N_RENDERERS, "off the screen");
  f->camera.cx = 59.5;
  float *const color = f->splats.color[0];
  f->splats.color[0] = NULL;
  float *const green = f->splats.color[1], *const blue = f->splats.color[2];
  f->splats.color[1] = f->splats.color[2] = NULL;
  compare(f, N_RENDERERS, "without colours");
  f->splats.color[0] = color;
  f->splats.color[1] = green;
  f->splats.color[2] = blue;
}

/* Single planes, and samples, which are drawn through the same renderer. */
static void check_planes_and_samples(fixture *f) {
  conic_image expected, image;
  for (int plane = 0; plane < CONIC_N_DRAWN_PLANES; plane++) {
    CHECK_OK(conic_image_allocate(f->context, f->camera.width, f->camera.height, 1u << plane, &image));
    CHECK_OK(conic_render(renderers[0], &f->splats, &f->camera, &f->options, &image, NULL));
    CHECK(conic_image_hash(&image, (conic_plane)plane) == conic_image_hash(&f->image, (conic_plane)plane));
    conic_image_release(f->context, &image);
  }
  CHECK_OK(conic_image_allocate(f->context, f->camera.width, f->camera.height, ALL_PLANES, &expected));
  CHECK_OK(conic_image_allocate(f->context, f->camera.width, f->camera.height, ALL_PLANES, &image));
  CHECK_OK(conic_render_samples(f->context, f->renderer, &f->splats, &f->camera, &f->options, 3, &expected, NULL));
  CHECK_OK(conic_render_samples(f->context, renderers[0], &f->splats, &f->camera, &f->options, 3, &image, NULL));
  CHECK(opencl_same(&expected, &image, "3 x 3 samples"));
  conic_image_release(f->context, &expected);
  conic_image_release(f->context, &image);
}

static uint64_t draw_again(fixture *f, conic_renderer *renderer, conic_image *image) {
  conic_opencl *opencl = (conic_opencl *)conic_renderer_backend(renderer);
  uint64_t before = opencl->queue.n_bytes_written;
  CHECK_OK(conic_render(renderer, &f->splats, &f->camera, &f->options, image, NULL));
  return opencl->queue.n_bytes_written - before;
}

/* Splats that have a number are copied to a device with memory of its own once, and anew with another number, in other
 * arrays or where the number is 0. */
static void check_kept_splats(fixture *f) {
  const size_t bytes = f->splats.count * sizeof(float);
  float *const red = f->splats.color[0], *other = malloc(bytes);
  conic_image image;
  CHECK_OK(conic_image_allocate(f->context, f->camera.width, f->camera.height, ALL_PLANES, &image));
  for (int i = 0; i < 3; i++) {
    conic_opencl *opencl = (conic_opencl *)conic_renderer_backend(renderers[i]);
    const int is_in_parts = ways[i].part_splats != 0;
    opencl->device.is_cpu = 0;
    f->options.splats_version = 5;
    fixture_render(f);
    CHECK(draw_again(f, renderers[i], &image) > bytes);
    CHECK(opencl_same(&f->image, &image, "splats that are to be kept"));
    memcpy(other, red, bytes);
    for (size_t splat = 0; splat < f->splats.count; splat++)
      red[splat] = 0.5f * other[splat];
    CHECK((draw_again(f, renderers[i], &image) > bytes) == is_in_parts);
    CHECK(is_in_parts || opencl_same(&f->image, &image, "kept splats"));
    fixture_render(f);
    f->options.splats_version = i % 2 ? 6 : 0;
    CHECK(draw_again(f, renderers[i], &image) > bytes);
    CHECK(opencl_same(&f->image, &image, "changed splats"));
    CHECK((draw_again(f, renderers[i], &image) > bytes) == (is_in_parts || i % 2 == 0));
    f->splats.color[0] = other;
    fixture_render(f);
    CHECK(draw_again(f, renderers[i], &image) > bytes);
    CHECK(opencl_same(&f->image, &image, "splats in other arrays"));
    f->splats.color[0] = red;
    memcpy(red, other, bytes);
    opencl->device.is_cpu = 1;
  }
  f->options.splats_version = 0;
  conic_image_release(f->context, &image);
  free(other);
}

static void check_all(fixture *f) {
  fixture_camera(f, 83, 66, 58.0);
  check_hostile(f, 0, 0.0, 1.5);
  check_hostile(f, 1, 0.01, 3.0);
  fixture_camera(f, 119, 87, 83.0);
  check_scene(f, CONIC_SCENE_KNOT, 6000, 2.2, "knot");
  fixture_camera(f, 23, 17, 16.0);
  check_scene(f, CONIC_SCENE_KNOT, 20000, 2.2, "crowd"); /* more splats on a block than are kept */
  fixture_camera(f, 119, 87, 83.0);
  check_scene(f, CONIC_SCENE_TORUS, 3000, 1.2, "torus"); /* from inside the tube */
  check_odd_cases(f);
  fixture_render(f);
  check_planes_and_samples(f);
  check_kept_splats(f);
}

/* FOLDER, or FOLDER small */
int main(int argc, char **argv) {
  fixture f = fixture_open(2);
  int is_small = argc > 2 && strcmp(argv[2], "small") == 0;
  opencl_need_device(f.context);
  open_renderers(f.context, is_small);
  if (is_small)
    check_small(&f);
  else
    check_all(&f);
  for (int i = 0; i < N_RENDERERS; i++)
    conic_renderer_destroy(renderers[i]);
  fixture_close(&f);
  return check_result();
}
