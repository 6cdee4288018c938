/* Layered clouds whose index is a hierarchy of another kind (lod/hierarchies/hierarchy.h): its nodes as the entries
 * that drawing knows.
 *
 * A node with children gets eight: octants without a node become entries without samples, in which what lies above is
 * drawn. Entries of all known nodes are numbered by level, then by key. As more of the hierarchy is read, they are
 * numbered anew, and the cache with them. What an entry states depends on the nodes above it alone. */
#pragma once

#include "lod/layers/draw/layers_cut.h"

#define CONIC_NO_NODE UINT32_MAX

/* A page whose nodes are known: it is one no more. */
enum { CONIC_OCTREE_PAGE_DONE = 2 };

/* The normals of a node's samples in 4 × 4 × 4 parts of its place, for samples below it that have too few neighbours.
 * They are in the order of the keys, in units of 1/127, and zero where nothing near has any. */
typedef struct conic_layers_guide {
  signed char normal[64][3];
} conic_layers_guide;

/* What layers keep of a hierarchy besides. */
typedef struct conic_layers_octree {
  conic_hierarchy *hierarchy;
  uint32_t *node_of;           /* an entry: its number in the hierarchy, or CONIC_NO_NODE */
  float *measured;             /* a node: the median outline of its own samples; 0: not known yet */
  conic_layers_guide **guides; /* a node: null where it is not known, or tells nothing */
  uint8_t *is_lost;            /* a node: its page could not be read for this picture; 2: nor was it once before */
  size_t nodes_room[3];
  float root_spacing;              /* as measured: the lower median */
  conic_layers_cloud *first_cloud; /* of the first node that has points, as opening measured it; until it is drawn */
  uint32_t first_node;
  conic_raw_scale colors;
} conic_layers_octree;

/* Opens the hierarchy: reads the root's page, and measures the root's points. It takes over the ranges of the layers.
 * Errors: as conic_layers_open. */
conic_status conic_layers_octree_open(conic_layers *layers, const conic_hierarchy_kind *kind);
void conic_layers_octree_close(conic_layers *layers);

typedef struct conic_layers_expansion {
  double error_px;
  uint64_t budget;
  int most_levels;
  double until_s;
  int may_miss, tolerates_damage;
  uint64_t n_missing, n_damaged; /* set: pages that could not be read; those of them that were wrong */
} conic_layers_expansion;

/* Reads the pages of all places that a picture of this error, or budget, shows; without a view, all there are. Errors:
 * INPUT, IO, MEMORY, ARGUMENT (a budget below the root's points), CANCELLED. */
conic_status conic_layers_octree_expand(conic_layers *layers, const conic_layers_view *view,
                                        conic_layers_expansion *expansion);

/* Bytes of pages that came over the network, where they are no part of the file of the clouds. */
uint64_t conic_layers_octree_received(const conic_layers *layers);

/* Whether an entry only stands for a page that was not read. */
int conic_layers_octree_is_page(const conic_layers *layers, uint32_t entry);

/* Finds how large the samples are of the entries that are 1 in `needed`, and of those above. Reads what tells so once
 * in the layers' life. Errors: as conic_layers_store_load. */
conic_status conic_layers_octree_measure(conic_layers *layers, const unsigned char *needed);

/* Keeps, as long as the layers are open, what other clouds need to know of one that was unpacked. Errors: MEMORY. */
conic_status conic_layers_octree_keep(conic_layers *layers, uint32_t entry, const conic_layers_cloud *cloud);

/* Finds the normal that the nodes above an entry have where a sample of this key is. 0: they have none. */
int conic_layers_octree_guess(const conic_layers *layers, uint32_t entry, uint64_t key, float normal[3]);

/* The outline that samples from above get in the place of an entry, if that is the finest there. */
float conic_layers_octree_outline(const conic_layers *layers, uint32_t entry);

/* Unpacks an entry's samples; null, or what is wrong. Any thread. */
const char *conic_layers_octree_decode(const conic_layers *layers, uint32_t entry, const unsigned char *bytes,
                                       size_t n_bytes, conic_layers_cloud *cloud);

/* Hands over an entry's cloud, in a block as the store has them, where it is kept since opening; else null. */
conic_layers_cloud *conic_layers_octree_take_first(conic_layers *layers, uint32_t entry);

/* Where an entry's bytes are. */
void conic_layers_octree_locate(const conic_layers *layers, uint32_t entry, conic_range *range);

/* --- entries and pages --- */

/* How far a point may lie outside its cell, as a share of the cell's edge. */
#define CONIC_OCTREE_SLACK 0.03125

/* Makes the entries anew, of all nodes that are known. Nothing is held of the cache. Errors: INPUT (they are no tree),
 * MEMORY. */
conic_status conic_layers_octree_index(conic_layers *layers);

/* Reads the pages of these entries. The nodes that they tell of replace the entries. Errors: as expansion. */
conic_status conic_layers_octree_read_pages(conic_layers *layers, const uint32_t *entries, size_t n,
                                            conic_layers_expansion *expansion);
