/* The nodes of a grown tree in the order of the file: by level, then by key; in a file, too, so that memory does not
 * grow with them. */
#ifndef CONIC_LAYERS_ORDER_H
#define CONIC_LAYERS_ORDER_H

#include "lod/layers/build/layers_chunks.h"

/* So many nodes are looked at at a time. */
enum { CONIC_LAYERS_SOME_NODES = 256 };

typedef struct conic_layers_order {
  conic_scratch file; /* conic_layers_entry each; all but the offset is that of the file, which is that in the pile */
  uint64_t n;
  uint32_t n_levels;
} conic_layers_order;

/* `path`: beside which the file lies; it must outlive the order. Errors: INPUT (more than a file may have), MEMORY, IO.
 */
conic_status conic_layers_order_nodes(conic_context *context, const char *path, const conic_layers_forest *forest,
                                      conic_layers_order *order);
void conic_layers_order_end(conic_layers_order *order); /* zero is allowed */

/* Reads nodes from number `first` on, CONIC_LAYERS_SOME_NODES or what there are; *n says how many. Errors: IO. */
conic_status conic_layers_order_read(const conic_layers_order *order, uint64_t first, conic_layers_entry *nodes,
                                     size_t *n);

#endif
