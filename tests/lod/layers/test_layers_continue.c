/* Layered clouds that go on: what was there is there again, where it was and as it was, on a grid that reaches farther;
 * the same file whatever the threads and memory. */
#include "conic/layers_draw.h"
#include "lod/layers/format/layers_code.h"
#include "lod/layers/format/layers_key.h"
#include "tests/support/layers_fixture.h"

static conic_status hand_on(void *cookie, const conic_splats *batch) {
  return conic_layers_builder_append(cookie, batch);
}

/* OLD's samples and then `more`, into OUT. */
static void go_on(conic_context *context, const char *old, const conic_splats *more, const char *out,
                  uint64_t memory_bytes) {
  conic_layers_options options;
  conic_layers_builder *builder;
  conic_layers *layers;
  conic_layers_options_init(&options);
  options.memory_bytes = memory_bytes;
  CHECK_OK(conic_layers_open(context, old, NULL, &layers));
  conic_layers_continue(layers, &options);
  CHECK(options.has_corner && options.cloud_size == 64);
  CHECK_OK(conic_layers_builder_open(context, out, &options, &builder));
  CHECK_OK(conic_layers_read_samples(layers, options.cutoff, NULL, hand_on, builder));
  if (more)
    CHECK_OK(conic_layers_builder_append(builder, more));
  CHECK_OK(conic_layers_builder_finish(builder, NULL));
  conic_layers_close(layers);
}

/* A sample's steps from another grid's origin, and the codes of its normal and colour. */
typedef struct found_sample {
  int64_t steps[3];
  uint8_t normal[2];
  float color[3];
} found_sample;

static int compare_found(const void *a, const void *b) {
  const found_sample *one = a, *other = b;
  for (int axis = 0; axis < 3; axis++)
    if (one->steps[axis] != other->steps[axis])
      return one->steps[axis] < other->steps[axis] ? -1 : 1;
  int order = memcmp(one->normal, other->normal, sizeof one->normal);
  return order ? order : memcmp(one->color, other->color, sizeof one->color);
}

static found_sample *list_found(const layers_all *all, const conic_layers_header *from) {
  const conic_layers_header *header = &all->view.header;
  found_sample *list = calloc(all->n, sizeof *list);
  if (!list)
    exit(1);
  for (int axis = 0; axis < 3; axis++) {
    double apart = (header->origin[axis] - from->origin[axis]) / header->quantum;
    CHECK_NEAR(apart, floor(apart + 0.5), 1e-6);
    for (size_t i = 0; i < all->n; i++)
      list[i].steps[axis] = (int64_t)floor(apart + 0.5) + (int64_t)conic_layers_step(all->samples[i].key, axis);
  }
  for (size_t i = 0; i < all->n; i++) {
    conic_layers_code_normal(all->samples[i].normal, list[i].normal);
    memcpy(list[i].color, all->samples[i].color, sizeof list[i].color);
  }
  qsort(list, all->n, sizeof *list, compare_found);
  return list;
}

static void check_kept(conic_context *context, const char *before, const char *after, size_t n_more) {
  layers_all old, all;
  layers_read(context, before, &old);
  layers_read(context, after, &all);
  CHECK(all.n == old.n + n_more && all.view.header.quantum == old.view.header.quantum);
  found_sample *wanted = list_found(&old, &old.view.header), *found = list_found(&all, &old.view.header);
  size_t n_kept = 0;
  for (size_t i = 0; i < all.n && n_kept < old.n; i++)
    n_kept += compare_found(&wanted[n_kept], &found[i]) == 0;
  CHECK(n_kept == old.n);
  free(wanted);
  free(found);
  layers_release(&old);
  layers_release(&all);
  conic_layers_defects defects;
  CHECK_OK(conic_layers_check(context, after, &defects));
  CHECK(defects.clouds + defects.coverage + defects.spheres + defects.cones == 0);
}

static void check_same_bytes(conic_context *context, const char *one, const char *other) {
  conic_mapping a, b;
  CHECK_OK(conic_mapping_open(context, one, &a));
  CHECK_OK(conic_mapping_open(context, other, &b));
  CHECK(a.n_bytes == b.n_bytes && memcmp(a.bytes, b.bytes, a.n_bytes) == 0);
  conic_mapping_close(context, &a);
  conic_mapping_close(context, &b);
}

int main(void) {
  if (layers_are_missing()) {
    fprintf(stderr, "skipped: this build has no zstd\n");
    return 77;
  }
  conic_context *context = files_context(), *alone = check_context(1);
  conic_layers_options options;
  conic_splats sphere, far;
  char old[4096], all[4096], again[4096];
  snprintf(old, sizeof old, "%s", files_path("old.lpc"));
  snprintf(all, sizeof all, "%s", files_path("all.lpc"));
  snprintf(again, sizeof again, "%s", files_path("again.lpc"));
  conic_layers_options_init(&options);
  options.cloud_size = 64;
  layers_scene(context, CONIC_SCENE_KNOT, 5000, 1e5, &sphere);
  layers_scene(context, CONIC_SCENE_SPHERE, 3000, 1e5 - 7.0, &far);
  CHECK_OK(layers_build(context, &sphere, old, &options, NULL));
  go_on(context, old, NULL, all, UINT64_C(1) << 30);
  check_kept(context, old, all, 0);
  go_on(context, old, &far, all, UINT64_C(1) << 30);
  check_kept(context, old, all, far.count);
  go_on(alone, old, &far, again, 1 << 16);
  check_same_bytes(context, all, again);
  CHECK(unlink(old) == 0 && unlink(all) == 0 && unlink(again) == 0);
  conic_splats_release(context, &sphere);
  conic_splats_release(context, &far);
  conic_context_destroy(alone);
  files_end(context);
  return check_result();
}
