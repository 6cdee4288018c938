/* Layered point clouds for tests: built of a set of splats, and read back whole. */
#pragma once

#include "core/base/memory.h"
#include "lod/layers/format/layers_decode.h"
#include "lod/layers/format/layers_format.h"
#include "tests/support/files.h"

/* Splats of a scene, circles with colours. */
static inline void layers_scene(conic_context *context, conic_scene_type type, size_t n, double offset,
                                conic_splats *splats) {
  conic_scene_options options;
  conic_scene *scene;
  conic_scene_options_init(&options);
  options.type = type;
  options.count = n;
  options.offset[0] = offset;
  CHECK_OK(conic_splats_allocate(context, n, CONIC_SPLATS_TANGENTS | CONIC_SPLATS_COLORS, splats));
  CHECK_OK(conic_scene_create(context, &options, &scene));
  CHECK_OK(conic_scene_sample(scene, 0, n, splats));
  conic_scene_destroy(scene);
}

/* Builds PATH of a set, in batches. */
static inline conic_status layers_build(conic_context *context, const conic_splats *splats, const char *path,
                                        const conic_layers_options *options, conic_layers_statistics *statistics) {
  conic_layers_builder *builder;
  conic_status status = conic_layers_builder_open(context, path, options, &builder);
  if (status != CONIC_OK)
    return status;
  for (size_t first = 0; first < splats->count && status == CONIC_OK; first += 700) {
    conic_splats batch = *splats;
    size_t left = splats->count - first;
    batch.count = left < 700 ? left : 700;
    float **arrays[] = {batch.position, batch.tangent_u, batch.tangent_v, batch.normal, batch.color, batch.sight};
    for (int i = 0; i < 18; i++)
      if (arrays[i / 3][i % 3])
        arrays[i / 3][i % 3] += first;
    status = conic_layers_builder_append(builder, &batch);
  }
  if (status == CONIC_OK)
    return conic_layers_builder_finish(builder, statistics);
  conic_layers_builder_abandon(builder);
  return status;
}

/* A file's clouds, one after the other. */
typedef struct layers_sample {
  uint64_t key;
  float position[3], normal[3], color[3], outline;
  uint32_t cloud;
} layers_sample;

typedef struct layers_all {
  conic_layers_file view;
  size_t n;
  layers_sample *samples;
} layers_all;

static inline void layers_read(conic_context *context, const char *path, layers_all *all) {
  conic_layers_decoder *decoder;
  memset(all, 0, sizeof *all);
  if (conic_layers_file_open(context, path, &all->view) != CONIC_OK ||
      conic_layers_decoder_create(context, &all->view.header, NULL, &decoder) != CONIC_OK)
    exit(1);
  all->samples = calloc((size_t)all->view.header.n_samples, sizeof *all->samples);
  for (uint32_t i = 0; i < all->view.header.n_clouds && all->samples; i++) {
    const conic_layers_entry *entry = &all->view.entries[i];
    void *block = conic_memory_allocate(context, conic_layers_cloud_bytes(&all->view.header, entry, NULL) + 64, 1);
    conic_layers_cloud cloud;
    conic_layers_cloud_place(&all->view.header, entry, NULL, block, &cloud);
    CHECK(!conic_layers_decode(decoder, entry, all->view.mapping.bytes + entry->offset, &cloud));
    for (size_t k = 0; k < cloud.count; k++) {
      layers_sample *to = &all->samples[all->n++];
      *to = (layers_sample){.key = cloud.keys[k], .cloud = i, .outline = cloud.outline ? cloud.outline[k] : 0.0f};
      for (int axis = 0; axis < 3; axis++) {
        to->position[axis] = cloud.position[axis][k];
        to->normal[axis] = cloud.normal[axis][k];
        to->color[axis] = cloud.color[0] ? cloud.color[axis][k] : 1.0f;
      }
    }
    conic_memory_release(context, block);
  }
  conic_layers_decoder_destroy(decoder);
}

static inline void layers_release(layers_all *all) {
  free(all->samples);
  conic_layers_file_close(&all->view);
}

/* Whether a build without zstd is why a test cannot run. */
static inline int layers_are_missing(void) {
  for (int i = 0; conic_feature_at(i); i++)
    if (strcmp(conic_feature_at(i)->name, "zstd") == 0)
      return !conic_feature_at(i)->available;
  return 1;
}
