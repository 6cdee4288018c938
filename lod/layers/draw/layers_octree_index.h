/* From a hierarchy's nodes to the entries that drawing knows, and reading its pages. */
#ifndef CONIC_LAYERS_OCTREE_INDEX_H
#define CONIC_LAYERS_OCTREE_INDEX_H

#include "lod/layers/draw/layers_octree.h"

/* How far a point may lie outside its cell, as a share of the cell's edge. */
#define CONIC_OCTREE_SLACK 0.03125

/* Makes the entries anew, of all nodes that are known. Nothing is held of the cache. Errors: INPUT (they are no tree),
 * MEMORY. */
conic_status conic_layers_octree_index(conic_layers *layers);

/* Reads the pages of these entries. The nodes that they tell of replace the entries. Errors: as expansion. */
conic_status conic_layers_octree_read_pages(conic_layers *layers, const uint32_t *entries, size_t n,
                                            conic_layers_expansion *expansion);

#endif
