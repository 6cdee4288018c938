/* A layered point cloud that is open for drawing. */
#pragma once

#include "core/splats/raw_colors.h"
#include "lod/hierarchies/hierarchy.h"
#include "lod/layers/draw/layers_store.h"

struct conic_layers {
  conic_context *context;
  char *name;
  conic_layers_access access;
  double until_s; /* when opening ends, by conic_seconds_now */
  int is_remote;
  conic_ranges *ranges;               /* of the clouds */
  struct conic_layers_octree *octree; /* null: a .lpc */
  uint64_t n_told;                    /* bytes received that a picture's statistics have told of */
  conic_layers_header header;
  conic_layers_header stand_ins; /* the header, as stand-ins are decoded */
  uint32_t n_all;                /* clouds, and, where there are stand-ins, as many more: those of cloud i are number
                                    n_clouds + i; 0: there are none */
  conic_layers_entry *entries;   /* of all */
  uint64_t *first_sample;        /* number of each cloud's first, in the order of the file */
  conic_layers_choice choice;
  conic_layers_store store;
  uint64_t picture_bytes;               /* what the image that is being drawn takes */
  conic_renderer *hider;                /* draws how deep things hide, for devices that cannot; made when needed */
  conic_camera last_camera;             /* of the picture before; width 0: there was none */
  struct conic_layers_facings *facings; /* likewise */
  struct conic_layers_set *set;         /* what is gathered to be drawn; likewise */
};

/* Says which values by name samples have that are gathered from now on, as conic_layers_region's `keep` does. Errors:
 * INPUT, MEMORY. */
conic_status conic_layers_keep(conic_layers *layers, const char *names);

/* How its files are read. */
void conic_layers_access_ranges(const conic_layers_access *access, double until_s, conic_ranges_options *options);

/* How many children an inner node has; they follow each other. */
static inline uint32_t conic_layers_children(const conic_layers *layers) {
  return layers->octree ? 8 : 2;
}

/* Clouds and stand-ins together. */
static inline uint32_t conic_layers_all(const conic_layers *layers) {
  return layers->n_all ? layers->n_all : layers->header.n_clouds;
}

static inline int conic_layers_is_stand_in(const conic_layers *layers, uint32_t cloud) {
  return layers->n_all && cloud >= layers->header.n_clouds;
}

/* Whether coarse places are drawn as their stand-ins, which have no values of their own. */
static inline int conic_layers_has_stand_ins(const conic_layers *layers) {
  const conic_layers_choice *choice = &layers->choice;
  return layers->n_all && !choice->filter && choice->colored_by < 0 && !choice->n_kept;
}

/* Whether a cloud is in memory, or empty. */
static inline int conic_layers_has_cloud(const conic_layers *layers, uint32_t cloud) {
  return layers->store.slots[cloud].cloud || layers->entries[cloud].n_samples == 0;
}

/* The memory that is left for a picture once the program, the index and the image have theirs: an eighth of all at
 * least.
 */
static inline uint64_t conic_layers_free_bytes(const conic_layers *layers) {
  const uint64_t own_bytes = (UINT64_C(14) << 20) + ((uint64_t)conic_context_threads(layers->context) << 21);
  const uint64_t all = layers->access.memory_bytes;
  uint64_t cloud_bytes = sizeof(conic_layers_entry) + sizeof(conic_layers_slot) + 96; /* with its place and pieces */
  uint64_t taken = own_bytes + conic_layers_all(layers) * cloud_bytes + layers->picture_bytes;
  return all > taken + all / 8 ? all - taken : all / 8;
}

/* Shares of that: for the cache, and for what is gathered and drawn at a time. The rest is for gaps that memory has
 * when it is taken and given back. */
static inline uint64_t conic_layers_cache_bytes(const conic_layers *layers) {
  return conic_layers_free_bytes(layers) / 4;
}

static inline uint64_t conic_layers_drawing_bytes(const conic_layers *layers) {
  return conic_layers_free_bytes(layers) / 8 * 5;
}
