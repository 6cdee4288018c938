/* Options of callers that were compiled with another version: smaller or larger than the library's own. */
#define _DEFAULT_SOURCE /* for MAP_ANON; NOLINT(bugprone-reserved-identifier,cert-dcl*) */
#if defined(_WIN32)
#include <windows.h>
#else
#include <sys/mman.h>
#endif

#include "core/base/options.h"
#include "tests/support/check.h"

enum { PAGE = 4096, CANARY = 0xA5 };

/* Two pages, of which the second may not be touched: what ends at its border cannot be read past its end. */
static unsigned char *guarded_pages(void) {
#if defined(_WIN32)
  DWORD before;
  unsigned char *pages = VirtualAlloc(NULL, 2 * PAGE, MEM_COMMIT | MEM_RESERVE, PAGE_READWRITE);
  if (!pages || !VirtualProtect(pages + PAGE, PAGE, PAGE_NOACCESS, &before))
    exit(1);
#else
  unsigned char *pages = mmap(NULL, 2 * PAGE, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANON, -1, 0);
  if (pages == MAP_FAILED || mprotect(pages + PAGE, PAGE, PROT_NONE) != 0)
    exit(1);
#endif
  return pages;
}

static size_t size_at(const void *options) {
  size_t size;
  memcpy(&size, options, sizeof size);
  return size;
}

static void init_context(void *o, size_t size) {
  conic_context_options_init_sized(o, size);
}
static void init_image(void *o, size_t size) {
  conic_image_options_init_sized(o, size);
}
static void init_framing(void *o, size_t size) {
  conic_framing_init_sized(o, size);
}
static void init_floats(void *o, size_t size) {
  conic_float_model_init_sized(o, CONIC_FLOATS_OWN, size);
}
static void init_judging(void *o, size_t size) {
  conic_gaussian_judging_init_sized(o, size);
}
static void init_oracle_judging(void *o, size_t size) {
  conic_oracle_judging_init_sized(o, size);
}
static void init_asking(void *o, size_t size) {
  conic_oracle_asking_init_sized(o, size);
}
static void init_gradient(void *o, size_t size) {
  conic_gradient_options_init_sized(o, size);
}
static void init_picture(void *o, size_t size) {
  conic_picture_options_init_sized(o, size);
}
static void init_gaussians_read(void *o, size_t size) {
  conic_gaussians_read_options_init_sized(o, size);
}
static void init_gaussians_write(void *o, size_t size) {
  conic_gaussians_write_options_init_sized(o, size);
}
static void init_gaussian(void *o, size_t size) {
  conic_gaussian_options_init_sized(o, size);
}
static void init_cameras(void *o, size_t size) {
  conic_cameras_options_init_sized(o, size);
}
static void init_read(void *o, size_t size) {
  conic_read_options_init_sized(o, size);
}
static void init_write(void *o, size_t size) {
  conic_write_options_init_sized(o, size);
}
static void init_estimate(void *o, size_t size) {
  conic_estimate_options_init_sized(o, size);
}
static void init_scene(void *o, size_t size) {
  conic_scene_options_init_sized(o, size);
}
static void init_render(void *o, size_t size) {
  conic_render_options_init_sized(o, size);
}
static void init_octree(void *o, size_t size) {
  conic_octree_options_init_sized(o, size);
}
static void init_selection(void *o, size_t size) {
  conic_selection_options_init_sized(o, size);
}
static void init_hybrid(void *o, size_t size) {
  conic_hybrid_options_init_sized(o, size);
}
static void init_hybrid_streaming(void *o, size_t size) {
  conic_hybrid_streaming_init_sized(o, size);
}
static void init_hybrid_view(void *o, size_t size) {
  conic_hybrid_view_init_sized(o, size);
}
static void init_layers(void *o, size_t size) {
  conic_layers_options_init_sized(o, size);
}
static void init_access(void *o, size_t size) {
  conic_layers_access_init_sized(o, size);
}
static void init_lighting(void *o, size_t size) {
  conic_lighting_options_init_sized(o, size);
}
static void init_draw(void *o, size_t size) {
  conic_layers_draw_options_init_sized(o, size);
}
static void init_opencl(void *o, size_t size) {
  conic_opencl_options_init_sized(o, size);
}
static void init_surface(void *o, size_t size) {
  conic_surface_options_init_sized(o, size);
}
static void init_clean(void *o, size_t size) {
  conic_clean_options_init_sized(o, size);
}
static void init_thin(void *o, size_t size) {
  conic_thin_options_init_sized(o, size);
}
static void init_densify(void *o, size_t size) {
  conic_densify_options_init_sized(o, size);
}
static void init_source(void *o, size_t size) {
  conic_source_options_init_sized(o, size);
}
static void init_view(void *o, size_t size) {
  conic_source_view_init_sized(o, size);
}
static void init_patches(void *o, size_t size) {
  conic_patches_options_init_sized(o, size);
}
static void init_accumulate(void *o, size_t size) {
  conic_accumulate_options_init_sized(o, size);
}
static void init_coloring(void *o, size_t size) {
  conic_coloring_options_init_sized(o, size);
}

static const struct {
  void (*init)(void *options, size_t size);
  size_t size;
} all[] = {{init_context, sizeof(conic_context_options)},
           {init_image, sizeof(conic_image_options)},
           {init_framing, sizeof(conic_framing)},
           {init_read, sizeof(conic_read_options)},
           {init_write, sizeof(conic_write_options)},
           {init_floats, sizeof(conic_float_model)},
           {init_judging, sizeof(conic_gaussian_judging)},
           {init_oracle_judging, sizeof(conic_oracle_judging)},
           {init_asking, sizeof(conic_oracle_asking)},
           {init_gradient, sizeof(conic_gradient_options)},
           {init_picture, sizeof(conic_picture_options)},
           {init_estimate, sizeof(conic_estimate_options)},
           {init_scene, sizeof(conic_scene_options)},
           {init_render, sizeof(conic_render_options)},
           {init_octree, sizeof(conic_octree_options)},
           {init_selection, sizeof(conic_selection_options)},
           {init_hybrid, sizeof(conic_hybrid_options)},
           {init_hybrid_streaming, sizeof(conic_hybrid_streaming)},
           {init_hybrid_view, sizeof(conic_hybrid_view)},
           {init_layers, sizeof(conic_layers_options)},
           {init_access, sizeof(conic_layers_access)},
           {init_draw, sizeof(conic_layers_draw_options)},
           {init_lighting, sizeof(conic_lighting_options)},
           {init_opencl, sizeof(conic_opencl_options)},
           {init_surface, sizeof(conic_surface_options)},
           {init_clean, sizeof(conic_clean_options)},
           {init_thin, sizeof(conic_thin_options)},
           {init_densify, sizeof(conic_densify_options)},
           {init_patches, sizeof(conic_patches_options)},
           {init_source, sizeof(conic_source_options)},
           {init_accumulate, sizeof(conic_accumulate_options)},
           {init_coloring, sizeof(conic_coloring_options)},
           {init_gaussian, sizeof(conic_gaussian_options)},
           {init_gaussians_read, sizeof(conic_gaussians_read_options)},
           {init_gaussians_write, sizeof(conic_gaussians_write_options)},
           {init_cameras, sizeof(conic_cameras_options)},
           {init_view, sizeof(conic_source_view)}};

static void test_init_fills_what_the_caller_has(void) {
  unsigned char whole[2048], other[2048];
  for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
    size_t size = all[i].size, smaller = size - sizeof(size_t), larger = size + 40;
    memset(whole, CANARY, sizeof whole);
    memset(other, CANARY, sizeof other);
    all[i].init(whole, size);
    CHECK(size_at(whole) == size && whole[size] == CANARY);
    all[i].init(other, smaller);
    CHECK(size_at(other) == smaller);
    CHECK(memcmp(other + sizeof size, whole + sizeof size, smaller - sizeof size) == 0);
    for (size_t at = smaller; at < sizeof other; at++)
      CHECK(other[at] == CANARY);
    memset(other, CANARY, sizeof other);
    all[i].init(other, larger);
    CHECK(size_at(other) == larger && other[larger] == CANARY);
    CHECK(memcmp(other + sizeof size, whole + sizeof size, size - sizeof size) == 0);
    CHECK(conic_is_zero(other + size, larger - size));
  }
}

/* A caller that knows one member fewer, at the end of what may be read. */
static void test_older_caller(void) {
  unsigned char *pages = guarded_pages();
  size_t older = offsetof(conic_scene_options, cutoff);
  conic_scene_options own, *theirs = (conic_scene_options *)(pages + PAGE - older);
  conic_scene_options_init_sized(theirs, older);
  theirs->count = 77;
  conic_scene_options_init(&own);
  CHECK(conic_options_take(&own, theirs));
  CHECK(own.size == sizeof own && own.count == 77 && own.cutoff == 1.5f);

  conic_context *context = check_context(1);
  conic_scene *scene;
  CHECK_OK(conic_scene_create(context, theirs, &scene));
  conic_scene_destroy(scene);
  conic_context_destroy(context);
}

static void test_newer_caller(void) {
  struct {
    conic_scene_options known;
    double unknown[2];
  } theirs;
  conic_scene_options own;
  conic_scene_options_init_sized(&theirs.known, sizeof theirs);
  theirs.known.count = 88;
  conic_scene_options_init(&own);
  CHECK(conic_options_take(&own, &theirs));
  CHECK(own.size == sizeof own && own.count == 88);
  theirs.unknown[1] = 1.0; /* asks for what this version cannot do */
  theirs.known.count = 99;
  CHECK(!conic_options_take(&own, &theirs));
  CHECK(own.count == 88);
}

static void test_sizes_that_are_none(void) {
  conic_scene_options own, theirs;
  static const size_t sizes[] = {0, 1, sizeof(size_t) - 1, sizeof theirs - 1, 4096 + sizeof(size_t), SIZE_MAX};
  conic_scene_options_init(&own);
  CHECK(!conic_options_take(&own, NULL));
  for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
    conic_scene_options_init(&theirs);
    theirs.size = sizes[i];
    CHECK(!conic_options_take(&own, &theirs));
  }
  theirs.size = sizeof(size_t); /* knows no member at all */
  theirs.count = 7;
  CHECK(conic_options_take(&own, &theirs) && own.count == 100000);
}

/* Structs without a size keep theirs: what is added takes the place of reserved words. */
static void test_other_structs_keep_their_size(void) {
  if (sizeof(void *) != 8)
    return;
  CHECK(sizeof(conic_light) == 40 && sizeof(conic_lighting) == 408);
  static const struct {
    const char *name;
    size_t size, pinned;
  } structs[] = {
#define PINNED(type, bytes) {#type, sizeof(type), bytes}
      PINNED(conic_camera, 264),
      PINNED(conic_cameras, 88),
      PINNED(conic_splats, 320),
      PINNED(conic_triangles, 296),
      PINNED(conic_material, 56),
      PINNED(conic_model, 416),
      PINNED(conic_image, 6608),
      PINNED(conic_drawing, 48),
      PINNED(conic_sample, 328),
      PINNED(conic_aperture, 56),
      PINNED(conic_accumulation_facts, 72),
      PINNED(conic_selection, 432),
      PINNED(conic_hybrid_selection, 760),
      PINNED(conic_patch_selection, 432),
      PINNED(conic_reference, 520),
      PINNED(conic_points_sink, 56),
      PINNED(conic_projection, 208),
      PINNED(conic_hybrid_report, 168),
      PINNED(conic_render_statistics, 512),
      PINNED(conic_hybrid_info, 232),
      PINNED(conic_hybrid_defects, 96),
      PINNED(conic_difference, 920),
      PINNED(conic_layers_info, 232),
      PINNED(conic_layers_defects, 96),
      PINNED(conic_layers_statistics, 160),
      PINNED(conic_layers_scale, 160),
      PINNED(conic_layers_drawn, 176),
      PINNED(conic_repairs, 112),
      PINNED(conic_octree_info, 232),
      PINNED(conic_octree_defects, 104),
      PINNED(conic_patches_report, 216),
      PINNED(conic_surface_report, 384),
      PINNED(conic_oracle_verdict, 872),
      PINNED(conic_surface_distance, 64),
      PINNED(conic_opencl_device, 616),
      PINNED(conic_surface_options, 128),
      PINNED(conic_clip, 32),
      PINNED(conic_coloring, 168),
      PINNED(conic_model_field, 64),
      PINNED(conic_kernel, 20),
      PINNED(conic_contribution, 32),
      PINNED(conic_surface_point, 136),
      PINNED(conic_gaussians, 232),
      PINNED(conic_gaussian_planes, 144),
      PINNED(conic_gaussian_statistics, 144),
      PINNED(conic_gaussians_defects, 64),
      PINNED(conic_gaussians_differences, 80)};
  for (size_t i = 0; i < sizeof structs / sizeof structs[0]; i++) {
    if (structs[i].size != structs[i].pinned)
      fprintf(stderr, "%s has %zu bytes, not %zu\n", structs[i].name, structs[i].size, structs[i].pinned);
    CHECK(structs[i].size == structs[i].pinned);
  }
}

int main(void) {
  test_init_fills_what_the_caller_has();
  test_older_caller();
  test_newer_caller();
  test_sizes_that_are_none();
  test_other_structs_keep_their_size();
  return check_result();
}
