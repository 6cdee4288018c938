/* A layered point cloud that is open for drawing. */
#ifndef CONIC_LAYERS_SCENE_H
#define CONIC_LAYERS_SCENE_H

#include "conic/layers_draw.h"
#include "lod/layers/draw/layers_store.h"
#include "lod/layers/format/layers_format.h"
#include "lod/ranges/ranges.h"

struct conic_layers {
  conic_context *context;
  char *name;
  conic_layers_access access;
  double until_s; /* by conic_seconds_now, opening ends */
  int is_remote;
  conic_ranges *ranges;
  uint64_t n_told; /* bytes received that a picture's statistics have told of */
  conic_layers_header header;
  conic_layers_entry *entries;
  uint64_t *first_sample; /* number of each cloud's first, in the order of the file */
  conic_layers_store store;
  conic_renderer *hider;        /* draws how deep things hide, for other devices that do not; made when needed */
  struct conic_layers_set *set; /* what is gathered to be drawn; likewise */
};

/* Shares of the memory that a picture may take: for the cache, and for what is gathered and drawn of it at a time. */
static inline uint64_t conic_layers_cache_bytes(const conic_layers *layers) {
  return layers->access.memory_bytes / 8 * 3;
}

static inline uint64_t conic_layers_drawing_bytes(const conic_layers *layers) {
  return layers->access.memory_bytes / 8 * 3;
}

#endif
